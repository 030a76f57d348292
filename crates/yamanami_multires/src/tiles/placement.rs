//! Where the samples of a terrain lie in tile space.

/// A map between tile space and the terrain's grid.
type Map = Box<dyn Fn([f64; 2]) -> [f64; 2] + Send + Sync>;

/// Where the samples of a terrain lie in tile space.
pub struct Placement {
    kind: Kind,
    lift: Option<Lift>,
}

/// Metres to add to heights at a (column, row).
type Lift = Box<dyn Fn([f64; 2]) -> f64 + Send + Sync>;

enum Kind {
    /// Columns run east or west, rows north or south: a coordinate for each.
    Axes { x: Vec<f64>, y: Vec<f64> },
    /// Any smooth map from (column, row), its inverse, and how much a step in either may move a place:
    /// x by column, x by row, y by column, y by row.
    Warped { size: [u32; 2], to_tiles: Map, to_grid: Map, stretch: [f64; 4] },
}

impl std::fmt::Debug for Placement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Placement").field("size", &self.size()).finish_non_exhaustive()
    }
}

/// Places along a side that are looked at for how much a map stretches.
const PROBES: usize = 33;

/// What the map may stretch more between them.
const STRETCH_MARGIN: f64 = 1.02;

impl Placement {
    /// A grid whose columns lie at `x` and rows at `y`; both run steadily up or down.
    pub fn axes(x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { kind: Kind::Axes { x, y }, lift: None }
    }

    /// A grid of `size` (columns, rows) under a smooth map from (column, row) to tile space; `to_grid` is its inverse.
    pub fn warped(
        size: [u32; 2],
        to_tiles: impl Fn([f64; 2]) -> [f64; 2] + Send + Sync + 'static,
        to_grid: impl Fn([f64; 2]) -> [f64; 2] + Send + Sync + 'static,
    ) -> Self {
        let mut stretch = [0f64; 4];
        for (i, k) in (0..PROBES).flat_map(|i| (0..PROBES).map(move |k| (i, k))) {
            let place = |i: usize, size: u32| f64::from(size - 1) * i as f64 / (PROBES - 1) as f64;
            let at = [place(i, size[0]), place(k, size[1])];
            for axis in 0..2 {
                let [mut low, mut high] = [at, at];
                low[axis] -= 0.5;
                high[axis] += 0.5;
                let (low, high) = (to_tiles(low), to_tiles(high));
                for to in 0..2 {
                    stretch[2 * to + axis] = stretch[2 * to + axis].max((high[to] - low[to]).abs());
                }
            }
        }
        let stretch = stretch.map(|s| s * STRETCH_MARGIN);
        let kind = Kind::Warped { size, to_tiles: Box::new(to_tiles), to_grid: Box::new(to_grid), stretch };
        Self { kind, lift: None }
    }

    /// Adds metres, as a smooth function of (column, row), to all heights of the terrain.
    pub fn lifted(self, lift: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static) -> Self {
        Self { lift: Some(Box::new(lift)), ..self }
    }

    /// Metres to add to heights at a (column, row).
    #[inline]
    pub(crate) fn lift_m(&self, at: [f64; 2]) -> f64 {
        self.lift.as_ref().map_or(0.0, |lift| lift(at))
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        match &self.kind {
            Kind::Axes { x, y } => [x.len() as u32, y.len() as u32],
            Kind::Warped { size, .. } => *size,
        }
    }

    /// Whether straight lines of the grid are not straight in tile space.
    pub fn is_warped(&self) -> bool {
        matches!(self.kind, Kind::Warped { .. })
    }

    /// Tile space of a sample.
    #[inline]
    pub fn place(&self, [column, row]: [u32; 2]) -> [f64; 2] {
        match &self.kind {
            Kind::Axes { x, y } => [x[column as usize], y[row as usize]],
            Kind::Warped { to_tiles, .. } => to_tiles([f64::from(column), f64::from(row)]),
        }
    }

    /// Tile space of a place that may lie outside of the grid.
    pub(crate) fn beyond(&self, [column, row]: [i64; 2]) -> [f64; 2] {
        match &self.kind {
            Kind::Axes { x, y } => {
                let at = |values: &[f64], k: i64| {
                    let last = values.len() - 1;
                    match k {
                        k if k < 0 => values[0] + k as f64 * (values[1] - values[0]),
                        k if k > last as i64 => {
                            values[last] + (k - last as i64) as f64 * (values[last] - values[last - 1])
                        }
                        k => values[k as usize],
                    }
                };
                [at(x, column), at(y, row)]
            }
            Kind::Warped { to_tiles, .. } => to_tiles([column as f64, row as f64]),
        }
    }

