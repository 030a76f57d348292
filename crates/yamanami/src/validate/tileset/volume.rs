//! Bounding volumes of 3D Tiles in the world: what they hold and how they are divided.
//!
//! Based on: Open Geospatial Consortium, "3D Tiles Specification 1.1", 2023.

use glam::{DMat3, DMat4, DVec3};
use serde_json::Value;
use std::f64::consts::TAU;
use yamanami_measure::tiles::earth::{SEMI_MAJOR_M, ecef_m, geodetic};

/// A bounding volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Volume {
    /// West, south, east, north in radians, least and greatest height in metres.
    Region([f64; 6]),
    Box {
        centre: DVec3,
        half_axes: DMat3,
    },
    Sphere {
        centre: DVec3,
        radius_m: f64,
    },
}

impl Volume {
    /// Reads a volume; what is wrong with it otherwise.
    pub(super) fn of(value: &Value) -> Result<Self, String> {
        let numbers = |key: &str, count: usize| -> Option<Vec<f64>> {
            let list: Vec<f64> = value[key].as_array()?.iter().filter_map(Value::as_f64).collect();
            (list.len() == count && list.iter().all(|v| v.is_finite())).then_some(list)
        };
        if let Some(r) = numbers("region", 6) {
            let on_globe = r[0].abs() <= TAU / 2.0 + 1e-9
                && r[2].abs() <= TAU / 2.0 + 1e-9
                && r[1].abs() <= TAU / 4.0 + 1e-9
                && r[3].abs() <= TAU / 4.0 + 1e-9;
            if !on_globe || r[1] > r[3] || r[4] > r[5] {
                return Err(format!("region {r:?}"));
            }
            return Ok(Self::Region(std::array::from_fn(|k| r[k])));
        }
        if let Some(b) = numbers("box", 12) {
            let half_axes = DMat3::from_cols_slice(&b[3..]);
            if half_axes.determinant() == 0.0 {
                return Err(format!("flat box {b:?}"));
            }
            return Ok(Self::Box { centre: DVec3::from_slice(&b), half_axes });
        }
        if let Some(s) = numbers("sphere", 4).filter(|s| s[3] > 0.0) {
            return Ok(Self::Sphere { centre: DVec3::from_slice(&s), radius_m: s[3] });
        }
        Err(value.to_string())
    }

    /// The same numbers as metadata have them.
    pub(super) fn of_numbers(key: &str, numbers: &[f64]) -> Result<Self, String> {
        Self::of(&serde_json::json!({ key: numbers }))
    }

    /// Moved into the world; regions are there already.
    pub(super) fn moved(self, world_from_tile: &DMat4) -> Self {
        let linear = DMat3::from_mat4(*world_from_tile);
        match self {
            Self::Region(_) => self,
            Self::Box { centre, half_axes } => {
                Self::Box { centre: world_from_tile.transform_point3(centre), half_axes: linear * half_axes }
            }
            Self::Sphere { centre, radius_m } => {
                let scale = linear.x_axis.length().max(linear.y_axis.length()).max(linear.z_axis.length());
                Self::Sphere { centre: world_from_tile.transform_point3(centre), radius_m: radius_m * scale }
            }
        }
    }

    /// Metres that a position lies outside; 0 inside.
    pub(super) fn outside_m(&self, p: DVec3) -> f64 {
        match self {
            Self::Sphere { centre, radius_m } => (p.distance(*centre) - radius_m).max(0.0),
            Self::Box { centre, half_axes } => {
                let inverse = half_axes.inverse();
                let inside = inverse * (p - centre);
                (half_axes * (inside - inside.clamp(DVec3::NEG_ONE, DVec3::ONE))).length()
            }
            Self::Region([west, south, east, north, low, high]) => {
                let [lon, lat, height] = geodetic(p);
                let (lon, lat) = (lon.to_radians(), lat.to_radians());
                let width = if east < west { east + TAU - west } else { east - west };
                let from_west = (lon - west).rem_euclid(TAU);
                // beyond the east or, the other way round, before the west
                let beyond = if from_west <= width { 0.0 } else { (from_west - width).min(TAU - from_west) };
                let east_m = beyond * lat.cos() * SEMI_MAJOR_M;
                let north_m = (south - lat).max(lat - north).max(0.0) * SEMI_MAJOR_M;
                DVec3::new(east_m, north_m, (low - height).max(height - high).max(0.0)).length()
            }
        }
    }

