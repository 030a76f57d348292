//! Structural similarity of two pictures.
//!
//! Based on: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to structural
//! similarity", 2004: luma, an 11×11 Gaussian window of σ = 1.5 pixels, K₁ = 0.01, K₂ = 0.03, the mean over all whole
//! windows, at full resolution.

use crate::{MeasureError, picture::common_size};
use image::RgbaImage;
use rayon::prelude::*;

const WINDOW: usize = 11;
/// Least width and height of a picture.
pub(crate) const LEAST_SIDE: u32 = WINDOW as u32;
const SIGMA_PX: f64 = 1.5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Mean structural similarity: 1 for equal pictures, less the more they differ. Alpha is ignored. Both pictures are of
/// one size, at least 11×11.
pub fn ssim(a: &RgbaImage, b: &RgbaImage) -> Result<f64, MeasureError> {
    let (map, columns) = ssim_map(a, b)?;
    let rows: Vec<f64> = map.par_chunks(columns).map(|row| row.iter().sum()).collect();
    Ok(rows.iter().sum::<f64>() / map.len() as f64)
}

/// Mean structural similarity of the windows in the middle of which these pixels lie, numbered row by row; 1 where no
/// pixel is the middle of a whole window.
pub(crate) fn ssim_at(a: &RgbaImage, b: &RgbaImage, pixels: &[usize]) -> Result<f64, MeasureError> {
    let (map, columns) = ssim_map(a, b)?;
    let (width, border) = (a.width() as usize, WINDOW / 2);
    let window = |&pixel: &usize| {
        let (column, row) = ((pixel % width).checked_sub(border)?, (pixel / width).checked_sub(border)?);
        if column < columns { map.get(row * columns + column) } else { None }
    };
    let (sum, count) = pixels.iter().filter_map(window).fold((0.0, 0u64), |(sum, count), v| (sum + v, count + 1));
    Ok(if count == 0 { 1.0 } else { sum / count as f64 })
}

/// The similarity of every whole window, row by row, and how many there are in a row.
fn ssim_map(a: &RgbaImage, b: &RgbaImage) -> Result<(Vec<f64>, usize), MeasureError> {
    let [width, height] = common_size(a, b)?;
    if width < WINDOW || height < WINDOW {
        return Err(MeasureError::TooSmall { least: LEAST_SIDE, given: [a.width(), a.height()] });
    }
    let (a, b) = (luma(a), luma(b));
    let weights = window();
    let columns = width - WINDOW + 1;
    // along the rows first: means and second moments of every horizontal window
    let moments: Vec<[f64; 5]> = (0..height)
        .into_par_iter()
        .flat_map_iter(|row| {
            let (a, b) = (&a[row * width..(row + 1) * width], &b[row * width..(row + 1) * width]);
            (0..columns).map(move |column| {
                let pairs = a[column..].iter().zip(&b[column..]);
                weights.iter().zip(pairs).fold([0.0; 5], |[ma, mb, aa, bb, ab], (w, (&x, &y))| {
                    [ma + w * x, mb + w * y, aa + w * x * x, bb + w * y * y, ab + w * x * y]
                })
            })
        })
        .collect();
    let map = (0..height - WINDOW + 1)
        .into_par_iter()
        .flat_map_iter(|row| {
            let moments = &moments;
            (0..columns).map(move |column| {
                let mut m = [0.0; 5];
                for (k, w) in weights.iter().enumerate() {
                    let line = moments[(row + k) * columns + column];
                    for (sum, value) in m.iter_mut().zip(line) {
                        *sum += w * value;
                    }
                }
                let [ma, mb, aa, bb, ab] = m;
                let (var_a, var_b, covariance) = (aa - ma * ma, bb - mb * mb, ab - ma * mb);
                (2.0 * ma * mb + C1) * (2.0 * covariance + C2) / ((ma * ma + mb * mb + C1) * (var_a + var_b + C2))
            })
        })
        .collect();
    Ok((map, columns))
}

/// Luma (ITU-R BT.601) of all pixels, 0..=255.
fn luma(picture: &RgbaImage) -> Vec<f64> {
    picture.pixels().map(|p| 0.299 * f64::from(p[0]) + 0.587 * f64::from(p[1]) + 0.114 * f64::from(p[2])).collect()
}

/// The window along one axis, summing to 1.
fn window() -> [f64; WINDOW] {
    let middle = (WINDOW / 2) as f64;
    let raw: [f64; WINDOW] =
        std::array::from_fn(|k| (-(k as f64 - middle).powi(2) / (2.0 * SIGMA_PX * SIGMA_PX)).exp());
    let sum: f64 = raw.iter().sum();
    raw.map(|w| w / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    fn grey(f: impl Fn(u32, u32) -> u8) -> RgbaImage {
        RgbaImage::from_fn(40, 30, |x, y| {
            let v = f(x, y);
            Rgba([v, v, v, 255])
        })
    }

    #[test]
    fn a_picture_is_wholly_similar_to_itself() {
        let p = grey(|x, y| (x * 7 + y * 3) as u8);
        assert!((ssim(&p, &p).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn flat_pictures_follow_the_luminance_term() {
        // no variance: (2·100·120 + C1) / (100² + 120² + C1)
        let expected = (24_000.0 + C1) / (24_400.0 + C1);
        let s = ssim(&grey(|_, _| 100), &grey(|_, _| 120)).unwrap();
        assert!((s - expected).abs() < 1e-9, "{s} {expected}");
    }

    #[test]
    fn the_negative_is_unlike_and_noise_is_between() {
        let p = grey(|x, y| if (x / 4 + y / 4) % 2 == 0 { 60 } else { 190 });
        let negative = grey(|x, y| if (x / 4 + y / 4) % 2 == 0 { 190 } else { 60 });
        let noisy = grey(|x, y| p.get_pixel(x, y)[0] + (x * 13 + y * 29) as u8 % 20);
        let (unlike, between) = (ssim(&p, &negative).unwrap(), ssim(&p, &noisy).unwrap());
        assert!(unlike < 0.0 && between > 0.8 && between < 1.0, "{unlike} {between}");
    }

    #[test]
    fn small_and_unequal_pictures_are_refused() {
        let line = ssim(&RgbaImage::new(10, 40), &RgbaImage::new(10, 40)).unwrap_err().to_string();
        assert_eq!(line, "picture too small: expected at least 11x11 pixels, given 10x40");
        assert!(ssim(&RgbaImage::new(12, 12), &RgbaImage::new(12, 13)).is_err());
    }
}
