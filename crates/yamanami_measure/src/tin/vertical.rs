//! How far two terrain surfaces are apart vertically, over all of the plan that both cover.
//!
//! The difference is linear on each piece of the overlay of both triangulations, so its greatest value lies at a corner
//! of a piece and its mean square is a closed form: no sample can miss anything. Slow and sure, the judge of whatever
//! reduces a surface, and without a line in common with it.

use super::PlanIndex;
use super::overlay::fold;
use super::prism::{integral, positive_part, square_integral};
use glam::DVec2;
use yamanami_core::TriangleMesh;

/// Vertical distance of two surfaces over the overlap of their plans.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct VerticalDifference {
    /// Greatest distance in metres.
    pub max_m: f64,
    /// Where it is, in plan; `None` without overlap, or where all triangles are the same.
    pub worst: Option<DVec2>,
    /// Root of the mean squared distance in metres.
    pub rms_m: f64,
    /// Mean distance in metres.
    pub mean_m: f64,
    /// Mean of second less first in metres: how much the second lies higher.
    pub mean_signed_m: f64,
    /// Plan area that both cover, square metres.
    pub overlap_m2: f64,
}

/// Sums of a chunk.
#[derive(Default)]
struct Sums {
    max: f64,
    worst: Option<DVec2>,
    squares: f64,
    above: f64,
    signed: f64,
    area: f64,
}

/// Measures two surfaces in the same frame against each other. Triangles that both have do not differ. Else a surface that
/// overlaps itself counts as often as it lies over a place.
///
/// # Panics
/// When a triangle names a vertex that its mesh does not have.
pub fn vertical_difference(first: &TriangleMesh, second: &PlanIndex<'_>) -> VerticalDifference {
    let (chunks, same_m2) = fold(first, second, |sums: &mut Sums, piece| {
        let (mut area_here, mut max_here, mut corner) = (0.0, 0.0, 0);
        let mut fan = 1;
        piece.differences(|area, d| {
            for (k, v) in [0, fan, fan + 1].into_iter().zip(d) {
                if v.abs() > max_here {
                    (max_here, corner) = (v.abs(), k);
                }
            }
            fan += 1;
            area_here += area;
            sums.squares += square_integral(area, d);
            sums.signed += integral(area, d);
            sums.above += positive_part(area, d)[1];
        });
        sums.area += area_here;
        // what only touches is no overlap
        if area_here > 0.0 && (max_here > sums.max || sums.worst.is_none()) {
            (sums.max, sums.worst) = (max_here, Some(piece.origin + piece.corners[corner]));
        }
    });
    let mut total = Sums { area: same_m2, ..Sums::default() };
    for c in chunks {
        if c.worst.is_some() && (c.max > total.max || total.worst.is_none()) {
            (total.max, total.worst) = (c.max, c.worst);
        }
        total.squares += c.squares;
        total.signed += c.signed;
        total.above += c.above;
        total.area += c.area;
    }
    let mean = |sum: f64| if total.area > 0.0 { sum / total.area } else { 0.0 };
    VerticalDifference {
        max_m: total.max,
        worst: total.worst,
        rms_m: mean(total.squares).max(0.0).sqrt(),
        mean_m: mean(2.0 * total.above - total.signed),
        mean_signed_m: mean(total.signed),
        overlap_m2: total.area,
    }
}

