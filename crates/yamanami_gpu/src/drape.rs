//! An image laid over the surface, with its smaller copies for distant ground.

use crate::palette::{SrgbEncoder, srgb_to_linear};
use glam::Vec3;
use image::{Rgba, RgbaImage};

/// An image and the affine map that lays it on the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Drape {
    levels: Vec<RgbaImage>,
    uv_from_local: [[f64; 3]; 2],
}

impl Drape {
    /// Lays `image` (sRGB) on the ground: `u = a·x + b·y + c` from `uv_from_local[0] = [a, b, c]`, `v` alike, for x and y
    /// in metres of the local metric frame; (0, 0) is the image's upper left corner, (1, 1) its lower right.
    /// An image without pixels lays nothing.
    pub fn new(image: RgbaImage, uv_from_local: [[f64; 3]; 2]) -> Self {
        let decode: Vec<f32> = (0..=255u8).map(|v| srgb_to_linear(f32::from(v) / 255.0)).collect();
        let encoder = SrgbEncoder::new();
        let empty = image.width() == 0 || image.height() == 0;
        let mut levels = vec![if empty { RgbaImage::new(1, 1) } else { image }];
        while let Some(finer) = levels.last().filter(|image| image.width().max(image.height()) > 1) {
            let coarser = halve(finer, &decode, &encoder);
            levels.push(coarser);
        }
        Self { levels, uv_from_local }
    }

    /// Lays an image over the box from `min` to `max` (x and y in metres), north up.
    pub fn over_box(image: RgbaImage, min: [f64; 2], max: [f64; 2]) -> Self {
        let (sx, sy) = (1.0 / (max[0] - min[0]), 1.0 / (max[1] - min[1]));
        Self::new(image, [[sx, 0.0, -min[0] * sx], [0.0, -sy, max[1] * sy]])
    }

    /// The image and its halvings, largest first.
    pub fn levels(&self) -> &[RgbaImage] {
        &self.levels
    }

    /// The map from the ground to the image, as given.
    pub fn uv_from_local(&self) -> [[f64; 3]; 2] {
        self.uv_from_local
    }
}

/// Half the size (at least one pixel), each pixel the mean in linear light of those it covers.
fn halve(finer: &RgbaImage, decode: &[f32], encoder: &SrgbEncoder) -> RgbaImage {
    let (width, height) = finer.dimensions();
    RgbaImage::from_fn((width / 2).max(1), (height / 2).max(1), |x, y| {
        let (mut rgb, mut alpha) = (Vec3::ZERO, 0.0);
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let p = finer.get_pixel((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1)).0;
            rgb += Vec3::new(decode[usize::from(p[0])], decode[usize::from(p[1])], decode[usize::from(p[2])]) * 0.25;
            alpha += f32::from(p[3]) * 0.25;
        }
        Rgba([encoder.byte(rgb.x), encoder.byte(rgb.y), encoder.byte(rgb.z), (alpha + 0.5) as u8])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_ends_at_one_pixel_with_the_mean_light() {
        let board = RgbaImage::from_fn(8, 3, |x, y| Rgba([if (x + y) % 2 == 0 { 255 } else { 0 }, 0, 0, 255]));
        let drape = Drape::over_box(board, [0.0, 0.0], [1.0, 1.0]);
        let sizes: Vec<_> = drape.levels().iter().map(RgbaImage::dimensions).collect();
        assert_eq!(sizes, [(8, 3), (4, 1), (2, 1), (1, 1)]);
        assert_eq!(drape.levels()[3].get_pixel(0, 0).0, [188, 0, 0, 255], "half the light is byte 188 of sRGB");
    }
}
