//! Rectangles in plan, to find those that touch one.
//!
//! Based on: Kamel, Faloutsos, "On Packing R-trees", 1993: sorted along a space-filling curve (ours is Morton's), then packed
//! level upon level, so that a node's children need no numbers.

use glam::DVec3;
use rayon::prelude::*;

/// Children of a node.
const FAN: usize = 8;

/// A rectangle in plan, metres, its sides in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rect {
    min: [f64; 2],
    max: [f64; 2],
}

impl Rect {
    const EMPTY: Self = Self { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };

    pub(super) fn around(places: &[DVec3]) -> Self {
        places.iter().fold(Self::EMPTY, |rect, p| rect.join(&Self { min: [p.x, p.y], max: [p.x, p.y] }))
    }

    fn join(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| self.min[k].min(other.min[k])),
            max: std::array::from_fn(|k| self.max[k].max(other.max[k])),
        }
    }

    /// The same without its sides: what only touches them is not met.
    pub(super) fn shrunk(&self) -> Self {
        Self { min: self.min.map(f64::next_up), max: self.max.map(f64::next_down) }
    }

    #[inline]
    fn meets(&self, other: &Self) -> bool {
        self.min[0] <= other.max[0]
            && other.min[0] <= self.max[0]
            && self.min[1] <= other.max[1]
            && other.min[1] <= self.max[1]
    }
}

/// The rectangles, packed.
#[derive(Debug)]
pub(super) struct Tree {
    /// The leaves' numbers along the curve.
    order: Vec<u32>,
    /// By number.
    rects: Vec<Rect>,
    /// From the leaves, along the curve, to the root.
    levels: Vec<Vec<Rect>>,
}

impl Tree {
    pub(super) fn new(rects: Vec<Rect>) -> Self {
        let whole = rects.iter().fold(Rect::EMPTY, |whole, rect| whole.join(rect));
        let scale = [0, 1].map(|k| f64::from(u16::MAX) / (whole.max[k] - whole.min[k]).max(f64::MIN_POSITIVE));
        let mut keyed: Vec<(u32, u32)> = rects
            .par_iter()
            .enumerate()
            .map(|(number, rect)| {
                // the middle without a sum, which could overflow; to whole numbers, saturating
                let cell = [0, 1].map(|k| {
                    let middle = 0.5 * (rect.min[k] - whole.min[k]) + 0.5 * (rect.max[k] - whole.min[k]);
                    spread((middle * scale[k]) as u16)
                });
                (cell[0] | cell[1] << 1, number as u32)
            })
            .collect();
        keyed.par_sort_unstable();
        let order: Vec<u32> = keyed.into_iter().map(|(_, number)| number).collect();
        let mut levels = vec![order.iter().map(|&number| rects[number as usize]).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > FAN) {
            let join = |children: &[Rect]| children.iter().fold(Rect::EMPTY, |all, rect| all.join(rect));
            let level = below.par_chunks(FAN).map(join).collect();
            levels.push(level);
        }
        Self { order, rects, levels }
    }

    /// Numbers along the curve: neighbours in plan are mostly neighbours here.
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    pub(super) fn rect(&self, number: u32) -> &Rect {
        &self.rects[number as usize]
    }

    /// Whether any rectangle that meets `rect` is it, by number.
    pub(super) fn any(&self, rect: &Rect, is_it: impl Fn(u32) -> bool) -> bool {
        self.any_below(self.levels.len() - 1, 0..self.levels[self.levels.len() - 1].len(), rect, &is_it)
    }

    fn any_below(
        &self,
        level: usize,
        places: std::ops::Range<usize>,
        rect: &Rect,
        is_it: &impl Fn(u32) -> bool,
    ) -> bool {
        places.into_iter().any(|place| {
            self.levels[level][place].meets(rect)
                && if level == 0 {
                    is_it(self.order[place])
                } else {
                    let first = place * FAN;
                    let end = (first + FAN).min(self.levels[level - 1].len());
                    self.any_below(level - 1, first..end, rect, is_it)
                }
        })
    }
}

/// The bits of a number, each at twice its place.
fn spread(number: u16) -> u32 {
    let mut n = u32::from(number);
    n = (n | n << 8) & 0x00ff_00ff;
    n = (n | n << 4) & 0x0f0f_0f0f;
    n = (n | n << 2) & 0x3333_3333;
    (n | n << 1) & 0x5555_5555
}
