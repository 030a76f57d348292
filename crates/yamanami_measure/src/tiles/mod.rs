//! Measures of tiles: what lies between neighbours, how tiles lie on the ground, how far they are from their source.
//!
//! Tiles come as plain positions and triangles, however they are stored; who made them is not known here.

pub mod earth;
mod edge;
mod plan;
mod profile;
mod shift;

pub use edge::{OpenEdges, SeamGap};
pub use plan::{PlanFaults, plan_faults};
pub use profile::{Gap, Profile};
pub use shift::Shift;
