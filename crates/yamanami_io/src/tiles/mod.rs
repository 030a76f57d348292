//! Tiles for other programs' viewers: where they are written, and their formats.

pub mod glb;
mod height_png;
mod output;
mod pmtiles;
pub mod quantized_mesh;
pub mod subtree;
mod three_tz;
pub mod tileset;

pub use height_png::encode_height_png;
pub use output::{TileFolder, TileOutput};
pub use pmtiles::{PmtilesArchive, PmtilesFacts, tile_number};
pub use three_tz::{INDEX_NAME, pack_3tz, read_3tz};
