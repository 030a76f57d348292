//! The terrain quadtree: two right triangles a base square, each split at its edge midpoints into four, again and again.
//!
//! Based on: Hashida, Kanai, Kishinami (wavelet and quadtree LOD of large terrain); Lounsbery, DeRose, Warren,
//! "Multiresolution analysis for surfaces of arbitrary topological type", 1997; red–green closure after Bank, Sherman,
//! Weiser, "Refinement algorithms and data structures for regular local mesh refinement", 1983.
//!
//! A node is an edge midpoint. It may be applied when all midpoints of the parent triangles at its edge are, so that a
//! triangle of the quadtree is drawn whole, or by a template of two or three triangles, or by its four children; the mesh
//! is a function of the applied set and has no T-vertex.

mod build;
mod data;
mod errors;
mod holes;
mod lazy;
mod nodes;
mod order;
mod pages;
mod surface;
mod template;
mod triangle;

pub(crate) use errors::charge_three;
pub(crate) use template::{ALL, Config, TEMPLATES};
#[cfg(test)]
pub(crate) use triangle::adjacent;
pub(crate) use triangle::{Triangle, doubled_area};

pub use build::{BuildOptions, build};
pub use data::{GridData, TerrainData};
pub use lazy::{analyse, synthesise};
pub use nodes::NodeNumbers;
pub use pages::PagedData;
pub use surface::TerrainSurface;
