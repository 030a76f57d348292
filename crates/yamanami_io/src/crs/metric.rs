//! A CRS in metres for longitudes and latitudes: where a surface is wanted, degrees are of no use.

use super::{from_epsg, table};
use yamanami_core::Crs;

/// Beyond so many degrees from every origin a Japanese plane rectangular zone is not for that place.
const MAX_DEGREES_FROM_ORIGIN: f64 = 8.0;

/// The CRS in metres that fits a place (degrees), on the datum of `crs`: the Japanese plane rectangular zone of the nearest
/// origin for JGD2011 and JGD2000, the national grid of New Zealand, the UTM zone of the datum; that of WGS 84 where the
/// datum has none. A CRS that is projected in metres already comes back as it is.
pub fn metric_crs_at(crs: &Crs, lon: f64, lat: f64) -> Crs {
    if !crs.geographic && !crs.web_mercator {
        return crs.clone();
    }
    let zone = utm_zone(lon);
    let epsg = match crs.epsg.unwrap_or_default() {
        6667 | 6668 | 6697 => japan_zone(lon, lat).map(|index| 6669 + index),
        4612 => japan_zone(lon, lat).map(|index| 2443 + index),
        4301 => (51..=55).contains(&zone).then(|| 3092 + zone - 51),
        4167 => (166.0..180.0).contains(&lon).then_some(2193),
        4258 => (28..=38).contains(&zone).then_some(25800 + zone),
        4267 => (1..=22).contains(&zone).then_some(26700 + zone),
        4269 | 4617 => (1..=23).contains(&zone).then_some(26900 + zone),
        6318 => match zone {
            1..=19 => Some(6329 + zone),
            59..=60 => Some(6328 + zone - 59),
            _ => None,
        },
        4283 => (48..=58).contains(&zone).then_some(28300 + zone),
        7844 => (46..=59).contains(&zone).then_some(7800 + zone),
        4322 if lat >= 0.0 => Some(32200 + zone),
        _ => None,
    };
    let wgs84 = zone + if lat < 0.0 { 32700 } else { 32600 };
    epsg.and_then(from_epsg).or_else(|| from_epsg(wgs84)).unwrap_or_default()
}

/// UTM zone of a longitude, 1 to 60.
fn utm_zone(lon: f64) -> u32 {
    let turned = (lon + 180.0).rem_euclid(360.0);
    ((turned / 6.0) as u32 + 1).min(60)
}

/// Index of the plane rectangular zone whose origin is nearest.
fn japan_zone(lon: f64, lat: f64) -> Option<u32> {
    let squeeze = lat.to_radians().cos();
    let distance = |[origin_lat, origin_lon]: [f64; 2]| ((lon - origin_lon) * squeeze).hypot(lat - origin_lat);
    let distances = table::japan_plane_rectangular_origins().map(distance);
    let (index, nearest) = (0..).zip(distances).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (nearest < MAX_DEGREES_FROM_ORIGIN).then_some(index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_zone_of_a_place() {
        for (from, lon, lat, to) in [
            (6697, 139.69, 35.2, 6677),
            (6668, 127.68, 26.21, 6683),
            (4612, 141.35, 43.07, 2454),
            (6668, 2.35, 48.85, 32631),
            (4326, 86.9, 28.0, 32645),
            (4326, 18.4, -33.9, 32734),
            (4326, 180.0, 10.0, 32601),
            (4258, 11.0, 49.0, 25832),
            (4269, -71.3, 44.3, 26919),
            (6318, -118.0, 34.0, 6340),
            (6318, 172.9, 52.9, 6328),
            (7844, 147.3, -42.9, 7855),
            (4167, 174.8, -36.8, 2193),
            (3857, 138.7, 35.4, 32654),
        ] {
            let crs = metric_crs_at(&from_epsg(from).unwrap(), lon, lat);
            assert_eq!(crs.epsg, Some(to), "EPSG:{from} at {lon}, {lat}");
            assert!(super::super::from_lon_lat(&crs, lon, lat).is_some());
        }
        let zone = from_epsg(6677).unwrap();
        assert_eq!(metric_crs_at(&zone, 0.0, 0.0), zone);
        metric_crs_at(&from_epsg(4326).unwrap(), f64::NAN, f64::INFINITY);
    }
}
