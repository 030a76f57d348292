//! A deformed map laid into a picture of pixels.

use super::{DeformedMap, Patch};
use crate::{Projection, Sphere};
use glam::{DVec2, DVec3, DVec4};

/// A deformed map as a picture: where its centre lies, how large the plain map is, how far it reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapView {
    /// The projection.
    pub map: DeformedMap,
    /// Picture size in pixels.
    pub size_px: [u32; 2],
    /// Place of the centre in the picture: pixels from the left and from the top.
    pub centre_px: DVec2,
    /// Radius of the plain map in pixels (P).
    pub ring_px: f64,
    /// How far ground is drawn from the centre, metres.
    pub rim_m: f64,
    /// Azimuth that points up, radians clockwise from north.
    pub up_azimuth_rad: f64,
}

impl MapView {
    /// A picture of this size that holds all ground to the rim up to `top_m` metres of height, with `margin_px` around.
    pub fn fitted(map: DeformedMap, size_px: [u32; 2], rim_m: f64, top_m: f64, margin_px: f64) -> Self {
        let half_px = 0.5 * f64::from(size_px[0].min(size_px[1]));
        // high ground on the way may be drawn further out than the rim
        let reach = (0..=64)
            .map(|i| map.ring_m + (rim_m - map.ring_m).max(0.0) * f64::from(i) / 64.0)
            .map(|r_m| map.rho(r_m, if r_m > 2.0 * map.ring_m { top_m } else { 0.0 }))
            .fold(rim_m.min(map.ring_m) / map.ring_m, f64::max);
        Self {
            map,
            size_px,
            centre_px: 0.5 * DVec2::new(f64::from(size_px[0]), f64::from(size_px[1])),
            ring_px: (half_px - margin_px).max(1.0) / reach,
            rim_m,
            up_azimuth_rad: 0.0,
        }
    }

    /// Pixels (from the left, from the top) of a point of the plane.
    pub fn px_from_plane(&self, p: DVec3) -> DVec2 {
        self.px_from_image(self.map.image_from_plane(p))
    }

    /// Pixels of a place of the picture given in radii of the plain map (x right, y up at azimuth 0).
    pub fn px_from_image(&self, place: DVec2) -> DVec2 {
        let turned = DVec2::from_angle(self.up_azimuth_rad).rotate(place);
        self.centre_px + self.ring_px * DVec2::new(turned.x, -turned.y)
    }

    /// The inverse of [`Self::px_from_image`].
    pub fn image_from_px(&self, px: DVec2) -> DVec2 {
        let out = (px - self.centre_px) / self.ring_px;
        DVec2::from_angle(-self.up_azimuth_rad).rotate(DVec2::new(out.x, -out.y))
    }

    /// What decides which of two points of one azimuth hides the other, 0 (centre) to 1 (rim): the nearer is seen.
    pub fn depth_key(&self, p: DVec3) -> f64 {
        (p.truncate() - self.map.centre).length() / self.rim_m
    }

    /// How far, in pixels, ground of a patch may lie from where it is drawn: see [`DeformedMap::error_bound`]. 0 beyond
    /// the rim.
    pub fn patch_error_px(&self, patch: &Patch, error_m: f64, edge_m: f64, rise_m: f64) -> f64 {
        if (patch.centre - self.map.centre).length() - patch.radius_m > self.rim_m {
            return 0.0;
        }
        self.ring_px * self.map.error_bound(patch, error_m, edge_m, rise_m)
    }
}

impl Projection for MapView {
    fn clip_from_world(&self, world: DVec3) -> DVec4 {
        let px = self.px_from_plane(world);
        let [width, height] = self.size_px.map(f64::from);
        DVec4::new(2.0 * px.x / width - 1.0, 1.0 - 2.0 * px.y / height, self.depth_key(world), 1.0)
    }

    fn error_px(&self, error_m: f64, bound: Sphere) -> f64 {
        let patch = Patch {
            centre: bound.centre.truncate(),
            radius_m: bound.radius_m,
            low_m: bound.centre.z - bound.radius_m,
            high_m: bound.centre.z + bound.radius_m,
        };
        self.patch_error_px(&patch, error_m, 0.0, 0.0)
    }
}
