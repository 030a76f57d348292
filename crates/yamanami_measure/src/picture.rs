//! Small measures of pictures: covered pixels, mean difference.

use crate::MeasureError;
use image::RgbaImage;

/// The common size of two pictures.
pub(crate) fn common_size(a: &RgbaImage, b: &RgbaImage) -> Result<[usize; 2], MeasureError> {
    let [expected, given] = [a, b].map(|p| [p.width(), p.height()]);
    if expected != given {
        return Err(MeasureError::SizesDiffer { expected, given });
    }
    Ok(expected.map(|s| s as usize))
}

/// Mean of |a − b| over all pixels and the three colour channels, in steps of 8 bits (0..=255). Alpha is ignored.
pub fn mean_abs_difference(a: &RgbaImage, b: &RgbaImage) -> Result<f64, MeasureError> {
    let [width, height] = common_size(a, b)?;
    let sum: u64 =
        a.pixels().zip(b.pixels()).map(|(p, q)| (0..3).map(|k| u64::from(p[k].abs_diff(q[k]))).sum::<u64>()).sum();
    Ok(sum as f64 / (3 * width * height).max(1) as f64)
}

/// Pixels that are not exactly the background: what a model covers of a picture.
pub fn covered_pixels(picture: &RgbaImage, background: [u8; 4]) -> usize {
    picture.pixels().filter(|p| p.0 != background).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn pixels_off_the_background_are_covered() {
        let mut picture = RgbaImage::from_pixel(10, 5, Rgba([7, 8, 9, 255]));
        assert_eq!(covered_pixels(&picture, [7, 8, 9, 255]), 0);
        picture.put_pixel(3, 3, Rgba([7, 8, 10, 255]));
        assert_eq!(covered_pixels(&picture, [7, 8, 9, 255]), 1);
    }

    #[test]
    fn the_mean_difference_is_per_channel() {
        let a = RgbaImage::from_pixel(4, 4, Rgba([10, 20, 30, 255]));
        let b = RgbaImage::from_pixel(4, 4, Rgba([13, 20, 24, 0]));
        assert_eq!(mean_abs_difference(&a, &b).unwrap(), 3.0);
        let line = mean_abs_difference(&a, &RgbaImage::new(4, 5)).unwrap_err().to_string();
        assert_eq!(line, "pictures differ in size: expected 4x4, given 4x5");
    }
}
