//! The ellipsoid WGS 84: Earth-centred positions, places on it, what its horizon hides.
//!
//! Based on: B. R. Bowring, "Transformation from spatial to geographical coordinates", 1976 (iterated); D. Bagnell,
//! K. Ring, "Computing the horizon occlusion point", 2013.

use glam::{DMat3, DVec3};

/// Equatorial radius, metres.
pub const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// Polar radius, metres.
pub const SEMI_MINOR_M: f64 = 6_356_752.314_245_179;
const ECCENTRICITY_SQUARED: f64 = 0.006_694_379_990_141_317;

/// Earth-centred position of a longitude and latitude in degrees and a height above the ellipsoid in metres.
pub fn ecef_m([lon, lat, height_m]: [f64; 3]) -> DVec3 {
    let ((sin_lon, cos_lon), (sin_lat, cos_lat)) = (lon.to_radians().sin_cos(), lat.to_radians().sin_cos());
    let normal_m = SEMI_MAJOR_M / (1.0 - ECCENTRICITY_SQUARED * sin_lat * sin_lat).sqrt();
    let from_axis = (normal_m + height_m) * cos_lat;
    let z = (normal_m * (1.0 - ECCENTRICITY_SQUARED) + height_m) * sin_lat;
    DVec3::new(from_axis * cos_lon, from_axis * sin_lon, z)
}

/// Longitude and latitude in degrees and height in metres of an Earth-centred position.
pub fn geodetic(p: DVec3) -> [f64; 3] {
    let from_axis = p.x.hypot(p.y);
    let mut lat = p.z.atan2(from_axis * (1.0 - ECCENTRICITY_SQUARED));
    let mut normal_m = SEMI_MAJOR_M;
    for _ in 0..8 {
        normal_m = SEMI_MAJOR_M / (1.0 - ECCENTRICITY_SQUARED * lat.sin().powi(2)).sqrt();
        lat = (p.z + ECCENTRICITY_SQUARED * normal_m * lat.sin()).atan2(from_axis);
    }
    // near the poles the distance from the axis says nothing about the height
    let height = if lat.abs() < 1.0 {
        from_axis / lat.cos() - normal_m
    } else {
        p.z / lat.sin() - normal_m * (1.0 - ECCENTRICITY_SQUARED)
    };
    [p.y.atan2(p.x).to_degrees(), lat.to_degrees(), height]
}

/// Rows east, north and up at a longitude and latitude in degrees: turns Earth-centred differences into local ones.
pub fn local_from_ecef([lon, lat]: [f64; 2]) -> DMat3 {
    let ((sin_lon, cos_lon), (sin_lat, cos_lat)) = (lon.to_radians().sin_cos(), lat.to_radians().sin_cos());
    let east = DVec3::new(-sin_lon, cos_lon, 0.0);
    let north = DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat);
    let up = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
    DMat3::from_cols(east, north, up).transpose()
}

/// Whether a position is near the ground: 12 km below to 100 km above the ellipsoid.
pub fn is_on_earth(p: DVec3) -> bool {
    p.is_finite() && p.length() > 0.5 * SEMI_MINOR_M && (-12e3..100e3).contains(&geodetic(p)[2])
}

/// How far a horizon occlusion point is from doing its work: of all `positions` that may be seen while the point, as seen
/// from any viewer, is hidden behind the ellipsoid, the greatest excess of the magnitude that a position asks for over the
/// point's own, in radii. At most about 0 is right.
pub fn horizon_excess(point: [f64; 3], positions: &[DVec3]) -> f64 {
    let point = DVec3::from(point);
    let magnitude = point.length();
    let direction = point.normalize_or_zero();
    let radii = DVec3::new(SEMI_MAJOR_M, SEMI_MAJOR_M, SEMI_MINOR_M);
    let needed = positions.iter().map(|&p| {
        let scaled = p / radii;
        // what lies below the ellipsoid is hidden like what lies on it
        let length = scaled.length().max(1.0);
        let towards = scaled.normalize_or_zero();
        let (cos_a, sin_a) = (towards.dot(direction), towards.cross(direction).length());
        let (cos_b, sin_b) = (1.0 / length, (length * length - 1.0).max(0.0).sqrt() / length);
        let denominator = cos_a * cos_b - sin_a * sin_b;
        if denominator > 0.0 { 1.0 / denominator } else { f64::INFINITY }
    });
    needed.fold(f64::NEG_INFINITY, f64::max) - magnitude
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn there_and_back(lon in -180.0..180.0f64, lat in -90.0..90.0f64, height in -500.0..9000.0f64) {
            let p = ecef_m([lon, lat, height]);
            let [lon2, lat2, height2] = geodetic(p);
            prop_assert!((lat - lat2).abs() < 1e-9 && (height - height2).abs() < 1e-6, "{lat2} {height2}");
            prop_assert!(p.distance(ecef_m([lon2, lat2, height2])) < 1e-6);
        }
    }

    #[test]
    fn a_horizon_point_must_be_high_enough() {
        let places = [[138.0, 35.0, 3000.0], [138.2, 35.2, 0.0]].map(ecef_m);
        let radii = DVec3::new(SEMI_MAJOR_M, SEMI_MAJOR_M, SEMI_MINOR_M);
        let towards = (ecef_m([138.1, 35.1, 0.0]) / radii).normalize();
        let needed = horizon_excess((towards * 1.0).to_array(), &places) + 1.0;
        assert!(needed > 1.0 && needed < 1.01, "{needed}");
        assert!(horizon_excess((towards * needed).to_array(), &places).abs() < 1e-12);
    }
}
