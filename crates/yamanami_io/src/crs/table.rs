//! The list of systems that are known by formula (codes and names of the EPSG registry).

use super::transverse_mercator::{BESSEL, CLARKE_1866, Ellipsoid, GRS80, TransverseMercator, WGS72, WGS84};

/// How a system's coordinates come from longitude and latitude.
#[derive(Debug, Clone, Copy)]
pub(super) enum Projection {
    /// They are longitude and latitude, in degrees.
    LongitudeLatitude,
    /// Spherical Mercator of the web maps.
    WebMercator,
    /// Ellipsoidal transverse Mercator: UTM and the national grids built like it.
    TransverseMercator(TransverseMercator),
}

const GEOGRAPHIC: [(u32, &str); 18] = [
    (4167, "NZGD2000"),
    (4258, "ETRS89"),
    (4267, "NAD27"),
    (4269, "NAD83"),
    (4283, "GDA94"),
    (4301, "Tokyo"),
    (4322, "WGS 72"),
    (4326, "WGS 84"),
    (4490, "China Geodetic Coordinate System 2000"),
    (4612, "JGD2000"),
    (4617, "NAD83(CSRS)"),
    (4979, "WGS 84"),
    (6318, "NAD83(2011)"),
    (6667, "JGD2011"),
    (6668, "JGD2011"),
    (6697, "JGD2011 + JGD2011 (vertical) height"),
    (7844, "GDA2020"),
    (9057, "WGS 84 (G1762)"),
];

/// Latitude and longitude of origin of the Japanese plane rectangular zones I to XIX, in degrees and minutes
/// (Ministry of Land, Infrastructure, Transport and Tourism, notification 9 of 2002).
const JAPAN_PLANE_RECTANGULAR: [(&str, f64, [f64; 2]); 19] = [
    ("I", 33.0, [129.0, 30.0]),
    ("II", 33.0, [131.0, 0.0]),
    ("III", 36.0, [132.0, 10.0]),
    ("IV", 33.0, [133.0, 30.0]),
    ("V", 36.0, [134.0, 20.0]),
    ("VI", 36.0, [136.0, 0.0]),
    ("VII", 36.0, [137.0, 10.0]),
    ("VIII", 36.0, [138.0, 30.0]),
    ("IX", 36.0, [139.0, 50.0]),
    ("X", 40.0, [140.0, 50.0]),
    ("XI", 44.0, [140.0, 15.0]),
    ("XII", 44.0, [142.0, 15.0]),
    ("XIII", 44.0, [144.0, 15.0]),
    ("XIV", 26.0, [142.0, 0.0]),
    ("XV", 26.0, [127.0, 30.0]),
    ("XVI", 26.0, [124.0, 0.0]),
    ("XVII", 26.0, [131.0, 0.0]),
    ("XVIII", 20.0, [136.0, 0.0]),
    ("XIX", 26.0, [154.0, 0.0]),
];

/// Latitude and longitude of origin of the Japanese plane rectangular zones, in degrees.
pub(super) fn japan_plane_rectangular_origins() -> impl Iterator<Item = [f64; 2]> {
    JAPAN_PLANE_RECTANGULAR.iter().map(|(_, lat, [degrees, minutes])| [*lat, degrees + minutes / 60.0])
}

/// Name and projection of a code.
pub(super) fn look_up(epsg: u32) -> Option<(String, Projection)> {
    if let Some((_, name)) = GEOGRAPHIC.iter().find(|(code, _)| *code == epsg) {
        return Some(((*name).to_owned(), Projection::LongitudeLatitude));
    }
    match epsg {
        3857 => Some(("WGS 84 / Pseudo-Mercator".to_owned(), Projection::WebMercator)),
        2193 => {
            let projection = TransverseMercator::new(GRS80, [0.0, 173.0], 0.9996, [1.6e6, 1e7]);
            let name = "NZGD2000 / New Zealand Transverse Mercator 2000".to_owned();
            Some((name, Projection::TransverseMercator(projection)))
        }
        2443..=2461 => Some(japan_plane_rectangular("JGD2000", epsg - 2443, "")),
        6669..=6687 => Some(japan_plane_rectangular("JGD2011", epsg - 6669, "")),
        10162..=10174 => Some(japan_plane_rectangular("JGD2011", epsg - 10162, " + JGD2011 (vertical) height")),
        3097..=3101 => Some(utm("JGD2000", GRS80, epsg - 3097 + 51)),
        6688..=6692 => Some(utm("JGD2011", GRS80, epsg - 6688 + 51)),
        6328..=6329 => Some(utm("NAD83(2011)", GRS80, epsg - 6328 + 59)),
        6330..=6348 => Some(utm("NAD83(2011)", GRS80, epsg - 6330 + 1)),
        25828..=25838 => Some(utm("ETRS89", GRS80, epsg - 25800)),
        26701..=26722 => Some(utm("NAD27", CLARKE_1866, epsg - 26700)),
        26901..=26923 => Some(utm("NAD83", GRS80, epsg - 26900)),
        28348..=28358 => Some(map_grid_of_australia("GDA94", epsg - 28300)),
        7846..=7859 => Some(map_grid_of_australia("GDA2020", epsg - 7800)),
        32201..=32260 => Some(utm("WGS 72", WGS72, epsg - 32200)),
        32601..=32660 => Some(utm("WGS 84", WGS84, epsg - 32600)),
        32701..=32760 => Some(utm_south(format!("WGS 84 / UTM zone {}S", epsg - 32700), WGS84, epsg - 32700)),
        3092..=3096 => Some(utm("Tokyo", BESSEL, epsg - 3092 + 51)),
        _ => None,
    }
}

fn japan_plane_rectangular(datum: &str, index: u32, suffix: &str) -> (String, Projection) {
    let (numeral, lat, [degrees, minutes]) = JAPAN_PLANE_RECTANGULAR[index as usize];
    let projection = TransverseMercator::new(GRS80, [lat, degrees + minutes / 60.0], 0.9999, [0.0, 0.0]);
    (format!("{datum} / Japan Plane Rectangular CS {numeral}{suffix}"), Projection::TransverseMercator(projection))
}

fn central_meridian(zone: u32) -> f64 {
    f64::from(zone) * 6.0 - 183.0
}

fn utm(datum: &str, ellipsoid: Ellipsoid, zone: u32) -> (String, Projection) {
    let projection = TransverseMercator::new(ellipsoid, [0.0, central_meridian(zone)], 0.9996, [5e5, 0.0]);
    (format!("{datum} / UTM zone {zone}N"), Projection::TransverseMercator(projection))
}

fn utm_south(name: String, ellipsoid: Ellipsoid, zone: u32) -> (String, Projection) {
    let projection = TransverseMercator::new(ellipsoid, [0.0, central_meridian(zone)], 0.9996, [5e5, 1e7]);
    (name, Projection::TransverseMercator(projection))
}

fn map_grid_of_australia(datum: &str, zone: u32) -> (String, Projection) {
    utm_south(format!("{datum} / MGA zone {zone}"), GRS80, zone)
}
