//! Tiles for other programs' viewers: where they are written, and their formats.

mod height_png;
mod output;

pub use height_png::encode_height_png;
pub use output::{TileFolder, TileOutput};
