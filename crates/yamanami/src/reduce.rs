//! A model with fewer polygons: to a number, to an error, or to what a display can show.
//!
//! Based on: Mizuno, Okumoto, Takata, Joe: the pixels that a model covers on a display, times a number of polygons a pixel.

use crate::model_picture::model_pixels;
use crate::{Canvas, DrawWith, Error};
use yamanami_core::{TriangleMesh, View};
use yamanami_multires::collapse::{CollapseOptions, Collapsed, CollapsedWithin, StoppedBy, collapse, collapse_within};

/// Polygons a pixel that Mizuno et al. found to be the least without a visible loss.
pub const POLYGONS_PER_PIXEL: f64 = 50.0;

/// What a display asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplayNeed {
    /// Pixels covered, view by view.
    pub covered_px: Vec<u64>,
    /// The most that any view covers: the base of the count.
    pub pixels: u64,
    /// Faces wanted: `pixels` times the polygons a pixel, rounded.
    pub faces: usize,
}

impl DisplayNeed {
    /// From covered pixels.
    pub fn new(covered_px: Vec<u64>, polygons_per_pixel: f64) -> Self {
        let pixels = covered_px.iter().copied().max().unwrap_or(0);
        Self { pixels, covered_px, faces: (pixels as f64 * polygons_per_pixel).round() as usize }
    }
}

/// Draws a model off-screen in every view, counts the pixels it covers, and says how many faces that asks for.
pub fn display_need(mesh: &TriangleMesh, views: &[View], polygons_per_pixel: f64) -> Result<DisplayNeed, Error> {
    let canvas = Canvas::of_mesh(mesh, DrawWith::Software)?;
    Ok(DisplayNeed::new(model_pixels(&canvas, views)?, polygons_per_pixel))
}

/// What ended a reduction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReducedBy {
    /// Nothing was to be done: the source has no more faces than wanted.
    Nothing,
    /// The faces wanted were reached.
    Faces,
    /// The next step would have cost more error than allowed.
    Error,
    /// No edge was left that may go without harm to the surface.
    Topology,
}

/// A reduced model.
#[derive(Debug, Clone)]
pub struct Reduced {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// What ended it.
    pub by: ReducedBy,
    /// The largest distance of a step by its own estimate, metres.
    pub estimate_m: f64,
    /// The two-sided distance to the source is certain not to be larger, metres; `None` where that was not asked for.
    pub certified_m: Option<f64>,
}

/// Reduces a model as `options` say; one that is small enough is given back as it is.
pub fn reduce(mesh: TriangleMesh, options: &CollapseOptions<'_>) -> Reduced {
    if mesh.triangles.len() <= options.target_faces {
        return Reduced { mesh, by: ReducedBy::Nothing, estimate_m: 0.0, certified_m: None };
    }
    reduced(collapse(&mesh, options), None)
}

/// Reduces a model as far as its surface and the source's are certain to stay within `limit_m` metres of each other, and no
/// further than `options` say.
pub fn reduce_within(mesh: TriangleMesh, limit_m: f64, options: &CollapseOptions<'_>) -> Reduced {
    if mesh.triangles.len() <= options.target_faces {
        return Reduced { mesh, by: ReducedBy::Nothing, estimate_m: 0.0, certified_m: Some(0.0) };
    }
    let CollapsedWithin { collapsed, certified_m } = collapse_within(&mesh, limit_m, options);
    reduced(collapsed, Some(certified_m))
}

fn reduced(collapsed: Collapsed, certified_m: Option<f64>) -> Reduced {
    let Collapsed { mesh, stopped_by, estimate_m, .. } = collapsed;
    let by = match stopped_by {
        StoppedBy::Target => ReducedBy::Faces,
        StoppedBy::Error => ReducedBy::Error,
        StoppedBy::Topology => ReducedBy::Topology,
    };
    Reduced { mesh, by, estimate_m, certified_m }
}
