//! Triangulated irregular networks (TINs; Peucker, Fowler, Little, Mark, "The Triangulated Irregular Network", 1978): how
//! they come to be and how they are made coarser.
//!
//! `delaunay` makes a TIN of survey points and breaklines, `greedy` one of a height field, `mend` makes a bad one safe;
//! `collapse` makes one coarser, `levels` a chain of them, `vertical` tells how far two of one ground are apart in height,
//! and `lines` where breaklines run.

pub(crate) mod collapse;
mod delaunay;
mod greedy;
mod levels;
mod lines;
mod mend;
pub(crate) mod vertical;

pub use delaunay::{DelaunayOptions, Triangulated, triangulate};
pub use greedy::{GreedyOptions, GreedyTin, greedy};
pub use levels::{Level, LevelOptions, collapse_levels};
pub use lines::{LineEdges, line_edges};
pub use mend::{Fault, Mended, MendedTin, mend, t_junctions};
