//! How far each sample of the ground is drawn from its place: measured, every one, against what the mesh promises.

use super::DeformedScene;
use glam::{DVec2, DVec3};
use yamanami_core::{FieldLevel, MapView, TriangleMesh};
use yamanami_measure::{LARGE_PX, projected_error};

/// True errors in the picture of all samples within the rim.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MapErrors {
    /// Samples measured.
    pub samples: usize,
    /// The largest, pixels.
    pub max_px: f64,
    /// Not exceeded by 99.9 % of the samples, pixels.
    pub p999_px: f64,
    /// Root of the mean square, pixels.
    pub rms_px: f64,
    /// Share of the paper's large errors, 3.5 pixels and more, 0 to 1.
    pub over_large: f64,
}

impl DeformedScene {
    /// Measures what is shown.
    pub fn measure(&self, view: &MapView) -> MapErrors {
        let visit = |errors: &mut Vec<f32>, corners: [DVec3; 3], samples: &[DVec3]| {
            let drawn = corners.map(|p| view.map.image_from_plane(p));
            for &sample in samples {
                if (sample.truncate() - view.map.centre).length() <= view.rim_m {
                    let weights = barycentric(corners.map(DVec3::truncate), sample.truncate());
                    let shown: DVec2 = (0..3).map(|i| weights[i] * drawn[i]).sum();
                    errors.push((view.ring_px * (view.map.image_from_plane(sample) - shown).length()) as f32);
                }
            }
        };
        let join = |mut a: Vec<f32>, b: Vec<f32>| {
            a.extend(b);
            a
        };
        summary(self.surface().fold_samples(self.front(), Vec::new, visit, join))
    }
}

/// Measures a mesh over one grid, with whatever heights it has.
pub(super) fn measure_mesh(view: &MapView, grid: &FieldLevel, mesh: &TriangleMesh) -> MapErrors {
    let all = projected_error(view, grid, &mesh.positions, &mesh.triangles).all;
    MapErrors {
        samples: all.samples,
        max_px: all.max_px,
        p999_px: all.p999_px,
        rms_px: all.rms_px,
        over_large: all.over_large,
    }
}

fn barycentric([a, b, c]: [DVec2; 3], p: DVec2) -> [f64; 3] {
    let area = (b - a).perp_dot(c - a);
    let (at_b, at_c) = ((p - a).perp_dot(c - a) / area, (b - a).perp_dot(p - a) / area);
    [1.0 - at_b - at_c, at_b, at_c]
}

fn summary(mut errors: Vec<f32>) -> MapErrors {
    let samples = errors.len();
    if samples == 0 {
        return MapErrors::default();
    }
    let squares: f64 = errors.iter().map(|&e| f64::from(e).powi(2)).sum();
    let large = errors.iter().filter(|&&e| f64::from(e) >= LARGE_PX).count();
    let rank = ((samples as f64 * 0.999).ceil() as usize).clamp(1, samples) - 1;
    let (_, p999_px, rest) = errors.select_nth_unstable_by(rank, f32::total_cmp);
    let p999_px = f64::from(*p999_px);
    MapErrors {
        samples,
        max_px: rest.iter().map(|&e| f64::from(e)).fold(p999_px, f64::max),
        p999_px,
        rms_px: (squares / samples as f64).sqrt(),
        over_large: large as f64 / samples as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_right() {
        let found = summary((1..=2000).map(|i| i as f32 / 200.0).collect());
        assert_eq!((found.samples, found.max_px, found.p999_px), (2000, 10.0, f64::from(1998f32 / 200.0)));
        assert!((found.over_large - 1301.0 / 2000.0).abs() < 1e-12);
        assert_eq!(summary(Vec::new()), MapErrors::default());
    }
}
