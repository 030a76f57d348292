//! A triangle of the mesh, in plan: split, owned samples, keys. It never sees a height.
//!
//! Every point of the plane has one owner among the triangles of a front: when a triangle is split, the first half takes
//! the line between them, and both keep of the old edges what was the whole triangle's. So samples on edges and corners are
//! counted once, and a new vertex comes with one of its two triangles.

use super::diamonds::Place;
use yamanami_core::TriangleKey;

/// Three corners, counter-clockwise: the ends of the longest edge, then the right-angled corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Triangle {
    pub(super) corners: [Place; 3],
    /// Whether it owns the insides of the longest edge and of the two others in their order.
    edges: [bool; 3],
    /// Whether it owns its corners.
    ends: [bool; 3],
}

impl Triangle {
    /// The eight base triangles of a square of this half side: its halves along a diagonal, split twice.
    pub(super) fn base(half_side: i32) -> [Self; 8] {
        let h = half_side;
        let south_east = Self { corners: [[h, h], [-h, -h], [h, -h]], edges: [true; 3], ends: [true; 3] };
        let north_west =
            Self { corners: [[-h, -h], [h, h], [-h, h]], edges: [false, true, true], ends: [false, false, true] };
        let quarters = [south_east.split(), north_west.split()].concat();
        let mut out = [south_east; 8];
        for (pair, quarter) in out.chunks_exact_mut(2).zip(quarters) {
            pair.copy_from_slice(&quarter.split());
        }
        out
    }

    /// The middle of the longest edge: the place of the node that splits it.
    #[inline]
    pub(super) fn middle(&self) -> Place {
        let [a, b, _] = self.corners;
        [(a[0] + b[0]) >> 1, (a[1] + b[1]) >> 1]
    }

    /// Its two halves.
    #[inline]
    pub(super) fn split(&self) -> [Self; 2] {
        let ([a, b, c], m, [ab, bc, ca], ends) = (self.corners, self.middle(), self.edges, self.ends);
        [
            Self { corners: [c, a, m], edges: [ca, ab, true], ends: [ends[2], ends[0], ab] },
            Self { corners: [b, c, m], edges: [bc, false, ab], ends: [ends[1], false, false] },
        ]
    }

    /// Whether it owns its longest edge.
    #[inline]
    pub(super) fn owns_longest(&self) -> bool {
        self.edges[0]
    }

    /// Which half holds a place.
    #[inline]
    pub(super) fn half_at(&self, [x, y]: [f64; 2]) -> usize {
        let ([cx, cy], [mx, my]) = (self.corners[2], self.middle());
        let across = f64::from(mx - cx) * (y - f64::from(cy)) - f64::from(my - cy) * (x - f64::from(cx));
        usize::from(across > 0.0)
    }

    /// Whether a place lies in it or on its border.
    pub(super) fn holds(&self, place: [f64; 2]) -> bool {
        self.weights(place).into_iter().all(|w| w >= 0.0)
    }

    /// Barycentric coordinates of a place.
    pub(super) fn weights(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let corner = |i: usize| self.corners[i % 3].map(f64::from);
        let twice = |i: usize| {
            let ([px, py], [qx, qy]) = (corner(i + 1), corner(i + 2));
            (qx - px) * (y - py) - (qy - py) * (x - px)
        };
        let parts = [0, 1, 2].map(twice);
        parts.map(|part| part / (parts[0] + parts[1] + parts[2]))
    }

    /// Least and greatest coordinate of its corners.
    #[inline]
    pub(super) fn extent(&self, axis: usize) -> [i32; 2] {
        let [a, b, c] = self.corners.map(|p| p[axis]);
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// Whether a place is its own.
    #[inline]
    pub(super) fn owns(&self, [x, y]: Place) -> bool {
        if let Some(i) = self.corners.iter().position(|&c| c == [x, y]) {
            return self.ends[i];
        }
        (0..3).all(|i| {
            let (p, q) = (self.corners[i], self.corners[(i + 1) % 3]);
            // edges run along axes and diagonals: the signs of the direction say as much as the vector
            let [dx, dy] = [(q[0] - p[0]).signum(), (q[1] - p[1]).signum()];
            let across = dx * (y - p[1]) - dy * (x - p[0]);
            across > 0 || (across == 0 && self.edges[i])
        })
    }

    /// Key of a triangle with the given middle of its longest edge and right-angled corner.
    #[inline]
    pub(super) fn key(middle: Place, apex: Place) -> TriangleKey {
        // coordinates lie within ±2^28
        let [x, y] = middle.map(|v| (v + (1 << 30)) as u64);
        (y << 31 | x) << 1 | u64::from(apex > middle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_testkit::Rng;

    #[test]
    fn every_place_has_one_owner() {
        let mut rng = Rng::new(5);
        let mut front = Triangle::base(16).to_vec();
        for _ in 0..40 {
            let t = front.swap_remove(rng.below(front.len()));
            front.extend(t.split());
        }
        for (y, x) in (-16..=16).flat_map(|y| (-16..=16).map(move |x| (y, x))) {
            let owners = front.iter().filter(|t| t.owns([x, y])).count();
            assert_eq!(owners, 1, "{x} {y}");
        }
        for t in Triangle::base(16) {
            for (t, half) in (0..2).map(|i| (t, t.split()[i])) {
                let [x, y] = [0, 1].map(|i| half.corners.iter().map(|c| f64::from(c[i])).sum::<f64>() / 3.0);
                assert_eq!(t.split()[t.half_at([x, y])], half);
            }
        }
    }
}
