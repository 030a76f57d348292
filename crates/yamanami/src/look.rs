//! The smallest mesh that looks the same: reduced models are drawn beside the source and the pictures compared.
//!
//! What counts as the same, and why, is in `docs/decisions/0007-looks-the-same.md`.

use crate::model_picture::{model_pixels, model_style};
use crate::{Canvas, DrawWith, Error, MODEL_BACKGROUND, Reduced, ReducedBy, reduce};
use image::RgbaImage;
use yamanami_core::{TriangleMesh, View};
use yamanami_gpu::RenderOptions;
use yamanami_measure::{FLIP_PIXELS_PER_DEGREE, ModelDifference, model_difference};
use yamanami_multires::collapse::{CollapseOptions, Method};

/// A move of the model that nobody sees, pixels: at 67 pixels a degree 6.7 seconds of arc.
const UNSEEN_MOVE_PX: f64 = 0.125;

/// Limits below which two pictures of a model look the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookLimits {
    /// Largest mean FLIP over the covered pixels.
    pub flip_mean: f64,
    /// Largest FLIP that one covered pixel in a hundred may exceed.
    pub flip_p99: f64,
    /// Least mean SSIM over the covered pixels.
    pub ssim: f64,
}

impl Default for LookLimits {
    fn default() -> Self {
        Self { flip_mean: 0.03, flip_p99: 0.10, ssim: 0.98 }
    }
}

impl LookLimits {
    /// Whether a difference cannot be seen.
    pub fn hold(&self, difference: &ModelDifference) -> bool {
        difference.flip_mean <= self.flip_mean && difference.flip_p99 <= self.flip_p99 && difference.ssim >= self.ssim
    }

    /// These limits, or what a difference that is not seen amounts to where that is more.
    fn or_as_much_as(self, unseen: &ModelDifference) -> Self {
        Self {
            flip_mean: self.flip_mean.max(unseen.flip_mean),
            flip_p99: self.flip_p99.max(unseen.flip_p99),
            ssim: self.ssim.min(unseen.ssim),
        }
    }
}

/// A model's pictures, to hold others against. They are drawn in software, so that every machine finds the same.
#[derive(Debug)]
pub struct Original {
    views: Vec<View>,
    pictures: Vec<RgbaImage>,
    unseen: Vec<ModelDifference>,
    antialias: bool,
    flat: bool,
}

impl Original {
    /// Draws a model in every view, and once more a little moved, to learn what such a move, which is not seen, amounts to.
    pub fn new(mesh: &TriangleMesh, views: &[View], antialias: bool, flat: bool) -> Result<Self, Error> {
        let (pictures, unseen) = (Vec::new(), Vec::new());
        let mut original = Self { views: views.iter().map(moved).collect(), pictures, unseen, antialias, flat };
        let moved = original.draw(mesh)?;
        original.views = views.to_vec();
        original.pictures = original.draw(mesh)?;
        original.unseen = original.differences(&moved)?;
        Ok(original)
    }

    /// The pictures, view by view.
    pub fn pictures(&self) -> &[RgbaImage] {
        &self.pictures
    }

    /// How much the model differs from itself moved by an eighth of a pixel, view by view.
    pub fn unseen(&self) -> &[ModelDifference] {
        &self.unseen
    }

    /// The limits in force, view by view.
    pub fn limits(&self) -> Vec<LookLimits> {
        self.unseen.iter().map(|unseen| LookLimits::default().or_as_much_as(unseen)).collect()
    }

    /// Whether none of the differences, view by view, can be seen.
    pub fn looks_same(&self, differences: &[ModelDifference]) -> bool {
        self.limits().iter().zip(differences).all(|(limits, difference)| limits.hold(difference))
    }

    /// Pictures of another model, drawn alike.
    pub fn draw(&self, mesh: &TriangleMesh) -> Result<Vec<RgbaImage>, Error> {
        let mut canvas = Canvas::of_mesh(mesh, DrawWith::Software)?;
        let style = RenderOptions { antialias: self.antialias, flat: self.flat, ..model_style(mesh) };
        self.views.iter().map(|view| canvas.draw(view, &style)).collect()
    }

