//! Judges tilesets, ours or others': the rules of their formats, cracks between neighbours at every mix of levels, and
//! declared against measured error.
//!
//! The geometry is judged by `yamanami_measure::tiles`, the bytes are read by `yamanami_io::inspect`; neither shares code with
//! what writes tiles.

mod cache;
mod fit;
mod kind;
mod quantized_mesh;
mod raster;
mod raster_fit;
mod report;
mod rules;
mod source;
mod tileset;

pub use report::{CrackRow, ErrorRow, Finding, Severity, ValidateReport};
pub use rules::{RULES, Rule};

use crate::Error;
use kind::Kind;
use source::Source;
use std::path::{Path, PathBuf};
use yamanami_io::dem::OpenOptions;
use yamanami_io::inspect::{Faults, glb};

/// Tells which step is at work and how far it is, from 0 to 1.
pub(crate) type Progress<'p> = &'p (dyn Fn(&str, f32) + Sync);

/// Tiles displaced by more samples than this are wrong, not rounded.
const MOST_SHIFT_SAMPLES: f64 = 0.05;

/// What is asked for.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ValidateOptions {
    /// Only so many tiles, chosen at random.
    pub tiles: Option<usize>,
    /// What the choice depends on.
    pub seed: u64,
    /// Cracks up to so many metres are tolerated, beside what quantisation explains.
    pub crack_m: f64,
    /// Error in metres that the deepest tiles of terrain are said to have; each coarser zoom twice the next.
    pub declared_m: Option<f64>,
    /// Elevation files that the tiles were made of.
    pub source: Vec<PathBuf>,
    /// How to read them, and raster tiles.
    pub dem: OpenOptions,
    /// Metres to add to the source's heights to come to those of the tiles: the geoid's height.
    pub source_offset_m: f64,
}

impl Default for ValidateOptions {
    fn default() -> Self {
        Self {
            tiles: None,
            seed: 1,
            crack_m: 0.1,
            declared_m: None,
            source: Vec::new(),
            dem: OpenOptions::default(),
            source_offset_m: 0.0,
        }
    }
}

/// Judges a tileset: a folder, an archive or a single tile.
pub fn validate(
    path: &Path,
    options: &ValidateOptions,
    progress: &(dyn Fn(&str, f32) + Sync),
) -> Result<ValidateReport, Error> {
    let kind = Kind::of(path)?;
    let source = match options.source.as_slice() {
        [] => None,
        paths => Some(Source::open(paths, &options.dem, options.source_offset_m)?),
    };
    let source = source.as_ref();
    let mut report = match kind {
        Kind::QuantizedMesh => quantized_mesh::folder(path, options, source, progress)?,
        Kind::Terrain(bytes) => quantized_mesh::single(path, &bytes),
        Kind::Tileset(container, name) => tileset::judge(&container, &name, options, source, progress)?,
        Kind::ThreeTz => tileset::archive(path, options, source, progress)?,
        Kind::Glb(bytes) => single_glb(path, &bytes),
        Kind::Raster => raster::folder(path, options, source, progress)?,
        Kind::PmTiles => raster::archive(path, options, source, progress)?,
    };
    report.sort();
    Ok(report)
}

fn single_glb(path: &Path, bytes: &[u8]) -> ValidateReport {
    let mut report = ValidateReport::new("binary glTF");
    let mut faults = Faults::default();
    let found = glb(bytes, &mut faults);
    (report.tiles, report.bytes, report.triangles) = ([1; 2], bytes.len() as u64, found.mesh.triangles.len() as u64);
    report.add_all(&path.file_name().unwrap_or_default().to_string_lossy(), faults.into_vec());
    report
}

/// So many of a list, by a seed, in their order.
fn sample<T: Copy>(all: &[T], count: usize, seed: u64) -> Vec<T> {
    if count >= all.len() {
        return all.to_vec();
    }
    let mut order: Vec<(u64, usize)> = (0..all.len()).map(|k| (scramble(seed ^ scramble(k as u64 + 1)), k)).collect();
    order.sort_unstable();
    let mut chosen: Vec<usize> = order[..count].iter().map(|&(_, k)| k).collect();
    chosen.sort_unstable();
    chosen.into_iter().map(|k| all[k]).collect()
}

/// Mixes 64 bits: G. L. Steele et al., "Fast splittable pseudorandom number generators", 2014.
fn scramble(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}
