//! Deformed maps in a call each: the ground around a place, shown by a front that follows the map's own controls.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map".

mod base;
mod check;
mod image_over;
mod make;
mod names;
mod scene;

pub use base::{BaseOptions, draw_base};
pub use check::MapErrors;
pub use image_over::MapImage;
pub use make::{MadeMap, MapJob, MapMesh, lay_lines, lay_places, make_map};
pub use names::rank_by_prominence;
pub use scene::{DeformedScene, MapUpdate};
