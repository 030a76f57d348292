//! What of a sheet is shown, in which language, and how large.

use crate::scene::Colour;

/// Language of everything but names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Language {
    /// Japanese.
    #[default]
    Ja,
    /// English.
    En,
}

/// What names are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NameForm {
    /// As given.
    #[default]
    Local,
    /// In Latin letters: as given, else from the kana (Hepburn); the given name where there is neither.
    Latin,
    /// As given, then the reading or the Latin letters, small.
    Both,
}

/// Where bearings are marked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BearingRing {
    /// Nowhere.
    Off,
    /// Around the plain map.
    PlainMap,
    /// Around everything.
    #[default]
    Outside,
}

/// What becomes of names of places that ground hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HiddenNames {
    /// They are left out.
    #[default]
    Drop,
    /// They are written in grey, after all others.
    Grey,
}

/// What a sheet shows and how large it is lettered.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetOptions {
    /// Pixels to a typographic point of the sheet: type, lines and margins all scale by it. See [`Self::point_px_for`].
    pub point_px: f64,
    /// Language of everything but names.
    pub language: Language,
    /// What names are written in.
    pub names: NameForm,
    /// Whether names are shown at all.
    pub has_names: bool,
    /// Whether heights, and at the rim distances, stand beside names.
    pub has_numbers: bool,
    /// What becomes of hidden places.
    pub hidden: HiddenNames,
    /// Rings of names around the horizon, 1 to 3.
    pub name_rings: u32,
    /// Where bearings are marked.
    pub bearing: BearingRing,
    /// Whether circles of equal distance are drawn.
    pub has_distance_rings: bool,
    /// Whether the plain map has a scale bar.
    pub has_scale_bar: bool,
    /// Whether colours, lines and marks are explained.
    pub has_legend: bool,
    /// Whether title, centre and numbers of the projection are written.
    pub has_title: bool,
    /// Whether credits are written.
    pub has_credits: bool,
    /// Whether a frame is drawn.
    pub has_frame: bool,
    /// Colour under a transparent picture; none leaves it transparent.
    pub paper: Option<Colour>,
}

impl Default for SheetOptions {
    fn default() -> Self {
        Self {
            point_px: 4.0 / 3.0,
            language: Language::Ja,
            names: NameForm::Local,
            has_names: true,
            has_numbers: true,
            hidden: HiddenNames::Drop,
            name_rings: 1,
            bearing: BearingRing::Outside,
            has_distance_rings: true,
            has_scale_bar: true,
            has_legend: true,
            has_title: true,
            has_credits: true,
            has_frame: true,
            paper: Some(super::PAPER),
        }
    }
}

impl SheetOptions {
    /// From the picture's edge to what stands inside the frame, points.
    pub(crate) const FRAME_PT: f64 = 20.0;
    /// What one ring of names takes, points.
    pub(crate) const NAMES_PT: f64 = 90.0;
    /// Between the horizon and the first ring of names, points.
    pub(crate) const LEADER_PT: f64 = 20.0;

    /// Pixels to a point for a picture: on screens as many to each picture; in print (`dpi` given) type grows slower
    /// than the paper, for a wall map is read from farther away.
    pub fn point_px_for(size_px: [u32; 2], dpi: Option<f64>) -> f64 {
        let side_px = f64::from(size_px[0].min(size_px[1]).max(1));
        match dpi {
            Some(dpi) if dpi > 0.0 => {
                let share = side_px * 25.4 / dpi / 300.0;
                dpi / 72.0 * share.powf(if share < 1.0 { 0.5 } else { 0.35 })
            }
            _ => side_px / 975.0,
        }
    }

    /// Pixels to leave around the horizon for names, bearings and frame: the margin of [`yamanami_core::MapView::fitted`].
    pub fn margin_px(&self) -> f64 {
        let names = if self.has_names {
            Self::LEADER_PT + Self::NAMES_PT * f64::from(self.name_rings.clamp(1, 3))
        } else {
            8.0
        };
        self.point_px * (Self::FRAME_PT + self.bearing_pt() + names)
    }

    /// What the bearing ring outside takes, points.
    pub(crate) fn bearing_pt(&self) -> f64 {
        if self.bearing == BearingRing::Outside { 17.0 } else { 0.0 }
    }
}
