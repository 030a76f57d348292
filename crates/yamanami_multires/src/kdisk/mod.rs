//! k-disk wavelets on semi-regular meshes, by lifting.
//!
//! Based on: Date, Kanai, Kishinami (multiresolution approximation of polygon models by k-disk wavelets); Lounsbery, DeRose,
//! Warren, "Multiresolution analysis for surfaces of arbitrary topological type", 1997 (hat functions, the triangles of a level taken as
//! equal in area); Sweldens, "The lifting scheme", 1996.
//!
//! One level of analysis: a detail is what a new vertex lies off the middle of its parents; then the coarse vertices within k edges
//! of the parents each take a share `s` of it, so that the wavelet is orthogonal to their hat functions. Synthesis takes the same
//! steps back. The `lazy` wavelet has no shares; for `orthogonal` all coarse vertices have, found by solving.
//!
//! What makes lifting fast: a level is worked on in rows of its lattice (`cells.rs`), in which nearly all disks are alike, and the shares of
//! all details around a coarse vertex are gathered at once (`regular.rs`). Around base vertices of a kind the disks are those of a
//! wheel (`wheel.rs`); only at borders and at the coarsest levels has each detail a disk of its own (`rim.rs`). The filters know nothing of
//! this, and are what it is tested against.

mod cells;
mod disk;
mod filters;
mod lifting;
mod orthogonal;
mod predict;
mod products;
mod regular;
mod rim;
mod stencil;
mod sums;
mod threshold;
mod update;
mod wheel;

pub use filters::{Filters, Sparse, filters};
pub use lifting::{Lifting, MOST_RINGS, Wavelet};
pub use products::{l2_norm, largest_cosine};
pub use threshold::keep_largest;
