//! A scene drawn onto the pixels of the ground, in place and by strips.

use super::{Scene, svg::Ground};
use crate::{Fonts, MapError};
use image::RgbaImage;
use rayon::prelude::*;
use resvg::{tiny_skia, usvg};

/// Rows drawn at a time: what is stroked is stroked anew in each strip, and each strip takes its bytes once more.
const STRIP_ROWS: usize = 1024;

impl Scene {
    /// Draws the scene over a picture of the ground (straight alpha). One of another size is scaled first.
    pub fn paint(&self, base: RgbaImage, fonts: &Fonts) -> Result<RgbaImage, MapError> {
        let [width, height] = self.size_px;
        let mut picture = if base.dimensions() == (width, height) {
            base
        } else {
            image::imageops::resize(&base, width, height, image::imageops::FilterType::Triangle)
        };
        let svg = self.written(Ground::None, None, fonts);
        let tree = tree(&svg, usvg::Options { fontdb: fonts.database(), ..usvg::Options::default() })
            .map_err(|cause| MapError::Write("PNG", cause))?;
        let row_bytes = width as usize * 4;
        picture.par_chunks_mut(STRIP_ROWS * row_bytes).enumerate().for_each(|(strip, pixels)| {
            pixels.chunks_exact_mut(4).for_each(|p| premultiply(p, self.paper));
            let rows = (pixels.len() / row_bytes) as u32;
            let up = tiny_skia::Transform::from_translate(0.0, -((strip * STRIP_ROWS) as f32));
            if let Some(mut pixmap) = tiny_skia::PixmapMut::from_bytes(pixels, width, rows) {
                resvg::render(&tree, up, &mut pixmap);
            }
            pixels.chunks_exact_mut(4).for_each(unmultiply);
        });
        Ok(picture)
    }
}

/// Reads a scene written as SVG.
pub(super) fn tree(svg: &str, options: usvg::Options<'_>) -> Result<usvg::Tree, String> {
    // far more elements than a web page has, but we wrote them ourselves
    usvg::Tree::from_str(svg, &options).map_err(|cause| cause.to_string())
}

/// Straight to premultiplied alpha, over paper where there is some.
fn premultiply(pixel: &mut [u8], paper: Option<[u8; 3]>) {
    let alpha = u32::from(pixel[3]);
    if alpha == 255 {
        return;
    }
    let share = |c: u8, part: u32| u32::from(c) * part;
    for c in 0..3 {
        let under = paper.map_or(0, |paper| share(paper[c], 255 - alpha));
        pixel[c] = ((share(pixel[c], alpha) + under + 127) / 255) as u8;
    }
    if paper.is_some() {
        pixel[3] = 255;
    }
}

fn unmultiply(pixel: &mut [u8]) {
    let alpha = u32::from(pixel[3]);
    if alpha == 255 || alpha == 0 {
        return;
    }
    for c in &mut pixel[..3] {
        *c = ((u32::from(*c) * 255 + alpha / 2) / alpha).min(255) as u8;
    }
}
