//! Meshes larger than memory, reduced in bounded memory: cut into blocks on a disk, each block reduced with what it shares
//! with others held, the results joined by those shared vertices and reduced once more with nothing held.
//!
//! Based on: Lindstrom, "Out-of-core simplification of large polygonal models", 2000, and Garland and Shaffer, "A multiphase
//! approach to efficient surface simplification", 2002 (a first phase that a second one, in memory, corrects); Hoppe,
//! "Smooth view-dependent level-of-detail control and its application to terrain rendering", 1998 (blocks with borders held).

mod block;
mod numbering;
mod partition;
mod pieces;
mod plan;
mod tree;

use crate::Error;
use pieces::Pieces;
use plan::Plan;
use std::path::{Path, PathBuf};
use yamanami_core::TriangleMesh;
use yamanami_io::IoError;
use yamanami_io::mesh_file::{MeshMeta, MeshStream, TriangleSink, VertexSink, read_mesh, write_mesh};
use yamanami_multires::collapse::{AttributeWeights, CollapseOptions, Method, StoppedBy, collapse};

/// How many faces to keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LargeTarget {
    /// So many.
    Faces(u64),
    /// This share of the source's, 0 to 1.
    Ratio(f64),
}

impl LargeTarget {
    fn of(self, faces: u64) -> u64 {
        match self {
            Self::Faces(n) => n.min(faces),
            Self::Ratio(r) => (faces as f64 * r).round() as u64,
        }
    }
}

/// How to reduce a mesh that may be larger than memory.
#[derive(Debug, Clone)]
pub struct LargeOptions {
    /// How many faces to keep.
    pub target: LargeTarget,
    /// What the process may hold, bytes.
    pub memory_bytes: u64,
    /// Which collapse.
    pub method: Method,
    /// Attributes in the metric.
    pub weights: AttributeWeights,
    /// Where scratch space is taken, about the size of the source; the result's folder if nothing is said.
    pub scratch: Option<PathBuf>,
    /// What the result's file says about itself.
    pub meta: MeshMeta,
}

impl LargeOptions {
    /// A target within a memory, everything else as usual.
    pub fn new(target: LargeTarget, memory_bytes: u64) -> Self {
        Self {
            target,
            memory_bytes,
            method: Method::default(),
            weights: AttributeWeights::default(),
            scratch: None,
            meta: MeshMeta::default(),
        }
    }
}

/// What became of a large mesh.
#[derive(Debug, Clone)]
pub struct LargeReport {
    /// Triangles of the source.
    pub source_faces: u64,
    /// Triangles that were asked for.
    pub target_faces: u64,
    /// Triangles of the result.
    pub faces: u64,
    /// Blocks of each round, none where the mesh fitted into memory.
    pub blocks: Vec<usize>,
    /// Triangles between blocks, over all rounds.
    pub seam_faces: u64,
    /// Triangles that came to the last collapse, which is done in memory with nothing held.
    pub joined_faces: u64,
    /// Bytes of scratch space at most.
    pub scratch_bytes: u64,
    /// What ended the last collapse.
    pub stopped_by: StoppedBy,
    /// Attributes of the source that did not pass through blocks.
    pub left_out: Vec<&'static str>,
}

