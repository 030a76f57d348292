//! Vertices at one position are one place: what topology is judged by, so that seams and unshared vertices are no holes.

use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// For each vertex the first of those at its position.
pub(crate) fn places(mesh: &TriangleMesh) -> Vec<u32> {
    let bits = |i: u32| (mesh.positions[i as usize] + DVec3::ZERO).to_array().map(f64::to_bits); // -0 and 0 are equal
    // sorting short numbers is several times faster than sorting positions; what shares one is compared below
    let mut order: Vec<(u64, u32)> =
        (0..mesh.positions.len() as u32).into_par_iter().map(|i| (mixed(bits(i)), i)).collect();
    order.par_sort_unstable();
    let mut place = vec![0; mesh.positions.len()];
    let mut firsts: Vec<u32> = Vec::new();
    for run in order.chunk_by(|a, b| a.0 == b.0) {
        firsts.clear();
        for &(_, i) in run {
            let first = firsts.iter().copied().find(|&first| bits(first) == bits(i));
            place[i as usize] = first.unwrap_or(i);
            if first.is_none() {
                firsts.push(i);
            }
        }
    }
    place
}

/// How many places triangles use.
pub(crate) fn used(mesh: &TriangleMesh, place: &[u32]) -> usize {
    let mut used = vec![false; mesh.positions.len()];
    for &i in mesh.triangles.iter().flatten() {
        used[place[i as usize] as usize] = true;
    }
    used.iter().filter(|&&u| u).count()
}

/// A number in which every bit of the three has a part.
///
/// Based on: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014.
fn mixed(bits: [u64; 3]) -> u64 {
    bits.into_iter().fold(0, |sum, b| {
        let mut z = (sum ^ b).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}
