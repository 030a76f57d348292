//! The front of a zoom: which midpoints are applied, and the triangles of it that reach into a tile.

use super::apron::{RIM, Spot, rim};
use super::placement::Placement;
use super::plan::{Plan, ZoomPlan};
use crate::wavelet::{ALL, Config, TEMPLATES, TerrainData, Triangle, doubled_area};
use yamanami_core::{Lattice, LatticeNode};

/// How far what a midpoint and all its descendants change reaches from it, in samples either way: for one level the
/// midpoint of a hypotenuse (both ways), and that of a leg along it and across.
///
/// A midpoint changes the two triangles at its edge. Its children lie on the edges of those triangles' children, and what
/// they change reaches out of them: half as far, and so on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Reach {
    hypotenuse: i64,
    along: i64,
    across: i64,
}

fn reaches(levels: u32) -> Vec<Reach> {
    let mut out: Vec<Reach> = Vec::new();
    for level in 0..levels {
        let unit = 1i64 << level;
        let next = match out.last() {
            None => Reach { hypotenuse: 1, along: 1, across: 2 },
            Some(below) => Reach {
                hypotenuse: unit + below.across,
                along: unit + below.across,
                across: (2 * unit).max(3 * unit / 2 + below.hypotenuse.max(below.along)),
            },
        };
        out.push(next);
    }
    out
}

/// A terrain in tile space.
#[derive(Debug)]
pub(super) struct Ground<'a, D> {
    pub(super) data: &'a D,
    pub(super) lattice: &'a Lattice,
    pub(super) placement: &'a Placement,
    pub(super) plan: &'a Plan,
    reaches: Vec<Reach>,
    /// How far the rim reaches out of the grid in tile space; 0 without.
    rim: f64,
}

/// Where a triangle and all that its refinement may draw lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Lies {
    /// Outside the tile.
    Outside,
    /// Across a side, or close to one.
    Across,
    /// Strictly inside; midpoints may still touch a line.
    Inside,
    /// So far inside that nothing below touches a line.
    Deep,
}

/// A part of the front.
#[derive(Debug, Clone, Copy)]
pub(super) enum Item {
    /// A triangle of the quadtree, strictly inside the tile, with all that is drawn in its place.
    Whole(Triangle, bool),
    /// A triangle of the front, by its samples; its level, its error, and whether a side crosses or touches it.
    Single([[u32; 2]; 3], u32, f32, bool),
    /// A triangle of the rim, with the level and error of the one that it goes on from.
    Rim([Spot; 3], u32, f32),
}

/// Children in an order in which each begins where the last one ended, or nearly so.
const ORDER: [usize; 4] = [1, 0, 3, 2];

impl<'a, D: TerrainData> Ground<'a, D> {
    pub(super) fn new(data: &'a D, lattice: &'a Lattice, placement: &'a Placement, plan: &'a Plan) -> Self {
        let rim = plan.fill_m.map_or(0.0, |_| (RIM as f64 + 0.5) * placement.widest_step());
        Self { data, lattice, placement, plan, reaches: reaches(lattice.levels()), rim }
    }

    /// Whether what a midpoint and its descendants change touches a border line of a zoom.
    fn touches(&self, m: LatticeNode, scale: f64) -> bool {
        let reach = self.reaches[m.level as usize];
        let half = match (m.x & 1, m.y & 1) {
            (1, 1) => [reach.hypotenuse; 2],
            (1, 0) => [reach.along, reach.across],
            _ => [reach.across, reach.along],
        };
        let at = [m.x, m.y].map(|k| i64::from(k) << m.level);
        // what changes at the grid's edge changes the rim
        let out = if self.rim > 0.0 && self.meets_edge(at, half) { self.rim } else { 0.0 };
        let reach = self.placement.reach(at, half);
        reach.into_iter().any(|[low, high]| ((low - out) * scale).ceil() <= (high + out) * scale)
    }

    /// Whether what lies within `half` of a place meets the edge of the grid.
    fn meets_edge(&self, at: [i64; 2], half: [i64; 2]) -> bool {
        let last = [self.lattice.width(), self.lattice.height()].map(|n| i64::from(n) - 1);
        (0..2).any(|k| at[k] - half[k] <= 0 || at[k] + half[k] >= last[k])
    }

