//! How high the geoid, from which maps count heights, lies above the ellipsoid.
//!
//! Based on: Lemoine, Kenyon, Factor and others, "The development of the joint NASA GSFC and NIMA geopotential model
//! EGM96", NASA/TP-1998-206861, 1998: spherical harmonics to degree 360, within about half a metre of the true geoid. They
//! are evaluated on a lattice over the region and interpolated by cubics, which adds less than two centimetres.

use crate::{IoError, dem};
use std::path::Path;
use yamanami_core::HeightField;

/// Heights of the geoid above the ellipsoid over a region.
#[derive(Debug, Clone)]
pub struct Geoid {
    name: String,
    heights: Heights,
}

#[derive(Debug, Clone)]
enum Heights {
    Same(f64),
    Lattice(Lattice),
    Grid(HeightField),
}

/// Nodes in longitude and latitude.
#[derive(Debug, Clone)]
struct Lattice {
    south_west_deg: [f64; 2],
    step_deg: f64,
    columns: usize,
    rows: usize,
    /// From the south, row by row.
    heights_m: Vec<f64>,
}

/// Degrees between nodes; the shortest waves of the model are a degree long.
const STEP_DEG: f64 = 0.125;
/// Twice that from so many nodes on.
const MANY_NODES: f64 = 50_000.0;
/// Most samples of a geoid read from a file.
const MOST_SAMPLES: usize = 1 << 26;

impl Geoid {
    /// EGM96 over a region (west, south, east, north; degrees).
    pub fn egm96([west, south, east, north]: [f64; 4]) -> Self {
        let nodes = |step: f64| ((east - west) / step + 4.0) * ((north - south) / step + 4.0);
        let step_deg = if nodes(STEP_DEG) > MANY_NODES { 2.0 * STEP_DEG } else { STEP_DEG };
        let first = |v: f64| (v / step_deg).floor() * step_deg - step_deg;
        let south_west_deg = [first(west), first(south)];
        let count = |from: f64, to: f64| ((to - from) / step_deg).ceil().max(0.0) as usize + 3;
        let (columns, rows) = (count(south_west_deg[0], east), count(south_west_deg[1], north));
        let mut heights_m = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            let latitude = (south_west_deg[1] + step_deg * row as f64).clamp(-90.0, 90.0);
            for column in 0..columns {
                let longitude = south_west_deg[0] + step_deg * column as f64;
                heights_m.push(egm96::egm96_compute_altitude_offset(latitude, longitude));
            }
        }
        let lattice = Lattice { south_west_deg, step_deg, columns, rows, heights_m };
        Self { name: "EGM96".to_owned(), heights: Heights::Lattice(lattice) }
    }

    /// A geoid from an elevation file whose samples, in longitude and latitude, are its heights above the ellipsoid.
    pub fn read(path: &Path) -> Result<Self, IoError> {
        let mut source = dem::open(&[path.to_owned()], &dem::OpenOptions::default())?;
        let info = source.info();
        if !info.geo.crs.geographic {
            return Err(IoError::unsupported(
                path,
                "a geoid that is not in longitude and latitude",
                "convert it first",
            ));
        }
        let samples = info.size[0].saturating_mul(info.size[1]);
        if samples > MOST_SAMPLES {
            return Err(IoError::too_large(path, "samples of a geoid", samples as u64, MOST_SAMPLES as u64));
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, heights: Heights::Grid(source.read_all()?) })
    }

    /// The same height everywhere.
    pub fn constant(height_m: f64) -> Self {
        Self { name: format!("a constant {height_m} m"), heights: Heights::Same(height_m) }
    }

    /// What it is, e.g. `EGM96`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its height above the ellipsoid, metres; `None` outside the region or where a file has no data.
    pub fn height_m(&self, longitude_deg: f64, latitude_deg: f64) -> Option<f64> {
        match &self.heights {
            Heights::Same(height_m) => Some(*height_m),
            Heights::Lattice(lattice) => lattice.height_m(longitude_deg, latitude_deg),
            Heights::Grid(grid) => [0.0, 360.0, -360.0].into_iter().find_map(|turn| {
                let [column, row] = grid.geo().grid_from_source(longitude_deg + turn, latitude_deg);
                grid.sample_bilinear(column, row)
            }),
        }
    }
}

impl Lattice {
    fn height_m(&self, longitude_deg: f64, latitude_deg: f64) -> Option<f64> {
        let place = |v: f64, first: f64, nodes: usize| {
            let at = (v - first) / self.step_deg;
            (at > 1.0 - 1e-9 && at < nodes as f64 - 2.0 + 1e-9).then(|| {
                let cell = (at.floor() as usize).clamp(1, nodes - 3);
                (cell - 1, cubic(at - cell as f64))
            })
        };
        let (column, across) = place(longitude_deg, self.south_west_deg[0], self.columns)?;
        let (row, along) = place(latitude_deg, self.south_west_deg[1], self.rows)?;
        let line = |r: usize| {
            let first = (row + r) * self.columns + column;
            self.heights_m[first..first + 4].iter().zip(across).map(|(h, w)| h * w).sum::<f64>()
        };
        Some((0..4).map(|r| line(r) * along[r]).sum())
    }
}

/// Weights of Lagrange's cubic through the nodes -1, 0, 1 and 2.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn egm96_is_as_published() {
        // the test points that NIMA gave out with its program
        for (latitude, longitude, height_m) in [
            (38.628_155_3, 269.779_155_0, -31.628),
            (-14.621_217_0, 305.021_114_0, -2.969),
            (46.874_319_0, 102.448_729_0, -43.575),
            (-23.617_446_0, 133.874_712_0, 15.871),
            (38.625_473_0, 359.999_500_0, 50.066),
            (-0.466_744_0, 0.002_300_0, 17.329),
        ] {
            let geoid = Geoid::egm96([longitude - 0.01, latitude - 0.01, longitude + 0.01, latitude + 0.01]);
            let found_m = geoid.height_m(longitude, latitude).unwrap();
            assert!((found_m - height_m).abs() < 0.02, "{latitude} {longitude}: {found_m} instead of {height_m}");
        }
    }

    #[test]
    fn the_lattice_is_as_good_as_the_series() {
        // over Nepal, where the geoid is roughest
        let region = [84.3, 27.6, 85.0, 28.2];
        let geoid = Geoid::egm96(region);
        for k in 0..12 {
            let (lon, lat) = (84.3 + 0.7 * f64::from(k) / 11.0, 27.6 + 0.6 * f64::from(k * 7 % 12) / 11.0);
            let exact_m = egm96::egm96_compute_altitude_offset(lat, lon);
            let found_m = geoid.height_m(lon, lat).unwrap();
            assert!((found_m - exact_m).abs() < 0.02, "{found_m} {exact_m}");
        }
        assert_eq!(geoid.height_m(80.0, 27.9), None);
        assert_eq!(Geoid::constant(-3.5).height_m(1.0, 2.0), Some(-3.5));
    }
}
