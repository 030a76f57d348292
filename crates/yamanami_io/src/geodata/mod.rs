//! Named places and lines for maps.
//!
//! | format | places | lines |
//! |---|---|---|
//! | CSV (`.csv`, `.tsv`, `.txt`) | rows with a latitude and a longitude, or points as well-known text | well-known text |
//! | GeoJSON (`.geojson`, `.json`) | points | lines and the rings of areas |
//! | GeoPackage (`.gpkg`) | points of all its tables | lines and rings of all its tables |
//! | Shapefile (`.shp` with its `.dbf`, `.prj`, `.cpg`) | points | lines and rings |
//! | GPX (`.gpx`) | waypoints | tracks and routes |
//!
//! `.gz` and `.zst` around the text formats. What comes out is in longitudes and latitudes, degrees; other systems are
//! converted where they are known by formula. What has no usable place is counted and told, not fatal.

mod csv;
mod dbf;
mod degrees;
mod feature;
pub(crate) mod geojson;
mod geopackage;
mod gpx;
mod kinds;
mod locate;
mod shapefile;
mod wkb;
mod wkt;
mod words;

use crate::IoError;
use crate::points::source::{Source, has_ending};
pub(crate) use feature::Shape;
use feature::{Feature, Features};
use locate::Locator;
use std::path::Path;
use words::{Word, number};
use yamanami_core::{Crs, LineKind, MapLine, NamedPlace, PlaceKind};

/// Text formats are read whole.
const MOST_BYTES: u64 = 1 << 30;
/// Wider than any name.
const MOST_NAME_CHARS: usize = 200;

/// What is asked of a file of places beside its path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlaceReadOptions {
    /// What all places are; else guessed from each.
    pub kind: Option<PlaceKind>,
    /// The CRS of the coordinates, where the file does not say or is wrong.
    pub crs: Option<Crs>,
}

/// What is asked of a file of lines beside its path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LineReadOptions {
    /// What all lines are; else guessed from each, and from the names of tables and files.
    pub kind: Option<LineKind>,
    /// The CRS of the coordinates, where the file does not say or is wrong.
    pub crs: Option<Crs>,
}

/// Places that were read, and what was not.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadPlaces {
    /// The places, in longitude and latitude.
    pub places: Vec<NamedPlace>,
    /// What was skipped or assumed: one line each.
    pub notes: Vec<String>,
}

/// Lines that were read, and what was not.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadLines {
    /// The lines, in longitude and latitude. Each ring of an area is one, holes too: filled together, by the even-odd
    /// rule, they are the area.
    pub lines: Vec<MapLine>,
    /// What was skipped or assumed: one line each.
    pub notes: Vec<String>,
}

/// Whether a path's name is that of a file that may hold places or lines.
pub fn is_geodata_name(path: impl AsRef<Path>) -> bool {
    has_ending(path.as_ref(), &["csv", "tsv", "txt", "geojson", "json", "gpkg", "shp", "gpx"])
}

/// Reads the named places of a file in the format of the path's extension.
pub fn read_places(path: impl AsRef<Path>, options: &PlaceReadOptions) -> Result<ReadPlaces, IoError> {
    places(path.as_ref(), features_of(path.as_ref())?, options)
}

/// The same from memory; `name` gives the format and stands in messages. Not of a GeoPackage.
pub fn read_places_from_bytes(
    name: impl AsRef<Path>,
    bytes: &[u8],
    options: &PlaceReadOptions,
) -> Result<ReadPlaces, IoError> {
    places(name.as_ref(), features_in(Source::memory(name.as_ref(), bytes))?, options)
}

/// Reads the lines of a file in the format of the path's extension.
pub fn read_lines(path: impl AsRef<Path>, options: &LineReadOptions) -> Result<ReadLines, IoError> {
    lines(path.as_ref(), features_of(path.as_ref())?, options)
}

/// The same from memory; `name` gives the format and stands in messages. Not of a GeoPackage.
pub fn read_lines_from_bytes(
    name: impl AsRef<Path>,
    bytes: &[u8],
    options: &LineReadOptions,
) -> Result<ReadLines, IoError> {
    lines(name.as_ref(), features_in(Source::memory(name.as_ref(), bytes))?, options)
}

fn features_of(path: &Path) -> Result<Vec<Features>, IoError> {
    if has_ending(path, &["gpkg"]) {
        return geopackage::read(path);
    }
    let mut all = features_in(Source::file(path)?)?;
    if has_ending(path, &["shp"]) {
        shapefile::add_companions(path, &mut all)?;
    }
    Ok(all)
}

