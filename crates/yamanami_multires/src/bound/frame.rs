//! The frame in which distances are bounded: both meshes about one origin, scaled by a power of two into a box of half
//! width one, so that one absolute slack covers all rounding and a model's unit does not matter.

use glam::DVec3;
use yamanami_core::TriangleMesh;

/// What rounding may add to a distance, units. A unit's last bit is 2^-53; shifting a corner into the frame costs half of
/// one a coordinate, a cut of a piece less than six, pieces are cut at most [`MOST_CUTS`] times in a row, and a distance
/// costs less than twenty: 1,560 in all, below 2^-42.
pub(super) const SLACK: f64 = 1.0 / (1u64 << 42) as f64;

/// Cuts in a row until a piece is taken as it is.
pub(super) const MOST_CUTS: u8 = 250;

/// The largest magnitude of the exponent that scales: beyond it a model is too large or too small for its squares.
const MOST_EXPONENT: i32 = 1000;

/// A common origin and scale.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    half_origin: DVec3,
    metres_a_unit: f64,
    /// A power of two, as the other: a product is as good as a quotient, and faster.
    twice_units_a_metre: f64,
}

impl Frame {
    /// The frame of all triangles of some meshes; none where a corner is not finite.
    pub(super) fn around(meshes: &[&TriangleMesh]) -> Option<Self> {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut finite = true;
        for mesh in meshes {
            for &corner in mesh.triangles.as_flattened() {
                let p = mesh.positions[corner as usize];
                finite &= p.is_finite();
                (min, max) = (min.min(p), max.max(p));
            }
        }
        if !finite {
            return None;
        }
        if min.x > max.x {
            (min, max) = (DVec3::ZERO, DVec3::ZERO);
        }
        // halves first: the difference of the largest numbers is not finite
        let half_origin = min * 0.25 + max * 0.25;
        let half = (max * 0.5 - min * 0.5).max_element();
        let exponent = if half > 0.0 { half.log2().ceil() as i32 } else { 0 };
        let metres_a_unit = f64::from(exponent.clamp(-MOST_EXPONENT, MOST_EXPONENT)).exp2();
        Some(Self { half_origin, metres_a_unit, twice_units_a_metre: 2.0 / metres_a_unit })
    }

    /// The same with room for twice the size.
    pub(super) fn twice(self) -> Self {
        Self { metres_a_unit: self.metres_a_unit * 2.0, twice_units_a_metre: self.twice_units_a_metre * 0.5, ..self }
    }

    /// Whether all triangles of a mesh have a place in it.
    pub(super) fn holds(&self, mesh: &TriangleMesh) -> bool {
        let corners = mesh.triangles.as_flattened().iter();
        corners.map(|&v| self.unit(mesh.positions[v as usize])).all(|p| p.abs().max_element() <= 1.0)
    }

    /// A place in the frame.
    pub(super) fn unit(&self, place: DVec3) -> DVec3 {
        (place * 0.5 - self.half_origin) * self.twice_units_a_metre
    }

    /// A place of the frame in metres.
    pub(super) fn metres(&self, unit: DVec3) -> DVec3 {
        (unit * (0.5 * self.metres_a_unit) + self.half_origin) * 2.0
    }

    /// A length in the frame.
    pub(super) fn length_in_units(&self, metres: f64) -> f64 {
        metres / self.metres_a_unit
    }

    /// A length of the frame in metres.
    pub(super) fn length_in_metres(&self, units: f64) -> f64 {
        units * self.metres_a_unit
    }

    /// The least length in metres that is sure to be no less than this one.
    pub(super) fn upper_m(&self, units: f64) -> f64 {
        // halving a subnormal loses its last bit
        (units + SLACK) * self.metres_a_unit + f64::MIN_POSITIVE
    }

    /// A length in metres that is sure to be no more than this one.
    pub(super) fn lower_m(&self, units: f64) -> f64 {
        ((units - SLACK) * self.metres_a_unit - f64::MIN_POSITIVE).max(0.0)
    }
}
