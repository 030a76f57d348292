//! FLIP: how large the difference of two pictures looks when they are flipped between in place.
//!
//! Based on: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: a difference evaluator for
//! alternating images", 2020 (the low-dynamic-range form). The constants are the paper's.

use crate::{MeasureError, picture::common_size};
use image::RgbaImage;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Pixels per degree of sight on a 0.7 m wide screen of 3840 pixels seen from 0.7 m.
pub const FLIP_PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * (PI / 180.0);

/// Perceived difference of two pictures.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FlipReport {
    /// Mean over all pixels, 0..=1.
    pub mean: f64,
    /// Largest difference, 0..=1.
    pub max: f64,
    /// Difference of each pixel, row by row, 0..=1.
    pub map: Vec<f32>,
}

/// Compares `test` with `reference` for a viewer who sees `pixels_per_degree`
/// ([`FLIP_PIXELS_PER_DEGREE`] where nothing else is known). Alpha is ignored.
pub fn flip(reference: &RgbaImage, test: &RgbaImage, pixels_per_degree: f64) -> Result<FlipReport, MeasureError> {
    let size = common_size(reference, test)?;
    let pixels_per_degree = if pixels_per_degree > 1.0 { pixels_per_degree.min(1000.0) } else { 1.0 };
    let (reference, test) = (Seen::new(reference, size, pixels_per_degree), Seen::new(test, size, pixels_per_degree));
    let scale = ColourScale::new();
    let map: Vec<f32> = (0..size[0] * size[1])
        .into_par_iter()
        .map(|k| {
            let colour = scale.difference(reference.hunt_lab[k], test.hunt_lab[k]);
            let feature = (reference.edge[k] - test.edge[k]).abs().max((reference.point[k] - test.point[k]).abs());
            let feature = (feature / std::f64::consts::SQRT_2).clamp(0.0, 1.0).sqrt();
            colour.powf(1.0 - feature) as f32
        })
        .collect();
    let sum: f64 = map.iter().map(|&d| f64::from(d)).sum();
    let max = map.iter().fold(0f32, |a, &b| a.max(b));
    Ok(FlipReport { mean: sum / map.len().max(1) as f64, max: f64::from(max), map })
}

type Colour = [f64; 3];

/// A picture as the eye takes it in.
struct Seen {
    /// Colours blurred by the eye, in L*a*b*, with the Hunt effect.
    hunt_lab: Vec<Colour>,
    /// Strength of edges.
    edge: Vec<f64>,
    /// Strength of points and lines.
    point: Vec<f64>,
}

impl Seen {
    fn new(picture: &RgbaImage, size: [usize; 2], pixels_per_degree: f64) -> Self {
        let linear: Vec<f64> = (0..=255).map(|v| linear_from_srgb(f64::from(v) / 255.0)).collect();
        let opponent: Vec<Colour> = picture
            .as_raw()
            .par_chunks_exact(4)
            .map(|p| ycxcz_from_xyz(xyz_from_linear([0, 1, 2].map(|k| linear[usize::from(p[k])]))))
            .collect();
        let plane = |channel: usize| opponent.iter().map(|c| c[channel]).collect::<Vec<f64>>();
        let [luminance, red_green, blue_yellow] = [plane(0), plane(1), plane(2)];

        let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
        let seen = |plane: &[f64], gaussians: &[[f64; 2]]| blurred(plane, size, gaussians, radius, pixels_per_degree);
        let (y, (cx, cz)) = rayon::join(
            || seen(&luminance, &[[1.0, 0.0047]]),
            || {
                rayon::join(
                    || seen(&red_green, &[[1.0, 0.0053]]),
                    || seen(&blue_yellow, &[[34.1, 0.04], [13.5, 0.025]]),
                )
            },
        );
        let hunt_lab = (0..y.len())
            .into_par_iter()
            .map(|k| {
                let linear = linear_from_xyz(xyz_from_ycxcz([y[k], cx[k], cz[k]])).map(|c| c.clamp(0.0, 1.0));
                hunt(lab_from_xyz(xyz_from_linear(linear)))
            })
            .collect();

        let grey: Vec<f64> = luminance.iter().map(|y| (y + 16.0) / 116.0).collect();
        let kernels = FeatureKernels::new(pixels_per_degree);
        let strength = |along: &[f64]| {
            let x = convolved(&grey, size, along, &kernels.across);
            let y = convolved(&grey, size, &kernels.across, along);
            x.iter().zip(&y).map(|(x, y)| x.hypot(*y)).collect()
        };
        let (edge, point) = rayon::join(|| strength(&kernels.edge), || strength(&kernels.point));
        Self { hunt_lab, edge, point }
    }
}

