//! How far a line strays when vertices of it go: the border, a breakline.

use super::net::edge_key;
use glam::DVec3;
use std::collections::HashMap;

/// Which vertices went between the two ends of each edge of a line.
#[derive(Debug, Default)]
pub(super) struct Chains {
    gone: HashMap<u64, Vec<u32>>,
    /// No line strayed further, metres.
    pub(super) worst_m: f64,
}

/// Distance of a point from a segment.
pub(super) fn distance_m(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(a + along * t)
}

impl Chains {
    /// How far the line strays when `v` goes and its neighbours `a` and `b` are joined: every vertex that went between them
    /// lies so near the new edge. The line's ends stay, so the new edge lies as near the old line. Chain vertices never move.
    pub(super) fn stray_m(&self, positions: &[DVec3], a: u32, v: u32, b: u32) -> f64 {
        let [pa, pb] = [a, b].map(|i| positions[i as usize]);
        let gone = [edge_key(a, v), edge_key(v, b)].into_iter().filter_map(|edge| self.gone.get(&edge)).flatten();
        gone.chain([&v]).map(|&i| distance_m(positions[i as usize], pa, pb)).fold(0.0, f64::max)
    }

    /// `v` goes.
    pub(super) fn join(&mut self, positions: &[DVec3], a: u32, v: u32, b: u32) {
        self.worst_m = self.worst_m.max(self.stray_m(positions, a, v, b));
        let mut gone = self.gone.remove(&edge_key(a, v)).unwrap_or_default();
        gone.extend(self.gone.remove(&edge_key(v, b)).unwrap_or_default());
        gone.push(v);
        self.gone.insert(edge_key(a, b), gone);
    }
}
