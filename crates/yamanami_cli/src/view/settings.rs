//! All that the side panel turns, and what it means for the front and for its picture.

use super::Options;
use crate::pictures;
use std::sync::Arc;
use yamanami::core::View;
use yamanami::gpu::{ColourBy, Drape, Haze, Light, Morph, RenderOptions, Wireframe};
use yamanami::{Criteria, Lod, Staircase, Subject, ViewCriterion};

/// Colour where the surface is to be plain, sRGB.
const PLAIN: [u8; 3] = [206, 200, 188];
/// Triangles allowed where the program was started without a budget and one is switched on.
const USUAL_BUDGET: u32 = 100_000;
/// Steps a frame where the program was started without a limit and one is switched on.
const USUAL_STEPS: usize = 2_000;
/// Geomorphing: a detail is whole once its error is this much above the threshold, relatively.
const MORPH_WIDTH: f32 = 0.5;

/// What moves the front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Control {
    /// The exact controller.
    Exact,
    /// The paper's staircase.
    Paper,
}

/// What colours the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Colour {
    /// The model's own.
    Own,
    /// Hypsometric tint.
    Height,
    /// Depth of the vertices' nodes.
    Level,
    /// One colour.
    Plain,
    /// Angle to the horizontal.
    Slope,
    /// Direction of fall.
    Aspect,
    /// The image laid over it.
    Image,
}

impl Colour {
    /// Those of a terrain, in the order of the panel.
    pub(super) const OF_TERRAIN: [Self; 6] =
        [Self::Height, Self::Slope, Self::Aspect, Self::Level, Self::Plain, Self::Image];
    /// Those of a model.
    pub(super) const OF_MODEL: [Self; 6] =
        [Self::Own, Self::Height, Self::Slope, Self::Aspect, Self::Level, Self::Plain];

    /// Word for the panel.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Own => "own",
            Self::Height => "height",
            Self::Level => "level",
            Self::Plain => "plain",
            Self::Slope => "slope",
            Self::Aspect => "aspect",
            Self::Image => "image",
        }
    }
}

impl From<pictures::Colour> for Colour {
    fn from(colour: pictures::Colour) -> Self {
        match colour {
            pictures::Colour::Height => Self::Height,
            pictures::Colour::Level => Self::Level,
            pictures::Colour::Plain => Self::Plain,
            pictures::Colour::Slope => Self::Slope,
            pictures::Colour::Aspect => Self::Aspect,
        }
    }
}

/// The settings.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Settings {
    pub(super) tolerance_m: f32,
    pub(super) tolerance_px: f32,
    pub(super) budget_on: bool,
    pub(super) budget_triangles: u32,
    pub(super) hysteresis: f32,
    pub(super) steps_on: bool,
    pub(super) max_steps: usize,
    pub(super) cull: bool,
    pub(super) control: Control,
    pub(super) intervals: usize,
    pub(super) gain: f32,
    pub(super) rebuild: bool,
    pub(super) morph: bool,
    pub(super) wireframe: bool,
    pub(super) colour: Colour,
    pub(super) haze: bool,
    pub(super) antialias: bool,
    pub(super) light: Light,
    pub(super) water_on: bool,
    pub(super) water_m: f64,
}

impl Settings {
    /// As the program was started.
    pub(super) fn new(options: &Options) -> Self {
        let criteria = &options.criteria;
        let (control, intervals, gain) = match &options.lod {
            Lod::Exact => (Control::Exact, 5, 0.5),
            Lod::Paper(staircase) => (Control::Paper, staircase.thresholds_m.len().max(1), staircase.gain),
        };
        Self {
            tolerance_m: criteria.terrain_tolerance_m,
            tolerance_px: criteria.view.map_or(1.0, |v| v.tolerance_px),
            budget_on: criteria.budget_triangles.is_some(),
            budget_triangles: criteria.budget_triangles.unwrap_or(USUAL_BUDGET),
            hysteresis: criteria.hysteresis,
            steps_on: criteria.max_steps.is_some(),
            max_steps: criteria.max_steps.unwrap_or(USUAL_STEPS),
            cull: criteria.view.is_none_or(|v| v.cull),
            control,
            intervals,
            gain,
            rebuild: false,
            morph: true,
            wireframe: false,
            colour: match options.colour {
                _ if options.image.is_some() => Colour::Image,
                Some(colour) => colour.into(),
                None => Colour::Height,
            },
            haze: true,
            antialias: true,
            light: Light::default(),
            water_on: options.water_m.is_some(),
            water_m: options.water_m.unwrap_or(0.0),
        }
    }

