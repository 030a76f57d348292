//! Which part of the globe a tile is: by its path, or else by its header.
//!
//! Based on: Cesium, "Quantized-mesh-1.0 terrain format", 2013 to 2024 (the quadtree of two squares of 180° in longitude
//! and latitude); B. R. Bowring, "Transformation from spatial to geographical coordinates", 1976 (iterated).

use super::bytes::Header;
use crate::IoError;
use crate::dem::tile_from_path;
use crate::tin_file::Notes;
use std::path::Path;

/// Equatorial radius of WGS 84, metres.
pub(super) const SEMI_MAJOR_M: f64 = 6_378_137.0;
const ECCENTRICITY_SQUARED: f64 = 0.006_694_379_990_141_317;

/// Deepest level that is looked for: tiles of 0.2 m.
const MAX_LEVEL: u32 = 26;

/// A tile's centre lies this close to that of its square, in squares, where the encoder says it as it should.
const CENTRED: f64 = 1e-3;

/// A square of the quadtree: level, column from the west and row from the south.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    level: u32,
    column: u32,
    row: u32,
}

impl Rectangle {
    /// The tile that the path says, if the header's centre agrees with it, else the one that the header says.
    pub(super) fn of(name: &Path, header: &Header, notes: &mut Notes) -> Result<Self, IoError> {
        let centre = lon_lat(header.centre_m).ok_or_else(|| {
            IoError::malformed(name, "byte 0", "the tile's centre on the globe", format!("{:?}", header.centre_m))
        })?;
        let of_path = tile_from_path(name).and_then(|[level, column, row]| Self::new(level, column, row));
        if let Some(tile) = of_path {
            let flipped = Self { row: (1 << tile.level) - 1 - tile.row, ..tile };
            if let Some((tile, from)) = [(tile, "south"), (flipped, "north")].into_iter().find(|(t, _)| t.holds(centre))
            {
                notes.say(format!("{tile}, by its path (rows from the {from})"));
                return Ok(tile);
            }
        }
        let levels = (0..=MAX_LEVEL).map(|level| Self::at_level(level, centre));
        let off_centre = |tile: &Self| {
            let [x, y] = tile.within(centre);
            (x - 0.5).abs().max((y - 0.5).abs())
        };
        let nearest = levels.clone().min_by(|a, b| off_centre(a).total_cmp(&off_centre(b)));
        if let Some(tile) = nearest.filter(|tile| off_centre(tile) < CENTRED) {
            notes.say(format!("{tile}, by the centre in its header"));
            return Ok(tile);
        }
        let misfit = |tile: &Self| (tile.radius_m() / header.radius_m).ln().abs();
        let tile =
            levels.min_by(|a, b| misfit(a).total_cmp(&misfit(b))).unwrap_or(Self { level: 0, column: 0, row: 0 });
        notes.say(format!("{tile}, guessed by the centre and the size in its header"));
        Ok(tile)
    }

    fn new(level: u32, column: u32, row: u32) -> Option<Self> {
        (level <= MAX_LEVEL && column >> level < 2 && row >> level == 0).then_some(Self { level, column, row })
    }

    fn size_deg(self) -> f64 {
        180.0 / f64::from(1u32 << self.level)
    }

    fn at_level(level: u32, [lon, lat]: [f64; 2]) -> Self {
        let size = 180.0 / f64::from(1u32 << level);
        let cell = |degrees: f64, most: u32| ((degrees / size).max(0.0) as u32).min(most - 1);
        Self { level, column: cell(lon + 180.0, 2 << level), row: cell(lat + 90.0, 1 << level) }
    }

    /// Where in the tile a place lies: 0 to 1 from west to east and from south to north.
    fn within(self, [lon, lat]: [f64; 2]) -> [f64; 2] {
        let size = self.size_deg();
        [(lon + 180.0) / size - f64::from(self.column), (lat + 90.0) / size - f64::from(self.row)]
    }

    fn holds(self, place: [f64; 2]) -> bool {
        self.within(place).iter().all(|part| (0.0..=1.0).contains(part))
    }

    /// Longitude and latitude in degrees of a place in the tile.
    pub(super) fn at(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let size = self.size_deg();
        [(f64::from(self.column) + x) * size - 180.0, (f64::from(self.row) + y) * size - 90.0]
    }

    /// Half the diagonal, about.
    fn radius_m(self) -> f64 {
        let [_, lat] = self.at([0.5, 0.5]);
        let half = (self.size_deg() / 2.0).to_radians();
        SEMI_MAJOR_M * half.hypot(half * lat.to_radians().cos())
    }
}

impl std::fmt::Display for Rectangle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([west, south], [east, north]) = (self.at([0.0; 2]), self.at([1.0; 2]));
        let Self { level, column, row } = self;
        write!(f, "tile {level}/{column}/{row}: {west} to {east} degrees east, {south} to {north} north")
    }
}

/// Longitude and latitude in degrees of an Earth-centred position.
fn lon_lat([x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
    let from_axis = x.hypot(y);
    let mut lat = z.atan2(from_axis * (1.0 - ECCENTRICITY_SQUARED));
    for _ in 0..8 {
        let normal_m = SEMI_MAJOR_M / (1.0 - ECCENTRICITY_SQUARED * lat.sin().powi(2)).sqrt();
        lat = (z + ECCENTRICITY_SQUARED * normal_m * lat.sin()).atan2(from_axis);
    }
    let place = [y.atan2(x).to_degrees(), lat.to_degrees()];
    let on_globe = (SEMI_MAJOR_M * 0.9..SEMI_MAJOR_M * 1.1).contains(&from_axis.hypot(z));
    (on_globe && place.iter().all(|d| d.is_finite())).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str, centre_m: [f64; 3], radius_m: f64) -> (Rectangle, Vec<String>) {
        let mut notes = Notes::default();
        let header = Header { centre_m, heights_m: [0.0; 2], radius_m };
        let rectangle = Rectangle::of(Path::new(name), &header, &mut notes).unwrap();
        (rectangle, notes.into_lines())
    }

    #[test]
    fn a_tile_is_found_by_path_or_header() {
        let everest = [293_937.300_812_839_24, 5_630_692.723_655_973, 2_971_535.293_617_78];
        let tile = Rectangle { level: 9, column: 759, row: 335 };
        for (name, radius_m, how) in [
            ("a_z9_x759_y335.terrain", 0.0, "by its path (rows from the south)"),
            ("9/759/335.terrain", 0.0, "by its path (rows from the south)"),
            ("9/759/176.terrain", 0.0, "by its path (rows from the north)"),
            ("9/7/335.terrain", 0.0, "by the centre in its header"),
            ("a.terrain", 0.0, "by the centre in its header"),
        ] {
            let (found, notes) = of(name, everest, radius_m);
            assert_eq!(found, tile, "{name}");
            assert!(notes.len() == 1 && notes[0].ends_with(how), "{notes:?}");
        }
        let moved = [everest[0] + 900.0, everest[1], everest[2]];
        let (found, notes) = of("a.terrain", moved, 26_097.8);
        assert_eq!(found, tile);
        assert!(notes[0].contains("guessed"), "{notes:?}");
        assert_eq!(of("a.terrain", [0.0, -6_378_137.0, 0.0], 0.0).0, Rectangle { level: 0, column: 0, row: 0 });
    }
}
