//! Coordinates that come back bit for bit: steps on a lattice, and what is left between the steps.
//!
//! A survey is a document: a TIN's vertices are stored exactly. Most lie on a lattice of decimals and need nothing more
//! than the steps; of others the difference is kept, counted in representable numbers.

use super::vertices::Packed;
use crate::store::bits::{put_varint, take_varint};
use yamanami_core::{ClusterVertex, Snap};

/// The lattice of a TIN's vertices, and where its steps are counted from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Exact {
    snap: Snap,
    first: [f64; 3],
}

/// No vertex is on the lattice's step unless said so.
const ALL_ON_STEPS: u8 = 0;
const BETWEEN_STEPS: u8 = 1;

/// The place of a number among all that can be represented.
fn rank(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    if bits < 0 { i64::MIN.wrapping_sub(bits) } else { bits }
}

fn of_rank(rank: i64) -> f64 {
    f64::from_bits(if rank < 0 { i64::MIN.wrapping_sub(rank) } else { rank } as u64)
}

impl Exact {
    pub(super) fn new(snap: Snap, least_m: [f64; 3]) -> Self {
        Self { snap, first: least_m.map(|x| snap.steps(x)) }
    }

    /// The steps of a place; `None` when it is too far out or no number.
    pub(super) fn steps(&self, position_m: [f64; 3]) -> Option<[i32; 3]> {
        let mut place = [0; 3];
        for axis in 0..3 {
            let steps = self.snap.steps(position_m[axis]) - self.first[axis];
            if steps.is_nan() || steps.abs() >= f64::from(1 << 30) {
                return None;
            }
            place[axis] = steps as i32;
        }
        Some(place)
    }

    pub(super) fn position(&self, place: [i32; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| self.snap.metres(self.first[axis] + f64::from(place[axis])) + 0.0)
    }

    /// What is left of each vertex's coordinates.
    pub(super) fn rests(&self, vertices: &[ClusterVertex], packed: &[Packed]) -> Vec<u8> {
        let rest = |(vertex, packed): (&ClusterVertex, &Packed)| {
            let near = self.position(packed.place);
            std::array::from_fn::<i64, 3, _>(|axis| {
                // adding zero makes -0 and 0 one
                rank(vertex.position_m[axis] + 0.0).wrapping_sub(rank(near[axis]))
            })
        };
        let rests: Vec<[i64; 3]> = vertices.iter().zip(packed).map(rest).collect();
        if rests.iter().all(|rest| *rest == [0; 3]) {
            return vec![ALL_ON_STEPS];
        }
        let mut bytes = vec![BETWEEN_STEPS];
        for &rest in rests.as_flattened() {
            put_varint(&mut bytes, ((rest << 1) ^ (rest >> 63)) as u64);
        }
        bytes
    }

    /// Puts the rests back; `None` when they are damaged.
    pub(super) fn add_rests(&self, mut bytes: &[u8], vertices: &mut [ClusterVertex]) -> Option<()> {
        let (&kind, rest) = bytes.split_first()?;
        bytes = rest;
        if kind == BETWEEN_STEPS {
            for vertex in vertices {
                let place = self.steps(vertex.position_m);
                for x in &mut vertex.position_m {
                    let zigzag = take_varint(&mut bytes)?;
                    *x = of_rank(rank(*x).wrapping_add((zigzag >> 1) as i64 ^ -((zigzag & 1) as i64)));
                    x.is_finite().then_some(())?;
                }
                // what is left is less than a step
                (self.steps(vertex.position_m) == place).then_some(())?;
            }
        }
        (kind <= BETWEEN_STEPS && bytes.is_empty()).then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_in_order_and_come_back() {
        let numbers = [-1e300, -2.0, -1.0, -f64::MIN_POSITIVE, 0.0, 5e-324, 1.0, 1.0f64.next_up(), 7e200];
        assert!(numbers.windows(2).all(|w| rank(w[0]) < rank(w[1])));
        assert!(numbers.iter().all(|&x| of_rank(rank(x)).to_bits() == x.to_bits()));
        assert_eq!(rank(1.0f64.next_up()) - rank(1.0), 1);
    }
}
