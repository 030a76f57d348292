//! Tiles for other programs' viewers: where they are written, and their formats.

mod output;

pub use output::{TileFolder, TileOutput};
