//! A balcony: its floor on a skirt with blocks, and a railing of three rails that cross and turn up at the corners.

use super::paint::Material::{PaleWood, Plaster, Wood};
use super::part::{Parts, Pose, disc, worn_box};
use super::plan::{BALCONY_M, SKIRT_M, Storey};
use glam::{DVec2, DVec3};

/// How far the rails' ends stand out over the corner.
const OVER_M: f64 = 0.034;
/// Rails above the floor: bottoms of the lower two, axis and radius of the round one on top.
const GROUND_RAIL_Z: f64 = 0.008;
const MID_RAIL_Z: f64 = 0.042;
pub(super) const TOP_RAIL_Z: f64 = 0.074;
const TOP_RAIL_RADIUS_M: f64 = 0.0066;
/// Height of the middle rail.
const MID_RAIL_M: f64 = 0.0065;
/// About the distance between posts.
const POST_SPACING_M: f64 = 0.072;

/// Distance of the rails from the axis.
pub(super) fn rail_m(storey: &Storey) -> f64 {
    storey.half_m + BALCONY_M - 0.014
}

pub(super) fn build(parts: &mut Parts, storey: &Storey) {
    let (z, edge) = (storey.floor_z, storey.half_m + BALCONY_M);
    // the skirt closes what is left open between the roof below and the floor
    let skirt = storey.half_m + 0.035;
    parts.bar(Pose::TOWER, [-skirt, -skirt, z - SKIRT_M - 0.03], [skirt, skirt, z - 0.012], Plaster);
    for side in 0..4 {
        let pose = Pose::outward(2 * side);
        floor(parts, pose, storey, edge);
        supports(parts, pose, storey, skirt);
        rails(parts, pose, storey);
    }
}

/// Planks across the edge beam.
fn floor(parts: &mut Parts, pose: Pose, storey: &Storey, edge: f64) {
    let z = storey.floor_z;
    let from = storey.half_m - 0.02;
    let plank_m = 2.0 * edge / (2.0 * edge / 0.045).round();
    let size = DVec3::new(2.0 * edge, edge - from, 0.010);
    parts.bent(pose, size.to_array(), Wood, move |p| {
        // mitred at the corners, where the next side's planks take over
        let y = from + p.y * size.y;
        let x = (2.0 * p.x - 1.0) * y;
        let joint_m = (((x + edge) / plank_m + 0.5).fract() - 0.5).abs() * plank_m;
        let groove = 0.0018 * (1.0 - joint_m / 0.0025).max(0.0);
        let front = if p.y == 1.0 { groove } else { 0.0 };
        DVec3::new(x, y - front, z - size.z * (1.0 - p.z) - if p.z == 1.0 { groove } else { 0.0 })
    });
    parts.bar(pose, [-edge + 0.012, edge - 0.030, z - 0.026], [edge - 0.012, edge - 0.012, z - 0.009], Wood);
}

/// Beams and blocks on the skirt that carry the floor.
fn supports(parts: &mut Parts, pose: Pose, storey: &Storey, skirt: f64) {
    let z = storey.floor_z;
    parts.bar(
        pose,
        [-skirt - 0.008, skirt - 0.004, z - SKIRT_M - 0.002],
        [skirt + 0.008, skirt + 0.008, z - SKIRT_M + 0.012],
        Wood,
    );
    let count = (2.0 * skirt / 0.105).round() as usize;
    for i in 0..=count {
        let x = (2.0 * i as f64 / count as f64 - 1.0) * (skirt - 0.002);
        let size = DVec3::new(0.024, 0.026, 0.014);
        let at = z - SKIRT_M + 0.012;
        parts.bent(pose, size.to_array(), PaleWood, move |p| {
            let q = worn_box(p, size, 0.0012);
            let up = 0.5 * size.z + q.z;
            let narrow = 1.0 - 0.3 * (1.0 - up / 0.006).clamp(0.0, 1.0);
            DVec3::new(x + q.x * narrow, skirt + 0.004 + q.y * narrow, at + up)
        });
        parts.bar(pose, [x - 0.007, skirt - 0.03, at + 0.013], [x + 0.007, skirt + BALCONY_M - 0.05, at + 0.030], Wood);
    }
}

fn rails(parts: &mut Parts, pose: Pose, storey: &Storey) {
    let (z, y) = (storey.floor_z, rail_m(storey));
    let end = y + OVER_M;
    // the two sides' rails cross at the corner; one pair lies a little higher, as if halved into the other
    let turn_up = move |x: f64| 0.026 * ((x.abs() - y + 0.02) / (OVER_M + 0.02)).clamp(0.0, 1.0).powi(2);
    for (bottom, wide_m, high_m, rise) in [(GROUND_RAIL_Z, 0.013, 0.011, 0.0), (MID_RAIL_Z, 0.013, MID_RAIL_M, 0.55)] {
        let size = DVec3::new(2.0 * end, wide_m, high_m);
        parts.bent(pose, size.to_array(), Wood, move |p| {
            let q = worn_box(p, size, 0.0014);
            DVec3::new(q.x, y + q.y, z + bottom + 0.5 * high_m + q.z + rise * turn_up(q.x))
        });
    }
    parts.round_bar(pose, [-end - 0.006, end + 0.006], TOP_RAIL_RADIUS_M, PaleWood, move |x| {
        [y, z + TOP_RAIL_Z + turn_up(x)]
    });
    let count = (2.0 * y / POST_SPACING_M).round() as usize;
    for i in 0..=count {
        let x = (2.0 * i as f64 / count as f64 - 1.0) * y;
        let post = pose.moved(x, y, z);
        let is_corner = i == 0 || i == count;
        // the corner's post is one side's alone
        if i == count {
            continue;
        }
        post_and_saddle(parts, post, if is_corner { 0.0065 } else { 0.0050 });
    }
}

/// A square post up to the middle rail, and on it the turned saddle that carries the top rail: a waist and a cup.
fn post_and_saddle(parts: &mut Parts, pose: Pose, half_m: f64) {
    let height_m = TOP_RAIL_Z - 0.5 * TOP_RAIL_RADIUS_M;
    let square_to = MID_RAIL_Z + 0.5 * MID_RAIL_M;
    parts.bent(pose, [2.0 * half_m, 2.0 * half_m, height_m], Wood, move |p| {
        let (a, b) = (2.0 * p.x - 1.0, 2.0 * p.y - 1.0);
        let z = p.z * height_m;
        let t = ((z - square_to) / (height_m - square_to)).max(0.0);
        let waist = 0.0052 - 0.0020 * (std::f64::consts::PI * t).sin() + 0.0016 * t * t;
        let at = if t > 0.0 { disc(a, b) * waist } else { DVec2::new(a, b) * half_m };
        at.extend(z - 0.002)
    });
    parts.seen_with(MID_RAIL_M);
}
