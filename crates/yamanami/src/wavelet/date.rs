//! date's experiment: models under disks of growing width, and whether two or three edges are wide enough.
//!
//! Based on: Date, Kanai, Kishinami (multiresolution approximation of polygon models by k-disk wavelets, and its evaluation):
//! figures 6, 7 and 10, the times, and the non-zeros (13).

use super::date_page::write_page;
use super::study::{kept, usual_thresholds_m, wavelet_study};
use super::{Approximation, SemiRegularModel, WaveletRow, WaveletStudy};
use crate::{Error, Original, model_views};
use image::RgbaImage;
use std::path::{Path, PathBuf};
use yamanami_core::TriangleMesh;
use yamanami_measure::plot::{Sheet, SheetRow, sheet};
use yamanami_multires::kdisk::{Lifting, Wavelet};

/// What is compared, from the coarsest to the limit.
pub(crate) const WAVELETS: [Wavelet; 7] = [
    Wavelet::Lazy,
    Wavelet::KDisk(0),
    Wavelet::KDisk(1),
    Wavelet::KDisk(2),
    Wavelet::KDisk(3),
    Wavelet::KDisk(4),
    Wavelet::Orthogonal,
];
/// Rows of figure 6.
const SHOWN: [Wavelet; 5] = [
    Wavelet::Lazy,
    Wavelet::KDisk(1),
    Wavelet::KDisk(2),
    Wavelet::KDisk(3),
    Wavelet::Orthogonal,
];
/// Finer levels look like the source.
const MOST_SHOWN_VERTICES: u32 = 10_000;
/// Coarser levels in figure 6, beside the source.
const SHOWN_LEVELS: u32 = 4;
const CELL_PX: u32 = 260;

/// A model for the experiment.
#[derive(Debug, Clone)]
pub struct DateModel {
    /// For file names: letters and digits.
    pub name: String,
    /// Where it comes from, in a sentence.
    pub origin: String,
    /// The model.
    pub model: SemiRegularModel,
    /// Whether it is ground, of which only heights are approximated.
    pub is_terrain: bool,
}

/// What was found for a model.
#[derive(Debug)]
pub(crate) struct Findings {
    pub(crate) name: String,
    pub(crate) origin: String,
    pub(crate) is_terrain: bool,
    pub(crate) study: WaveletStudy,
}

/// Runs the experiment on every model and writes `index.html`, `date.md` and their pictures into `out`; gives the page's path.
/// `progress` hears what is being done.
pub fn date(models: Vec<DateModel>, out: &Path, progress: &dyn Fn(&str)) -> Result<PathBuf, Error> {
    std::fs::create_dir_all(out).map_err(|source| Error::File { path: out.to_owned(), source })?;
    let mut findings = Vec::new();
    for DateModel { name, origin, model, is_terrain } in models {
        let thresholds_m = usual_thresholds_m(model.to_mesh().bounds().diagonal());
        let study = wavelet_study(&model, &WAVELETS, &thresholds_m, &|at| progress(&format!("{name}: {at}")))?;
        progress(&format!("{name}: figure 6"));
        approximations(&model, &out.join(format!("{name}_levels.png")))?;
        findings.push(Findings { name, origin, is_terrain, study });
    }
    progress("writing the page");
    write_page(&findings, out)
}

/// Figure 6: the levels of a model under each wavelet.
fn approximations(model: &SemiRegularModel, file: &Path) -> Result<(), Error> {
    let source = model.to_mesh();
    let levels = model.mesh.levels();
    let is_coarse = |&level: &u32| model.mesh.vertex_count(level) <= MOST_SHOWN_VERTICES;
    let mut shown: Vec<u32> = (0..levels).rev().filter(is_coarse).take(SHOWN_LEVELS as usize).collect();
    if shown.is_empty() {
        shown.push(0);
    }
    let mut columns = vec![format!("source, {} vertices", source.positions.len())];
    columns.extend(shown.iter().map(|&l| format!("level {l}, {} vertices", model.mesh.vertex_count(l))));
    // coarse levels may reach beyond the source: the pictures hold them all
    let mut points = source.positions.clone();
    let mut approximations = Vec::new();
    for wavelet in SHOWN {
        let lifting = Lifting::new(&model.mesh, wavelet);
        let mut details = model.vectors();
        lifting.analyse_vectors(&mut details);
        for &level in &shown {
            let count = model.mesh.vertex_count(level) as usize;
            let keep: Vec<bool> = (0..source.positions.len()).map(|v| v < count).collect();
            let mut positions = kept(&lifting, &details, &keep);
            positions.truncate(count);
            points.extend(&positions);
            approximations.push(TriangleMesh::new(positions, model.mesh.triangles(level)));
        }
    }
    let original = Original::new(&source, &model_views(&points, 1, [2 * CELL_PX; 2]), true, true)?;
    let mut rows = Vec::new();
    for (wavelet, meshes) in SHOWN.iter().zip(approximations.chunks(shown.len())) {
        let mut cells = vec![original.pictures().first().map(smaller)];
        for mesh in meshes {
            cells.push(original.draw(mesh)?.first().map(smaller));
        }
        rows.push(SheetRow { name: wavelet.to_string(), cells });
    }
    let title = format!("Figure 6, {}: levels by wavelet", model.title);
    Ok(sheet(file, &Sheet { title, columns, rows, cell_px: CELL_PX, empty: String::new() })?)
}

/// Half the size, for smooth edges.
fn smaller(picture: &RgbaImage) -> RgbaImage {
    image::imageops::resize(picture, CELL_PX, CELL_PX, image::imageops::FilterType::Triangle)
}

/// How much a wavelet's L2 error exceeds the least-squares limit's, as a share, at worst over some approximations.
pub(crate) fn excess(row: &WaveletRow, best: &WaveletRow, of: fn(&WaveletRow) -> &[Approximation]) -> f64 {
    let pairs = of(row).iter().zip(of(best)).filter(|(_, best)| best.l2_m > 0.0);
    pairs.map(|(a, best)| a.l2_m / best.l2_m - 1.0).fold(0.0, f64::max)
}