#[cfg(test)]
mod tests {
    use super::super::footing;
    use super::super::tests::{plane_tin, rough, shifted};
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn agrees_with_dense_samples(seeds in (any::<u64>(), any::<u64>()), moved in (-3.0..3.0f64, -3.0..3.0f64)) {
            let (a, mut b) = (shifted(rough(7, seeds.0)), shifted(rough(5, seeds.1)));
            b.positions.iter_mut().for_each(|p| *p += DVec3::new(moved.0, moved.1, 0.0));
            let (index_a, index_b) = (PlanIndex::new(&a), PlanIndex::new(&b));
            let exact = vertical_difference(&a, &index_b);
            const N: usize = 160;
            let bounds = a.bounds();
            let (mut max, mut squares, mut sum, mut count) = (0f64, 0.0, 0.0, 0.0);
            for i in 0..N * N {
                let share = DVec2::new((i % N) as f64 + 0.5, (i / N) as f64 + 0.5) / N as f64;
                let p = bounds.min.truncate() + share * (bounds.max - bounds.min).truncate();
                let (Some(za), Some(zb)) = (footing(&index_a, p), footing(&index_b, p)) else { continue };
                let d = zb.height_m - za.height_m;
                (max, squares, sum, count) = (max.max(d.abs()), squares + d * d, sum + d.abs(), count + 1.0);
            }
            prop_assert!(count > 0.0);
            prop_assert!(exact.max_m >= max - 1e-9 && exact.max_m < max + 0.6, "{} {max}", exact.max_m);
            prop_assert!((exact.rms_m - (squares / count).sqrt()).abs() < 0.03);
            prop_assert!((exact.mean_m - sum / count).abs() < 0.03);
            let worst = exact.worst.unwrap();
            let at = [&index_a, &index_b].map(|i| footing(i, worst));
            if let [Some(za), Some(zb)] = at {
                prop_assert!(((zb.height_m - za.height_m).abs() - exact.max_m).abs() < 1e-6);
            }
            let back = vertical_difference(&b, &index_a);
            prop_assert!((back.rms_m - exact.rms_m).abs() < 1e-9 && (back.max_m - exact.max_m).abs() < 1e-9);
            prop_assert!((back.mean_signed_m + exact.mean_signed_m).abs() < 1e-9);
        }

        #[test]
        fn a_surface_differs_from_itself_by_exactly_nothing(seed in any::<u64>(), turns in any::<u64>()) {
            let a = shifted(rough(8, seed));
            let mut b = a.clone();
            for (k, t) in b.triangles.iter_mut().enumerate() {
                t.rotate_left((turns.rotate_left(k as u32) % 3) as usize);
            }
            b.triangles.reverse();
            // and where only one vertex is moved, all the rest does not differ either
            for lift in [0.0, 0.5] {
                b.positions[40].z += lift;
                let d = vertical_difference(&a, &PlanIndex::new(&b));
                prop_assert!((d.max_m - lift).abs() < 1e-12 && (d.max_m == 0.0) == (lift == 0.0));
                prop_assert!(d.rms_m <= lift && (d.mean_m - d.mean_signed_m).abs() < 1e-12);
                prop_assert!((d.overlap_m2 - 64.0).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn planes_differ_as_their_formulas_say() {
        // d = 1 + x / 10 on 10 by 10 metres
        let mut b = plane_tin(4, [0.1, 0.0]);
        b.positions.iter_mut().for_each(|p| *p = DVec3::new(p.x * 2.5, p.y * 2.5, p.z * 2.5 + 1.0));
        let d = vertical_difference(&plane_tin(10, [0.0, 0.0]), &PlanIndex::new(&b));
        assert!((d.max_m - 2.0).abs() < 1e-12 && (d.worst.unwrap().x - 10.0).abs() < 1e-9);
        assert!((d.mean_m - 1.5).abs() < 1e-12 && (d.mean_signed_m - 1.5).abs() < 1e-12);
        assert!((d.rms_m - (7.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((d.overlap_m2 - 100.0).abs() < 1e-9);
    }

    #[test]
    fn surfaces_that_only_touch_have_no_overlap() {
        let a = plane_tin(2, [1.0, 0.0]);
        let mut b = a.clone();
        b.positions.iter_mut().for_each(|p| *p += DVec3::new(2.0, 0.0, 50.0));
        assert_eq!(vertical_difference(&a, &PlanIndex::new(&b)), VerticalDifference::default());
    }
}
