//! TINs in rectangular blocks and levels, as the paper has them: a comparison for the engine's own hierarchy.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS" (三次元GISのためのTINの高速描画法),
//! APA, 2005. [`centroid_chain`] makes the levels, [`cut`] splits one along the lines of a [`BlockGrid`], [`TinBlocks`] holds
//! all of them with their seams and the links from vertices to triangles. What of it a view shows is not decided here.

mod blocks;
mod centroid;
mod cut;
mod grid;
mod links;
mod net;
mod picks;
mod rim;
mod seams;
#[cfg(test)]
mod tests;

pub use blocks::{MOST_LEVELS, TinBlocks};
pub use centroid::{CostReading, centroid_chain};
pub use cut::{CutTin, cut};
pub use grid::{BlockGrid, MOST_BLOCKS};
pub use rim::Joined;
