//! The deformed map: near the centre a plain map, far away a panorama, in one picture.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (the eye moved to the
//! ring, equation (3)); Okajima et al., 2008; Zorin, Barr, "Correction of geometric perceptual distortions in
//! pictures", 1995 (plane and sphere mixed by α). Their printed equations have lost factors; docs/decisions/0017 says
//! what is used here. Where we differ: curvature and refraction are in it, the ring joins smoothly by choice, and what
//! a height or a coarse triangle does to the picture is bounded ([`DeformedMap::error_bound`]).
//!
//! With horizontal distance r from the centre, d = r − D_R, Z the depth below the eye and D = √(d² + Z²), a point of
//! azimuth θ is drawn at ρ·(sin θ, cos θ), where
//!
//! ```text
//! near (r ≤ D_R):  ρ = r / D_R
//! far  (r > D_R):  ρ = α·r / D_R + (1 − α)·(1 + s·d / (D + Z))
//! ```

mod bound;
mod inverse;
mod view;

pub use bound::Patch;
pub use view::MapView;

use glam::{DVec2, DVec3};

/// Radius of the Earth in metres, for the drop below the tangent plane.
pub const EARTH_RADIUS_M: f64 = 6_371_000.0;

/// From where the ground falls away below the tangent plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DropFrom {
    /// From the ring, above which the eye of each azimuth stands: the picture's own geometry.
    #[default]
    Ring,
    /// From the centre: what a viewer standing there sees.
    Centre,
}

/// The Earth's curvature, lessened by refraction: far ground lies (1 − k)·d² / 2R lower.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// k, the bending of light as a share of the Earth's curvature; 0.13 is usual, 0 is none.
    pub refraction: f64,
    /// Where distance counts from.
    pub from: DropFrom,
}

/// A deformed map over the plane around its centre, x east and y north, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeformedMap {
    /// The centre in the plane, metres.
    pub centre: DVec2,
    /// D_R: radius of the plain map, metres.
    pub ring_m: f64,
    /// Height of the eye above sea, metres (of exaggerated heights).
    pub eye_m: f64,
    /// Share of the plane beyond the ring, 0 (sphere, a panorama) to 1 (plane, a map).
    pub alpha: f64,
    /// p: α falls with distance as (D_R / r)^p; 0 keeps it.
    pub alpha_fall: f64,
    /// s: diameter of the sphere; [`DeformedMap::smooth_scale`] joins without a kink.
    pub scale: f64,
    /// Factor on heights (and on the drop), 1 for true ones.
    pub exaggeration: f64,
    /// The Earth's curvature, if it counts.
    pub curvature: Option<Curvature>,
}

/// What is wrong with the numbers of a deformed map.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MapFault {
    /// A number is out of its range: its name, what is expected, what was given.
    Number(&'static str, &'static str, f64),
    /// Ground stands above the eye near the ring, where the picture would tear.
    AboveTheEye {
        /// Where, in the plane.
        at: DVec2,
        /// Its height, exaggerated, metres.
        height_m: f64,
        /// The eye's height, metres.
        eye_m: f64,
    },
}

impl std::fmt::Display for MapFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(name, expected, given) => write!(f, "{name}: expected {expected}, got {given}"),
            Self::AboveTheEye { at, height_m, eye_m } => write!(
                f,
                "eye height: expected above all ground near the ring, got {eye_m:.0} m under ground of {height_m:.0} m, \
                 {:.1} km east and {:.1} km north of the centre; raise the eye, or move the ring or the centre",
                at.x / 1000.0,
                at.y / 1000.0
            ),
        }
    }
}

impl std::error::Error for MapFault {}

impl Default for DeformedMap {
    /// The paper's: ring at 10 km, eye at 5 km, all sphere; smooth.
    fn default() -> Self {
        Self {
            centre: DVec2::ZERO,
            ring_m: 10_000.0,
            eye_m: 5_000.0,
            alpha: 0.0,
            alpha_fall: 0.0,
            scale: 1.0,
            exaggeration: 1.0,
            curvature: None,
        }
    }
}

impl DeformedMap {
    /// The s with which slope and curvature at the ring are those of the plain map, at sea level, for every α.
    pub fn smooth_scale(ring_m: f64, eye_m: f64) -> f64 {
        2.0 * eye_m / ring_m
    }

    /// Checks the numbers; the ground is checked by [`Self::check_ground`].
    pub fn check(&self) -> Result<(), MapFault> {
        let must = |is_right: bool, name, expected, given| {
            if is_right { Ok(()) } else { Err(MapFault::Number(name, expected, given)) }
        };
        let positive = |v: f64| v.is_finite() && v > 0.0;
        must((0.0..=1.0).contains(&self.alpha), "alpha", "0 to 1", self.alpha)?;
        must((0.0..=8.0).contains(&self.alpha_fall), "fall of alpha", "0 to 8", self.alpha_fall)?;
        must(positive(self.ring_m), "ring radius", "above 0 m", self.ring_m)?;
        must(positive(self.eye_m), "eye height", "above 0 m", self.eye_m)?;
        must(positive(self.scale), "sphere scale", "above 0", self.scale)?;
        must(positive(self.exaggeration), "vertical exaggeration", "above 0", self.exaggeration)?;
        must(self.centre.is_finite(), "centre", "finite metres", self.centre.x + self.centre.y)?;
        let k = self.curvature.map_or(0.0, |c| c.refraction);
        must((-1.0..1.0).contains(&k), "refraction", "-1 up to 1", k)
    }

