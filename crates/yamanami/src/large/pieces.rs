//! Reduced blocks on a disk, joined by the vertices that they share: a mesh again.

use super::Source;
use super::partition::triangle_of;
use glam::DVec3;
use std::path::Path;
use yamanami_core::TriangleMesh;
use yamanami_io::IoError;
use yamanami_io::mesh_file::{TriangleSink, VertexRun, VertexSink};
use yamanami_io::scratch::Scratch;

/// Bytes read at a time.
const BUFFER: usize = 1 << 18;

/// A mesh of pieces.
#[derive(Debug)]
pub(super) struct Pieces {
    scratch: Scratch,
    pieces: usize,
    has_colours: bool,
    /// Number of each piece's first vertex, and of the one after the last.
    first: Vec<u32>,
    faces: u64,
}

impl Pieces {
    /// Room for so many pieces.
    pub(super) fn create(folder: &Path, pieces: usize, has_colours: bool) -> Result<Self, IoError> {
        let scratch = Scratch::create(folder, 2 * pieces + 1)?;
        Ok(Self { scratch, pieces, has_colours, first: vec![0; pieces + 1], faces: 0 })
    }

    fn record(&self) -> usize {
        if self.has_colours { 28 } else { 24 }
    }

    /// Keeps a piece; corners are numbers within it.
    pub(super) fn put(&self, piece: usize, mesh: &TriangleMesh) -> Result<(), IoError> {
        let mut bytes = Vec::with_capacity(BUFFER + 64);
        for (k, p) in mesh.positions.iter().enumerate() {
            for c in p.to_array() {
                bytes.extend_from_slice(&c.to_le_bytes());
            }
            if self.has_colours {
                bytes.extend_from_slice(mesh.colours.get(k).unwrap_or(&[255; 4]));
            }
            if bytes.len() >= BUFFER {
                self.scratch.append(piece, &bytes)?;
                bytes.clear();
            }
        }
        self.scratch.append(piece, &bytes)?;
        self.put_triangles(piece, &mesh.triangles)
    }

    /// Keeps triangles of a piece, or, for the piece after the last, triangles with corners numbered over all pieces.
    pub(super) fn put_triangles(&self, piece: usize, triangles: &[[u32; 3]]) -> Result<(), IoError> {
        let mut bytes = Vec::with_capacity(BUFFER);
        for part in triangles.chunks(BUFFER / 12) {
            bytes.clear();
            bytes.extend(part.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
            self.scratch.append(self.pieces + piece, &bytes)?;
        }
        Ok(())
    }

    /// Numbers the vertices over all pieces, after all pieces came. Gives each piece's first.
    pub(super) fn number(&mut self) -> &[u32] {
        let mut sum = 0;
        for piece in 0..self.pieces {
            self.first[piece] = sum;
            sum += (self.scratch.len(piece) / self.record() as u64) as u32;
        }
        self.first[self.pieces] = sum;
        &self.first
    }

    /// Counts the triangles, after all came.
    pub(super) fn finish(mut self) -> Self {
        self.faces = (0..=self.pieces).map(|piece| self.scratch.len(self.pieces + piece) / 12).sum();
        self
    }

    pub(super) fn faces(&self) -> u64 {
        self.faces
    }

    pub(super) fn scratch_bytes(&self) -> u64 {
        self.scratch.total_len()
    }
}

impl Source for Pieces {
    fn vertices(&self) -> u64 {
        self.first[self.pieces].into()
    }

    fn faces(&self) -> u64 {
        self.faces
    }

    fn has_colours(&self) -> bool {
        self.has_colours
    }

    fn is_single_precision(&self) -> bool {
        false
    }

    fn each_vertex_run(&mut self, sink: &mut VertexSink<'_>) -> Result<(), IoError> {
        let (mut buffer, mut positions, mut colours) = (vec![0; BUFFER], Vec::new(), Vec::new());
        let size = self.record();
        for piece in 0..self.pieces {
            let mut first = self.first[piece];
            self.scratch.read(piece, size, &mut buffer, &mut |records| {
                positions.clear();
                colours.clear();
                for r in records.chunks_exact(size) {
                    positions.push(DVec3::from([0, 8, 16].map(|k| {
                        let b = &r[k..k + 8];
                        f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])
                    })));
                    if let Some(c) = r.get(24..28) {
                        colours.push([c[0], c[1], c[2], c[3]]);
                    }
                }
                sink(VertexRun { first, positions: &positions, colours: &colours })?;
                first += positions.len() as u32;
                Ok::<_, IoError>(())
            })?;
        }
        Ok(())
    }

    fn each_triangle_run(&mut self, sink: &mut TriangleSink<'_>) -> Result<(), IoError> {
        let (mut buffer, mut triangles) = (vec![0; BUFFER], Vec::new());
        for piece in 0..=self.pieces {
            let first = if piece < self.pieces { self.first[piece] } else { 0 };
            self.scratch.read(self.pieces + piece, 12, &mut buffer, &mut |records| {
                triangles.clear();
                triangles.extend(records.chunks_exact(12).map(|r| triangle_of(r).map(|v| v + first)));
                sink(&triangles)
            })?;
        }
        Ok(())
    }
}

/// A whole mesh from its source.
pub(super) fn load(source: &mut dyn Source) -> Result<TriangleMesh, IoError> {
    // counts were checked against the memory allowed
    let mut mesh = TriangleMesh::default();
    mesh.positions.reserve_exact(source.vertices() as usize);
    mesh.triangles.reserve_exact(source.faces() as usize);
    source.each_vertex_run(&mut |run| {
        mesh.positions.extend_from_slice(run.positions);
        mesh.colours.extend_from_slice(run.colours);
        Ok(())
    })?;
    source.each_triangle_run(&mut |triangles| {
        mesh.triangles.extend_from_slice(triangles);
        Ok(())
    })?;
    Ok(mesh)
}
