//! The contracts of the core as functions: each panics with what was broken and where.
//!
//! A law is stated once here and run over every method; the laws themselves are stated with [`yamanami_core::Hierarchy`].

mod closure;
mod delta;
mod error;
mod hierarchy;
mod surface;

pub use closure::{closure_law, closure_law_of};
pub use delta::delta_law;
pub use error::{WorstError, ends_law, error_law, worst_vertical_error_m};
pub use hierarchy::hierarchy_law;
pub use surface::surface_law;

/// What a method's meshes are meant to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A height field that covers its domain: seen from above, counter-clockwise, one triangle deep.
    Terrain,
    /// A height field with no-data, whose border may change from front to front.
    TerrainWithHoles,
    /// A surface in space.
    Solid,
}
