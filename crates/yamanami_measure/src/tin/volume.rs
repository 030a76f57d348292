//! Earthwork: the volumes between two terrain surfaces.
//!
//! The difference of height is linear on each piece of the overlay of both triangulations; pieces on which it changes
//! sign are cut along its zero line. What comes out is exact, unlike the sum over a grid that is usual.

use super::PlanIndex;
use super::overlay::{fold, plan_area};
use super::prism::positive_part;
use yamanami_core::TriangleMesh;

/// Volumes from a first surface to a second, over the overlap of their plans.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct VolumeBetween {
    /// Volume to be taken away where the second lies lower, cubic metres.
    pub cut_m3: f64,
    /// Volume to be brought where the second lies higher, cubic metres.
    pub fill_m3: f64,
    /// Plan area of the cut, square metres.
    pub cut_m2: f64,
    /// Plan area of the fill, square metres.
    pub fill_m2: f64,
    /// Plan area that both cover, square metres.
    pub overlap_m2: f64,
    /// Plan area that only the first covers, square metres.
    pub first_only_m2: f64,
    /// Plan area that only the second covers, square metres.
    pub second_only_m2: f64,
}

impl VolumeBetween {
    /// Fill less cut, cubic metres.
    pub fn net_m3(&self) -> f64 {
        self.fill_m3 - self.cut_m3
    }
}

/// Volumes between two surfaces in the same frame. Triangles that both have enclose nothing; else a surface that overlaps itself counts as often as it lies over a place.
///
/// # Panics
/// When a triangle names a vertex that its mesh does not have.
pub fn volume_between(first: &TriangleMesh, second: &PlanIndex<'_>) -> VolumeBetween {
    let (chunks, same_m2) = fold(first, second, |sums: &mut VolumeBetween, piece| {
        piece.differences(|area, d| {
            let [fill_m2, fill_m3] = positive_part(area, d);
            let [cut_m2, cut_m3] = positive_part(area, d.map(|v| -v));
            sums.fill_m2 += fill_m2;
            sums.fill_m3 += fill_m3;
            sums.cut_m2 += cut_m2;
            sums.cut_m3 += cut_m3;
            sums.overlap_m2 += area;
        });
    });
    let mut total = VolumeBetween { overlap_m2: same_m2, ..VolumeBetween::default() };
    for c in chunks {
        total.cut_m3 += c.cut_m3;
        total.fill_m3 += c.fill_m3;
        total.cut_m2 += c.cut_m2;
        total.fill_m2 += c.fill_m2;
        total.overlap_m2 += c.overlap_m2;
    }
    total.first_only_m2 = (plan_area(first) - total.overlap_m2).max(0.0);
    total.second_only_m2 = (plan_area(second.mesh()) - total.overlap_m2).max(0.0);
    total
}

#[cfg(test)]
mod tests {
    use super::super::tests::{plane_tin, pyramid, rough, shifted};
    use super::super::vertical_difference;
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    #[test]
    fn a_pyramid_on_a_plain_has_a_third_of_its_box() {
        for place in [DVec3::ZERO, DVec3::new(6.4e6, 1.5e5, 0.0)] {
            let mut ground = plane_tin(10, [0.0, 0.0]);
            ground.positions.iter_mut().for_each(|p| *p += place);
            let mut pyramid = pyramid(6.0, 5.0);
            pyramid.positions.iter_mut().for_each(|p| *p += place + DVec3::new(1.3, 2.1, 0.0));
            let v = volume_between(&ground, &PlanIndex::new(&pyramid));
            assert!((v.fill_m3 - 60.0).abs() < 1e-7, "{v:?}");
            assert_eq!(v.cut_m3, 0.0);
            assert!((v.fill_m2 - 36.0).abs() < 1e-7 && (v.overlap_m2 - 36.0).abs() < 1e-7);
            assert!((v.first_only_m2 - 64.0).abs() < 1e-7 && v.second_only_m2 < 1e-7);
            // the plain raised to half its height: the tip is cut off
            let mut raised = ground.clone();
            raised.positions.iter_mut().for_each(|p| p.z += 2.5);
            let v = volume_between(&pyramid, &PlanIndex::new(&raised));
            assert!((v.cut_m3 - 7.5).abs() < 1e-7 && (v.cut_m2 - 9.0).abs() < 1e-7, "{v:?}");
            assert!((v.net_m3() - (90.0 - 60.0)).abs() < 1e-7);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn cut_and_fill_balance_with_the_mean_difference(seeds in (any::<u64>(), any::<u64>())) {
            let (a, b) = (shifted(rough(7, seeds.0)), shifted(rough(5, seeds.1)));
            let index = PlanIndex::new(&b);
            let (v, d) = (volume_between(&a, &index), vertical_difference(&a, &index));
            prop_assert!((v.net_m3() - d.mean_signed_m * d.overlap_m2).abs() < 1e-8);
            prop_assert!((v.cut_m3 + v.fill_m3 - d.mean_m * d.overlap_m2).abs() < 1e-8);
            prop_assert!((v.cut_m2 + v.fill_m2 - v.overlap_m2).abs() < 1e-8);
            prop_assert!((v.overlap_m2 - 25.0).abs() < 1e-8 && (v.first_only_m2 - 24.0).abs() < 1e-8);
            let back = volume_between(&b, &PlanIndex::new(&a));
            prop_assert!((back.cut_m3 - v.fill_m3).abs() < 1e-8 && (back.fill_m3 - v.cut_m3).abs() < 1e-8);
        }
    }
}