/// Filters a plane by the eye's contrast sensitivity: a sum of Gaussians, each given by weight and width.
fn blurred(plane: &[f64], size: [usize; 2], gaussians: &[[f64; 2]], radius: usize, pixels_per_degree: f64) -> Vec<f64> {
    let taps = |[_, width]: [f64; 2]| -> Vec<f64> {
        let at = |k: usize| (k as f64 - radius as f64) / pixels_per_degree;
        (0..=2 * radius).map(|k| (-PI * PI * at(k) * at(k) / width).exp()).collect()
    };
    let peak = |[weight, width]: [f64; 2]| weight * (PI / width).sqrt();
    let total: f64 = gaussians.iter().map(|&g| peak(g) * taps(g).iter().sum::<f64>().powi(2)).sum();
    let mut out = vec![0.0; plane.len()];
    for &gaussian in gaussians {
        let taps = taps(gaussian);
        let weight = peak(gaussian) / total;
        for (out, value) in out.iter_mut().zip(convolved(plane, size, &taps, &taps)) {
            *out += weight * value;
        }
    }
    out
}

/// Convolves along the rows with one kernel and along the columns with another of the same length; the border
/// repeats outwards.
fn convolved(plane: &[f64], [width, height]: [usize; 2], along_x: &[f64], along_y: &[f64]) -> Vec<f64> {
    if plane.is_empty() {
        return Vec::new();
    }
    let radius = along_x.len() / 2;
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each_init(Vec::new, |padded, (out, row)| {
        padded.clear();
        padded.extend(std::iter::repeat_n(row[0], radius));
        padded.extend_from_slice(row);
        padded.extend(std::iter::repeat_n(row[width - 1], radius));
        for (x, out) in out.iter_mut().enumerate() {
            *out = along_x.iter().zip(&padded[x..]).map(|(w, v)| w * v).sum();
        }
    });
    let mut out = vec![0.0; plane.len()];
    out.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        for (k, weight) in along_y.iter().enumerate() {
            let row = (y + k).saturating_sub(radius).min(height - 1);
            for (out, value) in out.iter_mut().zip(&rows[row * width..]) {
                *out += weight * value;
            }
        }
    });
    out
}

/// Kernels of the feature detectors: derivatives along one axis, a Gaussian across it.
struct FeatureKernels {
    edge: Vec<f64>,
    point: Vec<f64>,
    across: Vec<f64>,
}

impl FeatureKernels {
    fn new(pixels_per_degree: f64) -> Self {
        let sigma_px = 0.5 * 0.082 * pixels_per_degree;
        let radius = (3.0 * sigma_px).ceil() as i32;
        let kernel = |f: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let raw: Vec<f64> = (-radius..=radius)
                .map(|k| {
                    let x = f64::from(k) / sigma_px;
                    f(x) * (-x * x / 2.0).exp()
                })
                .collect();
            // positive weights sum to 1, negative ones to -1
            let positive: f64 = raw.iter().filter(|w| **w > 0.0).sum();
            let negative: f64 = raw.iter().filter(|w| **w < 0.0).sum();
            raw.iter()
                .map(|&w| {
                    if w > 0.0 {
                        w / positive
                    } else if w < 0.0 {
                        w / -negative
                    } else {
                        0.0
                    }
                })
                .collect()
        };
        Self { edge: kernel(&|x| -x), point: kernel(&|x| x * x - 1.0), across: kernel(&|_| 1.0) }
    }
}

/// Turns distances of colours into 0..=1.
struct ColourScale {
    largest: f64,
}

impl ColourScale {
    const EXPONENT: f64 = 0.7;

    fn new() -> Self {
        let of = |linear| hunt(lab_from_xyz(xyz_from_linear(linear)));
        let largest = hyab(of([0.0, 1.0, 0.0]), of([0.0, 0.0, 1.0])).powf(Self::EXPONENT);
        Self { largest }
    }

    /// The lower 40 % of the range of distances take 95 % of the scale.
    fn difference(&self, a: Colour, b: Colour) -> f64 {
        let distance = hyab(a, b).powf(Self::EXPONENT);
        let knee = 0.4 * self.largest;
        if distance < knee {
            0.95 / knee * distance
        } else {
            (0.95 + (distance - knee) / (self.largest - knee) * 0.05).min(1.0)
        }
    }
}

/// Distance of two colours that holds for large differences: lightness and chroma apart.
fn hyab(a: Colour, b: Colour) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// Colours look more vivid the lighter they are.
fn hunt([l, a, b]: Colour) -> Colour {
    [l, 0.01 * l * a, 0.01 * l * b]
}

