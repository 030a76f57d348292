//! Longitudes and latitudes of coordinates in the system of their file.

use crate::{IoError, crs};
use glam::DVec2;
use std::path::Path;
use yamanami_core::Crs;

/// Longitudes may run on beyond the antimeridian.
const MOST_LONGITUDE: f64 = 360.0;

/// Converts the coordinates of a file.
pub(super) struct Locator<'a> {
    crs: Option<&'a Crs>,
}

impl<'a> Locator<'a> {
    /// For a stated CRS; without one coordinates are taken as degrees.
    pub(super) fn new(label: &Path, crs: Option<&'a Crs>) -> Result<Self, IoError> {
        match crs {
            Some(stated) if !crs::is_known(stated) => {
                let what = format!("its coordinate reference system, '{}'", stated.name);
                Err(IoError::unsupported(label, what, "convert it to longitude and latitude (EPSG:4326)"))
            }
            crs => Ok(Self { crs }),
        }
    }

    /// Longitude and latitude, or why there are none.
    pub(super) fn lon_lat(&self, p: DVec2) -> Result<DVec2, String> {
        let lon_lat = match self.crs {
            Some(stated) => crs::to_lon_lat(stated, p.x, p.y).map(DVec2::from),
            None => Some(p),
        };
        let is_place = |p: &DVec2| p.x.abs() <= MOST_LONGITUDE && p.y.abs() <= 90.0;
        lon_lat.filter(is_place).ok_or_else(|| match self.crs {
            Some(stated) => format!("{}, {}, which is no place in '{}'", p.x, p.y, stated.name),
            None => format!("{}, {}, which is no longitude and latitude, and no coordinate system is stated", p.x, p.y),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn systems_known_and_not() {
        let path = Path::new("a.shp");
        let utm = crs::from_epsg(32654).unwrap();
        let at = Locator::new(path, Some(&utm)).unwrap().lon_lat(DVec2::new(293_517.347, 3_915_404.017)).unwrap();
        assert!((at - DVec2::new(138.7274, 35.3606)).length() < 1e-7);
        let strange = Crs { name: "Lambert of Oz".to_owned(), ..Crs::default() };
        assert!(Locator::new(path, Some(&strange)).is_err_and(|e| e.to_string().contains("Lambert of Oz")));
        let bare = Locator::new(path, None).unwrap();
        assert!(bare.lon_lat(DVec2::new(138.0, 35.0)).is_ok() && bare.lon_lat(DVec2::new(35e4, 35.0)).is_err());
        assert!(bare.lon_lat(DVec2::NAN).is_err());
    }
}
