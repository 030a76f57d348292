//! Right triangles split at their longest edge, again and again, over nested grids: the hierarchy of deformed maps.
//!
//! Based on: Lindstrom, Koller, Ribarsky, Hodges, Faust, Turner, "Real-time, continuous level of detail rendering of
//! height fields", 1996; Evans, Kirkpatrick, Townsend, "Right-triangulated irregular networks", 2001 (the mesh); Duchaineau
//! et al., "ROAMing terrain", 1997 (diamonds); Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area
//! deformed map" (longest edges along the radius). Where we differ: errors are guaranteed bounds for all samples, in
//! metres and in pixels of the map; the grids may be nested, finer ones near the centre; and summits keep longer.
//!
//! A node is the middle of a longest edge with its *diamond*: the two triangles at that edge (one at the border), each
//! split in two when the node is applied. The right-angled corners of the two are the node's parents. Eight base triangles
//! meet at the centre with their longest edges along the diagonals.
//!
//! A grid gives two levels of nodes: cell centres, and middles of cell sides. They exist where the grid does, so that
//! every sample is a vertex but those on the outermost ring of a finer grid: there the coarser grid's straight lines are the
//! ground. (Where a finer grid reaches as far as the coarser one, its outermost three rings may be so.) The widest grid
//! is surrounded by just as many made-up vertices, at the height of the nearest sample, as its outermost triangles need.
//!
//! [`band_mesh`] is the paper's own mesh, by bands of distance.

pub mod band_mesh;
mod build;
mod diamonds;
mod errors;
mod ground;
mod samples;
mod summits;
mod surface;
mod triangle;

pub use build::{BuildOptions, Rtin, SummitRule};
pub use samples::FrontPlace;
pub use summits::{Summit, summits};
