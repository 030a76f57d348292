//! What `map` is asked for: the place, the projection, how fine, what is drawn, on what sheet.

use crate::failure::Failure;
use crate::values;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use yamanami::core::{Crs, Curvature, DeformedMap, DropFrom, LineKind, MapLine, NamedPlace};
use yamanami::io::crs::AzimuthalPlane;
use yamanami::io::geodata::{LineReadOptions, PlaceReadOptions, read_lines, read_places};
use yamanami::map::{BearingRing, NameForm, ReliefStyle, SheetOptions};
use yamanami::multires::rtin::SummitRule;
use yamanami::{MapGroundOptions, lay_lines, lay_places};

/// Nearest grid of heights, as a share of the widest one's spacing.
const FINEST_SHARE: f64 = 0.125;
/// Ground up to this height is sea, metres.
const SEA_M: f32 = 0.4;
/// Summits that stand out stay in the mesh longer than their error alone would keep them.
pub(crate) const SUMMITS: SummitRule = SummitRule { factor: 1.0, min_prominence_m: 100.0 };

/// Where the map stands and how far it reaches.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Place")]
pub(crate) struct PlaceArgs {
    /// Centre of the map, degrees
    #[arg(long, value_name = "LAT,LON", value_parser = values::lat_lon, allow_hyphen_values = true)]
    pub(crate) at: [f64; 2],
    /// How far the map reaches, kilometres
    #[arg(long, value_name = "KM", default_value_t = 160.0, value_parser = values::positive)]
    pub(crate) radius: f64,
    /// Azimuth that points up, degrees clockwise from north
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = values::number, allow_hyphen_values = true)]
    pub(crate) up: f64,
    /// Metres between the heights of the widest grid; nearer ones are finer
    #[arg(long, value_name = "M", default_value_t = 200.0, value_parser = values::positive)]
    pub(crate) spacing: f64,
    /// What ground without data is
    #[arg(long, value_enum, default_value_t, value_name = "WHAT")]
    pub(crate) no_data: NoData,
}

impl PlaceArgs {
    /// The ground to read.
    pub(crate) fn ground(&self) -> MapGroundOptions {
        let [lat, lon] = self.at;
        MapGroundOptions {
            radius_m: 1000.0 * self.radius,
            spacing_m: self.spacing,
            finest_spacing_m: FINEST_SHARE * self.spacing,
            no_data: match self.no_data {
                NoData::Sea => yamanami::NoData::Sea,
                NoData::Blank => yamanami::NoData::Hole,
            },
            ..MapGroundOptions::around([lon, lat])
        }
    }

    /// Its colours in air of this haze, metres.
    pub(crate) fn relief(&self, haze_m: f64) -> ReliefStyle {
        let sea_level_m = (self.no_data == NoData::Sea).then_some(SEA_M);
        ReliefStyle { haze_m, sea_level_m, ..ReliefStyle::default() }
    }
}

/// What ground without data is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum NoData {
    /// Open sea
    #[default]
    Sea,
    /// Left blank
    Blank,
}

/// From where the ground falls away.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Curved {
    /// From the ring, above which the eyes stand
    #[default]
    Ring,
    /// From the centre, as a viewer there has it
    Centre,
    /// A flat Earth, as in the paper
    None,
}

/// The projection.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Projection")]
pub(crate) struct ProjectionArgs {
    /// Radius of the plain map in the middle (D_R), kilometres
    #[arg(long, value_name = "KM", default_value_t = 10.0, value_parser = values::number, allow_hyphen_values = true)]
    pub(crate) ring: f64,
    /// Height of the eye above sea, metres; all ground near the ring must lie lower
    #[arg(long, value_name = "M", default_value_t = 5000.0, value_parser = values::number, allow_hyphen_values = true)]
    pub(crate) eye: f64,
    /// Share of the plane beyond the ring: 0 a panorama, 1 a map
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = values::number, allow_hyphen_values = true)]
    pub(crate) alpha: f64,
    /// How fast alpha falls with distance: as (D_R / r)^P
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = values::not_negative)]
    pub(crate) alpha_fall: f64,
    /// Scale of the far part; else the one that joins the ring smoothly (1 is the paper's)
    #[arg(long, value_name = "S", value_parser = values::positive)]
    pub(crate) scale: Option<f64>,
    /// Factor on heights
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = values::positive)]
    pub(crate) exaggeration: f64,
    /// From where the Earth curves down
    #[arg(long, value_enum, default_value_t, value_name = "FROM")]
    pub(crate) curvature: Curved,
    /// Bending of light, as a share of the Earth's curvature
    #[arg(long, value_name = "K", default_value_t = 0.13, value_parser = values::number)]
    pub(crate) refraction: f64,
}

