//! The equations against their golden values, and the bound against ground laid at random.

use super::*;
use std::f64::consts::{PI, TAU};

const KM: f64 = 1000.0;

fn map(alpha: f64, scale: f64) -> DeformedMap {
    DeformedMap { alpha, scale, ..DeformedMap::default() }
}

fn curved(map: DeformedMap, refraction: f64) -> DeformedMap {
    DeformedMap { curvature: Some(Curvature { refraction, from: DropFrom::Ring }), ..map }
}

/// A small generator: the core has no random numbers.
struct Numbers(u64);

impl Numbers {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
}

#[test]
fn golden_values() {
    let golden = [
        (5.0, 0.0, 0.0, 1.0, 0.5),
        (10.0, 0.0, 0.0, 1.0, 1.0),
        (15.0, 0.0, 0.0, 1.0, std::f64::consts::SQRT_2),
        (60.0, 0.0, 0.0, 1.0, 1.904_987_562),
        (60.0, 2.0, 0.0, 1.0, 1.941_798_383),
        (160.0, 0.0, 0.0, 1.0, 1.967_222_068),
        (160.0, 3.0, 0.0, 1.0, 1.986_755_552),
        (160.0, 0.0, 0.3, 1.0, 6.177_055_448),
        (60.0, 2.0, 0.3, 2.0, 3.818_517_736),
    ];
    for (r, z, alpha, scale, rho) in golden {
        assert!((map(alpha, scale).rho(r * KM, z * KM) - rho).abs() < 1e-9, "r {r} z {z} alpha {alpha} s {scale}");
    }
    assert!((curved(map(0.0, 1.0), 0.13).rho(160.0 * KM, 3.0 * KM) - 1.976_702_799).abs() < 1e-9);
}

#[test]
fn drops_are_those_of_the_books() {
    let flat = DeformedMap { ring_m: 1e-3, ..map(0.0, 1.0) };
    for (km, without, with) in
        [(20.0, 31.0, 27.0), (50.0, 196.0, 171.0), (100.0, 785.0, 683.0), (160.0, 2009.0, 1748.0)]
    {
        assert!((curved(flat, 0.0).drop_m(km * KM) - without).abs() < 0.5);
        assert!((curved(flat, 0.13).drop_m(km * KM) - with).abs() < 0.5);
    }
}

/// The construction itself: along the ray to the unit sphere, then from the opposite point to the tangent plane.
#[test]
fn the_sphere_term_is_the_stereographic_construction() {
    for (d, depth) in [(1.0, 5.0), (5.0, 5.0), (50.0, 5.0), (150.0, 2.0), (40.0, -1.0)] {
        let slant: f64 = f64::hypot(d, depth);
        let (x, down) = (d / slant, depth / slant);
        let on_plane = 2.0 * x / (1.0 + down);
        assert!((2.0 * half_tangent(d, depth) - on_plane).abs() < 1e-15 * (1.0 + on_plane) * 4.0);
        assert!((half_tangent(d, depth) - (0.5 * f64::atan2(d, depth)).tan()).abs() < 1e-13);
    }
}

#[test]
fn the_ring_joins_and_joins_smoothly_with_the_smooth_scale() {
    for eye_m in [2000.0, 5000.0, 10_000.0] {
        for alpha in [0.0, 0.3, 0.7, 1.0] {
            for alpha_fall in [0.0, 1.5] {
                for curvature in [None, Some(Curvature { refraction: 0.13, from: DropFrom::Ring })] {
                    let s = DeformedMap::smooth_scale(10_000.0, eye_m);
                    let m = DeformedMap { eye_m, alpha, alpha_fall, curvature, ..map(alpha, s) };
                    let rho = |r: f64| m.rho(r, 0.0);
                    assert!((rho(10_000.0) - 1.0).abs() < 1e-15 && (rho(10_000.0 + 1e-6) - 1.0).abs() < 1e-9);
                    let slope = (rho(10_001.0) - rho(10_000.0)) * KM;
                    assert!((slope - 0.1).abs() < 1e-6, "{slope}");
                    let second = (rho(10_020.0) - 2.0 * rho(10_010.0) + rho(10_000.0)) / 1e-4;
                    assert!(second.abs() < 1e-3, "{second} per km² at eye {eye_m}");
                }
            }
        }
    }
    let slope = |m: DeformedMap| (m.rho(10_001.0, 0.0) - 1.0) * KM;
    for (eye_m, expected) in [(2000.0, 0.25), (5000.0, 0.1), (10_000.0, 0.05)] {
        assert!((slope(DeformedMap { eye_m, ..map(0.0, 1.0) }) - expected).abs() < 1e-4);
    }
}

