//! Semi-regular meshes of any base mesh: found in plain meshes, and shown as a surface of which any front can be drawn.
//!
//! Based on: Lounsbery, DeRose, Warren, "Multiresolution analysis for surfaces of arbitrary topological type", 1997.

mod merge;
mod recognise;

pub use recognise::{Recognised, recognise};
