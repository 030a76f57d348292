//! Names of places: which are shown, where they stand, and what became of each.
//!
//! A name stands at the true summit, never at a vertex of a mesh. In and around the plain map names stand beside their
//! marks ([`near`]), at the rim like rays outside the horizon ([`rim`]). No name lies over another, over the sheet's
//! furniture or outside the picture; where there is no room the lesser goes.

mod lettering;
mod near;
mod rank;
mod rim;
mod romaji;

#[cfg(test)]
mod tests;

pub use lettering::{MissingGlyphs, latin_name, parted_name};
pub(crate) use near::draw_mark;

use crate::boxes::{OrientedBox, Taken};
use crate::scene::Scene;
use crate::sheet::{HiddenNames, Sheet, Style};
use glam::{DVec2, DVec3};
use lettering::Lettering;
use yamanami_core::{NamedPlace, PlaceKind};

/// What became of a place's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Outcome {
    /// It is shown.
    Shown,
    /// It is shown in grey: ground hides the place.
    ShownHidden,
    /// Ground hides the place.
    Hidden,
    /// There was no room, or names are off.
    Crowded,
    /// The place lies outside the picture.
    OutsidePicture,
    /// The place lies beyond the rim.
    BeyondRim,
    /// The place has no coordinates.
    NoCoordinates,
}

impl Outcome {
    /// One word for files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Shown => "shown",
            Self::ShownHidden => "shown_hidden",
            Self::Hidden => "hidden",
            Self::Crowded => "crowded",
            Self::OutsidePicture => "outside_picture",
            Self::BeyondRim => "beyond_rim",
            Self::NoCoordinates => "no_coordinates",
        }
    }
}

/// A place's name on the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The name as given.
    pub name: String,
    /// What it is.
    pub kind: PlaceKind,
    /// Place in the plane and height, metres; not finite without coordinates.
    pub at: DVec3,
    /// Distance from the centre, metres.
    pub distance_m: f64,
    /// Bearing from the centre, radians clockwise from north.
    pub bearing_rad: f64,
    /// Where the ground at the place is drawn, pixels; not finite without coordinates.
    pub anchor_px: DVec2,
    /// The box of the name, pixels, where it is shown.
    pub box_px: Option<OrientedBox>,
    /// Corners of the line from the summit to a name at the rim, pixels; empty for others.
    pub leader_px: Vec<DVec2>,
    /// What became of it.
    pub outcome: Outcome,
}

/// A place that may be named, in the picture.
#[derive(Debug)]
pub(crate) struct Candidate {
    /// Which place.
    pub(crate) place: usize,
    pub(crate) kind: PlaceKind,
    pub(crate) px: DVec2,
    pub(crate) score: f64,
    pub(crate) is_hidden: bool,
    pub(crate) lettering: Lettering,
}

/// Share of the horizon's radius up to which names stand beside their marks.
const NEAR_SHARE: f64 = 0.86;

/// Places the names, draws them, and says what became of each.
pub(crate) fn draw(
    scene: &mut Scene,
    style: &Style<'_>,
    sheet: &Sheet<'_>,
    taken: &mut Taken,
    height_m: &dyn Fn(DVec2) -> f64,
    is_visible: &dyn Fn(DVec3) -> bool,
) -> (Vec<Label>, Vec<MissingGlyphs>) {
    let mut labels: Vec<Label> = sheet.places.iter().map(|place| looked_at(sheet, place, height_m)).collect();
    let mut missing = Vec::new();
    if !sheet.options.has_names {
        return (labels, missing);
    }
    let near_px = NEAR_SHARE * sheet.rim_px();
    let is_near = |px: DVec2| (px - sheet.view.centre_px).length() <= near_px.max(sheet.view.ring_px);
    let scores = rank::scores(sheet.places, &labels, sheet.view.map.ring_m);
    let mut candidates = Vec::new();
    for (i, (place, label)) in sheet.places.iter().zip(&mut labels).enumerate() {
        if label.outcome != Outcome::Crowded {
            continue;
        }
        let is_hidden = !is_visible(label.at);
        if is_hidden {
            label.outcome = Outcome::Hidden;
            if sheet.options.hidden == HiddenNames::Drop {
                continue;
            }
        }
        let (lettering, lack) = Lettering::of(style, sheet.options, place, label, is_near(label.anchor_px), is_hidden);
        missing.extend(lack);
        candidates.push(Candidate {
            place: i,
            kind: place.kind,
            px: label.anchor_px,
            score: scores[i],
            is_hidden,
            lettering,
        });
    }
    let most = |c: &Candidate| (c.is_hidden, matches!(c.kind, PlaceKind::Settlement | PlaceKind::Other));
    candidates.sort_by(|a, b| most(a).cmp(&most(b)).then(b.score.total_cmp(&a.score)).then(a.place.cmp(&b.place)));
    let (near, far): (Vec<_>, Vec<_>) = candidates.into_iter().partition(|c| is_near(c.px));
    let mut shown = rim::place(style, sheet, &far, taken);
    shown.extend(near::place(style, &near, taken));
    rim::draw_leaders(scene, style, &shown);
    near::draw_marks(scene, style, &near, &shown);
    for placed in shown {
        let label = &mut labels[placed.place];
        label.outcome = if label.outcome == Outcome::Hidden { Outcome::ShownHidden } else { Outcome::Shown };
        label.box_px = Some(placed.outline);
        label.leader_px = placed.leader;
        scene.text(placed.text);
    }
    (labels, missing)
}

/// A name that has found its place.
#[derive(Debug)]
pub(crate) struct Placed {
    pub(crate) place: usize,
    pub(crate) is_hidden: bool,
    pub(crate) outline: OrientedBox,
    pub(crate) leader: Vec<DVec2>,
    pub(crate) text: crate::scene::Text,
}

/// Where a place is; [`Outcome::Crowded`] as long as nothing else is known of it.
fn looked_at(sheet: &Sheet<'_>, place: &NamedPlace, height_m: &dyn Fn(DVec2) -> f64) -> Label {
    let view = sheet.view;
    let given = place.height_m.filter(|h| h.is_finite());
    let z = if place.position.is_finite() { given.unwrap_or_else(|| height_m(place.position)) } else { f64::NAN };
    let at = place.position.extend(if z.is_finite() { z } else { 0.0 });
    let out = place.position - view.map.centre;
    // on the ground that is drawn: a grid's summit is lower than the surveyed one, and its mark must not float
    let ground = if place.position.is_finite() { height_m(place.position) } else { f64::NAN };
    let anchor_px = view.px_from_plane(if ground.is_finite() { at.with_z(ground) } else { at });
    let [width, height] = view.size_px.map(f64::from);
    let is_in = anchor_px.x >= 0.0 && anchor_px.y >= 0.0 && anchor_px.x < width && anchor_px.y < height;
    let outcome = if !(at.is_finite() && anchor_px.is_finite()) {
        Outcome::NoCoordinates
    } else if out.length() > view.rim_m {
        Outcome::BeyondRim
    } else if !is_in {
        Outcome::OutsidePicture
    } else {
        Outcome::Crowded
    };
    Label {
        name: place.name.clone(),
        kind: place.kind,
        at,
        distance_m: out.length(),
        bearing_rad: out.x.atan2(out.y).rem_euclid(std::f64::consts::TAU),
        anchor_px,
        box_px: None,
        leader_px: Vec::new(),
        outcome,
    }
}
