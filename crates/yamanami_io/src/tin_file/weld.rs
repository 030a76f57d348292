//! Vertices of formats that repeat them a triangle: exactly equal places become one vertex, numbered as they come.

use glam::DVec3;
use std::hash::{BuildHasher, RandomState};

const EMPTY: u32 = u32::MAX;

/// Vertices by their place: 24 bytes each, and 8 to 16 for finding them.
#[derive(Debug, Default)]
pub(super) struct Weld {
    positions: Vec<DVec3>,
    /// Open addressing with linear probing: numbers of vertices, a power of two of them, at most half in use.
    table: Vec<u32>,
    /// Seeded by chance, so that no file can be made to collide; numbers do not depend on it.
    hasher: RandomState,
}

impl Weld {
    /// The number of the vertex at a place; `None` when there are more than 2³¹.
    pub(super) fn vertex(&mut self, place: DVec3) -> Option<u32> {
        // minus zero is zero
        let place = place + DVec3::ZERO;
        if self.positions.len() * 2 >= self.table.len() {
            self.grow();
        }
        let slot = self.slot(place);
        if self.table[slot] == EMPTY {
            self.table[slot] = u32::try_from(self.positions.len()).ok().filter(|&number| number < 1 << 31)?;
            self.positions.push(place);
        }
        Some(self.table[slot])
    }

    /// The vertices, in the order of their numbers.
    pub(super) fn into_positions(self) -> Vec<DVec3> {
        self.positions
    }

    /// Where a place is or would be.
    fn slot(&self, place: DVec3) -> usize {
        let mask = self.table.len() - 1;
        let mut slot = self.hasher.hash_one(place.to_array().map(f64::to_bits)) as usize & mask;
        while self.table[slot] != EMPTY && self.positions[self.table[slot] as usize] != place {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        self.table = vec![EMPTY; (self.table.len() * 2).max(64)];
        for number in 0..self.positions.len() {
            let slot = self.slot(self.positions[number]);
            self.table[slot] = number as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_are_one_vertex() {
        let mut weld = Weld::default();
        let place = |i: u32| DVec3::new(f64::from(i % 500), -0.0, 0.1 * f64::from(i % 500));
        let numbers: Vec<u32> = (0..2000).map(|i| weld.vertex(place(i)).unwrap()).collect();
        assert!(numbers.iter().enumerate().all(|(i, &n)| n == i as u32 % 500));
        assert_eq!(weld.vertex(DVec3::ZERO), Some(0));
        assert_eq!(weld.into_positions().len(), 500);
    }
}
