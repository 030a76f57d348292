//! Topology of the triangle quadtree on the clamped lattice. Knows no height.
//!
//! A triangle is half a lattice square. Its corners are called R (right angle), P and Q (ends of the hypotenuse), so
//! that R, P, Q run counter-clockwise seen from above; half 0 is the upper right one (rows run south), half 1 is half 0
//! turned by 180 degrees. Its midpoints are h (of PQ), p (of PR) and q (of QR), points of the next finer lattice.

use yamanami_core::{Lattice, LatticeNode};

/// A triangle of the quadtree: half a square of side `2^level` samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Triangle {
    pub(crate) level: u32,
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) half: u32,
}

/// Points of a triangle by role: R, P, Q and the midpoints h, p, q.
pub(crate) const R: usize = 0;
pub(crate) const P: usize = 1;
pub(crate) const Q: usize = 2;

/// Offsets of (R, P, Q, h, p, q) in half-squares from the square's corner, by half.
const ROLE_OFFSETS: [[(u32, u32); 6]; 2] = [
    [(2, 0), (0, 0), (2, 2), (1, 1), (1, 0), (2, 1)],
    [(0, 2), (2, 2), (0, 0), (1, 1), (1, 2), (0, 1)],
];

/// Squares (in the parent's quarter coordinates) and halves of the four children: at R, P, Q and the inner one.
const CHILDREN: [[(u32, u32, u32); 4]; 2] =
    [[(1, 0, 0), (0, 0, 0), (1, 1, 0), (1, 0, 1)], [(0, 1, 1), (1, 1, 1), (0, 0, 1), (0, 1, 0)]];

impl Triangle {
    #[inline]
    pub(crate) fn exists(self, lattice: &Lattice) -> bool {
        let [nx, ny] = lattice.squares(self.level);
        self.x < nx && self.y < ny
    }

    /// Whether the square reaches past the last column or row, so that corners or midpoints may coincide.
    #[inline]
    pub(crate) fn is_clamped(self, lattice: &Lattice) -> bool {
        (u64::from(self.x) + 1) << self.level > u64::from(lattice.width() - 1)
            || (u64::from(self.y) + 1) << self.level > u64::from(lattice.height() - 1)
    }

    /// Lattice coordinates of the six points (R, P, Q, h, p, q) on the level below; the triangle's level is above 0.
    #[inline]
    pub(crate) fn points(self) -> [LatticeNode; 6] {
        ROLE_OFFSETS[self.half as usize].map(|(dx, dy)| LatticeNode {
            level: self.level - 1,
            x: 2 * self.x + dx,
            y: 2 * self.y + dy,
        })
    }

    /// Grid samples (clamped) of the corners R, P, Q.
    #[inline]
    pub(crate) fn corner_samples(self, lattice: &Lattice) -> [[u32; 2]; 3] {
        let o = &ROLE_OFFSETS[self.half as usize];
        [R, P, Q].map(|role| lattice.sample(self.level, self.x + o[role].0 / 2, self.y + o[role].1 / 2))
    }

    /// The midpoints h, p, q.
    #[inline]
    pub(crate) fn midpoints(self) -> [LatticeNode; 3] {
        let all = self.points();
        [all[3], all[4], all[5]]
    }

    /// The four children: at R, P, Q and the inner one. Only those that exist on the lattice matter.
    #[inline]
    pub(crate) fn children(self) -> [Triangle; 4] {
        CHILDREN[self.half as usize].map(|(dx, dy, half)| Triangle {
            level: self.level - 1,
            x: 2 * self.x + dx,
            y: 2 * self.y + dy,
            half,
        })
    }

    /// The parent, one level coarser.
    #[inline]
    pub(crate) fn parent(self) -> Triangle {
        let half = match (self.x & 1, self.y & 1) {
            (1, 0) => 0,
            (0, 1) => 1,
            _ => self.half,
        };
        Triangle { level: self.level + 1, x: self.x >> 1, y: self.y >> 1, half }
    }
}

/// The triangles (one or two) whose edge a midpoint bisects.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Adjacent {
    triangles: [Triangle; 2],
    len: usize,
}

impl std::ops::Deref for Adjacent {
    type Target = [Triangle];
    #[inline]
    fn deref(&self) -> &[Triangle] {
        &self.triangles[..self.len]
    }
}

/// Existing triangles of side `2^(level+1)` at a midpoint of the lattice of `node.level`.
#[inline]
pub(crate) fn adjacent(node: LatticeNode, lattice: &Lattice) -> Adjacent {
    let level = node.level + 1;
    let (x, y) = (node.x / 2, node.y / 2);
    let candidates = match (node.x & 1, node.y & 1) {
        (1, 0) => [Some((x, y, 0)), y.checked_sub(1).map(|y| (x, y, 1))],
        (0, 1) => [Some((x, y, 1)), x.checked_sub(1).map(|x| (x, y, 0))],
        _ => [Some((x, y, 0)), Some((x, y, 1))],
    };
    let mut out = Adjacent { triangles: [Triangle { level, x: 0, y: 0, half: 0 }; 2], len: 0 };
    for (x, y, half) in candidates.into_iter().flatten() {
        let triangle = Triangle { level, x, y, half };
        if triangle.exists(lattice) {
            out.triangles[out.len] = triangle;
            out.len += 1;
        }
    }
    out
}

/// The two lattice points (same level's coordinates) whose edge a midpoint bisects.
#[inline]
pub(crate) fn edge_ends(node: LatticeNode) -> [LatticeNode; 2] {
    let (dx, dy) = (node.x & 1, node.y & 1);
    [
        LatticeNode { x: node.x - dx, y: node.y - dy, ..node },
        LatticeNode { x: node.x + dx, y: node.y + dy, ..node },
    ]
}

/// Twice the signed area of a triangle of grid samples (columns east, rows south): positive when counter-clockwise seen
/// from above.
#[inline]
pub(crate) fn doubled_area(t: [[u32; 2]; 3]) -> i64 {
    let [a, b, c] = t.map(|[x, y]| (i64::from(x), -i64::from(y)));
    (b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_tile_their_parent_and_know_it() {
        let lattice = Lattice::new(17, 17);
        for half in 0..2 {
            let t = Triangle { level: 3, x: 1, y: 0, half };
            let mut area = 0;
            for c in t.children() {
                assert_eq!(c.parent(), t);
                let a = doubled_area(c.corner_samples(&lattice));
                assert!(a > 0);
                area += a;
            }
            assert_eq!(area, doubled_area(t.corner_samples(&lattice)));
        }
    }

    #[test]
    fn a_midpoint_is_a_midpoint_of_its_adjacent_triangles() {
        let lattice = Lattice::new(13, 22);
        for level in 0..lattice.levels() {
            let [nx, ny] = lattice.points(level);
            for y in 0..ny {
                for x in 0..nx {
                    if x % 2 == 0 && y % 2 == 0 {
                        continue;
                    }
                    let node = LatticeNode { level, x, y };
                    let triangles = adjacent(node, &lattice);
                    assert!(!triangles.is_empty());
                    for t in triangles.iter() {
                        assert!(t.midpoints().contains(&node));
                    }
                }
            }
        }
    }
}
