//! A plane around a place in which every distance and bearing from that place is true.
//!
//! Based on: C. F. F. Karney, "Algorithms for geodesics", 2013 (the geodesics of the ellipsoid, to nanometres). The
//! projection is the azimuthal equidistant one; it is at least as old as al-Bīrūnī.

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use glam::DVec2;

/// The azimuthal equidistant plane around a place, on the ellipsoid of WGS 84 (which GRS 80 equals within 0.1 mm): x
/// east, y north, metres.
#[derive(Debug, Clone, Copy)]
pub struct AzimuthalPlane {
    centre: [f64; 2],
    geodesic: Geodesic,
}

impl AzimuthalPlane {
    /// The plane around a longitude and latitude in degrees; `None` when that is no place.
    pub fn new(lon: f64, lat: f64) -> Option<Self> {
        let is_place = lon.abs() <= 360.0 && lat.abs() <= 90.0;
        is_place.then(|| Self { centre: [lon, lat], geodesic: Geodesic::wgs84() })
    }

    /// Longitude and latitude of the centre in degrees.
    pub fn centre_lon_lat(&self) -> [f64; 2] {
        self.centre
    }

    /// Place in the plane of a longitude and latitude in degrees; not finite when that is no place.
    pub fn to_plane(&self, lon: f64, lat: f64) -> DVec2 {
        if !(lon.is_finite() && lat.abs() <= 90.0) {
            return DVec2::NAN;
        }
        let [lon0, lat0] = self.centre;
        let (distance_m, bearing_deg, _, _): (f64, f64, f64, f64) = self.geodesic.inverse(lat0, lon0, lat, lon);
        let (sin, cos) = bearing_deg.to_radians().sin_cos();
        distance_m * DVec2::new(sin, cos)
    }

    /// Longitude and latitude in degrees of a place in the plane. The longitude is within 180° of the centre's, so that
    /// it does not jump where the count of longitudes does.
    pub fn to_lon_lat(&self, p: DVec2) -> [f64; 2] {
        let [lon0, lat0] = self.centre;
        if !p.is_finite() {
            return [f64::NAN; 2];
        }
        let (lat, lon): (f64, f64) = self.geodesic.direct(lat0, lon0, p.x.atan2(p.y).to_degrees(), p.length());
        [lon0 + turn(lon - lon0), lat]
    }
}

/// An angle in degrees as −180 to 180.
fn turn(degrees: f64) -> f64 {
    degrees - 360.0 * (degrees / 360.0).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn distances_and_bearings_are_those_of_the_geodesy_books() {
        // Karney 2013, section 2: from JFK (40.6° N, 73.8° W) to 51.6° N, 0.5° W
        let plane = AzimuthalPlane::new(-73.8, 40.6).unwrap();
        let p = plane.to_plane(-0.5, 51.6);
        assert!((p.length() - 5_551_759.400_319).abs() < 1e-5, "{}", p.length());
        assert!((p.x.atan2(p.y).to_degrees() - 51.198_882_845_58).abs() < 1e-9);
        // a degree of the meridian at 35° N on GRS 80
        let plane = AzimuthalPlane::new(138.727_4, 34.5).unwrap();
        let p = plane.to_plane(138.727_4, 35.5);
        assert!(p.x.abs() < 1e-6 && (p.y - 110_940.8).abs() < 1.0, "{p}");
    }

    #[test]
    fn what_is_no_place_has_none() {
        assert!(AzimuthalPlane::new(f64::NAN, 0.0).is_none() && AzimuthalPlane::new(0.0, 90.5).is_none());
        let plane = AzimuthalPlane::new(179.9, 0.0).unwrap();
        assert!(!plane.to_plane(0.0, f64::NAN).is_finite() && !plane.to_plane(f64::INFINITY, 0.0).is_finite());
        assert!(plane.to_lon_lat(DVec2::NAN)[0].is_nan());
        let [lon, _] = plane.to_lon_lat(DVec2::new(50e3, 0.0));
        assert!(lon > 180.0, "east of the antimeridian longitudes run on: {lon}");
        assert_eq!(AzimuthalPlane::new(10.0, 90.0).unwrap().to_lon_lat(DVec2::ZERO)[1], 90.0);
    }

    proptest! {
        #[test]
        fn there_and_back(lon in -180.0..180.0, lat in -89.0..89.0, x in -1e6..1e6, y in -1e6..1e6) {
            let plane = AzimuthalPlane::new(lon, lat).unwrap();
            let p = DVec2::new(x, y);
            let [lon2, lat2] = plane.to_lon_lat(p);
            prop_assert!((plane.to_plane(lon2, lat2) - p).length() < 1e-6);
        }
    }
}
