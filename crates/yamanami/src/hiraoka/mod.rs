//! hiraoka's experiment: a TIN in blocks and levels against brute force, what its rules lose, the engine, a hundredfold area.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS" (三次元GISのためのTINの高速描画法),
//! APA, 2005. The paper's TIN is not public: a made ground of its extent, heights and triangles stands in for it.

mod decimation;
mod drawing;
mod engine;
mod ground;
mod page;
mod pictures;
mod poses;

use crate::{Culling, Error};
use decimation::LevelError;
use drawing::SizeFound;
use ground::{PAPER_TRIANGLES, grid, mirrored, paper_tin, paper_view, thresholds_m, view_in_plan};
use poses::Losses;
use std::path::{Path, PathBuf};
use yamanami_core::{HeightField, TriangleMesh, View};
use yamanami_multires::tin::{GreedyOptions, greedy};
use yamanami_multires::tin_block::{CostReading, TinBlocks, centroid_chain};

/// The reading of the paper that its levels are drawn with. By the plain one triangles far and wide meet in a few vertices,
/// which serves neither the pictures nor the time.
const DRAWN: CostReading = CostReading::OncePerPass;

/// Poses on the whole TIN, and on a small one, where many are affordable.
const POSES: [usize; 2] = [2_000, 100_000];
/// Triangles of the small one.
const SMALL_TRIANGLES: usize = 2_000;

/// What was found.
#[derive(Debug)]
pub(crate) struct Findings {
    title: String,
    /// Lowest, mean (over the samples) and highest, metres.
    heights_m: [f64; 3],
    decimation: Vec<LevelError>,
    sizes: Vec<SizeFound>,
    /// Triangles and whole blocks that the paper's rule loses from the middle of a block.
    own_block_lost: [usize; 2],
    /// By TIN and view.
    losses: Vec<(&'static str, Losses)>,
}

/// Runs the experiment and writes `index.html`, `hiraoka.md`, tables (CSV) and pictures into `out`; gives the page's path.
/// `field` is the ground, 3,120 by 2,080 m; it is drawn again with so many copies each way in `copies`, the first being 1.
/// `progress` hears what is being done.
pub fn hiraoka(
    field: &HeightField,
    title: String,
    copies: &[usize],
    out: &Path,
    progress: &dyn Fn(&str),
) -> Result<PathBuf, Error> {
    std::fs::create_dir_all(out).map_err(|source| Error::File { path: out.to_owned(), source })?;
    progress("a TIN of the field");
    let tin = paper_tin(field)?;
    let heights = field.heights_m().iter().filter(|z| !z.is_nan()).map(|&z| f64::from(z));
    let (sum, count) = heights.fold((0.0, 0usize), |(sum, count), z| (sum + z, count + 1));
    let bounds = tin.bounds();
    pictures::plan(&tin, &out.join("plan.png"))?;
    let decimation = decimation::compare(&tin, progress)?;
    let mut sizes = Vec::new();
    for &copies in copies {
        sizes.push(drawing::measure(&mirrored(&tin, copies), copies, out, progress)?);
    }
    progress("the eye's own block");
    let own_block_lost = drawing::own_block(&tin, out)?;
    progress("random poses");
    let lost = |tin: &TriangleMesh, view: &View, poses: usize| -> Result<Losses, Error> {
        let chain = centroid_chain(tin, thresholds_m(1).len() + 1, DRAWN)?;
        Ok(poses::losses(&TinBlocks::new(&chain, grid(1)?)?, &thresholds_m(1), view, poses))
    };
    let whole = lost(&tin, &paper_view(), POSES[0])?;
    let options = GreedyOptions { max_error_m: 0.0, most_triangles: Some(SMALL_TRIANGLES) };
    let mut small = greedy(field, &options)?.tin.mesh;
    let low = small.bounds().min;
    small.positions.iter_mut().for_each(|p| *p -= low.truncate().extend(0.0));
    let losses = vec![
        ("the TIN", whole),
        ("a TIN of 2,000 triangles", lost(&small, &paper_view(), POSES[1])?),
        ("the same, in plan, 45° wide", lost(&small, &view_in_plan(), POSES[1])?),
    ];
    progress("writing the page");
    let heights_m = [bounds.min.z, sum / count.max(1) as f64, bounds.max.z];
    page::write(&Findings { title, heights_m, decimation, sizes, own_block_lost, losses }, out)
}

/// For file names.
fn file_name(culling: Culling) -> &'static str {
    match culling {
        Culling::BruteForce => "brute",
        Culling::Faithful => "paper",
        Culling::Conservative => "conservative",
    }
}
