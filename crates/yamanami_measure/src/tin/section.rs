//! The section of a terrain surface along a line: every edge that the line crosses gives a vertex of the section.
//!
//! A crossing is computed from the edge alone, its ends in a fixed order, and a vertex on the line is taken as it is, so
//! the triangles on both sides agree to the last bit and the section has gaps only where the surface has.

use super::PlanIndex;
use super::locate::{PlanBox, side};
use super::plane::Plane;
use glam::{DVec2, DVec3};

/// A vertex of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionPoint {
    /// Distance along the line in plan from its start, metres.
    pub distance_m: f64,
    /// The point on the surface.
    pub point: DVec3,
}

/// The section of a surface along a line.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Section {
    /// Stretches on the surface, in order; between them it has a gap. Two vertices at one distance are a step: the line
    /// crosses an upright face. No run is empty.
    pub runs: Vec<Vec<SectionPoint>>,
    /// Length of the line in plan, metres.
    pub length_m: f64,
}

impl Section {
    /// Pairs of neighbouring vertices.
    fn legs(&self) -> impl Iterator<Item = [SectionPoint; 2]> + '_ {
        self.runs.iter().flat_map(|run| run.windows(2).map(|w| [w[0], w[1]]))
    }

    /// Height at a distance along the line, metres; `None` in a gap.
    pub fn height_at_m(&self, distance_m: f64) -> Option<f64> {
        let [a, b] = self.legs().find(|[a, b]| a.distance_m <= distance_m && distance_m <= b.distance_m)?;
        let share = (distance_m - a.distance_m) / (b.distance_m - a.distance_m);
        Some(if share.is_finite() { a.point.z + (b.point.z - a.point.z) * share } else { a.point.z })
    }

    /// Length in plan that lies on the surface, metres.
    pub fn covered_m(&self) -> f64 {
        self.legs().map(|[a, b]| b.distance_m - a.distance_m).sum()
    }

    /// Length on the ground, up and down, metres.
    pub fn ground_m(&self) -> f64 {
        self.legs().map(|[a, b]| (b.distance_m - a.distance_m).hypot(b.point.z - a.point.z)).sum()
    }

    /// Climb and descent, both positive, metres.
    pub fn climb_and_descent_m(&self) -> [f64; 2] {
        self.legs().fold([0.0; 2], |[up, down], [a, b]| {
            let rise = b.point.z - a.point.z;
            [up + rise.max(0.0), down + (-rise).max(0.0)]
        })
    }

    /// Mean of the angle to the horizontal by length in plan, radians, always positive; 0 for a section without length.
    pub fn mean_slope_rad(&self) -> f64 {
        let sum: f64 = self
            .legs()
            .map(|[a, b]| {
                let along = b.distance_m - a.distance_m;
                along * (b.point.z - a.point.z).abs().atan2(along)
            })
            .sum();
        let covered = self.covered_m();
        if covered > 0.0 { sum / covered } else { 0.0 }
    }

    /// The lowest and the highest vertex; `None` off the surface.
    pub fn lowest_and_highest(&self) -> Option<[SectionPoint; 2]> {
        let points = || self.runs.iter().flatten().copied();
        let lowest = points().min_by(|a, b| a.point.z.total_cmp(&b.point.z))?;
        let highest = points().max_by(|a, b| a.point.z.total_cmp(&b.point.z))?;
        Some([lowest, highest])
    }
}

/// Cuts a surface along a line through `line`'s points. Points that are not finite are passed over.
pub fn section(index: &PlanIndex<'_>, line: &[DVec2]) -> Section {
    let line: Vec<DVec2> = line.iter().copied().filter(|p| p.is_finite()).collect();
    let mut section = Section::default();
    for ends in line.windows(2) {
        let leg = Leg::new(ends[0], ends[1]);
        if leg.length > 0.0 {
            leg.cut(index, &mut section);
            section.length_m += leg.length;
        }
    }
    section
}

/// A straight piece of the line.
struct Leg {
    from: DVec2,
    to: DVec2,
    length: f64,
    /// Unit direction.
    along: DVec2,
    /// Rounding of places along the line, metres.
    rounding: f64,
}

/// A point of a leg: distance from its start, and the place on the surface.
type Crossing = (f64, DVec3);

impl Leg {
    fn new(from: DVec2, to: DVec2) -> Self {
        let length = from.distance(to);
        let rounding = 32.0 * f64::EPSILON * from.abs().max(to.abs()).max_element();
        Self { from, to, length, along: (to - from) / length, rounding }
    }

