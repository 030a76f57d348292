//! The neighbours of a vertex of a semi-regular mesh.

use super::{Place, SemiRegular};

/// The six steps of the lattice, counter-clockwise.
pub(super) const STEPS: [[i32; 2]; 6] = [[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]];

impl SemiRegular {
    /// The neighbours of a vertex in a level's mesh, counter-clockwise, into `found`. Gives whether they go all around; else they go
    /// from one border edge to the other. The vertex is one of that level's mesh.
    pub fn ring(&self, level: u32, vertex: u32, found: &mut Vec<u32>) -> bool {
        found.clear();
        let own = self.level_of(vertex);
        let scale = level - own;
        match self.place(vertex) {
            Place::Face { face, at } => {
                found.extend((0..6).map(|step| self.step(level, face, at.map(|v| v << scale), step)));
                true
            }
            Place::Edge { edge, at } => {
                let size = 1 << level;
                let edge = self.base().edges()[edge as usize];
                self.wedge(level, edge.left, at << scale, found);
                if let Some(right) = edge.right {
                    found.pop();
                    self.wedge(level, right, size - (at << scale), found);
                    found.pop();
                }
                edge.right.is_some()
            }
            Place::Base => {
                let fan = self.base().fan(vertex);
                for &corner in fan {
                    found.pop();
                    self.wedge(level, corner, 0, found);
                }
                let is_closed = !self.base().is_on_border(vertex);
                if is_closed {
                    found.pop();
                }
                is_closed
            }
        }
    }

    /// The neighbours in one base triangle of the vertex `at` steps along a side, from the side on to where the triangle ends.
    fn wedge(&self, level: u32, (face, side): (u32, u8), at: u32, found: &mut Vec<u32>) {
        let size = 1u32 << level;
        let place = match side {
            0 => [at, 0],
            1 => [size - at, at],
            _ => [0, size - at],
        };
        let last = if at == 0 { 1 } else { 3 };
        let first = 2 * usize::from(side);
        found.extend((first..=first + last).map(|step| self.step(level, face, place, step % 6)));
    }

    fn step(&self, level: u32, face: u32, [a, b]: [u32; 2], step: usize) -> u32 {
        let [da, db] = STEPS[step];
        self.vertex(level, face, [a.wrapping_add_signed(da), b.wrapping_add_signed(db)])
    }
}