impl ProjectionArgs {
    /// The projection around the plane's origin; its numbers are checked.
    pub(crate) fn map(&self) -> Result<DeformedMap, Failure> {
        let (ring_m, eye_m) = (1000.0 * self.ring, self.eye);
        let curvature = |from| Some(Curvature { refraction: self.refraction, from });
        let map = DeformedMap {
            ring_m,
            eye_m,
            alpha: self.alpha,
            alpha_fall: self.alpha_fall,
            scale: self.scale.unwrap_or_else(|| DeformedMap::smooth_scale(ring_m, eye_m)),
            exaggeration: self.exaggeration,
            curvature: match self.curvature {
                Curved::Ring => curvature(DropFrom::Ring),
                Curved::Centre => curvature(DropFrom::Centre),
                Curved::None => None,
            },
            ..DeformedMap::default()
        };
        map.check().map_err(|fault| Failure::misuse(fault.to_string()))?;
        Ok(map)
    }
}

/// Which mesh is drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum MapLod {
    /// As coarse as the tolerance allows wherever it does
    #[default]
    Exact,
    /// The bands of distance of Hori et al., heights moved to keep peaks
    Paper,
    /// Every sample
    Full,
}

/// How fine the ground is.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "How fine")]
pub(crate) struct MapFinenessArgs {
    /// Which mesh is drawn
    #[arg(long, value_enum, default_value_t, value_name = "NAME")]
    pub(crate) lod: MapLod,
    /// No ground is drawn further from its place than this, pixels
    #[arg(long, value_name = "P", default_value_t = 1.0, value_parser = values::tolerance)]
    pub(crate) tolerance_px: f32,
    /// Most triangles
    #[arg(long, value_name = "N", value_parser = values::budget)]
    pub(crate) budget: Option<u32>,
    /// Measure how far every sample of the heights is drawn from its place
    #[arg(long)]
    pub(crate) check: bool,
}

/// What is drawn besides the ground.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Names and lines")]
pub(crate) struct OverlayArgs {
    /// Named places: CSV, GeoJSON or GeoPackage; may be given several times
    #[arg(long, value_name = "FILE")]
    pub(crate) places: Vec<PathBuf>,
    /// Rivers, roads, coasts: GeoJSON, GeoPackage, Shapefile or CSV with WKT; may be given several times
    #[arg(long, value_name = "FILE")]
    pub(crate) lines: Vec<PathBuf>,
    /// A walk: GPX; may be given several times
    #[arg(long, value_name = "FILE")]
    pub(crate) track: Vec<PathBuf>,
    /// A picture with a georeference, laid over the plain map and faded out beyond it
    #[arg(long, value_name = "FILE")]
    pub(crate) image: Option<PathBuf>,
    /// Show hidden summits too, in grey
    #[arg(long)]
    pub(crate) hidden: bool,
    /// Name only what is seen by somebody standing at the centre
    #[arg(long)]
    pub(crate) from_ground: bool,
    /// CRS of the picture's world file [default: longitude and latitude]
    #[arg(long, value_name = "EPSG", value_parser = values::epsg, requires = "image")]
    pub(crate) image_crs: Option<Crs>,
    /// What names are written in
    #[arg(long, value_enum, default_value_t, value_name = "FORM")]
    pub(crate) letters: Letters,
    /// Rings of names around the horizon
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=3))]
    pub(crate) name_rings: u32,
    /// Language of the sheet
    #[arg(long, value_enum, default_value_t, value_name = "LANG")]
    pub(crate) lang: Lang,
    /// A font for names whose letters the program's own lacks: TTF or OTF
    #[arg(long, value_name = "FILE")]
    pub(crate) font: Option<PathBuf>,
}

/// What names are written in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Letters {
    /// As given
    #[default]
    Local,
    /// Latin letters, from the reading where there are none
    Latin,
    /// As given, and small beside it the reading or Latin letters
    Both,
}

impl OverlayArgs {
    /// All files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = PathBuf> {
        let single = self.image.iter().chain(&self.font);
        self.places.iter().chain(&self.lines).chain(&self.track).chain(single).cloned().collect::<Vec<_>>().into_iter()
    }

    pub(crate) fn names(&self) -> NameForm {
        match self.letters {
            Letters::Local => NameForm::Local,
            Letters::Latin => NameForm::Latin,
            Letters::Both => NameForm::Both,
        }
    }
}

/// Places, lines, and what was skipped of them, one line each.
pub(crate) type Overlays = (Vec<NamedPlace>, Vec<MapLine>, Vec<String>);

