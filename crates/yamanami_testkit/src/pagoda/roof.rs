//! A roof: four slopes of round cover tiles over hollow pan tiles, the discs at their ends, ridges over the corners with
//! their end tiles.

use super::paint::Material;
use super::part::{Parts, Pose, disc, worn_box};
use super::plan::{EAVE_THICKNESS_M, Roof};
use super::tessellate::Sheet;
use crate::rng::{scramble, unit_from_bits};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// About the distance between rows of cover tiles.
const PITCH_M: f64 = 0.040;
/// Radius of a cover tile, as a share of the pitch.
const COVER_SHARE: f64 = 0.27;
/// How hollow a pan tile is.
const HOLLOW_M: f64 = 0.0075;
/// Length of a tile that the next one leaves free.
const TILE_M: f64 = 0.062;
/// Where the slopes end beside the corner, under its ridge.
const CORNER_M: f64 = 0.016;

/// The wave of tiles across a slope.
#[derive(Debug, Clone, Copy)]
struct Rows {
    /// From the middle of the side to the outermost pan tile's middle.
    half_m: f64,
    count: usize,
    pitch_m: f64,
    radius_m: f64,
}

/// A place on the wave.
struct OnWave {
    /// Middle of its row, and offsets from there along the side and away from the roof.
    row_x: f64,
    x: f64,
    up: f64,
    row: usize,
    on_cover: bool,
}

impl Rows {
    fn of(roof: &Roof) -> Self {
        let half_m = roof.eave_m - CORNER_M;
        let count = (2.0 * half_m / PITCH_M).round() as usize;
        let pitch_m = 2.0 * half_m / count as f64;
        Self { half_m, count, pitch_m, radius_m: COVER_SHARE * pitch_m }
    }

    fn middle(&self, row: usize) -> f64 {
        self.pitch_m * (row as f64 + 0.5) - self.half_m
    }

    /// Length across one row, along the tiles' surface: half a pan, the cover, half a pan.
    fn pan_m(&self) -> f64 {
        let flat_m = 0.5 * self.pitch_m - self.radius_m;
        flat_m * (1.0 + 2.0 / 3.0 * (HOLLOW_M / flat_m).powi(2))
    }

    fn row_m(&self) -> f64 {
        2.0 * self.pan_m() + PI * self.radius_m
    }

    fn across_m(&self) -> f64 {
        self.row_m() * self.count as f64
    }

    /// The place at a share of the length across all rows.
    fn at(&self, u: f64) -> OnWave {
        let rows = u * self.count as f64;
        let row = (rows as usize).min(self.count - 1);
        let along_m = (rows - row as f64) * self.row_m();
        let flat_m = 0.5 * self.pitch_m - self.radius_m;
        let pan_m = self.pan_m();
        let row_x = self.middle(row);
        let from_edge_m = along_m.min(self.row_m() - along_m);
        let (out, up, on_cover) = if from_edge_m < pan_m {
            let t = from_edge_m / pan_m;
            (0.5 * self.pitch_m - t * flat_m, HOLLOW_M * (t * t - 1.0), false)
        } else {
            let turn = DVec2::from_angle((from_edge_m - pan_m) / self.radius_m);
            (self.radius_m * turn.x, self.radius_m * turn.y, true)
        };
        let x = if along_m < 0.5 * self.row_m() { -out } else { out };
        OnWave { row_x, x, up, row, on_cover }
    }
}

pub(super) fn build(parts: &mut Parts, roof: &Roof, storey: u64) {
    for side in 0..4 {
        let pose = Pose::outward(2 * side);
        slope(parts, pose, *roof, storey * 4 + side as u64);
        discs(parts, pose, roof);
        corner_ridge(parts, Pose::outward(2 * side + 1), *roof);
    }
}

