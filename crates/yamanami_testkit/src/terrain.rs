//! Synthetic height fields of any size, whole or by windows, with shapes, spacings and holes to try a method on.

use crate::fractal::Fractal;
use crate::holes::{HoleMap, Holes};
use std::convert::Infallible;
use yamanami_core::{Crs, GeoReference, HeightField, HeightSource, Window};

/// The form of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// Relief at all scales.
    Fractal {
        /// About this much from valley to peak.
        relief_m: f32,
        /// Amplitude of an octave over that of the next longer one, 0…1: 0.5 is real mountains, 0.9 is nearly noise.
        roughness: f32,
        /// Which of all such reliefs.
        seed: u64,
    },
    /// `z = at_origin_m + slope_m[0]·column + slope_m[1]·row`: exact in `f32` when the numbers are short in binary.
    Plane {
        /// Height of sample (0, 0).
        at_origin_m: f32,
        /// Rise per column and per row.
        slope_m: [f32; 2],
    },
    /// A roof whose crest runs across the grid, along neither its lines nor its diagonals.
    Ridge {
        /// Height of the crest over the lower corners.
        relief_m: f32,
    },
    /// A cone on level ground, its tip on the middle sample.
    Cone {
        /// Height of the tip.
        relief_m: f32,
    },
    /// Two levels and a vertical step between them, along a slanting line.
    Cliff {
        /// Height of the step.
        relief_m: f32,
    },
    /// Level ground.
    Flat {
        /// Its height.
        z_m: f32,
    },
    /// Level ground with one sample sticking out: what a greedy error measure must not miss.
    Spike {
        /// Column of the sample.
        column: usize,
        /// Row of the sample.
        row: usize,
        /// Its height.
        z_m: f32,
    },
}

impl Shape {
    /// Mountains: 1,000 m of fractal relief.
    pub fn mountains(seed: u64) -> Self {
        Self::Fractal { relief_m: 1000.0, roughness: 0.5, seed }
    }
}

/// How far apart samples are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Spacing {
    /// So many arc seconds in longitude and latitude (EPSG 4326), the north-west sample at 138° E, 36° N.
    ArcSeconds(f64),
    /// So many metres both ways, without a CRS.
    Metres(f64),
    /// Metres between columns and between rows, without a CRS.
    Oblong(f64, f64),
}

/// A terrain made to order: equal orders give equal terrains, whole or by windows.
#[derive(Debug, Clone)]
pub struct SyntheticTerrain {
    size: [usize; 2],
    geo: GeoReference,
    shape: Shape,
    fractal: Option<Fractal>,
    holes: HoleMap,
    quantum_m: Option<f32>,
}

impl SyntheticTerrain {
    /// A terrain of `width` × `height` samples without holes.
    pub fn new(width: usize, height: usize, shape: Shape, spacing: Spacing) -> Self {
        let size = [width, height];
        let fractal = match shape {
            Shape::Fractal { relief_m, roughness, seed } => {
                Some(Fractal::new(width.max(height), relief_m, roughness, seed))
            }
            _ => None,
        };
        Self {
            size,
            geo: geo_reference(spacing, size),
            shape,
            fractal,
            holes: HoleMap::new(Holes::None, size),
            quantum_m: None,
        }
    }

    /// Mountains at 50 m, the grid most tests want.
    pub fn mountains(width: usize, height: usize, seed: u64) -> Self {
        Self::new(width, height, Shape::mountains(seed), Spacing::Metres(50.0))
    }

    /// The same with no-data.
    #[must_use]
    pub fn with_holes(mut self, holes: Holes) -> Self {
        self.holes = HoleMap::new(holes, self.size);
        self
    }

    /// The same with heights rounded to multiples of `quantum_m`, as an integer DEM has them.
    #[must_use]
    pub fn rounded_to(mut self, quantum_m: f32) -> Self {
        self.quantum_m = Some(quantum_m);
        self
    }

    /// All of it in memory.
    pub fn to_field(&self) -> HeightField {
        let [width, height] = self.size;
        let mut heights_m = vec![0.0; width * height];
        for (row, out) in heights_m.chunks_exact_mut(width).enumerate() {
            self.fill_row(row, 0, out);
        }
        HeightField::new(width, height, heights_m, self.geo.clone())
    }

    /// Heights of `row` from `column` on.
    pub fn fill_row(&self, row: usize, column: usize, out: &mut [f32]) {
        if let Some(fractal) = &self.fractal {
            out.fill(0.0);
            fractal.add_row(row, column, out);
        } else {
            for (column, z) in (column..).zip(out.iter_mut()) {
                *z = self.shape_at(column, row);
            }
        }
        if let Some(quantum_m) = self.quantum_m {
            for z in out.iter_mut() {
                *z = (*z / quantum_m).round() * quantum_m;
            }
        }
        self.holes.punch_row(row, column, out);
    }

    fn shape_at(&self, column: usize, row: usize) -> f32 {
        let [half_x, half_y] = self.size.map(|n| (n - 1) as f64 * 0.5);
        let (x, y) = (column as f64 - half_x, row as f64 - half_y);
        match self.shape {
            Shape::Fractal { .. } | Shape::Flat { z_m: 0.0 } => 0.0,
            Shape::Flat { z_m } => z_m,
            Shape::Plane { at_origin_m, slope_m } => at_origin_m + slope_m[0] * column as f32 + slope_m[1] * row as f32,
            Shape::Ridge { relief_m } => {
                let across = (x * 0.8 + y * 0.6).abs() / (half_x * 0.8 + half_y * 0.6);
                (f64::from(relief_m) * (1.0 - across)) as f32
            }
            Shape::Cone { relief_m } => {
                // the tip sits on a sample also where the size is even
                let (dx, dy) = (x + half_x.fract(), y + half_y.fract());
                let away = dx.hypot(dy) / half_x.min(half_y).max(1.0);
                (f64::from(relief_m) * (1.0 - away).max(0.0)) as f32
            }
            Shape::Cliff { relief_m } => {
                if x + 0.3 * y < 0.0 {
                    0.0
                } else {
                    relief_m
                }
            }
            Shape::Spike { column: c, row: r, z_m } => {
                if (column, row) == (c, r) {
                    z_m
                } else {
                    0.0
                }
            }
        }
    }
}