/// Places and lines of all files, laid into the plane.
pub(crate) fn map_places_and_lines(overlay: &OverlayArgs, plane: &AzimuthalPlane) -> Result<Overlays, Failure> {
    let (mut places, mut lines, notes) = places_and_lines(overlay)?;
    lay_places(&mut places, plane);
    lay_lines(&mut lines, plane);
    Ok((places, lines, notes))
}

/// The same in longitude and latitude.
pub(crate) fn places_and_lines(overlay: &OverlayArgs) -> Result<Overlays, Failure> {
    read_overlays(&overlay.places, &overlay.lines, &overlay.track)
}

/// Reads files of places, lines and walks, in longitude and latitude.
pub(crate) fn read_overlays(
    place_files: &[PathBuf],
    line_files: &[PathBuf],
    tracks: &[PathBuf],
) -> Result<Overlays, Failure> {
    let (mut places, mut lines, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for file in place_files {
        let read = read_places(file, &PlaceReadOptions::default())?;
        places.extend(read.places);
        notes.extend(read.notes.iter().map(|note| format!("{}: {note}", file.display())));
    }
    let of_kind = |kind| LineReadOptions { kind, ..LineReadOptions::default() };
    let tracks = tracks.iter().map(|file| (file, of_kind(Some(LineKind::Track))));
    for (file, options) in line_files.iter().map(|file| (file, of_kind(None))).chain(tracks) {
        let read = read_lines(file, &options)?;
        lines.extend(read.lines);
        notes.extend(read.notes.iter().map(|note| format!("{}: {note}", file.display())));
    }
    Ok((places, lines, notes))
}

/// Language of the sheet's own words.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Lang {
    /// Japanese
    #[default]
    Ja,
    /// English
    En,
}

/// Paper in the A series, upright.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Paper {
    /// 841 x 1189 mm
    A0,
    /// 594 x 841 mm
    A1,
    /// 420 x 594 mm
    A2,
    /// 297 x 420 mm
    A3,
    /// 210 x 297 mm
    A4,
}

impl Paper {
    /// Width and height in millimetres.
    pub(crate) fn size_mm(self) -> [f64; 2] {
        match self {
            Self::A0 => [841.0, 1189.0],
            Self::A1 => [594.0, 841.0],
            Self::A2 => [420.0, 594.0],
            Self::A3 => [297.0, 420.0],
            Self::A4 => [210.0, 297.0],
        }
    }
}

/// The sheet.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Sheet")]
pub(crate) struct SheetArgs {
    /// Paper, upright
    #[arg(long, value_enum, value_name = "NAME", conflicts_with = "size")]
    pub(crate) paper: Option<Paper>,
    /// The paper lies on its long side
    #[arg(long, requires = "paper")]
    pub(crate) landscape: bool,
    /// Dots an inch of the paper
    #[arg(long, value_name = "N", default_value_t = 300.0, value_parser = values::positive)]
    pub(crate) dpi: f64,
    /// Picture size in pixels, in place of a paper [default: 1600x1600]
    #[arg(long, value_name = "WxH", value_parser = values::picture_size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Title of the sheet
    #[arg(long, value_name = "TEXT")]
    pub(crate) title: Option<String>,
    /// Where the data come from, for the foot of the sheet
    #[arg(long, value_name = "TEXT")]
    pub(crate) credit: Option<String>,
    /// No colour where there is no ground
    #[arg(long)]
    pub(crate) transparent: bool,
    /// Only the ground: no names, lines, rings, legend
    #[arg(long)]
    pub(crate) bare: bool,
    /// Distance at which ground has faded into the air by two thirds, kilometres; 0 for clear air
    #[arg(long, value_name = "KM", default_value_t = 230.0, value_parser = values::not_negative)]
    pub(crate) haze: f64,
    /// Colours of height reach to the highest ground of the map, not to 3,700 m
    #[arg(long)]
    pub(crate) stretch: bool,
    /// Draw the mesh
    #[arg(long)]
    pub(crate) wireframe: bool,
}

impl SheetArgs {
    /// Size in pixels, and dots an inch of the paper; none on a screen.
    pub(crate) fn size_px(&self) -> ([u32; 2], Option<f64>) {
        let Some(paper) = self.paper else { return (self.size.unwrap_or([1600, 1600]), None) };
        let [short, long] = paper.size_mm();
        let mm = if self.landscape { [long, short] } else { [short, long] };
        (mm.map(|side| (side * self.dpi / 25.4).round().max(1.0) as u32), Some(self.dpi))
    }

    /// A sheet with nothing but the ground.
    pub(crate) fn bare(&self) -> SheetOptions {
        SheetOptions {
            has_names: false,
            bearing: BearingRing::Off,
            has_distance_rings: false,
            has_scale_bar: false,
            has_legend: false,
            has_title: false,
            has_credits: false,
            has_frame: false,
            ..SheetOptions::default()
        }
    }
}
