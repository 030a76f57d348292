//! How many triangles a second this machine draws: R of the paper, from which N_T = R / v.

use crate::{Canvas, DrawWith, Error, Scene, Subject, overview};
use std::time::Instant;
use yamanami_gpu::RenderOptions;

/// Triangles of the mesh that is timed.
const TIMED_TRIANGLES: u32 = 100_000;

/// Triangles a second drawn off-screen at this picture size: the best of a few frames of a mesh of this terrain or model.
pub fn measure_rate(subject: &mut impl Subject, with: DrawWith, viewport_px: [u32; 2]) -> Result<f64, Error> {
    let mut scene = Scene::new(subject, Canvas::new(subject.bounds().centre(), with)?);
    let view = overview(subject, viewport_px);
    let criteria = crate::Criteria { budget_triangles: Some(TIMED_TRIANGLES), ..crate::Criteria::default() };
    let mut triangles = 0;
    for _ in 0..8 {
        let update = scene.update(subject, &criteria)?;
        triangles = update.report.triangles;
        if update.pages == 0 {
            break;
        }
    }
    let mut best_s = f64::INFINITY;
    for _ in 0..4 {
        let started = Instant::now();
        scene.draw(&view, &RenderOptions::default())?;
        best_s = best_s.min(started.elapsed().as_secs_f64());
    }
    Ok(triangles as f64 / best_s)
}

/// The budget for a frame rate: N_T = R / v.
pub fn triangles_at_rate(triangles_per_s: f64, frames_per_s: f64) -> u32 {
    (triangles_per_s / frames_per_s.max(1e-3)).clamp(2.0, f64::from(u32::MAX)) as u32
}
