//! The errors of levels: the paper's decimation in its readings, beside the collapse by vertical quadrics.

use crate::Error;
use std::time::Instant;
use yamanami_core::{Tin, TriangleMesh};
use yamanami_measure::tin::{PlanIndex, vertical_difference};
use yamanami_multires::tin::{LevelOptions, collapse_levels};
use yamanami_multires::tin_block::{CostReading, centroid_chain};

/// What a method makes of a TIN at one level.
#[derive(Debug, Clone)]
pub(super) struct LevelError {
    pub(super) method: &'static str,
    /// 1 for a half, 2 for a quarter, …
    pub(super) level: usize,
    pub(super) triangles: usize,
    pub(super) rms_m: f64,
    pub(super) max_m: f64,
    /// Of the whole chain.
    pub(super) seconds: f64,
}

/// Name of the collapse in tables.
pub(super) const COLLAPSE: &str = "yamanami: collapse";

/// Levels below the source in the comparison.
pub(super) const COMPARED: usize = 3;

/// Exact vertical errors of all methods' halves, quarters and eighths.
pub(super) fn compare(source: &TriangleMesh, progress: &dyn Fn(&str)) -> Result<Vec<LevelError>, Error> {
    let index = PlanIndex::new(source);
    let mut errors = Vec::new();
    let mut measure = |method, levels: &[TriangleMesh], seconds| {
        for (nth, mesh) in levels.iter().enumerate() {
            let apart = vertical_difference(mesh, &index);
            errors.push(LevelError {
                method,
                level: nth + 1,
                triangles: mesh.triangles.len(),
                rms_m: apart.rms_m,
                max_m: apart.max_m,
                seconds,
            });
        }
    };
    for reading in CostReading::ALL {
        progress(&format!("decimation: {}", reading.name()));
        let start = Instant::now();
        let chain = centroid_chain(source, COMPARED + 1, reading)?;
        measure(reading.name(), &chain[1..], start.elapsed().as_secs_f64());
    }
    progress("decimation: collapse");
    let tin = Tin::of_mesh("", source.clone());
    let targets: Vec<usize> = (1..=COMPARED).map(|level| source.triangles.len() >> level).collect();
    let start = Instant::now();
    let levels = collapse_levels(&tin, &targets, &LevelOptions::default());
    let seconds = start.elapsed().as_secs_f64();
    let meshes: Vec<TriangleMesh> = levels.into_iter().map(|level| level.mesh).collect();
    measure(COLLAPSE, &meshes, seconds);
    Ok(errors)
}
