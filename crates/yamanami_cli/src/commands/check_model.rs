//! The check of a mesh extracted from a model: how far it is from the finest one, both ways, and whether it has cracks.

use crate::failure::Failure;
use crate::progress::Bar;
use crate::{out, text};
use serde_json::{Value, json};
use yamanami::core::TriangleMesh;
use yamanami::measure::{ConformityReport, SurfaceDistance, conformity, surface_distance};
use yamanami::{Criteria, Subject};

/// Points on each surface from which the distance to the other is measured.
const SAMPLES: usize = 1_000_000;
/// Distances are off by this part of the coordinates, which are 64-bit floats.
const MEASURING: f64 = 1e-11;

/// What was measured.
#[derive(Debug)]
pub(crate) struct ModelCheck {
    distance: SurfaceDistance,
    conformity: ConformityReport,
    /// The finest mesh's: what the source had, the extracted mesh may have.
    finest: ConformityReport,
    /// The finest mesh is at most so far from the source, metres; and what measuring itself may be off by.
    slack_m: f64,
}

impl ModelCheck {
    /// Measures a mesh against all that the model holds, itself at most `stored_error_m` from its source.
    pub(crate) fn new(model: &mut impl Subject, mesh: &TriangleMesh, stored_error_m: f64) -> Result<Self, Failure> {
        let _bar = Bar::spinner("checking");
        let reach_m = model.bounds().min.abs().max(model.bounds().max.abs()).max_element();
        let finest = yamanami::extract(model, &Criteria::default())?.mesh;
        Ok(Self {
            distance: surface_distance(mesh, &finest, SAMPLES, 1),
            conformity: conformity(mesh),
            finest: conformity(&finest),
            slack_m: stored_error_m + reach_m * MEASURING,
        })
    }

    pub(crate) fn to_json(&self) -> Value {
        let c = &self.conformity;
        json!({
            "hausdorff_m": self.distance.hausdorff_m,
            "rms_m": self.distance.rms_m,
            "samples": SAMPLES,
            "open_edges": c.open_edges,
            "border_loops": c.border_loops,
            "non_manifold_edges": c.non_manifold_edges,
            "inconsistent_edges": c.inconsistent_edges,
            "finest_open_edges": self.finest.open_edges,
        })
    }

    pub(crate) fn print(&self) -> Result<(), Failure> {
        let metres = |m: f64| text::number(m);
        out::row(
            "true error",
            format_args!("at most {} m, rms {} m", metres(self.distance.hausdorff_m), metres(self.distance.rms_m)),
        )?;
        out::row("", format_args!("{} points on each side measured", text::count(SAMPLES)))?;
        let c = &self.conformity;
        let border = if c.open_edges == 0 {
            "closed".to_owned()
        } else {
            format!("{} open edges in {} loops", text::count(c.open_edges), text::count(c.border_loops))
        };
        out::row("mesh", format_args!("{border}; {} non-manifold edges", text::count(c.non_manifold_edges)))
    }

    /// A check that finds a broken promise is a failure.
    pub(crate) fn verdict(&self, promised_m: Option<f64>) -> Result<(), Failure> {
        let max_m = self.distance.hausdorff_m;
        let allowed_m = promised_m.map(|m| m + self.slack_m);
        if let Some(allowed_m) = allowed_m.filter(|&allowed_m| max_m > allowed_m) {
            return Err(Failure::failed(format!(
                "check: the true error is {max_m} m, at most {allowed_m} m was promised"
            )));
        }
        if self.finest.open_edges == 0 && self.conformity.open_edges > 0 {
            return Err(Failure::failed(format!(
                "check: the mesh has {} open edges, the model none",
                self.conformity.open_edges
            )));
        }
        Ok(())
    }
}
