//! How kinds of lines are drawn, as layers of strokes from the lowest.
//!
//! Railways are those of Japanese maps: black with white dashes in it.

use crate::scene::Colour;
use crate::sheet::{HALO, INK, ROAD, ROAD_SIDE, SOFT_INK, TRACK, WATER};
use yamanami_core::LineKind;

/// One stroke of a kind.
#[derive(Debug)]
pub(super) struct Layer {
    pub(super) colour: Colour,
    pub(super) width_pt: f64,
    pub(super) opacity: f64,
    pub(super) dash_pt: Option<[f64; 2]>,
}

const fn full(colour: Colour, width_pt: f64, opacity: f64) -> Layer {
    Layer { colour, width_pt, opacity, dash_pt: None }
}

const fn dashed(colour: Colour, width_pt: f64, dash_pt: [f64; 2]) -> Layer {
    Layer { colour, width_pt, opacity: 1.0, dash_pt: Some(dash_pt) }
}

static COAST: [Layer; 1] = [full(WATER, 0.6, 0.9)];
static RIVER: [Layer; 1] = [full(WATER, 0.7, 0.85)];
static LAKE: [Layer; 1] = [full(WATER, 0.45, 0.9)];
static ROADS: [Layer; 2] = [full(ROAD_SIDE, 1.7, 0.85), full(ROAD, 1.0, 1.0)];
static RAILWAY: [Layer; 2] = [full(INK, 1.5, 1.0), dashed(HALO, 0.8, [4.0, 4.0])];
static TRACKS: [Layer; 2] = [full(HALO, 3.2, 0.9), full(TRACK, 1.7, 1.0)];
static BORDER: [Layer; 1] = [dashed(SOFT_INK, 0.5, [3.5, 1.6])];
static OTHER: [Layer; 1] = [full(SOFT_INK, 0.6, 0.9)];

/// The strokes of a kind, lowest first.
pub(super) fn look_of(kind: LineKind) -> &'static [Layer] {
    match kind {
        LineKind::Coast => &COAST,
        LineKind::River => &RIVER,
        LineKind::Lake => &LAKE,
        LineKind::Road => &ROADS,
        LineKind::Railway => &RAILWAY,
        LineKind::Track => &TRACKS,
        LineKind::Border => &BORDER,
        _ => &OTHER,
    }
}