    /// Height of the water, if there is any.
    pub(super) fn water_level_m(&self) -> Option<f64> {
        self.water_on.then_some(self.water_m)
    }

    /// What is asked of the front for a view.
    pub(super) fn criteria(&self, view: View) -> Criteria {
        Criteria {
            terrain_tolerance_m: self.tolerance_m,
            view: Some(ViewCriterion { view, tolerance_px: self.tolerance_px, cull: self.cull }),
            budget_triangles: self.budget_on.then_some(self.budget_triangles),
            hysteresis: self.hysteresis,
            max_steps: self.steps_on.then_some(self.max_steps),
            ..Criteria::default()
        }
    }

    /// The control of the front. The staircase reaches from the eye over the terrain's diagonal.
    pub(super) fn lod(&self, diagonal_m: f64) -> Lod {
        match self.control {
            Control::Exact => Lod::Exact,
            Control::Paper => {
                let staircase = Staircase::new(self.tolerance_m, 0.0, 1.2 * diagonal_m, self.intervals);
                Lod::Paper(Staircase { gain: self.gain, ..staircase })
            }
        }
    }

    /// Whether another control than before must start from the base mesh.
    pub(super) fn restarts(&self, before: &Self) -> bool {
        let paper = |s: &Self| (s.control == Control::Paper).then_some((s.tolerance_m, s.intervals, s.gain));
        paper(self) != paper(before)
    }

    /// The style of the picture. `threshold_px` is what is in force, where details may fade in.
    pub(super) fn style(
        &self,
        subject: &impl Subject,
        drape: Option<&Arc<Drape>>,
        threshold_px: Option<f32>,
    ) -> RenderOptions {
        let usual = subject.usual_style();
        RenderOptions {
            colour: match self.colour {
                Colour::Own => usual.colour,
                Colour::Height => ColourBy::Height,
                Colour::Level => ColourBy::Level,
                Colour::Plain => ColourBy::Plain(PLAIN),
                Colour::Slope => ColourBy::Slope,
                Colour::Aspect => ColourBy::Aspect,
                Colour::Image => ColourBy::Drape,
            },
            deepest_level: usual.deepest_level.saturating_sub(1).max(1),
            drape: drape.cloned(),
            light: self.light,
            water_level_m: self.water_level_m(),
            morph: threshold_px.filter(|_| self.morph).map(|tau_px| Morph { tau_px, width: MORPH_WIDTH }),
            wireframe: self.wireframe.then(Wireframe::default),
            haze: if self.haze { usual.haze } else { Haze::None },
            antialias: self.antialias,
            ..usual
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_paper_s_own_numbers_restart_it() {
        let exact = Settings::new(&Options::default());
        let finer = Settings { tolerance_m: 3.0, gain: 0.9, ..exact.clone() };
        assert!(!finer.restarts(&exact));
        let paper = Settings { control: Control::Paper, ..exact.clone() };
        assert!(paper.restarts(&exact) && exact.restarts(&paper));
        assert!(Settings { gain: 0.9, ..paper.clone() }.restarts(&paper));
        assert!(!Settings { budget_triangles: 7, ..paper.clone() }.restarts(&paper));
    }

    #[test]
    fn what_is_switched_off_is_not_asked() {
        let mut settings = Settings::new(&Options::default());
        let view = View { eye: glam::DVec3::Z, target: glam::DVec3::ZERO, fov_y_rad: 1.0, viewport_px: [8, 8] };
        let criteria = settings.criteria(view);
        assert_eq!((criteria.budget_triangles, criteria.max_steps), (None, None));
        (settings.budget_on, settings.steps_on) = (true, true);
        let criteria = settings.criteria(view);
        assert_eq!((criteria.budget_triangles, criteria.max_steps), (Some(USUAL_BUDGET), Some(USUAL_STEPS)));
    }
}
