//! Triangulated irregular networks (TINs; Peucker, Fowler, Little, Mark, "The Triangulated Irregular Network", 1978): how
//! they come to be and how they are made coarser.
//!
//! `delaunay` makes a TIN of survey points and breaklines, `greedy` one of a height field, `mend` makes a bad one safe.

mod delaunay;
mod greedy;
mod mend;

pub use delaunay::{DelaunayOptions, Triangulated, triangulate};
pub use greedy::{GreedyOptions, GreedyTin, greedy};
pub use mend::{Fault, Mended, MendedTin, mend};
