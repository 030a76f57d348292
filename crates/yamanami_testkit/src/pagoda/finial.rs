//! Sōrin: the bronze finial. Dew basin, inverted bowl and lotus, nine rings with spokes and bells on a mast, the water flame,
//! and two jewels.

use super::paint::Material::{Bronze, Tile};
use super::part::{Parts, Pose};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Above the top of the highest roof's slopes.
pub(super) const HEIGHT_M: f64 = 0.985;
const MAST_M: f64 = 0.0095;
const SPOKE_M: f64 = 0.0026;
const FIRST_RING_Z: f64 = 0.215;
const RING_SPACING_M: f64 = 0.056;

pub(super) fn build(parts: &mut Parts, top_z: f64) {
    let at = |z: f64| Pose::TOWER.moved(0.0, 0.0, top_z + z);
    // basin: foot, body, rim
    parts.bar(at(0.0), [-0.078, -0.078, -0.045], [0.078, 0.078, 0.016], Tile);
    parts.bar(at(0.0), [-0.066, -0.066, 0.012], [0.066, 0.066, 0.066], Bronze);
    parts.bar(at(0.0), [-0.076, -0.076, 0.062], [0.076, 0.076, 0.078], Bronze);
    for side in 0..4 {
        for x in [-0.033, 0.033] {
            // a framed field on each half of a side
            parts.bar(
                Pose::outward(2 * side).moved(x, 0.0, top_z),
                [-0.024, 0.060, 0.022],
                [0.024, 0.0685, 0.056],
                Bronze,
            );
        }
    }
    let bowl = |t: f64| {
        let a = 0.5 * PI * t;
        [0.058 * a.cos().max(0.22), 0.076 + 0.052 * a.sin()]
    };
    parts.turned(at(0.0), [0.056, 0.10], Bronze, bowl, |_, _| 0.0);
    lotus(parts, at(0.122), 0.070, 0.034);
    lotus(parts, at(0.150), 0.046, 0.026);
    let mast = |t: f64| [MAST_M * (1.0 - 0.35 * t), 0.11 + t * (HEIGHT_M - 0.14)];
    parts.turned(at(0.0), [MAST_M, HEIGHT_M - 0.14], Bronze, mast, |_, _| 0.0);
    for k in 0..9 {
        let z = FIRST_RING_Z + RING_SPACING_M * k as f64;
        ring(parts, at(z), 0.096 - 0.0042 * k as f64, k);
    }
    flame(parts, top_z + FIRST_RING_Z + 8.0 * RING_SPACING_M + 0.030);
    let dragon_z = FIRST_RING_Z + 8.0 * RING_SPACING_M + 0.200;
    lotus(parts, at(dragon_z - 0.030), 0.022, 0.012);
    parts.ball(at(dragon_z), 0.022, Bronze, |d| d);
    parts.seen_with(2.0 * MAST_M);
    lotus(parts, at(HEIGHT_M - 0.058), 0.020, 0.012);
    parts.ball(at(HEIGHT_M - 0.034), 0.022, Bronze, |d| {
        // a drop: drawn out to a tip at the top
        let tip = ((d.z - 0.35) / 0.65).clamp(0.0, 1.0);
        DVec3::new(d.x * (1.0 - 0.35 * tip), d.y * (1.0 - 0.35 * tip), d.z + 0.55 * tip.powi(3))
    });
}

/// A flower whose eight petals curl outward.
fn lotus(parts: &mut Parts, pose: Pose, radius_m: f64, height_m: f64) {
    let side_m = 0.5 * PI * radius_m;
    parts.bent(pose, [side_m, side_m, 1.4 * height_m], Bronze, move |p| {
        let at = super::part::disc(2.0 * p.x - 1.0, 2.0 * p.y - 1.0);
        let petal = (4.0 * at.y.atan2(at.x)).cos().abs();
        let open = 0.35 + 0.65 * (0.5 * PI * p.z).sin().powf(0.8);
        let r = radius_m * open * (1.0 - 0.13 * (1.0 - petal) * p.z);
        let lip = if p.z == 1.0 { -0.25 * height_m * (1.0 - at.length_squared()) } else { 0.0 };
        (at * r).extend(height_m * p.z * (0.88 + 0.12 * petal) + lip)
    });
}

/// One of the nine rings: hoop, inner hoop, hub, eight spokes, bells below.
fn ring(parts: &mut Parts, pose: Pose, radius_m: f64, number: usize) {
    parts.ring(pose, radius_m, [0.0045, 0.0085], Bronze);
    parts.ring(pose, 0.55 * radius_m, [0.0028, 0.0036], Bronze);
    let hub = |t: f64| [0.0125 + 0.0045 * (PI * t).sin(), 0.030 * (t - 0.5)];
    parts.turned(pose, [0.015, 0.036], Bronze, hub, |_, _| 0.0);
    parts.seen_with(2.0 * MAST_M);
    for k in 0..8 {
        let turned = Pose::turned(TAU / 8.0 * (k as f64 + 0.5 * (number % 2) as f64));
        let spoke = turned.raised_to(pose);
        parts.round_bar(spoke, [0.010, radius_m - 0.001], SPOKE_M, Bronze, |_| [0.0, 0.0]);
        if k % 2 == 0 {
            let bell = |t: f64| [0.0058 * (1.15 - 0.15 * t - 0.62 * t.powi(4)), 0.019 * (t - 1.0) - 0.0075];
            parts.turned(spoke.moved(radius_m, 0.0, 0.0), [0.0058, 0.022], Bronze, bell, |_, _| 0.0);
            parts.seen_with(2.0 * SPOKE_M);
        }
    }
}

/// Four pierced blades that stand around the mast like flames.
fn flame(parts: &mut Parts, z: f64) {
    const HIGH_M: f64 = 0.150;
    for quarter in 0..4 {
        let pose = Pose::turned(0.25 * TAU * quarter as f64 + 0.125 * TAU).raised_to(Pose::TOWER.moved(0.0, 0.0, z));
        // the outer blade with its tongues, a slot between it and the mast
        let edge = |t: f64| {
            let belly = (PI * t.powf(0.75)).sin().max(0.0) * 0.058;
            belly * (1.0 + 0.16 * (TAU * 4.5 * t).sin()) + 0.010
        };
        parts.bent(pose, [0.026, 0.0042, HIGH_M], Bronze, move |p| {
            let t = p.z;
            let inner = 0.5 * (edge(t) - 0.010) + 0.006;
            let x = inner + p.x * (edge(t) - inner);
            // tongues lean upward at their tips
            DVec3::new(x, 0.0042 * (p.y - 0.5) * (1.0 - 0.4 * p.x), t * HIGH_M + 0.036 * p.x * t * (1.0 - t))
        });
        for k in 1..6 {
            let t = k as f64 / 6.0;
            let reach = 0.5 * (edge(t) - 0.010) + 0.010;
            let rise = 0.6;
            parts.round_bar(pose, [0.002, reach], 0.0021, Bronze, move |x| [0.0, t * HIGH_M + rise * (x - reach)]);
        }
        // a curl in the slot
        let size = 0.010;
        let curl = pose.moved(0.020, 0.0, 0.36 * HIGH_M);
        parts.bent(curl, [2.0 * size, 0.0036, 2.0 * size], Bronze, move |p| {
            let at: DVec2 = super::part::disc(2.0 * p.x - 1.0, 2.0 * p.z - 1.0) * size;
            DVec3::new(at.x, 0.0036 * (p.y - 0.5) + 0.001 * (p.y - 0.5) * (at.length() / size * TAU).cos(), at.y)
        });
    }
}