    /// The applied midpoints of a triangle in the front of a zoom, [`ALL`] when all that exist are, and the greatest error of
    /// those that are not. `deep`: none of them touches a line. Midpoints that are not in memory go to `absent`.
    pub(super) fn config(
        &self,
        t: Triangle,
        zoom: &ZoomPlan,
        lines: Lines,
        absent: &mut Vec<LatticeNode>,
    ) -> (Config, f32) {
        if t.level == 0 {
            return (0, 0.0);
        }
        let level = t.level - 1;
        let [nx, ny] = self.lattice.points(level);
        let (inner, border) = (zoom.inner[level as usize], zoom.border[level as usize]);
        let (mut config, mut worst) = (0, -1);
        for (bit, m) in t.midpoints().into_iter().enumerate() {
            if m.x >= nx || m.y >= ny {
                continue;
            }
            if !self.data.is_resident(m) {
                absent.push(m);
                return (0, f32::INFINITY);
            }
            let error = self.data.error(m);
            let code = i32::from(error.0);
            let applied = match lines {
                Lines::None => code > inner,
                Lines::Everywhere => code > border,
                Lines::Scale(scale) => code > inner || code > border && self.touches(m, scale),
            };
            if applied {
                config |= 1 << bit;
            } else {
                worst = worst.max(code);
            }
        }
        if worst < 0 { (ALL, 0.0) } else { (config, yamanami_core::ErrorCode(worst as u16).to_m()) }
    }

    /// Whether the rim goes on from a triangle: also where it holds no data, so that no hole opens to the outside.
    fn has_rim(&self, t: Triangle) -> bool {
        let half = 1i64 << t.level;
        self.rim > 0.0 && self.meets_edge([t.x, t.y].map(|k| (i64::from(k) << t.level) + half / 2), [(half + 1) / 2; 2])
    }

    /// Where a triangle lies; `tile` is the tile's x from..to and y from..to.
    fn lies(&self, t: Triangle, tile: &[[f64; 2]; 2]) -> Lies {
        let half = 1i64 << t.level;
        let at = [t.x, t.y].map(|k| i64::from(k) << t.level);
        // twice as far as the square's middle is from its sides where straight lines of the grid bend
        let (middle, spread) = if self.placement.is_warped() {
            (at.map(|k| k + half / 2), half)
        } else {
            (at.map(|k| k + half / 2), (half + 1) / 2)
        };
        let reach = self.placement.reach(middle, [spread; 2]);
        let at_edge = self.has_rim(t);
        let out = if at_edge { self.rim } else { 0.0 };
        let [mut inside, mut outside] = [true, false];
        for (r, side) in reach.iter().zip(tile) {
            inside &= r[0] > side[0] && r[1] < side[1];
            outside |= r[1] + out < side[0] || r[0] - out > side[1];
        }
        if outside {
            return Lies::Outside;
        }
        // where there is a rim, it comes with its triangles, one by one
        if !inside || at_edge {
            return Lies::Across;
        }
        let beyond = t.level.checked_sub(1).map_or(0, |l| self.reaches[l as usize].across);
        let reach = self.placement.reach(middle, [spread + beyond; 2]);
        let deep = reach.iter().zip(tile).all(|(r, side)| r[0] > side[0] && r[1] < side[1]);
        if deep { Lies::Deep } else { Lies::Inside }
    }

    /// The parts of a zoom's front that reach into a tile.
    pub(super) fn items(
        &self,
        zoom: &ZoomPlan,
        scale: f64,
        tile: &[[f64; 2]; 2],
        items: &mut Vec<Item>,
        absent: &mut Vec<LatticeNode>,
    ) {
        let level = self.lattice.levels();
        let [nx, ny] = self.lattice.squares(level);
        for (y, x) in (0..ny).flat_map(|y| (0..nx).map(move |x| (y, x))) {
            for half in 0..2 {
                self.walk(Triangle { level, x, y, half }, zoom, scale, tile, items, absent);
            }
        }
    }

