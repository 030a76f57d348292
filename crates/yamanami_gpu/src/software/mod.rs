//! Drawing without any graphics driver: the readable twin of the GPU's passes.
//!
//! Like a GPU it snaps corners to 1/256 pixel, decides coverage at four samples a pixel by exact integer edge functions
//! with the top-left rule, and keeps the nearest surface of each sample, so that no pixel of a shared edge is lost or
//! drawn twice. Colours are worked out last, once for each triangle that shows in a pixel. Based on: Juan Pineda, "A
//! Parallel Algorithm for Polygon Rasterization", 1988; Marc Olano, Trey Greer, "Triangle Scan Conversion using 2D
//! Homogeneous Coordinates", 1997 (attributes without clipping); Christopher Burns, Warren Hunt, "The Visibility Buffer",
//! 2013.

pub mod map;
mod place;
mod raster;
mod resolve;
mod seen;

pub use seen::{Visibility, visibility};

use crate::frame::{Frame, check_size};
use crate::palette::SrgbEncoder;
use crate::{GpuError, RenderOptions, ResidentBuffers};
use image::RgbaImage;
use place::{PlacedVertex, ScreenTriangle};
use raster::{Band, CENTRE, FOUR_SAMPLES, Sample};
use rayon::prelude::*;
use resolve::Resolver;
use yamanami_core::View;

/// Longest side of a picture drawn in software.
pub const MAX_SIDE_PX: u32 = 16_384;

/// Rows of a band, the unit of parallel work.
const BAND_ROWS: usize = 16;

/// Draws a mesh. Equal inputs give equal pictures, whatever the number of threads.
pub fn render_to_image(buffers: &ResidentBuffers, view: &View, options: &RenderOptions) -> Result<RgbaImage, GpuError> {
    check_size(view.viewport_px, MAX_SIDE_PX)?;
    let [width, height] = view.viewport_px;
    let samples: &[Sample] = if options.antialias { &FOUR_SAMPLES } else { &CENTRE };
    let scene = Scene::new(buffers, view, options, samples);
    let resolver = Resolver::new(buffers, &scene.frame, &scene.vertices, options.drape.as_deref(), SrgbEncoder::new());
    let mut pixels = vec![0u8; width as usize * height as usize * 4];
    let row_bytes = width as usize * 4;
    pixels.par_chunks_mut(row_bytes * BAND_ROWS).enumerate().for_each(|(number, rows)| {
        if options.antialias {
            let band = scene.draw_band::<4>(number, &FOUR_SAMPLES);
            resolver.colour_band(&band, &FOUR_SAMPLES, rows);
        } else {
            let band = scene.draw_band::<1>(number, &CENTRE);
            resolver.colour_band(&band, &CENTRE, rows);
        }
    });
    // The buffer is as long as the image asks, so there always is an image.
    Ok(RgbaImage::from_raw(width, height, pixels).unwrap_or_default())
}

/// Number of pixels whose middle the mesh covers in this view.
pub fn covered_pixels(buffers: &ResidentBuffers, view: &View) -> Result<u64, GpuError> {
    check_size(view.viewport_px, MAX_SIDE_PX)?;
    let scene = Scene::new(buffers, view, &RenderOptions::default(), &CENTRE);
    let bands = (view.viewport_px[1] as usize).div_ceil(BAND_ROWS);
    let count = |number| scene.draw_band::<1>(number, &CENTRE).covered_samples();
    Ok((0..bands).into_par_iter().map(count).sum())
}

/// A mesh as seen, sorted into bands of rows.
struct Scene {
    frame: Frame,
    vertices: Vec<PlacedVertex>,
    triangles: Vec<ScreenTriangle>,
    /// Triangles of each band, in drawing order.
    bands: Vec<Vec<u32>>,
}

impl Scene {
    fn new(buffers: &ResidentBuffers, view: &View, options: &RenderOptions, samples: &[Sample]) -> Self {
        let frame = Frame::new(buffers.origin(), buffers.bounds(), view, options);
        let vertices: Vec<PlacedVertex> =
            buffers.vertices().par_iter().map(|vertex| PlacedVertex::new(&frame, vertex)).collect();
        let triangles = place::screen_triangles(&frame, &vertices, buffers.triangles(), samples);
        let mut bands = vec![Vec::new(); (view.viewport_px[1] as usize).div_ceil(BAND_ROWS)];
        for (number, triangle) in (0u32..).zip(&triangles) {
            let [_, rows] = triangle.pixel_box(view.viewport_px);
            if !rows.is_empty() {
                for band in &mut bands[rows.start / BAND_ROWS..=(rows.end - 1) / BAND_ROWS] {
                    band.push(number);
                }
            }
        }
        Self { frame, vertices, triangles, bands }
    }

    fn draw_band<const N: usize>(&self, number: usize, samples: &[Sample; N]) -> Band<N> {
        let size_px = self.frame.size_px.map(|side| side as usize);
        let first_row = number * BAND_ROWS;
        let mut band = Band::new(size_px, first_row..(first_row + BAND_ROWS).min(size_px[1]));
        for &triangle in &self.bands[number] {
            band.draw(&self.triangles[triangle as usize], samples);
        }
        band
    }
}
