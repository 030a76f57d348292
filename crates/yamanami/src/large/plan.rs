//! What fits into a memory: how large a mesh may be in one piece, and how large blocks are beside what all of them need.

use crate::Error;

/// What the process holds before it reads anything: code, libraries, threads, buffers of files.
const BASE_BYTES: u64 = 24 << 20;
/// A mesh while it is collapsed: 24 bytes of arrays, the collapse's own, and its result.
const BYTES_A_FACE: u64 = 170;
/// What colours add: their gradients around each vertex above all.
const BYTES_OF_COLOURS_A_FACE: u64 = 130;
/// A mesh while it is read as a whole, beside its file's bytes.
const READ_BYTES_A_FACE: u64 = 40;
/// Blocks at work at the same time. Fixed, as blocks and with them the result depend on it.
pub(super) const AT_ONCE: usize = 2;
/// Most blocks of a round; the table of blocks has two bytes a vertex.
const MOST_BLOCKS: u64 = 1 << 14;

/// A memory.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    memory_bytes: u64,
    bytes_a_face: u64,
}

impl Plan {
    pub(super) fn new(memory_bytes: u64, has_colours: bool) -> Self {
        Self { memory_bytes, bytes_a_face: BYTES_A_FACE + if has_colours { BYTES_OF_COLOURS_A_FACE } else { 0 } }
    }

    fn usable(&self) -> u64 {
        self.memory_bytes.saturating_sub(BASE_BYTES)
    }

    /// Largest mesh that is collapsed in one piece.
    pub(super) fn most_faces(&self) -> u64 {
        self.usable() / self.bytes_a_face
    }

    /// Largest file that is read as a whole: a face takes 19 bytes of a usual one.
    pub(super) fn most_file_bytes(&self) -> u64 {
        self.usable() / (19 + READ_BYTES_A_FACE) * 19
    }

    /// Faces that a block may have when the whole mesh has so many vertices.
    pub(super) fn most_block_faces(&self, vertices: u64) -> u64 {
        // a set of its vertices for each, and one of the seams'
        let sets = (AT_ONCE as u64 + 1) * marks_bytes(vertices);
        self.usable().saturating_sub(sets) / (AT_ONCE as u64 * self.bytes_a_face)
    }

    /// How many blocks to cut a mesh into.
    pub(super) fn blocks(&self, vertices: u64, faces: u64) -> Result<usize, Error> {
        let needed = 3 * marks_bytes(vertices).max(vertices);
        // as much again for blocks that are worth the name
        if self.usable() < 2 * needed {
            let needed = 2 * needed + BASE_BYTES;
            return Err(self.short_of(format!("tables for {vertices} vertices"), needed));
        }
        // cuts follow samples, and seams come on top
        let aim = self.most_block_faces(vertices) / 5 * 4;
        let blocks = faces.div_ceil(aim.max(1)).max(3);
        if blocks > MOST_BLOCKS {
            return Err(
                self.short_of(format!("{blocks} blocks"), BASE_BYTES + faces / MOST_BLOCKS * 4 * self.bytes_a_face)
            );
        }
        Ok(blocks as usize)
    }

    /// Bytes to collect for each of so many streams before they are written.
    pub(super) fn buffer_bytes(&self, streams: usize) -> usize {
        ((self.usable() / 8) as usize / streams).clamp(1 << 12, 1 << 18)
    }

    /// How many faces blocks should leave to the collapse of all of them: the second number where it fits with what seams
    /// hold, else what fits, but not less than the first: then another round makes it fit, with seams elsewhere.
    pub(super) fn goal(&self, [enough, wanted]: [u64; 2], seam_faces: u64) -> u64 {
        // each face between blocks has an edge with a face of a block
        let held = 2 * seam_faces;
        wanted.min(self.most_faces().saturating_sub(held) / 10 * 9).max(enough.min(self.most_faces() / 10 * 9))
    }

    /// Refuses seams that leave no room for blocks.
    pub(super) fn check_seam(&self, on_seams: u64, vertices: u64) -> Result<(), Error> {
        // kept while blocks are at work: place, colour, number in its piece
        let needed = on_seams * 40;
        if needed > self.usable() / 4 {
            let what = format!("{on_seams} of {vertices} vertices are shared by blocks");
            return Err(self.short_of(what, BASE_BYTES + 4 * needed));
        }
        Ok(())
    }

    /// Refuses a result that does not fit itself.
    pub(super) fn check_target(&self, faces: u64) -> Result<(), Error> {
        if faces > self.most_faces() {
            return Err(self.too_little(format!("a result of {faces} faces"), faces));
        }
        Ok(())
    }

    /// The memory does not do for a mesh of so many faces in one piece.
    pub(super) fn too_little(&self, what: String, faces: u64) -> Error {
        self.short_of(what, BASE_BYTES + faces * self.bytes_a_face)
    }

    fn short_of(&self, what: String, needed: u64) -> Error {
        let megabytes = |bytes: u64| bytes.div_ceil(1_000_000);
        let (given, needed) = (megabytes(self.memory_bytes), megabytes(needed));
        Error::Request(format!("memory: {what}: expected at least {needed} MB, given {given} MB"))
    }
}

/// A bit a vertex, with counts.
fn marks_bytes(vertices: u64) -> u64 {
    vertices / 8 + vertices / 128
}
