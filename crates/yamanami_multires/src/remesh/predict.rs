//! Where a new vertex is expected, from the mesh of the level below.
//!
//! Based on: Dyn, Levin, Gregory, "A butterfly subdivision scheme for surface interpolation with tension control", 1990; Zorin,
//! Schröder, Sweldens, "Interpolating subdivision for meshes with arbitrary topology", 1996 (around extraordinary vertices).

use glam::DVec3;
use std::f64::consts::TAU;
use yamanami_core::SemiRegular;

/// Rings of both ends of an edge.
#[derive(Debug, Default)]
pub(super) struct Rings {
    of: [Vec<u32>; 2],
}

impl Rings {
    /// The place expected between two neighbours of a level's mesh.
    pub(super) fn predict(&mut self, topology: &SemiRegular, level: u32, ends: [u32; 2], positions: &[DVec3]) -> DVec3 {
        let of = &mut self.of;
        let is_closed = [0, 1].map(|k| topology.ring(level, ends[k], &mut of[k]));
        let [ring_a, ring_b] = &*of;
        let [a, b] = ends.map(|v| positions[v as usize]);
        let middle = (a + b) * 0.5;
        let at = |v: u32| positions[v as usize];
        let place_in = |ring: &[u32], other: u32| ring.iter().position(|&n| n == other);
        let [Some(i), Some(j)] = [place_in(ring_a, ends[1]), place_in(ring_b, ends[0])] else { return middle };
        let is_side = |ring: &[u32], k: usize| k == 0 || k + 1 == ring.len();
        match is_closed {
            [true, true] if ring_a.len() == 6 && ring_b.len() == 6 => {
                let around = |k: usize| at(ring_a[(i + k) % 6]);
                let beyond = |k: usize| at(ring_b[(j + k) % 6]);
                let wings = around(2) + around(4) + beyond(2) + beyond(4);
                middle + (around(1) + around(5)) * 0.125 - wings * 0.0625
            }
            [true, true] => {
                let from_a = (ring_a.len() != 6).then(|| extraordinary(a, ring_a, i, positions));
                let from_b = (ring_b.len() != 6).then(|| extraordinary(b, ring_b, j, positions));
                match (from_a, from_b) {
                    (Some(p), Some(q)) => (p + q) * 0.5,
                    (p, q) => p.or(q).unwrap_or(middle),
                }
            }
            [true, false] => extraordinary(a, ring_a, i, positions),
            [false, true] => extraordinary(b, ring_b, j, positions),
            [false, false] if is_side(ring_a, i) && is_side(ring_b, j) => {
                let other = |ring: &[u32], k: usize| at(if k == 0 { ring[ring.len() - 1] } else { ring[0] });
                middle * 1.125 - (other(ring_a, i) + other(ring_b, j)) * 0.0625
            }
            [false, false] => middle,
        }
    }
}

/// From one end's neighbours, the other end being neighbour `first`.
fn extraordinary(centre: DVec3, ring: &[u32], first: usize, positions: &[DVec3]) -> DVec3 {
    let n = ring.len();
    let weight = |k: usize| match (n, k) {
        (3, 0) => 5.0 / 12.0,
        (3, _) => -1.0 / 12.0,
        (4, 0) => 0.375,
        (4, 2) => -0.125,
        (4, _) => 0.0,
        _ => {
            let turn = TAU * k as f64 / n as f64;
            (0.25 + turn.cos() + 0.5 * (2.0 * turn).cos()) / n as f64
        }
    };
    let around: DVec3 = (0..n).map(|k| positions[ring[(first + k) % n] as usize] * weight(k)).sum();
    centre * 0.75 + around
}