/// One slope with the boards beneath it, as one surface.
fn slope(parts: &mut Parts, pose: Pose, roof: Roof, seed: u64) {
    let rows = Rows::of(&roof);
    let steep = (1.0 + (roof.rise_m / (roof.eave_m - roof.inner_m)).powi(2)).sqrt();
    let column_m = move |u: f64| {
        let at = rows.at(u);
        let x = (at.row_x + at.x).abs();
        let flat_x = ((2.0 * u - 1.0) * rows.half_m).abs();
        [
            roof.eave_m - roof.under_m.max(flat_x),
            EAVE_THICKNESS_M,
            (roof.eave_m - roof.inner_m.max(x)) * steep,
        ]
    };
    let place = move |p: DVec3| {
        let (u, v) = (p.x, p.y);
        let flat_x = (2.0 * u - 1.0) * rows.half_m;
        let under = |share: f64| {
            let y = roof.eave_m + (roof.under_m.max(flat_x.abs()) - roof.eave_m) * share;
            DVec3::new(flat_x, y, roof.under_z(flat_x, y))
        };
        let at = rows.at(u);
        let top = |share: f64| {
            let x = at.row_x + at.x;
            let inner_m = roof.inner_m.max(x.abs());
            let y = roof.eave_m + (inner_m - roof.eave_m) * share;
            let tiles = (roof.eave_m - y) * steep / TILE_M;
            let (tile, share) = (tiles.floor(), tiles.fract());
            // each tile was laid by hand
            let chance =
                |k: u64| unit_from_bits(scramble(seed << 32 ^ (at.row as u64) << 16 ^ (tile as u64) << 4 ^ k)) - 0.5;
            let (x, up) = if at.on_cover {
                // the lower end reaches over the next tile's neck
                let size = 1.12 - 0.22 * share;
                (at.x * size + 0.0012 * chance(1), at.up * size + 0.0012 * chance(2))
            } else {
                (at.x, at.up + 0.0034 * (0.5 - share) + 0.0010 * chance(3))
            };
            let m = roof.slope(y);
            let normal = DVec2::new(-m, 1.0).normalize();
            // the eaves are cut plumb
            let lean = (tiles / 0.5).min(1.0);
            DVec3::new(at.row_x + x, y + normal.x * up * lean, roof.top_z(at.row_x + x, y) + normal.y * up)
        };
        if v < 0.0 {
            under(-v)
        } else if v <= 1.0 {
            under(0.0).lerp(top(0.0), v)
        } else {
            top(v - 1.0)
        }
    };
    let sheet = Sheet { across_m: rows.across_m(), column_m: Box::new(column_m) };
    // a roof is never too thin to be seen
    parts.sheet(pose, sheet, PITCH_M * 3.0, Material::Tile, place);
}

/// The round ends of the cover tiles, with a rim and a flower in it.
fn discs(parts: &mut Parts, pose: Pose, roof: &Roof) {
    let rows = Rows::of(roof);
    let radius_m = 1.22 * rows.radius_m;
    for row in 0..rows.count {
        let x = rows.middle(row);
        let z = roof.top_z(x, roof.eave_m) + 0.002;
        let depth_m = 0.012;
        let y = roof.eave_m - 0.004;
        // turned about a level axis: the lathe's z looks outward
        let side_m = 0.5 * PI * radius_m;
        parts.bent_from(pose, [side_m, depth_m, side_m], [2, 1, 2], Material::Tile, move |p| {
            let at = disc(2.0 * p.x - 1.0, 2.0 * p.z - 1.0);
            let relief = if p.y == 1.0 { disc_relief(at) } else { 0.0 };
            DVec3::new(x + radius_m * at.x, y + depth_m * p.y + relief, z + radius_m * at.y)
        });
    }
}

/// Height of the relief on an end disc of radius 1: rim, eight petals, seed pod.
fn disc_relief(at: DVec2) -> f64 {
    let r = at.length();
    let hollow = -0.0032 * ((0.82 - r) / 0.10).clamp(0.0, 1.0);
    let pod = 0.0026 * ((0.30 - r) / 0.10).clamp(0.0, 1.0);
    let petal = 0.0016 * (0.5 + 0.5 * (8.0 * at.y.atan2(at.x)).cos()) * ((r - 0.30) / 0.15).clamp(0.0, 1.0);
    hollow + pod + if r < 0.76 { petal } else { 0.0 }
}