#[test]
fn the_inverse_is_one() {
    let mut n = Numbers(7);
    for alpha in [0.0, 0.3, 1.0] {
        for curvature in [None, Some(Curvature { refraction: 0.13, from: DropFrom::Ring })] {
            let m = DeformedMap { curvature, ..map(alpha, 1.0) };
            for _ in 0..2000 {
                let azimuth = n.between(-PI, PI);
                let z = n.between(-100.0, 4000.0);
                // with curvature, to the horizon of ground of this height
                let horizon_m = m.ring_m + (2.0 * m.depth_m(m.ring_m, z) / m.bend_per_m()).sqrt();
                let r = n.between(0.0, f64::min(0.97 * horizon_m, 300e3));
                if r < 11_000.0 && r > 10_000.0 && z > 3900.0 {
                    continue;
                }
                let p = DVec2::from_angle(azimuth) * r;
                let back = m.plane_from_image(m.image_from_plane(p.extend(z)), z).unwrap();
                assert!((back - p).length() < 1e-3, "alpha {alpha}, r {r}, z {z}: {} m", (back - p).length());
            }
        }
    }
    assert_eq!(map(0.0, 1.0).radius_m(2.5, 0.0), None, "beyond the horizon there is nothing");
}

#[test]
fn numbers_out_of_range_and_ground_above_the_eye_are_refused() {
    let said = |m: DeformedMap| m.check().unwrap_err().to_string();
    assert_eq!(said(map(1.5, 1.0)), "alpha: expected 0 to 1, got 1.5");
    assert_eq!(said(DeformedMap { ring_m: 0.0, ..map(0.0, 1.0) }), "ring radius: expected above 0 m, got 0");
    let m = map(0.0, 1.0);
    assert!(m.check().is_ok());
    let ground = |r: f64, z: f64| m.check_ground([DVec3::new(0.0, r, z)]);
    assert!(ground(10_010.0, 4900.0).is_ok());
    let refused = ground(10_010.0, 5100.0).unwrap_err().to_string();
    assert!(
        refused.starts_with("eye height: expected above all ground near the ring, got 5000 m under ground of 5100")
    );
    assert!(ground(50_000.0, 5100.0).is_ok(), "far ground may stand above the eye");
}

/// Triangles laid anywhere over rough ground: no sample is further off than the bound says.
#[test]
fn the_bound_bounds() {
    let mut n = Numbers(11);
    let (mut tightest, mut tried) = (0f64, 0);
    for _ in 0..20_000 {
        let m = DeformedMap {
            centre: DVec2::new(n.between(-5e3, 5e3), n.between(-5e3, 5e3)),
            ring_m: n.between(2e3, 20e3),
            eye_m: n.between(3e3, 9e3),
            alpha: n.between(0.0, 1.0).powi(2),
            alpha_fall: if n.between(0.0, 1.0) < 0.5 { 0.0 } else { n.between(0.0, 3.0) },
            scale: n.between(0.3, 2.5),
            exaggeration: n.between(0.5, 1.5),
            curvature: match n.between(0.0, 3.0) as u32 {
                0 => None,
                1 => Some(Curvature { refraction: 0.13, from: DropFrom::Ring }),
                _ => Some(Curvature { refraction: 0.0, from: DropFrom::Centre }),
            },
        };
        let leg = 10f64.powf(n.between(1.5, 4.0));
        let distance = m.ring_m * n.between(0.0, 3.0).powi(3);
        let at = m.centre + DVec2::from_angle(n.between(0.0, TAU)) * distance;
        let side = DVec2::from_angle(n.between(0.0, TAU)) * leg;
        let corners = [at, at + side, at + side.perp()];
        let heights = [0, 1, 2].map(|_| n.between(0.0, 1900.0f64.min(0.8 * leg)));
        let error_m = n.between(0.0, 0.3 * leg).min(300.0);
        let edge_m = leg * std::f64::consts::SQRT_2;
        let (low, high) = (heights[0].min(heights[1]).min(heights[2]), heights[0].max(heights[1]).max(heights[2]));
        let middle = 0.5 * (corners[1] + corners[2]);
        let patch = Patch { centre: middle, radius_m: edge_m / 2.0, low_m: low - error_m, high_m: high + error_m };
        let bound = m.error_bound(&patch, error_m, edge_m, high - low);
        if bound.is_infinite() {
            continue;
        }
        let drawn = [0, 1, 2].map(|i| m.image_from_plane(corners[i].extend(heights[i])));
        for _ in 0..20 {
            let (mut u, mut v) = (n.between(0.0, 1.0), n.between(0.0, 1.0));
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let w = [1.0 - u - v, u, v];
            let p: DVec2 = (0..3).map(|i| corners[i] * w[i]).sum();
            let z: f64 = (0..3).map(|i| heights[i] * w[i]).sum::<f64>() + n.between(-error_m, error_m);
            let off = (m.image_from_plane(p.extend(z)) - (0..3).map(|i| drawn[i] * w[i]).sum::<DVec2>()).length();
            assert!(off <= bound * (1.0 + 1e-9) + 1e-12, "{off} over {bound}: {m:?} {patch:?} edge {edge_m}");
            tightest = tightest.max(off / bound);
            tried += 1;
        }
        // a larger patch has no smaller bound
        let wider = Patch { radius_m: patch.radius_m * 1.3, low_m: low - 2.0 * error_m, ..patch };
        assert!(m.error_bound(&wider, error_m, edge_m, high - low) >= bound);
    }
    assert!(tried > 100_000 && tightest > 0.5, "{tried} tried, the closest came to {tightest} of its bound");
}

