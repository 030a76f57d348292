//! What holds for all tiles of a tree: tolerances, the lattices of border lines, quanta of heights.

use yamanami_core::ErrorCode;

/// How to cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutOptions {
    /// Coarsest and finest zoom of the tree.
    pub zooms: [u32; 2],
    /// Largest error of the front in the finest zoom, metres; that of each coarser one is twice as large.
    pub tolerance_m: f64,
    /// Radius of the globe, metres, when vertices will be joined by straight lines in space: then the rise of the globe
    /// over a triangle counts as an error. `None` for tiles that stay flat.
    pub globe_radius_m: Option<f64>,
    /// Lowest and highest height of the terrain, metres.
    pub height_range_m: [f64; 2],
    /// What lies outside of the terrain is level ground of this height, metres; `None` leaves it out.
    pub fill_m: Option<f64>,
}

/// Zooms above the finest whose borders are closed against all finer ones; more would make a tile of the coarsest all
/// border.
const CLOSED_ZOOMS: u32 = 6;

/// Zooms that the border lines of still coarser tiles are finer than their insides: what may gape then is an eighth of the
/// tile's own error.
const FINER_BORDERS: u32 = 3;

/// A quantum of heights is at most this part of the tolerance.
const QUANTUM_SHARE: f64 = 1.0 / 32.0;

/// Steps along a border that a sample's spacing has at least, on the coarsest lattice of closed borders.
const STEPS_A_SAMPLE: f64 = 4.0;

/// Most parts of the fill along a side, as a power of two.
const MOST_FILL_PARTS: u32 = 6;

/// What holds for one zoom.
#[derive(Debug, Clone)]
pub(crate) struct ZoomPlan {
    /// By level of the terrain: a midpoint is applied when its code is above.
    pub(crate) inner: Vec<i32>,
    /// The same for midpoints that touch a border line.
    pub(crate) border: Vec<i32>,
    /// Heights of border vertices are multiples of it, metres; a power of two.
    pub(crate) border_quantum_m: f64,
    /// The same of inner vertices; a multiple of the other.
    pub(crate) inner_quantum_m: f64,
}

/// The front's share of the tolerance; what is left is for heights that are rounded and edges that are moved.
const FRONT_SHARE: f64 = 0.9;

/// What holds for all tiles.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub(crate) first: u32,
    pub(crate) last: u32,
    /// From this zoom on all borders are closed.
    pub(crate) closed: u32,
    zooms: Vec<ZoomPlan>,
    /// Zooms below this have lattices as coarse as the samples: places in them mean little.
    crude_below: u32,
    /// What is promised of the finest zoom, metres.
    pub(crate) tolerance_m: f64,
    /// All that two heights can differ, metres.
    pub(crate) relief_m: f64,
    /// By level: how far a triangle's chord lies below the globe, metres.
    pub(crate) sagitta_m: Vec<f64>,
    pub(crate) fill_m: Option<f64>,
    /// Length of a unit of tile space that a chord over it rises above the globe by the finest tolerance; 0 when flat.
    chord: f64,
}

