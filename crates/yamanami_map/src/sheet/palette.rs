//! The few colours of a sheet: warm inks on warm paper, water, and one red.

use crate::scene::Colour;

/// Paper.
pub(crate) const PAPER: Colour = [247, 243, 234];
/// Names and lines.
pub(crate) const INK: Colour = [43, 39, 34];
/// Small type and what stands back.
pub(crate) const SOFT_INK: Colour = [104, 95, 84];
/// Hidden places.
pub(crate) const GREY: Colour = [150, 143, 133];
/// Edges around letters.
pub(crate) const HALO: Colour = [255, 252, 245];
/// Marks of summits and the north.
pub(crate) const RUST: Colour = [150, 58, 36];
/// Water's lines and what is written on it.
pub(crate) const WATER: Colour = [62, 116, 158];
/// Lakes.
pub(crate) const LAKE: Colour = [184, 211, 226];
/// Sides of roads.
pub(crate) const ROAD_SIDE: Colour = [132, 104, 74];
/// Roads.
pub(crate) const ROAD: Colour = [255, 246, 222];
/// Tracks.
pub(crate) const TRACK: Colour = [206, 44, 40];