    fn walk(
        &self,
        t: Triangle,
        zoom: &ZoomPlan,
        scale: f64,
        tile: &[[f64; 2]; 2],
        items: &mut Vec<Item>,
        absent: &mut Vec<LatticeNode>,
    ) {
        let shown = self.data.shown(t.level, t.x, t.y, t.half);
        match self.lies(t, tile) {
            Lies::Outside => return,
            Lies::Across if !shown && !self.has_rim(t) => return,
            Lies::Inside | Lies::Deep if !shown => return,
            Lies::Inside => return items.push(Item::Whole(t, false)),
            Lies::Deep => return items.push(Item::Whole(t, true)),
            Lies::Across => {}
        }
        let (config, error_m) = self.config(t, zoom, Lines::Scale(scale), absent);
        if config == ALL {
            let children = t.children();
            for child in ORDER.map(|k| children[k]).into_iter().filter(|c| c.exists(self.lattice)) {
                self.walk(child, zoom, scale, tile, items, absent);
            }
            return;
        }
        self.drawn(t, config, |corners| {
            if self.rim > 0.0 {
                let size = [self.lattice.width(), self.lattice.height()];
                rim(corners.map(|c| c.map(i64::from)), size, error_m, t.level, items);
            }
            let at = corners.map(|sample| self.placement.place(sample));
            let (mut inside, mut outside) = (true, false);
            for (axis, side) in tile.iter().enumerate() {
                inside &= at.iter().all(|p| p[axis] > side[0] && p[axis] < side[1]);
                outside |= at.iter().all(|p| p[axis] <= side[0]) || at.iter().all(|p| p[axis] >= side[1]);
            }
            if shown && !outside {
                items.push(Item::Single(corners, t.level, error_m, !inside));
            }
        });
    }

    /// All triangles drawn in place of a triangle inside a tile, in order.
    pub(super) fn whole(
        &self,
        t: Triangle,
        zoom: &ZoomPlan,
        lines: Lines,
        absent: &mut Vec<LatticeNode>,
        out: &mut impl FnMut([[u32; 2]; 3], u32, f32),
    ) {
        if !self.data.shown(t.level, t.x, t.y, t.half) {
            return;
        }
        let (config, error_m) = self.config(t, zoom, lines, absent);
        if config == ALL {
            let children = t.children();
            for child in ORDER.map(|k| children[k]).into_iter().filter(|c| c.exists(self.lattice)) {
                self.whole(child, zoom, lines, absent, out);
            }
        } else {
            self.drawn(t, config, |corners| out(corners, t.level, error_m));
        }
    }

    /// The triangles that draw `t` in a configuration short of [`ALL`].
    pub(super) fn drawn(&self, t: Triangle, config: Config, mut out: impl FnMut([[u32; 2]; 3])) {
        if config == 0 {
            return out(t.corner_samples(self.lattice));
        }
        let points = t.points().map(|n| self.lattice.sample(n.level, n.x, n.y));
        let clamped = t.is_clamped(self.lattice);
        for roles in TEMPLATES[config] {
            let corners = roles.map(|role| points[role]);
            if !clamped || doubled_area(corners) != 0 {
                out(corners);
            }
        }
    }
}

/// Where border lines are.
#[derive(Debug, Clone, Copy)]
pub(super) enum Lines {
    /// Nowhere near.
    None,
    /// Everywhere: the front that all zooms have at a line.
    Everywhere,
    /// At multiples of the reciprocal.
    Scale(f64),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wavelet::adjacent;

    #[test]
    fn a_midpoint_s_reach_holds_its_triangles_and_its_children_s_reaches() {
        let lattice = Lattice::new(65, 65);
        let reaches = reaches(6);
        let half = |m: LatticeNode| {
            let r = reaches[m.level as usize];
            match (m.x & 1, m.y & 1) {
                (1, 1) => [r.hypotenuse; 2],
                (1, 0) => [r.along, r.across],
                _ => [r.across, r.along],
            }
        };
        let at = |m: LatticeNode| [m.x, m.y].map(|k| i64::from(k) << m.level);
        for level in 0..6 {
            let [nx, ny] = lattice.points(level);
            for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))).filter(|(x, y)| (x | y) & 1 == 1) {
                let m = LatticeNode { level, x, y };
                let holds = |place: [i64; 2], reach: [i64; 2]| {
                    (0..2).all(|axis| (place[axis] - at(m)[axis]).abs() + reach[axis] <= half(m)[axis])
                };
                for t in adjacent(m, &lattice).iter() {
                    assert!(t.corner_samples(&lattice).into_iter().all(|c| holds(c.map(i64::from), [0; 2])));
                    for child in t.children().into_iter().filter(|c| c.level > 0 && c.exists(&lattice)) {
                        for n in child.midpoints() {
                            assert!(holds(at(n), half(n)), "{m:?} {n:?}");
                        }
                    }
                }
            }
        }
    }
}
