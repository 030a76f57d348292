//! Breaklines: lines of GeoJSON, and tables of text whose rows of one name are a line.

use super::source::{Source, has_ending};
use super::table::{Columns, number};
use super::text::{Layout, Skipped, strip_comment};
use super::{ColumnOrder, check_unit};
use crate::geodata::{Shape, geojson};
use crate::{IoError, crs};
use glam::DVec3;
use serde_json::Value;
use std::path::Path;
use yamanami_core::{Breakline, BreaklineKind, Crs};

/// GeoJSON is read whole.
const MOST_GEOJSON_BYTES: u64 = 1 << 30;

/// What is asked of a file of lines beside its path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LineReadOptions {
    /// What the first coordinate of a text is.
    pub order: ColumnOrder,
    /// Metres in a unit of the coordinates, 1 where it is not said. Not for longitudes and latitudes.
    pub unit_m: Option<f64>,
    /// The CRS of the points: longitudes and latitudes are projected into it.
    pub crs: Crs,
    /// How strictly lines hold whose file does not say.
    pub kind: BreaklineKind,
}

/// Lines that were read, and what was not.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadLines {
    /// The lines in metres. Where a file has no height, z is NaN.
    pub lines: Vec<Breakline>,
    /// What was skipped or assumed: one line each.
    pub notes: Vec<String>,
}

/// Whether a path's name is that of a file of lines.
pub fn is_lines_name(path: impl AsRef<Path>) -> bool {
    has_ending(path.as_ref(), &["geojson", "json", "csv", "txt"])
}

/// Reads the lines of a file in the format of the path's extension.
pub fn read_lines(path: impl AsRef<Path>, options: &LineReadOptions) -> Result<ReadLines, IoError> {
    read(Source::file(path.as_ref())?, options)
}

/// The same from memory; `name` gives the format and stands in messages.
pub fn read_lines_from_bytes(
    name: impl AsRef<Path>,
    bytes: &[u8],
    options: &LineReadOptions,
) -> Result<ReadLines, IoError> {
    read(Source::memory(name.as_ref(), bytes), options)
}

fn read(source: Source<'_>, options: &LineReadOptions) -> Result<ReadLines, IoError> {
    check_unit(options.unit_m)?;
    let label = source.label().to_owned();
    let is_geojson = has_ending(&label, &["geojson", "json"]);
    let mut read = if is_geojson { read_geojson(source, options)? } else { read_table(source, options)? };
    let before = read.lines.len();
    read.lines.retain(|line| line.points.len() > 1);
    if read.lines.len() < before {
        read.notes.push(format!("{} lines of a single point dropped", before - read.lines.len()));
    }
    if read.lines.is_empty() {
        return Err(IoError::malformed(label, "whole file", "lines", "none that can be kept"));
    }
    Ok(read)
}

fn read_table(source: Source<'_>, options: &LineReadOptions) -> Result<ReadLines, IoError> {
    let unit_m = options.unit_m.unwrap_or(1.0);
    let mut text = source.into_text()?;
    let mut read = ReadLines::default();
    let mut skipped = Skipped::default();
    let by_place = |fields: &[&[u8]]| {
        let are_numbers = fields.len() >= 4 && fields[1..4].iter().all(|f| number(f).is_some());
        are_numbers.then(|| Columns::ordered(1, 2, 3, Some(0), options.order))
    };
    let layout = Layout::read(&mut text, options.order, &mut read.notes, by_place)?;
    let mut take = |row: usize, line: &[u8]| {
        let fields = layout.delimiter.split(line);
        match layout.place(&fields) {
            Some(place) => {
                let name = fields.get(layout.columns.name.unwrap_or(0)).copied().unwrap_or_default();
                let name = String::from_utf8_lossy(name);
                if read.lines.last().is_none_or(|line| line.name != name) {
                    let points = Vec::new();
                    read.lines.push(Breakline { name: name.into_owned(), kind: options.kind, points });
                }
                if let Some(line) = read.lines.last_mut() {
                    line.points.push(DVec3::from(place) * unit_m);
                }
            }
            None if strip_comment(line).is_some() => {}
            None => skipped.add(row, line),
        }
    };
    if let Some((row, line)) = &layout.first {
        take(*row, line);
    }
    while let Some((row, line)) = text.next_line()? {
        take(row, line);
    }
    skipped.note("lines without three numbers", &mut read.notes);
    Ok(read)
}

fn read_geojson(source: Source<'_>, options: &LineReadOptions) -> Result<ReadLines, IoError> {
    let label = source.label().to_owned();
    let bytes = source.into_text()?.into_bytes(MOST_GEOJSON_BYTES)?;
    let root = geojson::parse(&label, &bytes)?;
    let places = Places {
        options,
        label: &label,
        stated: geojson::stated_crs(&root).filter(|stated| stated.epsg.and_then(crs::from_epsg).is_some()),
    };
    let (mut read, mut skipped, mut failed) = (ReadLines::default(), 0, None);
    geojson::for_each(&root, &mut |properties, geometry| {
        let word = |key: &str| properties.get(key).and_then(Value::as_str);
        let kind = match word("kind") {
            Some("hard") => BreaklineKind::Hard,
            Some("soft") => BreaklineKind::Soft,
            Some("boundary") => BreaklineKind::Boundary,
            _ => options.kind,
        };
        let name = word("name").or_else(|| word("id")).unwrap_or_default();
        let mut shape = Shape::default();
        skipped += geojson::add_geometry(geometry, &mut shape) + shape.points.len();
        for line in shape.lines {
            match line.points.into_iter().map(|p| places.place(p.x, p.y, p.z)).collect() {
                Ok(points) => read.lines.push(Breakline { name: name.to_owned(), kind, points }),
                Err(error) => failed = failed.take().or(Some(error)),
            }
        }
    });
    if let Some(error) = failed {
        return Err(error);
    }
    if skipped > 0 {
        read.notes.push(format!("{skipped} geometries that are no lines, or whose places are none, skipped"));
    }
    Ok(read)
}

struct Places<'a> {
    options: &'a LineReadOptions,
    label: &'a Path,
    stated: Option<Crs>,
}

impl Places<'_> {
    /// A place in metres in the CRS of the points.
    fn place(&self, x: f64, y: f64, z: f64) -> Result<DVec3, IoError> {
        let wanted = &self.options.crs;
        let is_known = crs::to_lon_lat(wanted, 0.0, 0.0).is_some() && !wanted.geographic;
        let as_it_is = DVec3::new(x, y, z) * self.options.unit_m.unwrap_or(1.0);
        let lon_lat = match &self.stated {
            Some(stated) if stated.epsg == wanted.epsg || !is_known && !stated.geographic => return Ok(as_it_is),
            Some(stated) => crs::to_lon_lat(stated, x, y),
            // without a CRS, what can be degrees is, as the format wants it
            None if is_known && x.abs() <= 180.0 && y.abs() <= 90.0 => Some([x, y]),
            None => return Ok(as_it_is),
        };
        let projected = lon_lat.and_then(|[lon, lat]| crs::from_lon_lat(wanted, lon, lat));
        match projected {
            Some([east, north]) => Ok(DVec3::new(east, north, z)),
            None => {
                let what = format!("the place {x}, {y} in the CRS of the points");
                Err(IoError::unsupported(self.label, what, "give lines in the CRS of the points, or state that"))
            }
        }
    }
}
