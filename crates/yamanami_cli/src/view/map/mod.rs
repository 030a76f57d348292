//! `yamanami view --map`: a window on a deformed map, moved and turned by hand.
//!
//! The map is that of Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map"; that its centre,
//! its α and its picture can be dragged about, the mesh following by differences, is ours.
//!
//! The parts: [`app`] is one frame after another, [`pose`] how the map lies in the picture, [`ground`] reads the land
//! around a place (again when one has moved away), [`stage`] keeps it and draws it, [`settings`] is what the side
//! [`panel`] turns, [`names`] letters the summits, [`overlay`] draws what lies over the picture, [`pick`] tells what is
//! under the cursor.

mod app;
mod ground;
mod keys;
mod names;
mod overlay;
mod panel;
mod pick;
mod settings;
mod stage;

use std::path::PathBuf;
use yamanami::core::{DeformedMap, MapLine, NamedPlace};
use yamanami::io::dem;
use yamanami::map::{Fonts, ReliefStyle};
use yamanami::multires::rtin::BuildOptions;
use yamanami::{MapGroundOptions, MapImage};

/// How the window starts.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    /// Files and databases of heights.
    pub(crate) sources: Vec<PathBuf>,
    /// How they are read.
    pub(crate) reading: dem::OpenOptions,
    /// The ground at first; further places are read alike.
    pub(crate) ground: MapGroundOptions,
    /// How its hierarchy is built.
    pub(crate) build: BuildOptions,
    /// Its colours.
    pub(crate) relief: ReliefStyle,
    /// The projection, its centre at the plane's origin.
    pub(crate) map: DeformedMap,
    /// Azimuth that points up, radians clockwise from north.
    pub(crate) up_azimuth_rad: f64,
    /// Largest error wanted, pixels.
    pub(crate) tolerance_px: f32,
    /// Most triangles.
    pub(crate) budget_triangles: Option<u32>,
    /// Names, in longitude and latitude.
    pub(crate) places: Vec<NamedPlace>,
    /// Lines, in longitude and latitude.
    pub(crate) lines: Vec<MapLine>,
    /// Hidden summits are named too.
    pub(crate) hidden: bool,
    /// What counts as hidden is so for somebody who stands at the centre.
    pub(crate) from_ground: bool,
    /// What names are lettered with.
    pub(crate) fonts: Fonts,
    /// Size of the window in points.
    pub(crate) size: [u32; 2],
    /// Saves a picture of the whole window here once the first frames have settled, and closes it.
    pub(crate) screenshot: Option<PathBuf>,
}

/// Opens the window, a picture laid over the plain map if there is one, and stays until it is closed. The error is one line.
pub(crate) fn run(options: Options, image: Option<MapImage>) -> Result<(), String> {
    let size = options.size;
    let bar = crate::progress::Bar::spinner("reading the ground");
    let mut reader = ground::Reader::open(&options, image)?;
    let ground = reader.read(options.ground.centre_lon_lat)?;
    drop(bar);
    super::open("Deformed map - yamanami", size, move |context, failure| {
        app::MapViewer::new(context, reader, ground, options, failure)
    })
}
