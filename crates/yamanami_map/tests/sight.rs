//! What is hidden, against looking along the ground step by step; and colours of the smallest and emptiest fields.

use glam::{DVec2, DVec3};
use image::{Rgba, RgbaImage};
use proptest::prelude::*;
use yamanami_core::{Curvature, DeformedMap, DropFrom, FieldLevel, NestedField};
use yamanami_map::{HorizonTable, InkStyle, ReliefStyle, SeenFrom, Sightline, ink, paint};
use yamanami_testkit::{Rng, nested_ground};

/// Metres between places looked at.
const STEP_M: f64 = 10.0;

/// The angle above straight down at which a point is seen, in the picture's geometry: by the angle itself.
fn angle(map: &DeformedMap, r_m: f64, z_m: f64) -> f64 {
    (r_m - map.ring_m).max(0.0).atan2(map.depth_m(r_m, z_m))
}

/// The greatest angle of ground along an azimuth between two distances.
fn greatest(field: &NestedField, map: &DeformedMap, towards: DVec2, from_m: f64, to_m: f64) -> f64 {
    let steps = ((to_m - from_m) / STEP_M).max(0.0) as usize;
    let at = |i: usize| from_m + STEP_M * i as f64;
    (0..=steps).map(|i| angle(map, at(i), field.height_m(map.centre + at(i) * towards))).fold(0.0, f64::max)
}

