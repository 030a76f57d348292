//! The four sides of a tile and the lattices that vertices stand on there.
//!
//! The vertices on a line stand on the lattice of the coarsest zoom that has the line, so that all zooms can say where they
//! are: step k of a tile is step 2k of its child. The corners of finer tiles lie between two steps, as 32767 is odd; both
//! steps are vertices, of the corner's height, so that the corner lies on the edge between them.

use super::piece::{GRID, Tile};
use super::plan::Plan;

/// A side's number: as quantized-mesh lists them.
pub(super) const WEST: usize = 0;
pub(super) const SOUTH: usize = 1;
pub(super) const EAST: usize = 2;
pub(super) const NORTH: usize = 3;

/// One side of a tile.
#[derive(Debug, Clone)]
pub(super) struct Side {
    /// The coordinate that is the same all along: x in the west and east, y in the south and north.
    pub(super) axis: usize,
    /// Its value in tile space.
    pub(super) at: f64,
    /// The tile's zoom, and its index along the side.
    zoom: u32,
    index: i64,
    /// Zooms of the lattice of the vertices and of the corners among them.
    lattice: u32,
    corners: u32,
    /// Steps of the tile's own lattice strictly within the side that are vertices wherever there is ground.
    pub(super) forced: Vec<u16>,
}

const LAST: i64 = GRID as i64;

impl Side {
    pub(super) fn all(tile: Tile, plan: &Plan) -> [Self; 4] {
        [WEST, SOUTH, EAST, NORTH].map(|side| Self::new(tile, side, plan))
    }

    fn new(tile: Tile, side: usize, plan: &Plan) -> Self {
        let (axis, far) = (side % 2, u32::from(side >= EAST));
        let [line, index] = if axis == 0 { [tile.x + far, tile.y] } else { [tile.y + far, tile.x] };
        let mut out = Self {
            axis,
            at: f64::from(line) / f64::from(1u32 << tile.zoom),
            zoom: tile.zoom,
            index: i64::from(index),
            lattice: plan.lattice_zoom(tile.zoom, line),
            corners: plan.corner_zoom(tile.zoom),
            forced: Vec::new(),
        };
        let (depth, fine) = (out.corners - tile.zoom, out.corners - out.lattice);
        let corners = (out.index << depth)..=((out.index + 1) << depth);
        let steps = corners.flat_map(|j| [(j * LAST) >> fine, (j * LAST + (1 << fine) - 1) >> fine]);
        out.forced = steps.map(|step| out.local(step)).filter(|k| (1..LAST).contains(k)).map(|k| k as u16).collect();
        out.forced.dedup();
        out
    }

    /// How many of the tile's own steps a step of the lattice is.
    pub(super) fn stride(&self) -> u32 {
        1 << (self.zoom - self.lattice)
    }

    fn local(&self, step: i64) -> i64 {
        (step << (self.zoom - self.lattice)) - self.index * LAST
    }

    /// The tile's own step nearest to a coordinate along the side, of those on the side's lattice; past the ends too.
    pub(super) fn nearest(&self, along: f64) -> i64 {
        self.local((along * f64::from(1u32 << self.lattice) * f64::from(GRID)).round() as i64)
    }

    /// The vertex for a place on the side.
    pub(super) fn snap(&self, along: f64) -> u16 {
        // a corner may lie between two steps
        match along * f64::from(1u32 << self.zoom) - self.index as f64 {
            part if part <= 0.0 => 0,
            part if part >= 1.0 => GRID as u16,
            _ => self.nearest(along).clamp(0, LAST) as u16,
        }
    }

    /// Tile space of the place whose height a vertex of the side has.
    pub(super) fn place(&self, step: u16) -> [f64; 2] {
        let own = i64::from(step);
        let along = if own == 0 || own == LAST {
            (self.index + own / LAST) as f64 / f64::from(1u32 << self.zoom)
        } else {
            let (step, fine) = ((own + self.index * LAST) >> (self.zoom - self.lattice), self.corners - self.lattice);
            let corner = ((step << fine) + LAST / 2).div_euclid(LAST);
            if ((step << fine) - corner * LAST).abs() < 1 << fine {
                corner as f64 / f64::from(1u32 << self.corners)
            } else {
                step as f64 / (f64::from(1u32 << self.lattice) * f64::from(GRID))
            }
        };
        if self.axis == 0 { [self.at, along] } else { [along, self.at] }
    }
}