fn geo_reference(spacing: Spacing, size: [usize; 2]) -> GeoReference {
    match spacing {
        Spacing::Metres(step_m) => GeoReference::local([step_m; 2], size[1]),
        Spacing::Oblong(x_m, y_m) => GeoReference::local([x_m, y_m], size[1]),
        Spacing::ArcSeconds(seconds) => {
            let crs = Crs { epsg: Some(4326), geographic: true, web_mercator: false, name: "WGS 84".into() };
            let step = seconds / 3600.0;
            GeoReference::new(crs, [138.0, 36.0], [step, -step], size)
        }
    }
}

impl HeightSource for SyntheticTerrain {
    type Error = Infallible;

    fn size(&self) -> [usize; 2] {
        self.size
    }

    fn geo(&self) -> &GeoReference {
        &self.geo
    }

    fn read_window(&mut self, window: Window, out: &mut [f32]) -> Result<(), Infallible> {
        for (row, out) in (window.row..).zip(out.chunks_exact_mut(window.width)).take(window.height) {
            self.fill_row(row, window.column, out);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(a: &[f32], b: &[f32]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
    }

    #[test]
    fn windows_are_cut_from_the_same_terrain_as_the_whole() {
        let holes = Holes::Discs { count: 5, seed: 3 };
        let mut terrain = SyntheticTerrain::mountains(201, 133, 9).with_holes(holes);
        let whole = terrain.to_field();
        assert!(whole.no_data_count() > 0);
        let window = Window { column: 37, row: 50, width: 101, height: 20 };
        let mut part = vec![0.0; 101 * 20];
        terrain.read_window(window, &mut part).unwrap();
        for row in 0..20 {
            let from = (50 + row) * 201 + 37;
            assert!(same(&part[row * 101..][..101], &whole.heights_m()[from..][..101]), "row {row}");
        }
    }

    #[test]
    fn mountains_have_relief_at_every_scale() {
        let field = SyntheticTerrain::mountains(513, 513, 1).to_field();
        let [low, high] = field.range_m().unwrap();
        assert!(low >= 0.0 && high <= 1000.0 && high - low > 300.0, "{low} {high}");
        let mut last = f64::INFINITY;
        for log2 in (0..8).rev() {
            let step = 1usize << log2;
            let mut details = Vec::new();
            for row in (0..513).step_by(step) {
                for column in (step..513 - step).step_by(2 * step) {
                    let z = |c: usize| f64::from(field.at(c, row));
                    details.push((z(column) - 0.5 * (z(column - step) + z(column + step))).abs());
                }
            }
            let mean = details.iter().sum::<f64>() / details.len() as f64;
            assert!(mean > 0.05 && mean < last, "mean detail {mean} at a step of {step}, coarser {last}");
            last = mean;
        }
    }

    #[test]
    fn seeds_differ_and_heights_are_pinned() {
        let a = SyntheticTerrain::mountains(65, 65, 1).to_field();
        let b = SyntheticTerrain::mountains(65, 65, 2).to_field();
        assert_ne!(a, b);
        assert_eq!(a, SyntheticTerrain::mountains(65, 65, 1).to_field());
    }

    #[test]
    fn shapes_are_what_they_say() {
        let of = |shape| SyntheticTerrain::new(33, 21, shape, Spacing::Metres(0.5)).to_field();
        let plane = of(Shape::Plane { at_origin_m: 2.0, slope_m: [0.5, -0.25] });
        assert_eq!(plane.at(32, 20), 2.0 + 16.0 - 5.0);
        assert_eq!(of(Shape::Cone { relief_m: 80.0 }).at(16, 10), 80.0);
        assert_eq!(of(Shape::Cliff { relief_m: 30.0 }).range_m(), Some([0.0, 30.0]));
        let spike = of(Shape::Spike { column: 5, row: 6, z_m: 9.0 });
        assert_eq!(spike.heights_m().iter().filter(|&&z| z != 0.0).count(), 1);
        let even = SyntheticTerrain::new(8, 6, Shape::Cone { relief_m: 7.0 }, Spacing::ArcSeconds(1.0)).to_field();
        assert_eq!(even.range_m().unwrap()[1], 7.0, "the tip is a sample");
        assert!((even.geo().step_m[1] - 30.8).abs() < 0.1, "{:?}", even.geo().step_m);
    }

    #[test]
    fn every_pattern_of_holes_leaves_what_it_says() {
        let left = |holes| {
            let field = SyntheticTerrain::mountains(40, 30, 1).with_holes(holes).to_field();
            1200 - field.no_data_count()
        };
        assert_eq!(left(Holes::All), 0);
        assert_eq!(left(Holes::AllBut { column: 39, row: 0 }), 1);
        assert_eq!(left(Holes::Border { samples: 3 }), 34 * 24);
        assert!((1050..1150).contains(&left(Holes::Speckle { share: 0.1, seed: 4 })));
        assert!((600..=640).contains(&left(Holes::BeyondDiagonal)));
    }

    #[test]
    fn rounding_gives_whole_metres() {
        let field = SyntheticTerrain::mountains(33, 33, 5).rounded_to(1.0).to_field();
        assert!(field.heights_m().iter().all(|z| z.fract() == 0.0));
    }
}
