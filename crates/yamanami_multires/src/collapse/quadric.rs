//! The sum of squared distances to planes, as a function of place.
//!
//! Based on: Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997.

use glam::{DMat3, DVec3};
use std::ops::{Add, AddAssign};

/// q(p) = pᵀAp + 2b·p + c, with A symmetric.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Quadric {
    /// xx, yy, zz.
    diagonal: DVec3,
    /// yz, xz, xy.
    mixed: DVec3,
    b: DVec3,
    c: f64,
}

impl Quadric {
    /// `weight` times the squared distance to the plane n·p + d = 0.
    #[inline]
    pub(crate) fn plane(normal: DVec3, d: f64, weight: f64) -> Self {
        let weighted = normal * weight;
        Self {
            diagonal: weighted * normal,
            mixed: DVec3::new(weighted.y * normal.z, weighted.x * normal.z, weighted.x * normal.y),
            b: weighted * d,
            c: weight * d * d,
        }
    }

    fn times(&self, p: DVec3) -> DVec3 {
        DVec3::new(
            self.diagonal.x * p.x + self.mixed.z * p.y + self.mixed.y * p.z,
            self.mixed.z * p.x + self.diagonal.y * p.y + self.mixed.x * p.z,
            self.mixed.y * p.x + self.mixed.x * p.y + self.diagonal.z * p.z,
        )
    }

    /// The value at a place; rounding never makes it negative.
    #[inline]
    pub(crate) fn at(&self, p: DVec3) -> f64 {
        (p.dot(self.times(p) + 2.0 * self.b) + self.c).max(0.0)
    }

    /// The place of the least value; `None` where planes leave it open.
    pub(super) fn minimum(&self) -> Option<DVec3> {
        let a = DMat3::from_cols(
            DVec3::new(self.diagonal.x, self.mixed.z, self.mixed.y),
            DVec3::new(self.mixed.z, self.diagonal.y, self.mixed.x),
            DVec3::new(self.mixed.y, self.mixed.x, self.diagonal.z),
        );
        let scale = self.diagonal.element_sum();
        let determinant = a.determinant();
        // beyond a condition of about 10⁶ the place is noise
        (determinant > 1e-9 * scale * scale * scale / 27.0).then(|| a.inverse() * -self.b)
    }

    /// The place of the least value on the segment from `a` to `b`.
    pub(super) fn minimum_between(&self, a: DVec3, b: DVec3) -> DVec3 {
        let along = b - a;
        let curvature = along.dot(self.times(along));
        if curvature <= 0.0 {
            return 0.5 * (a + b);
        }
        let t = -along.dot(self.times(a) + self.b) / curvature;
        a + along * t.clamp(0.0, 1.0)
    }
}

impl AddAssign for Quadric {
    fn add_assign(&mut self, other: Self) {
        self.diagonal += other.diagonal;
        self.mixed += other.mixed;
        self.b += other.b;
        self.c += other.c;
    }
}

impl Add for Quadric {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}
