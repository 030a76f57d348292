//! Height, slope and aspect of a terrain surface at a point.
//!
//! Slope and aspect are those of the triangle under the point, as in: Burrough, McDonnell, "Principles of geographical
//! information systems", 1998.

use super::PlanIndex;
use super::plane::Plane;
use glam::DVec2;
use std::f64::consts::TAU;

/// What a point of the plan stands on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Footing {
    /// Height in metres: that of the triangle's plane.
    pub height_m: f64,
    /// Angle of the triangle to the horizontal, radians.
    pub slope_rad: f64,
    /// Direction in which water runs off, radians clockwise from north (y), 0 up to 2π; `None` where level.
    pub aspect_rad: Option<f64>,
    /// Number of the triangle; of several at an edge the least.
    pub triangle: u32,
}

/// What a point stands on; `None` outside the surface and in its holes.
pub fn footing(index: &PlanIndex<'_>, place: DVec2) -> Option<Footing> {
    let triangle = index.triangle_at(place)?;
    let plane = Plane::of(index.mesh().corners(triangle as usize));
    let fall = -plane.gradient;
    Some(Footing {
        height_m: plane.height(place),
        slope_rad: fall.length().atan(),
        // rounding may turn a hair west of north into a full turn
        aspect_rad: (fall != DVec2::ZERO)
            .then(|| fall.x.atan2(fall.y).rem_euclid(TAU))
            .map(|a| if a < TAU { a } else { 0.0 }),
        triangle,
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{plane_tin, rough, shifted};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn a_plane_has_its_height_slope_and_aspect_everywhere(
            gx in -3.0..3.0f64,
            gy in -3.0..3.0f64,
            place in (0.0..10.0f64, 0.0..10.0f64),
        ) {
            let (near, far) = (plane_tin(10, [gx, gy]), shifted(plane_tin(10, [gx, gy])));
            let move_m = far.positions[0].truncate() - near.positions[0].truncate();
            for (mesh, by) in [(&near, DVec2::ZERO), (&far, move_m)] {
                let p = DVec2::from(place) + by;
                let at = footing(&PlanIndex::new(mesh), p).unwrap();
                let q = p - by;
                prop_assert!((at.height_m - (gx * q.x + gy * q.y)).abs() < 1e-8);
                prop_assert!((at.slope_rad.tan() - gx.hypot(gy)).abs() < 1e-7);
                let aspect = at.aspect_rad.unwrap();
                prop_assert!((0.0..TAU).contains(&aspect));
                let down = DVec2::new(aspect.sin(), aspect.cos());
                prop_assert!((down.dot(DVec2::new(gx, gy)) + gx.hypot(gy)).abs() < 1e-6);
            }
        }

        #[test]
        fn vertices_have_their_own_heights(seed in any::<u64>()) {
            let mesh = shifted(rough(8, seed));
            let index = PlanIndex::new(&mesh);
            for v in &mesh.positions {
                let at = footing(&index, v.truncate()).unwrap();
                prop_assert!((at.height_m - v.z).abs() < 1e-9, "{} {}", at.height_m, v.z);
            }
        }
    }

    #[test]
    fn level_ground_falls_nowhere_and_outside_there_is_none() {
        let mesh = plane_tin(3, [0.0, 0.0]);
        let index = PlanIndex::new(&mesh);
        let at = footing(&index, DVec2::new(1.5, 1.2)).unwrap();
        assert_eq!((at.height_m, at.slope_rad, at.aspect_rad), (0.0, 0.0, None));
        assert_eq!(footing(&index, DVec2::new(3.5, 1.2)), None);
    }

    #[test]
    fn ground_that_falls_north_has_aspect_zero_and_east_a_quarter_turn() {
        let aspect = |gradient| {
            let mesh = plane_tin(3, gradient);
            footing(&PlanIndex::new(&mesh), DVec2::new(1.5, 1.2)).unwrap().aspect_rad.unwrap().to_degrees()
        };
        assert!(aspect([0.0, -1.0]).abs() < 1e-9);
        assert!((aspect([-1.0, 0.0]) - 90.0).abs() < 1e-9);
        assert!((aspect([0.0, 1.0]) - 180.0).abs() < 1e-9);
        assert!((aspect([1.0, 0.0]) - 270.0).abs() < 1e-9);
    }
}
