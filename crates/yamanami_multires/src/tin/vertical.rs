//! The greatest vertical distance between two TINs of one ground, exactly.
//!
//! Both surfaces are linear on each piece of their overlay, so their difference is greatest at a corner of a piece: a vertex
//! of one of them, or a place where an edge of one crosses an edge of the other in plan.

use glam::{DVec2, DVec3};

/// A triangulation without overlap in plan, its places relative to something near.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub positions: &'a [DVec3],
    pub triangles: &'a [[u32; 3]],
}

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

fn plan(p: DVec3) -> DVec2 {
    DVec2::new(p.x, p.y)
}

fn box_of(points: &[DVec3]) -> [DVec2; 2] {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for &p in points {
        low = low.min(plan(p));
        high = high.max(plan(p));
    }
    [low, high]
}

/// Twice the area, seen from above.
fn area2(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

impl<'a> Ground<'a> {
    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    fn cells(&self, bounds: [DVec2; 2]) -> Cells {
        Cells::new(bounds, self.triangles.len(), |t| box_of(&self.corners(t)))
    }

    /// The greatest height difference at `points`, where this ground is.
    fn at_points(&self, cells: &Cells, points: impl Iterator<Item = DVec3>) -> f64 {
        let mut worst_m = 0.0f64;
        for p in points {
            let [x, y] = cells.cell_of(plan(p));
            for &t in cells.in_cell(x, y) {
                let [a, b, c] = self.corners(t as usize);
                let (wa, wb, wc) = (area2(b, c, p), area2(c, a, p), area2(a, b, p));
                if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 && wa + wb + wc > 0.0 {
                    let z = (wa * a.z + wb * b.z + wc * c.z) / (wa + wb + wc);
                    worst_m = worst_m.max((z - p.z).abs());
                    break;
                }
            }
        }
        worst_m
    }

    /// Its edges, each once, from the lower number to the higher.
    fn edges(&self) -> Vec<u64> {
        let mut edges = Vec::with_capacity(3 * self.triangles.len());
        for &[a, b, c] in self.triangles {
            for (u, v) in [(a, b), (b, c), (c, a)] {
                edges.push(u64::from(u.min(v)) << 32 | u64::from(u.max(v)));
            }
        }
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    fn ends(&self, edge: u64) -> [DVec3; 2] {
        [(edge >> 32) as usize, edge as u32 as usize].map(|v| self.positions[v])
    }
}

/// The greatest difference where an edge of one crosses an edge of the other.
fn at_crossings(fine: &Ground<'_>, coarse: &Ground<'_>, bounds: [DVec2; 2]) -> f64 {
    let (fine_edges, coarse_edges) = (fine.edges(), coarse.edges());
    let cells = Cells::new(bounds, coarse_edges.len(), |e| box_of(&coarse.ends(coarse_edges[e])));
    let mut worst_m = 0.0f64;
    for &edge in &fine_edges {
        let [p, q] = fine.ends(edge);
        let [low, high] = box_of(&[p, q]);
        let ([x0, y0], [x1, y1]) = (cells.cell_of(low), cells.cell_of(high));
        for y in y0..=y1 {
            for x in x0..=x1 {
                for &other in cells.in_cell(x, y) {
                    let [a, b] = coarse.ends(coarse_edges[other as usize]);
                    let (sp, sq) = (area2(a, b, p), area2(a, b, q));
                    if sp * sq >= 0.0 {
                        continue;
                    }
                    let (sa, sb) = (area2(p, q, a), area2(p, q, b));
                    if sa * sb >= 0.0 {
                        continue;
                    }
                    let (t, s) = (sp / (sp - sq), sa / (sa - sb));
                    let difference_m = (p.z + t * (q.z - p.z)) - (a.z + s * (b.z - a.z));
                    worst_m = worst_m.max(difference_m.abs());
                }
            }
        }
    }
    worst_m
}

/// The greatest vertical distance, metres, between two TINs where both are.
pub(crate) fn vertical_distance_m(fine: Ground<'_>, coarse: Ground<'_>) -> f64 {
    let bounds = box_of(fine.positions);
    let over = coarse.at_points(&coarse.cells(bounds), fine.positions.iter().copied());
    let under = fine.at_points(&fine.cells(bounds), coarse.positions.iter().copied());
    over.max(under).max(at_crossings(&fine, &coarse, bounds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_diagonals_of_a_square_differ_in_its_middle() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let positions = [at(0.0, 0.0, 0.0), at(2.0, 0.0, 3.0), at(2.0, 2.0, 0.0), at(0.0, 2.0, 3.0)];
        let one = Ground { positions: &positions, triangles: &[[0, 1, 2], [0, 2, 3]] };
        let other = Ground { positions: &positions, triangles: &[[0, 1, 3], [1, 2, 3]] };
        assert_eq!(vertical_distance_m(one, other), 3.0);
        assert_eq!(vertical_distance_m(one, one), 0.0);
    }

    #[test]
    fn a_peak_left_out_is_its_height() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let positions = [at(0.0, 0.0, 0.0), at(4.0, 0.0, 0.0), at(0.0, 4.0, 0.0), at(1.0, 1.0, 7.0)];
        let fine = Ground { positions: &positions, triangles: &[[0, 1, 3], [1, 2, 3], [2, 0, 3]] };
        let coarse = Ground { positions: &positions[..3], triangles: &[[0, 1, 2]] };
        assert_eq!(vertical_distance_m(fine, coarse), 7.0);
        assert_eq!(vertical_distance_m(coarse, fine), 7.0);
    }
}
