//! Nested grids around one place, and maps of them, at random.

use crate::{Rng, Shape, Spacing, SyntheticTerrain};
use glam::DVec2;
use yamanami_core::{Curvature, DeformedMap, DropFrom, FieldLevel, MapView, NestedField};

/// Nested grids of `halves` samples from the centre to a side, the coarsest of `spacing_m` metres, over ground that is
/// fractal at the finest. No grid reaches further than the first.
pub fn nested_ground(halves: &[u32], spacing_m: f64, relief_m: f32, seed: u64) -> NestedField {
    let finest = halves.len() - 1;
    let widest = ((2 * halves[0]) << finest) as usize + 1;
    let shape = Shape::Fractal { relief_m, roughness: 0.55, seed };
    let ground = SyntheticTerrain::new(widest, widest, shape, Spacing::Metres(1.0)).to_field();
    let level = |(i, &half): (usize, &u32)| {
        let (step, middle) = (1usize << (finest - i), (halves[0] as usize) << finest);
        let first = middle - half as usize * step;
        let width = 2 * half as usize + 1;
        let heights = (0..width * width).map(|n| ground.at(first + n % width * step, first + n / width * step));
        FieldLevel::new(spacing_m / f64::from(1 << i), half, heights.collect())
    };
    NestedField::new(halves.iter().enumerate().map(level).collect())
}

/// A map with every number at random over ground that reaches `reach_m` from the plane's origin; its numbers pass
/// [`DeformedMap::check`], the ground below it may not.
pub fn random_map_view(rng: &mut Rng, reach_m: f64) -> MapView {
    let mut between = |low: f64, high: f64| low + (high - low) * rng.unit();
    let ring_m = reach_m * between(0.02, 0.7);
    let map = DeformedMap {
        centre: DVec2::new(between(-0.5, 0.5), between(-0.5, 0.5)) * reach_m,
        ring_m,
        eye_m: between(1200.0, 12_000.0),
        alpha: [0.0, 1.0, between(0.0, 1.0)][between(0.0, 3.0) as usize],
        alpha_fall: [0.0, between(0.0, 3.0)][between(0.0, 2.0) as usize],
        scale: between(0.3, 2.0),
        exaggeration: between(0.5, 3.0),
        curvature: match between(0.0, 3.0) as u32 {
            0 => None,
            1 => Some(Curvature { refraction: 0.13, from: DropFrom::Ring }),
            _ => Some(Curvature { refraction: 0.0, from: DropFrom::Centre }),
        },
    };
    MapView { ring_px: between(100.0, 3000.0), ..MapView::fitted(map, [1300, 1300], reach_m * 0.8, 1500.0, 10.0) }
}
