//! Deformed maps in a call each: the ground around a place, shown by a front that follows the map's own controls.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map".

mod base;
#[cfg(feature = "files")]
mod check;
#[cfg(feature = "files")]
mod image_over;
#[cfg(feature = "files")]
mod make;
#[cfg(feature = "files")]
mod names;
mod scene;

pub use base::{BaseOptions, draw_base};
#[cfg(feature = "files")]
pub use check::MapErrors;
#[cfg(feature = "files")]
pub use image_over::MapImage;
#[cfg(feature = "files")]
pub use make::{MadeMap, MapJob, MapMesh, lay_lines, lay_places, make_map};
#[cfg(feature = "files")]
pub use names::rank_by_prominence;
pub use scene::{DeformedScene, MapUpdate};
