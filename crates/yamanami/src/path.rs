//! Camera paths: an orbit, a run along the valleys, or one recorded to a file.

use crate::camera::FOV_Y_RAD;
use crate::model_view::model_views;
use crate::{Error, Subject, Terrain};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::path::Path;
use yamanami_core::{Aabb, View};

/// A camera path: one view a frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CameraPath {
    /// The views, all of the same picture size.
    pub views: Vec<View>,
}

/// A recorded path as JSON: places in the source CRS, heights in metres.
#[derive(Serialize, Deserialize)]
struct Recorded {
    fov_deg: f64,
    frames: Vec<RecordedFrame>,
}

#[derive(Serialize, Deserialize)]
struct RecordedFrame {
    eye: [f64; 3],
    target: [f64; 3],
}

/// A full turn around the middle of a terrain or TIN, or around a model as near as it fits the picture from all sides.
pub fn orbit(subject: &impl Subject, frames: usize, viewport_px: [u32; 2]) -> CameraPath {
    let bounds = subject.bounds();
    if !subject.is_ground() {
        return around(bounds, frames, viewport_px);
    }
    let [east_m, north_m] = (bounds.max - bounds.min).truncate().to_array();
    let [low, high] = [bounds.min.z, bounds.max.z];
    let centre = bounds.centre().with_z(low + 0.3 * (high - low));
    let radius_m = 0.62 * east_m.max(north_m);
    let views = (0..frames)
        .map(|i| {
            let angle = std::f64::consts::TAU * (i as f64 / frames as f64 + 0.62);
            let around = DVec3::new(angle.cos(), angle.sin(), 0.0);
            let eye = centre + radius_m * around + DVec3::Z * (0.42 * radius_m + 0.4 * (high - low));
            View { eye, target: centre, fov_y_rad: FOV_Y_RAD, viewport_px }
        })
        .collect();
    CameraPath { views }
}

/// A full turn around a model at one distance: the largest at which a ring of views must stand to hold all of it. The
/// eye comes near and goes away once a turn, so that the front has something to follow.
fn around(bounds: Aabb, frames: usize, viewport_px: [u32; 2]) -> CameraPath {
    let ring = model_views(&bounds.corners(), 4, viewport_px);
    let centre = bounds.centre();
    let farthest_m = ring.iter().map(|v| v.eye.distance(centre)).fold(0.0, f64::max);
    let first = (ring[0].eye - centre).normalize();
    let views = (0..frames)
        .map(|i| {
            let turn = std::f64::consts::TAU * i as f64 / frames as f64;
            let towards_eye = DQuat::from_rotation_z(turn) * first;
            let eye = centre + towards_eye * farthest_m * (0.8 + 0.2 * turn.cos());
            View { eye, target: centre, fov_y_rad: FOV_Y_RAD, viewport_px }
        })
        .collect();
    CameraPath { views }
}

