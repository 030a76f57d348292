//! Differences of two pictures of a model, over the pixels that show it: the background would hide them in the mean.
//!
//! Based on: Andersson et al., "FLIP", 2020; Wang et al., "SSIM", 2004.

use crate::ssim::{LEAST_SIDE, ssim_at};
use crate::{MeasureError, flip, picture::common_size};
use image::{RgbaImage, imageops};

/// Background kept around the model, pixels: more than the reach of any filter.
const MARGIN_PX: u32 = 24;

/// How far two pictures of a model are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelDifference {
    /// Pixels that are not background in one picture or the other.
    pub covered_px: u64,
    /// Pixels that are background in one picture only: the change of the silhouette.
    pub silhouette_px: u64,
    /// Mean FLIP over the covered pixels, 0..=1.
    pub flip_mean: f64,
    /// The FLIP that only one covered pixel in a hundred exceeds.
    pub flip_p99: f64,
    /// Mean SSIM of the windows around covered pixels.
    pub ssim: f64,
    /// Peak signal to noise over the covered pixels, dB; infinite for equal pictures.
    pub psnr_db: f64,
}

/// Compares two pictures of a model before a plain background (sRGB) for a viewer who sees `pixels_per_degree`.
pub fn model_difference(
    reference: &RgbaImage,
    test: &RgbaImage,
    background: [u8; 3],
    pixels_per_degree: f64,
) -> Result<ModelDifference, MeasureError> {
    common_size(reference, test)?;
    let shows = |p: &image::Rgba<u8>| p.0[..3] != background;
    let Some([left, top, width, height]) = shown_box(reference, test, &shows) else {
        return Ok(ModelDifference {
            covered_px: 0,
            silhouette_px: 0,
            flip_mean: 0.0,
            flip_p99: 0.0,
            ssim: 1.0,
            psnr_db: f64::INFINITY,
        });
    };
    let [reference, test] =
        [reference, test].map(|picture| imageops::crop_imm(picture, left, top, width, height).to_image());
    let flip_map = flip(&reference, &test, pixels_per_degree)?.map;
    let (mut covered, mut silhouette_px, mut squares) = (Vec::new(), 0, 0u64);
    let mut differences = Vec::new();
    for (k, (a, b)) in reference.pixels().zip(test.pixels()).enumerate() {
        let (in_a, in_b) = (shows(a), shows(b));
        if in_a || in_b {
            covered.push(k);
            differences.push(flip_map[k]);
            silhouette_px += u64::from(in_a != in_b);
            squares += (0..3).map(|c| u64::from(a.0[c].abs_diff(b.0[c])).pow(2)).sum::<u64>();
        }
    }
    let count = covered.len() as f64;
    let ssim = ssim_at(&reference, &test, &covered)?;
    let flip_mean = differences.iter().map(|&d| f64::from(d)).sum::<f64>() / count;
    let rank = (differences.len() * 99 / 100).min(differences.len() - 1);
    let (_, &mut p99, _) = differences.select_nth_unstable_by(rank, f32::total_cmp);
    Ok(ModelDifference {
        covered_px: covered.len() as u64,
        silhouette_px,
        flip_mean,
        flip_p99: f64::from(p99),
        ssim,
        psnr_db: 10.0 * (255.0 * 255.0 * 3.0 * count / squares as f64).log10(),
    })
}

/// Left, top, width and height of what shows in one picture or the other, with a margin.
fn shown_box(a: &RgbaImage, b: &RgbaImage, shows: &dyn Fn(&image::Rgba<u8>) -> bool) -> Option<[u32; 4]> {
    let (mut least, mut most) = ([u32::MAX; 2], [0; 2]);
    for ((x, y, p), q) in a.enumerate_pixels().zip(b.pixels()) {
        if shows(p) || shows(q) {
            least = [least[0].min(x), least[1].min(y)];
            most = [most[0].max(x), most[1].max(y)];
        }
    }
    let size = [a.width(), a.height()];
    (least[0] <= most[0]).then(|| {
        let [[left, width], [top, height]] = [0, 1].map(|axis| {
            let start = least[axis].saturating_sub(MARGIN_PX);
            let end = (most[axis] + 1 + MARGIN_PX).min(size[axis]);
            // room for a window of SSIM, where the picture has it
            let start = start.min(size[axis].saturating_sub(LEAST_SIDE));
            [start, (end - start).max(LEAST_SIDE.min(size[axis]))]
        });
        [left, top, width, height]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    const BACK: [u8; 3] = [240, 241, 242];

    fn disc(side: u32, radius: f64, shade: impl Fn(u32, u32) -> u8) -> RgbaImage {
        RgbaImage::from_fn(side, side, |x, y| {
            let (dx, dy) = (f64::from(x) - 20.0, f64::from(y) - 20.0);
            let v = shade(x, y);
            if dx.hypot(dy) < radius { Rgba([v, v, v, 255]) } else { Rgba([BACK[0], BACK[1], BACK[2], 255]) }
        })
    }

    #[test]
    fn the_background_does_not_dilute() {
        let shade = |x: u32, y: u32| (90 + (x * 3 + y * 2) % 60) as u8;
        let noisy = |x: u32, y: u32| shade(x, y) + ((x * 7 + y * 5) % 9) as u8;
        let differ = |side| model_difference(&disc(side, 9.5, shade), &disc(side, 9.5, noisy), BACK, 67.0).unwrap();
        let (small, large) = (differ(64), differ(300));
        assert_eq!(small, large);
        assert!(small.covered_px > 270 && small.silhouette_px == 0);
        assert!(small.flip_mean > 0.01 && small.flip_p99 >= small.flip_mean && small.ssim < 0.99, "{small:?}");
        assert!(small.psnr_db > 30.0 && small.psnr_db < 40.0, "{small:?}");
    }

    #[test]
    fn equal_pictures_and_empty_ones_do_not_differ() {
        let model = disc(48, 9.5, |x, _| x as u8);
        let same = model_difference(&model, &model, BACK, 67.0).unwrap();
        assert_eq!((same.flip_mean, same.flip_p99, same.silhouette_px), (0.0, 0.0, 0));
        assert!(same.psnr_db.is_infinite() && same.ssim > 1.0 - 1e-12);
        let empty = disc(48, 0.0, |_, _| 0);
        assert_eq!(model_difference(&empty, &empty, BACK, 67.0).unwrap().covered_px, 0);
        let gone = model_difference(&model, &empty, BACK, 67.0).unwrap();
        assert_eq!(gone.silhouette_px, gone.covered_px);
    }
}
