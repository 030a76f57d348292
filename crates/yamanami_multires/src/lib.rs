//! Builders of multiresolution surfaces.
//!
//! [`wavelet`] holds the terrain quadtree: a height field of any size as a 4-to-1 triangle quadtree with the lazy
//! wavelet, its guaranteed vertical errors, and the surface that emits any parent-closed front of it. [`collapse`] reduces
//! meshes, [`cluster`] makes the hierarchy of a scan, [`bound`] certifies distances between meshes, [`clean`] mends scans.
//! [`semi_regular`] finds 4-to-1 splits in plain meshes and shows any front of them, [`remesh`] makes scans so, and [`kdisk`]
//! holds the wavelets on them. [`tiles`] cuts terrains into tiles. [`rtin`] is the hierarchy of deformed maps: right triangles over nested grids. [`tin`] makes TINs of points and height fields, [`tin_block`] cuts them into blocks and levels. This
//! crate never sees a view, a frame, a file or a GPU.

pub mod bound;
pub mod clean;
pub mod cluster;
pub mod collapse;
mod error;
pub mod kdisk;
pub mod progressive;
pub mod remesh;
pub mod rtin;
pub mod semi_regular;
pub mod tiles;
pub mod tin;
pub mod tin_block;

pub mod wavelet;

pub use error::MultiresError;
