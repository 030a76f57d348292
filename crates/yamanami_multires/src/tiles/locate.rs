//! The height of the front that all zooms have at their border lines, at any place: it depends on the place alone.

use super::apron::{RIM, outside};
use super::plan::ZoomPlan;
use super::walk::{Ground, Lines};
use crate::wavelet::{ALL, TerrainData, Triangle};
use yamanami_core::LatticeNode;

/// So far out from the grid the rim is level, samples: beyond its inner ring by more than vertices move on a side, so that
/// none of the ring's vertices stands on the slope.
const LEVEL: f64 = 1.25;

impl<D: TerrainData> Ground<'_, D> {
    /// Height in metres of the front of border lines of a zoom at a column and row, of the rim and the fill outside.
    pub(super) fn border_height_m(&self, zoom: u32, at: [f64; 2], absent: &mut Vec<LatticeNode>) -> f64 {
        let size = [self.lattice.width(), self.lattice.height()];
        let out = outside(at, size);
        let Some(fill_m) = self.plan.fill_m.filter(|_| out > LEVEL) else {
            return self.ground_height_m(zoom, at, absent);
        };
        let part = ((out - LEVEL) / (RIM as f64 - 2.0 * LEVEL + 1.0)).min(1.0);
        if part == 1.0 {
            return fill_m;
        }
        (1.0 - part) * self.ground_height_m(zoom, at, absent) + part * fill_m
    }

    fn ground_height_m(&self, zoom: u32, at: [f64; 2], absent: &mut Vec<LatticeNode>) -> f64 {
        let size = [self.lattice.width(), self.lattice.height()];
        let at = [0, 1].map(|axis| at[axis].clamp(0.0, f64::from(size[axis] - 1)));
        let limits = self.plan.zoom(zoom);
        let level = self.lattice.levels();
        let squares = self.lattice.squares(level);
        let [x, y] = [0, 1].map(|axis| ((at[axis] / f64::from(1u32 << level)) as u32).min(squares[axis] - 1));
        let mut found = Found { least: f64::NEG_INFINITY, height_m: 0.0 };
        self.choose([0, 1].map(|half| Triangle { level, x, y, half }).into_iter(), at, limits, absent, &mut found);
        found.height_m + self.placement.lift_m(at)
    }

    /// Goes on with the triangle that a place lies in, or least outside of; the first of equals. Where base squares reach past
    /// the grid, a square's diagonal bends as it is refined, and all triangles whose squares hold the place are looked at.
    fn choose(
        &self,
        triangles: impl Iterator<Item = Triangle>,
        at: [f64; 2],
        limits: &ZoomPlan,
        absent: &mut Vec<LatticeNode>,
        found: &mut Found,
    ) {
        let mut best: Option<(f64, Triangle)> = None;
        for t in triangles {
            if t.is_clamped(self.lattice) {
                let holds = |k: u32, along: f64, size: u32| {
                    let [from, to] = [k, k + 1].map(|k| (u64::from(k) << t.level).min(u64::from(size - 1)) as f64);
                    from <= along && along <= to
                };
                if holds(t.x, at[0], self.lattice.width()) && holds(t.y, at[1], self.lattice.height()) {
                    self.descend(t, at, limits, absent, found);
                }
                continue;
            }
            let least = barycentric(t.corner_samples(self.lattice), at).into_iter().fold(f64::INFINITY, f64::min);
            if best.is_none_or(|(most, _)| least > most) {
                best = Some((least, t));
            }
        }
        if let Some((_, t)) = best {
            self.descend(t, at, limits, absent, found);
        }
    }

    fn descend(&self, t: Triangle, at: [f64; 2], limits: &ZoomPlan, absent: &mut Vec<LatticeNode>, found: &mut Found) {
        let (config, _) = self.config(t, limits, Lines::Everywhere, absent);
        if config == ALL {
            let children = t.children().into_iter().filter(|c| c.exists(self.lattice));
            return self.choose(children, at, limits, absent, found);
        }
        self.drawn(t, config, |corners| {
            let weights = barycentric(corners, at);
            let least = weights.into_iter().fold(f64::INFINITY, f64::min);
            if least > found.least {
                let z = corners.map(|[column, row]| f64::from(self.data.sample_height_m(column, row)));
                *found = Found { least, height_m: (0..3).map(|k| weights[k] * z[k]).sum() };
            }
        });
    }
}

/// The triangle that a place lies deepest in, so far.
struct Found {
    least: f64,
    height_m: f64,
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
