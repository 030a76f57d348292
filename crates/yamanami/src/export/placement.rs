//! Where a surface stands on the globe: from the coordinates of its CRS to the level frame of a tileset.
//!
//! Heights count from the ellipsoid there. Maps count them from the geoid; how far that lies above the ellipsoid is added.

use crate::Error;
use glam::DVec3;
use std::path::PathBuf;
use yamanami_core::{Aabb, Crs};
use yamanami_io::crs::{self, Geoid, LevelFrame, ecef_from_geographic};

/// From where heights count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeightKind {
    /// From the ellipsoid, as receivers of satellites measure.
    Ellipsoidal,
    /// From the geoid, the level of the sea, as maps have them.
    Orthometric,
}

/// Which geoid.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum GeoidChoice {
    /// EGM96, within about half a metre.
    #[default]
    Egm96,
    /// An elevation file of its heights above the ellipsoid, by longitude and latitude.
    File(PathBuf),
    /// So many metres above the ellipsoid everywhere.
    Constant(f64),
}

/// The way from a source's coordinates to a tileset's.
#[derive(Debug, Clone)]
pub(super) struct Placement {
    crs: Crs,
    geoid: Option<Geoid>,
    middle_deg: f64,
    frame: LevelFrame,
    /// Metres in the tileset's frame are at most so many times those of the source.
    pub stretch: f64,
}

/// Places looked at along each side of a source.
const LOOKS: u32 = 9;

impl Placement {
    /// Places what lies in a box of a CRS. `None` where nothing is known of the CRS. `notes` hears what was taken for granted.
    pub(super) fn of(
        crs: &Crs,
        bounds: &Aabb,
        heights: Option<HeightKind>,
        geoid: &GeoidChoice,
        notes: &mut Vec<String>,
    ) -> Result<Option<Self>, Error> {
        if !crs::is_known(crs) {
            return Ok(None);
        }
        let centre = bounds.centre();
        let outside = || Error::Request(format!("the source lies outside of what its CRS, {}, is for", crs.name));
        let [middle_deg, latitude_deg] = crs::to_lon_lat(crs, centre.x, centre.y).ok_or_else(outside)?;
        let frame = LevelFrame::at([middle_deg.to_radians(), latitude_deg.to_radians(), 0.0]);
        let mut placement = Self { crs: crs.clone(), geoid: None, middle_deg, frame, stretch: 1.0 };
        let mut region = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for p in looks(bounds) {
            let [lon, lat] = placement.lon_lat_deg(p).ok_or_else(outside)?;
            region = [region[0].min(lon), region[1].min(lat), region[2].max(lon), region[3].max(lat)];
        }
        let stated = crs.name.contains("height").then_some(HeightKind::Orthometric);
        if crs.name.starts_with("NAD27") {
            notes.push("NAD27 is taken for WGS 84: places are off by up to 200 m".to_owned());
        }
        match heights.or(stated) {
            Some(HeightKind::Orthometric) => {
                let model = match geoid {
                    GeoidChoice::Egm96 => Geoid::egm96(region),
                    GeoidChoice::File(path) => Geoid::read(path)?,
                    GeoidChoice::Constant(height_m) => Geoid::constant(*height_m),
                };
                notes.push(format!("heights above sea level became ellipsoidal by the geoid {}", model.name()));
                placement.geoid = Some(model);
            }
            Some(HeightKind::Ellipsoidal) => {}
            None => notes.push(
                "the source does not say from where its heights count: taken as above the ellipsoid; where they are above \
                 the sea, give --heights orthometric"
                    .to_owned(),
            ),
        }
        if let Some(p) = looks(bounds).find(|&p| !placement.local(p).is_finite()) {
            let [lon, lat] = placement.lon_lat_deg(p).unwrap_or_default();
            return Err(Error::Request(format!("the geoid has no height at {lon:.5}, {lat:.5}")));
        }
        placement.stretch = looks(bounds).map(|p| placement.stretch_at(p)).fold(0.0, f64::max);
        Ok(Some(placement))
    }

    /// Whether heights change on the way.
    pub(super) fn has_geoid(&self) -> bool {
        self.geoid.is_some()
    }

    /// Longitude and latitude of a place, degrees.
    pub(super) fn lon_lat_deg(&self, p: DVec3) -> Option<[f64; 2]> {
        let [lon, lat] = crs::to_lon_lat(&self.crs, p.x, p.y)?;
        // beside the middle, also where the antimeridian lies between
        Some([lon - 360.0 * ((lon - self.middle_deg) / 360.0).round(), lat])
    }

    /// Height above the ellipsoid of a height of the source; not a number where the geoid has none.
    pub(super) fn ellipsoidal_m(&self, [lon, lat]: [f64; 2], z: f64) -> f64 {
        z + self.geoid.as_ref().map_or(0.0, |geoid| geoid.height_m(lon, lat).unwrap_or(f64::NAN))
    }

    /// A place in the tileset's frame by degrees and height above the ellipsoid.
    pub(super) fn local_from_geographic(&self, [lon, lat]: [f64; 2], height_m: f64) -> DVec3 {
        self.frame.local_from_ecef(ecef_from_geographic([lon.to_radians(), lat.to_radians(), height_m]))
    }

