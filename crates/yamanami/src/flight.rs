//! Flights: a camera path replayed frame by frame, and what each frame cost.

use crate::scene::morph_of;
use crate::{CameraPath, Canvas, Criteria, Error, LimitedBy, Lod, Scene, Subject, ViewCriterion};
use image::RgbaImage;
use serde::Serialize;
use web_time::Instant;
use yamanami_gpu::RenderOptions;

/// How changes reach the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FlightMode {
    /// By differences.
    #[default]
    Differences,
    /// Everything anew each frame, for comparison.
    Rebuild,
}

/// How to fly.
#[derive(Debug, Clone)]
pub struct FlightOptions {
    /// The controls; their view is set from the path, its tolerance and culling kept. Without a view, 1 pixel.
    pub criteria: Criteria,
    /// Which control.
    pub lod: Lod,
    /// Differences or rebuild.
    pub mode: FlightMode,
    /// Whether to draw each frame.
    pub draw: bool,
    /// Style of the pictures.
    pub style: RenderOptions,
    /// Details fade in.
    pub morph: bool,
}

/// One frame of a flight.
#[derive(Debug, Clone, Serialize)]
pub struct FrameStats {
    /// Triangles shown.
    pub triangles: usize,
    /// Nodes applied.
    pub refined: usize,
    /// Nodes undone.
    pub coarsened: usize,
    /// Nodes weighed by the controller.
    pub weighed: usize,
    /// Finding the front and changing the mesh in memory, milliseconds.
    pub update_ms: f64,
    /// Writing the change, milliseconds.
    pub upload_ms: f64,
    /// Bytes written.
    pub upload_bytes: u64,
    /// Separate ranges written.
    pub upload_writes: u64,
    /// Drawing, with reading the picture back, milliseconds; 0 when not drawn.
    pub draw_ms: f64,
    /// No node left out has a larger error on the screen, pixels (the paper's staircase: metres of its top step).
    pub error_px: f32,
    /// Pages read from the database.
    pub pages: usize,
    /// What bound the front: `tolerance`, `budget`, `residency` or `steps`.
    pub limited_by: &'static str,
}

/// Flies a path; `each` hears of every frame, with its picture when drawn.
pub fn fly(
    subject: &mut impl Subject,
    canvas: Canvas,
    path: &CameraPath,
    options: &FlightOptions,
    mut each: impl FnMut(usize, &FrameStats, Option<&RgbaImage>) -> Result<(), Error>,
) -> Result<Vec<FrameStats>, Error> {
    let mut scene = match &options.lod {
        Lod::Exact => Scene::new(subject, canvas),
        Lod::Paper(staircase) => Scene::with_staircase(subject, canvas, staircase.clone()),
    };
    let mut frames = Vec::with_capacity(path.views.len());
    let asked = options.criteria.view;
    for (i, &view) in path.views.iter().enumerate() {
        let criterion = ViewCriterion {
            view,
            tolerance_px: asked.map_or(1.0, |v| v.tolerance_px),
            cull: asked.is_none_or(|v| v.cull),
        };
        let criteria = Criteria { view: Some(criterion), ..options.criteria };
        let update = match options.mode {
            FlightMode::Differences => scene.update(subject, &criteria)?,
            FlightMode::Rebuild => scene.rebuild(subject, &criteria)?,
        };
        let mut draw_ms = 0.0;
        let mut picture = None;
        if options.draw {
            let mut style = options.style.clone();
            if options.morph && options.lod == Lod::Exact {
                style.morph = Some(morph_of(&update.report));
            }
            let started = Instant::now();
            picture = Some(scene.draw(&view, &style)?);
            draw_ms = started.elapsed().as_secs_f64() * 1e3;
        }
        let stats = FrameStats {
            triangles: update.report.triangles,
            refined: update.report.refined,
            coarsened: update.report.coarsened,
            weighed: update.report.weighed,
            update_ms: update.update_time.as_secs_f64() * 1e3,
            upload_ms: update.upload_time.as_secs_f64() * 1e3,
            upload_bytes: update.upload.bytes,
            upload_writes: update.upload.writes,
            draw_ms,
            error_px: update.report.error_left,
            pages: update.pages,
            limited_by: match update.report.limited_by {
                LimitedBy::Tolerance => "tolerance",
                LimitedBy::Budget => "budget",
                LimitedBy::Residency => "residency",
                LimitedBy::Steps => "steps",
            },
        };
        each(i, &stats, picture.as_ref())?;
        frames.push(stats);
    }
    Ok(frames)
}
