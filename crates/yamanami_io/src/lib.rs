//! File formats in and out, and the surface database.
//!
//! [`dem`] reads elevation grids, [`mesh_file`] reads and writes meshes, [`tin_file`] TINs, [`points`] reads survey points and breaklines, [`geodata`] named places and lines for maps, [`store`] is the surface database,
//! [`inspect`] reads the tiles of others to judge them, [`progressive`] the file of a semi-regular model of which any prefix is one; [`crs`] knows coordinate reference systems by EPSG code.

pub mod crs;
pub mod dem;
mod error;
pub mod geodata;
pub mod inspect;
pub mod mesh_file;
pub mod points;
pub mod progressive;
pub mod scratch;
pub mod store;
pub mod tin_file;

pub use error::IoError;
