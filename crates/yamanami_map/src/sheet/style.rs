//! Sizes in points made pixels, and texts of the sheet's kind.

use super::{HALO, Language, SheetOptions, Strings};
use crate::Fonts;
use crate::scene::{Anchor, Colour, Run, Stroke, Text};
use glam::DVec2;

/// What everything on a sheet is drawn with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Style<'a> {
    /// Pixels to a point.
    pub(crate) point_px: f64,
    pub(crate) fonts: &'a Fonts,
    pub(crate) language: Language,
}

impl<'a> Style<'a> {
    pub(crate) fn new(options: &SheetOptions, fonts: &'a Fonts) -> Self {
        let point_px = if options.point_px.is_finite() { options.point_px.max(0.05) } else { 1.0 };
        Self { point_px, fonts, language: options.language }
    }

    /// Points as pixels.
    pub(crate) fn pt(&self, points: f64) -> f64 {
        points * self.point_px
    }

    /// The same, everything this many times as large.
    pub(crate) fn scaled(&self, by: f64) -> Self {
        Self { point_px: self.point_px * by, ..*self }
    }

    pub(crate) fn strings(&self) -> &'static Strings {
        Strings::of(self.language)
    }

    /// Letters of one size.
    pub(crate) fn run(&self, text: impl Into<String>, points: f64, colour: Colour) -> Run {
        Run { text: text.into(), size_px: self.pt(points), colour }
    }

    /// Width of runs set one after the other, pixels.
    pub(crate) fn width_px(&self, runs: &[Run]) -> f64 {
        let widths_em = self.fonts.widths_em(runs.iter().map(|run| run.text.as_str()));
        runs.iter().zip(widths_em).map(|(run, em)| run.size_px * em).sum()
    }

    /// A line of letters with its base line at `at`.
    pub(crate) fn line(&self, at: DVec2, anchor: Anchor, runs: Vec<Run>) -> Text {
        Text { at, angle_rad: 0.0, anchor, runs, halo: None }
    }

    /// A line of letters whose middle height is at `at`, turned clockwise.
    pub(crate) fn centred(&self, at: DVec2, angle_rad: f64, anchor: Anchor, runs: Vec<Run>) -> Text {
        let tallest = runs.iter().map(|run| run.size_px).fold(0.0, f64::max);
        let down = DVec2::from_angle(angle_rad).rotate(DVec2::new(0.0, 0.36 * tallest));
        Text { at: at + down, angle_rad, anchor, runs, halo: None }
    }

    /// The light edge around letters that stand on the ground.
    pub(crate) fn halo(&self) -> Stroke {
        Stroke::new(HALO, self.pt(2.2)).at_opacity(0.85)
    }
}