fn features_in(source: Source<'_>) -> Result<Vec<Features>, IoError> {
    let label = source.label().to_owned();
    let is = |endings: &[&str]| has_ending(&label, endings);
    let read = match () {
        () if is(&["geojson", "json"]) => geojson::read,
        () if is(&["csv", "tsv", "txt"]) => csv::read,
        () if is(&["shp"]) => shapefile::read,
        () if is(&["gpx"]) => gpx::read,
        () => {
            let hint = "give .csv, .geojson, .gpkg, .shp or .gpx";
            return Err(IoError::unsupported(label, "by its ending no file of places or lines", hint));
        }
    };
    let bytes = source.into_text()?.into_bytes(MOST_BYTES)?;
    Ok(vec![read(&label, &bytes)?])
}

/// What could not be placed: how many, the first one, and why.
#[derive(Default)]
struct Misplaced {
    count: usize,
    first: Option<(String, String)>,
}

impl Misplaced {
    fn add(&mut self, feature: &Feature, why: String) {
        self.count += 1;
        self.first.get_or_insert_with(|| (feature.place.clone(), why));
    }

    /// A note on them, or an error when there is nothing else.
    fn told(self, label: &Path, what: &str, kept: usize, notes: &mut Vec<String>) -> Result<(), IoError> {
        let first = self.first.map(|(place, why)| (self.count, place, why));
        match first {
            Some((_, place, why)) if kept == 0 => Err(IoError::malformed(label, place, what, why)),
            None if kept == 0 => {
                let found = notes.last().map_or("none", String::as_str);
                Err(IoError::malformed(label, "whole file", what, found))
            }
            Some((count, place, why)) => {
                notes.push(format!("{count} without usable coordinates skipped, the first at {place}: {why}"));
                Ok(())
            }
            None => Ok(()),
        }
    }
}

fn places(label: &Path, all: Vec<Features>, options: &PlaceReadOptions) -> Result<ReadPlaces, IoError> {
    let mut read = ReadPlaces::default();
    let (mut misplaced, mut nameless) = (Misplaced::default(), 0);
    for features in all {
        read.notes.extend(features.notes);
        let locator = Locator::new(label, options.crs.as_ref().or(features.crs.as_ref()))?;
        for feature in &features.features {
            let words = &feature.words;
            if feature.shape.points.is_empty() && !feature.shape.lines.is_empty() {
                continue;
            }
            let Some(name) = words.get(Word::Name) else {
                nameless += 1;
                continue;
            };
            // many points under one name are one place
            let Some(&point) = feature.shape.points.first() else {
                misplaced.add(feature, feature.fault.clone().unwrap_or_else(|| "no coordinates".to_owned()));
                continue;
            };
            let position = match locator.lon_lat(point.truncate()) {
                Ok(position) => position,
                Err(why) => {
                    misplaced.add(feature, why);
                    continue;
                }
            };
            let stated = words.get(Word::Height).and_then(number);
            read.places.push(NamedPlace {
                name: name.chars().take(MOST_NAME_CHARS).collect(),
                reading: words.get(Word::Reading).map(str::to_owned),
                latin: words.get(Word::Latin).map(str::to_owned),
                position,
                height_m: stated.or_else(|| Some(point.z).filter(|z| z.is_finite())),
                kind: options.kind.unwrap_or_else(|| kinds::of_place(words, name)),
                rank: words.get(Word::Rank).and_then(number),
            });
        }
    }
    if nameless > 0 {
        read.notes.push(format!("{nameless} without a name skipped"));
    }
    misplaced.told(label, "named places with coordinates", read.places.len(), &mut read.notes)?;
    Ok(read)
}

fn lines(label: &Path, all: Vec<Features>, options: &LineReadOptions) -> Result<ReadLines, IoError> {
    let mut read = ReadLines::default();
    let (mut misplaced, mut short) = (Misplaced::default(), 0);
    for features in all {
        read.notes.extend(features.notes);
        let locator = Locator::new(label, options.crs.as_ref().or(features.crs.as_ref()))?;
        for feature in &features.features {
            let name = feature.words.get(Word::Name).unwrap_or_default();
            let kind = options.kind.or(features.kind).unwrap_or_else(|| kinds::of_line(&feature.words, &features.name));
            if let Some(fault) = &feature.fault {
                misplaced.add(feature, fault.clone());
            }
            for line in &feature.shape.lines {
                let points: Result<Vec<_>, String> =
                    line.points.iter().map(|p| locator.lon_lat(p.truncate())).collect();
                match points {
                    Ok(mut points) => {
                        if line.is_area && points.len() > 1 && points.first() == points.last() {
                            points.pop();
                        }
                        if points.len() < if line.is_area { 3 } else { 2 } {
                            short += 1;
                            continue;
                        }
                        let name = name.chars().take(MOST_NAME_CHARS).collect();
                        read.lines.push(MapLine { points, is_area: line.is_area, kind, name });
                    }
                    Err(why) => misplaced.add(feature, why),
                }
            }
        }
    }
    if short > 0 {
        read.notes.push(format!("{short} lines of too few points skipped"));
    }
    misplaced.told(label, "lines", read.lines.len(), &mut read.notes)?;
    Ok(read)
}
