//! File formats in and out, and the surface database.
//!
//! [`dem`] reads elevation grids, [`mesh_file`] reads and writes meshes, [`tin_file`] TINs, [`points`] reads survey points and breaklines, [`geodata`] named places and lines for maps, [`store`] is the surface database, [`pack`] the same as one file read by ranges,
//! [`progressive`] the file of a semi-regular model of which any prefix is one; [`tiles`] writes tile trees, [`inspect`] reads those of others to judge them; [`crs`] knows coordinate reference systems by EPSG code.
//!
//! Without the feature `files` only [`crs`], the codecs of [`store`] and the layout of [`pack`] are built, which need no file: for browsers.

pub mod crs;
#[cfg(feature = "files")]
pub mod dem;
mod error;
#[cfg(feature = "files")]
pub mod geodata;
#[cfg(feature = "files")]
pub mod inspect;
#[cfg(feature = "files")]
pub mod mesh_file;
pub mod pack;
#[cfg(feature = "files")]
pub mod points;
#[cfg(feature = "files")]
pub mod progressive;
#[cfg(feature = "files")]
pub mod scratch;
pub mod store;
#[cfg(feature = "files")]
pub mod tiles;
#[cfg(feature = "files")]
pub mod tin_file;

pub use error::IoError;
