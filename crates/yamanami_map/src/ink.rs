//! Ink along the ridges: where ground stands before ground much further away, its edge is drawn.
//!
//! Based on: Saito, Takahashi, "Comprehensible rendering of 3-D shapes", 1990 (edges from the depth of a picture); the
//! panoramas of Heinrich Berann, whose ranges part by a line and paler air.

use glam::DVec2;
use image::RgbaImage;
use rayon::prelude::*;

/// How ridges are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InkStyle {
    /// Width of the line, pixels.
    pub width_px: f64,
    /// Colour of the line (sRGB).
    pub colour: [u8; 3],
    /// Most that the line covers, 0 to 1.
    pub strength: f32,
    /// Ground behind that is further by this share is no edge yet.
    pub least_step: f32,
    /// Ground behind that is further by this share has the full line.
    pub full_step: f32,
}

impl Default for InkStyle {
    fn default() -> Self {
        Self { width_px: 1.0, colour: [58, 52, 66], strength: 0.62, least_step: 0.025, full_step: 0.25 }
    }
}

/// Draws ridges into rows of a picture of the ground. `distance_m` gives the distance from the centre of the ground seen
/// at a pixel of the whole picture (NaN where there is none or the pixel is outside); `centre_px` is the map's centre in
/// the whole picture, `first_row` the rows' place in it; within `ring_px` of it nothing stands before anything.
pub fn ink(
    rows: &mut RgbaImage,
    first_row: u32,
    centre_px: DVec2,
    ring_px: f64,
    style: &InkStyle,
    distance_m: impl Fn(i64, i64) -> f32 + Sync,
) {
    let width = rows.width() as usize;
    let steps = style.width_px.ceil().max(1.0) as u32;
    rows.as_flat_samples_mut().samples.par_chunks_mut(4 * width.max(1)).enumerate().for_each(|(row, line)| {
        let y = i64::from(first_row) + row as i64;
        for (x, pixel) in line.chunks_exact_mut(4).enumerate() {
            let here = distance_m(x as i64, y);
            let out = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - centre_px;
            let from_centre_px = out.length();
            if here.is_nan() || from_centre_px <= ring_px + 2.0 {
                continue;
            }
            let towards = out / from_centre_px;
            let (mut nearer, mut covered) = (here, 0f32);
            for step in 1..=steps {
                let at = DVec2::new(x as f64, y as f64) + f64::from(step) * towards;
                let behind = distance_m(at.x.round() as i64, at.y.round() as i64);
                let share = if behind.is_nan() { f32::INFINITY } else { behind / nearer - 1.0 };
                let edge = ((share - style.least_step) / (style.full_step - style.least_step)).clamp(0.0, 1.0);
                // the last step counts only as far as the width reaches into it
                let within = (style.width_px - f64::from(step - 1)).min(1.0) as f32;
                covered = covered.max(edge * within);
                if behind.is_nan() {
                    break;
                }
                nearer = behind;
            }
            let share = covered * style.strength;
            for (value, ink) in pixel.iter_mut().zip(style.colour) {
                *value = (f32::from(*value) * (1.0 - share) + f32::from(ink) * share).round() as u8;
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn ridges_get_a_line_on_their_own_side_and_slopes_get_none() {
        let mut picture = RgbaImage::from_pixel(101, 101, Rgba([200, 200, 200, 255]));
        // distance grows slowly outward, doubles at 30 pixels, and there is nothing beyond 45
        let distance = |x: i64, y: i64| {
            let r = DVec2::new(x as f64 - 50.0, y as f64 - 50.0).length() as f32;
            if r > 45.0 { f32::NAN } else { (1000.0 + 2.0 * r) * if r > 30.0 { 2.0 } else { 1.0 } }
        };
        ink(&mut picture, 0, DVec2::splat(50.5), 10.0, &InkStyle::default(), distance);
        let at = |x: u32| picture.get_pixel(x, 50).0[0];
        assert!(at(80) < 130, "the near side of the step: {}", at(80));
        assert_eq!((at(65), at(82), at(90)), (200, 200, 200));
        assert!(at(95) < 130, "the outline against nothing");
        assert_eq!(picture.get_pixel(98, 50).0, [200, 200, 200, 255], "nothing stays nothing");
    }
}
