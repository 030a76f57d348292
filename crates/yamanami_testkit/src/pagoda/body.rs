//! Walls: plastered bays between round pillars and tie beams, panelled doors in the middle, windows of upright bars beside
//! them; and the stone platform with its steps.

use super::paint::Material::{Bronze, PaleWood, Plaster, Stone, Wood};
use super::part::{Parts, Pose, worn_box};
use super::plan::{BASE_HALF_M, BASE_TOP_Z, PILLAR_SHARE, Storey};
use glam::DVec3;
use std::f64::consts::PI;

const PILLAR_M: f64 = 0.021;

pub(super) fn build(parts: &mut Parts, storey: &Storey) {
    let (half, z, head) = (storey.half_m, storey.floor_z, storey.head_z);
    // the core behind everything reaches up into the roof
    let core = half - 0.008;
    let roof_z = storey.roof.under_z(0.0, half) + 0.01;
    parts.bar(Pose::TOWER, [-core, -core, z - 0.012], [core, core, roof_z], Plaster);
    for side in 0..4 {
        let pose = Pose::outward(2 * side);
        for share in [-1.0, -PILLAR_SHARE, PILLAR_SHARE] {
            pillar(parts, pose.moved(share * half, half, z), head - z);
        }
        let reach = half + PILLAR_M + 0.004;
        let mut beam = |from: f64, to: f64, out: f64| {
            parts.bar(pose, [-reach - out, half - 0.004, from], [reach + out, half + PILLAR_M + out, to], Wood);
        };
        let wall_m = head - z;
        let low = 0.022;
        beam(z + 0.002, z + low, 0.004);
        beam(head - 0.15 * wall_m - 0.010, head - 0.15 * wall_m + 0.006, 0.003);
        beam(head - 0.019, head - 0.006, -0.003);
        // the plate on which the brackets stand
        beam(head - 0.006, head + 0.004, 0.010);
        let bay = [z + low, head - 0.15 * wall_m - 0.010];
        door(parts, pose.moved(0.0, half, 0.0), PILLAR_SHARE * half - PILLAR_M - 0.001, bay);
        for side in [-1.0, 1.0] {
            let middle = side * 0.5 * (1.0 + PILLAR_SHARE) * half;
            window(parts, pose.moved(middle, half, 0.0), 0.5 * (1.0 - PILLAR_SHARE) * half - PILLAR_M - 0.001, bay);
        }
    }
}

/// A round pillar that swells a little below the middle.
fn pillar(parts: &mut Parts, pose: Pose, height_m: f64) {
    let profile = move |t: f64| {
        let swell = 1.0 + 0.035 * (PI * (0.15 + 0.7 * t)).sin() - 0.10 * ((t - 0.9) / 0.1).clamp(0.0, 1.0).powi(2);
        [PILLAR_M * swell, t * height_m]
    };
    parts.turned(pose, [PILLAR_M, height_m], Wood, profile, |_, _| 0.0);
}

/// Two leaves with rails, panels and rows of studs, in a frame.
fn door(parts: &mut Parts, pose: Pose, half_m: f64, [low, high]: [f64; 2]) {
    frame(parts, pose, half_m, [low, high], 0.014);
    let (width_m, height_m) = (half_m - 0.014, high - low - 0.028);
    for side in [-1.0, 1.0] {
        let size = DVec3::new(width_m - 0.001, 0.012, height_m);
        let middle = DVec3::new(side * 0.5 * width_m, 0.006, 0.5 * (low + high));
        parts.bent(pose, size.to_array(), Wood, move |p| {
            let relief = if p.y == 1.0 { leaf_relief((p.x - 0.5).abs() * size.x, p.z, size) } else { 0.0 };
            middle + worn_box(p, size, 0.001) + DVec3::Y * relief
        });
        let knob = pose.moved(side * 0.010, 0.016, 0.5 * (low + high));
        parts.ball(knob, 0.0045, Bronze, |d| d * DVec3::new(1.0, 0.8, 1.0));
    }
}

/// Frames stand 4 mm above the panels; studs sit on the cross rails.
fn leaf_relief(from_middle_m: f64, up: f64, size: DVec3) -> f64 {
    let stile = from_middle_m > 0.5 * size.x - 0.011;
    let rail_share = 0.012 / size.z;
    let rails = [0.5 * rail_share, 0.34, 0.68, 1.0 - 0.5 * rail_share];
    let rail = rails.iter().any(|r| (up - r).abs() < rail_share * 0.6);
    let panel = if stile || rail { 0.0 } else { -0.004 };
    let across = (from_middle_m / 0.016 + 0.5).fract() - 0.5;
    let stud = rails[1..3].iter().map(|r| ((up - r) * size.z).powi(2)).fold(f64::INFINITY, f64::min);
    panel + 0.003 * (1.0 - (stud + (across * 0.016).powi(2)) / 0.0030_f64.powi(2)).max(0.0).sqrt()
}

