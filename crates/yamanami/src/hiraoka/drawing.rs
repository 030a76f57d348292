//! The drawing step timed and checked on a ground of some size: brute force, the paper's rule, the one that loses nothing.

use super::engine::{EngineFound, engine};
use super::ground::{grid, own_block_view, paper_view, thresholds_m};
use super::pictures::{full_picture, levels_picture};
use super::{DRAWN, file_name};
use crate::{Culling, DrawCounts, Error, TinDrawing, seen_triangles};
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::time::Instant;
use yamanami_core::{Frustum, TriangleMesh};
use yamanami_measure::{FLIP_PIXELS_PER_DEGREE, flip, ssim};
use yamanami_multires::tin_block::{TinBlocks, centroid_chain};

/// The three ways, with their names in tables.
pub(super) const CULLINGS: [(Culling, &str); 3] = [
    (Culling::BruteForce, "brute force"),
    (Culling::Faithful, "the paper's rule"),
    (Culling::Conservative, "conservative"),
];

/// Most and fewest runs whose median is told.
const RUNS: [usize; 2] = [301, 11];
/// Runs end after about so long.
const RUNS_S: f64 = 2.0;

/// What one way of drawing did.
#[derive(Debug, Clone)]
pub(super) struct DrawRow {
    pub(super) name: &'static str,
    pub(super) median_ms: f64,
    pub(super) triangles: usize,
    pub(super) counts: DrawCounts,
    /// Triangles that are seen, at the levels that it chose, and were not drawn; and blocks of which all that is seen was
    /// not.
    pub(super) lost_triangles: usize,
    pub(super) lost_blocks: usize,
    /// Against the picture of the whole TIN.
    pub(super) ssim: f64,
    pub(super) flip: f64,
}

/// Open edges inside the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gaps {
    /// With the seams.
    pub(super) joined: usize,
    /// Each block as it was cut.
    pub(super) apart: usize,
}

/// What was found for one size of ground.
#[derive(Debug)]
pub(super) struct SizeFound {
    /// Copies of the paper's ground each way.
    pub(super) copies: usize,
    pub(super) blocks: usize,
    pub(super) chain_s: f64,
    pub(super) blocks_s: f64,
    /// Triangles after the cut and vertical error, by level.
    pub(super) levels: Vec<(usize, f64)>,
    pub(super) rows: Vec<DrawRow>,
    pub(super) gaps: Gaps,
    pub(super) engine: EngineFound,
}

/// Builds and draws a ground. Pictures of one of the paper's size are written into `out`.
pub(super) fn measure(
    tin: &TriangleMesh,
    copies: usize,
    out: &Path,
    progress: &dyn Fn(&str),
) -> Result<SizeFound, Error> {
    let title = format!("{} triangles", tin.triangles.len());
    progress(&format!("{title}: levels"));
    let start = Instant::now();
    let thresholds_m = thresholds_m(copies);
    let chain = centroid_chain(tin, thresholds_m.len() + 1, DRAWN)?;
    let chain_s = start.elapsed().as_secs_f64();
    progress(&format!("{title}: blocks"));
    let start = Instant::now();
    let blocks = TinBlocks::new(&chain, grid(copies)?)?;
    let blocks_s = start.elapsed().as_secs_f64();
    drop(chain);
    let view = paper_view();
    let frustum = view.frustum();
    progress(&format!("{title}: the picture of all"));
    let full = full_picture(tin, &view)?;
    if copies == 1 {
        full.save_itself(tin, &view, out)?;
    }
    let mut drawing = TinDrawing::new(thresholds_m);
    let mut rows = Vec::new();
    for (culling, name) in CULLINGS {
        progress(&format!("{title}: {name}"));
        let mut counts = DrawCounts::default();
        let median_ms = median_ms(|| counts = drawing.draw(&blocks, &view, culling));
        let [lost_triangles, lost_blocks] = lost(&blocks, &drawing, &frustum);
        let mesh = blocks.compact(drawing.triangles());
        let picture = full.like(&mesh, &view)?;
        rows.push(DrawRow {
            name,
            median_ms,
            triangles: drawing.triangles().len(),
            counts,
            lost_triangles,
            lost_blocks,
            ssim: ssim(full.picture(), &picture)?,
            flip: flip(full.picture(), &picture, FLIP_PIXELS_PER_DEGREE)?.mean,
        });
        if copies == 1 && culling != Culling::BruteForce {
            full.save(&mesh, &picture, &view, out, file_name(culling))?;
            levels_picture(&blocks, &drawing, &view, &out.join(format!("levels_{}.png", file_name(culling))))?;
        }
    }
    let gaps = gaps(&blocks, drawing.shown());
    let levels = (0..blocks.levels()).map(|l| (blocks.triangle_count(l), blocks.error_m(l))).collect();
    let count = blocks.grid().len();
    drop(blocks);
    progress(&format!("{title}: the engine"));
    let engine = engine(tin, &view, &full, drawing.triangles().len())?;
    Ok(SizeFound { copies, blocks: count, chain_s, blocks_s, levels, rows, gaps, engine })
}

