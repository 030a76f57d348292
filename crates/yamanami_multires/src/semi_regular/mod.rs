//! Semi-regular meshes of any base mesh: found in plain meshes, and shown as a surface of which any front can be drawn.
//!
//! Based on: Lounsbery, DeRose, Warren, "Multiresolution analysis for surfaces of arbitrary topological type", 1997.

mod errors;
mod front;
mod merge;
mod normals;
mod recognise;
mod surface;
mod triangle;

pub use front::{Thresholded, close, thresholded};
pub use recognise::{Recognised, recognise};
pub(crate) use recognise::{not_a_surface, renumbered};
pub use surface::SemiRegularSurface;
