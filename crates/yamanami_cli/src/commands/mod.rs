//! The commands, one a file.

mod build;
mod build_model;
mod build_tiles;
mod check;
mod check_model;
mod cleaning;
mod coast;
mod compare;
mod demo;
mod demo_map;
mod export;
mod extract;
mod flight_path;
mod flight_text;
mod fly;
mod generate;
mod generate_tin;
mod heights;
mod info;
mod info_mesh;
mod info_model;
mod info_text;
mod info_tin;
mod map;
mod map_args;
mod map_text;
mod profile;
mod progressive;
mod reduce;
mod reduce_memory;
mod reduce_text;
mod remesh;
mod render;
mod render_model;
mod reproduce;
mod reproduce_hori;
#[cfg(feature = "serve")]
mod serve;
#[cfg(feature = "serve")]
mod site;
mod tin;
mod validate;
mod validate_text;
mod view;
mod view_map;
mod volume;
mod wavelet;
mod wavelet_text;

use crate::failure::Failure;
use clap::{Parser, Subcommand};
use std::ffi::OsString;

/// The window of maps is asked for as `view` with `--map`, which stands anywhere; its arguments are others than those of
/// `view`, so that to the parser it is a command of its own, by this name.
const VIEW_MAP: &str = "view --map";

/// Survey elevation data to smooth, exact and small multiresolution surfaces.
#[derive(Debug, Parser)]
#[command(
    name = "yamanami",
    bin_name = "yamanami",
    version,
    max_term_width = 110,
    after_help = "\
Start with:
  yamanami demo                              all of it on bundled real terrain
  yamanami info dem.tif                      what is this file
  yamanami extract dem.tif --tolerance 10 -o dem.glb
                                             a mesh that stays within 10 m of every sample
  yamanami build dem.tif -o dem.yama         a database with every level of detail in it
  yamanami fly dem.yama --budget 100000 -o flight
                                             a flight with never more than 100,000 triangles
  yamanami map dem.tif --at 35.66,138.57 -o map.png
                                             a map near, mountains far, in one picture

TINs: LandXML, DXF, CityGML relief, 2DM, quantized-mesh; points with breaklines (yamanami tin --help).
Elevation files: GeoTIFF and COG, SRTM .hgt, DTED, ESRI ASCII, GSI FG-GML, elevation tiles. Several
make one mosaic, and a .yama stands wherever they do. Results go to stdout, progress to stderr.
Exit code: 0 success, 1 failure, 2 misuse."
)]
pub(crate) struct Program {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::DemoArgs),
    Info(info::InfoArgs),
    Build(build::BuildArgs),
    View(view::ViewArgs),
    #[command(name = VIEW_MAP, hide = true)]
    ViewMap(Box<view_map::ViewMapArgs>),
    Fly(Box<fly::FlyArgs>),
    Render(render::RenderArgs),
    Map(Box<map::MapArgs>),
    Extract(Box<extract::ExtractArgs>),
    Export(Box<export::ExportArgs>),
    #[cfg(feature = "serve")]
    Serve(serve::ServeArgs),
    Reduce(Box<reduce::ReduceArgs>),
    Compare(compare::CompareArgs),
    Heights(heights::HeightsArgs),
    Profile(profile::ProfileArgs),
    Tin(tin::TinArgs),
    Volume(volume::VolumeArgs),
    Validate(validate::ValidateArgs),
    Generate(generate::GenerateArgs),
    Remesh(remesh::RemeshCommand),
    Wavelet(wavelet::WaveletArgs),
    Reproduce(reproduce::ReproduceArgs),
}

impl Program {
    /// As the program was called.
    pub(crate) fn of_arguments() -> Self {
        Self::parse_from(with_view_map(std::env::args_os().collect()))
    }

    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            Command::Demo(args) => demo::run(args),
            Command::Info(args) => info::run(args),
            Command::Build(args) => build::run(args),
            Command::View(args) => view::run(args),
            Command::ViewMap(args) => view_map::run(args),
            Command::Fly(args) => fly::run(args),
            Command::Render(args) => render::run(args),
            Command::Extract(args) => extract::run(args),
            Command::Export(args) => export::run(args),
            #[cfg(feature = "serve")]
            Command::Serve(args) => serve::run(args),
            Command::Reduce(args) => reduce::run(args),
            Command::Compare(args) => compare::run(args),
            Command::Heights(args) => heights::run(args),
            Command::Map(args) => map::run(args),
            Command::Profile(args) => profile::run(args),
            Command::Tin(args) => tin::run(args),
            Command::Volume(args) => volume::run(args),
            Command::Validate(args) => validate::run(args),
            Command::Generate(args) => generate::run(args),
            Command::Remesh(args) => remesh::run(args),
            Command::Wavelet(args) => wavelet::run(args),
            Command::Reproduce(args) => reproduce::run(args),
        }
    }
}

/// `view … --map …` as the one command that it is.
fn with_view_map(mut arguments: Vec<OsString>) -> Vec<OsString> {
    let flag = arguments.iter().take_while(|&a| a != "--").position(|a| a == "--map");
    if let Some(flag) = flag.filter(|_| arguments.get(1).is_some_and(|a| a == "view")) {
        arguments.remove(flag);
        arguments[1] = VIEW_MAP.into();
    }
    arguments
}

#[cfg(test)]
mod tests {
    use super::{Program, with_view_map};
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Program::command().debug_assert();
    }

    #[test]
    fn the_window_of_maps_is_a_command_of_its_own() {
        let of = |line: &str| with_view_map(line.split(' ').map(Into::into).collect()).join(" ".as_ref());
        assert_eq!(of("yamanami view a.tif --map --at 1,2"), "yamanami view --map a.tif --at 1,2");
        assert_eq!(with_view_map(vec!["yamanami".into(), "view".into(), "--map".into()])[1..], ["view --map"]);
        assert_eq!(of("yamanami view -- --map"), "yamanami view -- --map");
        assert_eq!(of("yamanami render a.tif --map"), "yamanami render a.tif --map");
    }
}
