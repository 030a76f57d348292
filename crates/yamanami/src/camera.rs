//! Cameras over a terrain.

use crate::Terrain;
use glam::DVec3;
use yamanami_core::View;

/// Vertical field of view where none is given, radians (40°).
pub(crate) const FOV_Y_RAD: f64 = 0.698_131_700_797_731_8;

/// A view of the whole terrain from the south-west, from a third of the way up.
pub fn overview(terrain: &Terrain, viewport_px: [u32; 2]) -> View {
    let [east_m, north_m] = terrain.extent_m();
    let [low, high] = terrain.range_m().map(f64::from);
    let centre = DVec3::new(0.5 * east_m, -0.5 * north_m, low + 0.35 * (high - low));
    let reach = 0.5 * east_m.hypot(north_m);
    let eye = centre + reach * DVec3::new(-0.75, -1.35, 0.0) + DVec3::Z * (0.85 * reach + 0.5 * (high - low));
    View { eye, target: centre - DVec3::Z * 0.05 * reach, fov_y_rad: FOV_Y_RAD, viewport_px }
}

/// A view from a place to a place, both in the source CRS, heights in metres.
pub fn view_between(terrain: &Terrain, eye: [f64; 3], target: [f64; 3], fov_y_rad: f64, viewport_px: [u32; 2]) -> View {
    let local = |p: [f64; 3]| {
        let [x, y] = terrain.geo().local_from_source(p[0], p[1]);
        DVec3::new(x, y, p[2])
    };
    View { eye: local(eye), target: local(target), fov_y_rad, viewport_px }
}