/// Upright bars set edgeways in a frame.
fn window(parts: &mut Parts, pose: Pose, half_m: f64, [low, high]: [f64; 2]) {
    // the wall below and above stays white
    let (low, high) = (low + 0.18 * (high - low), high - 0.06 * (high - low));
    let half_m = half_m - 0.012;
    frame(parts, pose, half_m, [low, high], 0.010);
    let inner = half_m - 0.010;
    let pitch_m = 2.0 * inner / (2.0 * inner / 0.0155).round().max(3.0);
    let size = DVec3::new(2.0 * inner, 0.006, high - low - 0.016);
    parts.bent(pose, size.to_array(), PaleWood, move |p| {
        let x = (p.x - 0.5) * size.x;
        let off_m = (((x + inner) / pitch_m).fract() - 0.5).abs() * pitch_m;
        let bar = if p.y == 1.0 { (0.0052 - off_m).max(0.0) * 1.8 } else { 0.0 };
        DVec3::new(x, -0.004 + p.y * size.y + bar, 0.5 * (low + high) + (p.z - 0.5) * size.z)
    });
}

fn frame(parts: &mut Parts, pose: Pose, half_m: f64, [low, high]: [f64; 2], wide_m: f64) {
    let out = 0.017;
    for side in [-1.0_f64, 1.0] {
        let (a, b) = (side * half_m, side * (half_m - wide_m));
        parts.bar(pose, [a.min(b), -0.006, low], [a.max(b), out, high], Wood);
    }
    let over = half_m + 0.0025;
    parts.bar(pose, [-over, -0.005, low - 0.001], [over, out + 0.0025, low + wide_m], Wood);
    parts.bar(pose, [-over, -0.005, high - wide_m], [over, out + 0.0025, high + 0.001], Wood);
}

/// The platform: foot, dressed blocks, cornice and paving, and steps on every side.
pub(super) fn base(parts: &mut Parts) {
    let (half, top) = (BASE_HALF_M, BASE_TOP_Z);
    let tower = Pose::TOWER;
    parts.bar(tower, [-half - 0.03, -half - 0.03, 0.0], [half + 0.03, half + 0.03, 0.032], Stone);
    parts.bar(tower, [-half + 0.012, -half + 0.012, 0.02], [half - 0.012, half - 0.012, top - 0.02], Stone);
    parts.bar(tower, [-half, -half, top - 0.036], [half, half, top - 0.006], Stone);
    for side in 0..4 {
        let pose = Pose::outward(2 * side);
        // dressed blocks of the wall
        let size = DVec3::new(2.0 * half - 0.008, 0.03, top - 0.036 - 0.030);
        let block_m = size.x / 9.0;
        let middle = DVec3::new(0.0, half - 0.018, 0.5 * (0.030 + top - 0.036));
        parts.bent(pose, size.to_array(), Stone, move |p| {
            let q = worn_box(p, size, 0.002);
            let out = if p.y == 1.0 { -joint(q.x, 0.5 * size.x, block_m) } else { 0.0 };
            middle + q + DVec3::Y * out
        });
        let steps = 5;
        for i in 0..steps {
            let high = (top - 0.004) * (steps - i) as f64 / steps as f64;
            let out = half + 0.038 * (i + 1) as f64;
            parts.bar(pose, [-0.17, half - 0.02, 0.0], [0.17, out, high], Stone);
        }
        for x in [-0.20, 0.20] {
            let size = DVec3::new(0.05, 0.038 * steps as f64 + 0.05, top + 0.012);
            parts.bent(pose, size.to_array(), Stone, move |p| {
                let q = worn_box(p, size, 0.005);
                // the top slopes down with the steps
                let t = q.y / size.y + 0.5;
                let share = q.z / size.z + 0.5;
                DVec3::new(x + q.x, half - 0.01 + t * size.y, share * size.z * (1.0 - 0.74 * t))
            });
        }
    }
    // paving slabs
    let size = DVec3::new(2.0 * half - 0.006, 2.0 * half - 0.006, 0.012);
    let slab_m = size.x / 9.0;
    parts.bent(tower, size.to_array(), Stone, move |p| {
        let q = worn_box(p, size, 0.003);
        let joints = [q.x, q.y].map(|x| joint(x, 0.5 * size.x, slab_m));
        let down = if p.z == 1.0 { joints[0].max(joints[1]) } else { 0.0 };
        DVec3::new(q.x, q.y, top - 0.5 * size.z + q.z - down)
    });
}

/// Depth of the joint between stones so long, which are laid from `half_m` before the middle on.
fn joint(x: f64, half_m: f64, stone_m: f64) -> f64 {
    let off_m = (((x + half_m) / stone_m + 0.5).fract() - 0.5).abs() * stone_m;
    0.004 * (1.0 - off_m / 0.005).max(0.0)
}
