//! Cutting a terrain into tiles of any zoom whose borders are the same lines on both sides, whatever the zooms.
//!
//! Tile space is a plane with a quadtree: at zoom z, tile (x, y) is the square from (x, y) to (x + 1, y + 1), in units of
//! 2⁻ᶻ, x eastwards, y northwards. A [`Placement`] says where the samples of the terrain lie in it.
//!
//! A tile is a front of the [terrain quadtree](crate::wavelet) within the tolerance of its zoom, in which all that touches
//! a border line of the zoom is as fine as in the finest zoom. As errors are saturated, the triangles at a line are then the
//! same in all zooms, and so is the line that they draw on it; its vertices stand on a lattice that all zooms share. There is no
//! skirt. How this came about is in `docs/decisions/0019`.

mod apron;
mod border;
mod clip;
mod cut;
mod fill;
mod locate;
mod measure;
mod piece;
mod placement;
mod plan;
mod sheet;
mod table;
mod walk;

pub use cut::{Absent, CutScratch, Cutter};
pub use piece::{GRID, Tile, TilePiece};
pub use placement::Placement;
pub use plan::CutOptions;
