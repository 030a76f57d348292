//! Pictures of models: grey or in their own colours, before a plain background.

use crate::{Canvas, Error};
use yamanami_core::{TriangleMesh, View};
use yamanami_gpu::{Background, ColourBy, Haze, RenderOptions, Shading, software};

/// Behind models: light and neutral.
pub const MODEL_BACKGROUND: [u8; 3] = [240, 241, 242];

/// Models without colours of their own.
const GREY: [u8; 3] = [196, 196, 196];

/// How models are drawn: in the colours of their vertices, grey where they have none; the insides, which show through
/// holes, are darker.
pub fn model_style(mesh: &TriangleMesh) -> RenderOptions {
    coloured_style(!mesh.colours.is_empty() && mesh.colours.len() == mesh.positions.len())
}

/// The same for a model that is not at hand as a mesh.
pub fn coloured_style(has_colours: bool) -> RenderOptions {
    RenderOptions {
        colour: if has_colours { ColourBy::Vertex } else { ColourBy::Plain(GREY) },
        shading: Shading::Model,
        haze: Haze::None,
        background: Background::Plain(MODEL_BACKGROUND),
        ..RenderOptions::default()
    }
}

/// Pixels whose middle a model covers, view by view. Always counted in software, so that every machine counts alike.
pub fn model_pixels(canvas: &Canvas, views: &[View]) -> Result<Vec<u64>, Error> {
    views.iter().map(|view| Ok(software::covered_pixels(canvas.buffers(), view)?)).collect()
}
