//! Which triangles a view sees.

use super::raster::FOUR_SAMPLES;
use super::{BAND_ROWS, MAX_SIDE_PX, Scene};
use crate::frame::check_size;
use crate::{GpuError, RenderOptions, ResidentBuffers};
use glam::Vec3;
use rayon::prelude::*;
use yamanami_core::View;

/// What a view sees of a mesh, triangle by triangle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Visibility {
    /// Samples at which each triangle shows, four a pixel.
    pub samples: Vec<u32>,
    /// Whether each triangle may be seen: it shows at a sample, or one of its corners or its middle is not hidden behind
    /// all that shows around there. Triangles smaller than the samples' distance are found by the latter.
    pub may_be_seen: Vec<bool>,
}

/// Surfaces this much farther, relatively, than what shows are still taken for the same.
const SLACK: f32 = 1e-4;

/// Finds what a view sees of a mesh. Triangles are those of [`ResidentBuffers::triangles`].
pub fn visibility(buffers: &ResidentBuffers, view: &View) -> Result<Visibility, GpuError> {
    check_size(view.viewport_px, MAX_SIDE_PX)?;
    let [width, height] = view.viewport_px.map(|side| side as usize);
    let scene = Scene::new(buffers, view, &RenderOptions::default(), &FOUR_SAMPLES);
    let bands: Vec<(Vec<u32>, Vec<f32>)> = (0..height.div_ceil(BAND_ROWS))
        .into_par_iter()
        .map(|number| {
            let band = scene.draw_band::<4>(number, &FOUR_SAMPLES);
            (band.shown_slots().collect(), band.farthest().collect())
        })
        .collect();
    let mut samples = vec![0u32; buffers.triangles().len()];
    let mut farthest = Vec::with_capacity(width * height);
    for (slots, depths) in bands {
        slots.into_iter().for_each(|slot| samples[slot as usize] += 1);
        farthest.extend(depths);
    }
    let shows = |clip: Vec3| {
        let at = |ndc: f32, side: usize| {
            let pixel = (0.5 + 0.5 * ndc) * side as f32;
            (pixel >= 0.0 && pixel < side as f32).then_some(pixel as usize)
        };
        if clip.z < scene.frame.ray_forward[3] {
            return false;
        }
        let (Some(x), Some(y)) = (at(clip.x / clip.z, width), at(-clip.y / clip.z, height)) else { return false };
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        let around = rows.flat_map(|row| {
            let columns = x.saturating_sub(1)..(x + 2).min(width);
            columns.map(move |column| row * width + column)
        });
        let behind = around.map(|pixel| farthest[pixel]).fold(f32::INFINITY, f32::min);
        1.0 / clip.z >= behind * (1.0 - SLACK)
    };
    let vertices: Vec<bool> = scene.vertices.par_iter().map(|vertex| shows(vertex.clip)).collect();
    let may_be_seen = buffers
        .triangles()
        .par_iter()
        .zip(&samples)
        .map(|(corners, &samples)| {
            let middle = || corners.iter().map(|&c| scene.vertices[c as usize].clip).sum::<Vec3>() / 3.0;
            samples > 0 || corners.iter().any(|&c| vertices[c as usize]) || shows(middle())
        })
        .collect();
    Ok(Visibility { samples, may_be_seen })
}
