//! TINs thinned to halves, quarters, …, by the engine's collapse or the paper's decimation, each level with its true error.

use crate::Error;
use yamanami_core::{Tin, TriangleMesh};
use yamanami_measure::tin::{PlanIndex, VerticalDifference, vertical_difference};
use yamanami_multires::tin::{LevelOptions, collapse_levels};
use yamanami_multires::tin_block::{CostReading, centroid_chain};

/// How a TIN is thinned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ThinBy {
    /// Error-driven edge collapse; borders and breaklines stray no further than this from level to level, metres.
    Collapse {
        /// Metres.
        most_stray_m: f64,
    },
    /// Hiraoka et al. 2005: fans around centroids, the least slope first.
    Hiraoka(CostReading),
}

/// A thinned TIN.
#[derive(Debug, Clone)]
pub struct ThinLevel {
    /// The TIN. By collapse its breaklines are those of the source, which its edges follow within `stray_m`.
    pub tin: Tin,
    /// How far it is from the source vertically, exactly.
    pub vertical: VerticalDifference,
    /// How far borders and breaklines stray from the source's at most, metres; the paper's way does not say.
    pub stray_m: Option<f64>,
}

/// Levels of a half, a quarter, … of the triangles, `levels` of them. Hidden faces are left behind.
pub fn thin(source: &Tin, levels: usize, by: ThinBy) -> Result<Vec<ThinLevel>, Error> {
    let count = source.mesh.triangles.len();
    let meshes: Vec<(TriangleMesh, Option<f64>)> = match by {
        ThinBy::Collapse { most_stray_m } => {
            let targets: Vec<usize> = (1..=levels).map(|k| count >> k.min(63)).collect();
            let snap = Some(yamanami_core::Snap::of(&source.mesh.positions, source.unit_m));
            let made = collapse_levels(source, &targets, &LevelOptions { most_stray_m, snap });
            made.into_iter().map(|level| (level.mesh, Some(level.stray_m))).collect()
        }
        ThinBy::Hiraoka(reading) => {
            let chain = centroid_chain(&source.mesh, levels + 1, reading)?;
            chain.into_iter().skip(1).map(|mesh| (mesh, None)).collect()
        }
    };
    let index = PlanIndex::new(&source.mesh);
    let level = |(mesh, stray_m): (TriangleMesh, Option<f64>)| {
        let vertical = vertical_difference(&mesh, &index);
        let tin = Tin {
            name: source.name.clone(),
            mesh,
            hidden: Vec::new(),
            breaklines: source.breaklines.clone(),
            crs: source.crs.clone(),
            unit_m: source.unit_m,
        };
        ThinLevel { tin, vertical, stray_m }
    };
    Ok(meshes.into_iter().map(level).collect())
}