fn map(rng: &mut Rng, curved: u8) -> DeformedMap {
    let mut between = |low: f64, high: f64| low + (high - low) * rng.unit();
    DeformedMap {
        centre: DVec2::new(between(-3e3, 3e3), between(-3e3, 3e3)),
        ring_m: between(1e3, 6e3),
        eye_m: between(1500.0, 4000.0),
        exaggeration: between(0.5, 1.5),
        curvature: match curved {
            0 => None,
            1 => Some(Curvature { refraction: 0.13, from: DropFrom::Ring }),
            _ => Some(Curvature { refraction: 0.0, from: DropFrom::Centre }),
        },
        ..DeformedMap::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn sight_lines_agree_with_walking_them(seed in 0u64..1 << 40, curved in 0u8..3) {
        let field = nested_ground(&[24, 20], 1000.0, 900.0, seed);
        let mut rng = Rng::new(seed);
        let map = map(&mut rng, curved);
        let sight = Sightline::new(&field, map, SeenFrom::Picture);
        let (mut agree, mut all) = (0, 0);
        for _ in 0..60 {
            let place = DVec2::new(rng.unit() - 0.5, rng.unit() - 0.5) * 40e3;
            let p = place.extend(field.height_m(place) + 150.0 * rng.unit());
            let out = place - map.centre;
            let own_m = 1.5 * field.level_at(place).spacing_m();
            let before = greatest(&field, &map, out.normalize(), map.ring_m, out.length() - own_m);
            let own = angle(&map, out.length(), p.z);
            // the sight line looks at fewer places: what hides may fall between them, but nothing else hides
            if own > before + 1e-3 {
                prop_assert!(sight.sees(p), "{p} is hidden, seen at {own} over {before}: {map:?}");
            }
            if (own - before).abs() > 0.02 {
                all += 1;
                agree += u32::from(sight.sees(p) == (own > before));
            }
        }
        prop_assert!(agree * 100 >= all * 95, "{agree} of {all}");
    }

    #[test]
    fn the_table_of_horizons_is_what_lies_before(seed in 0u64..1 << 40, curved in 0u8..3) {
        let field = nested_ground(&[24, 20], 1000.0, 900.0, seed);
        let mut rng = Rng::new(seed ^ 1);
        let map = map(&mut rng, curved);
        let (azimuths, step_m, rim_m) = (90, 250.0, 19e3);
        let table = HorizonTable::new(&field, &map, rim_m, azimuths, step_m);
        prop_assert_eq!(table.half_tangents.len(), azimuths * 77);
        for _ in 0..60 {
            let row = rng.below(azimuths);
            let (sin, cos) = (row as f64 * std::f64::consts::TAU / azimuths as f64).sin_cos();
            let towards = DVec2::new(sin, cos);
            let r_m = step_m * (1 + rng.below(75)) as f64;
            let found = 2.0 * table.before(r_m * towards, r_m + 1.0).atan();
            let walked = greatest(&field, &map, towards, map.ring_m, r_m);
            prop_assert!(found <= walked + 1e-3, "{found} over {walked} at {r_m} m: {map:?}");
            // the last place that the table looked at may lie a stride before
            let surely = greatest(&field, &map, towards, map.ring_m, r_m - 700.0);
            prop_assert!(found >= surely - 0.06, "{found} under {surely} at {r_m} m: {map:?}");
            let nearer = table.before(r_m * towards, r_m - step_m);
            prop_assert!(nearer <= table.before(r_m * towards, r_m), "falls with distance");
        }
    }

    #[test]
    fn a_point_raised_stays_seen(seed in 0u64..1 << 40, eye_above_m in 1.0..50.0f64) {
        let field = nested_ground(&[24, 20], 1000.0, 900.0, seed);
        let mut rng = Rng::new(seed);
        let map = map(&mut rng, 1);
        for from in [SeenFrom::Picture, SeenFrom::Ground { eye_above_m }] {
            let sight = Sightline::new(&field, map, from);
            for _ in 0..40 {
                let place = DVec2::new(rng.unit() - 0.5, rng.unit() - 0.5) * 50e3;
                let low = place.extend(field.height_m(place));
                let high = low + DVec3::Z * (1.0 + 500.0 * rng.unit());
                prop_assert!(!sight.sees(low) || sight.sees(high), "{low} is seen, {high} is not");
            }
        }
    }
}

/// The smallest fields, with and without data.
fn odd_fields() -> Vec<NestedField> {
    let level =
        |spacing_m: f64, half: u32, z: f32| FieldLevel::new(spacing_m, half, vec![z; (2 * half as usize + 1).pow(2)]);
    let mut one_known = vec![f32::NAN; 25];
    one_known[12] = 3000.0;
    vec![
        NestedField::new(vec![level(100.0, 2, 500.0)]),
        NestedField::new(vec![level(100.0, 2, f32::NAN)]),
        NestedField::new(vec![level(1e-3, 2, -1e4)]),
        NestedField::new(vec![FieldLevel::new(100.0, 2, one_known)]),
        NestedField::new(vec![level(200.0, 8, f32::NAN), level(100.0, 2, 900.0)]),
        NestedField::new(vec![level(200.0, 2, 0.0), level(100.0, 4, f32::INFINITY)]),
    ]
}

#[test]
fn the_smallest_and_emptiest_fields_are_painted() {
    let plain = ReliefStyle::default();
    let styles = [
        plain.clone(),
        ReliefStyle { tints: Vec::new(), sea_level_m: None, ..plain.clone() },
        ReliefStyle { haze_m: 100.0, is_multi_directional: false, sea_level_m: Some(1e9), ..plain.clone() },
        plain.clone().stretched_to(0.0),
        plain.stretched_to(f32::NAN),
    ];
    for field in odd_fields() {
        for (style, centre) in styles.iter().flat_map(|s| [DVec2::ZERO, DVec2::splat(1e7)].map(|c| (s, c))) {
            let pictures = paint(&field, style, centre);
            assert_eq!(pictures.len(), field.levels().len());
            for (picture, level) in pictures.iter().zip(field.levels()) {
                assert_eq!(picture.reach_m, level.reach_m());
                assert_eq!(picture.rgba.dimensions(), (level.width() as u32, level.width() as u32));
                for (pixel, known) in picture.rgba.pixels().zip(level.known()) {
                    // no-data lies at sea level: where water is drawn it may be water
                    let is_drawn = *known || style.sea_level_m.is_some();
                    assert!(pixel.0[3] == 255 && is_drawn || pixel.0[3] == 0 && !known);
                }
            }
        }
    }
}

#[test]
fn sight_over_the_smallest_and_emptiest_fields() {
    let map = DeformedMap { ring_m: 60.0, eye_m: 5000.0, ..DeformedMap::default() };
    for field in odd_fields() {
        for from in [SeenFrom::Picture, SeenFrom::Ground { eye_above_m: 2.0 }] {
            let sight = Sightline::new(&field, map, from);
            for p in [DVec3::ZERO, DVec3::new(90.0, -90.0, 0.0), DVec3::new(0.0, 30.0, 9e3)] {
                sight.sees(p);
            }
            assert!(sight.sees(DVec3::new(50.0, 0.0, -1e4)), "within the ring nothing hides");
        }
        for (rim_m, azimuths, step_m) in [(200.0, 1, 1.0), (0.0, 7, 100.0), (500.0, 3, 2e3)] {
            let table = HorizonTable::new(&field, &map, rim_m, azimuths, step_m);
            assert!(table.half_tangents.iter().all(|t| t.is_finite() && *t >= 0.0));
            assert!(table.before(DVec2::new(1e9, -1e9), 1e9) >= 0.0 && table.before(DVec2::ZERO, 0.0) >= 0.0);
        }
    }
}

#[test]
fn ink_of_odd_pictures() {
    for (width, height) in [(1, 1), (5, 5), (1, 9), (0, 0)] {
        for width_px in [0.0, 0.3, 7.5] {
            let style = InkStyle { width_px, ..InkStyle::default() };
            let before = RgbaImage::from_pixel(width, height, Rgba([90, 90, 90, 255]));
            let mut picture = before.clone();
            ink(&mut picture, 3, DVec2::new(2.5, 2.5), 0.0, &style, |_, _| f32::NAN);
            assert_eq!(picture, before, "no ground, no ink");
            ink(&mut picture, 0, DVec2::new(-1e6, 1e6), 1.0, &style, |_, _| 5e3);
            assert_eq!(picture, before, "level ground has no edge");
            ink(&mut picture, 0, DVec2::ZERO, 0.0, &style, |x, y| (x * 1000 + y) as f32);
            assert!(picture.pixels().all(|p| p.0[3] == 255));
        }
    }
}
