//! Tiles for other programs' viewers: where they are written, and their formats.

mod output;
pub mod subtree;
pub mod tileset;

pub use output::{TileFolder, TileOutput};
