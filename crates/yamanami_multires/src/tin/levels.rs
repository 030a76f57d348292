//! A chain of ever coarser TINs of one ground, each with its true error.

use super::collapse::{Task, reduce};
use super::lines::line_edges;
use super::vertical::{Ground, vertical_distance_m};
use glam::DVec3;
use yamanami_core::{Snap, Tin, TriangleMesh};

/// How to make a chain.
#[derive(Debug, Clone, Copy)]
pub struct LevelOptions {
    /// No border and no breakline strays further from one level to the next, metres.
    pub most_stray_m: f64,
    /// Where vertices that are made may lie; anywhere if `None`.
    pub snap: Option<Snap>,
}

impl Default for LevelOptions {
    fn default() -> Self {
        Self { most_stray_m: f64::INFINITY, snap: None }
    }
}

/// One level.
#[derive(Debug, Clone)]
pub struct Level {
    /// The coarser TIN, without hidden faces; its breaklines are those of the source.
    pub mesh: TriangleMesh,
    /// Edges of the mesh that breaklines run along.
    pub lines: Vec<[u32; 2]>,
    /// Greatest vertical distance from the source, exactly, metres.
    pub vertical_m: f64,
    /// No border and no breakline is further from the source's, metres.
    pub stray_m: f64,
}

/// Collapses a TIN to each of these numbers of triangles in turn, most first. Where lines and shape forbid it, a level has
/// more than was asked for.
pub fn collapse_levels(tin: &Tin, targets: &[usize], options: &LevelOptions) -> Vec<Level> {
    let source = &tin.mesh;
    let origin = source.positions.first().copied().unwrap_or_default();
    let near = |positions: &[DVec3]| positions.iter().map(|&p| p - origin).collect::<Vec<_>>();
    let source_near = near(&source.positions);
    let mut lines = line_edges(tin).edges;
    let mut mesh = TriangleMesh::new(source.positions.clone(), source.triangles.clone());
    let mut stray_m = 0.0;
    let mut levels = Vec::with_capacity(targets.len());
    for &target in targets {
        let is_locked = vec![false; mesh.positions.len()];
        let reduced = reduce(Task {
            positions: &mesh.positions,
            triangles: &mesh.triangles,
            is_locked: &is_locked,
            lines: &lines,
            target,
            most_stray_m: options.most_stray_m,
            snap: options.snap,
        });
        stray_m += reduced.stray_m;
        mesh = TriangleMesh::new(reduced.positions, reduced.triangles);
        lines = reduced.lines;
        let coarse_near = near(&mesh.positions);
        let fine = Ground { positions: &source_near, triangles: &source.triangles };
        let coarse = Ground { positions: &coarse_near, triangles: &mesh.triangles };
        let vertical_m = vertical_distance_m(fine, coarse);
        levels.push(Level { mesh: mesh.clone(), lines: lines.clone(), vertical_m, stray_m });
    }
    levels
}
