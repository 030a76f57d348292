//! Coordinate reference systems by EPSG code: names, and the way between projected coordinates and longitude/latitude.
//!
//! The engine keeps every grid in the CRS of its file, so only a few systems need to be known by formula: those that
//! elevation data of Japan and of world-wide products come in. Conversions stay within a system's own datum.

mod azimuthal;
mod ecef;
#[cfg(feature = "files")]
mod geoid;
mod metric;
mod table;
mod transverse_mercator;
mod warp;
mod well_known;

pub use azimuthal::AzimuthalPlane;
pub use ecef::{LevelFrame, ecef_from_geographic, geographic_from_ecef};
#[cfg(feature = "files")]
pub use geoid::Geoid;
pub use metric::metric_crs_at;
use table::Projection;
pub use warp::GridWarp;
pub use well_known::well_known_text;
use yamanami_core::Crs;

/// Sphere radius of Web Mercator, metres.
const WEB_MERCATOR_RADIUS_M: f64 = 6_378_137.0;

/// The CRS of an EPSG code: geographic, UTM (WGS 84, JGD2000, JGD2011, NAD27, NAD83, ETRS89, GDA), Web Mercator, the 19
/// Japanese plane rectangular zones, New Zealand Transverse Mercator. `None` when the code is not in this list.
pub fn from_epsg(epsg: u32) -> Option<Crs> {
    let (name, projection) = table::look_up(epsg)?;
    Some(Crs {
        epsg: Some(epsg),
        geographic: matches!(projection, Projection::LongitudeLatitude),
        web_mercator: matches!(projection, Projection::WebMercator),
        name,
    })
}

/// Longitude and latitude in degrees of a position in `crs`; `None` when the CRS is not known by formula or the
/// position lies outside of it.
pub fn to_lon_lat(crs: &Crs, x: f64, y: f64) -> Option<[f64; 2]> {
    let lon_lat = match projection(crs)? {
        Projection::LongitudeLatitude => [x, y],
        Projection::WebMercator => [
            (x / WEB_MERCATOR_RADIUS_M).to_degrees(),
            (y / WEB_MERCATOR_RADIUS_M).sinh().atan().to_degrees(),
        ],
        Projection::TransverseMercator(projection) => projection.to_lon_lat(x, y),
    };
    let [lon, lat] = lon_lat;
    (lon.is_finite() && lat.abs() <= 90.0).then_some(lon_lat)
}

/// Position in `crs` of a longitude and latitude in degrees: the inverse of [`to_lon_lat`].
pub fn from_lon_lat(crs: &Crs, lon: f64, lat: f64) -> Option<[f64; 2]> {
    if !lon.is_finite() || !(-90.0..=90.0).contains(&lat) {
        return None;
    }
    let position = match projection(crs)? {
        Projection::LongitudeLatitude => [lon, lat],
        Projection::WebMercator => [
            WEB_MERCATOR_RADIUS_M * lon.to_radians(),
            WEB_MERCATOR_RADIUS_M * lat.to_radians().tan().asinh(),
        ],
        Projection::TransverseMercator(projection) => projection.position(lon, lat)?,
    };
    position.iter().all(|v| v.is_finite()).then_some(position)
}

/// Whether positions in `crs` can be converted to longitude and latitude.
pub fn is_known(crs: &Crs) -> bool {
    projection(crs).is_some()
}

/// How far it is round the Earth in x, in units of the CRS, where x runs all the way round.
pub fn way_round(crs: &Crs) -> Option<f64> {
    match projection(crs)? {
        Projection::LongitudeLatitude => Some(360.0),
        Projection::WebMercator => Some(std::f64::consts::TAU * WEB_MERCATOR_RADIUS_M),
        Projection::TransverseMercator(_) => None,
    }
}