/// A mesh that is read in passes.
trait Source {
    fn vertices(&self) -> u64;
    /// Triangles, as far as known: polygons may give more.
    fn faces(&self) -> u64;
    fn has_colours(&self) -> bool;
    fn is_single_precision(&self) -> bool;
    fn each_vertex_run(&mut self, sink: &mut VertexSink<'_>) -> Result<(), IoError>;
    fn each_triangle_run(&mut self, sink: &mut TriangleSink<'_>) -> Result<(), IoError>;
}

impl Source for MeshStream {
    fn vertices(&self) -> u64 {
        self.vertices()
    }
    fn faces(&self) -> u64 {
        self.faces()
    }
    fn has_colours(&self) -> bool {
        self.has_colours()
    }
    fn is_single_precision(&self) -> bool {
        self.is_single_precision()
    }
    fn each_vertex_run(&mut self, sink: &mut VertexSink<'_>) -> Result<(), IoError> {
        self.each_vertex_run(sink)
    }
    fn each_triangle_run(&mut self, sink: &mut TriangleSink<'_>) -> Result<(), IoError> {
        self.each_triangle_run(sink)
    }
}

/// How many times the target the blocks leave to the last collapse, which chooses among them: what is enough, and what is
/// wanted where memory allows.
const FREEDOM: [u64; 2] = [4, 8];

/// Reduces the mesh in `input` to a target and writes it to `output`. A mesh that fits into the memory allowed is
/// reduced as a whole. Only PLY files may be larger. `progress` hears of the share done, 0 to 1.
pub fn reduce_large(
    input: &Path,
    output: &Path,
    options: &LargeOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<LargeReport, Error> {
    let beside = output.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = options.scratch.as_deref().unwrap_or(beside);
    // what carries colours takes more: so does what may
    let plan = Plan::new(options.memory_bytes, true);
    let file_bytes = std::fs::metadata(input).map_err(|e| IoError::io(input, e))?.len();
    if !MeshStream::knows(input) {
        // what a file of another format holds is only known when it is read
        if file_bytes > plan.most_file_bytes() {
            MeshStream::open(input, folder)?;
        }
        return in_memory(read_mesh(input)?, output, options, progress);
    }
    let mut stream = MeshStream::open(input, folder)?;
    let plan = Plan::new(options.memory_bytes, stream.has_colours());
    if stream.faces() <= plan.most_faces() && stream.bytes() <= plan.most_file_bytes() {
        drop(stream);
        return in_memory(read_mesh(input)?, output, options, progress);
    }
    let mut report = LargeReport {
        source_faces: 0,
        target_faces: 0,
        faces: 0,
        blocks: Vec::new(),
        seam_faces: 0,
        joined_faces: 0,
        scratch_bytes: 0,
        stopped_by: StoppedBy::Target,
        left_out: stream.left_out(),
    };
    let mut pieces: Option<Pieces> = None;
    while pieces.as_ref().is_none_or(|p| p.faces() > plan.most_faces()) {
        let round = report.blocks.len();
        let source: &mut dyn Source = match &mut pieces {
            Some(pieces) => pieces,
            None => &mut stream,
        };
        let parts = partition::partition(source, &plan, round, folder, &|share| progress(share * 0.2))?;
        let before = parts.faces();
        if round == 0 {
            report.source_faces = before;
            report.target_faces = options.target.of(before);
            plan.check_target(report.target_faces)?;
        }
        report.blocks.push(parts.blocks());
        report.seam_faces += parts.seam_faces;
        let goal = plan.goal(FREEDOM.map(|times| times * report.target_faces), parts.seam_faces);
        let next = block::reduce_all(&parts, goal, options, folder, &|share| progress(0.2 + share * 0.6))?;
        report.scratch_bytes = report.scratch_bytes.max(parts.scratch_bytes() + next.scratch_bytes());
        if next.faces() > before / 10 * 9 && next.faces() > plan.most_faces() {
            return Err(plan.too_little(format!("blocks reduce {before} faces to {} only", next.faces()), next.faces()));
        }
        pieces = Some(next);
    }
    let joined = match &mut pieces {
        Some(pieces) => pieces::load(pieces)?,
        None => pieces::load(&mut stream)?,
    };
    drop(pieces);
    report.joined_faces = joined.triangles.len() as u64;
    let last = |share: f32| progress(0.8 + 0.2 * share);
    let collapsed = collapse(&joined, &collapse_options(options, report.target_faces, &last));
    drop(joined);
    write_mesh(output, &collapsed.mesh, &options.meta)?;
    report.faces = collapsed.mesh.triangles.len() as u64;
    report.stopped_by = collapsed.stopped_by;
    Ok(report)
}

fn in_memory(
    mesh: TriangleMesh,
    output: &Path,
    options: &LargeOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<LargeReport, Error> {
    let source_faces = mesh.triangles.len() as u64;
    let target_faces = options.target.of(source_faces);
    let collapsed = collapse(&mesh, &collapse_options(options, target_faces, progress));
    drop(mesh);
    write_mesh(output, &collapsed.mesh, &options.meta)?;
    Ok(LargeReport {
        source_faces,
        target_faces,
        faces: collapsed.mesh.triangles.len() as u64,
        blocks: Vec::new(),
        seam_faces: 0,
        joined_faces: source_faces,
        scratch_bytes: 0,
        stopped_by: collapsed.stopped_by,
        left_out: Vec::new(),
    })
}

fn collapse_options<'a>(
    options: &LargeOptions,
    target_faces: u64,
    progress: &'a (dyn Fn(f32) + Sync),
) -> CollapseOptions<'a> {
    CollapseOptions {
        target_faces: target_faces as usize,
        method: options.method,
        weights: options.weights,
        progress: Some(progress),
        ..CollapseOptions::default()
    }
}