    /// More than the greatest distance of neighbouring samples in tile space.
    pub(crate) fn widest_step(&self) -> f64 {
        let most = |values: &[f64]| values.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        match &self.kind {
            Kind::Axes { x, y } => most(x).max(most(y)),
            Kind::Warped { stretch, .. } => stretch.iter().copied().fold(0.0, f64::max) * 2.0,
        }
    }

    /// Column and row, between samples, of a place; past the grid they run on.
    pub fn grid(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        match &self.kind {
            Kind::Axes { x: xs, y: ys } => [along(xs, x), along(ys, y)],
            Kind::Warped { to_grid, .. } => to_grid([x, y]),
        }
    }

    /// Tile space, x from..to and y from..to, that surely holds all samples within `half` columns and rows of a place on the
    /// grid, which may lie past its end. A larger reach around a place that holds a smaller one is never less.
    #[inline]
    pub(crate) fn reach(&self, [column, row]: [i64; 2], half: [i64; 2]) -> [[f64; 2]; 2] {
        match &self.kind {
            Kind::Axes { x, y } => {
                let side = |values: &[f64], at: i64, half: i64| {
                    let last = values.len() as i64 - 1;
                    let [a, b] = [at - half, at + half].map(|k| values[k.clamp(0, last) as usize]);
                    [a.min(b), a.max(b)]
                };
                [side(x, column, half[0]), side(y, row, half[1])]
            }
            Kind::Warped { size, to_tiles, stretch, .. } => {
                let clamp = |k: i64, size: u32| k.clamp(0, i64::from(size) - 1) as f64;
                let middle = to_tiles([clamp(column, size[0]), clamp(row, size[1])]);
                let [dc, dr] = half.map(|h| h as f64);
                let spread = [stretch[0] * dc + stretch[1] * dr, stretch[2] * dc + stretch[3] * dr];
                [0, 1].map(|axis| [middle[axis] - spread[axis], middle[axis] + spread[axis]])
            }
        }
    }

    /// Least distance of neighbouring samples in tile space, as far as it is looked at.
    pub fn spacing(&self) -> f64 {
        let least = |values: &[f64]| values.windows(2).map(|w| (w[1] - w[0]).abs()).fold(f64::INFINITY, f64::min);
        match &self.kind {
            Kind::Axes { x, y } => least(x).min(least(y)),
            Kind::Warped { size, to_tiles, .. } => {
                let at = size.map(|n| f64::from(n - 1) / 2.0);
                let middle = to_tiles(at);
                let step = |by: [f64; 2]| {
                    let next = to_tiles([at[0] + by[0], at[1] + by[1]]);
                    (next[0] - middle[0]).hypot(next[1] - middle[1])
                };
                step([1.0, 0.0]).min(step([0.0, 1.0]))
            }
        }
    }

    /// Tile space, x from..to and y from..to, of the whole grid.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        match &self.kind {
            Kind::Axes { x, y } => [x, y].map(|v| {
                let (a, b) = (v[0], v[v.len() - 1]);
                [a.min(b), a.max(b)]
            }),
            Kind::Warped { size: [w, h], .. } => {
                let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
                let mut include = |sample: [u32; 2]| {
                    for (b, v) in bounds.iter_mut().zip(self.place(sample)) {
                        *b = [b[0].min(v), b[1].max(v)];
                    }
                };
                (0..*w).for_each(|c| [0, h - 1].into_iter().for_each(|r| include([c, r])));
                (0..*h).for_each(|r| [0, w - 1].into_iter().for_each(|c| include([c, r])));
                bounds
            }
        }
    }
}

/// Where a value lies among steady ones, between them and past their ends.
fn along(values: &[f64], value: f64) -> f64 {
    let last = values.len() - 1;
    let rising = values[last] > values[0];
    let after = values.partition_point(|&v| if rising { v <= value } else { v >= value });
    let k = after.clamp(1, last) - 1;
    k as f64 + (value - values[k]) / (values[k + 1] - values[k])
}
