//! Places on the ellipsoid WGS 84 as Earth-centred, Earth-fixed metres, and the level frame at a place: metres east, north
//! and up, in which tiles of 3D Tiles are.
//!
//! Based on: Bowring, "Transformation from spatial to geographical coordinates", Survey Review, 1976 (the way back, here
//! iterated); NIMA TR8350.2 (the ellipsoid).

use glam::{DMat3, DVec3};

const SEMI_MAJOR_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
const SEMI_MINOR_M: f64 = SEMI_MAJOR_M * (1.0 - FLATTENING);
const ECCENTRICITY_SQUARED: f64 = FLATTENING * (2.0 - FLATTENING);
const SECOND_ECCENTRICITY_SQUARED: f64 = ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED);

/// Earth-centred metres of a longitude and latitude (radians) and a height above the ellipsoid (metres).
pub fn ecef_from_geographic([longitude, latitude, height_m]: [f64; 3]) -> DVec3 {
    let (sin, cos) = latitude.sin_cos();
    let prime_vertical_m = SEMI_MAJOR_M / (1.0 - ECCENTRICITY_SQUARED * sin * sin).sqrt();
    let from_axis_m = (prime_vertical_m + height_m) * cos;
    DVec3::new(
        from_axis_m * longitude.cos(),
        from_axis_m * longitude.sin(),
        (prime_vertical_m * (1.0 - ECCENTRICITY_SQUARED) + height_m) * sin,
    )
}

/// Longitude, latitude (radians) and height above the ellipsoid (metres): the inverse of [`ecef_from_geographic`], to less
/// than a micrometre from 1,000 km below the surface up.
pub fn geographic_from_ecef(place: DVec3) -> [f64; 3] {
    let from_axis_m = place.x.hypot(place.y);
    let mut reduced = (SEMI_MAJOR_M * place.z).atan2(SEMI_MINOR_M * from_axis_m);
    let mut latitude = 0.0;
    for _ in 0..4 {
        let (sin, cos) = reduced.sin_cos();
        latitude = (place.z + SECOND_ECCENTRICITY_SQUARED * SEMI_MINOR_M * sin.powi(3))
            .atan2(from_axis_m - ECCENTRICITY_SQUARED * SEMI_MAJOR_M * cos.powi(3));
        let (sin, cos) = latitude.sin_cos();
        reduced = (SEMI_MINOR_M * sin).atan2(SEMI_MAJOR_M * cos);
    }
    let (sin, cos) = latitude.sin_cos();
    let height_m = from_axis_m * cos + place.z * sin - SEMI_MAJOR_M * (1.0 - ECCENTRICITY_SQUARED * sin * sin).sqrt();
    [place.y.atan2(place.x), latitude, height_m]
}

/// A frame of metres east, north and up at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelFrame {
    origin: DVec3,
    /// East, north and up as columns.
    axes: DMat3,
}

impl LevelFrame {
    /// The frame at a longitude, latitude (radians) and height above the ellipsoid (metres).
    pub fn at(geographic: [f64; 3]) -> Self {
        let (sin_lon, cos_lon) = geographic[0].sin_cos();
        let (sin_lat, cos_lat) = geographic[1].sin_cos();
        let east = DVec3::new(-sin_lon, cos_lon, 0.0);
        let north = DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat);
        let up = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
        Self { origin: ecef_from_geographic(geographic), axes: DMat3::from_cols(east, north, up) }
    }

    /// An Earth-centred place in this frame.
    pub fn local_from_ecef(&self, place: DVec3) -> DVec3 {
        self.axes.transpose() * (place - self.origin)
    }

    /// A place of this frame, Earth-centred.
    pub fn ecef_from_local(&self, place: DVec3) -> DVec3 {
        self.origin + self.axes * place
    }

    /// The matrix of [`Self::ecef_from_local`], column by column, as 3D Tiles have it.
    pub fn transform(&self) -> [f64; 16] {
        let columns = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis, self.origin];
        std::array::from_fn(|k| if k % 4 == 3 { f64::from(u8::from(k == 15)) } else { columns[k / 4][k % 4] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Longitude, latitude (degrees), height, and Earth-centred metres; computed with PROJ 9 (`cs2cs EPSG:4979 EPSG:4978`).
    const KNOWN: [([f64; 3], [f64; 3]); 5] = [
        ([0.0, 0.0, 0.0], [6_378_137.0, 0.0, 0.0]),
        ([0.0, 90.0, 100.0], [0.0, 0.0, 6_356_852.314_245]),
        ([138.7274, 35.3606, 3776.0], [-3_916_073.259_313, 3_437_037.683_922, 3_672_751.026_283]),
        ([-118.1, 34.3, -50.0], [-2_484_369.279_447, -4_652_810.202_655, 3_573_957.866_536]),
        ([18.42, -33.92, 1085.0], [5_027_619.574_856, 1_674_415.832_759, -3_539_691.911_572]),
    ];

    #[test]
    fn places_agree_with_proj() {
        for ([lon, lat, height_m], expected) in KNOWN {
            let geographic = [lon.to_radians(), lat.to_radians(), height_m];
            let place = ecef_from_geographic(geographic);
            assert!(place.distance(DVec3::from_array(expected)) < 1e-9 * SEMI_MAJOR_M, "{lon} {lat} gives {place}");
            let back = geographic_from_ecef(place);
            assert!((back[1] - geographic[1]).abs() < 1e-14 && (back[2] - height_m).abs() < 1e-8, "{back:?}");
        }
    }

    #[test]
    fn a_level_frame_is_level() {
        let at = [2.4, 0.6, 120.0];
        let frame = LevelFrame::at(at);
        assert!(frame.local_from_ecef(ecef_from_geographic(at)).length() < 1e-8);
        let above = frame.local_from_ecef(ecef_from_geographic([2.4, 0.6, 220.0]));
        assert!(above.distance(DVec3::Z * 100.0) < 1e-7, "{above}");
        let east = frame.local_from_ecef(ecef_from_geographic([2.4 + 1e-6, 0.6, 120.0]));
        assert!(east.x > 5.0 && east.y.abs() < 1e-4, "{east}");
        let north = frame.local_from_ecef(ecef_from_geographic([2.4, 0.6 + 1e-6, 120.0]));
        assert!(north.y > 6.0 && north.x.abs() < 1e-7, "{north}");
        let m = frame.transform();
        let p = DVec3::new(3.0, -4.0, 5.0);
        let by_matrix = DVec3::from_array([0, 1, 2].map(|r| m[r] * p.x + m[4 + r] * p.y + m[8 + r] * p.z + m[12 + r]));
        assert!(by_matrix.distance(frame.ecef_from_local(p)) < 1e-8);
        assert_eq!([m[3], m[7], m[11], m[15]], [0.0, 0.0, 0.0, 1.0]);
    }

    proptest! {
        #[test]
        fn there_and_back(lon in -3.1f64..3.1, lat in -1.57f64..1.57, height_m in -1e5..1e6) {
            let [lon2, lat2, height2_m] = geographic_from_ecef(ecef_from_geographic([lon, lat, height_m]));
            prop_assert!((lon - lon2).abs() < 1e-14 && (lat - lat2).abs() < 1e-14);
            prop_assert!((height_m - height2_m).abs() < 1e-7);
        }
    }
}