    /// How far pictures are from the model's own, view by view.
    pub fn differences(&self, pictures: &[RgbaImage]) -> Result<Vec<ModelDifference>, Error> {
        let compare = |(own, other)| Ok(model_difference(own, other, MODEL_BACKGROUND, FLIP_PIXELS_PER_DEGREE)?);
        self.pictures.iter().zip(pictures).map(compare).collect()
    }
}

/// The view moved to the right and up, by [`UNSEEN_MOVE_PX`] at its target.
fn moved(view: &View) -> View {
    let pixel_m = (view.target - view.eye).length() / view.pixels_per_radian();
    let right = view.forward().cross(view.up()).normalize();
    let up = right.cross(view.forward());
    let step = (right + up).normalize() * (UNSEEN_MOVE_PX * pixel_m);
    View { eye: view.eye + step, target: view.target + step, ..*view }
}

/// The worst of each measure over several views.
pub fn worst_of(differences: &[ModelDifference]) -> Option<ModelDifference> {
    differences.iter().copied().reduce(|mut worst, d| {
        worst.covered_px += d.covered_px;
        worst.silhouette_px += d.silhouette_px;
        worst.flip_mean = worst.flip_mean.max(d.flip_mean);
        worst.flip_p99 = worst.flip_p99.max(d.flip_p99);
        worst.ssim = worst.ssim.min(d.ssim);
        worst.psnr_db = worst.psnr_db.min(d.psnr_db);
        worst
    })
}

/// A mesh tried on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// Its faces.
    pub faces: usize,
    /// The worst of the views.
    pub difference: ModelDifference,
    /// Whether it looks the same.
    pub same: bool,
}

/// The smallest mesh found that looks the same.
#[derive(Debug, Clone)]
pub struct LookSame {
    /// The mesh.
    pub reduced: Reduced,
    /// The pixels that the source covers, view by view.
    pub covered_px: Vec<u64>,
    /// The limits, view by view.
    pub limits: Vec<LookLimits>,
    /// What was tried, in order.
    pub probes: Vec<Probe>,
    /// Its difference from the source, the worst of the views; `None` where nothing smaller looks the same.
    pub difference: Option<ModelDifference>,
}

/// The search ends when the mesh that looks the same is less than so many times the one that does not.
const CLOSE_ENOUGH: f64 = 1.08;
/// No mesh of fewer faces is tried.
const FEWEST_FACES: usize = 16;

/// Searches for the smallest mesh that looks the same in all views, by halving the ratio of the two counts between which
/// it lies. A probe starts from the smallest mesh that still looked the same, so that probes cost less and less; the
/// paper's own collapse, whose quadrics remember the source, starts from the source each time. `progress` hears of each
/// probe.
pub fn look_same(
    mesh: TriangleMesh,
    views: &[View],
    method: Method,
    progress: &dyn Fn(&Probe),
) -> Result<LookSame, Error> {
    let original = Original::new(&mesh, views, true, false)?;
    let covered_px = model_pixels(&Canvas::of_mesh(&mesh, DrawWith::Software)?, views)?;
    let source = (method == Method::Garland97).then(|| mesh.clone());
    let start = Reduced { mesh, by: ReducedBy::Nothing, estimate_m: 0.0, certified_m: None };
    let search = Search { original: &original, method, source: source.as_ref() };
    let (reduced, difference, probes) = search.between(start, FEWEST_FACES, progress)?;
    Ok(LookSame { reduced, covered_px, limits: original.limits(), probes, difference })
}

/// The search itself.
pub(crate) struct Search<'a> {
    pub(crate) original: &'a Original,
    pub(crate) method: Method,
    /// Where probes start, if not from the mesh before.
    pub(crate) source: Option<&'a TriangleMesh>,
}

