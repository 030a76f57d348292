//! An edge looked at before it is collapsed: the triangles around its ends, whether the surface stays one and in shape,
//! and where the vertices that went before would come to lie.

use super::net::{Kind, NONE, Net};
use super::points::Points;
use super::{LEAST_SHAPE, MOST_AROUND, THINNEST, Way, area2};
use glam::{DVec2, DVec3};

/// A triangle around one end that does not have the other: it stays.
#[derive(Debug, Clone, Copy)]
struct Side {
    triangle: u32,
    from: u32,
    to: u32,
}

/// A triangle of the fan around the new vertex, relative to that.
#[derive(Debug, Clone, Copy)]
struct Wedge {
    from: DVec3,
    to: DVec3,
    /// Twice its area in plan.
    area2: f64,
    triangle: u32,
}

/// What was seen around an edge. Kept from edge to edge for its room.
#[derive(Debug, Default)]
pub(super) struct Look {
    /// The triangles that stay around each end.
    sides: [Vec<Side>; 2],
    fan: Vec<Wedge>,
    /// Vertices that went before, each with the triangle of the fan that it comes to lie under.
    under: Vec<(u32, u32)>,
    /// For each vertex when it was last seen.
    marks: Vec<u32>,
    now: u32,
}

fn cross(a: DVec3, b: DVec3) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Area in plan, twice, and the longest side squared.
fn shape(a: DVec3, b: DVec3, c: DVec3) -> (f64, f64) {
    let flat = |p: DVec3, q: DVec3| DVec2::new(q.x - p.x, q.y - p.y).length_squared();
    let longest2 = flat(a, b).max(flat(b, c)).max(flat(c, a));
    (area2(a, b, c), longest2.max(f64::MIN_POSITIVE))
}

impl Look {
    pub(super) fn new(vertices: usize) -> Self {
        Self { marks: vec![0; vertices], ..Self::default() }
    }

    /// Marks a vertex, and tells whether it had the mark.
    fn mark(&mut self, v: u32, mark: u32) -> bool {
        std::mem::replace(&mut self.marks[v as usize], mark) == mark
    }

    /// Looks at the edge from u to v. Whether the surface stays one: the neighbours of both are the tips of the triangles
    /// of both, and no line closes.
    pub(super) fn may_join(&mut self, net: &Net, u: u32, v: u32) -> bool {
        let (mut count, mut tips) = (0, [NONE; 2]);
        for (own, other, sides) in [(u, v, 0), (v, u, 1)] {
            let sides = &mut self.sides[sides];
            sides.clear();
            for corner in net.corners(own) {
                let [_, from, to] = net.turned(corner);
                if from != other && to != other {
                    sides.push(Side { triangle: corner / 3, from, to });
                } else if own == u {
                    if count == 2 {
                        return false;
                    }
                    tips[count] = if from == other { to } else { from };
                    count += 1;
                }
            }
        }
        if count == 0 || closes_line(net, u, v, &tips[..count]) {
            return false;
        }
        self.now += 2;
        let (first, both) = (self.now - 1, self.now);
        let mut around = 0;
        for i in 0..count {
            around += usize::from(!self.mark(tips[i], first));
        }
        for i in 0..self.sides[0].len() {
            let Side { from, to, .. } = self.sides[0][i];
            around += usize::from(!self.mark(from, first));
            around += usize::from(!self.mark(to, first));
        }
        let mut common = 0;
        for i in 0..self.sides[1].len() {
            let Side { from, to, .. } = self.sides[1][i];
            for w in [from, to] {
                if self.marks[w as usize] == first {
                    self.marks[w as usize] = both;
                    common += usize::from(!tips[..count].contains(&w));
                }
            }
        }
        common == 0 && around + count + self.sides[1].len() <= MOST_AROUND + 4
    }

