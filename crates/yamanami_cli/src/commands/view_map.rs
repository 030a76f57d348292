//! `view --map`: the desktop window of deformed maps.

use super::map_args::{OverlayArgs, PlaceArgs, ProjectionArgs};
use crate::args::SourceArgs;
use crate::failure::Failure;
use crate::values;
use clap::Args;
use std::path::PathBuf;

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

#[cfg(feature = "viewer")]
pub(crate) fn run(args: &ViewMapArgs) -> Result<(), Failure> {
    use super::map_args::NoData;
    use crate::progress::note;
    use yamanami::core::LineKind;
    use yamanami::io::geodata::{LineReadOptions, PlaceReadOptions, read_lines, read_places};

    let (place, overlay) = (&args.place, &args.overlay);
    if overlay.image.is_some() {
        return Err(Failure::misuse("--image: the window of maps lays no pictures over the ground"));
    }
    let map = args.projection.map()?;
    let mut places = Vec::new();
    for file in &overlay.places {
        let read = read_places(file, &PlaceReadOptions::default())?;
        read.notes.iter().for_each(|line| note(&format!("note: {line}")));
        places.extend(read.places);
    }
    let mut lines = Vec::new();
    let tracks = overlay.track.iter().map(|file| (file, Some(LineKind::Track)));
    for (file, kind) in overlay.lines.iter().map(|file| (file, None)).chain(tracks) {
        let read = read_lines(file, &LineReadOptions { kind, ..LineReadOptions::default() })?;
        read.notes.iter().for_each(|line| note(&format!("note: {line}")));
        lines.extend(read.lines);
    }
    let font = overlay.font.as_ref().map(std::fs::read).transpose()?;
    if let Some(font) = &font {
        yamanami::map::Fonts::with(font.clone())?;
    }
    let [lat, lon] = place.at;
    crate::view::map::run(crate::view::map::Options {
        sources: args.source.sources.clone(),
        reading: args.source.reading.options().dem,
        ground: yamanami::MapGroundOptions {
            radius_m: 1000.0 * place.radius,
            spacing_m: place.spacing,
            no_data: match place.no_data {
                NoData::Sea => yamanami::NoData::Sea,
                NoData::Blank => yamanami::NoData::Hole,
            },
            ..yamanami::MapGroundOptions::around([lon, lat])
        },
        map,
        up_azimuth_rad: place.up.to_radians(),
        tolerance_px: args.tolerance_px,
        budget_triangles: args.budget,
        places,
        lines,
        hidden: overlay.hidden,
        from_ground: overlay.from_ground,
        most_names: overlay.most_names,
        font,
        size: args.size.unwrap_or([1280, 800]),
        screenshot: args.screenshot.clone(),
    })
    .map_err(Failure::failed)
}

#[cfg(not(feature = "viewer"))]
pub(crate) fn run(_: &ViewMapArgs) -> Result<(), Failure> {
    super::view::no_window()
}
