//! Builds the terrain quadtree of a height field: errors of all levels, from fine to coarse, on all cores.

use super::data::GridData;
use super::errors::{LANES, charge, charge_three, code, config_errors, config_errors_abreast, config_errors_exact};
use super::holes::{Holes, fill};
use super::nodes::NodeNumbers;
use super::surface::TerrainSurface;
use super::triangle::{Triangle, adjacent};
use crate::MultiresError;
use rayon::prelude::*;
use yamanami_core::{ErrorCode, HeightField, Lattice, LatticeNode};

/// How to build.
#[derive(Default)]
pub struct BuildOptions<'a> {
    /// Called with the share done, 0 to 1, from the building thread.
    pub progress: Option<&'a dyn Fn(f32)>,
}

impl std::fmt::Debug for BuildOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BuildOptions").finish_non_exhaustive()
    }
}

/// Up to this level triangles are weighed side by side, above it row by row.
const ABREAST_LEVELS: u32 = 4;

/// Largest height an error code can still bound, metres either way.
const MAX_HEIGHT_M: f32 = 500_000.0;

/// Builds the surface of a height field of at least 2×2 samples.
pub fn build(field: HeightField, options: &BuildOptions<'_>) -> Result<TerrainSurface<GridData>, MultiresError> {
    let (width, height) = (field.width(), field.height());
    let lattice = Lattice::new(width, height);
    let numbers = (width.checked_mul(height).is_some_and(|n| u32::try_from(n).is_ok()))
        .then(|| NodeNumbers::new(lattice.clone()))
        .flatten()
        .ok_or(MultiresError::TooLarge { width, height })?;
    if let Some(i) = field.heights_m().par_iter().position_any(|z| z.abs() > MAX_HEIGHT_M) {
        return Err(MultiresError::HeightOutOfRange {
            height_m: field.heights_m()[i],
            column: i % width,
            row: i / width,
        });
    }
    let holes = Holes::of(&field, &lattice);
    if holes.as_ref().is_some_and(|h| h.is_empty()) {
        return Err(MultiresError::NothingToShow { width, height, no_data: field.no_data_count() });
    }
    let geo = field.geo().clone();
    let mut heights_m = field.into_heights_m();
    fill(&mut heights_m, width, height);
    let builder = Builder { rounding_m: rounding_m(&heights_m), lattice, heights_m, holes, step_m: geo.step_m };
    let report = |level: u32| {
        if let Some(progress) = options.progress {
            progress(level as f32 / builder.lattice.levels().max(1) as f32);
        }
    };
    let mut errors: Vec<Vec<ErrorCode>> = Vec::new();
    for level in 0..builder.lattice.levels() {
        report(level);
        errors.push(builder.level_errors(level, errors.last().map_or(&[], Vec::as_slice)));
    }
    report(builder.lattice.levels());
    let bound_radius_m = builder.bound_radii_m();
    let Builder { lattice, heights_m, holes, rounding_m, .. } = builder;
    let data = GridData { lattice, heights_m, errors, holes, rounding_m };
    Ok(TerrainSurface::new(numbers, data, geo, bound_radius_m))
}

struct Builder {
    lattice: Lattice,
    heights_m: Vec<f32>,
    holes: Option<Holes>,
    step_m: [f64; 2],
    rounding_m: f32,
}

