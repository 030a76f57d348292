//! What a tile's header says of its place in space: centre, bounding sphere, and the point that tells whether the globe
//! hides the tile.
//!
//! Based on: K. Ring, "Computing the horizon occlusion point", Cesium, 2013.

use crate::crs::ecef_from_geographic;
use glam::DVec3;

/// Radii of WGS 84, metres.
const RADII_M: DVec3 = DVec3::new(6_378_137.0, 6_378_137.0, 6_356_752.314_245_179);

/// Places looked at along each side of a tile, at both its heights.
const LOOKS: u32 = 8;

/// Between the places that are looked at a tile bulges no further.
const MARGIN: f64 = 1.0 + 1e-4;

/// A point so many radii out is hidden by no horizon that would not hide half the globe.
const FAR_RADII: f64 = 100.0;

/// A tile in space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub(super) centre_m: DVec3,
    pub(super) radius_m: f64,
    /// In radii of the ellipsoid.
    pub(super) horizon: DVec3,
}

impl Bounds {
    /// Of all between two heights over a rectangle (west, south, east, north; degrees).
    pub(super) fn of([west, south, east, north]: [f64; 4], [low_m, high_m]: [f64; 2]) -> Self {
        let at = |lon: f64, lat: f64, z: f64| ecef_from_geographic([lon.to_radians(), lat.to_radians(), z]);
        let centre_m = at(0.5 * (west + east), 0.5 * (south + north), 0.5 * (low_m + high_m));
        let towards = (centre_m / RADII_M).normalize();
        let (mut radius_m, mut reach) = (0f64, 0f64);
        for k in 0..(LOOKS + 1) * (LOOKS + 1) {
            let share = |k: u32| f64::from(k) / f64::from(LOOKS);
            let (lon, lat) =
                (west + (east - west) * share(k % (LOOKS + 1)), south + (north - south) * share(k / (LOOKS + 1)));
            for z in [low_m, high_m] {
                let p = at(lon, lat, z);
                radius_m = radius_m.max(p.distance(centre_m));
                reach = reach.max(magnitude(p / RADII_M, towards));
            }
        }
        Self { centre_m, radius_m: radius_m * MARGIN, horizon: towards * (reach * MARGIN).min(FAR_RADII) }
    }
}

/// How far out along a direction a point is hidden only when a place is.
fn magnitude(place: DVec3, towards: DVec3) -> f64 {
    let squared = place.length_squared().max(1.0);
    let length = squared.sqrt();
    let direction = place / place.length();
    let (cos_a, sin_a) = (direction.dot(towards), direction.cross(towards).length());
    let (cos_b, sin_b) = (1.0 / length, (squared - 1.0).sqrt() / length);
    let cos = cos_a * cos_b - sin_a * sin_b;
    if cos > 1.0 / FAR_RADII { 1.0 / cos } else { FAR_RADII }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_lies_in_its_sphere_and_below_its_horizon_point() {
        for rectangle in [
            [-180.0, -90.0, 0.0, 90.0],
            [0.0, 0.0, 90.0, 90.0],
            [138.0, 35.0, 138.7, 35.7],
            [1.0, 42.0, 1.01, 42.01],
        ] {
            let bounds = Bounds::of(rectangle, [-100.0, 3800.0]);
            let [west, south, east, north] = rectangle;
            for k in 0..37 * 37 {
                let share = |k: i32| f64::from(k) / 36.0;
                let (lon, lat) = (west + (east - west) * share(k % 37), south + (north - south) * share(k / 37));
                for z in [-100.0, 2000.0, 3800.0] {
                    let p = ecef_from_geographic([lon.to_radians(), lat.to_radians(), z]);
                    assert!(p.distance(bounds.centre_m) <= bounds.radius_m, "{rectangle:?}");
                    let towards = bounds.horizon.normalize();
                    assert!(magnitude(p / RADII_M, towards) <= bounds.horizon.length() * (1.0 + 1e-9), "{rectangle:?}");
                }
            }
        }
    }
}
