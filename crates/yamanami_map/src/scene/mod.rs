//! What is drawn over the ground, as a short list of shapes: the same list becomes SVG, PDF and pixels.

mod pdf;
mod png;
mod raster;
mod svg;

pub use pdf::PackedBase;
pub use png::encode_png;

use glam::DVec2;

/// Red, green, blue.
pub type Colour = [u8; 3];

/// A line that is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width in pixels.
    pub width_px: f64,
    /// 0 to 1.
    pub opacity: f64,
    /// Lengths of dash and gap in pixels.
    pub dash_px: Option<[f64; 2]>,
}

impl Stroke {
    /// A full line.
    pub fn new(colour: Colour, width_px: f64) -> Self {
        Self { colour, width_px, opacity: 1.0, dash_px: None }
    }

    /// The same, seen through.
    pub fn at_opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    /// The same, dashed.
    pub fn dashed(self, dash_px: f64, gap_px: f64) -> Self {
        Self { dash_px: Some([dash_px, gap_px]), ..self }
    }
}

/// An area that is filled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fill {
    /// Its colour.
    pub colour: Colour,
    /// 0 to 1.
    pub opacity: f64,
}

/// A line or ring of straight pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Its corners, pixels.
    pub points: Vec<DVec2>,
    /// Whether the last is joined to the first.
    pub is_closed: bool,
}

impl Outline {
    /// An open line.
    pub fn open(points: impl Into<Vec<DVec2>>) -> Self {
        Self { points: points.into(), is_closed: false }
    }

    /// A ring.
    pub fn closed(points: impl Into<Vec<DVec2>>) -> Self {
        Self { points: points.into(), is_closed: true }
    }
}

/// Which end of a text lies at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Anchor {
    /// Where it begins.
    #[default]
    Start,
    /// Its middle.
    Middle,
    /// Where it ends.
    End,
}

/// Letters of one size and colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The letters.
    pub text: String,
    /// Their size in pixels.
    pub size_px: f64,
    /// Their colour.
    pub colour: Colour,
}

/// One line of letters.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// Place of the anchor on the base line, pixels.
    pub at: DVec2,
    /// Turned clockwise about it, radians.
    pub angle_rad: f64,
    /// Which end is anchored.
    pub anchor: Anchor,
    /// What it says.
    pub runs: Vec<Run>,
    /// A light edge around the letters.
    pub halo: Option<Stroke>,
}

/// One thing drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Lines and areas that look alike.
    Outlines {
        /// The lines.
        outlines: Vec<Outline>,
        /// How they are filled.
        fill: Option<Fill>,
        /// How they are drawn.
        stroke: Option<Stroke>,
    },
    /// A circle.
    Circle {
        /// Its centre, pixels.
        centre: DVec2,
        /// Its radius, pixels.
        radius_px: f64,
        /// How it is filled.
        fill: Option<Fill>,
        /// How it is drawn.
        stroke: Option<Stroke>,
    },
    /// Letters.
    Text(Text),
}

/// All that is drawn over the ground, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Width and height in pixels.
    pub size_px: [u32; 2],
    /// Colour under a picture of the ground that is transparent; none keeps it so.
    pub paper: Option<Colour>,
    /// The shapes, first at the bottom.
    pub shapes: Vec<Shape>,
}

impl Scene {
    /// Draws lines.
    pub(crate) fn stroke(&mut self, outlines: Vec<Outline>, stroke: Stroke) {
        if !outlines.is_empty() {
            self.shapes.push(Shape::Outlines { outlines, fill: None, stroke: Some(stroke) });
        }
    }

    /// Fills areas.
    pub(crate) fn fill(&mut self, outlines: Vec<Outline>, fill: Fill) {
        if !outlines.is_empty() {
            self.shapes.push(Shape::Outlines { outlines, fill: Some(fill), stroke: None });
        }
    }

    /// Draws a circle.
    pub(crate) fn circle(&mut self, centre: DVec2, radius_px: f64, stroke: Stroke) {
        self.shapes.push(Shape::Circle { centre, radius_px, fill: None, stroke: Some(stroke) });
    }

    /// Writes letters.
    pub(crate) fn text(&mut self, text: Text) {
        self.shapes.push(Shape::Text(text));
    }
}

impl Shape {
    /// The same, elsewhere.
    pub(crate) fn moved(mut self, by: DVec2) -> Self {
        match &mut self {
            Self::Outlines { outlines, .. } => outlines.iter_mut().flat_map(|o| &mut o.points).for_each(|p| *p += by),
            Self::Circle { centre, .. } => *centre += by,
            Self::Text(text) => text.at += by,
        }
        self
    }
}
