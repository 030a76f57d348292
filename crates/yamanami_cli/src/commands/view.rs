//! `view`: the desktop window.

use crate::args::{ControlArgs, EyeArgs, FinenessArgs, LensArgs, SourceArgs};
use crate::failure::Failure;
use crate::pictures::Colour;
use crate::values;
use clap::Args;
use std::path::PathBuf;

/// Fly and orbit in a window
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami view dem.yama
  yamanami view dem.tif --budget 200000 --tolerance-px 1
  yamanami view dem.yama --path flight.json                  replay a recorded path
  yamanami view dem.yama --water 620 --colour slope          with water, which is measured
  yamanami view scan.yama                                    around a model
  yamanami view --map dem.tif --at 35.36,138.73              a deformed map (yamanami view --map --help)

All that is set here can be changed in the window.")]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) source: SourceArgs,
    #[command(flatten)]
    pub(crate) fineness: FinenessArgs,
    #[command(flatten)]
    pub(crate) control: ControlArgs,
    #[command(flatten)]
    pub(crate) eye: EyeArgs,
    #[command(flatten)]
    pub(crate) lens: LensArgs,
    /// A recorded camera path to replay
    #[arg(long, value_name = "FILE.json", help_heading = "Path")]
    pub(crate) path: Option<PathBuf>,
    /// What gives the surface its colour; else height for terrain, and for models their own colours
    #[arg(long, value_enum, value_name = "BY", help_heading = "Drawing", conflicts_with = "image")]
    pub(crate) colour: Option<Colour>,
    /// Height of a water surface: what lies below is tinted blue, and measured
    #[arg(long, value_name = "M", value_parser = values::number, allow_hyphen_values = true, help_heading = "Drawing")]
    pub(crate) water: Option<f64>,
    /// An image to lay over the surface
    #[arg(long, value_name = "FILE", help_heading = "Drawing")]
    pub(crate) image: Option<PathBuf>,
    /// Save a picture of the window when the first frames have settled, and close it
    #[arg(long, value_name = "P.png", help_heading = "Results")]
    pub(crate) screenshot: Option<PathBuf>,
}

#[cfg(feature = "viewer")]
pub(crate) fn run(args: &ViewArgs) -> Result<(), Failure> {
    match crate::inputs::subject(&args.source)? {
        crate::inputs::Opened::Terrain(terrain) => open(args, *terrain),
        crate::inputs::Opened::Model(model) => open(args, *model),
        crate::inputs::Opened::Progressive(model) => open(args, *model),
    }
}

#[cfg(feature = "viewer")]
fn open(args: &ViewArgs, subject: impl yamanami::Subject + 'static) -> Result<(), Failure> {
    let size = args.lens.size.unwrap_or([1280, 800]);
    let view = crate::args::view(&args.eye, &args.lens, &subject, size);
    let asked = args.eye.eye.is_some() || args.lens.fov.is_some();
    let path = args.path.as_ref().map(|file| yamanami::read_path(&subject, file, size)).transpose()?;
    let criteria = args.fineness.criteria(Some(view), !args.lens.no_cull, 1.0);
    let options = crate::view::Options {
        criteria: args.control.limit(criteria),
        lod: args.control.lod(&subject, args.fineness.tolerance),
        path,
        view: asked.then_some(view),
        sources: args.source.sources.clone(),
        reading: args.source.reading.options(),
        colour: args.colour,
        water_m: args.water,
        image: args.image.clone(),
        size,
        screenshot: args.screenshot.clone(),
    };
    crate::view::run(subject, options).map_err(Failure::failed)
}

#[cfg(not(feature = "viewer"))]
pub(crate) fn run(_: &ViewArgs) -> Result<(), Failure> {
    no_window()
}

/// What is told where the window was left out.
#[cfg(not(feature = "viewer"))]
pub(super) fn no_window() -> Result<(), Failure> {
    Err(Failure::failed(
        "this yamanami was built without its window; rebuild with: cargo build --release -p yamanami_cli --features viewer",
    ))
}
