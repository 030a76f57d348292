//! `wavelet`: a model or terrain under k-disk wavelets of growing width.

use super::remesh::{RemeshArgs, mend};
use super::wavelet_text;
use crate::args::ReadingArgs;
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, values};
use clap::Args;
use std::path::{Path, PathBuf};
use yamanami::core::TriangleMesh;
use yamanami::io::{dem, mesh_file};
use yamanami::multires::kdisk::Wavelet;
use yamanami::multires::remesh::RemeshReport;
use yamanami::{SemiRegularModel, usual_thresholds_m, wavelet_study, write_wavelet_plots};

/// Compare wavelets on a model or terrain: compression, accuracy, time
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami generate ball -o ball.ply
  yamanami wavelet ball.ply                                all wavelets, a table for each measure
  yamanami wavelet scan.ply --remesh                       a scan, made semi-regular first
  yamanami wavelet dem.tif --wavelets lazy,kdisk:2         the same for heights
  yamanami wavelet ball.ply -o plots --json                plots too; numbers for a machine

A model needs subdivision connectivity: each triangle of a base mesh split in four, again and
again. It is found in any order of vertices and triangles. With --remesh a scan gets it first.

Wavelets: lazy (new vertices less the middle of their parents), kdisk:K (orthogonal to the hat
functions of the vertices within K edges, 0 to 8), orthogonal (to all: least squares, the limit).")]
pub(crate) struct WaveletArgs {
    /// A mesh with subdivision connectivity, or an elevation file without holes
    source: PathBuf,
    /// Which wavelets
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = values::wavelet, default_value = "lazy,kdisk:0,kdisk:1,kdisk:2,kdisk:3,kdisk:4,orthogonal")]
    wavelets: Vec<Wavelet>,
    /// Thresholds of the details, metres; else a range that suits the model
    #[arg(long, value_name = "M,M,…", value_delimiter = ',', value_parser = values::not_negative)]
    thresholds: Vec<f64>,
    /// Folder for plots
    #[arg(short, long, value_name = "DIR", help_heading = "Results")]
    output: Option<PathBuf>,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
    /// Remesh a model that has no levels
    #[arg(long, help_heading = "Remeshing")]
    remesh: bool,
    #[command(flatten)]
    how: RemeshArgs,
    #[command(flatten)]
    reading: ReadingArgs,
}

pub(crate) fn run(args: &WaveletArgs) -> Result<(), Failure> {
    if let Some(folder) = &args.output {
        inputs::make_folder(folder)?;
    }
    let model = open(&args.source, &args.reading, args.remesh.then_some(&args.how))?;
    let thresholds_m = match args.thresholds.as_slice() {
        [] => usual_thresholds_m(model.to_mesh().bounds().diagonal()),
        given => given.to_vec(),
    };
    let study = {
        let bar = Bar::spinner("analysing");
        wavelet_study(&model, &args.wavelets, &thresholds_m, &|at| bar.set_job(&format!("analysing: {at}")))?
    };
    if args.json {
        wavelet_text::json(&study)?;
    } else {
        wavelet_text::print(&study, !args.thresholds.is_empty())?;
    }
    if let Some(folder) = &args.output {
        for (file, shows) in write_wavelet_plots(&study, folder, "wavelet")? {
            note(&format!("{}: {shows}", folder.join(file).display()));
        }
    }
    Ok(())
}

/// A semi-regular model: an elevation file's grid, or a mesh that has levels.
fn open(path: &Path, reading: &ReadingArgs, remesh: Option<&RemeshArgs>) -> Result<SemiRegularModel, Failure> {
    let title = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if inputs::is_mesh(path) {
        let mut mesh = {
            let _bar = Bar::spinner("reading");
            mesh_file::read_mesh(path)?
        };
        if remesh.is_some() {
            mend(&mut mesh);
        }
        return Ok(semi_regular(&mesh, path, title, remesh)?.0);
    }
    let field = {
        let _bar = Bar::spinner("reading");
        dem::open(&[path.to_owned()], &reading.options().dem)?.read_all()?
    };
    Ok(SemiRegularModel::of_heights(&field, title)?)
}

/// A mesh as a semi-regular model: by its own levels, or remeshed where it has none and that is wanted.
pub(crate) fn semi_regular(
    mesh: &TriangleMesh,
    path: &Path,
    title: String,
    remesh: Option<&RemeshArgs>,
) -> Result<(SemiRegularModel, Option<RemeshReport>), Failure> {
    let named = |e: yamanami::Error| Failure::failed(format!("{}: {e}", path.display()));
    if let Some(model) = SemiRegularModel::recognised(mesh, title.clone()).map_err(named)? {
        return Ok((model, None));
    }
    let Some(args) = remesh else {
        return Err(Failure::failed(format!(
            "{0}: no subdivision connectivity: expected triangles that come from splitting a base mesh four to one, given {1} that \
             do not; add --remesh, or remesh once: yamanami remesh {0} -o remeshed.ply",
            path.display(),
            mesh.triangles.len(),
        )));
    };
    let bar = Bar::shares("remeshing");
    let progress = |share| bar.set_share(share);
    let (model, report) = SemiRegularModel::remeshed(mesh, title, &args.options(&progress)).map_err(named)?;
    Ok((model, Some(report)))
}
