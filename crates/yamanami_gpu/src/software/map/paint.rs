//! Colours of a map's pixels: the fragment shader's twin (`shaders/map.wgsl`).

use super::MapScene;
use super::scene::{Seen, by_bands};
use crate::frame::check_size;
use crate::map::premultiplied;
use crate::palette::{SrgbEncoder, srgb_to_linear};
use crate::shade::wire_share;
use crate::software::{BAND_ROWS, MAX_SIDE_PX};
use crate::{GpuError, Hidden, MapOptions, ResidentBuffers, Veil};
use glam::{Vec3, Vec4};
use image::RgbaImage;
use std::ops::Range;
use yamanami_core::MapView;

/// Samples a side of a pixel when a picture is antialiased.
const OVERSAMPLING: u32 = 2;

/// Paints a map by strips of rows, so that large pictures need not be in memory at once.
#[derive(Debug)]
pub struct MapPainter<'a> {
    scene: MapScene<'a>,
    options: &'a MapOptions,
    /// The picture's own size, and samples a side of its pixels.
    size_px: [u32; 2],
    factor: u32,
    slack: f32,
    ground: Vec4,
    background: Vec4,
    encoder: SrgbEncoder,
    decode: Vec<f32>,
}

/// Draws a map. The background is transparent unless the options say otherwise; alpha is straight. Equal inputs give equal
/// pictures, whatever the number of threads.
pub fn render_to_image(buffers: &ResidentBuffers, view: &MapView, options: &MapOptions) -> Result<RgbaImage, GpuError> {
    let [width, height] = view.size_px;
    let pixels = MapPainter::new(buffers, view, options)?.paint_rows(0..height);
    // The pixels are as many as the image asks, so there always is an image.
    Ok(RgbaImage::from_raw(width, height, pixels).unwrap_or_default())
}

impl<'a> MapPainter<'a> {
    /// Places a mesh in the picture of a map.
    pub fn new(buffers: &'a ResidentBuffers, view: &MapView, options: &'a MapOptions) -> Result<Self, GpuError> {
        check_size(view.size_px, MAX_SIDE_PX)?;
        let factor = if options.antialias { OVERSAMPLING } else { 1 };
        let sampled = MapView {
            size_px: view.size_px.map(|side| side * factor),
            centre_px: view.centre_px * f64::from(factor),
            ring_px: view.ring_px * f64::from(factor),
            ..*view
        };
        Ok(Self {
            scene: MapScene::of(buffers, sampled),
            options,
            size_px: view.size_px,
            factor,
            slack: options.veil.as_ref().map_or(1.0, |veil| veil.slack(view)),
            ground: Vec4::from_array(premultiplied(options.ground)),
            background: Vec4::from_array(premultiplied(options.background)),
            encoder: SrgbEncoder::new(),
            decode: (0..=255u8).map(|v| srgb_to_linear(f32::from(v) / 255.0)).collect(),
        })
    }

    /// Bytes of some rows, sRGB and straight alpha; rows outside the picture are left out.
    pub fn paint_rows(&self, rows: Range<u32>) -> Vec<u8> {
        let [width, height] = self.size_px;
        let end = rows.end.min(height);
        let rows = rows.start.min(end)..end;
        let factor = self.factor as usize;
        let mut pixels = vec![[0u8; 4]; width as usize * rows.len()];
        by_bands(rows, BAND_ROWS / factor, width as usize, &mut pixels, |rows, pixels| {
            if factor == 1 {
                self.paint_samples(rows, pixels);
                return;
            }
            let row = width as usize * factor;
            let mut samples = vec![[0u8; 4]; row * rows.len() * factor];
            self.paint_samples(rows.start * factor..rows.end * factor, &mut samples);
            for (pixels, samples) in pixels.chunks_exact_mut(width as usize).zip(samples.chunks_exact(row * factor)) {
                for (column, pixel) in pixels.iter_mut().enumerate() {
                    let at = column * factor;
                    *pixel = self.mean([samples[at], samples[at + 1], samples[row + at], samples[row + at + 1]]);
                }
            }
        });
        pixels.into_flattened()
    }

    /// Paints whole rows of samples of one band.
    fn paint_samples(&self, rows: Range<usize>, samples: &mut [[u8; 4]]) {
        samples.fill(straight(self.background));
        self.scene.visit(rows, |sample, seen| {
            let colour = self.colour(&seen);
            samples[sample] = straight(colour + self.background * (1.0 - colour.w));
        });
    }

    /// Colour times alpha, and alpha, of ground that is seen.
    fn colour(&self, seen: &Seen<'_>) -> Vec4 {
        let textures = &self.options.textures;
        let mut colour = if self.options.antialias {
            let [right, down] = seen.run.steps_m();
            textures.mean_colour(seen.place.truncate(), right, down)
        } else {
            textures.colour(seen.place.x, seen.place.y)
        };
        colour += self.ground * (1.0 - colour.w);
        if let Some(wire) = self.options.wireframe {
            // the width is that of the picture's pixels
            let slopes = seen.run.slopes_per_px() * self.factor as f32;
            let share = wire_share(seen.shares, slopes, wire.width_px, wire.opacity);
            colour = colour.lerp(Vec4::from_array(premultiplied(opaque(wire.colour))), share);
        }
        let Some(veil) = &self.options.veil else { return colour };
        let hidden = self.hidden_share(veil, seen.place);
        match veil.hidden {
            Hidden::Dropped => colour * (1.0 - hidden),
            Hidden::Veiled(veil, share) => {
                let veiled = Vec4::from_array(premultiplied(opaque(veil))) * colour.w;
                colour.lerp(veiled, hidden * share)
            }
        }
    }

    /// How far below its horizon ground lies: 0 where it is seen, 1 where it is not.
    fn hidden_share(&self, veil: &Veil, place: Vec3) -> f32 {
        let map = &self.scene.view().map;
        let out = place.truncate().as_dvec2() - map.centre;
        let distance_m = out.length();
        if distance_m <= map.ring_m {
            return 0.0;
        }
        let horizon = veil.horizon.half_tangent(out.x.atan2(out.y), distance_m);
        let below = horizon - map.half_tangent(distance_m, f64::from(place.z)) as f32;
        (below / self.slack - 1.0).clamp(0.0, 1.0)
    }

    /// Mean of four samples in linear light.
    fn mean(&self, samples: [[u8; 4]; 4]) -> [u8; 4] {
        if samples[1..].iter().all(|sample| *sample == samples[0]) {
            return samples[0];
        }
        let mut sum = Vec4::ZERO;
        for [r, g, b, a] in samples {
            let [r, g, b] = [r, g, b].map(|v| self.decode[usize::from(v)]);
            sum += Vec4::new(r, g, b, 1.0) * (f32::from(a) / 255.0);
        }
        if sum.w == 0.0 {
            return [0; 4];
        }
        let colour = sum.truncate() / sum.w;
        let alpha = (sum.w * (255.0 / 4.0) + 0.5) as u8;
        [
            self.encoder.byte(colour.x),
            self.encoder.byte(colour.y),
            self.encoder.byte(colour.z),
            alpha,
        ]
    }
}

fn opaque([r, g, b]: [u8; 3]) -> [u8; 4] {
    [r, g, b, 255]
}

/// Bytes with straight alpha of a colour times alpha.
#[inline]
fn straight(colour: Vec4) -> [u8; 4] {
    if colour.w <= 0.0 {
        return [0; 4];
    }
    let per_alpha = 1.0 / colour.w;
    (colour * Vec4::new(per_alpha, per_alpha, per_alpha, 1.0) * 255.0 + 0.5).to_array().map(|v| v as u8)
}
