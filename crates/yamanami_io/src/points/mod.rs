//! Survey points and breaklines, of which a TIN is made.
//!
//! | format | what is read | CRS and unit |
//! |---|---|---|
//! | text (`.csv`, `.txt`, `.xyz`, `.pts`): comma, semicolon, tab or spaces | x, y, z by the names of the header, else by place | as told |
//! | SIMA (`.sim`) | the points of its A01 records | as told, metres |
//! | LAS 1.0 to 1.4 and LAZ (`.las`, `.laz`) | ground (class 2), or all without noise where none is classed | from its keys or well-known text |
//! | GeoJSON (`.geojson`, `.json`) | lines and rings | as told; degrees are projected |
//! | text of lines | line, x, y, z: rows of one name are a line | as told |
//!
//! `.gz` and `.zst` around the text formats. Files are read forwards; only what is kept stays in memory. What comes out is in
//! metres, x east, y north, z up, and finite.

mod georef;
mod las;
mod laz_source;
mod lines;
pub(crate) mod source;
mod table;
mod text;

pub use lines::{LineReadOptions, ReadLines, is_lines_name, read_lines, read_lines_from_bytes};

use crate::{IoError, crs};
use glam::DVec3;
use source::Source;
use std::path::Path;
use yamanami_core::Crs;

/// Which of the two plan coordinates of a text comes first, where its header does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColumnOrder {
    /// x, y, z: east, north, height.
    #[default]
    EastNorth,
    /// x is north: survey coordinates of Japan, and "P, N, E, Z" lists.
    NorthEast,
}

/// What is asked of a file of points beside its path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointReadOptions {
    /// What the first coordinate of a text is.
    pub order: ColumnOrder,
    /// Classes to keep of a LAS file; else ground where there is any, else all but noise.
    pub classes: Option<Vec<u8>>,
    /// Metres in a unit of the coordinates, where the file does not say or is wrong.
    pub unit_m: Option<f64>,
    /// EPSG code of the coordinates, where the file does not say or is wrong.
    pub epsg: Option<u32>,
}

/// Points that were read, and what was not.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadPoints {
    /// The points in metres, in the CRS's own axes.
    pub points_m: Vec<DVec3>,
    /// Metres in a unit of the file's plan coordinates.
    pub unit_m: f64,
    /// The CRS of x and y; unknown where neither file nor caller says.
    pub crs: Crs,
    /// What was skipped or assumed: one line each.
    pub notes: Vec<String>,
}

/// Whether a path's name is that of a file of points.
pub fn is_points_name(path: impl AsRef<Path>) -> bool {
    source::has_ending(path.as_ref(), &["csv", "txt", "xyz", "pts", "sim", "las", "laz"])
}

/// Reads the points of a file in the format of the path's extension.
pub fn read_points(path: impl AsRef<Path>, options: &PointReadOptions) -> Result<ReadPoints, IoError> {
    read(Source::file(path.as_ref())?, options)
}

/// The same from memory; `name` gives the format and stands in messages.
pub fn read_points_from_bytes(
    name: impl AsRef<Path>,
    bytes: &[u8],
    options: &PointReadOptions,
) -> Result<ReadPoints, IoError> {
    read(Source::memory(name.as_ref(), bytes), options)
}

fn read(source: Source<'_>, options: &PointReadOptions) -> Result<ReadPoints, IoError> {
    let label = source.label().to_owned();
    check_unit(options.unit_m)?;
    let mut read = if source::has_ending(&label, &["las", "laz"]) {
        las::read(source, options)?
    } else {
        text::read(source, options)?
    };
    if let Some(epsg) = options.epsg {
        read.crs = known_crs(epsg)?;
    }
    if read.crs.geographic {
        let hint = "project them to a metric CRS first";
        return Err(IoError::unsupported(label, "points in longitude and latitude", hint));
    }
    if read.points_m.is_empty() {
        return Err(IoError::malformed(label, "whole file", "points", "none that can be kept"));
    }
    Ok(read)
}

fn check_unit(unit_m: Option<f64>) -> Result<(), IoError> {
    match unit_m {
        Some(unit_m) if !(unit_m.is_finite() && unit_m > 0.0) => Err(IoError::BadRequest {
            what: "metres in a unit".into(),
            expected: "a number above 0".into(),
            given: unit_m.to_string(),
        }),
        _ => Ok(()),
    }
}

fn known_crs(epsg: u32) -> Result<Crs, IoError> {
    crs::from_epsg(epsg).ok_or_else(|| IoError::BadRequest {
        what: "CRS".into(),
        expected: "the EPSG code of UTM, a plane rectangular zone or another known system".into(),
        given: epsg.to_string(),
    })
}
