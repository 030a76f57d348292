//! What a map shows besides the ground: named places and lines. Readers make them, map makers draw them.

use glam::DVec2;

/// What a named place is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum PlaceKind {
    /// A summit.
    #[default]
    Summit,
    /// A pass.
    Pass,
    /// A town or village.
    Settlement,
    /// A lake, island, station, anything else.
    Other,
}

/// A named place.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NamedPlace {
    /// Its name as written there.
    pub name: String,
    /// How the name is read (kana), where given.
    pub reading: Option<String>,
    /// The name in Latin letters, where given.
    pub latin: Option<String>,
    /// Where: longitude and latitude in degrees as read; plane metres once laid into a plane.
    pub position: DVec2,
    /// Height above sea as given, metres.
    pub height_m: Option<f64>,
    /// What it is.
    pub kind: PlaceKind,
    /// Prominence in metres, population, or whatever else ranks it; the greater the more important.
    pub rank: Option<f64>,
}

/// What a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum LineKind {
    /// A shore of the sea.
    Coast,
    /// A river or canal.
    River,
    /// The shore of a lake.
    Lake,
    /// A road.
    Road,
    /// A railway.
    Railway,
    /// A track walked or to be walked.
    Track,
    /// A border.
    Border,
    /// Anything else.
    #[default]
    Other,
}

/// A line, or the ring around an area.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MapLine {
    /// Its corners: longitude and latitude in degrees as read; plane metres once laid into a plane.
    pub points: Vec<DVec2>,
    /// Whether the last corner is joined to the first and the inside belongs to it.
    pub is_area: bool,
    /// What it is.
    pub kind: LineKind,
    /// Its name, empty when it has none.
    pub name: String,
}