impl Search<'_> {
    /// Between a mesh that looks the same and a count that is too small.
    pub(crate) fn between(
        &self,
        mut best: Reduced,
        mut fails: usize,
        progress: &dyn Fn(&Probe),
    ) -> Result<(Reduced, Option<ModelDifference>, Vec<Probe>), Error> {
        let (mut probes, mut difference) = (Vec::new(), None);
        while best.mesh.triangles.len() as f64 > fails as f64 * CLOSE_ENOUGH {
            let same = best.mesh.triangles.len();
            let target_faces = ((same as f64 * fails as f64).sqrt().round() as usize).clamp(fails, same - 1);
            let from = self.source.unwrap_or(&best.mesh).clone();
            let options = CollapseOptions { target_faces, method: self.method, ..CollapseOptions::default() };
            let tried = reduce(from, &options);
            let differences = self.original.differences(&self.original.draw(&tried.mesh)?)?;
            let Some(worst) = worst_of(&differences) else { break };
            let same_look = self.original.looks_same(&differences);
            let probe = Probe { faces: tried.mesh.triangles.len(), difference: worst, same: same_look };
            progress(&probe);
            probes.push(probe);
            if !probe.same {
                fails = target_faces;
            } else if probe.faces < same {
                // a collapse that the surface stopped goes no further next time
                fails = if tried.by == ReducedBy::Topology { probe.faces } else { fails };
                difference = Some(worst);
                let estimate_m = best.estimate_m.max(tried.estimate_m);
                best = Reduced { by: ReducedBy::Faces, estimate_m, ..tried };
            } else {
                break;
            }
        }
        Ok((best, difference, probes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_views;
    use glam::DVec3;

    /// A lumpy sheet of so many squares a side.
    fn sheet(cells: u32) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        let at = |x: u32, y: u32| y * (cells + 1) + x;
        for y in 0..=cells {
            for x in 0..=cells {
                let (u, v) = (f64::from(x) / f64::from(cells), f64::from(y) / f64::from(cells));
                mesh.positions.push(DVec3::new(u, v, 0.06 * (9.0 * u).sin() * (7.0 * v).cos()));
                if x < cells && y < cells {
                    mesh.triangles.push([at(x, y), at(x + 1, y), at(x + 1, y + 1)]);
                    mesh.triangles.push([at(x, y), at(x + 1, y + 1), at(x, y + 1)]);
                }
            }
        }
        mesh
    }

    #[test]
    fn the_smallest_mesh_that_looks_the_same_does_and_smaller_ones_do_not() {
        let mesh = sheet(60);
        let views = model_views(&mesh.positions, 2, [128, 96]);
        let found = look_same(mesh.clone(), &views, Method::Memoryless, &|_| ()).unwrap();
        let faces = found.reduced.mesh.triangles.len();
        assert!(faces < mesh.triangles.len() / 2, "{faces}");
        let original = Original::new(&mesh, &views, true, false).unwrap();
        let pictures = original.draw(&found.reduced.mesh).unwrap();
        assert!(original.looks_same(&original.differences(&pictures).unwrap()));
        let largest_failing = found.probes.iter().filter(|p| !p.same).map(|p| p.faces).max();
        assert!(largest_failing.is_some_and(|f| f < faces), "{:?}", found.probes);
    }

    #[test]
    fn a_move_that_is_not_seen_sets_the_limits_where_it_is_more() {
        let unseen = |flip_mean, flip_p99, ssim| {
            let mesh = sheet(4);
            let views = model_views(&mesh.positions, 1, [64, 48]);
            let original = Original::new(&mesh, &views, true, false).unwrap();
            ModelDifference { flip_mean, flip_p99, ssim, ..original.unseen()[0] }
        };
        let usual = LookLimits::default();
        assert_eq!(usual.or_as_much_as(&unseen(0.01, 0.05, 0.999)), usual);
        let raised = usual.or_as_much_as(&unseen(0.05, 0.2, 0.9));
        assert_eq!((raised.flip_mean, raised.flip_p99, raised.ssim), (0.05, 0.2, 0.9));
    }
}