    /// Adds the section along this leg.
    fn cut(&self, index: &PlanIndex<'_>, section: &mut Section) {
        let mut parts: Vec<[Crossing; 2]> = Vec::new();
        index.visit(
            |b| self.may_meet(b),
            |t| {
                parts.extend(self.part(index.mesh().corners(t as usize)));
            },
        );
        parts.sort_unstable_by(|a, b| a[0].0.total_cmp(&b[0].0).then(a[1].0.total_cmp(&b[1].0)));
        let start_m = section.length_m;
        let vertex = |(distance, point): Crossing| SectionPoint { distance_m: start_m + distance, point };
        for [enter, leave] in parts {
            let [enter, leave] = [vertex(enter), vertex(leave)];
            match section.runs.last_mut().map(|run| (run[run.len() - 1], run)) {
                Some((end, run)) if enter.distance_m <= end.distance_m + self.rounding => {
                    // the line runs along an edge: its other triangle gave the same part
                    if leave.distance_m <= end.distance_m {
                        continue;
                    }
                    if (enter.point.z - end.point.z).abs() > self.rounding.max(1e-9) {
                        run.push(SectionPoint { distance_m: end.distance_m, point: enter.point });
                    }
                    run.push(leave);
                }
                _ => section.runs.push(vec![enter, leave]),
            }
        }
    }

    /// Whether the leg may pass through a box.
    fn may_meet(&self, b: &PlanBox) -> bool {
        if !PlanBox::of([self.from, self.to]).meets(b) {
            return false;
        }
        let half = (b.max - b.min) / 2.0;
        let off = self.along.perp_dot(b.min + half - self.from).abs();
        off <= self.along.abs().dot(DVec2::new(half.y, half.x)) + self.rounding
    }

    /// Where the leg enters and leaves a triangle; `None` where they share no length.
    fn part(&self, corners: [DVec3; 3]) -> Option<[Crossing; 2]> {
        let sides = corners.map(|p| side(self.from, self.to, p.truncate()));
        let mut ends: Option<[Crossing; 2]> = None;
        let mut meet = |point: DVec3| {
            let here = ((point.truncate() - self.from).dot(self.along), point);
            ends = Some(ends.map_or([here; 2], |[a, b]| {
                [if here.0 < a.0 { here } else { a }, if here.0 > b.0 { here } else { b }]
            }));
        };
        for k in 0..3 {
            let next = (k + 1) % 3;
            if sides[k] == 0.0 {
                meet(corners[k]);
            } else if (sides[k] < 0.0) != (sides[next] < 0.0) && sides[next] != 0.0 {
                let (a, b) = (corners[k], corners[next]);
                let swap = (b.x, b.y) < (a.x, a.y);
                let [(p, from), (q, to)] =
                    if swap { [(b, sides[next]), (a, sides[k])] } else { [(a, sides[k]), (b, sides[next])] };
                meet(p + (q - p) * (from / (from - to)));
            }
        }
        let [mut enter, mut leave] = ends?;
        if leave.0 <= 0.0 || enter.0 >= self.length || enter.0 >= leave.0 {
            return None;
        }
        let plane = Plane::of(corners);
        let on = |distance, place: DVec2| (distance, place.extend(plane.height(place)));
        if enter.0 < 0.0 {
            enter = on(0.0, self.from);
        }
        if leave.0 > self.length {
            leave = on(self.length, self.to);
        }
        Some([enter, leave])
    }
}

#[cfg(test)]
mod tests {
    use super::super::footing;
    use super::super::tests::{grid, plane_tin, pyramid, rough, shifted};
    use super::*;
    use proptest::prelude::*;
    use yamanami_core::TriangleMesh;

    fn heights(section: &Section) -> Vec<[f64; 2]> {
        section.runs.iter().flatten().map(|p| [p.distance_m, p.point.z]).collect()
    }

