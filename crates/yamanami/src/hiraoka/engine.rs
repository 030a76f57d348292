//! The engine beside the paper's method: the hierarchy of clusters on the same ground and from the same eye.

use super::pictures::FullPicture;
use crate::Error;
use yamanami_core::{TriangleMesh, View};

/// What the engine did.
#[derive(Debug, Clone)]
pub(super) struct EngineRow {
    pub(super) name: &'static str,
    pub(super) build_s: f64,
    /// Median time of finding the front from nothing, and of the update when the eye has moved by a metre.
    pub(super) median_ms: f64,
    pub(super) triangles: usize,
    pub(super) ssim: f64,
    pub(super) flip: f64,
}

/// Draws a TIN with the engine.
pub(super) fn engine(
    _tin: &TriangleMesh,
    _view: &View,
    _full: &FullPicture,
    _progress: &dyn Fn(&str),
) -> Result<Option<EngineRow>, Error> {
    Ok(None)
}
