//! The error in the picture of a deformed map is a bound: for any eye, ring, mix, scale, exaggeration and curvature, a front
//! of all nodes above a tolerance shows every sample within it.

use glam::{DVec2, DVec3};
use yamanami_core::{FieldLevel, Hierarchy, MapView, NestedField, NodeId};
use yamanami_multires::rtin::{BuildOptions, Rtin, SummitRule};
use yamanami_testkit::{Rng, Shape, Spacing, SyntheticTerrain, random_map_view};

/// Two grids of a ground with relief at all scales, of `width` and `width / 2` samples.
fn small_field(half: u32, spacing_m: f64) -> NestedField {
    let shape = Shape::Fractal { relief_m: 1500.0, roughness: 0.6, seed: 12 };
    let width = 4 * half as usize + 1;
    let ground = SyntheticTerrain::new(width, width, shape, Spacing::Metres(1.0)).to_field();
    let side = 2 * half as usize + 1;
    let grid = |step: usize, first: usize| {
        (0..side * side).map(|n| ground.at(first + n % side * step, first + n / side * step)).collect()
    };
    let (wide, fine) = (grid(2, 0), grid(1, half as usize));
    NestedField::new(vec![FieldLevel::new(spacing_m, half, wide), FieldLevel::new(0.5 * spacing_m, half, fine)])
}

/// All nodes above the tolerance, and how many; parents are above it with their children.
fn front(rtin: &Rtin, view: &MapView, tolerance_px: f32) -> (Vec<bool>, usize) {
    let errors: Vec<f32> = (0..rtin.node_bound()).map(|n| rtin.map_error_px(n, view)).collect();
    let mut active: Vec<bool> = errors.iter().map(|&e| e > tolerance_px).collect();
    let above = active.iter().filter(|&&a| a).count();
    for node in (0..rtin.node_bound()).rev() {
        for &parent in rtin.parents(node).iter() {
            let [own_px, above_px] = [node, parent].map(|n| errors[n as usize]);
            assert!(above_px >= own_px * (1.0 - 1e-6), "{own_px} px over its parent's {above_px} px: {view:?}");
            // rounding alone may leave a parent a hair below
            active[parent as usize] |= active[node as usize];
        }
    }
    (active, above)
}

/// Greatest distance in pixels of a sample within the rim from where the front draws it.
fn worst_px(rtin: &Rtin, view: &MapView, active: &[bool]) -> f64 {
    let visit = |worst: &mut f64, corners: [DVec3; 3], samples: &[DVec3]| {
        let drawn = corners.map(|c| view.px_from_plane(c));
        let [a, b, c] = corners.map(|c| c.truncate());
        let area = (b - a).perp_dot(c - a);
        for sample in samples {
            let p = sample.truncate();
            if (p - view.map.centre).length() <= view.rim_m {
                let w = [(b - p).perp_dot(c - p), (c - p).perp_dot(a - p), (a - p).perp_dot(b - p)].map(|w| w / area);
                let shown: DVec2 = (0..3).map(|i| drawn[i] * w[i]).sum();
                *worst = worst.max((view.px_from_plane(*sample) - shown).length());
            }
        }
    };
    rtin.fold_samples(&|n: NodeId| active[n as usize], || 0.0, visit, f64::max)
}

fn hold(rtin: &Rtin, trials: usize, seed: u64) {
    let mut rng = Rng::new(seed);
    let grid = rtin.field().widest();
    let samples: Vec<DVec3> = (0..grid.width().pow(2))
        .map(|n| grid.plane_from_grid(n % grid.width(), n / grid.width()).extend(f64::from(grid.heights_m()[n])))
        .collect();
    let (mut tried, mut tightest, mut partial) = (0, 0f64, 0);
    while tried < trials {
        let view = random_map_view(&mut rng, grid.reach_m());
        assert_eq!(view.map.check(), Ok(()));
        if view.map.check_ground(samples.iter().copied()).is_err() {
            continue;
        }
        let tolerance_px = 10f64.powf(-1.0 + 2.5 * rng.unit()) as f32;
        let (active, above) = front(rtin, &view, tolerance_px);
        let worst = worst_px(rtin, &view, &active);
        assert!(worst <= f64::from(tolerance_px), "{worst} px at {tolerance_px} px: {view:?}");
        tightest = tightest.max(worst / f64::from(tolerance_px));
        partial += usize::from(above > 0 && above < active.len());
        tried += 1;
    }
    assert!(partial * 2 > trials && tightest > 0.4, "{partial} of {trials} fronts, {tightest} of the tolerance");
}

#[test]
fn the_error_in_pixels_bounds_every_sample_of_any_map() {
    let field = small_field(4, 4000.0);
    hold(&Rtin::build(field, &BuildOptions::default()).unwrap(), 10_000, 1);
}

#[test]
fn the_same_over_a_wider_field_with_raised_summits() {
    let rule = SummitRule { factor: 2.0, min_prominence_m: 100.0 };
    let field = small_field(34, 700.0);
    hold(&Rtin::build(field, &BuildOptions { summits: Some(rule) }).unwrap(), 100, 2);
}
