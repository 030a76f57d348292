//! Beneath the eaves: two rows of rafters, the boards along their ends, the hip rafters, and the beam that carries all.

use super::paint::Material::{PaleWood, Wood};
use super::part::{Parts, Pose, worn_box};
use super::plan::{PURLIN_M, RAFTER_M, RAFTER_SPACING_M, Roof, Storey};
use glam::DVec3;

pub(super) fn build(parts: &mut Parts, storey: &Storey) {
    let roof = storey.roof;
    for side in 0..4 {
        let pose = Pose::outward(2 * side);
        rafters(parts, pose, storey);
        // boards along the rafters' ends, and the beam on the brackets; the beams cross at the corners
        let ends = [
            (roof.mid_m - 0.012, 0.018, 0.016, -0.018),
            (roof.eave_m - 0.030, 0.020, 0.018, -0.010),
            (roof.eave_m - 0.012, 0.016, 0.012, 0.0),
        ];
        for (y, wide_m, high_m, drop_m) in ends {
            along(parts, pose, roof, y, [wide_m, high_m], move |x| roof.under_z(x, y) + drop_m);
        }
        let y = storey.purlin_m();
        let reach_m = y + 0.05;
        let z = storey.purlin_z();
        let lift = move |x: f64| z + roof.lift(x.abs().min(y));
        beam(parts, pose, reach_m, y, [0.022, PURLIN_M], lift);
        hip(parts, Pose::outward(2 * side + 1), storey);
    }
}

/// A beam along the side that ends at the corners' axes.
fn along(
    parts: &mut Parts,
    pose: Pose,
    roof: Roof,
    y: f64,
    size_m: [f64; 2],
    z: impl Fn(f64) -> f64 + Send + Sync + 'static,
) {
    // half a beam's width over the corner, so that two of them close it
    beam(parts, pose, (y + 0.5 * size_m[0] - 0.001).min(roof.eave_m), y, size_m, z);
}

/// A level beam from -`reach_m` to `reach_m`, `size_m` wide and high, whose bottom lies at `z(x)`.
fn beam(
    parts: &mut Parts,
    pose: Pose,
    reach_m: f64,
    y: f64,
    [wide_m, high_m]: [f64; 2],
    z: impl Fn(f64) -> f64 + Send + Sync + 'static,
) {
    let size = DVec3::new(2.0 * reach_m, wide_m, high_m);
    parts.bent(pose, size.to_array(), Wood, move |p| {
        let q = worn_box(p, size, 0.0015);
        DVec3::new(q.x, y + q.y, z(q.x) + 0.5 * high_m + q.z)
    });
}

fn rafters(parts: &mut Parts, pose: Pose, storey: &Storey) {
    let roof = storey.roof;
    let count = (2.0 * (roof.eave_m - 0.04) / RAFTER_SPACING_M) as usize;
    for i in 0..count {
        let x = (i as f64 - 0.5 * (count - 1) as f64) * RAFTER_SPACING_M;
        // a rafter starts at the wall or at the hip; its lower row sinks outward to let the upper one lie on it
        let from = (roof.under_m + 0.01).max(x.abs());
        let lower = (from, roof.mid_m, 0.0, 0.020);
        let upper = (from.max(roof.mid_m - 0.045), roof.eave_m - 0.022, 0.0, 0.0);
        for (row, (from, to, sink_from, sink_to)) in [lower, upper].into_iter().enumerate() {
            if to - from < 0.03 {
                continue;
            }
            // at the wall end the two rows meet the boards; outward the lower one falls away from them
            let sink = move |y: f64| {
                let t = ((y - roof.under_m) / (roof.mid_m - roof.under_m)).clamp(0.0, 1.0);
                sink_from + (sink_to - sink_from) * t
            };
            let side_m = if row == 0 { RAFTER_M } else { 0.9 * RAFTER_M };
            let size = DVec3::new(side_m, to - from, side_m);
            let material = if row == 0 { Wood } else { PaleWood };
            parts.bent(pose, size.to_array(), material, move |p| {
                let q = worn_box(p, size, 0.0016);
                let y = 0.5 * (from + to) + q.y;
                DVec3::new(x + q.x, y, roof.under_z(x, y) + 0.001 - sink(y) - 0.5 * side_m + q.z)
            });
        }
    }
}

/// The hip rafter, with a nose that looks out below the corner of the eaves, and a wind bell under it.
fn hip(parts: &mut Parts, pose: Pose, storey: &Storey) {
    let roof = storey.roof;
    let reach = |y: f64| y * std::f64::consts::SQRT_2;
    for (from, to, low_m, high_m) in [
        (roof.under_m, roof.mid_m + 0.02, 0.058, 0.040),
        (roof.mid_m - 0.08, roof.eave_m - 0.008, 0.030, 0.034),
    ] {
        let (from, to) = (reach(from), reach(to));
        let size = DVec3::new(0.030, to - from, high_m);
        parts.bent(pose, size.to_array(), Wood, move |p| {
            let q = worn_box(p, size, 0.002);
            let y = 0.5 * (from + to) + q.y;
            let side = y / std::f64::consts::SQRT_2;
            // the nose is cut back below
            let nose = ((y - (to - 0.035)) / 0.035).clamp(0.0, 1.0);
            let up = 0.5 * high_m + q.z;
            let up = up + (high_m - up) * 0.55 * nose * nose;
            DVec3::new(q.x, y, roof.under_z(side, side) - low_m + up)
        });
    }
    let tip = reach(roof.eave_m - 0.03);
    let top_z = roof.under_z(roof.eave_m - 0.03, roof.eave_m - 0.03) - 0.016;
    parts.round_bar(pose.moved(0.0, tip, top_z - 0.010), [-0.0025, 0.0025], 0.012, Wood, |_| [0.0, 0.0]);
    bell(parts, pose.moved(0.0, tip, top_z - 0.062));
}

fn bell(parts: &mut Parts, pose: Pose) {
    let flare = |t: f64| 0.012 * (1.0 + 0.28 * (1.0 - t).powi(3) - 0.45 * t.powi(6));
    let material = super::paint::Material::Bronze;
    parts.turned(
        pose,
        [0.012, 0.042],
        material,
        move |t| [flare(t), 0.042 * t],
        |t, r| {
            if t == 0.0 { 0.010 * (1.0 - r * r) } else { 0.004 * (1.0 - r * r) }
        },
    );
}
