//! Semi-regular models to a file of which any prefix is a coarser model, and back.
//!
//! Based on: Khodakovsky, Schröder, Sweldens, "Progressive geometry compression", 2000.

use crate::Error;
use glam::DVec3;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use yamanami_core::{DetailScheme, Predictor, SemiRegular};
use yamanami_io::progressive::{
    ProgressiveLimits, ProgressiveMeta, ProgressiveModel, ProgressiveReport, Renumbered, decode, encode, renumber,
};
use yamanami_multires::progressive::{details, positions};

/// How a model is made into a progressive file.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgressiveOptions {
    /// For people.
    pub title: String,
    /// Where the model comes from, for people.
    pub source: String,
    /// How new vertices are foretold.
    pub predictor: Predictor,
    /// How much of each new vertex's detail moves either end of its edge; zero: no update step.
    pub update: f32,
    /// A unit along the normal on the finest level, as a part of the diagonal of the model's box: the whole file is about as exact.
    pub precision: f64,
    /// How much larger a unit is from a level to the next: the surface that a coefficient moves becomes smaller.
    pub level_ratio: f32,
    /// How much larger a unit is along the surface than along the normal.
    pub tangent_ratio: f32,
    /// A unit of the base mesh's coordinates, as a part of one along the normal on level 1.
    pub base_ratio: f64,
}

impl Default for ProgressiveOptions {
    fn default() -> Self {
        Self {
            title: String::new(),
            source: String::new(),
            predictor: Predictor::Butterfly,
            update: 0.17,
            precision: 1e-5,
            level_ratio: 2.0,
            tangent_ratio: 4.0,
            base_ratio: 0.5,
        }
    }
}

/// A model as a progressive file.
#[derive(Debug, Clone)]
pub struct ProgressiveFile {
    /// The file.
    pub bytes: Vec<u8>,
    /// By vertex of the file: the number that it had.
    pub old_vertices: Vec<u32>,
    /// No vertex of the whole file is farther from the one given, metres; it says so itself.
    pub max_error_m: f64,
}

/// A model from a progressive file, or from its beginning.
#[derive(Debug, Clone)]
pub struct ProgressiveSurface {
    /// The mesh: the numbers are the file's.
    pub mesh: SemiRegular,
    /// By vertex.
    pub positions_m: Vec<DVec3>,
    /// What the file says of itself.
    pub meta: ProgressiveMeta,
    /// How much was read.
    pub report: ProgressiveReport,
}

/// Makes a model, vertices by level, into a progressive file.
pub fn encode_progressive(
    mesh: &SemiRegular,
    positions_m: &[DVec3],
    options: &ProgressiveOptions,
) -> Result<ProgressiveFile, Error> {
    let count = mesh.vertex_count(mesh.levels()) as usize;
    if positions_m.len() != count {
        return Err(Error::Request(format!("{count} vertices expected, {} given", positions_m.len())));
    }
    if count == 0 {
        return Err(Error::Request("a model with triangles expected, an empty one given".into()));
    }
    if let Some(v) = positions_m.iter().position(|p| !p.is_finite()) {
        return Err(Error::Request(format!("vertex {v}: finite coordinates expected, {} given", positions_m[v])));
    }
    let Renumbered { mesh, old_vertices } = renumber(mesh);
    let own: Vec<DVec3> = old_vertices.iter().map(|&v| positions_m[v as usize]).collect();
    let (low, high) = own.iter().fold((own[0], own[0]), |(low, high), &p| (low.min(p), high.max(p)));
    let scheme = scheme(&mesh, low, high, options)?;
    let told = details(&mesh, &own, &scheme);
    let max_error_m = std::iter::zip(&own, &told.positions_m).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    let half_size_m = (0.5 * (high - low)).to_array().map(|x| x as f32);
    let (title, source) = (options.title.clone(), options.source.clone());
    let meta = ProgressiveMeta { title, source, scheme, half_size_m, max_error_m: (max_error_m as f32).next_up() };
    let bytes = encode(&mesh, &told.coefficients, &meta)?;
    Ok(ProgressiveFile { bytes, old_vertices, max_error_m: meta.max_error_m.into() })
}

fn scheme(mesh: &SemiRegular, low: DVec3, high: DVec3, options: &ProgressiveOptions) -> Result<DetailScheme, Error> {
    let (precision, ratio) = (options.precision, options.level_ratio);
    if !(precision > 1e-9 && precision < 1.0) {
        return Err(Error::Request(format!("a precision between 1e-9 and 1 expected, {precision} given")));
    }
    let ratios = [f64::from(ratio), options.tangent_ratio.into(), options.base_ratio];
    if !ratios.iter().all(|r| (1e-3..=1e3).contains(r)) || !(0.0..=1.0).contains(&options.update) {
        let given = format!("{ratios:?} and {}", options.update);
        return Err(Error::Request(format!(
            "ratios between 0.001 and 1000 and an update of 0 to 1 expected, {given} given"
        )));
    }
    let diagonal_m = (high - low).length();
    let finest_m = precision * if diagonal_m > 0.0 { diagonal_m } else { 1.0 };
    let step_m = finest_m / f64::from(ratio).powi(mesh.levels().saturating_sub(1) as i32);
    Ok(DetailScheme {
        predictor: options.predictor,
        update: options.update,
        origin_m: 0.5 * (low + high),
        base_step_m: step_m * options.base_ratio,
        step_m,
        level_ratio: ratio,
        tangent_ratio: options.tangent_ratio,
    })
}

/// Reads a model from a progressive file's bytes, or from as many of the first of them as there are. `name` is for messages.
pub fn decode_progressive(name: &Path, bytes: &[u8], limits: ProgressiveLimits) -> Result<ProgressiveSurface, Error> {
    let ProgressiveModel { mesh, coefficients, meta, report } = decode(name, bytes, limits)?;
    let positions_m = positions(&mesh, &coefficients, &meta.scheme);
    Ok(ProgressiveSurface { mesh, positions_m, meta, report })
}

/// Reads a progressive file, or its first `max_bytes`.
pub fn read_progressive(path: &Path, max_bytes: u64, limits: ProgressiveLimits) -> Result<ProgressiveSurface, Error> {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(max_bytes).read_to_end(&mut bytes));
    read.map_err(|source| Error::File { path: path.to_owned(), source })?;
    decode_progressive(path, &bytes, limits)
}