    /// Whether every triangle that stays keeps its side up and does not become a sliver.
    pub(super) fn keeps_shape(&self, net: &Net, u: u32, way: &Way) -> bool {
        let p = |v: u32| net.positions[v as usize];
        let is_sound = |v: u32| {
            self.sides[usize::from(v != u)].iter().all(|side| {
                let (area, longest2) = shape(way.place, p(side.from), p(side.to));
                area > 0.0
                    && area > THINNEST * longest2
                    && (area >= LEAST_SHAPE * longest2 || {
                        let (before, longest2_before) = shape(p(v), p(side.from), p(side.to));
                        area * longest2_before >= before * longest2
                    })
            })
        };
        is_sound(way.gone) && (way.place == p(way.kept) || is_sound(way.kept))
    }

    /// Finds where the vertices that went before, and those of the edge, come to lie under the fan around the new vertex:
    /// the greatest square of their heights below or above it, and its area.
    pub(super) fn lift(&mut self, net: &Net, points: &Points, u: u32, way: &Way) -> (f64, f64) {
        let at = |v: u32| net.positions[v as usize] - way.place;
        self.fan.clear();
        self.under.clear();
        let mut area = 0.0;
        for v in [way.gone, way.kept] {
            for &Side { triangle, from, to } in &self.sides[usize::from(v != u)] {
                let (from, to) = (at(from), at(to));
                let area2 = cross(from, to);
                area += 0.5 * area2;
                self.fan.push(Wedge { from, to, area2, triangle });
            }
        }
        let mut worst = 0.0f64;
        points.of_change(net, way, |point, place| {
            let p = place - way.place;
            let (mut inside, mut height, mut under) = (f64::NEG_INFINITY, 0.0, NONE);
            for wedge in &self.fan {
                let (to_share, from_share) = (cross(wedge.from, p), cross(p, wedge.to));
                let tip_share = wedge.area2 - to_share - from_share;
                if to_share >= 0.0 && from_share >= 0.0 && tip_share >= 0.0 {
                    (inside, under) = (0.0, wedge.triangle);
                    height = (from_share * wedge.from.z + to_share * wedge.to.z) / wedge.area2;
                    break;
                }
            }
            if under == NONE {
                // in none: the one that it is least outside of
                for wedge in &self.fan {
                    let (to_share, from_share) = (cross(wedge.from, p), cross(p, wedge.to));
                    let least = to_share.min(from_share).min(wedge.area2 - to_share - from_share);
                    if least > inside * wedge.area2 {
                        (inside, under) = (least / wedge.area2, wedge.triangle);
                        height = (from_share * wedge.from.z + to_share * wedge.to.z) / wedge.area2;
                    }
                }
            }
            // a point outside was on a line, which strays as far as that is allowed
            if inside >= -1e-9 {
                worst = worst.max((height - p.z) * (height - p.z));
            }
            if under != NONE {
                self.under.push((point, under));
            }
        });
        (worst, area)
    }

    /// Puts the vertices where [`Self::lift`] found them to lie.
    pub(super) fn put(&self, points: &mut Points) {
        points.put(self.fan.iter().map(|wedge| wedge.triangle), &self.under);
    }

    /// Every vertex around the new one, once.
    pub(super) fn for_each_around(&mut self, mut visit: impl FnMut(u32)) {
        self.now += 1;
        for k in 0..2 {
            for i in 0..self.sides[k].len() {
                let Side { from, to, .. } = self.sides[k][i];
                for v in [from, to] {
                    if !self.mark(v, self.now) {
                        visit(v);
                    }
                }
            }
        }
    }
}

/// Whether a line would close or two become one: the next vertex along it must not be a tip, nor the other end's next too.
fn closes_line(net: &Net, u: u32, v: u32, tips: &[u32]) -> bool {
    let of_line = |w: u32| match net.kinds[w as usize] {
        Kind::Chain(ends) => ends,
        _ => [NONE; 2],
    };
    let [lu, lv] = [of_line(u), of_line(v)];
    let closes = |line: [u32; 2]| line.iter().any(|w| *w != NONE && tips.contains(w));
    if !lu.contains(&v) && !lv.contains(&u) {
        return false;
    }
    closes(lu) || closes(lv) || lu.contains(&v) && lv.contains(&u) && lu.iter().any(|w| *w != v && lv.contains(w))
}