fn linear_from_srgb(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Linear sRGB to XYZ (D65), as exact fractions of the standard's primaries.
const XYZ_FROM_LINEAR: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// XYZ of white: the rows' sums.
fn white() -> Colour {
    XYZ_FROM_LINEAR.map(|row| row.iter().sum())
}

fn xyz_from_linear(c: Colour) -> Colour {
    XYZ_FROM_LINEAR.map(|row| row[0] * c[0] + row[1] * c[1] + row[2] * c[2])
}

fn linear_from_xyz(c: Colour) -> Colour {
    const LINEAR_FROM_XYZ: [[f64; 3]; 3] = [
        [3.241_003_232_976_358, -1.537_398_969_488_785_5, -0.498_615_881_996_362_9],
        [-0.969_224_252_202_516_3, 1.875_929_983_695_176, 0.041_554_226_340_084_73],
        [0.055_639_419_851_975_46, -0.204_011_206_123_910_13, 1.057_148_977_187_533],
    ];
    LINEAR_FROM_XYZ.map(|row| row[0] * c[0] + row[1] * c[1] + row[2] * c[2])
}

/// The opponent space of the contrast sensitivity filters.
fn ycxcz_from_xyz(c: Colour) -> Colour {
    let w = white();
    let [x, y, z] = [c[0] / w[0], c[1] / w[1], c[2] / w[2]];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_from_ycxcz([l, cx, cz]: Colour) -> Colour {
    let w = white();
    let y = (l + 16.0) / 116.0;
    [w[0] * (y + cx / 500.0), w[1] * y, w[2] * (y - cz / 200.0)]
}

fn lab_from_xyz(c: Colour) -> Colour {
    const DELTA: f64 = 6.0 / 29.0;
    let w = white();
    let f = |t: f64| if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let [x, y, z] = [f(c[0] / w[0]), f(c[1] / w[1]), f(c[2] / w[2])];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    fn picture(f: impl Fn(u32, u32) -> [u8; 3]) -> RgbaImage {
        RgbaImage::from_fn(64, 48, |x, y| {
            let [r, g, b] = f(x, y);
            Rgba([r, g, b, 255])
        })
    }

    fn scene(x: u32, y: u32) -> [u8; 3] {
        [(x * 4 % 256) as u8, (y * 5 % 256) as u8, ((x * x + y * y * 3) % 256) as u8]
    }

    fn checker(x: u32, y: u32) -> [u8; 3] {
        if (x / 8 + y / 8).is_multiple_of(2) { [230, 60, 40] } else { [20, 40, 200] }
    }

    fn blot(x: u32, y: u32) -> [u8; 3] {
        if (20..30).contains(&x) && (15..22).contains(&y) { [255; 3] } else { checker(x, y) }
    }

    /// Means and maxima printed for these pictures by the authors' own program (nv-flip 0.1.2).
    #[test]
    fn agrees_with_the_authors_program() {
        let check = |a: RgbaImage, b: RgbaImage, pixels_per_degree, mean: f64, max: f64| {
            let report = flip(&a, &b, pixels_per_degree).unwrap();
            assert!((report.mean - mean).abs() < 5e-5, "mean {} expected {mean}", report.mean);
            assert!((report.max - max).abs() < 5e-5, "max {} expected {max}", report.max);
        };
        check(picture(|_, _| [100, 120, 140]), picture(|_, _| [120, 120, 100]), 67.0, 0.336_56, 0.336_567);
        check(picture(scene), picture(|x, y| scene(x + 1, y)), 67.0, 0.120_981_7, 0.922_099_6);
        check(picture(checker), picture(blot), 67.0, 0.052_673_36, 0.991_117_1);
        check(picture(checker), picture(blot), 20.0, 0.031_199_88, 0.994_535);
        check(picture(|_, _| [0; 3]), picture(|_, _| [255; 3]), 67.0, 0.967_39, 0.967_392);
        check(picture(|_, _| [0, 255, 0]), picture(|_, _| [0, 0, 255]), 67.0, 1.0, 1.0);
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        let report = flip(&picture(scene), &picture(scene), FLIP_PIXELS_PER_DEGREE).unwrap();
        assert_eq!((report.mean, report.max, report.map.len()), (0.0, 0.0, 64 * 48));
    }

    #[test]
    fn unequal_sizes_are_refused() {
        assert!(flip(&picture(scene), &RgbaImage::new(64, 47), 67.0).is_err());
    }
}
