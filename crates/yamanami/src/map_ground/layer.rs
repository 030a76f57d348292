//! One source laid onto a grid of the map's plane.

use super::interpolate::Samples;
use super::source::{Source, grid_from_lon_lat};
use crate::Error;
use glam::DVec2;
use rayon::prelude::*;
use yamanami_core::Window;
use yamanami_io::crs::{AzimuthalPlane, GridWarp};

/// Samples of a source in memory at once.
const MOST_WINDOW_SAMPLES: usize = if cfg!(test) { 1 << 13 } else { 1 << 24 };
/// Samples around a place that its height needs, and a little for what lies between the rows looked at.
const MARGIN: f64 = 8.0;
/// A spline is laid through samples that stand further apart than so many of the grid's.
const SMOOTH_SPACINGS: f64 = 1.5;
/// How exactly places are met, metres.
const PLACE_TOLERANCE_M: f64 = 1e-3;
/// So far from the outermost sample its cell reaches, in samples.
const HALF_CELL: f64 = 0.5;

/// A square grid of the plane around (0, 0), row by row from the north-west.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlaneGrid {
    pub(super) spacing_m: f64,
    pub(super) half: u32,
}

impl PlaneGrid {
    pub(super) fn width(&self) -> usize {
        2 * self.half as usize + 1
    }

    pub(super) fn reach_m(&self) -> f64 {
        self.spacing_m * f64::from(self.half)
    }
}

/// A source's heights on a grid.
pub(super) struct Layer {
    /// NaN where there are none.
    pub(super) heights_m: Vec<f32>,
    /// Whether a file lies there, with data or without.
    pub(super) inside: Vec<bool>,
}

/// Columns and rows of a rectangle of the grid.
#[derive(Debug, Clone, Copy)]
struct Block {
    column: usize,
    row: usize,
    width: usize,
    height: usize,
}

/// Reads what a grid needs of a source; `None` when they do not meet.
pub(super) fn read(source: &mut Source, plane: &AzimuthalPlane, grid: PlaneGrid) -> Result<Option<Layer>, Error> {
    let mut layer: Option<Layer> = None;
    let turns: &[f64] = if source.goes_round() { &[-360.0, 0.0, 360.0] } else { &[0.0] };
    for &turn in turns {
        lay(source, plane, grid, turn, &mut layer)?;
    }
    Ok(layer)
}

fn lay(
    source: &mut Source,
    plane: &AzimuthalPlane,
    grid: PlaneGrid,
    turn: f64,
    layer: &mut Option<Layer>,
) -> Result<(), Error> {
    let (plane, goes_round) = (*plane, source.goes_round());
    let geo = source.geo.clone();
    let tolerance = PLACE_TOLERANCE_M / geo.step_m[0].min(geo.step_m[1]);
    let exact = |p: DVec2| {
        let [lon, lat] = plane.to_lon_lat(p);
        // projections are looked up where longitudes are counted from −180° to 180°
        let lon = if goes_round { lon + turn } else { lon - 360.0 * (lon / 360.0).round() };
        grid_from_lon_lat(&geo, lon, lat)
    };
    if !may_meet(&exact, grid, source.size) {
        return Ok(());
    }
    let warp = GridWarp::new(grid.reach_m(), tolerance, exact);
    let whole = Block { column: 0, row: 0, width: grid.width(), height: grid.width() };
    let level = source.level_for(grid.spacing_m);
    let axes = Axes::of(source, level);
    let mut blocks = vec![whole];
    while let Some(block) = blocks.pop() {
        let Some(window) = window_of(&warp, grid, block, &axes) else { continue };
        if window.width * window.height > MOST_WINDOW_SAMPLES && block.width.max(block.height) > 1 {
            blocks.extend(halved(block));
            continue;
        }
        let mut samples = source.read(level, window)?;
        if source.spacing_m() > SMOOTH_SPACINGS * grid.spacing_m {
            samples.smooth();
        }
        let layer = layer.get_or_insert_with(|| {
            let count = grid.width() * grid.width();
            Layer { heights_m: vec![f32::NAN; count], inside: vec![false; count] }
        });
        fill(&warp, grid, block, &axes, (&samples, window), &source.parts, layer);
    }
    Ok(())
}

/// Whether any of a coarse net of places lies in a source, or the net is too coarse to say.
fn may_meet(exact: &impl Fn(DVec2) -> DVec2, grid: PlaneGrid, size: [usize; 2]) -> bool {
    const NET: i32 = 8;
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for (x, y) in (-NET..=NET).flat_map(|y| (-NET..=NET).map(move |x| (x, y))) {
        let at = exact(DVec2::new(f64::from(x), f64::from(y)) * (grid.reach_m() / f64::from(NET)));
        if at.is_finite() {
            (low, high) = (low.min(at), high.max(at));
        }
    }
    // what bulges out between two places of the net is far less than a cell of it
    let slack = (high - low) / f64::from(NET);
    let end = DVec2::new(size[0] as f64, size[1] as f64);
    low.x.is_finite() && (low - slack).cmplt(end).all() && (high + slack).cmpgt(DVec2::NEG_ONE).all()
}