    #[test]
    fn over_a_pyramid_the_section_is_a_roof() {
        let mesh = pyramid(6.0, 5.0);
        let index = PlanIndex::new(&mesh);
        let over = section(&index, &[DVec2::new(-1.0, 3.0), DVec2::new(9.0, 3.0)]);
        assert_eq!(heights(&over), [[1.0, 0.0], [4.0, 5.0], [7.0, 0.0]]);
        assert_eq!((over.length_m, over.covered_m()), (10.0, 6.0));
        assert!((over.ground_m() - 2.0 * 34f64.sqrt()).abs() < 1e-12);
        assert_eq!(over.climb_and_descent_m(), [5.0, 5.0]);
        assert!((over.mean_slope_rad() - (5f64 / 3.0).atan()).abs() < 1e-12);
        assert_eq!((over.height_at_m(2.5), over.height_at_m(0.5)), (Some(2.5), None));
        let [low, high] = over.lowest_and_highest().unwrap();
        assert_eq!((low.point.z, high.point.z), (0.0, 5.0));
        // along the border edge, and a line that only touches a corner
        let border = section(&index, &[DVec2::new(0.0, 0.0), DVec2::new(6.0, 0.0)]);
        assert_eq!(heights(&border), [[0.0, 0.0], [6.0, 0.0]]);
        assert_eq!(section(&index, &[DVec2::new(-1.0, 1.0), DVec2::new(1.0, -1.0)]).runs.len(), 0);
    }

    #[test]
    fn holes_are_gaps_and_the_line_turns_where_it_is_told() {
        let mut mesh = plane_tin(4, [1.0, 0.0]);
        mesh.triangles.retain(|t| {
            let middle = t.iter().map(|&i| mesh.positions[i as usize]).sum::<DVec3>() / 3.0;
            !(middle.x > 1.0 && middle.x < 2.0 && middle.y > 1.0 && middle.y < 2.0)
        });
        let line = [DVec2::new(0.5, 1.5), DVec2::new(3.5, 1.5), DVec2::new(3.5, 3.5)];
        let s = section(&PlanIndex::new(&mesh), &line);
        let ends: Vec<[f64; 2]> = s.runs.iter().map(|r| [r[0].distance_m, r[r.len() - 1].distance_m]).collect();
        assert_eq!(ends, [[0.0, 0.5], [1.5, 5.0]]);
        assert!(s.runs.iter().flatten().all(|p| (p.point.z - p.point.x).abs() < 1e-12));
        assert_eq!(section(&PlanIndex::new(&mesh), &[]), Section::default());
        assert_eq!(section(&PlanIndex::new(&mesh), &[DVec2::NAN, line[0]]), Section::default());
    }

    #[test]
    fn an_upright_face_is_a_step() {
        let mut low = grid(2, |_, _| 0.0);
        let high = grid(2, |_, _| 3.0);
        let count = low.positions.len() as u32;
        low.positions.extend(high.positions.iter().map(|p| *p + DVec3::X * 2.0));
        low.triangles.extend(high.triangles.iter().map(|t| t.map(|i| i + count)));
        let s = section(&PlanIndex::new(&low), &[DVec2::new(0.0, 1.3), DVec2::new(4.0, 1.3)]);
        assert_eq!(s.runs.len(), 1);
        let step: Vec<f64> = s.runs[0].iter().filter(|p| p.distance_m == 2.0).map(|p| p.point.z).collect();
        assert_eq!(step, [0.0, 3.0]);
        assert_eq!(s.ground_m(), 7.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn the_section_lies_on_the_surface_without_gaps(
            seed in any::<u64>(),
            line in prop::collection::vec((0.0..8.0f64, 0.0..8.0f64), 2..5),
            on_grid in any::<bool>(),
        ) {
            let near = rough(8, seed);
            let mesh: TriangleMesh = shifted(near.clone());
            let move_m = (mesh.positions[0] - near.positions[0]).truncate();
            let line: Vec<DVec2> = line
                .into_iter()
                .map(|p| {
                    let p = DVec2::from(p);
                    // through vertices, too
                    if on_grid { near.positions[(p.x as usize) + 9 * (p.y as usize)].truncate() + move_m } else { p + move_m }
                })
                .collect();
            let index = PlanIndex::new(&mesh);
            let s = section(&index, &line);
            let length: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
            prop_assert!((s.length_m - length).abs() < 1e-9);
            prop_assert_eq!(s.runs.len(), usize::from(length > 0.0));
            prop_assert!((s.covered_m() - length).abs() < 1e-7);
            for w in s.runs.iter().flat_map(|run| run.windows(2)) {
                prop_assert!(w[0].distance_m <= w[1].distance_m);
                for t in [0.25, 0.5] {
                    let p = w[0].point.lerp(w[1].point, t);
                    let at = footing(&index, p.truncate()).unwrap().height_m;
                    prop_assert!((at - p.z).abs() < 1e-6, "{} {}", at, p.z);
                }
            }
        }
    }
}
