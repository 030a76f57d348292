//! A mesh cut into blocks on a disk. Each vertex belongs to one block; a face belongs to its corners' block, or, where they
//! differ, lies between blocks: then its vertices are *seam* vertices, and every block that it touches knows it.

use super::Source;
use super::numbering::Numbering;
use super::plan::Plan;
use super::tree::Tree;
use crate::Error;
use glam::DVec3;
use rayon::prelude::*;
use std::path::Path;
use yamanami_io::IoError;
use yamanami_io::scratch::Scratch;

/// Vertices that the tree is grown from, at most about.
const SAMPLE: u64 = 1 << 19;
/// Mark of a face whose corners are not all in one block.
const BETWEEN: u16 = u16::MAX;

/// Blocks on a disk.
#[derive(Debug)]
pub(super) struct Partition {
    scratch: Scratch,
    blocks: usize,
    record: VertexRecord,
    /// Vertices of the source.
    pub(super) vertices: u64,
    /// Faces of each block alone.
    pub(super) own_faces: Vec<u64>,
    /// Faces between blocks.
    pub(super) seam_faces: u64,
    /// Corners of those, numbered.
    pub(super) seam: Numbering,
    pub(super) seam_positions: Vec<DVec3>,
    pub(super) seam_colours: Vec<[u8; 4]>,
}

/// How a vertex is kept: number, place, and colour if there are any.
#[derive(Debug, Clone, Copy)]
struct VertexRecord {
    is_single: bool,
    has_colours: bool,
}

impl VertexRecord {
    fn size(self) -> usize {
        4 + if self.is_single { 12 } else { 24 } + if self.has_colours { 4 } else { 0 }
    }

    fn push(self, into: &mut Vec<u8>, vertex: u32, p: DVec3, colour: Option<&[u8; 4]>) {
        into.extend_from_slice(&vertex.to_le_bytes());
        for c in p.to_array() {
            if self.is_single {
                into.extend_from_slice(&(c as f32).to_le_bytes());
            } else {
                into.extend_from_slice(&c.to_le_bytes());
            }
        }
        if self.has_colours {
            into.extend_from_slice(colour.unwrap_or(&[255; 4]));
        }
    }

    fn read(self, r: &[u8]) -> (u32, DVec3, [u8; 4]) {
        let vertex = u32::from_le_bytes([r[0], r[1], r[2], r[3]]);
        let p = DVec3::from([0, 1, 2].map(|k| {
            if self.is_single {
                let b = &r[4 + 4 * k..8 + 4 * k];
                f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            } else {
                let b = &r[4 + 8 * k..12 + 8 * k];
                f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])
            }
        }));
        let colour = if self.has_colours {
            let b = &r[r.len() - 4..];
            [b[0], b[1], b[2], b[3]]
        } else {
            [255; 4]
        };
        (vertex, p, colour)
    }
}

/// Collects what goes to each stream and writes it when there is enough.
struct Sorter<'a> {
    scratch: &'a Scratch,
    buffers: Vec<Vec<u8>>,
    first: usize,
    most: usize,
}

impl<'a> Sorter<'a> {
    fn new(scratch: &'a Scratch, first: usize, streams: usize, plan: &Plan) -> Self {
        let most = plan.buffer_bytes(streams);
        Self { scratch, buffers: (0..streams).map(|_| Vec::with_capacity(most)).collect(), first, most }
    }

    #[inline]
    fn push(&mut self, stream: usize, record: usize, fill: impl FnOnce(&mut Vec<u8>)) -> Result<(), IoError> {
        let buffer = &mut self.buffers[stream];
        if buffer.len() + record > self.most {
            self.scratch.append(self.first + stream, buffer)?;
            buffer.clear();
        }
        fill(buffer);
        Ok(())
    }

    fn finish(self) -> Result<(), IoError> {
        let mut streams = self.buffers.iter().enumerate();
        streams.try_for_each(|(k, buffer)| self.scratch.append(self.first + k, buffer))
    }
}

fn push_triangle(into: &mut Vec<u8>, [a, b, c]: [u32; 3]) {
    let mut record = [0; 12];
    record[..4].copy_from_slice(&a.to_le_bytes());
    record[4..8].copy_from_slice(&b.to_le_bytes());
    record[8..].copy_from_slice(&c.to_le_bytes());
    into.extend_from_slice(&record);
}

/// A triangle's corners from 12 bytes.
pub(super) fn triangle_of(r: &[u8]) -> [u32; 3] {
    [0, 1, 2].map(|k| u32::from_le_bytes([r[4 * k], r[4 * k + 1], r[4 * k + 2], r[4 * k + 3]]))
}

/// Cuts a mesh into blocks that fit the plan. `progress` hears of the share done.
pub(super) fn partition(
    source: &mut dyn Source,
    plan: &Plan,
    round: usize,
    folder: &Path,
    progress: &dyn Fn(f32),
) -> Result<Partition, Error> {
    let mut blocks = plan.blocks(source.vertices(), source.faces())?;
    let sample = sample(source)?;
    progress(0.1);
    // cuts follow vertices, so blocks of polygons or of dense fans may come out too large: then more of them
    loop {
        let tree = Tree::new(sample.clone(), blocks, round);
        let found = cut(source, &tree, plan, folder, progress)?;
        let largest = found.own_faces.iter().max().copied().unwrap_or_default();
        let allowed = plan.most_block_faces(source.vertices());
        if largest <= allowed {
            return Ok(found);
        }
        if tree.leaves() < blocks || blocks as u64 > 8 * plan.blocks(source.vertices(), found.faces())? as u64 {
            return Err(plan.too_little(format!("a block of {largest} faces that cannot be cut"), 2 * largest));
        }
        blocks *= 2;
    }
}

