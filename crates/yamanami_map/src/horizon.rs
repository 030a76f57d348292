//! What hides what: along each azimuth ground is hidden by nearer ground that stands at a greater angle.
//!
//! Based on: the deformed map of Hori et al., where every azimuth has its own eye above the ring, so that one camera's
//! depth buffer decides nothing; Wang, Robinson, White, "Generating viewsheds without using sightlines", 2000 (the
//! running maximum outward).

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use yamanami_core::{Curvature, DeformedMap, EARTH_RADIUS_M, NestedField};

/// Samples of the ground along a sight line stand this share of the grid's spacing apart.
const STRIDE: f64 = 0.7;

/// A greatest height hides only what lies at least this many grid spacings behind it: a summit does not hide itself.
const OWN_SLOPE: f64 = 1.5;

/// From where one looks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SeenFrom {
    /// From the eyes above the ring: hidden is what the picture does not show.
    #[default]
    Picture,
    /// From the centre, this many metres above the ground: hidden is what nobody there sees.
    Ground {
        /// Height of the viewer's eye above the ground, metres.
        eye_above_m: f64,
    },
}

/// Sight lines over a field: tells whether a place is seen.
#[derive(Debug, Clone, Copy)]
pub struct Sightline<'a> {
    field: &'a NestedField,
    map: DeformedMap,
    from: SeenFrom,
    eye_m: f64,
}

impl<'a> Sightline<'a> {
    /// Sight lines of a map over a field.
    pub fn new(field: &'a NestedField, map: DeformedMap, from: SeenFrom) -> Self {
        let eye_m = match from {
            SeenFrom::Picture => map.eye_m,
            SeenFrom::Ground { eye_above_m } => field.height_m(map.centre) + eye_above_m,
        };
        Self { field, map, from, eye_m }
    }

    /// How high ground appears at a distance from the centre: any measure that grows with the angle of sight.
    fn rises(&self, r_m: f64, z_m: f64) -> f64 {
        match self.from {
            SeenFrom::Picture => self.map.half_tangent(r_m, z_m),
            SeenFrom::Ground { .. } => {
                let k = self.map.curvature.map_or(1.0, |Curvature { refraction, .. }| refraction);
                (z_m - (1.0 - k) * r_m * r_m / (2.0 * EARTH_RADIUS_M) - self.eye_m) / r_m
            }
        }
    }

    /// From where on ground can hide something.
    fn start_m(&self) -> f64 {
        match self.from {
            SeenFrom::Picture => self.map.ring_m,
            SeenFrom::Ground { .. } => 0.0,
        }
    }

    /// Whether nothing nearer hides a point. `z_m` of the point counts, not the field's height there.
    pub fn sees(&self, p: DVec3) -> bool {
        let out = p.truncate() - self.map.centre;
        let r_m = out.length();
        let own_m = OWN_SLOPE * self.field.level_at(p.truncate()).spacing_m();
        if r_m - own_m <= self.start_m() {
            return true;
        }
        let (towards, angle) = (out / r_m, self.rises(r_m, p.z));
        let mut at_m = self.start_m();
        loop {
            let place = self.map.centre + at_m * towards;
            let level = self.field.level_at(place);
            at_m += STRIDE * level.spacing_m();
            if at_m >= r_m - own_m {
                return true;
            }
            let place = self.map.centre + at_m * towards;
            if self.rises(at_m, self.field.height_m(place)) > angle {
                return false;
            }
        }
    }
}

/// The running maximum of [`DeformedMap::half_tangent`] outward, for all azimuths: a table to look many points up in.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonTable {
    /// Rows of the table: azimuths, clockwise from north, the whole circle.
    pub azimuth_count: usize,
    /// Metres between the entries of a row, which begin at the centre.
    pub step_m: f64,
    /// The greatest half tangent of the ground up to each distance, azimuth by azimuth.
    pub half_tangents: Vec<f32>,
}

impl HorizonTable {
    /// Works the table out to the rim.
    pub fn new(field: &NestedField, map: &DeformedMap, rim_m: f64, azimuth_count: usize, step_m: f64) -> Self {
        let columns = (rim_m / step_m).ceil() as usize + 1;
        let mut half_tangents = vec![0f32; azimuth_count * columns];
        half_tangents.par_chunks_mut(columns).enumerate().for_each(|(row, out)| {
            let (sin, cos) = (row as f64 * std::f64::consts::TAU / azimuth_count as f64).sin_cos();
            let towards = DVec2::new(sin, cos);
            let (mut greatest, mut at_m) = (0f64, map.ring_m);
            for (column, out) in out.iter_mut().enumerate() {
                while at_m <= (column as f64 * step_m).min(rim_m) {
                    let place = map.centre + at_m * towards;
                    let level = field.level_at(place);
                    greatest = greatest.max(map.half_tangent(at_m, level.height_m(place)));
                    at_m += STRIDE * level.spacing_m();
                }
                *out = greatest as f32;
            }
        });
        Self { azimuth_count, step_m, half_tangents }
    }

