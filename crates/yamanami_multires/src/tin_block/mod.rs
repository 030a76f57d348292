//! TINs in rectangular blocks and levels, as the paper has them: a comparison for the engine's own hierarchy.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS" (三次元GISのためのTINの高速描画法),
//! APA, 2005. [`centroid_chain`] makes the levels.

mod centroid;
mod net;

pub use centroid::{CostReading, centroid_chain};
