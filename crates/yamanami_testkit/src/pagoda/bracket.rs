//! Tokyō: the brackets between wall and eaves. A block on the pillar's head carries bow-shaped arms with bearing blocks, three
//! steps outward; at the corners a set reaches out along the diagonal as well.

use super::paint::Material::{PaleWood, Wood};
use super::part::{Parts, Pose, worn_box};
use super::plan::{BLOCK_M, PILLAR_SHARE, STEP_OUT_M, STEP_UP_M, Storey};
use glam::DVec3;

/// Arms: width and height. What is left of a step's height is the bearing block's.
const ARM_M: [f64; 2] = [0.017, 0.021];
const BEARING_M: f64 = STEP_UP_M - ARM_M[1];
/// Side of a bearing block at its top, and half the length of an arm along the wall.
const BEARING_SIDE_M: f64 = 0.026;
const HALF_ARM_M: f64 = 0.058;

pub(super) fn build(parts: &mut Parts, storey: &Storey) {
    let half = storey.half_m;
    for side in 0..4 {
        let pose = Pose::outward(2 * side);
        wall(parts, pose, storey);
        for share in [-1.0, -PILLAR_SHARE, PILLAR_SHARE, 1.0] {
            set(parts, pose.moved(share * half, half, 0.0), storey, STEP_OUT_M, Set::At(share));
        }
        // one great block for each pillar: the corner's is this side's alone
        for share in [-1.0, -PILLAR_SHARE, PILLAR_SHARE] {
            block(parts, pose.moved(share * half, half, storey.head_z), 0.050, BLOCK_M);
        }
        let corner = Pose::outward(2 * side + 1).moved(0.0, half * std::f64::consts::SQRT_2, 0.0);
        set(parts, corner, storey, STEP_OUT_M * std::f64::consts::SQRT_2, Set::Diagonal);
        // between the pillars a strut with a block carries the wall beams
        for x in [-0.5 * (1.0 + PILLAR_SHARE), 0.0, 0.5 * (1.0 + PILLAR_SHARE)] {
            let strut = pose.moved(x * half, half, storey.head_z);
            parts.bar(strut, [-0.008, -0.006, -0.002], [0.008, 0.006, BLOCK_M - 0.004], Wood);
            block(parts, pose.moved(x * half, half, storey.step_z(0) - 0.006), BEARING_SIDE_M, BEARING_M + 0.006);
        }
    }
}

/// Beams one above the other in the wall, plaster between them, and the light beams that join the sets further out.
fn wall(parts: &mut Parts, pose: Pose, storey: &Storey) {
    let half = storey.half_m;
    for step in 0..3 {
        let z = storey.step_z(step) + BEARING_M;
        let reach = half + 0.02;
        parts.bar(pose, [-reach, half - 0.007, z], [reach, half + 0.007, z + ARM_M[1] - 0.003], Wood);
    }
    let out = 2.0 * STEP_OUT_M;
    let (reach, y, z) = (half + out + 0.03, half + out, storey.step_z(2) + ARM_M[1] + BEARING_M);
    parts.bar(pose, [-reach, y - 0.007, z], [reach, y + 0.007, z + 0.018], Wood);
    // a small ceiling of laths between the wall and that beam
    let (from, to) = (half + 0.004, y);
    let z = z + 0.006;
    let laths = (2.0 * half / 0.021).round();
    let size = DVec3::new(2.0 * to, to - from, 0.010);
    parts.bent(pose, size.to_array(), Wood, move |p| {
        let x = (p.x - 0.5) * size.x;
        let off_m = ((x / (2.0 * half) * laths).fract().abs() - 0.5).abs() * 2.0 * half / laths;
        let lath = if p.z == 0.0 { -0.006 * ((0.0052 - off_m) / 0.002).clamp(0.0, 1.0) } else { 0.0 };
        DVec3::new(x, from + p.y * size.y, z + p.z * size.z + lath)
    });
}

/// Where a set stands.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Set {
    /// On a pillar at this share of the half side: on one of the corners at ±1.
    At(f64),
    /// On the diagonal of a corner.
    Diagonal,
}

