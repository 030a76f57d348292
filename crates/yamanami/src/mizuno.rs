//! mizuno's experiment: a model reduced to multiples of the pixels it covers on four displays, and what its pictures lose.
//!
//! Based on: Mizuno, Okumoto, Takata, Joe, "Polygon reduction for effective 3D model rendering on different platforms",
//! 2011. The pictures are judged by measures (FLIP, SSIM) instead of by eye.

use crate::look::Search;
use crate::mizuno_page::write_page;
use crate::mizuno_sheet::{Cut, cuts_of};
use crate::{Error, LookLimits, Original, Reduced, ReducedBy, model_camera, model_views, reduce, seen_side};
use crate::{display_need, worst_of};
use glam::DVec3;
use image::RgbaImage;
use std::path::{Path, PathBuf};
use yamanami_core::{TriangleMesh, View};
use yamanami_measure::ModelDifference;
use yamanami_multires::collapse::{CollapseOptions, Method};

/// The paper's displays.
const DISPLAYS: [[u32; 2]; 4] = [[1920, 1080], [1600, 900], [1280, 720], [800, 600]];
/// The paper's polygons a pixel.
pub(crate) const PAPER_K: [f64; 7] = [0.1, 1.0, 10.0, 40.0, 50.0, 60.0, 100.0];
/// Those and more, for the curve, from the most down.
const LADDER: [f64; 12] = [100.0, 60.0, 50.0, 40.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1];
/// Least height of the display that is added where the source is too small for the paper's displays.
const LEAST_HEIGHT_PX: f64 = 120.0;

/// A model for the experiment.
#[derive(Debug, Clone)]
pub struct MizunoModel {
    /// For file names: letters and digits.
    pub name: String,
    /// In words.
    pub title: String,
    /// The source.
    pub mesh: TriangleMesh,
    /// Eye and target; from the south-east around the model where none are given.
    pub camera: Option<[DVec3; 2]>,
    /// Vertical field of view with the camera, radians.
    pub fov_y_rad: Option<f64>,
    /// What the cut-outs show: name, middle, radius in metres. Three places of the picture where there are none.
    pub regions: Vec<(String, DVec3, f64)>,
}

/// A drawing style of the comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Style {
    pub(crate) name: &'static str,
    antialias: bool,
    flat: bool,
}

/// Styles; the first is used on every display, the others on the one with the longest ladder.
pub(crate) const STYLES: [Style; 3] = [
    Style { name: "smooth, four samples a pixel", antialias: true, flat: false },
    Style { name: "smooth, one sample a pixel", antialias: false, flat: false },
    Style { name: "flat, one sample a pixel", antialias: false, flat: true },
];

/// A step of the ladder on a display.
#[derive(Debug, Clone)]
pub(crate) struct Rung {
    pub(crate) k: f64,
    /// Faces reached; `None` where the source has fewer than wanted.
    pub(crate) faces: Option<usize>,
    /// By style.
    pub(crate) differences: Vec<ModelDifference>,
}

/// What was found on a display.
#[derive(Debug)]
pub(crate) struct OnDisplay {
    pub(crate) size_px: [u32; 2],
    pub(crate) pixels: u64,
    /// From the most polygons down.
    pub(crate) rungs: Vec<Rung>,
    /// Difference of the source from itself moved by an eighth of a pixel, by style.
    pub(crate) unseen: Vec<ModelDifference>,
    /// Limits below which pictures look the same, by style.
    pub(crate) limits: Vec<LookLimits>,
    /// Names and pictures of the parts: of the source, and by the paper's k.
    pub(crate) cuts: Vec<(String, RgbaImage, Vec<Option<RgbaImage>>)>,
    /// The smallest mesh that looks the same: faces and difference; `None` where only the source itself does.
    pub(crate) look: Option<(usize, ModelDifference)>,
}

/// What was found for a model.
#[derive(Debug)]
pub(crate) struct Findings {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) source_faces: usize,
    /// Faces of the side that is seen.
    pub(crate) seen_faces: usize,
    pub(crate) displays: Vec<OnDisplay>,
    /// The number of the display with all styles.
    pub(crate) full: usize,
}

