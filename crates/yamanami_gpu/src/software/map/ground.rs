//! What ground is seen at each pixel.

use std::ops::Range;
use yamanami_core::MapView;

/// Ground seen at the middle of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundPoint {
    /// Place in the plane, metres; NaN where nothing is drawn.
    pub x_m: f32,
    /// See `x_m`.
    pub y_m: f32,
    /// Height, metres.
    pub z_m: f32,
    /// Slot of the triangle, see [`crate::ResidentBuffers::triangles`].
    pub triangle: u32,
}

/// The ground seen in some rows of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundBuffer {
    pub(super) width: u32,
    pub(super) rows: Range<u32>,
    pub(super) points: Vec<GroundPoint>,
}

impl GroundPoint {
    /// Nothing is drawn here.
    pub const NOTHING: Self = Self { x_m: f32::NAN, y_m: f32::NAN, z_m: f32::NAN, triangle: u32::MAX };

    /// Whether there is ground.
    pub fn is_ground(&self) -> bool {
        !self.x_m.is_nan()
    }

    /// Distance from the centre as a share of the rim's, as [`MapView::depth_key`]: something of another key at this pixel
    /// is seen if it is nearer. NaN where nothing is drawn.
    pub fn depth_key(&self, view: &MapView) -> f64 {
        let (x, y) = (f64::from(self.x_m) - view.map.centre.x, f64::from(self.y_m) - view.map.centre.y);
        x.hypot(y) / view.rim_m
    }
}

impl GroundBuffer {
    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of the picture.
    pub fn rows(&self) -> Range<u32> {
        self.rows.clone()
    }

    /// The pixels, row by row.
    pub fn points(&self) -> &[GroundPoint] {
        &self.points
    }

    /// The ground at a column and row of the picture, if any is seen there.
    pub fn at(&self, column: u32, row: u32) -> Option<GroundPoint> {
        let is_inside = column < self.width && self.rows.contains(&row);
        let pixel = || (row - self.rows.start) as usize * self.width as usize + column as usize;
        is_inside.then(|| self.points[pixel()]).filter(GroundPoint::is_ground)
    }
}
