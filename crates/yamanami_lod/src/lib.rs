//! Level-of-detail control: which nodes of a hierarchy to show, and how the front moves from frame to frame.
//!
//! A [`Front`] is the parent-closed set of applied nodes. [`Controller`] moves it by the least change to what tolerance,
//! view and triangle budget ask for; [`extract`] builds the same front from nothing, slowly and shortly, and is the
//! oracle the controller is tested against. [`PaperController`] is the paper's own staircase with its proportional
//! feedback, [`BandTable`] the band table of deformed maps. This crate knows no height, vertex, file or clock: only [`yamanami_core::Hierarchy`].
#![forbid(unsafe_code)]

mod bands;
mod controller;
mod criteria;
mod front;
mod oracle;
mod paper;
mod wheel;

pub use bands::{
    Band, BandRule, BandTable, MiddleReading, PAPER_BLOCK_M, PAPER_SPLIT_PX, SlopeDeviation, band_error_px,
    hypotenuse_m,
};
pub use controller::{Controller, FrameReport, LimitedBy};
pub use criteria::{Criteria, MapCriterion, ViewCriterion};
pub use front::{Front, Step};
pub use oracle::extract;
pub use paper::{PaperController, Staircase};
