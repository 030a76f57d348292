//! The last step: vertices leave the source a little, along its normals, so that the triangles between them lie as close to it as
//! they can. With its vertices on the source a mesh cuts off all that is round, on the same side everywhere.
//!
//! Idea: Hoppe, DeRose, Duchamp, McDonald, Stuetzle, "Mesh Optimization", 1993 (vertices at the least sum of squares); here the
//! triangles stay and each vertex has one unknown.

use super::net::Net;
use super::source::blend;
use super::walk;
use glam::DVec3;
use rayon::prelude::*;

/// Where triangles are measured: points of equal weight that give the integral of a square of what is linear.
const POINTS: [[f64; 3]; 3] = [
    [2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
];

/// Times that distances are measured anew, and steps of descent between.
const ROUNDS: usize = 2;
const STEPS: usize = 8;

/// The farthest that a vertex goes, in lengths of the shortest edge around.
const FARTHEST: f64 = 0.2;

/// Gives each vertex's place near the source.
pub(super) fn fit(net: &Net<'_>) -> Vec<DVec3> {
    let triangles = net.topology.triangles(net.level);
    let mut limits = vec![f64::INFINITY; net.positions.len()];
    for t in &triangles {
        for k in 0..3 {
            let ends = [t[k], t[(k + 1) % 3]].map(|v| v as usize);
            let length = FARTHEST * net.positions[ends[0]].distance(net.positions[ends[1]]);
            ends.iter().for_each(|&v| limits[v] = limits[v].min(length));
        }
    }
    (0..net.positions.len() as u32).filter(|&v| net.is_border(v)).for_each(|v| limits[v as usize] = 0.0);
    let mut heights = vec![0.0; net.positions.len()];
    for _ in 0..ROUNDS {
        let at = |v: u32| net.positions[v as usize] + net.normals[v as usize] * heights[v as usize];
        let mut gaps: Vec<[f64; 3]> = triangles.par_iter().map(|t| gaps(net, t, t.map(at))).collect();
        for _ in 0..STEPS {
            step(net, &triangles, &mut gaps, &mut heights, &limits);
        }
    }
    net.positions.iter().zip(&net.normals).zip(&heights).map(|((&p, &n), &h)| p + n * h).collect()
}

/// How far below the source a triangle's points lie, along its normal there.
fn gaps(net: &Net<'_>, t: &[u32; 3], corners: [DVec3; 3]) -> [f64; 3] {
    let own = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
    std::array::from_fn(|k| {
        let at = blend(corners, POINTS[k]);
        let found = walk::descend(net.source, net.places[t[k] as usize], at);
        let normal = net.source.normal(found.place);
        if normal.dot(own) < 0.5 { 0.0 } else { (found.position - at).dot(normal) }
    })
}

/// One step: each vertex goes by the mean of the gaps around, and the gaps shrink by what it takes of them.
fn step(net: &Net<'_>, triangles: &[[u32; 3]], gaps: &mut [[f64; 3]], heights: &mut [f64], limits: &[f64]) {
    let mut sums = vec![[0.0; 2]; heights.len()];
    for (t, gaps) in triangles.iter().zip(gaps.iter()) {
        let [a, b, c] = t.map(|v| net.positions[v as usize]);
        let area = (b - a).cross(c - a).length();
        for k in 0..3 {
            let sum = &mut sums[t[k] as usize];
            sum[0] += area * (0..3).map(|point| POINTS[point][k] * gaps[point]).sum::<f64>();
            sum[1] += area;
        }
    }
    let moves: Vec<f64> = (0..heights.len())
        .map(|v| {
            let [sum, area] = sums[v];
            let wanted = if area > 0.0 { heights[v] + sum / area } else { 0.0 };
            let before = std::mem::replace(&mut heights[v], wanted.clamp(-limits[v], limits[v]));
            heights[v] - before
        })
        .collect();
    for (t, gaps) in triangles.iter().zip(gaps) {
        let own = t.map(|v| moves[v as usize]);
        for point in 0..3 {
            gaps[point] -= (0..3).map(|k| POINTS[point][k] * own[k]).sum::<f64>();
        }
    }
}
