//! Triangles and edges sorted into cells, for the places where no walk leads.

use super::walk::NONE;
use super::{Ground, area2, box_of, off_at_crossing_m};
use glam::{DVec2, DVec3};
use std::cell::{Cell, OnceCell};

/// Cells over a ground, each with what lies in it.
struct Cells {
    low: DVec2,
    cell_m: DVec2,
    size: [usize; 2],
    start: Vec<u32>,
    items: Vec<u32>,
}

/// Items in a cell, about.
const A_CELL: usize = 3;

impl Cells {
    /// Sorts `count` things by their boxes.
    fn new(bounds: [DVec2; 2], count: usize, box_of: impl Fn(usize) -> [DVec2; 2]) -> Self {
        let [low, high] = bounds;
        let extent = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let cells = (count / A_CELL + 1) as f64;
        let ratio = (extent.x / extent.y).clamp(1e-3, 1e3);
        let columns = (cells * ratio).sqrt().ceil().clamp(1.0, 4096.0);
        let rows = (cells / ratio).sqrt().ceil().clamp(1.0, 4096.0);
        let mut all = Self {
            low,
            cell_m: extent / DVec2::new(columns, rows),
            size: [columns as usize, rows as usize],
            start: vec![0; columns as usize * rows as usize + 1],
            items: Vec::new(),
        };
        for item in 0..count {
            all.for_each_cell(box_of(item), |start, cell| start[cell + 1] += 1);
        }
        for cell in 1..all.start.len() {
            all.start[cell] += all.start[cell - 1];
        }
        let mut next = all.start.clone();
        let mut items = vec![0; next.last().map_or(0, |&n| n as usize)];
        for item in 0..count {
            all.for_each_cell(box_of(item), |_, cell| {
                items[next[cell] as usize] = item as u32;
                next[cell] += 1;
            });
        }
        all.items = items;
        all
    }

    fn cell_of(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.low) / self.cell_m;
        // negative and huge values saturate
        [(at.x as usize).min(self.size[0] - 1), (at.y as usize).min(self.size[1] - 1)]
    }

    fn for_each_cell(&mut self, [low, high]: [DVec2; 2], mut visit: impl FnMut(&mut Vec<u32>, usize)) {
        let ([x0, y0], [x1, y1]) = (self.cell_of(low), self.cell_of(high));
        for y in y0..=y1 {
            for x in x0..=x1 {
                visit(&mut self.start, y * self.size[0] + x);
            }
        }
    }

    fn in_cell(&self, x: usize, y: usize) -> &[u32] {
        let cell = y * self.size[0] + x;
        &self.items[self.start[cell] as usize..self.start[cell + 1] as usize]
    }
}

/// How often all triangles are looked through, before sorting them into cells is worth its time.
const SCANS: u32 = 8;

/// Finds triangles by place.
pub(super) struct Finder<'a> {
    ground: Ground<'a>,
    bounds: [DVec2; 2],
    asked: Cell<u32>,
    cells: OnceCell<Cells>,
}

impl<'a> Finder<'a> {
    pub(super) fn new(ground: Ground<'a>, bounds: [DVec2; 2]) -> Self {
        Self { ground, bounds, asked: Cell::new(0), cells: OnceCell::new() }
    }

    /// The triangle at a place, or [`NONE`].
    pub(super) fn triangle_at(&self, p: DVec3) -> u32 {
        let is_at = |&&t: &&u32| {
            let [a, b, c] = self.ground.corners(t);
            let weights = [area2(b, c, p), area2(c, a, p), area2(a, b, p)];
            weights.iter().all(|w| *w >= 0.0) && weights.iter().sum::<f64>() > 0.0
        };
        if self.asked.replace(self.asked.get() + 1) < SCANS {
            return (0..self.ground.triangles.len() as u32).find(|t| is_at(&t)).unwrap_or(NONE);
        }
        let of = |t: usize| box_of(&self.ground.corners(t as u32));
        let cells = self.cells.get_or_init(|| Cells::new(self.bounds, self.ground.triangles.len(), of));
        let [x, y] = cells.cell_of(p.truncate());
        cells.in_cell(x, y).iter().find(is_at).copied().unwrap_or(NONE)
    }
}

/// The edges of a ground by cells.
pub(super) struct EdgeCells {
    edges: Vec<[DVec3; 2]>,
    cells: Cells,
}

impl EdgeCells {
    pub(super) fn new(ground: Ground<'_>, bounds: [DVec2; 2]) -> Self {
        let mut edges: Vec<[u32; 2]> = (ground.triangles.iter())
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)].map(|(u, v)| [u.min(v), u.max(v)]))
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let edges: Vec<[DVec3; 2]> = edges.iter().map(|e| e.map(|v| ground.positions[v as usize])).collect();
        let cells = Cells::new(bounds, edges.len(), |e| box_of(&edges[e]));
        Self { edges, cells }
    }

    /// The greatest height difference where the edge from p to q crosses one of these.
    pub(super) fn worst_crossing_m(&self, [p, q]: [DVec3; 2]) -> f64 {
        let [low, high] = box_of(&[p, q]);
        let ([x0, y0], [x1, y1]) = (self.cells.cell_of(low), self.cells.cell_of(high));
        let mut worst_m = 0.0f64;
        for (x, y) in (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| (x, y))) {
            for &other in self.cells.in_cell(x, y) {
                let [a, b] = self.edges[other as usize];
                let (sp, sq) = (area2(a, b, p), area2(a, b, q));
                let (sa, sb) = (area2(p, q, a), area2(p, q, b));
                if sp * sq < 0.0 && sa * sb < 0.0 {
                    worst_m = worst_m.max(off_at_crossing_m([p, q], [a, b], sa / (sa - sb)));
                }
            }
        }
        worst_m
    }
}
