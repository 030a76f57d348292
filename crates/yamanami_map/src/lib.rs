//! Making maps of ground that is already there: how it is coloured and shaded, what hides what, and the sheet around it
//! with names, lines, rings and legends, as PNG, SVG or PDF.
//!
//! Knows [`yamanami_core::NestedField`], [`yamanami_core::DeformedMap`] and pixels; no file format of the ground and no
//! triangle.
#![forbid(unsafe_code)]

mod error;
mod horizon;
mod ink;
mod relief;

pub use error::MapError;
pub use horizon::{HorizonTable, SeenFrom, Sightline};
pub use ink::{InkStyle, ink};
pub use relief::{GroundPicture, ReliefStyle, TintStop, paint};