/// One set seen from its pillar: three steps `out_m` apart.
fn set(parts: &mut Parts, pose: Pose, storey: &Storey, out_m: f64, at: Set) {
    for step in 0..3 {
        let (z, y) = (storey.step_z(step), out_m * step as f64);
        let end = y + out_m + 0.5 * ARM_M[0] + 0.008;
        arm_outward(parts, pose, [-0.03, end], z);
        bearing(parts, pose, 0.0, y + out_m, z + ARM_M[1]);
        let Set::At(share) = at else { continue };
        arm_along(parts, pose, y, z);
        for x in [-HALF_ARM_M + 0.012, 0.0, HALF_ARM_M - 0.012] {
            // what lies around a corner is the other side's; the corner itself is one side's
            let is_others = share.abs() == 1.0 && (x * share > 0.0 || (x == 0.0 && y == 0.0 && share > 0.0));
            if !is_others {
                bearing(parts, pose, x, y, z + ARM_M[1]);
            }
        }
    }
    tail(parts, pose, storey, out_m);
    if at != Set::Diagonal {
        // a last arm lies below the beam at the ends
        arm_along(parts, pose, 3.0 * out_m, storey.step_z(3) - ARM_M[1]);
    }
}

/// An arm that reaches out from the wall, its lower edge rounded up at the end.
fn arm_outward(parts: &mut Parts, pose: Pose, [from, to]: [f64; 2], z: f64) {
    // a little wider than those along the wall, which it crosses at the corners
    let size = DVec3::new(ARM_M[0] + 0.0016, to - from, ARM_M[1]);
    parts.bent(pose, size.to_array(), Wood, move |p| {
        let q = worn_box(p, size, 0.0015);
        let y = 0.5 * (from + to) + q.y;
        DVec3::new(q.x, y, z + bowed(0.5 * size.z + q.z, to - y))
    });
}

/// An arm along the wall, rounded at both ends.
fn arm_along(parts: &mut Parts, pose: Pose, y: f64, z: f64) {
    let size = DVec3::new(2.0 * HALF_ARM_M, ARM_M[0], ARM_M[1]);
    parts.bent(pose, size.to_array(), Wood, move |p| {
        let q = worn_box(p, size, 0.0015);
        DVec3::new(q.x, y + q.y, z + bowed(0.5 * size.z + q.z, HALF_ARM_M - q.x.abs()))
    });
}

/// Lifts the lower edge of an arm near its end: the bow.
fn bowed(up: f64, from_end_m: f64) -> f64 {
    let t = (1.0 - from_end_m / 0.036).clamp(0.0, 1.0);
    let rise = 0.70 * (1.0 - (1.0 - t * t).sqrt());
    up + (ARM_M[1] - up) * rise
}

fn bearing(parts: &mut Parts, pose: Pose, x: f64, y: f64, z: f64) {
    block(parts, pose.moved(x, y, z), BEARING_SIDE_M, BEARING_M);
}

/// A block whose lower part is hollowed in: masu, or the great block on a pillar.
fn block(parts: &mut Parts, pose: Pose, side_m: f64, height_m: f64) {
    let size = DVec3::new(side_m, side_m, height_m);
    parts.bent(pose, size.to_array(), PaleWood, move |p| {
        let q = worn_box(p, size, 0.0012);
        let up = 0.5 * height_m + q.z;
        let t = (1.0 - up / (0.45 * height_m)).clamp(0.0, 1.0);
        let narrow = 1.0 - 0.30 * t * t.sqrt();
        DVec3::new(q.x * narrow, q.y * narrow, up)
    });
}

/// The slanting tail rafter that comes out of the wall through the second and third step.
fn tail(parts: &mut Parts, pose: Pose, storey: &Storey, out_m: f64) {
    let (from, to) = (-0.02, 3.0 * out_m + 0.035);
    let size = DVec3::new(0.016, to - from, 0.019);
    let fall = 0.20 * STEP_OUT_M / out_m;
    let z = storey.step_z(2) - 0.004;
    parts.bent(pose, size.to_array(), Wood, move |p| {
        let q = worn_box(p, size, 0.0015);
        let y = 0.5 * (from + to) + q.y;
        // the end is cut square to the slope and thinned
        let thin = 1.0 - 0.25 * ((y - (to - 0.03)) / 0.03).clamp(0.0, 1.0);
        DVec3::new(q.x, y, z + fall * (2.0 * out_m - y) + q.z * thin)
    });
}
