//! What each rule loses from random eyes.

use crate::{Culling, TinDrawing, seen_triangles};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashSet;
use yamanami_core::View;
use yamanami_multires::tin_block::TinBlocks;

/// Losses over many poses.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Losses {
    pub(super) poses: usize,
    /// Blocks of which something is seen, and those of them whose four corners are all out of view.
    pub(super) seen_blocks: usize,
    pub(super) cornerless_blocks: usize,
    /// Poses whose own block, the one under the eye, is seen; and those where it has no corner in view.
    pub(super) own_seen: usize,
    pub(super) own_cornerless: usize,
    /// Triangles that are seen, and those that were not drawn by the paper's rule, and by the conservative one.
    pub(super) seen: usize,
    pub(super) lost_faithful: usize,
    pub(super) lost_conservative: usize,
}

impl Losses {
    fn and(self, o: Self) -> Self {
        Self {
            poses: self.poses + o.poses,
            seen_blocks: self.seen_blocks + o.seen_blocks,
            cornerless_blocks: self.cornerless_blocks + o.cornerless_blocks,
            own_seen: self.own_seen + o.own_seen,
            own_cornerless: self.own_cornerless + o.own_cornerless,
            seen: self.seen + o.seen,
            lost_faithful: self.lost_faithful + o.lost_faithful,
            lost_conservative: self.lost_conservative + o.lost_conservative,
        }
    }
}

/// Eyes anywhere over the ground, 100 m high, that look level in any direction, as the paper's does.
pub(super) fn losses(blocks: &TinBlocks, thresholds_m: &[f64], like: &View, poses: usize) -> Losses {
    const CHUNK: usize = 256;
    let chunks: Vec<usize> = (0..poses.div_ceil(CHUNK)).collect();
    let of_chunk = |&chunk: &usize| {
        let mut drawings = [(); 2].map(|()| TinDrawing::new(thresholds_m.to_vec()));
        let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(poses);
        range
            .map(|pose| of_pose(blocks, &pose_view(blocks, like, pose), &mut drawings))
            .fold(Losses::default(), Losses::and)
    };
    chunks.par_iter().map(of_chunk).reduce(Losses::default, Losses::and)
}

/// The `nth` of a sequence that fills places and headings evenly (Roberts, "The unreasonable effectiveness of
/// quasirandom sequences", 2018).
fn pose_view(blocks: &TinBlocks, like: &View, nth: usize) -> View {
    // g⁴ = g + 1
    const G: f64 = 1.220_744_084_605_759_5;
    let share = |k: i32| (0.5 + nth as f64 / G.powi(k)).fract();
    let lines = [0, 1].map(|axis| blocks.grid().lines_m(axis));
    let at = |axis: usize, share: f64| {
        let (first, last) = (lines[axis][0], lines[axis][lines[axis].len() - 1]);
        first + share * (last - first)
    };
    let eye = DVec3::new(at(0, share(1)), at(1, share(2)), like.eye.z);
    let heading = std::f64::consts::TAU * share(3);
    View { eye, target: eye + DVec3::new(heading.sin(), heading.cos(), 0.0), ..*like }
}

fn of_pose(blocks: &TinBlocks, view: &View, [faithful, conservative]: &mut [TinDrawing; 2]) -> Losses {
    let frustum = view.frustum();
    faithful.draw(blocks, view, Culling::Faithful);
    conservative.draw(blocks, view, Culling::Conservative);
    let own = blocks.grid().block_at(view.eye);
    let mut losses = Losses { poses: 1, ..Losses::default() };
    for block in 0..blocks.grid().len() {
        let seen = seen_triangles(blocks, block, conservative.shown(), &frustum);
        if seen.is_empty() {
            continue;
        }
        let is_cornerless = !blocks.corners_m(block).iter().any(|&p| frustum.sees_point(p));
        losses.seen_blocks += 1;
        losses.cornerless_blocks += usize::from(is_cornerless);
        losses.own_seen += usize::from(block == own);
        losses.own_cornerless += usize::from(block == own && is_cornerless);
        losses.seen += seen.len();
        let lost = |drawing: &TinDrawing| {
            let drawn: HashSet<_> = drawing.triangles_of(block).iter().collect();
            seen.iter().filter(|&triangle| !drawn.contains(triangle)).count()
        };
        losses.lost_faithful += lost(faithful);
        losses.lost_conservative += lost(conservative);
    }
    losses
}
