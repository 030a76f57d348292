//! `view --map`: the desktop window of deformed maps.

use super::map_args::{OverlayArgs, PlaceArgs, ProjectionArgs};
use crate::args::SourceArgs;
use crate::failure::Failure;
use crate::values;
use clap::Args;
use std::path::PathBuf;
#[cfg(feature = "viewer")]
use {
    super::map_args::{Letters, SUMMITS, places_and_lines},
    crate::progress::note,
    yamanami::MapImage,
    yamanami::map::latin_name,
    yamanami::multires::rtin::BuildOptions,
};

/// A deformed map in a window: near a map, far away a panorama, to be dragged about
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami view --map dem.tif --at 35.36,138.73
  yamanami view --map dem.tif --at 35.66,138.57 --radius 110 --ring 30 --eye 9000 --places mountains.csv

All that is set here can be changed in the window. The ground is read again when its centre has been moved away.")]
pub(crate) struct ViewMapArgs {
    #[command(flatten)]
    pub(crate) source: SourceArgs,
    #[command(flatten)]
    pub(crate) place: PlaceArgs,
    #[command(flatten)]
    pub(crate) projection: ProjectionArgs,
    /// No ground is drawn further from its place than this, pixels
    #[arg(long, value_name = "P", default_value_t = 1.0, value_parser = values::tolerance, help_heading = "How fine")]
    pub(crate) tolerance_px: f32,
    /// Most triangles
    #[arg(long, value_name = "N", value_parser = values::budget, help_heading = "How fine")]
    pub(crate) budget: Option<u32>,
    #[command(flatten)]
    pub(crate) overlay: OverlayArgs,
    /// Size of the window [default: 1280x800]
    #[arg(long, value_name = "WxH", value_parser = values::picture_size, help_heading = "Results")]
    pub(crate) size: Option<[u32; 2]>,
    /// Save a picture of the window when the first frames have settled, and close it
    #[arg(long, value_name = "P.png", help_heading = "Results")]
    pub(crate) screenshot: Option<PathBuf>,
}

/// Distance at which ground has faded into the air by two thirds, metres.
#[cfg(feature = "viewer")]
const HAZE_M: f64 = 230e3;

#[cfg(feature = "viewer")]
pub(crate) fn run(args: &ViewMapArgs) -> Result<(), Failure> {
    let (place, overlay) = (&args.place, &args.overlay);
    let map = args.projection.map()?;
    let fonts = super::map::fonts(overlay)?;
    let (mut places, lines, notes) = places_and_lines(overlay)?;
    notes.iter().for_each(|line| note(line));
    if overlay.letters == Letters::Latin {
        for place in &mut places {
            place.name = latin_name(place).unwrap_or_else(|| std::mem::take(&mut place.name));
        }
    }
    let image = overlay.image.as_deref().map(|file| MapImage::read(file, overlay.image_crs.as_ref())).transpose()?;
    let options = crate::view::map::Options {
        sources: args.source.sources.clone(),
        reading: args.source.reading.options().dem,
        ground: place.ground(),
        build: BuildOptions { summits: Some(SUMMITS) },
        relief: place.relief(HAZE_M),
        map,
        up_azimuth_rad: place.up.to_radians(),
        tolerance_px: args.tolerance_px,
        budget_triangles: args.budget,
        places,
        lines,
        hidden: overlay.hidden,
        from_ground: overlay.from_ground,
        fonts,
        size: args.size.unwrap_or([1280, 800]),
        screenshot: args.screenshot.clone(),
    };
    crate::view::map::run(options, image).map_err(Failure::failed)
}

#[cfg(not(feature = "viewer"))]
pub(crate) fn run(_: &ViewMapArgs) -> Result<(), Failure> {
    super::view::no_window()
}
