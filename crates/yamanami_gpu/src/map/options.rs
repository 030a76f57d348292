//! Style of a picture of a deformed map.

use super::{HorizonTable, MapTextures};
use crate::Wireframe;
use std::sync::Arc;
use yamanami_core::MapView;

/// Style of a picture of a deformed map. Colours are mixed as sRGB stores them; only the mean over a pixel's samples is
/// taken of linear light.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MapOptions {
    /// Pictures of the ground, laid over it.
    pub textures: Arc<MapTextures>,
    /// Ground where the textures show nothing: sRGB and straight alpha. Transparent by default.
    pub ground: [u8; 4],
    /// Ground that no eye sees.
    pub veil: Option<Veil>,
    /// Edges drawn over the ground that is seen.
    pub wireframe: Option<Wireframe>,
    /// What lies under and beside the map: sRGB and straight alpha. Transparent by default; windows want an opaque one.
    pub background: [u8; 4],
    /// Four samples a pixel instead of one (on a GPU for borders only), and the pictures' mean over each instead of their
    /// colour in its middle: for still pictures.
    pub antialias: bool,
}

/// Treats ground that hides behind other ground as the eye of its azimuth sees it. With α = 0 such ground is drawn over
/// anyway; with α > 0 the plane's share brings it forth.
#[derive(Debug, Clone, PartialEq)]
pub struct Veil {
    /// How high the horizon stands before each point.
    pub horizon: Arc<HorizonTable>,
    /// What becomes of hidden ground.
    pub hidden: Hidden,
    /// Ground this many pixels of the panorama (α = 0) below its horizon still counts as seen; from twice as many on it
    /// is hidden. The table's own errors should be less.
    pub slack_px: f32,
}

/// What becomes of hidden ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hidden {
    /// Nothing is drawn there.
    Dropped,
    /// A colour (sRGB) takes this share of it, 0 to 1.
    Veiled([u8; 3], f32),
}

impl Veil {
    /// Half tangents by which ground may lie below its horizon in this view, and still count as seen.
    pub(crate) fn slack(&self, view: &MapView) -> f32 {
        (f64::from(self.slack_px.max(1e-3)) / (view.ring_px * view.map.scale)) as f32
    }
}

/// Colour and alpha from 0 to 1, colour times alpha.
pub(crate) fn premultiplied(rgba: [u8; 4]) -> [f32; 4] {
    let [r, g, b, a] = rgba.map(|v| f32::from(v) / 255.0);
    [r * a, g * a, b * a, a]
}