/// How many triangles, and blocks with all their triangles, are seen at the levels that were chosen, and not drawn.
fn lost(blocks: &TinBlocks, drawing: &TinDrawing, frustum: &Frustum) -> [usize; 2] {
    let mut lost = [0, 0];
    for block in 0..blocks.grid().len() {
        let drawn: HashSet<_> = drawing.triangles_of(block).iter().collect();
        let seen = seen_triangles(blocks, block, drawing.shown(), frustum);
        let missing = seen.iter().filter(|&triangle| !drawn.contains(triangle)).count();
        lost[0] += missing;
        lost[1] += usize::from(missing > 0 && missing == seen.len());
    }
    lost
}

/// What the paper's rule draws from the middle of a block, as a picture beside that of the conservative one; gives the
/// triangles and whole blocks that it loses.
pub(super) fn own_block(tin: &TriangleMesh, out: &Path) -> Result<[usize; 2], Error> {
    let (view, thresholds_m) = (own_block_view(), thresholds_m(1));
    let blocks = TinBlocks::new(&centroid_chain(tin, thresholds_m.len() + 1, DRAWN)?, grid(1)?)?;
    let full = full_picture(tin, &view)?;
    let mut drawing = TinDrawing::new(thresholds_m);
    let mut losses = [0, 0];
    for culling in [Culling::Conservative, Culling::Faithful] {
        drawing.draw(&blocks, &view, culling);
        losses = lost(&blocks, &drawing, &view.frustum());
        let mesh = blocks.compact(drawing.triangles());
        full.save_triangles(&mesh, &view, &out.join(format!("own_block_{}.png", file_name(culling))))?;
    }
    Ok(losses)
}

/// Median time of a job in milliseconds.
pub(super) fn median_ms(mut job: impl FnMut()) -> f64 {
    let begin = Instant::now();
    let mut times_ms = Vec::new();
    while times_ms.len() < RUNS[1] || (times_ms.len() < RUNS[0] && begin.elapsed().as_secs_f64() < RUNS_S) {
        let start = Instant::now();
        job();
        times_ms.push(1e3 * start.elapsed().as_secs_f64());
    }
    times_ms.sort_by(f64::total_cmp);
    times_ms[times_ms.len() / 2]
}

fn gaps(blocks: &TinBlocks, shown: &[u8]) -> Gaps {
    let mut apart = Vec::new();
    for (block, &level) in shown.iter().enumerate() {
        apart.extend_from_slice(blocks.triangles(block, usize::from(level)));
    }
    let outer = open_edges(&blocks.mesh(&vec![0; shown.len()]));
    Gaps {
        joined: open_edges(&blocks.mesh(shown)).saturating_sub(outer),
        apart: open_edges(&blocks.compact(&apart)).saturating_sub(outer),
    }
}

/// Edges with a triangle on one side only, ends told apart by the bits of their places.
fn open_edges(mesh: &TriangleMesh) -> usize {
    let mut number = HashMap::new();
    let numbers: Vec<u32> = mesh
        .positions
        .iter()
        .enumerate()
        .map(|(v, p)| *number.entry(p.to_array().map(f64::to_bits)).or_insert(v as u32))
        .collect();
    let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * mesh.triangles.len());
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| numbers[v as usize]);
        edges.extend([(a, b), (b, c), (c, a)].map(|(p, q)| (p.min(q), p.max(q), p < q)));
    }
    edges.sort_unstable();
    edges.chunk_by(|p, q| (p.0, p.1) == (q.0, q.1)).filter(|same| same.len() == 1).count()
}
