//! The check of an extracted mesh: true error at every sample, and conformity.

use crate::failure::Failure;
use crate::{out, text};
use serde_json::{Value, json};
use yamanami::core::{HeightField, TriangleMesh};
use yamanami::measure::{ConformityReport, VerticalReport, conformity, vertical_error};

/// What was measured.
#[derive(Debug)]
pub(crate) struct Check {
    pub(crate) vertical: VerticalReport,
    pub(crate) conformity: ConformityReport,
}

impl Check {
    /// Measures a mesh of the local frame.
    pub(crate) fn new(field: &HeightField, mesh: &TriangleMesh) -> Self {
        Self { vertical: vertical_error(field, mesh), conformity: conformity(mesh) }
    }

    pub(crate) fn to_json(&self) -> Value {
        let (v, c) = (&self.vertical, &self.conformity);
        json!({
            "max_vertical_m": v.max_m,
            "rms_vertical_m": v.rms_m,
            "mean_vertical_m": v.mean_m,
            "worst_sample": v.worst,
            "samples_measured": v.measured,
            "samples_uncovered": v.uncovered,
            "no_data_samples_covered": v.covered_no_data,
            "area_ratio": v.area_ratio,
            "conforming": c.is_conforming(),
            "border_loops": c.border_loops,
            "t_vertices": c.t_vertices,
            "non_manifold_edges": c.non_manifold_edges,
            "inconsistent_edges": c.inconsistent_edges,
            "degenerate_triangles": c.degenerate,
            "flipped_triangles": c.flipped,
        })
    }

    pub(crate) fn print(&self) -> Result<(), Failure> {
        let v = &self.vertical;
        let at = v.worst.map_or_else(String::new, |[column, row]| format!(" (column {column}, row {row})"));
        out::row("true error", format_args!("at most {} m{at}", text::number(v.max_m)))?;
        out::row("", format_args!("rms {} m, mean {} m", text::number(v.rms_m), text::number(v.mean_m)))?;
        let mut covered = format!("{} samples measured", text::count(v.measured as u64));
        if v.uncovered > 0 {
            covered += &format!(", {} with data not covered", text::count(v.uncovered as u64));
        }
        if v.covered_no_data > 0 {
            covered += &format!(", {} without data covered", text::count(v.covered_no_data as u64));
        }
        out::row("", covered)?;
        self.print_conformity()
    }

    fn print_conformity(&self) -> Result<(), Failure> {
        let c = &self.conformity;
        let verdict = if c.is_conforming() { "conforming" } else { "NOT conforming" };
        out::row("mesh", format_args!("{verdict}: {c}"))
    }
}
