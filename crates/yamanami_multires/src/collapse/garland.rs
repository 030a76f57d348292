//! The ten steps of Garland and Heckbert 1997 as Mizuno et al. list them: one quadric a vertex, summed from the planes
//! of its triangles and added up as vertices merge, the cheapest edge first.
//!
//! Two things beside the ten steps: borders are held by planes that stand on them (section 6 of the paper of 1997), and
//! an edge whose collapse would fold or pinch the surface is passed over.

use super::StoppedBy;
use super::quadric::Quadric;
use super::rounds::Stop;
use super::work::{Kept, Work};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// How much more a border's standing planes weigh than the surface's.
const BORDER_WEIGHT: f64 = 1000.0;

/// A pair of vertices with its cost; the order is that of cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Pair {
    /// Bits of the cost, which is not negative, so that they order like it.
    cost: u64,
    vertices: [u32; 2],
    /// Sum of the vertices' versions when the pair was weighed.
    version: u64,
}

/// Collapses in place. Gives why it stopped and the largest estimate of a step's distance, in units of `work`.
pub(super) fn run(work: &mut Work, stop: Stop, progress: &dyn Fn(usize)) -> (StoppedBy, f64) {
    let vertices = work.positions.len();
    let mut quadrics = vec![Quadric::default(); vertices];
    for t in 0..work.triangles.len() {
        let corners = work.triangles[t];
        let [a, b, c] = corners.map(|v| work.positions[v as usize]);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        let plane = Quadric::plane(normal, -normal.dot(a), 1.0);
        for (k, v) in corners.into_iter().enumerate() {
            quadrics[v as usize] += plane;
            let w = corners[(k + 1) % 3];
            if work.edge_triangles(v, w) == 1 {
                let (from, to) = (work.positions[v as usize], work.positions[w as usize]);
                if let Some(across) = (to - from).cross(normal).try_normalize() {
                    let standing = Quadric::plane(across, -across.dot(from), BORDER_WEIGHT);
                    quadrics[v as usize] += standing;
                    quadrics[w as usize] += standing;
                }
            }
        }
    }
    let mut version = vec![0u64; vertices];
    let weigh = |work: &Work, quadrics: &[Quadric], version: &[u64], a: u32, b: u32| -> (Pair, DVec3) {
        let sum = quadrics[a as usize] + quadrics[b as usize];
        let (pa, pb) = (work.positions[a as usize], work.positions[b as usize]);
        let place = match work.kept_end(a, b) {
            Kept::First | Kept::Both => pa,
            Kept::Second => pb,
            Kept::Neither => sum.minimum().unwrap_or_else(|| sum.minimum_between(pa, pb)),
        };
        let version = version[a as usize] + version[b as usize];
        (Pair { cost: sum.at(place).to_bits(), vertices: [a.min(b), a.max(b)], version }, place)
    };
    let mut heap = BinaryHeap::new();
    for t in 0..work.triangles.len() {
        let corners = work.triangles[t];
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if a < b || work.edge_triangles(a, b) == 1 {
                heap.push(Reverse(weigh(work, &quadrics, &version, a, b).0));
            }
        }
    }
    let mut worst = 0f64;
    let mut neighbours = Vec::new();
    loop {
        if work.faces() <= stop.faces {
            return (StoppedBy::Target, worst);
        }
        let Some(Reverse(pair)) = heap.pop() else { return (StoppedBy::Topology, worst) };
        let [a, b] = pair.vertices;
        let is_stale = work.is_gone(a) || work.is_gone(b) || pair.version != version[a as usize] + version[b as usize];
        if is_stale || work.kept_end(a, b) == Kept::Both {
            continue;
        }
        let cost = f64::from_bits(pair.cost).sqrt();
        if cost > stop.error {
            return (StoppedBy::Error, worst);
        }
        let (_, place) = weigh(work, &quadrics, &version, a, b);
        let (pa, pb) = (work.positions[a as usize], work.positions[b as usize]);
        // the one whose place is kept stays
        let (stays, goes, from, to) = if place == pb { (b, a, pb, pa) } else { (a, b, pa, pb) };
        let share = ((place - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        if !work.collapse(goes, stays, place, share as f32) {
            continue;
        }
        worst = worst.max(cost);
        quadrics[stays as usize] = quadrics[a as usize] + quadrics[b as usize];
        version[stays as usize] += 1 + version[goes as usize];
        work.neighbours(stays, &mut neighbours);
        for &n in &neighbours {
            heap.push(Reverse(weigh(work, &quadrics, &version, stays, n).0));
        }
        if work.faces() % 4096 < 2 {
            progress(work.faces());
        }
    }
}
