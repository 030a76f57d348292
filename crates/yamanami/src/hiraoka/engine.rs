//! The engine beside the paper's method: the hierarchy of clusters on the same ground and from the same eye.

use super::pictures::FullPicture;
use crate::{Canvas, Criteria, DrawWith, Error, ModelBuild, Scene, ViewCriterion};
use std::time::Instant;
use yamanami_core::{Tin, TriangleMesh, View};
use yamanami_measure::{FLIP_PIXELS_PER_DEGREE, flip, ssim};

/// Frames after the first, the eye going ahead by [`STEP_M`] in each.
const FRAMES: usize = 60;
const STEP_M: f64 = 10.0;

/// What the engine did.
#[derive(Debug, Clone)]
pub(super) struct EngineRow {
    pub(super) name: String,
    /// Time to find and mesh the first front from the base mesh, and the mean of the frames after it.
    pub(super) first_ms: f64,
    pub(super) next_ms: f64,
    /// Of the first front: all triangles, those out of view too, where the front stays coarse.
    pub(super) triangles: usize,
    pub(super) error_px: f64,
    pub(super) ssim: f64,
    pub(super) flip: f64,
}

/// What the engine did with a ground.
#[derive(Debug, Clone)]
pub(super) struct EngineFound {
    pub(super) build_s: f64,
    pub(super) rows: Vec<EngineRow>,
}

/// Draws a TIN with the engine: to a pixel, and with as many triangles as the paper's method drew.
pub(super) fn engine(
    tin: &TriangleMesh,
    view: &View,
    full: &FullPicture,
    paper_triangles: usize,
) -> Result<EngineFound, Error> {
    let start = Instant::now();
    let tin = Tin::of_mesh("hiraoka", tin.clone());
    let mut model = ModelBuild::of_tin(&tin, tin.name.clone(), &|_| ())?.into_model()?;
    drop(tin);
    let build_s = start.elapsed().as_secs_f64();
    let mut rows = Vec::new();
    let runs = [
        ("yamanami, within a pixel".to_owned(), 1.0, None),
        ("yamanami, as many triangles".to_owned(), 0.0, Some(paper_triangles as u32)),
    ];
    for (name, tolerance_px, budget_triangles) in runs {
        let mut scene = Scene::new(&model, Canvas::new(view.eye, DrawWith::Software)?);
        let mut update = |scene: &mut Scene, ahead_m: f64| {
            let ahead = view.forward() * ahead_m;
            let view = View { eye: view.eye + ahead, target: view.target + ahead, ..*view };
            let criterion = ViewCriterion { view, tolerance_px, cull: true };
            scene.update(&mut model, &Criteria { view: Some(criterion), budget_triangles, ..Criteria::default() })
        };
        let first = update(&mut scene, 0.0)?;
        let picture = scene.draw(view, full.style())?;
        let mut next_ms = 0.0;
        for frame in 1..=FRAMES {
            next_ms += 1e3 * update(&mut scene, frame as f64 * STEP_M)?.update_time.as_secs_f64() / FRAMES as f64;
        }
        rows.push(EngineRow {
            name,
            first_ms: 1e3 * first.update_time.as_secs_f64(),
            next_ms,
            triangles: first.report.triangles,
            error_px: f64::from(first.report.error_left),
            ssim: ssim(full.picture(), &picture)?,
            flip: flip(full.picture(), &picture, FLIP_PIXELS_PER_DEGREE)?.mean,
        });
    }
    Ok(EngineFound { build_s, rows })
}
