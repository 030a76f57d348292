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

/// A number spread over 64 bits, so that sums and differences of such cancel out only where the numbers do.
pub(crate) fn mixed(v: u32) -> u64 {
    let x = (u64::from(v) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (x ^ x >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9)
}
