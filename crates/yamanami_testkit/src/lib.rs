//! What tests of every crate share: synthetic terrain, and the laws every method obeys, as functions.
//!
//! [`SyntheticTerrain`] makes height fields of any size, whole or by windows. [`laws`] holds the contracts of
//! [`yamanami_core::Hierarchy`] and [`yamanami_core::Surface`] as checks that panic with what was broken and where, so
//! that a law is written once and run over every method. [`RandomFront`] wanders through the legal fronts of a hierarchy.
//! [`models`] makes small closed and open surfaces, [`carved`] balls; [`Pagoda`] is a made laser scan of a building, up to 20 million triangles,
//! [`Survey`] the points and breaklines of a terrain with a road and a river.
#![forbid(unsafe_code)]

mod carved;
mod conforming;
mod fractal;
mod front;
mod holes;
pub mod laws;
pub mod models;
mod nested;
mod pagoda;
pub mod rng;
mod solid;
mod strict_sink;
mod survey;
mod terrain;

pub use carved::{Relief, carved};
pub use conforming::check_conforming;
pub use front::{RandomFront, Step};
pub use holes::Holes;
pub use nested::{nested_ground, random_map_view};
pub use pagoda::{Pagoda, Region};
pub use rng::Rng;
pub use solid::{ball, ring, torus};
pub use strict_sink::StrictSink;
pub use survey::Survey;
pub use terrain::{Shape, Spacing, SyntheticTerrain};