impl Plan {
    /// `sample` is the least distance of samples in tile space, `levels` the terrain's, `step_m` its spacing.
    pub(crate) fn new(options: &CutOptions, levels: u32, step_m: [f64; 2], sample: f64) -> Self {
        let [first, last] = options.zooms;
        let lattice = |zoom: u32| 1.0 / (f64::from(1u32 << zoom) * f64::from(super::GRID));
        let crude_below = (first..last).find(|&zoom| 2.0 * lattice(zoom) <= sample).unwrap_or(last);
        let fine = (first..last).find(|&zoom| lattice(zoom) * STEPS_A_SAMPLE <= sample).unwrap_or(last);
        let closed = last.saturating_sub(CLOSED_ZOOMS).max(fine).max(first);
        let hypotenuse_2 = step_m[0] * step_m[0] + step_m[1] * step_m[1];
        let sagitta_m: Vec<f64> = (0..=levels)
            .map(|level| {
                let side = f64::from(1u32 << level);
                options.globe_radius_m.map_or(0.0, |radius_m| side * side * hypotenuse_2 / (8.0 * radius_m))
            })
            .collect();
        let [low_m, high_m] = options.height_range_m;
        let (low_m, high_m) = options.fill_m.map_or((low_m, high_m), |fill_m| (low_m.min(fill_m), high_m.max(fill_m)));
        let relief_m = (high_m - low_m).max(1e-3);
        // a tile's heights are steps of 16 bits from its lowest one, and its ends are told in single precision
        let highest_m = low_m.abs().max(high_m.abs()) + relief_m;
        let least_m = (relief_m * 1.001 / f64::from(super::GRID - 2)).max(highest_m * 2f64.powi(-23));
        let range_quantum_m = least_m.log2().ceil().exp2();
        let error_m = |zoom: u32| FRONT_SHARE * options.tolerance_m * f64::from(last - zoom.min(last)).exp2();
        let zooms = (first..=last)
            .map(|zoom| {
                let border_m = if zoom >= closed { error_m(last) } else { error_m(zoom + FINER_BORDERS) };
                // triangles smaller than two steps of the tile's lattice would fold
                let least =
                    (0..levels).find(|&l| f64::from(1u32 << l) * sample >= 2.0 * lattice(zoom)).unwrap_or(levels);
                let limits = |error_m: f64| {
                    let limit = |level: u32| match level {
                        l if l < least => i32::from(u16::MAX),
                        l => limit(error_m - sagitta_m[l as usize + 1]),
                    };
                    (0..levels).map(limit).collect()
                };
                let quantum_m = |error_m: f64| range_quantum_m.max((error_m * QUANTUM_SHARE).log2().floor().exp2());
                ZoomPlan {
                    inner: limits(error_m(zoom)),
                    border: limits(border_m),
                    border_quantum_m: quantum_m(border_m),
                    inner_quantum_m: quantum_m(error_m(zoom)),
                }
            })
            .collect();
        let chord_m = options.globe_radius_m.map_or(0.0, |radius_m| (8.0 * radius_m * options.tolerance_m).sqrt());
        let chord = chord_m * sample / step_m[0].max(step_m[1]);
        let (tolerance_m, fill_m) = (options.tolerance_m, options.fill_m);
        Self { first, last, closed, zooms, crude_below, tolerance_m, relief_m, sagitta_m, fill_m, chord }
    }

    /// Whether a zoom's lattice is as coarse as the samples.
    pub(crate) fn is_crude(&self, zoom: u32) -> bool {
        zoom < self.crude_below
    }

    /// Into how many parts the fill of a tile is divided along its sides, as a power of two.
    pub(crate) fn fill_parts(&self, zoom: u32) -> u32 {
        if self.chord == 0.0 {
            return 0;
        }
        let (side, error) = (0.5f64.powi(zoom as i32), f64::from(self.last - zoom.min(self.last)).exp2());
        (side / (self.chord * error.sqrt())).log2().ceil().clamp(0.0, f64::from(MOST_FILL_PARTS)) as u32
    }

    pub(crate) fn zoom(&self, zoom: u32) -> &ZoomPlan {
        &self.zooms[(zoom - self.first) as usize]
    }

    /// The zoom whose lattice the vertices on a line stand on, in tiles of a zoom: the coarsest that has the line among those
    /// that are closed against one another.
    pub(crate) fn lattice_zoom(&self, zoom: u32, line: u32) -> u32 {
        if zoom < self.closed {
            return zoom;
        }
        zoom.saturating_sub(line.trailing_zeros()).max(self.closed)
    }

    /// The finest zoom whose corners are vertices of the borders of tiles of a zoom.
    pub(crate) fn corner_zoom(&self, zoom: u32) -> u32 {
        if zoom < self.closed { zoom } else { self.last }
    }
}

/// The greatest code that is not above an error.
fn limit(error_m: f64) -> i32 {
    if error_m < 0.0 {
        return -1;
    }
    let code = ErrorCode::ceil(error_m as f32);
    i32::from(code.0) - i32::from(f64::from(code.to_m()) > error_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_parts_what_is_above() {
        for error_m in [0.0, 1e-5, 0.3, 10.0, 10.004, 500.0] {
            let limit = limit(error_m);
            let to_m = |code: i32| f64::from(ErrorCode(code as u16).to_m());
            assert!(to_m(limit) <= error_m && to_m(limit + 1) > error_m, "{error_m}");
        }
        assert_eq!(limit(-1.0), -1);
    }

    #[test]
    fn a_line_has_one_lattice_from_its_coarsest_zoom_on() {
        let options = CutOptions {
            zooms: [0, 12],
            tolerance_m: 10.0,
            globe_radius_m: None,
            height_range_m: [0.0, 3000.0],
            fill_m: None,
        };
        let plan = Plan::new(&options, 10, [30.0; 2], 1.0 / 4096.0 / 70.0);
        assert_eq!(plan.closed, 6);
        assert_eq!([9, 10, 11, 12].map(|z| plan.lattice_zoom(z, 3 << (z - 9))), [9; 4]);
        assert_eq!([6, 12].map(|z| plan.lattice_zoom(z, 1 << (z - 4))), [6; 2]);
        assert_eq!(plan.lattice_zoom(5, 2), 5);
        assert_eq!(plan.zoom(12).border_quantum_m, 0.25);
    }
}