fn projection(crs: &Crs) -> Option<Projection> {
    if crs.geographic {
        return Some(Projection::LongitudeLatitude);
    }
    if crs.web_mercator {
        return Some(Projection::WebMercator);
    }
    table::look_up(crs.epsg?).map(|(_, projection)| projection)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// EPSG, longitude, latitude, x, y; computed with PROJ 9.
    const KNOWN: [(u32, f64, f64, f64, f64); 12] = [
        (6677, 139.7671, 35.6812, -5995.18517, -35367.23013),
        (6680, 141.3544, 43.0686, -72939.70638, -103081.83021),
        (6683, 127.6809, 26.2124, 18076.81195, 23541.9675),
        (32654, 138.7274, 35.3606, 293517.34702, 3915404.01693),
        (32733, 18.42, -33.92, 816196.7118, 6241444.31444),
        (2193, 174.7633, -36.8485, 1757209.25348, 5920482.80889),
        (26919, -71.3033, 44.2706, 316174.99989, 4904508.42523),
        (3857, 138.7274, 35.3606, 15443063.52707, 4212993.86452),
        (2451, 139.0, 36.5, -74652.56138, 55799.20954),
        (25832, 11.0, 49.0, 646280.94612, 5429382.98399),
        (26711, -118.0, 34.0, 407648.31688, 3762412.21918),
        (7855, 147.3, -42.9, 524492.13097, 5250246.28837),
    ];

    #[test]
    fn projected_positions_agree_with_proj() {
        for (epsg, lon, lat, x, y) in KNOWN {
            let crs = from_epsg(epsg).unwrap();
            let [px, py] = from_lon_lat(&crs, lon, lat).unwrap();
            assert!((px - x).abs() < 2e-5 && (py - y).abs() < 2e-5, "EPSG:{epsg} gives {px}, {py}");
            let [plon, plat] = to_lon_lat(&crs, x, y).unwrap();
            assert!((plon - lon).abs() < 1e-9 && (plat - lat).abs() < 1e-9, "EPSG:{epsg} gives {plon}, {plat}");
        }
    }

    #[test]
    fn codes_have_their_registered_names() {
        for (epsg, name) in [
            (4326, "WGS 84"),
            (4612, "JGD2000"),
            (6668, "JGD2011"),
            (6677, "JGD2011 / Japan Plane Rectangular CS IX"),
            (6687, "JGD2011 / Japan Plane Rectangular CS XIX"),
            (2443, "JGD2000 / Japan Plane Rectangular CS I"),
            (10174, "JGD2011 / Japan Plane Rectangular CS XIII + JGD2011 (vertical) height"),
            (32654, "WGS 84 / UTM zone 54N"),
            (32760, "WGS 84 / UTM zone 60S"),
            (6692, "JGD2011 / UTM zone 55N"),
            (3097, "JGD2000 / UTM zone 51N"),
            (6329, "NAD83(2011) / UTM zone 60N"),
            (6330, "NAD83(2011) / UTM zone 1N"),
            (28348, "GDA94 / MGA zone 48"),
            (3857, "WGS 84 / Pseudo-Mercator"),
        ] {
            assert_eq!(from_epsg(epsg).unwrap().name, name);
        }
        assert_eq!(from_epsg(32600), None);
        assert_eq!(from_epsg(6693), None);
        assert!(from_epsg(6697).unwrap().geographic);
    }

    #[test]
    fn positions_that_do_not_exist_have_no_answer() {
        let utm = from_epsg(32654).unwrap();
        assert_eq!(from_lon_lat(&utm, f64::NAN, 0.0), None);
        assert_eq!(from_lon_lat(&utm, 141.0, 91.0), None);
        assert_eq!(to_lon_lat(&utm, f64::INFINITY, 0.0), None);
        assert_eq!(to_lon_lat(&Crs::default(), 1.0, 2.0), None);
    }

    proptest! {
        #[test]
        fn there_and_back(zone in 6669u32..6688, x in -130e3..130e3, y in -300e3..300e3) {
            let crs = from_epsg(zone).unwrap();
            let [lon, lat] = to_lon_lat(&crs, x, y).unwrap();
            let [x2, y2] = from_lon_lat(&crs, lon, lat).unwrap();
            prop_assert!((x - x2).abs() < 1e-6 && (y - y2).abs() < 1e-6);
        }
    }
}
