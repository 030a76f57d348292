//! Where a new vertex is foretold.
//!
//! Based on: Dyn, Levin, Gregory, "A butterfly subdivision scheme for surface interpolation with tension control", 1990; Zorin,
//! Schröder, Sweldens, "Interpolating subdivision for meshes with arbitrary topology", 1996. Where we differ: an inner edge with one
//! end on the border is foretold from its other end alone, one with both from the midpoint.

use super::rings::Rings;
use glam::DVec3;
use yamanami_core::Predictor;

/// Valences with weights at hand; others are worked out.
const VALENCES: usize = 16;

/// Foretells midpoints of a level's edges.
#[derive(Debug)]
pub(super) struct Prediction {
    predictor: Predictor,
    /// Weights of the ring around a vertex by valence, from the edge's other end on.
    weights: Vec<Vec<f64>>,
}

fn ring_weights(valence: usize) -> Vec<f64> {
    let n = valence as f64;
    match valence {
        3 => vec![5.0 / 12.0, -1.0 / 12.0, -1.0 / 12.0],
        4 => vec![0.375, 0.0, -0.125, 0.0],
        _ => (0..valence)
            .map(|j| {
                let angle = std::f64::consts::TAU * j as f64 / n;
                (0.25 + angle.cos() + 0.5 * (2.0 * angle).cos()) / n
            })
            .collect(),
    }
}

impl Prediction {
    pub(super) fn new(predictor: Predictor) -> Self {
        Self { predictor, weights: (0..VALENCES).map(ring_weights).collect() }
    }

    /// Where the midpoint of the edge between two vertices is foretold.
    #[inline]
    pub(super) fn at(&self, rings: &Rings, positions: &[DVec3], [p, q]: [u32; 2]) -> DVec3 {
        let [at_p, at_q] = [p, q].map(|v| positions[v as usize]);
        let middle = 0.5 * (at_p + at_q);
        if self.predictor == Predictor::Hat {
            return middle;
        }
        let (around_p, p_is_inner) = rings.of(p);
        let (around_q, q_is_inner) = rings.of(q);
        let place = |ring: &[u32], v: u32| ring.iter().position(|&n| n == v).unwrap_or(0);
        let (i, j) = (place(around_p, q), place(around_q, p));
        let get = |ring: &[u32], k: usize| positions[ring[k % ring.len()] as usize];
        if p_is_inner && q_is_inner && around_p.len() == 6 && around_q.len() == 6 {
            let wings = get(around_p, i + 1) + get(around_p, i + 5);
            let outer = get(around_p, i + 2) + get(around_p, i + 4) + get(around_q, j + 2) + get(around_q, j + 4);
            return middle + 0.125 * wings - 0.0625 * outer;
        }
        let from_one = |v: DVec3, ring: &[u32], k: usize| {
            let own;
            let weights = match self.weights.get(ring.len()) {
                Some(weights) => weights,
                None => {
                    own = ring_weights(ring.len());
                    &own
                }
            };
            let mut sum = 0.75 * v;
            for (n, w) in weights.iter().enumerate() {
                sum += *w * get(ring, k + n);
            }
            sum
        };
        match (p_is_inner, q_is_inner) {
            (true, true) if around_p.len() == 6 => from_one(at_q, around_q, j),
            (true, true) if around_q.len() == 6 => from_one(at_p, around_p, i),
            (true, true) => 0.5 * (from_one(at_p, around_p, i) + from_one(at_q, around_q, j)),
            (true, false) => from_one(at_p, around_p, i),
            (false, true) => from_one(at_q, around_q, j),
            (false, false) => {
                // along the border the next vertex on either side is the other end of the ring
                let beyond = |ring: &[u32], k: usize| match k {
                    0 => ring.last().copied(),
                    k if k + 1 == ring.len() => ring.first().copied(),
                    _ => None,
                };
                match (beyond(around_p, i), beyond(around_q, j)) {
                    (Some(a), Some(b)) => 1.125 * middle - 0.0625 * (positions[a as usize] + positions[b as usize]),
                    _ => middle,
                }
            }
        }
    }
}