    /// Refuses ground above the eye within a ring's radius of the ring: there ρ runs off to infinity.
    pub fn check_ground(&self, points: impl IntoIterator<Item = DVec3>) -> Result<(), MapFault> {
        for p in points {
            let r_m = (p.truncate() - self.centre).length();
            let is_near = (r_m - self.ring_m).abs() <= self.ring_m;
            if is_near && self.depth_m(r_m, p.z) <= 0.0 {
                let height_m = self.exaggeration * p.z;
                return Err(MapFault::AboveTheEye { at: p.truncate() - self.centre, height_m, eye_m: self.eye_m });
            }
        }
        Ok(())
    }

    /// (1 − k) / R, 0 without curvature; per metre.
    pub(crate) fn bend_per_m(&self) -> f64 {
        self.curvature.map_or(0.0, |c| (1.0 - c.refraction) / EARTH_RADIUS_M)
    }

    /// How far from where the drop counts.
    pub(crate) fn drop_distance_m(&self, r_m: f64) -> f64 {
        match self.curvature {
            Some(Curvature { from: DropFrom::Centre, .. }) => r_m,
            _ => (r_m - self.ring_m).max(0.0),
        }
    }

    /// Drop of the ground below the tangent plane at a distance from the centre, metres.
    pub fn drop_m(&self, r_m: f64) -> f64 {
        let d = self.drop_distance_m(r_m);
        0.5 * self.bend_per_m() * d * d
    }

    /// Z: depth below the eye of ground of height `z_m` at a distance from the centre, metres; negative above it.
    pub fn depth_m(&self, r_m: f64, z_m: f64) -> f64 {
        self.eye_m - self.exaggeration * (z_m - self.drop_m(r_m))
    }

    /// α at a distance from the centre.
    pub fn alpha_at(&self, r_m: f64) -> f64 {
        if self.alpha_fall == 0.0 || r_m <= self.ring_m {
            return self.alpha;
        }
        self.alpha * (self.ring_m / r_m).powf(self.alpha_fall)
    }

    /// tan(φ/2) of the angle φ from straight down at which the eye of an azimuth sees a point: what hides what is
    /// decided by it, the greater lies higher. 0 within the ring, where one looks straight down.
    pub fn half_tangent(&self, r_m: f64, z_m: f64) -> f64 {
        let d = r_m - self.ring_m;
        if d <= 0.0 {
            return 0.0;
        }
        half_tangent(d, self.depth_m(r_m, z_m))
    }

    /// ρ: distance from the picture's centre in radii of the plain map.
    pub fn rho(&self, r_m: f64, z_m: f64) -> f64 {
        if r_m <= self.ring_m {
            return r_m / self.ring_m;
        }
        let alpha = self.alpha_at(r_m);
        alpha * r_m / self.ring_m + (1.0 - alpha) * (1.0 + self.scale * self.half_tangent(r_m, z_m))
    }

    /// ∂ρ/∂z per metre of height: how far a summit leans out.
    pub fn rho_per_height(&self, r_m: f64, z_m: f64) -> f64 {
        let d = r_m - self.ring_m;
        if d <= 0.0 {
            return 0.0;
        }
        let z = self.depth_m(r_m, z_m);
        (1.0 - self.alpha_at(r_m)) * self.scale * self.exaggeration * half_tangent(d, z) / slant(d, z)
    }

    /// Place in the picture of a point of the plane: x right (east), y up (north), in radii of the plain map.
    pub fn image_from_plane(&self, p: DVec3) -> DVec2 {
        let out = p.truncate() - self.centre;
        let r_m = out.length();
        if r_m <= self.ring_m {
            return out / self.ring_m;
        }
        out * (self.rho(r_m, p.z) / r_m)
    }
}

/// tan(φ/2) = d / (D + Z) of a point at distance `d_m` > 0 and depth `depth_m`.
#[inline]
fn half_tangent(d_m: f64, depth_m: f64) -> f64 {
    let slant_m = slant(d_m, depth_m);
    // the same number twice: each form is exact where the other loses its digits
    if depth_m >= 0.0 { d_m / (slant_m + depth_m) } else { (slant_m - depth_m) / d_m }
}

/// D: slant distance of a point at distance `d_m` and depth `depth_m`. Metres need none of the care of `f64::hypot`, which
/// is slow.
#[inline]
fn slant(d_m: f64, depth_m: f64) -> f64 {
    (d_m * d_m + depth_m * depth_m).sqrt()
}

#[cfg(test)]
mod tests;