    /// A vector (east, north, up) at a place in degrees, turned into the tileset's frame.
    pub(super) fn turned_at(&self, [lon, lat]: [f64; 2], direction: [f32; 3]) -> [f32; 3] {
        let there = LevelFrame::at([lon.to_radians(), lat.to_radians(), 0.0]);
        let tip = there.ecef_from_local(DVec3::from_array(direction.map(f64::from)));
        let turned = self.frame.local_from_ecef(tip) - self.frame.local_from_ecef(there.ecef_from_local(DVec3::ZERO));
        turned.normalize_or(DVec3::Z).as_vec3().to_array()
    }

    /// A place in the tileset's frame; not numbers where there is no answer.
    pub(super) fn local(&self, p: DVec3) -> DVec3 {
        let Some(at) = self.lon_lat_deg(p) else { return DVec3::NAN };
        self.local_from_geographic(at, self.ellipsoidal_m(at, p.z))
    }

    /// A unit vector at a place, turned into the tileset's frame.
    pub(super) fn turned(&self, p: DVec3, direction: [f32; 3]) -> [f32; 3] {
        let turned = self.local(p + DVec3::from_array(direction.map(f64::from))) - self.local(p);
        turned.normalize_or(DVec3::Z).as_vec3().to_array()
    }

    /// From the tileset's frame to Earth-centred metres.
    pub(super) fn transform(&self) -> [f64; 16] {
        self.frame.transform()
    }

    /// The longest that a metre of the source gets: axes stay all but square to each other.
    fn stretch_at(&self, p: DVec3) -> f64 {
        let here = self.local(p);
        let longest = DVec3::AXES.into_iter().map(|axis| (self.local(p + axis) - here).length()).fold(0.0, f64::max);
        longest * (1.0 + SHEAR)
    }
}

/// More than axes of a map lean to each other, and than the stretch changes between two looks.
const SHEAR: f64 = 2e-3;

/// Places all over the top of a box.
fn looks(bounds: &Aabb) -> impl Iterator<Item = DVec3> + use<> {
    let (low, size) = (bounds.min, bounds.max - bounds.min);
    (0..LOOKS * LOOKS).map(move |k| {
        let share = |k: u32| f64::from(k) / f64::from(LOOKS - 1);
        low + size * DVec3::new(share(k % LOOKS), share(k / LOOKS), 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_io::crs::{from_epsg, geographic_from_ecef};

    fn placed(epsg: u32, bounds: Aabb, heights: Option<HeightKind>, geoid: &GeoidChoice) -> (Placement, Vec<String>) {
        let mut notes = Vec::new();
        let crs = from_epsg(epsg).unwrap();
        (Placement::of(&crs, &bounds, heights, geoid, &mut notes).unwrap().unwrap(), notes)
    }

    #[test]
    fn a_place_of_a_map_is_found_again_on_the_globe() {
        let bounds = Aabb { min: DVec3::new(290e3, 3_910e3, 600.0), max: DVec3::new(298e3, 3_920e3, 3_776.0) };
        let (placement, notes) = placed(32654, bounds, Some(HeightKind::Orthometric), &GeoidChoice::default());
        assert!(notes[0].contains("EGM96"));
        // the summit of Mount Fuji, 138.7274 35.3606 by PROJ; the geoid lies 41 to 43 m above the ellipsoid there
        let local = placement.local(DVec3::new(293_517.347_02, 3_915_404.016_93, 3776.0));
        let [lon, lat, height_m] = geographic_from_ecef(placement.frame.ecef_from_local(local));
        assert!((lon.to_degrees() - 138.7274).abs() < 1e-9 && (lat.to_degrees() - 35.3606).abs() < 1e-9);
        assert!((3816.5..3819.0).contains(&height_m), "{height_m}");
        // 0.9996 to 1.0001, and a touch for shear
        assert!((0.999..1.004).contains(&placement.stretch), "{}", placement.stretch);
        let up = placement.turned(bounds.centre(), [0.0, 0.0, 1.0]);
        assert!(up[2] > 0.999_99, "{up:?}");
    }

    #[test]
    fn what_is_taken_for_granted_is_said() {
        let bounds = Aabb { min: DVec3::new(-20e3, -30e3, 0.0), max: DVec3::new(-10e3, -20e3, 50.0) };
        let (_, notes) = placed(6677, bounds, None, &GeoidChoice::Egm96);
        assert!(notes[0].contains("--heights orthometric"));
        let (_, notes) = placed(6677, bounds, Some(HeightKind::Ellipsoidal), &GeoidChoice::Egm96);
        assert!(notes.is_empty());
        let (_, notes) = placed(10174, bounds, None, &GeoidChoice::Constant(36.0));
        assert!(notes[0].contains("a constant 36 m"), "{notes:?}");
        let crs = Crs::default();
        assert!(Placement::of(&crs, &bounds, None, &GeoidChoice::Egm96, &mut Vec::new()).unwrap().is_none());
    }
}
