//! What all formats are read into: shapes with a few words about them.

use super::words::Words;
use glam::DVec3;
use yamanami_core::{Crs, LineKind};

/// The features of a file or of a table of it.
#[derive(Debug, Default)]
pub(super) struct Features {
    /// Name of the file or table, a hint at what it holds.
    pub(super) name: String,
    /// The CRS as stated.
    pub(super) crs: Option<Crs>,
    /// What all lines are, where the format says.
    pub(super) kind: Option<LineKind>,
    pub(super) features: Vec<Feature>,
    pub(super) notes: Vec<String>,
}

/// One feature.
#[derive(Debug, Default)]
pub(super) struct Feature {
    /// Where in the file, for messages.
    pub(super) place: String,
    pub(super) words: Words,
    pub(super) shape: Shape,
    /// What is wrong with the shape, if it could not be read.
    pub(super) fault: Option<String>,
}

/// Points and lines in the axes of the file, x or longitude first; z is NaN where there is none.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Shape {
    pub(crate) points: Vec<DVec3>,
    pub(crate) lines: Vec<Line>,
}

/// A line or ring.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Line {
    pub(crate) points: Vec<DVec3>,
    pub(crate) is_area: bool,
}