/// Columns and rows of a level from those of the finest.
struct Axes {
    size: [usize; 2],
    points: [usize; 2],
    scale: f64,
}

impl Axes {
    fn of(source: &Source, level: u32) -> Self {
        Self { size: source.size, points: source.points(level), scale: 0.5f64.powi(level as i32) }
    }

    /// Where a place falls on the level; `None` outside of the source. The last point of a level stands on the last
    /// sample, nearer to the one before than the others.
    #[inline]
    fn on_level(&self, at: DVec2) -> Option<DVec2> {
        let axis = |v: f64, k: usize| {
            let (last, last_point) = ((self.size[k] - 1) as f64, (self.points[k] - 1) as f64);
            if !(v >= -HALF_CELL && v <= last + HALF_CELL) {
                return None;
            }
            let v = v.clamp(0.0, last);
            let regular = (last_point - 1.0) / self.scale;
            Some(if v <= regular { v * self.scale } else { last_point - 1.0 + (v - regular) / (last - regular) })
        };
        Some(DVec2::new(axis(at.x, 0)?, axis(at.y, 1)?))
    }
}

fn halved(block: Block) -> [Block; 2] {
    let Block { column, row, width, height } = block;
    if width >= height {
        let left = width / 2;
        [
            Block { width: left, ..block },
            Block { column: column + left, width: width - left, ..block },
        ]
    } else {
        let top = height / 2;
        [Block { height: top, ..block }, Block { row: row + top, height: height - top, ..block }]
    }
}

/// Maps one row of a block.
fn map_row<F: Fn(DVec2) -> DVec2>(warp: &GridWarp<F>, grid: PlaneGrid, block: Block, row: usize, out: &mut [DVec2]) {
    let half = f64::from(grid.half);
    let x_m = (block.column as f64 - half) * grid.spacing_m;
    warp.row((half - row as f64) * grid.spacing_m, x_m, grid.spacing_m, out);
}

/// The window of a level that a block needs; `None` when it needs nothing.
fn window_of<F: Fn(DVec2) -> DVec2>(warp: &GridWarp<F>, grid: PlaneGrid, block: Block, axes: &Axes) -> Option<Window> {
    const ROWS: usize = 32;
    let mut at = vec![DVec2::ZERO; block.width];
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for k in 0..=ROWS {
        map_row(warp, grid, block, block.row + k * (block.height - 1) / ROWS, &mut at);
        for at in at.iter().filter_map(|&at| axes.on_level(at)) {
            (low, high) = (low.min(at), high.max(at));
        }
    }
    if !low.is_finite() {
        return None;
    }
    let gap = (high - low) / ROWS as f64 * if block.height > ROWS { 1.0 } else { 0.0 };
    let axis = |k: usize| {
        let first = (low[k] - gap[k] - MARGIN).floor().max(0.0) as usize;
        let end = ((high[k] + gap[k] + MARGIN).ceil() as usize + 1).min(axes.points[k]);
        // at least two samples, between which something lies
        let first = first.min(end.saturating_sub(2));
        (first, end - first)
    };
    let ((column, width), (row, height)) = (axis(0), axis(1));
    Some(Window { column, row, width, height })
}

fn fill<F: Fn(DVec2) -> DVec2 + Sync>(
    warp: &GridWarp<F>,
    grid: PlaneGrid,
    block: Block,
    axes: &Axes,
    (samples, window): (&Samples, Window),
    parts: &[Window],
    layer: &mut Layer,
) {
    let origin = DVec2::new(window.column as f64, window.row as f64);
    let width = grid.width();
    let rows = layer.heights_m.par_chunks_mut(width).zip(layer.inside.par_chunks_mut(width)).enumerate();
    rows.skip(block.row).take(block.height).for_each_init(
        || vec![DVec2::ZERO; block.width],
        |at, (row, (heights_m, inside))| {
            map_row(warp, grid, block, row, at);
            let mut last = 0;
            let columns = block.column..block.column + block.width;
            let targets = heights_m[columns.clone()].iter_mut().zip(&mut inside[columns]);
            for (at, (height_m, inside)) in at.iter().zip(targets) {
                let Some(on_level) = axes.on_level(*at) else { continue };
                let z = samples.at(on_level.x - origin.x, on_level.y - origin.y);
                if !z.is_nan() {
                    (*height_m, *inside) = (z, true);
                } else if !*inside {
                    *inside = part_at(parts, *at, &mut last);
                }
            }
        },
    );
}

/// Whether a place lies in one of the parts; neighbours mostly lie in the same as the last one.
pub(super) fn part_at(parts: &[Window], at: DVec2, last: &mut usize) -> bool {
    let holds = |part: &Window| {
        let axis = |v: f64, first: usize, count: usize| {
            v >= first as f64 - HALF_CELL && v <= (first + count) as f64 - 1.0 + HALF_CELL
        };
        axis(at.x, part.column, part.width) && axis(at.y, part.row, part.height)
    };
    if parts.get(*last).is_some_and(holds) {
        return true;
    }
    parts.iter().position(holds).inspect(|&k| *last = k).is_some()
}
