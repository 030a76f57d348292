//! Making maps of ground that is already there: how it is coloured and shaded, what hides what, and the sheet around it
//! with names, lines, rings and legends, as PNG, SVG or PDF.
//!
//! Knows [`yamanami_core::NestedField`], [`yamanami_core::DeformedMap`] and pixels; no file format of the ground and no
//! triangle. Without the feature `sheet` it has relief, horizon and ink alone, for browsers.
#![forbid(unsafe_code)]

#[cfg(feature = "sheet")]
mod boxes;
mod error;
#[cfg(feature = "sheet")]
mod fonts;
#[cfg(feature = "sheet")]
mod furniture;
mod horizon;
mod ink;
#[cfg(feature = "sheet")]
mod labels;
#[cfg(feature = "sheet")]
mod lines;
mod relief;
#[cfg(feature = "sheet")]
mod scene;
#[cfg(feature = "sheet")]
mod sheet;

#[cfg(feature = "sheet")]
pub use boxes::OrientedBox;
pub use error::MapError;
#[cfg(feature = "sheet")]
pub use fonts::Fonts;
pub use horizon::{HorizonTable, SeenFrom, Sightline};
pub use ink::{InkStyle, ink};
#[cfg(feature = "sheet")]
pub use labels::{Label, MissingGlyphs, Outcome, latin_name, parted_name};
pub use relief::{GroundPicture, ReliefStyle, TintStop, paint};
#[cfg(feature = "sheet")]
pub use scene::{Anchor, Colour, Fill, Outline, PackedBase, Run, Scene, Shape, Stroke, Text, encode_png};
#[cfg(feature = "sheet")]
pub use sheet::{BearingRing, Composed, HiddenNames, Language, NameForm, Sheet, SheetOptions};
