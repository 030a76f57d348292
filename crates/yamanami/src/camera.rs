//! Cameras over a terrain.

use crate::Terrain;
use glam::DVec3;
use yamanami_core::{Perspective, Projection, View};

/// Vertical field of view where none is given, radians (40°).
pub(crate) const FOV_Y_RAD: f64 = 0.698_131_700_797_731_8;

/// A view of the whole terrain from the south-west and above, as near as it fits the picture.
pub fn overview(terrain: &Terrain, viewport_px: [u32; 2]) -> View {
    let [east_m, north_m] = terrain.extent_m();
    let [low, high] = terrain.range_m().map(f64::from);
    let centre = DVec3::new(0.5 * east_m, -0.5 * north_m, 0.5 * (low + high));
    let corners: Vec<DVec3> = (0..8)
        .map(|i| {
            let side = |bit: i32, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
            DVec3::new(side(0, 0.0, east_m), side(1, 0.0, -north_m), side(2, low, high))
        })
        .collect();
    let direction = DVec3::new(-0.45, -0.95, 0.62).normalize();
    let fits = |distance_m: f64| {
        let view = View { eye: centre + distance_m * direction, target: centre, fov_y_rad: FOV_Y_RAD, viewport_px };
        let projection = Perspective::new(view, 1.0, 1e9);
        let inside = corners.iter().all(|&corner| {
            let clip = projection.clip_from_world(corner);
            clip.w > 0.0 && clip.x.abs() < 0.95 * clip.w && clip.y.abs() < 0.9 * clip.w
        });
        inside.then_some(view)
    };
    let mut distance_m = 0.1 * east_m.hypot(north_m).max(high - low).max(1.0);
    loop {
        if let Some(view) = fits(distance_m) {
            return view;
        }
        distance_m *= 1.03;
    }
}

/// A view from a place to a place, both in the source CRS, heights in metres.
pub fn view_between(terrain: &Terrain, eye: [f64; 3], target: [f64; 3], fov_y_rad: f64, viewport_px: [u32; 2]) -> View {
    let local = |p: [f64; 3]| {
        let [x, y] = terrain.geo().local_from_source(p[0], p[1]);
        DVec3::new(x, y, p[2])
    };
    View { eye: local(eye), target: local(target), fov_y_rad, viewport_px }
}
