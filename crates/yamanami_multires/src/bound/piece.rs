//! Convex pieces of triangles, and how they are cut.

use glam::DVec3;

/// Most corners of a piece.
pub(super) const MOST_CORNERS: usize = 8;

/// A convex part of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    corners: [DVec3; MOST_CORNERS],
    count: u8,
    /// Cuts that made it.
    pub(super) cuts: u8,
    /// The triangle it belongs to, in its tree's order.
    pub(super) face: u32,
    /// A triangle of the other surface nearby, in that tree's order.
    pub(super) near: u32,
    /// `near` is a guess that no cut was made by yet.
    pub(super) is_guess: bool,
}

impl Piece {
    /// A whole triangle.
    pub(super) fn whole(triangle: &[DVec3; 3], face: u32, near: u32) -> Self {
        let mut corners = [DVec3::ZERO; MOST_CORNERS];
        corners[..3].copy_from_slice(triangle);
        Self { corners, count: 3, cuts: 0, face, near, is_guess: true }
    }

    /// A piece of the same triangle without corners yet.
    fn part(&self) -> Self {
        Self { count: 0, cuts: self.cuts.saturating_add(1), ..*self }
    }

    fn push(&mut self, corner: DVec3) {
        self.corners[usize::from(self.count)] = corner;
        self.count += 1;
    }

    /// Its corners in order.
    #[inline]
    pub(super) fn corners(&self) -> &[DVec3] {
        &self.corners[..usize::from(self.count)]
    }

    /// The mean of the corners, and how far the farthest of them is.
    pub(super) fn ball(&self) -> (DVec3, f64) {
        let corners = self.corners();
        let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let radius2 = corners.iter().map(|p| (p - centre).length_squared()).fold(0.0, f64::max);
        (centre, radius2.sqrt())
    }

    /// Cuts by a plane through `place`: the part that `normal` points away from and the part it points to. None where the
    /// plane does not leave at least `least` on both sides, or cutting would need too many corners.
    pub(super) fn cut(&self, place: DVec3, normal: DVec3, least: f64) -> Option<[Self; 2]> {
        let corners = self.corners();
        let count = corners.len();
        let mut sides = [0.0; MOST_CORNERS];
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        for (side, corner) in sides.iter_mut().zip(corners) {
            *side = normal.dot(corner - place);
            (min, max) = (min.min(*side), max.max(*side));
        }
        if !(min < -least && max > least) || count == MOST_CORNERS {
            return None;
        }
        let next = |k: usize| if k + 1 == count { 0 } else { k + 1 };
        // a needle's corners may not look convex any more
        if (0..count).filter(|&k| (sides[k] > 0.0) != (sides[next(k)] > 0.0)).count() != 2 {
            return None;
        }
        let [mut behind, mut before] = [self.part(); 2];
        for k in 0..count {
            let (from, to) = (sides[k], sides[next(k)]);
            if from > 0.0 {
                before.push(corners[k])
            } else {
                behind.push(corners[k])
            }
            if (from > 0.0) != (to > 0.0) {
                let on_plane = corners[k] + (corners[next(k)] - corners[k]) * (from / (from - to));
                before.push(on_plane);
                behind.push(on_plane);
            }
        }
        Some([behind, before])
    }

    /// Cuts across the longest way from corner to corner, or from corner to corner where there are many.
    pub(super) fn halves(&self) -> [Self; 2] {
        let corners = self.corners();
        let mut farthest = (0.0, DVec3::ZERO, DVec3::ZERO);
        for (k, &a) in corners.iter().enumerate() {
            for &b in &corners[k + 1..] {
                let length2 = (b - a).length_squared();
                if length2 > farthest.0 {
                    farthest = (length2, a, b);
                }
            }
        }
        let (length2, a, b) = farthest;
        if let Some(halves) = self.cut((a + b) * 0.5, b - a, length2 * 0.1) {
            return halves;
        }
        let [mut left, mut right] = [self.part(); 2];
        let middle = corners.len() / 2;
        corners[..=middle].iter().for_each(|&p| left.push(p));
        corners[middle..].iter().chain(&corners[..1]).for_each(|&p| right.push(p));
        [left, right]
    }
}