/// The ridge down a corner in two steps, each with courses of flat tiles, a row of cover tiles on top and an end tile.
fn corner_ridge(parts: &mut Parts, pose: Pose, roof: Roof) {
    // the corner's own axis measures √2 as far as the sides' do
    let reach = |y: f64| y * std::f64::consts::SQRT_2;
    let z_at = move |d: f64| {
        let y = d / std::f64::consts::SQRT_2;
        roof.top_z(y, y)
    };
    let run_m = roof.eave_m - roof.inner_m;
    let inner = roof.inner_m + 0.008;
    let main_end = roof.eave_m - 0.27 * run_m;
    for (from, to, height_m, half_m) in
        [(inner, main_end, 0.050, 0.019), (main_end - 0.03, roof.eave_m - 0.035, 0.030, 0.016)]
    {
        let (from, to) = (reach(from), reach(to));
        let length_m = to - from;
        let sink_m = 0.022;
        parts.bent(pose, [2.0 * half_m, length_m, height_m + sink_m], Material::Tile, move |p| {
            let y = from + p.y * length_m;
            // courses of flat tiles: grooves along the sides
            let up = p.z * (height_m * start_low(y, from) + sink_m);
            let groove = 0.0022 * (0.5 + 0.5 * (TAU * up / 0.0125).cos());
            let narrow = 1.0 - 0.15 * p.z - groove / half_m;
            DVec3::new((2.0 * p.x - 1.0) * half_m * narrow, y, z_at(y) - sink_m + up + end_rise(y, to))
        });
        // a row of cover tiles rides on it
        let radius_m = 0.0135;
        let size_m = [radius_m * 1.5, length_m, radius_m * 1.5];
        parts.bent(pose, size_m, Material::Tile, move |p| {
            let y = from + p.y * (length_m + 0.006);
            let size = radius_m * (1.10 - 0.18 * ((to - y + 1.0) / TILE_M).fract());
            let section = disc(2.0 * p.x - 1.0, 2.0 * p.z - 1.0) * size;
            DVec3::new(section.x, y, z_at(y) + height_m * start_low(y, from) + 0.004 + section.y + end_rise(y, to))
        });
        end_tile(parts, pose.moved(0.0, to + 0.004, z_at(to) + end_rise(to, to) - 0.012), height_m + 0.052);
    }
    // a corner piece closes the eaves where the two slopes end
    let (from, to) = (reach(roof.eave_m - 0.06), reach(roof.eave_m) - 0.003);
    let high_m = EAVE_THICKNESS_M + 0.004;
    parts.bent(pose, [0.032, to - from, high_m], Material::Tile, move |p| {
        let q = worn_box(p, DVec3::new(0.032, to - from, high_m), 0.002);
        let y = 0.5 * (from + to) + q.y;
        DVec3::new(q.x, y, z_at(y) - 0.5 * EAVE_THICKNESS_M + q.z)
    });
    // the last tiles run out to the tip of the corner
    let (from, to) = (reach(roof.eave_m - 0.05), reach(roof.eave_m + 0.006));
    parts.bent(pose, [0.03, to - from, 0.03], Material::Tile, move |p| {
        let y = from + p.y * (to - from);
        let section = disc(2.0 * p.x - 1.0, 2.0 * p.z - 1.0);
        let relief = if p.y == 1.0 { disc_relief(section) } else { 0.0 };
        DVec3::new(0.017 * section.x, y + relief, z_at(y) + 0.004 + 0.017 * section.y)
    });
}

/// Ridges start low, under the balcony of the next storey.
fn start_low(y: f64, from: f64) -> f64 {
    0.25 + 0.75 * ((y - from) / 0.20).clamp(0.0, 1.0)
}

/// Ridges turn up towards their ends.
fn end_rise(y: f64, end: f64) -> f64 {
    0.014 * (1.0 - (end - y) / 0.16).clamp(0.0, 1.0).powi(2)
}

/// An onigawara: a plate with horns and shoulders, a face in relief.
fn end_tile(parts: &mut Parts, pose: Pose, height_m: f64) {
    let (width_m, depth_m) = (0.78 * height_m, 0.016);
    parts.bent(pose, [width_m, depth_m, height_m], Material::Tile, move |p| {
        let (a, b) = (2.0 * p.x - 1.0, p.z);
        // outline: feet spread out, waist, shoulders, and two horns
        let half = 0.5 * width_m * (1.0 - 0.25 * (PI * (b * 1.25 - 0.1)).sin().max(0.0) + 0.10 * (TAU * b).cos());
        let horn = 0.16 * (-((a.abs() - 0.62) / 0.16).powi(2)).exp() + 0.07 * (-(a / 0.18).powi(2)).exp();
        let top = height_m * (0.84 + horn);
        let relief = if p.y == 1.0 { face_relief(a, b) } else { 0.0 };
        DVec3::new(a * half, depth_m * (p.y - 0.5) + relief, b * top)
    });
}

/// Eyes, brow, nose, cheeks and a mouth, in metres above the plate.
fn face_relief(a: f64, b: f64) -> f64 {
    let bump = |x: f64, y: f64, wide: f64, high: f64| (-((a - x) / wide).powi(2) - ((b - y) / high).powi(2)).exp();
    let side = a.abs();
    let eye = (-((side - 0.36) / 0.13).powi(2) - ((b - 0.56) / 0.08).powi(2)).exp();
    let brow = (-((side - 0.36) / 0.26).powi(2) - ((b - 0.70 - 0.1 * side) / 0.05).powi(2)).exp();
    let cheek = (-((side - 0.48) / 0.18).powi(2) - ((b - 0.36) / 0.10).powi(2)).exp();
    0.007 * eye + 0.006 * brow + 0.005 * cheek + 0.009 * bump(0.0, 0.46, 0.13, 0.12)
        - 0.005 * bump(0.0, 0.22, 0.42, 0.06)
}
