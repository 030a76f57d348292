//! What is under the cursor, in words.

use super::stage::Stage;
use glam::DVec3;
use yamanami::core::MapView;
use yamanami::io::crs::AzimuthalPlane;

/// Bearings by name.
const BEARINGS: [&str; 8] = ["N", "NE", "E", "SE", "S", "SW", "W", "NW"];

/// A place of the ground.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Picked {
    /// Longitude and latitude, degrees.
    pub(super) lon_lat: [f64; 2],
    /// Height, metres.
    pub(super) height_m: f64,
    /// The named summit beside it.
    pub(super) name: Option<String>,
}

impl Picked {
    /// A place of the shown ground.
    pub(super) fn new(stage: &Stage, place: DVec3, name: Option<String>) -> Self {
        Self { lon_lat: stage.plane.to_lon_lat(place.truncate()), height_m: place.z, name }
    }

    /// Where it lies in the plane of the shown ground.
    pub(super) fn place(&self, plane: &AzimuthalPlane) -> DVec3 {
        let [lon, lat] = self.lon_lat;
        plane.to_plane(lon, lat).extend(self.height_m)
    }

    /// Height, distance and bearing from the map's centre, place and name.
    pub(super) fn in_words(&self, stage: &Stage, view: &MapView) -> String {
        let [lon, lat] = self.lon_lat;
        let [lon0, lat0] = stage.plane.to_lon_lat(view.map.centre);
        // a plane around the map's own centre, so that both are true
        let way = AzimuthalPlane::new(lon0, lat0).map_or(glam::DVec2::NAN, |plane| plane.to_plane(lon, lat));
        let bearing_deg = way.x.atan2(way.y).to_degrees().rem_euclid(360.0);
        let name = self.name.as_ref().map(|name| format!("{name}   ground ")).unwrap_or_default();
        format!(
            "{name}{:.0} m   {:.1} km {} ({bearing_deg:.0}°)   {lat:.5}, {lon:.5}",
            self.height_m,
            way.length() / 1e3,
            BEARINGS[(bearing_deg / 45.0).round() as usize % 8],
        )
    }
}
