//! Which way a flight goes, and how fast.

use crate::failure::Failure;
use crate::values;
use clap::Args;
use std::path::Path;
use yamanami::core::View;
use yamanami::{CameraPath, Subject, orbit, read_path, valley_run};

/// The camera path.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Path")]
pub(crate) struct PathArgs {
    /// orbit, valley or a recorded path (.json); else along the valleys of a terrain, and around a model
    #[arg(long, value_name = "PATH")]
    pub(crate) path: Option<String>,
    /// Frames; a recorded path has its own number
    #[arg(long, value_name = "N", value_parser = values::frames)]
    pub(crate) frames: Option<usize>,
    /// Metres that the eye moves each frame
    #[arg(long, value_name = "M", value_parser = values::positive)]
    pub(crate) speed: Option<f64>,
}

/// Frames of a built-in path.
const USUAL_FRAMES: usize = 240;
/// Views of a built-in path before it is flown at a speed.
const DENSE_VIEWS: usize = 4096;
/// Most frames of a flight whose number of frames follows from its speed.
const MOST_FRAMES: f64 = 100_000.0;

impl PathArgs {
    /// The path's name.
    pub(crate) fn name(&self, subject: &impl Subject) -> &str {
        let usual = if subject.as_terrain().is_some() { "valley" } else { "orbit" };
        self.path.as_deref().unwrap_or(usual)
    }

    /// The views of the flight.
    pub(crate) fn views(&self, subject: &impl Subject, viewport_px: [u32; 2]) -> Result<CameraPath, Failure> {
        let views = if self.speed.is_some() { DENSE_VIEWS } else { self.frames.unwrap_or(USUAL_FRAMES) };
        let (path, closed) = match self.name(subject) {
            "orbit" => (orbit(subject, views, viewport_px), true),
            "valley" => {
                let terrain =
                    subject.as_terrain().ok_or_else(|| Failure::misuse("--path valley: a model has no valleys"))?;
                (valley_run(terrain, views, viewport_px)?, false)
            }
            file if file.to_lowercase().ends_with(".json") => {
                let recorded = read_path(subject, Path::new(file), viewport_px)?;
                match (self.frames, self.speed) {
                    (Some(frames), None) => return Ok(evenly(&recorded, frames)),
                    _ => (recorded, false),
                }
            }
            other => {
                return Err(Failure::misuse(format!(
                    "--path: expected orbit, valley or a .json file, given '{other}'"
                )));
            }
        };
        Ok(match self.speed {
            Some(speed_m) => at_speed(&path, speed_m, self.frames, closed),
            None => path,
        })
    }
}

fn between(a: &View, b: &View, t: f64) -> View {
    View { eye: a.eye.lerp(b.eye, t), target: a.target.lerp(b.target, t), ..*a }
}

/// A path of another number of frames over the same way.
fn evenly(path: &CameraPath, frames: usize) -> CameraPath {
    let last = path.views.len() - 1;
    let view = |i: usize| {
        let t = i as f64 / (frames.max(2) - 1) as f64 * last as f64;
        let k = (t as usize).min(last);
        between(&path.views[k], &path.views[(k + 1).min(last)], t - k as f64)
    };
    CameraPath { views: (0..frames).map(view).collect() }
}

/// The same way at so many metres a frame: round and round when it is closed, else to its end.
fn at_speed(path: &CameraPath, speed_m: f64, frames: Option<usize>, closed: bool) -> CameraPath {
    let mut views = path.views.clone();
    if closed {
        views.extend(path.views.first().copied());
    }
    let mut way_m = vec![0.0];
    for pair in views.windows(2) {
        way_m.push(way_m[way_m.len() - 1] + pair[0].eye.distance(pair[1].eye));
    }
    let length_m = way_m[way_m.len() - 1];
    if length_m <= 0.0 {
        return CameraPath { views: path.views[..1].to_vec() };
    }
    let whole = (length_m / speed_m).min(MOST_FRAMES) as usize + 1;
    let frames = if closed { frames.unwrap_or(whole) } else { frames.unwrap_or(whole).min(whole) };
    let view = |i: usize| {
        let at_m = (i as f64 * speed_m) % (length_m * (1.0 + 1e-12));
        let k = way_m.partition_point(|&m| m <= at_m).clamp(1, views.len() - 1);
        let step_m = way_m[k] - way_m[k - 1];
        let t = if step_m > 0.0 { ((at_m - way_m[k - 1]) / step_m).min(1.0) } else { 0.0 };
        between(&views[k - 1], &views[k], t)
    };
    CameraPath { views: (0..frames).map(view).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn straight() -> CameraPath {
        let view =
            |x: f64| View { eye: DVec3::X * x, target: DVec3::X * x + DVec3::Y, fov_y_rad: 1.0, viewport_px: [64, 64] };
        CameraPath { views: [0.0, 10.0, 100.0].map(view).to_vec() }
    }

    #[test]
    fn every_frame_moves_as_far() {
        let path = at_speed(&straight(), 15.0, None, false);
        assert_eq!(path.views.len(), 7);
        for (i, view) in path.views.iter().enumerate() {
            assert!((view.eye.x - 15.0 * i as f64).abs() < 1e-9);
        }
        assert_eq!(at_speed(&straight(), 15.0, Some(3), false).views.len(), 3);
        let around = at_speed(&straight(), 30.0, Some(8), true);
        assert_eq!(around.views.len(), 8, "a closed path goes on");
        assert!((around.views[7].eye.x - 10.0).abs() < 1e-6, "{}", around.views[7].eye.x);
    }

    #[test]
    fn ends_stay_ends() {
        let path = evenly(&straight(), 5);
        assert_eq!((path.views[0].eye.x, path.views[4].eye.x), (0.0, 100.0));
        assert_eq!(evenly(&straight(), 1).views.len(), 1);
    }
}