    /// A sphere around it.
    pub(super) fn sphere(&self) -> (DVec3, f64) {
        match self {
            Self::Sphere { centre, radius_m } => (*centre, *radius_m),
            Self::Box { centre, half_axes } => {
                let half = |a: DVec3| a.length_squared();
                let sum = half(half_axes.x_axis) + half(half_axes.y_axis) + half(half_axes.z_axis);
                (*centre, sum.sqrt() + half_axes.x_axis.dot(half_axes.y_axis).abs().sqrt())
            }
            Self::Region([west, south, east, north, low, high]) => {
                let east = if east < west { east + TAU } else { *east };
                let at = |x: f64, y: f64, height: f64| ecef_m([x.to_degrees(), y.to_degrees(), height]);
                let (x, y) = ((west + east) / 2.0, (south + north) / 2.0);
                let centre = at(x, y, (low + high) / 2.0);
                let edges = [*west, x, east].into_iter().flat_map(|x| [*south, y, *north].map(|y| (x, y)));
                let points = edges.flat_map(|(x, y)| [at(x, y, *low), at(x, y, *high)]);
                (centre, points.map(|p| p.distance(centre)).fold(0.0, f64::max))
            }
        }
    }

    /// The part of it that implicit tiling gives a child: `bits` has the halves along x, y and, where there are three, z.
    pub(super) fn part(&self, bits: &[u32]) -> Option<Self> {
        let bit = |axis: usize| bits.get(axis).map(|&b| f64::from(b));
        match self {
            Self::Sphere { .. } => None,
            Self::Region([west, south, east, north, low, high]) => {
                let east = if east < west { east + TAU } else { *east };
                let half = |a: f64, b: f64, bit: Option<f64>| match bit {
                    Some(bit) => [a + bit * (b - a) / 2.0, a + (bit + 1.0) * (b - a) / 2.0],
                    None => [a, b],
                };
                let ([w, e], [s, n], [l, h]) =
                    (half(*west, east, bit(0)), half(*south, *north, bit(1)), half(*low, *high, bit(2)));
                let turn = if w > TAU / 2.0 { TAU } else { 0.0 };
                Some(Self::Region([w - turn, s, e - turn, n, l, h]))
            }
            Self::Box { centre, half_axes } => {
                let (mut centre, mut axes) = (*centre, *half_axes);
                for axis in 0..3 {
                    if let Some(bit) = bit(axis) {
                        *axes.col_mut(axis) *= 0.5;
                        centre += axes.col(axis) * (2.0 * bit - 1.0);
                    }
                }
                Some(Self::Box { centre, half_axes: axes })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_lie_within_the_whole() {
        let whole = Volume::Box { centre: DVec3::ZERO, half_axes: DMat3::from_diagonal(DVec3::new(4.0, 4.0, 1.0)) };
        let part = whole.part(&[1, 0]).unwrap();
        assert_eq!(part.outside_m(DVec3::new(3.0, -3.0, 0.9)), 0.0);
        assert_eq!(part.outside_m(DVec3::new(-1.0, -3.0, 0.9)), 1.0);
        let region = Volume::Region([3.0, 0.1, -3.0, 0.2, 0.0, 50.0]);
        let east = region.part(&[1, 0]).unwrap();
        assert_eq!(east.outside_m(ecef_m([(-3.1f64).to_degrees(), 0.12f64.to_degrees(), 20.0])), 0.0);
        let outside = region.outside_m(ecef_m([2.9f64.to_degrees(), 0.12f64.to_degrees(), 20.0]));
        assert!((outside - 0.1 * SEMI_MAJOR_M).abs() < 0.01 * SEMI_MAJOR_M, "{outside}");
    }
}
