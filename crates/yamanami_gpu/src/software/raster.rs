//! Which triangle shows at each sample: exact coverage and a depth buffer, for one band of rows.

use super::place::{SUBPIXELS, ScreenTriangle};
use std::ops::Range;

/// Where a sample lies in its pixel, in sub-pixels right and down.
pub(super) type Sample = [i64; 2];

/// The middle of the pixel.
pub(super) const CENTRE: [Sample; 1] = [[128, 128]];

/// The usual rotated grid of four samples a pixel.
pub(super) const FOUR_SAMPLES: [Sample; 4] = [[96, 32], [224, 96], [32, 160], [160, 224]];

/// Marks a sample that no triangle covers.
pub(super) const NOTHING: u32 = u32::MAX;

/// What shows in a band of rows, `N` samples a pixel.
#[derive(Debug)]
pub(super) struct Band<const N: usize> {
    width: usize,
    rows: Range<usize>,
    inverse_depth: Vec<[f32; N]>,
    slots: Vec<[u32; N]>,
}

impl<const N: usize> Band<N> {
    pub(super) fn new(size_px: [usize; 2], rows: Range<usize>) -> Self {
        let pixels = size_px[0] * rows.len();
        Self { width: size_px[0], rows, inverse_depth: vec![[0.0; N]; pixels], slots: vec![[NOTHING; N]; pixels] }
    }

    /// Columns of the picture.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// First row of the picture in this band.
    pub(super) fn first_row(&self) -> usize {
        self.rows.start
    }

    /// Triangle slots at the samples of every pixel, row by row.
    pub(super) fn slots(&self) -> &[[u32; N]] {
        &self.slots
    }

    /// Triangle slots at all covered samples.
    pub(super) fn shown_slots(&self) -> impl Iterator<Item = u32> + '_ {
        self.slots.iter().flatten().copied().filter(|&slot| slot != NOTHING)
    }

    /// 1 / depth of the farthest sample of every pixel, 0 where the background shows.
    pub(super) fn farthest(&self) -> impl Iterator<Item = f32> + '_ {
        self.inverse_depth.iter().map(|depths| depths.iter().fold(f32::INFINITY, |a, &b| a.min(b)))
    }

    /// Number of samples covered.
    pub(super) fn covered_samples(&self) -> u64 {
        self.shown_slots().count() as u64
    }

    /// Draws a triangle where it is nearer than what is there.
    pub(super) fn draw(&mut self, triangle: &ScreenTriangle, samples: &[Sample; N]) {
        let [columns, rows] = triangle.pixel_box([self.width as u32, self.rows.end as u32]);
        let rows = rows.start.max(self.rows.start)..rows.end;
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let edges = Edge::around(triangle);
        let [z0, z1, z2] = triangle.inverse_depth;
        // Edge i is opposite to corner i + 2; its value over the area is that corner's share.
        let per_area = 1.0 / edges[0].value_at(triangle.corners[2]) as f64;
        let (to_1, to_2) = (f64::from(z1 - z0) * per_area, f64::from(z2 - z0) * per_area);
        let z_at = |e: [i64; 3]| (f64::from(z0) + e[2] as f64 * to_1 + e[0] as f64 * to_2) as f32;
        let z_step = ((edges[2].dx as f64 * to_1 + edges[0].dx as f64 * to_2) * SUBPIXELS as f64) as f32;
        let bias = edges.map(|edge| edge.bias());
        let offsets = samples.map(|s| [0, 1, 2].map(|i| edges[i].dx * s[0] + edges[i].dy * s[1] + bias[i]));
        let step = edges.map(|edge| edge.dx * SUBPIXELS);
        for row in rows {
            let corner = [columns.start as i64 * SUBPIXELS, row as i64 * SUBPIXELS];
            let mut e = edges.map(|edge| edge.value_at(corner));
            let mut z = samples.map(|s| z_at(edges.map(|edge| edge.value_at([corner[0] + s[0], corner[1] + s[1]]))));
            let start = (row - self.rows.start) * self.width;
            let span = start + columns.start..start + columns.end;
            for (depths, slots) in self.inverse_depth[span.clone()].iter_mut().zip(&mut self.slots[span]) {
                for s in 0..N {
                    let o = offsets[s];
                    let inside = (e[0] + o[0]) | (e[1] + o[1]) | (e[2] + o[2]);
                    if inside >= 0 && z[s] > depths[s] {
                        depths[s] = z[s];
                        slots[s] = triangle.slot;
                    }
                    z[s] += z_step;
                }
                for i in 0..3 {
                    e[i] += step[i];
                }
            }
        }
    }
}

/// A line through two corners: positive inside the triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    /// Growth per sub-pixel to the right and down.
    pub(super) dx: i64,
    pub(super) dy: i64,
    at: [i64; 2],
}

impl Edge {
    pub(super) fn around(triangle: &ScreenTriangle) -> [Self; 3] {
        [0, 1, 2].map(|i| {
            let (from, to) = (triangle.corners[i], triangle.corners[(i + 1) % 3]);
            Self { dx: from[1] - to[1], dy: to[0] - from[0], at: from }
        })
    }

    pub(super) fn value_at(self, p: [i64; 2]) -> i64 {
        self.dx * (p[0] - self.at[0]) + self.dy * (p[1] - self.at[1])
    }

    /// Growth per sub-pixel across the line.
    pub(super) fn length(self) -> f64 {
        (self.dx as f64).hypot(self.dy as f64)
    }

    /// The top-left rule: a sample on an edge belongs to the triangle whose left or top edge it is.
    fn bias(self) -> i64 {
        let left_or_top = self.dx > 0 || (self.dx == 0 && self.dy > 0);
        if left_or_top { 0 } else { -1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn triangle(mut corners: [[i64; 2]; 3], slot: u32) -> Option<ScreenTriangle> {
        let [a, b, c] = corners;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area < 0 {
            corners.swap(1, 2);
        }
        (area != 0).then_some(ScreenTriangle { corners, inverse_depth: [1.0; 3], slot })
    }

    proptest! {
        /// A fan around any inner point of a rectangle covers each of its samples exactly once.
        #[test]
        fn a_fan_is_watertight(x in 1i64..4095, y in 1i64..4095, turn in 0usize..3) {
            let (low, high) = (0, 16 * SUBPIXELS);
            let ring = [[low, low], [high, low], [high, high], [low, high]];
            let mut count = 0;
            for i in 0..4 {
                let mut corners = [ring[i], ring[(i + 1) % 4], [x, y]];
                corners.rotate_left(turn);
                if let Some(triangle) = triangle(corners, i as u32) {
                    let mut alone = Band::<4>::new([20, 20], 0..20);
                    alone.draw(&triangle, &FOUR_SAMPLES);
                    count += alone.covered_samples();
                }
            }
            prop_assert_eq!(count, 16 * 16 * 4);
        }
    }

    #[test]
    fn the_nearer_triangle_shows_whatever_the_order() {
        let mut near = triangle([[0, 0], [2048, 0], [0, 2048]], 1).unwrap();
        near.inverse_depth = [2.0; 3];
        let far = triangle([[0, 0], [2048, 0], [0, 2048]], 2).unwrap();
        for order in [[&near, &far], [&far, &near]] {
            let mut band = Band::<1>::new([8, 8], 0..8);
            order.into_iter().for_each(|t| band.draw(t, &CENTRE));
            assert!(band.slots().iter().flatten().all(|&slot| slot == 1 || slot == NOTHING));
            assert_eq!(band.covered_samples(), 28, "middles on the diagonal belong to the other side");
        }
    }
}