fn sample(source: &mut dyn Source) -> Result<Vec<DVec3>, IoError> {
    let every = source.vertices().div_ceil(SAMPLE).max(1) as usize;
    let mut sample = Vec::with_capacity(source.vertices() as usize / every + 1);
    source.each_vertex_run(&mut |run| {
        let skip = (run.first as usize).next_multiple_of(every) - run.first as usize;
        sample.extend(run.positions.iter().skip(skip).step_by(every));
        Ok(())
    })?;
    Ok(sample)
}

fn cut(
    source: &mut dyn Source,
    tree: &Tree,
    plan: &Plan,
    folder: &Path,
    progress: &dyn Fn(f32),
) -> Result<Partition, Error> {
    let (blocks, vertices, faces) = (tree.leaves(), source.vertices(), source.faces().max(1));
    let scratch = Scratch::create(folder, 2 * blocks + 1)?;

    let mut block_of = Vec::with_capacity(vertices as usize);
    source.each_vertex_run(&mut |run| {
        block_of.par_extend(run.positions.par_iter().with_min_len(2048).map(|&p| tree.block(p)));
        Ok(())
    })?;
    progress(0.3);

    let mut seam = Numbering::new(vertices);
    let (mut own_faces, mut seam_faces, mut seen) = (vec![0u64; blocks], 0u64, 0u64);
    let mut sorter = Sorter::new(&scratch, blocks, blocks + 1, plan);
    let mut of_face = Vec::new();
    source.each_triangle_run(&mut |triangles| {
        let block_of = &block_of;
        let block = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| block_of[v as usize]);
            if a == b && b == c { a } else { BETWEEN }
        };
        triangles.par_iter().with_min_len(2048).map(block).collect_into_vec(&mut of_face);
        for (&t, &block) in triangles.iter().zip(&of_face) {
            if block != BETWEEN {
                own_faces[usize::from(block)] += 1;
                sorter.push(block.into(), 12, |into| push_triangle(into, t))?;
                continue;
            }
            seam_faces += 1;
            sorter.push(blocks, 12, |into| push_triangle(into, t))?;
            let of = t.map(|v| block_of[v as usize]);
            for (k, &b) in of.iter().enumerate() {
                seam.insert(t[k]);
                if !of[..k].contains(&b) {
                    sorter.push(b.into(), 12, |into| push_triangle(into, t))?;
                }
            }
        }
        seen += triangles.len() as u64;
        progress(0.3 + 0.5 * (seen as f32 / faces as f32).min(1.0));
        Ok(())
    })?;
    sorter.finish()?;

    let record = VertexRecord { is_single: source.is_single_precision(), has_colours: source.has_colours() };
    let on_seams = seam.count();
    plan.check_seam(on_seams as u64, vertices)?;
    let mut seam_positions = Vec::with_capacity(on_seams);
    let mut seam_colours = Vec::with_capacity(if record.has_colours { on_seams } else { 0 });
    let mut sorter = Sorter::new(&scratch, 0, blocks, plan);
    source.each_vertex_run(&mut |run| {
        for (k, &p) in run.positions.iter().enumerate() {
            let (vertex, colour) = (run.first + k as u32, run.colours.get(k));
            let block = usize::from(block_of[vertex as usize]);
            sorter.push(block, record.size(), |into| record.push(into, vertex, p, colour))?;
            if seam.contains(vertex) {
                seam_positions.push(p);
                seam_colours.extend(colour);
            }
        }
        Ok(())
    })?;
    sorter.finish()?;
    progress(1.0);
    Ok(Partition { scratch, blocks, record, vertices, own_faces, seam_faces, seam, seam_positions, seam_colours })
}

impl Partition {
    pub(super) fn blocks(&self) -> usize {
        self.blocks
    }

    /// All faces.
    pub(super) fn faces(&self) -> u64 {
        self.own_faces.iter().sum::<u64>() + self.seam_faces
    }

    pub(super) fn has_colours(&self) -> bool {
        self.record.has_colours
    }

    pub(super) fn scratch_bytes(&self) -> u64 {
        self.scratch.total_len()
    }

    /// Vertices of a block.
    pub(super) fn block_vertices(&self, block: usize) -> usize {
        (self.scratch.len(block) / self.record.size() as u64) as usize
    }

    /// Faces of a block, those between it and others with it.
    pub(super) fn block_faces(&self, block: usize) -> usize {
        (self.scratch.len(self.blocks + block) / 12) as usize
    }

    /// Gives a block's vertices, in order: number in the source, place, colour.
    pub(super) fn each_vertex(
        &self,
        block: usize,
        buffer: &mut [u8],
        mut sink: impl FnMut(u32, DVec3, [u8; 4]),
    ) -> Result<(), IoError> {
        let (size, record) = (self.record.size(), self.record);
        self.scratch.read(block, size, buffer, &mut |records| {
            for r in records.chunks_exact(size) {
                let (vertex, p, colour) = record.read(r);
                sink(vertex, p, colour);
            }
            Ok(())
        })
    }

    /// Gives a block's faces, or, for the block after the last, the faces between blocks, each once.
    pub(super) fn each_triangle(
        &self,
        block: usize,
        buffer: &mut [u8],
        mut sink: impl FnMut([u32; 3]) -> Result<(), IoError>,
    ) -> Result<(), IoError> {
        self.scratch.read(self.blocks + block, 12, buffer, &mut |records| {
            records.chunks_exact(12).try_for_each(|r| sink(triangle_of(r)))
        })
    }
}
