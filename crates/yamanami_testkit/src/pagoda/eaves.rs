//! Beneath the eaves: two rows of rafters, the boards along their ends, the hip rafters, and the beam that carries all.

use super::paint::Material::{PaleWood, Wood};
use super::part::{Parts, Pose, worn_box};
use super::plan::{PURLIN_M, RAFTER_M, RAFTER_SPACING_M, Roof, Storey};
use super::tessellate::Sheet;
use glam::DVec3;

pub(super) fn build(parts: &mut Parts, storey: &Storey) {
    let roof = storey.roof;
    for side in 0..4 {
        let pose = Pose::outward(2 * side);
        rafters(parts, pose, storey);
        // boards along the rafters' ends, and the beam on the brackets; the beams cross at the corners
        let ends = [
            (roof.mid_m - 0.004, 0.018, 0.018, -0.019),
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

/// How far the sides of a rafter lean, and over which length its end is rounded off.
const LEAN: f64 = 0.16;
const NOSE_M: f64 = 0.010;

/// Rafters of one row seen from below, with the boards between them: teeth across the side.
#[derive(Debug, Clone, Copy)]
struct Teeth {
    half_m: f64,
    count: usize,
    side_m: f64,
}

impl Teeth {
    /// As many rafters as stand within so far of the side's middle.
    fn within(reach_m: f64, side_m: f64) -> Self {
        let count = (2.0 * reach_m / RAFTER_SPACING_M) as usize;
        Self { half_m: 0.5 * RAFTER_SPACING_M * count as f64, count, side_m }
    }

    /// Length across one rafter along its surface: half a gap, down, its bottom, up, half a gap.
    fn tooth_m(&self) -> f64 {
        RAFTER_SPACING_M + 2.0 * self.side_m
    }

    /// Offset along the side, and how far below the boards, at a share of the length across all.
    fn at(&self, u: f64) -> [f64; 2] {
        let teeth = u * self.count as f64;
        let tooth = (teeth as usize).min(self.count - 1);
        let along_m = (teeth - tooth as f64) * self.tooth_m();
        let gap_m = 0.5 * (RAFTER_SPACING_M - self.side_m);
        let from_edge_m = along_m.min(self.tooth_m() - along_m);
        let in_m = from_edge_m.min(gap_m) + (from_edge_m - gap_m - self.side_m).max(0.0);
        let down_m = (from_edge_m - gap_m).clamp(0.0, self.side_m);
        let x = if 2.0 * along_m < self.tooth_m() { in_m } else { RAFTER_SPACING_M - in_m };
        // its sides lean, so that no two places lie one below the other
        let lean_m = LEAN * (down_m - 0.5 * self.side_m);
        let x = if x < 0.5 * RAFTER_SPACING_M { x + lean_m } else { x - lean_m };
        let x = x.clamp(0.0, RAFTER_SPACING_M);
        [tooth as f64 * RAFTER_SPACING_M + x - self.half_m, down_m]
    }
}

fn rafters(parts: &mut Parts, pose: Pose, storey: &Storey) {
    let roof = storey.roof;
    let wall_m = roof.under_m + 0.01;
    // the lower row sinks outward to let the upper one lie on it
    let rows = [
        (wall_m, roof.mid_m, 0.020, RAFTER_M, Wood),
        (wall_m.max(roof.mid_m - 0.045), roof.eave_m - 0.022, 0.0, 0.9 * RAFTER_M, PaleWood),
    ];
    for (from, to, sink_m, side_m, material) in rows {
        let teeth = Teeth::within(to - 0.02, side_m);
        let start = move |x: f64| from.max(x.abs());
        let column_m = move |u: f64| [to - start(teeth.at(u)[0]), side_m, 0.008];
        let place = move |p: DVec3| {
            let [x, down_m] = teeth.at(p.x);
            let y = if p.y < 0.0 { to + (start(x) - to) * -p.y } else { to - 0.008 * (p.y - 1.0).max(0.0) };
            let sink = sink_m * ((y - roof.under_m) / (roof.mid_m - roof.under_m)).clamp(0.0, 1.0);
            // the end is rounded off and vanishes in the board along the ends
            let nose = ((to - y) / NOSE_M).clamp(0.0, 1.0);
            let nose = if p.y < 0.0 { nose * (2.0 - nose) } else { 0.0 };
            let down_m = down_m * (0.2 + 0.8 * nose);
            let up = -0.001 - down_m + p.y.clamp(0.0, 1.0) * (down_m + 0.006);
            DVec3::new(x, y, roof.under_z(x, y) - sink + up)
        };
        let sheet = Sheet { across_m: teeth.tooth_m() * teeth.count as f64, column_m: Box::new(column_m) };
        parts.sheet(pose, sheet, side_m, material, place);
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
