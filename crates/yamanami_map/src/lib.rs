//! Making maps of ground that is already there: how it is coloured and shaded, what hides what, and the sheet around it
//! with names, lines, rings and legends, as PNG, SVG or PDF.
//!
//! Knows [`yamanami_core::NestedField`], [`yamanami_core::DeformedMap`] and pixels; no file format of the ground and no
//! triangle.
#![forbid(unsafe_code)]

mod boxes;
mod error;
mod fonts;
mod furniture;
mod horizon;
mod ink;
mod labels;
mod lines;
mod relief;
mod scene;
mod sheet;

pub use boxes::OrientedBox;
pub use error::MapError;
pub use fonts::Fonts;
pub use horizon::{HorizonTable, SeenFrom, Sightline};
pub use ink::{InkStyle, ink};
pub use labels::{Label, MissingGlyphs, Outcome, latin_name, parted_name};
pub use relief::{GroundPicture, ReliefStyle, TintStop, paint};
pub use scene::{Anchor, Colour, Fill, Outline, PackedBase, Run, Scene, Shape, Stroke, Text, encode_png};
pub use sheet::{BearingRing, Composed, HiddenNames, Language, NameForm, Sheet, SheetOptions};