/// Far from the ring ground may stand above the eye.
#[test]
fn ground_above_the_eye_has_a_bound_that_grows_too() {
    let mut n = Numbers(3);
    let mut above = 0;
    for _ in 0..20_000 {
        let m = DeformedMap { eye_m: n.between(500.0, 2000.0), ring_m: n.between(2e3, 9e3), ..map(0.0, 1.0) };
        let [low_m, high_m] = [n.between(0.0, 3000.0), n.between(0.0, 3000.0)];
        let patch = Patch {
            centre: DVec2::from_angle(n.between(0.0, TAU)) * n.between(1.0, 60e3),
            radius_m: n.between(1.0, 4e3),
            low_m: low_m.min(high_m),
            high_m: low_m.max(high_m),
        };
        let inner = Patch {
            centre: patch.centre + DVec2::from_angle(n.between(0.0, TAU)) * 0.5 * patch.radius_m,
            radius_m: n.between(0.0, 0.5) * patch.radius_m,
            low_m: patch.low_m + n.between(0.0, 0.5) * (patch.high_m - patch.low_m),
            ..patch
        };
        let [outer, inner] = [&patch, &inner].map(|p| m.error_bound(p, 20.0, patch.radius_m, 100.0));
        assert!(inner <= outer * (1.0 + 1e-9), "{inner} over {outer}: {m:?} {patch:?}");
        above += usize::from(outer.is_finite() && patch.high_m > m.eye_m);
    }
    assert!(above > 5000, "{above}");
}

#[test]
fn pixels_and_places_are_inverse_and_north_is_up() {
    let view = MapView { up_azimuth_rad: 0.3, ..MapView::fitted(map(0.0, 1.0), [1300, 900], 160e3, 3000.0, 10.0) };
    let px = DVec2::new(123.0, 456.0);
    assert!((view.px_from_image(view.image_from_px(px)) - px).length() < 1e-9);
    let up = view.px_from_plane(DVec3::new(5000.0 * 0.3f64.sin(), 5000.0 * 0.3f64.cos(), 0.0));
    assert!((up.x - 650.0).abs() < 1e-9 && up.y < 450.0, "its azimuth points up");
    let north_up = MapView { up_azimuth_rad: 0.0, ..view };
    let east = north_up.px_from_plane(DVec3::new(5000.0, 0.0, 0.0));
    assert!(east.x > 650.0 && (east.y - 450.0).abs() < 1e-9);
    let rim = north_up.px_from_plane(DVec3::new(0.0, 160e3, 3000.0));
    assert!(rim.y > 9.9 && rim.y < 12.0, "{rim}");
}
