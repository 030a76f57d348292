//! The land around a place with what is drawn on it: read once at the start, and again beside the window's work when the
//! map has been moved away.

use super::Options;
use glam::DVec2;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use yamanami::core::{MapLine, NamedPlace};
use yamanami::gpu::MapTextures;
use yamanami::io::crs::AzimuthalPlane;
use yamanami::map::{ReliefStyle, paint};
use yamanami::multires::rtin::{BuildOptions, Rtin, summits};
use yamanami::{BaseOptions, MapGroundOptions, MapImage, MapSource, MapSources, rank_by_prominence};

/// The ground is read again once the centre has moved by this share of the map's radius.
pub(super) const MOVED_SHARE: f64 = 0.15;
/// More ground than the map shows is read, so that it can be moved some way.
const REACH: f64 = 1.2;
/// A picture over the plain map reaches this many radii of it, and as far again as the map is moved.
const IMAGE_RINGS: f64 = 1.3;
/// It is made as fine as for a plain map of this radius, pixels.
const IMAGE_RING_PX: f64 = 400.0;
/// Summits of less prominence rank no name, metres.
const LEAST_PROMINENCE_M: f64 = 20.0;
/// Metres in a degree of latitude, a little less than anywhere.
const DEGREE_M: f64 = 110e3;

/// The ground around a place.
pub(super) struct Ground {
    pub(super) surface: Rtin,
    /// Its colours.
    pub(super) textures: Arc<MapTextures>,
    pub(super) plane: AzimuthalPlane,
    /// Named places in the plane, the most important first.
    pub(super) names: Vec<NamedPlace>,
    /// Lines in the plane.
    pub(super) lines: Vec<MapLine>,
    /// Files that gave heights.
    pub(super) sources: Vec<MapSource>,
    /// Height of its highest place, metres.
    pub(super) top_m: f64,
}

/// What the ground is read from.
pub(super) struct Reader {
    sources: MapSources,
    options: MapGroundOptions,
    places: Vec<NamedPlace>,
    lines: Vec<MapLine>,
    build: BuildOptions,
    relief: ReliefStyle,
    image: Option<MapImage>,
    ring_m: f64,
}

impl Reader {
    /// Opens the sources. Errors are one line.
    pub(super) fn open(options: &Options, image: Option<MapImage>) -> Result<Self, String> {
        let sources = MapSources::open(&options.sources, &options.reading).map_err(|error| error.to_string())?;
        let ground = MapGroundOptions { radius_m: REACH * options.ground.radius_m, ..options.ground.clone() };
        Ok(Self {
            sources,
            options: ground,
            places: options.places.clone(),
            lines: options.lines.clone(),
            build: options.build,
            relief: options.relief.clone(),
            image,
            ring_m: options.map.ring_m,
        })
    }

    /// Reads the ground around a longitude and latitude.
    pub(super) fn read(&mut self, centre_lon_lat: [f64; 2]) -> Result<Ground, String> {
        let in_words = |error: &dyn std::error::Error| error.to_string();
        let options = MapGroundOptions { centre_lon_lat, ..self.options.clone() };
        let read = self.sources.read(&options).map_err(|error| in_words(&error))?;
        let (field, plane) = (read.field, read.plane);
        let top_m = f64::from(field.range_m()[1]);
        let mut pictures = paint(&field, &self.relief, DVec2::ZERO);
        if let Some(image) = &self.image {
            let reach_m = IMAGE_RINGS * self.ring_m + MOVED_SHARE * options.radius_m;
            image.lay_over(&mut pictures, &plane, DVec2::ZERO, reach_m, self.ring_m / IMAGE_RING_PX);
        }
        let painted = BaseOptions::painted(pictures).map_err(|error| in_words(&error))?;
        let mut names: Vec<NamedPlace> = self.places.iter().filter_map(|place| self.laid(place, &plane)).collect();
        if !names.is_empty() {
            rank_by_prominence(&mut names, &field, &summits(field.widest(), LEAST_PROMINENCE_M));
            names.sort_by(|a, b| b.rank.unwrap_or(0.0).total_cmp(&a.rank.unwrap_or(0.0)));
        }
        let lines = self.lines.iter().filter_map(|line| self.laid_line(line, &plane)).collect();
        let surface = Rtin::build(field, &self.build).map_err(|error| in_words(&error))?;
        Ok(Ground { surface, textures: painted.textures, plane, names, lines, sources: read.sources, top_m })
    }

    /// A place in the plane, where it lies on the ground that is read.
    fn laid(&self, place: &NamedPlace, plane: &AzimuthalPlane) -> Option<NamedPlace> {
        let [lon, lat] = place.position.to_array();
        // geodesics are dear: most of a country's names are far away in latitude
        if (lat - plane.centre_lon_lat()[1]).abs() * DEGREE_M > self.options.radius_m {
            return None;
        }
        let position = plane.to_plane(lon, lat);
        (position.length() <= self.options.radius_m).then(|| NamedPlace { position, ..place.clone() })
    }

    /// A line in the plane, where it meets the ground that is read.
    fn laid_line(&self, line: &MapLine, plane: &AzimuthalPlane) -> Option<MapLine> {
        let south_north = |p: &DVec2| (p.y - plane.centre_lon_lat()[1]).abs() * DEGREE_M <= self.options.radius_m;
        if !line.points.iter().any(south_north) {
            return None;
        }
        let points: Vec<DVec2> = line.points.iter().map(|p| plane.to_plane(p.x, p.y)).collect();
        let is_near = points.iter().any(|p| p.length() <= self.options.radius_m);
        is_near.then(|| MapLine { points, ..line.clone() })
    }
}

/// Reads ground on a thread of its own.
#[derive(Debug)]
pub(super) struct Loader {
    wanted: Sender<[f64; 2]>,
    read: Receiver<Result<Ground, String>>,
    is_busy: bool,
}

impl Loader {
    /// Hands the reader over; `wake` is called whenever something has been read.
    pub(super) fn new(mut reader: Reader, wake: impl Fn() + Send + 'static) -> Self {
        let (wanted, wants) = channel::<[f64; 2]>();
        let (results, read) = channel();
        // it ends with the window, whose end of the channel is dropped
        std::thread::spawn(move || {
            while let Ok(lon_lat) = wants.recv() {
                if results.send(reader.read(lon_lat)).is_err() {
                    break;
                }
                wake();
            }
        });
        Self { wanted, read, is_busy: false }
    }

    /// Whether something is being read.
    pub(super) fn is_busy(&self) -> bool {
        self.is_busy
    }

    /// Asks for the ground around a longitude and latitude, unless some is being read.
    pub(super) fn ask(&mut self, lon_lat: [f64; 2]) {
        if !self.is_busy {
            self.is_busy = self.wanted.send(lon_lat).is_ok();
        }
    }

    /// What has been read.
    pub(super) fn take(&mut self) -> Option<Result<Ground, String>> {
        let read = self.read.try_recv().ok();
        self.is_busy &= read.is_none();
        read
    }
}

impl std::fmt::Debug for Ground {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ground").field("centre", &self.plane.centre_lon_lat()).finish_non_exhaustive()
    }
}
