//! What is mended of a mesh before work, on request, and how it is told.

use crate::failure::Failure;
use crate::{out, values};
use clap::Args;
use serde_json::{Map, Value, json};
use yamanami::core::TriangleMesh;
use yamanami::multires::clean::{CleanOptions, CleanReport, clean};

/// What to mend first.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Cleaning")]
pub(crate) struct CleanArgs {
    /// Mend what can be mended safely: join vertices at one place that look alike, drop faces with a repeated corner or that
    /// stand there twice, drop vertices without faces
    #[arg(long)]
    clean: bool,
    /// Join vertices that are no further apart than so many metres; 0 for equal places
    #[arg(long, value_name = "M", value_parser = values::not_negative)]
    weld: Option<f64>,
    /// Join vertices even where colour or texture differ
    #[arg(long, requires = "weld")]
    weld_across_seams: bool,
    /// Drop pieces of fewer faces
    #[arg(long, value_name = "N", value_parser = values::faces)]
    drop_pieces: Option<usize>,
    /// Turn faces so that neighbours face the same way
    #[arg(long)]
    orient: bool,
}

impl CleanArgs {
    fn options(&self) -> Option<CleanOptions> {
        let asked = self.clean || self.weld.is_some() || self.drop_pieces.is_some() || self.orient;
        asked.then(|| {
            let base = if self.clean { CleanOptions::safe() } else { CleanOptions::default() };
            CleanOptions {
                weld_m: self.weld.or(base.weld_m),
                weld_across_seams: self.weld_across_seams,
                min_component_faces: self.drop_pieces.unwrap_or(0),
                orient: self.orient,
                ..base
            }
        })
    }

    /// Does what was asked for. `None` when nothing was.
    pub(crate) fn apply(&self, mesh: &mut TriangleMesh) -> Option<CleanReport> {
        self.options().map(|options| clean(mesh, &options))
    }
}

/// Prints what was mended.
pub(crate) fn tell(report: &CleanReport) -> Result<(), Failure> {
    let changes = report.changes();
    let list: Vec<String> =
        changes.iter().map(|(what, n)| format!("{} {what}", crate::text::count(*n as u64))).collect();
    out::row("cleaned", if list.is_empty() { "nothing to mend".to_owned() } else { list.join(", ") })
}

/// The same as JSON.
pub(crate) fn to_json(report: &CleanReport) -> Value {
    let entries = report.changes().into_iter().map(|(what, n)| (what.replace([' ', '-'], "_"), json!(n)));
    Value::Object(entries.collect::<Map<String, Value>>())
}