/// How far f32 arithmetic on these heights may fall short: nothing for whole metres, else a few units in the last place
/// of the relief.
fn rounding_m(heights_m: &[f32]) -> f32 {
    let whole = heights_m.par_iter().all(|z| z.fract() == 0.0);
    let (low, high) = heights_m
        .par_iter()
        .fold(|| (f32::MAX, f32::MIN), |(l, h), &z| (l.min(z), h.max(z)))
        .reduce(|| (f32::MAX, f32::MIN), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let relief_m = high - low;
    // products of a relief and a barycentric coordinate k / side are exact while they fit 24 bits
    if whole && relief_m <= 4096.0 { 0.0 } else { relief_m * 1e-6 }
}

/// The lazy wavelet's detail of a sample between two: from differences of near heights, which f32 keeps.
#[inline]
fn detail(z: f32, a: f32, b: f32) -> f32 {
    (0.5 * ((z - a) + (z - b))).abs()
}

impl Builder {
    /// Error codes of a level's midpoints, given those of the level below.
    fn level_errors(&self, level: u32, below: &[ErrorCode]) -> Vec<ErrorCode> {
        // level 0 is most of the grid and cheap to weigh: no table of triangles for it
        let charged = (level > 0).then(|| self.charge_triangles(level + 1, below));
        let [squares_x, _] = self.lattice.squares(level + 1).map(|n| n as usize);
        let [nx, ny] = self.lattice.points(level).map(|n| n as usize);
        let mut errors = vec![ErrorCode(0); nx * ny];
        errors.par_chunks_mut(nx).enumerate().for_each(|(y, row)| {
            for (x, error) in row.iter_mut().enumerate() {
                let role = match (x & 1, y & 1) {
                    (0, 0) => continue,
                    (1, 1) => 0,
                    (1, 0) => 1,
                    _ => 2,
                };
                if charged.is_none() && self.holes.is_none() && x + 1 < nx && y + 1 < ny {
                    *error = self.detail_error(x, y);
                    continue;
                }
                let node = LatticeNode { level, x: x as u32, y: y as u32 };
                for &t in adjacent(node, &self.lattice).iter() {
                    let of_midpoints = match &charged {
                        Some(charged) => charged[t.y as usize * squares_x + t.x as usize][t.half as usize],
                        None => self.charge_triangle(t, below),
                    };
                    *error = (*error).max(of_midpoints[role]);
                }
            }
        });
        errors
    }

    /// Error of a finest midpoint away from border and holes: its own detail, which both its triangles ask for.
    #[inline]
    fn detail_error(&self, x: usize, y: usize) -> ErrorCode {
        let width = self.lattice.width() as usize;
        let i = y * width + x;
        let back = (y & 1) * width + (x & 1);
        let [z, a, b] = [i, i - back, i + back].map(|i| self.heights_m[i]);
        code(detail(z, a, b), self.rounding_m)
    }

    /// For both halves of every square of a level, what its midpoints h, p, q must answer for, children included.
    fn charge_triangles(&self, level: u32, below: &[ErrorCode]) -> Vec<[[ErrorCode; 3]; 2]> {
        let [nx, ny] = self.lattice.squares(level).map(|n| n as usize);
        let mut charged = vec![[[ErrorCode(0); 3]; 2]; nx * ny];
        charged.par_chunks_mut(nx).enumerate().for_each(|(y, row)| {
            let triangle = |x: usize, half: u32| Triangle { level, x: x as u32, y: y as u32, half };
            let mut x = 0;
            while x < nx {
                let abreast = (2..=ABREAST_LEVELS).contains(&level)
                    && self.holes.is_none()
                    && x + LANES <= nx
                    && !triangle(x + LANES - 1, 0).is_clamped(&self.lattice);
                let count = if abreast { LANES } else { 1 };
                for half in 0..2 {
                    let origin = self.origin(triangle(x, half));
                    if abreast {
                        let width = self.lattice.width() as usize;
                        let errors = config_errors_abreast(&self.heights_m, width, origin, 1 << level, half);
                        for (lane, errors) in errors.iter().enumerate() {
                            let inherited = self.worst_grandchild(triangle(x + lane, half), below);
                            let own = charge_three(errors).map(|e| inherited.max(code(e, self.rounding_m)));
                            row[x + lane][half as usize] = own;
                        }
                    } else {
                        row[x][half as usize] = self.charge_triangle(triangle(x, half), below);
                    }
                }
                x += count;
            }
        });
        charged
    }

    /// Index of the first sample of a triangle's square.
    fn origin(&self, t: Triangle) -> usize {
        ((t.y as usize) << t.level) * self.lattice.width() as usize + ((t.x as usize) << t.level)
    }

    fn charge_triangle(&self, t: Triangle, below: &[ErrorCode]) -> [ErrorCode; 3] {
        let inherited = if t.level >= 2 { self.worst_grandchild(t, below) } else { ErrorCode(0) };
        let mut charged = [inherited; 3];
        let (mut shown, mut whole) = (true, true);
        if let Some(holes) = &self.holes {
            shown = holes.shown(t.level, t.x, t.y, t.half);
            whole = holes.whole(t.level, t.x, t.y, t.half);
        }
        if !shown {
            return charged;
        }
        let clamped = t.is_clamped(&self.lattice);
        let own = if clamped {
            let [nx, ny] = self.lattice.points(t.level - 1);
            let exists = t.midpoints().map(|m| m.x < nx && m.y < ny);
            charge(&config_errors_exact(&self.heights_m, &self.lattice, t), exists)
        } else {
            let width = self.lattice.width() as usize;
            let origin = self.origin(t);
            if t.level == 1 {
                self.details(width, origin, t.half)
            } else {
                charge_three(&config_errors(&self.heights_m, width, origin, 1 << t.level, t.half))
            }
        };
        // where a hole is partly covered, the surface is off by up to the triangle's size
        let hole_m =
            if whole { 0.0 } else { (self.step_m[0].hypot(self.step_m[1]) * f64::from(1u32 << t.level)) as f32 };
        for (c, own) in charged.iter_mut().zip(own) {
            *c = (*c).max(code(own.max(hole_m), self.rounding_m));
        }
        charged
    }

    /// A triangle of side 2 has no samples but its midpoints: each answers for itself.
    #[inline]
    fn details(&self, width: usize, origin: usize, half: u32) -> [f32; 3] {
        let z = |i: usize, k: usize| self.heights_m[origin + k * width + i];
        let h = detail(z(1, 1), z(0, 0), z(2, 2));
        if half == 0 {
            [h, detail(z(1, 0), z(0, 0), z(2, 0)), detail(z(2, 1), z(2, 0), z(2, 2))]
        } else {
            [h, detail(z(1, 2), z(0, 2), z(2, 2)), detail(z(0, 1), z(0, 0), z(0, 2))]
        }
    }

    /// The greatest error among the midpoints of a triangle's children.
    #[inline]
    fn worst_grandchild(&self, t: Triangle, below: &[ErrorCode]) -> ErrorCode {
        let level = t.level - 2;
        let [nx, ny] = self.lattice.points(level);
        let mut worst = ErrorCode(0);
        for child in t.children() {
            if child.exists(&self.lattice) {
                for m in child.midpoints() {
                    if m.x < nx && m.y < ny {
                        worst = worst.max(below[m.y as usize * nx as usize + m.x as usize]);
                    }
                }
            }
        }
        worst
    }

    /// Radius, one a level, of spheres around a level's midpoints that hold their triangles and their children's spheres.
    fn bound_radii_m(&self) -> Vec<f64> {
        let (width, height) = (self.lattice.width() as usize, self.lattice.height() as usize);
        let (mut ranges, mut below) = (Vec::new(), [0, 0]);
        let (mut radii, mut radius_m) = (Vec::new(), 0.0);
        for level in 0..self.lattice.levels() {
            let [nx, ny] = self.lattice.squares(level + 1).map(|n| n as usize);
            let mut coarse = vec![[f32::MAX, f32::MIN]; nx * ny];
            coarse.par_chunks_mut(nx).enumerate().for_each(|(y, row)| {
                for (x, range) in row.iter_mut().enumerate() {
                    let mut include = |low: f32, high: f32| *range = [range[0].min(low), range[1].max(high)];
                    if level == 0 {
                        for row in self.heights_m.chunks_exact(width).take((2 * y + 3).min(height)).skip(2 * y) {
                            row[2 * x..(2 * x + 3).min(width)].iter().for_each(|&z| include(z, z));
                        }
                    } else {
                        for v in 2 * y..(2 * y + 2).min(below[1]) {
                            for u in 2 * x..(2 * x + 2).min(below[0]) {
                                let [low, high]: [f32; 2] = ranges[v * below[0] + u];
                                include(low, high);
                            }
                        }
                    }
                }
            });
            let relief_m = coarse.par_iter().map(|r| r[1] - r[0]).reduce(|| 0.0, f32::max);
            let [dx, dy] = self.step_m.map(|m| m * f64::from(1u32 << level));
            let across_m = (dx * dx + 4.0 * dy * dy).max(4.0 * dx * dx + dy * dy);
            radius_m += (across_m + f64::from(relief_m).powi(2)).sqrt();
            radii.push(radius_m);
            (ranges, below) = (coarse, [nx, ny]);
        }
        radii
    }
}
