//! The triangles of a semi-regular mesh's levels.

use super::SemiRegular;

impl SemiRegular {
    /// The triangles of a level's mesh, counter-clockwise, base triangle by base triangle, row by row.
    pub fn triangles(&self, level: u32) -> Vec<[u32; 3]> {
        let mut all = Vec::with_capacity(self.triangle_count(level) as usize);
        for face in 0..self.base().triangles().len() as u32 {
            self.for_triangles_of(level, face, |corners| all.push(corners));
        }
        all
    }

    /// The triangles of a level's mesh within one base triangle, row by row.
    pub fn for_triangles_of(&self, level: u32, face: u32, mut found: impl FnMut([u32; 3])) {
        let size = 1u32 << level;
        let mut below: Vec<u32> = (0..=size).map(|a| self.vertex(level, face, [a, 0])).collect();
        for b in 1..=size {
            let above: Vec<u32> = (0..=size - b).map(|a| self.vertex(level, face, [a, b])).collect();
            for a in 0..above.len() {
                found([below[a], below[a + 1], above[a]]);
                if a + 1 < above.len() {
                    found([below[a + 1], above[a + 1], above[a]]);
                }
            }
            below = above;
        }
    }
}
