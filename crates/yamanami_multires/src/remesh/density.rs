//! How dense a net should lie: more vertices where the surface is bent.
//!
//! Based on: Nadler, "Piecewise linear best L2 approximation on triangulations", 1986 (for the least squared error edges are as
//! long as the bend to the power -1/3).

use glam::DVec3;

/// What the bend is taken to, and how far the densities may be from that where the bend is as in the mean.
const POWER: f64 = 0.5;
const LEAST: f64 = 1.0;
const MOST: f64 = 2.3;

/// Rounds of smoothing.
const ROUNDS: usize = 10;

/// The densities at each vertex, from the unit normals there.
pub(super) fn densities(positions: &[DVec3], normals: &[DVec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut turns = vec![[0.0; 2]; positions.len()];
    let mut all = [0.0; 2];
    for t in triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(a, b)| (a as usize, b as usize)) {
            let own = [normals[a].distance(normals[b]), positions[a].distance(positions[b])];
            for k in 0..2 {
                turns[a][k] += own[k];
                turns[b][k] += own[k];
                all[k] += own[k];
            }
        }
    }
    let bend = |[turn, length]: [f64; 2]| if length > 0.0 { turn / length } else { 0.0 };
    let mean = bend(all).max(f64::MIN_POSITIVE);
    let mut densities: Vec<f64> = turns.iter().map(|&t| (bend(t) / mean).powf(POWER)).collect();
    for _ in 0..ROUNDS {
        let mut sums = vec![[0.0; 2]; positions.len()];
        for t in triangles {
            let sum: f64 = t.iter().map(|&v| densities[v as usize]).sum();
            for &v in t {
                sums[v as usize][0] += sum;
                sums[v as usize][1] += 3.0;
            }
        }
        densities.iter_mut().zip(&sums).for_each(|(d, [sum, count])| *d = if *count > 0.0 { sum / count } else { *d });
    }
    densities.iter_mut().for_each(|d| *d = d.clamp(LEAST, MOST));
    densities
}
