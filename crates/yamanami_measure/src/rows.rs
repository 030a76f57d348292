//! Triangles laid over the rows of a grid: sorted into bands of rows, cut by a row.
//!
//! The rows are cut into bands that are worked on in parallel; which band holds which triangles does not depend on the
//! number of threads.

use rayon::prelude::*;

/// Rows of a band: few enough for the band's distances to stay in cache, enough for triangles to be set up seldom.
pub(crate) const BAND_ROWS: usize = 32;
/// Triangles sorted into bands by one task.
const TRIANGLE_CHUNK: usize = 1 << 16;
/// Vertices this close to a sample position (relative to the grid's extent) are at it: `column * step / step` is not
/// always `column`.
const SNAP_RELATIVE: f64 = 1e-11;
/// How far outside a triangle, in cells, a sample may be measured against it where none touches it: single-precision
/// files move the border by about this much.
pub(crate) const REACH_CELLS: f64 = 1e-3;

/// A triangle corner in grid units: column, row, height in metres.
pub(crate) type Corner = [f64; 3];

/// Moves a column or row of a grid with so many samples a side onto the sample within rounding of it.
pub(crate) fn onto_samples(longer_side: usize) -> impl Fn(f64) -> f64 + Sync {
    let snap = SNAP_RELATIVE * longer_side as f64;
    move |g: f64| {
        let nearest = g.round();
        if (g - nearest).abs() <= snap { nearest } else { g }
    }
}

/// Twice the plan area of a triangle in cells; the sign is that of the turn in (column, row), where rows run south.
pub(crate) fn double_area([a, b, c]: [Corner; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// All triangles, sorted into the bands of a grid of `height` rows.
pub(crate) fn chunks(triangles: &[[u32; 3]], corners: &[Corner], height: usize) -> Vec<Chunk> {
    let bands = height.div_ceil(BAND_ROWS);
    triangles.par_chunks(TRIANGLE_CHUNK).map(|run| Chunk::sort(run, corners, bands, height)).collect()
}

/// A run of triangles, sorted by the bands they touch.
pub(crate) struct Chunk {
    /// Where each band's triangles start in `triangles`, plus the end.
    starts: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// Plan area of all of them, cells.
    pub(crate) area_cells: f64,
}

impl Chunk {
    fn sort(triangles: &[[u32; 3]], corners: &[Corner], bands: usize, height: usize) -> Self {
        let mut starts = vec![0u32; bands + 1];
        let mut area_cells = 0.0;
        let ranges: Vec<Option<[u32; 2]>> = triangles
            .iter()
            .map(|t| {
                let t = t.map(|i| corners[i as usize]);
                let area = double_area(t).abs();
                let finite = t.iter().all(|c| c[2].is_finite()) && area.is_finite();
                if !finite || area == 0.0 {
                    return None;
                }
                area_cells += area * 0.5;
                let rows = t.map(|c| c[1]);
                let first = rows.iter().fold(f64::INFINITY, |a, &b| a.min(b)) - REACH_CELLS;
                let last = rows.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b)) + REACH_CELLS;
                let [first, last] = [first.ceil().max(0.0), last.floor().min((height - 1) as f64)];
                (first <= last).then(|| [first as usize / BAND_ROWS, last as usize / BAND_ROWS].map(|b| b as u32))
            })
            .collect();
        for &[first, last] in ranges.iter().flatten() {
            for band in first..=last {
                starts[band as usize + 1] += 1;
            }
        }
        for band in 0..bands {
            starts[band + 1] += starts[band];
        }
        let mut sorted = vec![[0; 3]; starts[bands] as usize];
        let mut next = starts.clone();
        for (t, range) in triangles.iter().zip(&ranges) {
            let Some([first, last]) = *range else { continue };
            for band in first..=last {
                sorted[next[band as usize] as usize] = *t;
                next[band as usize] += 1;
            }
        }
        Self { starts, triangles: sorted, area_cells }
    }

    /// All triangles of all chunks that touch a band, in their order.
    pub(crate) fn band_of(chunks: &[Self], band: usize) -> impl Iterator<Item = &[u32; 3]> {
        chunks.iter().flat_map(move |chunk| chunk.band(band))
    }

    fn band(&self, band: usize) -> &[[u32; 3]] {
        &self.triangles[self.starts[band] as usize..self.starts[band + 1] as usize]
    }
}

/// Where the line of constant row `y`, which meets the triangle, enters and leaves it. An edge shared by two triangles
/// gives both the same value, whichever way round they name it.
pub(crate) fn span([a, b, c]: [Corner; 3], y: f64) -> [f64; 2] {
    let (mut west, mut east) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut meet = |x: f64| (west, east) = (west.min(x), east.max(x));
    for [p, q] in [[a, b], [b, c], [c, a]] {
        let [from, to] = if (p[1], p[0]) <= (q[1], q[0]) { [p, q] } else { [q, p] };
        if y < from[1] || y > to[1] {
            continue;
        }
        if y == from[1] {
            meet(from[0]);
        }
        if y == to[1] {
            meet(to[0]);
        } else if y != from[1] {
            meet(from[0] + (to[0] - from[0]) * ((y - from[1]) / (to[1] - from[1])));
        }
    }
    [west, east]
}