/// Runs the experiment on every model and writes `index.html`, `mizuno.md` and their pictures into `out`; gives the page's
/// path. `progress` hears what is being done.
pub fn mizuno(models: Vec<MizunoModel>, out: &Path, progress: &dyn Fn(&str)) -> Result<PathBuf, Error> {
    std::fs::create_dir_all(out).map_err(|source| Error::File { path: out.to_owned(), source })?;
    let findings =
        models.into_iter().map(|model| experiment(model, DISPLAYS, progress)).collect::<Result<Vec<_>, _>>()?;
    progress("writing the page");
    write_page(&findings, out)
}

/// A display being worked on.
struct Stage {
    found: OnDisplay,
    originals: Vec<Original>,
    cuts: Vec<Cut>,
    /// The smallest mesh so far that looks the same, and the largest count below it that does not.
    best: Option<(TriangleMesh, ModelDifference)>,
    fails: usize,
}

fn experiment(model: MizunoModel, sizes_px: [[u32; 2]; 4], progress: &dyn Fn(&str)) -> Result<Findings, Error> {
    let MizunoModel { name, title, mesh, camera, fov_y_rad, regions } = model;
    let source_faces = mesh.triangles.len();
    let view_of = |size_px: [u32; 2]| match camera {
        Some([eye, target]) => model_camera(eye.to_array(), target.to_array(), fov_y_rad, size_px),
        None => model_views(&mesh.positions, 1, size_px)[0],
    };
    progress(&format!("{name}: what the view sees"));
    let mut views: Vec<View> = sizes_px.into_iter().map(view_of).collect();
    let seen = seen_side(&mesh, &views)?.mesh;
    let seen_faces = seen.triangles.len();
    let smallest = display_need(&mesh, &views[3..], LADDER[0])?;
    if smallest.faces > seen_faces {
        // a smaller display, on which the whole ladder fits
        let scale = (0.95 * seen_faces as f64 / smallest.faces as f64).sqrt();
        let height = (scale * f64::from(sizes_px[3][1])).max(LEAST_HEIGHT_PX);
        views.push(view_of([(height * 4.0 / 3.0).round() as u32, height.round() as u32]));
    }
    drop(mesh);
    let full = views.len() - 1;
    let mut stages = Vec::new();
    for (i, view) in views.iter().enumerate() {
        progress(&format!("{name}: pictures of the source, {} x {}", view.viewport_px[0], view.viewport_px[1]));
        stages.push(Stage::new(&seen, *view, if i == full { &STYLES } else { &STYLES[..1] }, &regions)?);
    }
    // one descent through all counts of all displays
    let mut steps: Vec<(usize, f64, usize)> = Vec::new();
    for (i, stage) in stages.iter().enumerate() {
        steps.extend(LADDER.map(|k| ((k * stage.found.pixels as f64).round() as usize, k, i)));
    }
    steps.sort_by(|a, b| b.0.cmp(&a.0).then(a.2.cmp(&b.2)));
    let mut at = seen.clone();
    for (target, k, i) in steps {
        let stage = &mut stages[i];
        if target >= seen_faces {
            stage.found.rungs.push(Rung { k, faces: None, differences: Vec::new() });
            stage.leave_out(k);
            continue;
        }
        progress(&format!(
            "{name}: {target} faces, {k} a pixel of {} x {}",
            stage.found.size_px[0], stage.found.size_px[1]
        ));
        at = reduce(at, &CollapseOptions { target_faces: target, ..CollapseOptions::default() }).mesh;
        stage.measure(&at, k)?;
    }
    let mut displays = Vec::new();
    for stage in stages {
        progress(&format!("{name}: what looks the same on {} x {}", stage.found.size_px[0], stage.found.size_px[1]));
        displays.push(stage.search(&seen)?);
    }
    Ok(Findings { name, title, source_faces, seen_faces, displays, full })
}

impl Stage {
    fn new(mesh: &TriangleMesh, view: View, styles: &[Style], regions: &[(String, DVec3, f64)]) -> Result<Self, Error> {
        let pixels = display_need(mesh, &[view], 1.0)?.pixels;
        let of = |style: &Style| Original::new(mesh, &[view], style.antialias, style.flat);
        let originals = styles.iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let cuts = cuts_of(regions, &view, &originals[0].pictures()[0]);
        let of_source = |cut: &Cut| (cut.name.clone(), cut.out_of(&originals[0].pictures()[0]), Vec::new());
        let found = OnDisplay {
            size_px: view.viewport_px,
            pixels,
            rungs: Vec::new(),
            unseen: originals.iter().flat_map(|original| original.unseen().to_vec()).collect(),
            limits: originals.iter().flat_map(Original::limits).collect(),
            cuts: cuts.iter().map(of_source).collect(),
            look: None,
        };
        Ok(Self { found, originals, cuts, best: None, fails: 0 })
    }

