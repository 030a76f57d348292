//! The sheet of a deformed map: everything but the ground, composed in order over it.
//!
//! What such a sheet needs is taken from printed panorama maps (Heinrich Berann's and the Japanese *tenbōzu*): few
//! colours, hairlines, names that stand out from the horizon like rays.

mod options;
mod palette;
mod strings;
mod style;

pub use options::{BearingRing, HiddenNames, Language, NameForm, SheetOptions};
pub(crate) use palette::*;
pub(crate) use strings::{Strings, grouped, short};
pub(crate) use style::Style;

use crate::boxes::Taken;
use crate::labels::{self, Label, MissingGlyphs};
use crate::scene::{Colour, Outline, Scene, Stroke};
use crate::{Fonts, furniture, lines};
use glam::{DVec2, DVec3};
use yamanami_core::{MapLine, MapView, NamedPlace};

/// What is drawn over a picture of the ground.
#[derive(Debug, Clone)]
pub struct Sheet<'a> {
    /// How the ground is drawn.
    pub view: &'a MapView,
    /// Name of the map; empty for none.
    pub title: &'a str,
    /// Longitude and latitude of the centre in degrees, if known.
    pub centre_lon_lat: Option<DVec2>,
    /// Whose data it shows, one line each.
    pub credits: &'a [String],
    /// Named places, positions in metres of the plane.
    pub places: &'a [NamedPlace],
    /// Lines, positions in metres of the plane; later ones lie over earlier ones of their kind.
    pub lines: &'a [MapLine],
    /// Edges of mountains, pixels.
    pub silhouettes: &'a [Vec<DVec2>],
    /// Heights in metres and their colours, rising, for the legend; empty for none.
    pub tint: &'a [(f64, Colour)],
    /// What to show and how.
    pub options: &'a SheetOptions,
    /// What it is lettered with.
    pub fonts: &'a Fonts,
}

/// A sheet, composed.
#[derive(Debug, Clone)]
pub struct Composed {
    /// What is to be drawn.
    pub scene: Scene,
    /// What became of each place, in the order of the places.
    pub labels: Vec<Label>,
    /// Names, titles and credits with characters that no font has.
    pub missing: Vec<MissingGlyphs>,
}

impl Sheet<'_> {
    /// Composes the sheet. `height_m` is the ground's height at a point of the plane (NaN where there is none),
    /// `is_visible` whether a point is seen in the picture.
    pub fn compose(&self, height_m: &dyn Fn(DVec2) -> f64, is_visible: &dyn Fn(DVec3) -> bool) -> Composed {
        let style = Style::new(self.options, self.fonts);
        let mut scene = Scene { size_px: self.view.size_px, paper: self.options.paper, shapes: Vec::new() };
        let mut taken = Taken::of_picture(self.view.size_px, style.pt(SheetOptions::FRAME_PT));
        self.draw_silhouettes(&mut scene, &style);
        let kinds = lines::draw(&mut scene, &style, self, height_m, is_visible);
        furniture::draw_over_map(&mut scene, &style, self, &mut taken);
        furniture::draw_around_map(&mut scene, &style, self, &kinds, &mut taken);
        let (labels, mut missing) = labels::draw(&mut scene, &style, self, &mut taken, height_m, is_visible);
        let texts = self.credits.iter().map(String::as_str).chain([self.title]);
        missing.extend(texts.filter_map(|text| MissingGlyphs::of_text(self.fonts, text)));
        Composed { scene, labels, missing }
    }

    fn draw_silhouettes(&self, scene: &mut Scene, style: &Style<'_>) {
        let outlines = self.silhouettes.iter().filter(|line| line.len() > 1).map(|line| Outline::open(line.clone()));
        scene.stroke(outlines.collect(), Stroke::new(INK, style.pt(0.35)).at_opacity(0.55));
    }

    /// Largest radius within the picture, pixels.
    pub(crate) fn half_px(&self) -> f64 {
        let size = DVec2::new(f64::from(self.view.size_px[0]), f64::from(self.view.size_px[1]));
        let near = self.view.centre_px.min(size - self.view.centre_px);
        near.x.min(near.y).max(0.0)
    }

    /// Radius of the rim at sea level, pixels.
    pub(crate) fn rim_px(&self) -> f64 {
        self.view.ring_px * self.view.map.rho(self.view.rim_m, 0.0)
    }

    /// Radius of the bearing ring around everything, pixels; of where names must end, without it.
    pub(crate) fn outer_px(&self, style: &Style<'_>) -> f64 {
        self.half_px() - style.pt(SheetOptions::FRAME_PT + self.options.bearing_pt())
    }
}
