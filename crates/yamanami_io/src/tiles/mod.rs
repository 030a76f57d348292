//! Tiles for other programs' viewers: where they are written, and their formats.

pub mod glb;
mod output;
pub mod quantized_mesh;
pub mod subtree;
mod three_tz;
pub mod tileset;

pub use output::{TileFolder, TileOutput};
pub use three_tz::{INDEX_NAME, pack_3tz, read_3tz};
