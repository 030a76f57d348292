//! quantized-mesh 1.0: tiles of terrain on the globe in longitude and latitude, and the `layer.json` of their pyramid.
//!
//! Based on: Cesium, "Quantized-mesh-1.0 terrain format", 2013 to 2024.

mod encode;
mod globe;
mod layer;

pub use encode::{MeshTile, encode};
pub use layer::Layer;

use crate::IoError;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;

/// Steps of a tile along each coordinate.
pub const GRID: u32 = 32767;

/// Degrees along the side of a tile of a zoom.
pub fn tile_deg(zoom: u32) -> f64 {
    180.0 / f64::from(1u32 << zoom)
}

/// West, south, east and north of a tile, degrees; rows count from the south.
pub fn tile_rectangle_deg(zoom: u32, x: u32, y: u32) -> [f64; 4] {
    let side = tile_deg(zoom);
    let [x, y] = [x, y].map(f64::from);
    [x * side - 180.0, y * side - 90.0, (x + 1.0) * side - 180.0, (y + 1.0) * side - 90.0]
}

/// A tile's path in the pyramid.
pub fn tile_path(zoom: u32, x: u32, y: u32) -> String {
    format!("{zoom}/{x}/{y}.terrain")
}

/// Packs a tile as servers hand it out. What the indices and the neighbouring vertices' differences hold is small already:
/// more effort finds little more.
const EFFORT: u32 = 6;

/// Packs a tile by gzip, as viewers expect it.
pub fn pack(tile: &[u8]) -> Result<Vec<u8>, IoError> {
    let mut packer = GzEncoder::new(Vec::with_capacity(tile.len() / 2), Compression::new(EFFORT));
    packer.write_all(tile).and_then(|()| packer.finish()).map_err(|e| IoError::io("tile", e))
}