    /// The greatest half tangent of ground nearer than a distance, along the nearest azimuth of the table.
    pub fn before(&self, out: DVec2, r_m: f64) -> f64 {
        let turn = out.x.atan2(out.y) / std::f64::consts::TAU;
        let row = (turn.rem_euclid(1.0) * self.azimuth_count as f64).round() as usize % self.azimuth_count;
        let columns = self.half_tangents.len() / self.azimuth_count;
        f64::from(self.half_tangents[row * columns + ((r_m / self.step_m) as usize).min(columns - 1)])
    }

    /// Whether a point that rises `slack_m` above itself would be seen: for lines that lie on the ground.
    pub fn sees(&self, map: &DeformedMap, p: DVec3, slack_m: f64) -> bool {
        let out = p.truncate() - map.centre;
        let r_m = out.length();
        map.half_tangent(r_m, p.z + slack_m) >= self.before(out, r_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::{DropFrom, FieldLevel};

    /// A plain with a wall of this height 30 km east, and a hill behind it.
    fn walled(wall_m: f32) -> NestedField {
        let empty = FieldLevel::new(500.0, 160, vec![0.0; 321 * 321]);
        let heights = (0..321 * 321)
            .map(|k| match empty.plane_from_grid(k % 321, k / 321) {
                p if (p.x - 30_000.0).abs() < 600.0 => wall_m,
                p if (p - DVec2::new(50_000.0, 0.0)).length() < 2000.0 => 1000.0,
                _ => 0.0,
            })
            .collect();
        NestedField::new(vec![FieldLevel::new(500.0, 160, heights)])
    }

    #[test]
    fn a_wall_hides_what_lies_below_the_line_over_its_top() {
        let map = DeformedMap { eye_m: 3000.0, scale: 0.6, ..DeformedMap::default() };
        let hill = DVec3::new(50_000.0, 0.0, 1000.0);
        let other = DVec3::new(-50_000.0, 0.0, 1000.0);
        // the line from 3,000 m above the ring at 10 km to 1,000 m at 50 km passes 30 km at 2,000 m
        for (wall_m, is_seen) in [(1900.0, true), (2100.0, false)] {
            let field = walled(wall_m);
            let sight = Sightline::new(&field, map, SeenFrom::Picture);
            assert_eq!(sight.sees(hill), is_seen, "wall of {wall_m} m");
            assert!(sight.sees(other), "the west has no wall");
            let table = HorizonTable::new(&field, &map, 70_000.0, 720, 250.0);
            assert_eq!(table.sees(&map, hill, 0.0), is_seen);
            assert!(table.sees(&map, other, 0.0));
            assert!(!table.sees(&map, DVec3::new(33_000.0, 0.0, 0.0), 5.0), "the foot behind the wall");
        }
        let field = walled(500.0);
        let viewer = |eye_above_m| Sightline::new(&field, map, SeenFrom::Ground { eye_above_m });
        let edge = DVec3::new(48_500.0, 0.0, 1000.0);
        assert!(viewer(2.0).sees(edge) && !viewer(2.0).sees(edge.with_z(800.0)));
    }

    #[test]
    fn the_curved_earth_hides_the_foot_of_far_mountains() {
        let flat = NestedField::new(vec![FieldLevel::new(1000.0, 180, vec![0.0; 361 * 361])]);
        let curved = DeformedMap {
            curvature: Some(Curvature { refraction: 0.13, from: DropFrom::Centre }),
            ..DeformedMap::default()
        };
        let from_beach = Sightline::new(&flat, curved, SeenFrom::Ground { eye_above_m: 10.0 });
        let at = |z: f64| DVec3::new(0.0, 160_000.0, z);
        // the dip from 10 m is reached at 12.1 km; 148 km on, 1,494 m are hidden
        assert!(from_beach.sees(at(1550.0)) && !from_beach.sees(at(1450.0)));
        let in_picture = Sightline::new(&flat, curved, SeenFrom::Picture);
        assert!(in_picture.sees(at(0.0)));
    }
}