    /// Notes that the source has too few polygons for a step.
    fn leave_out(&mut self, k: f64) {
        if PAPER_K.contains(&k) {
            self.found.cuts.iter_mut().for_each(|(_, _, cells)| cells.push(None));
        }
    }

    fn measure(&mut self, mesh: &TriangleMesh, k: f64) -> Result<(), Error> {
        let faces = mesh.triangles.len();
        let mut differences = Vec::new();
        for (number, original) in self.originals.iter().enumerate() {
            let pictures = original.draw(mesh)?;
            differences.push(worst(original, &pictures)?);
            if number == 0 && PAPER_K.contains(&k) {
                for (cut, (_, _, cells)) in self.cuts.iter().zip(&mut self.found.cuts) {
                    cells.push(Some(cut.out_of(&pictures[0])));
                }
            }
        }
        if self.found.limits[0].hold(&differences[0]) {
            self.best = Some((mesh.clone(), differences[0]));
            self.fails = 0;
        } else if self.fails == 0 {
            self.fails = faces;
        }
        self.found.rungs.push(Rung { k, faces: Some(faces), differences });
        Ok(())
    }

    /// Narrows down the smallest mesh that looks the same.
    fn search(mut self, source: &TriangleMesh) -> Result<OnDisplay, Error> {
        let (mesh, difference) = self.best.take().unzip();
        let mesh = mesh.unwrap_or_else(|| source.clone());
        let search = Search { original: &self.originals[0], method: Method::Memoryless, source: None };
        let start = Reduced { mesh, by: ReducedBy::Faces, estimate_m: 0.0, certified_m: None };
        let (best, better, _) = search.between(start, self.fails.max(1), &|_| ())?;
        self.found.look = better.or(difference).map(|difference| (best.mesh.triangles.len(), difference));
        Ok(self.found)
    }
}

/// The one difference of an original with one view.
fn worst(original: &Original, pictures: &[RgbaImage]) -> Result<ModelDifference, Error> {
    let differences = original.differences(pictures)?;
    worst_of(&differences).ok_or_else(|| Error::Request("expected a view, given none".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_testkit::Pagoda;

    #[test]
    fn more_polygons_differ_less_and_every_step_is_accounted_for() {
        let model = MizunoModel {
            name: "pagoda".to_owned(),
            title: "A pagoda".to_owned(),
            mesh: Pagoda::new(20_000).to_mesh(),
            camera: Some(Pagoda::view()),
            fov_y_rad: Some(std::f64::consts::FRAC_PI_6),
            regions: vec![("roof".to_owned(), Pagoda::regions()[0].centre_m, Pagoda::regions()[0].radius_m)],
        };
        let found = experiment(model, [[160, 120], [120, 90], [80, 60], [48, 36]], &|_| ()).unwrap();
        assert_eq!(found.displays.len(), 4 + usize::from(found.full == 4));
        assert!(found.seen_faces < found.source_faces);
        for display in &found.displays {
            assert_eq!(display.rungs.iter().map(|rung| rung.k).collect::<Vec<_>>(), LADDER);
            assert_eq!(display.cuts.len(), 1);
            assert!(display.cuts.iter().all(|(_, _, cells)| cells.len() == PAPER_K.len()));
            let tried: Vec<&Rung> = display.rungs.iter().filter(|rung| rung.faces.is_some()).collect();
            for pair in tried.windows(2) {
                assert!(pair[0].faces >= pair[1].faces);
            }
            let (first, last) = (tried[0], tried[tried.len() - 1]);
            assert!(first.differences[0].flip_mean < last.differences[0].flip_mean, "{first:?} {last:?}");
            for rung in display.rungs.iter().filter(|rung| rung.faces.is_none()) {
                assert!(rung.k * display.pixels as f64 > found.seen_faces as f64 - 1.0);
            }
            if let Some((faces, difference)) = display.look {
                assert!(faces <= found.seen_faces && display.limits[0].hold(&difference));
            }
        }
    }
}
