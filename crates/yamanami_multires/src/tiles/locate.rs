//! The height of the front that all zooms have at their border lines, at any place: it depends on the place alone.

use super::walk::{Ground, Lines};
use crate::wavelet::{ALL, TerrainData, Triangle};
use yamanami_core::LatticeNode;

impl<D: TerrainData> Ground<'_, D> {
    /// Height in metres of the front of border lines of a zoom at a column and row, clamped to the grid.
    pub(super) fn border_height_m(&self, zoom: u32, at: [f64; 2], absent: &mut Vec<LatticeNode>) -> f64 {
        let size = [self.lattice.width(), self.lattice.height()];
        let at = [0, 1].map(|axis| at[axis].clamp(0.0, f64::from(size[axis] - 1)));
        let limits = self.plan.zoom(zoom);
        let level = self.lattice.levels();
        let squares = self.lattice.squares(level);
        let [x, y] = [0, 1].map(|axis| ((at[axis] / f64::from(1u32 << level)) as u32).min(squares[axis] - 1));
        let mut t = self.nearest([0, 1].map(|half| Triangle { level, x, y, half }).into_iter(), at);
        loop {
            let (config, _) = self.config(t, limits, Lines::Everywhere, absent);
            if config != ALL {
                let (mut best, mut height_m) = (f64::NEG_INFINITY, 0.0);
                self.drawn(t, config, |corners| {
                    let weights = barycentric(corners, at);
                    let least = weights.into_iter().fold(f64::INFINITY, f64::min);
                    if least > best {
                        best = least;
                        let z = corners.map(|[column, row]| f64::from(self.data.sample_height_m(column, row)));
                        height_m = (0..3).map(|k| weights[k] * z[k]).sum();
                    }
                });
                return height_m;
            }
            let children = t.children().into_iter().filter(|c| c.exists(self.lattice));
            t = self.nearest(children, at);
        }
    }

    /// The triangle that a place lies in, or least outside of; the first of equals.
    fn nearest(&self, triangles: impl Iterator<Item = Triangle>, at: [f64; 2]) -> Triangle {
        let mut best: Option<(f64, Triangle)> = None;
        for t in triangles {
            let corners = t.corner_samples(self.lattice);
            let least = barycentric(corners, at).into_iter().fold(f64::INFINITY, f64::min);
            if best.is_none_or(|(most, _)| least > most) {
                best = Some((least, t));
            }
        }
        match best {
            Some((_, t)) => t,
            // every triangle has a child that exists
            None => Triangle { level: 0, x: 0, y: 0, half: 0 },
        }
    }
}

/// Barycentric coordinates of a column and row; minus infinity where a triangle has no area.
fn barycentric(corners: [[u32; 2]; 3], at: [f64; 2]) -> [f64; 3] {
    let [a, b, c] = corners.map(|[x, y]| [f64::from(x), f64::from(y)]);
    let cross = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
    let area = cross(a, b, c);
    if area == 0.0 {
        return [f64::NEG_INFINITY; 3];
    }
    [cross(at, b, c) / area, cross(a, at, c) / area, cross(a, b, at) / area]
}