/// A low flight from west to east that keeps to low ground.
pub fn valley_run(terrain: &Terrain, frames: usize, viewport_px: [u32; 2]) -> Result<CameraPath, Error> {
    const COLUMNS: usize = 48;
    const ROWS: usize = 48;
    let level = terrain.overview_level(192);
    terrain.load_level(level)?;
    let [east_m, north_m] = terrain.extent_m();
    // keep off the border: places run from 8 % to 92 %
    let place = |column: usize, row: usize| {
        let share = |k: usize, n: usize| 0.08 + 0.84 * k as f64 / (n - 1) as f64;
        [share(column, COLUMNS) * east_m, -share(row, ROWS) * north_m]
    };
    let height_m = |column: usize, row: usize| {
        let [x, y] = place(column, row);
        terrain.rough_height_m(x, y, level)
    };
    // the cheapest way east by dynamic programming: height, and a price for turning aside
    let relief_m = f64::from(terrain.range_m()[1] - terrain.range_m()[0]).max(1.0);
    let mut cost: Vec<f64> = (0..ROWS).map(|r| height_m(0, r)).collect();
    let mut from: Vec<Vec<usize>> = Vec::new();
    for column in 1..COLUMNS {
        let (mut next, mut back) = (Vec::new(), Vec::new());
        for row in 0..ROWS {
            let candidates = row.saturating_sub(1)..=(row + 1).min(ROWS - 1);
            let price = |r: usize| cost[r] + 0.03 * relief_m * (r as f64 - row as f64).abs();
            let best = candidates.min_by(|&a, &b| price(a).total_cmp(&price(b))).unwrap_or(row);
            next.push(price(best) + height_m(column, row));
            back.push(best);
        }
        cost = next;
        from.push(back);
    }
    let mut row = (0..ROWS).min_by(|&a, &b| cost[a].total_cmp(&cost[b])).unwrap_or(0);
    let mut rows = vec![row];
    for back in from.iter().rev() {
        row = back[row];
        rows.push(row);
    }
    rows.reverse();
    let ground: Vec<DVec3> = rows
        .iter()
        .enumerate()
        .map(|(column, &row)| {
            let [x, y] = place(column, row);
            DVec3::new(x, y, height_m(column, row))
        })
        .collect();
    let smooth = |points: &[DVec3], reach: usize| -> Vec<DVec3> {
        (0..points.len())
            .map(|i| {
                let near = &points[i.saturating_sub(reach)..(i + reach + 1).min(points.len())];
                near.iter().sum::<DVec3>() / near.len() as f64
            })
            .collect()
    };
    let clearance_m = 0.12 * relief_m + 0.004 * east_m.max(north_m);
    let mut track = smooth(&smooth(&ground, 3), 3);
    for (i, p) in track.iter_mut().enumerate() {
        let near = &ground[i.saturating_sub(3)..(i + 4).min(ground.len())];
        p.z = near.iter().map(|g| g.z).fold(f64::MIN, f64::max) + clearance_m;
    }
    let track = smooth(&track, 3);
    let at = |t: f64| {
        let t = t.clamp(0.0, (track.len() - 1) as f64);
        let i = (t as usize).min(track.len() - 2);
        track[i].lerp(track[i + 1], t - i as f64)
    };
    let last = (track.len() - 1) as f64;
    let views = (0..frames)
        .map(|i| {
            let t = i as f64 / frames.max(2).saturating_sub(1) as f64 * (last - 6.0);
            let eye = at(t);
            let ahead = at(t + 5.0);
            let target = DVec3::new(ahead.x, ahead.y, ahead.z - 0.5 * clearance_m);
            View { eye, target, fov_y_rad: 1.0, viewport_px }
        })
        .collect();
    Ok(CameraPath { views })
}

/// Reads a recorded path.
pub fn read_path(subject: &impl Subject, file: &Path, viewport_px: [u32; 2]) -> Result<CameraPath, Error> {
    let text = std::fs::read_to_string(file).map_err(|source| Error::File { path: file.to_owned(), source })?;
    let recorded: Recorded = serde_json::from_str(&text).map_err(|e| {
        Error::Request(format!("{}: expected a camera path ({{\"fov_deg\": …, \"frames\": [{{\"eye\": [x, y, z], \"target\": [x, y, z]}}, …]}}): {e}", file.display()))
    })?;
    let finite = recorded.frames.iter().all(|f| f.eye.iter().chain(&f.target).all(|v| v.is_finite()));
    if recorded.frames.is_empty() || !finite || !(1.0..=170.0).contains(&recorded.fov_deg) {
        return Err(Error::Request(format!(
            "{}: expected at least one frame of finite numbers and a field of view of 1 to 170 degrees",
            file.display()
        )));
    }
    let fov = recorded.fov_deg.to_radians();
    let views =
        recorded.frames.iter().map(|f| crate::view_between(subject, f.eye, f.target, fov, viewport_px)).collect();
    Ok(CameraPath { views })
}

/// Writes a path for [`read_path`].
pub fn write_path(subject: &impl Subject, path: &CameraPath, file: &Path) -> Result<(), Error> {
    let source = |p: DVec3| subject.source_from_local(p).to_array();
    let recorded = Recorded {
        fov_deg: path.views.first().map_or(FOV_Y_RAD, |v| v.fov_y_rad).to_degrees(),
        frames: path.views.iter().map(|v| RecordedFrame { eye: source(v.eye), target: source(v.target) }).collect(),
    };
    let text = serde_json::to_string_pretty(&recorded).map_err(|e| Error::Request(e.to_string()))?;
    std::fs::write(file, text).map_err(|source| Error::File { path: file.to_owned(), source })
}
