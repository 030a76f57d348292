//! Lines laid over the ground: sampled until the picture cannot tell, cut where ground hides them or the map ends,
//! and simplified (Douglas, Peucker, "Algorithms for the reduction of the number of points", 1973).

use glam::{DVec2, DVec3};
use yamanami_core::MapView;

/// Longest piece between two samples, pixels.
const STEP_PX: f64 = 2.5;
/// How far a simplified line may run from its samples, pixels.
const ERROR_PX: f64 = 0.3;
/// How often a piece is halved at most.
const MOST_HALVINGS: u32 = 14;
/// Share of a far area's outline that must be seen for it to be filled.
const SEEN_SHARE: f64 = 0.9;

/// The ground that lines are laid over.
pub(super) struct Drape<'a> {
    pub(super) view: &'a MapView,
    /// Height at a point of the plane, metres; NaN where there is none.
    pub(super) height_m: &'a dyn Fn(DVec2) -> f64,
    /// Whether a point is seen in the picture.
    pub(super) is_visible: &'a dyn Fn(DVec3) -> bool,
}

/// A part of a line that is seen and drawn with one width.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    pub(super) points: Vec<DVec2>,
    /// Which of the widths, by distance.
    pub(super) width_class: usize,
}

#[derive(Debug, Clone, Copy)]
struct Sample {
    plane: DVec2,
    px: DVec2,
    z: f64,
}

impl Drape<'_> {
    /// The seen parts of a line, by width class: the first of `classes` whose number of ring radii is not exceeded.
    pub(super) fn runs(&self, points: &[DVec2], is_closed: bool, classes: &[(f64, f64)]) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        let mut open: Option<Run> = None;
        let close = |open: &mut Option<Run>, runs: &mut Vec<Run>| {
            if let Some(mut run) = open.take()
                && run.points.len() > 1
            {
                run.points = simplified(&run.points);
                runs.push(run);
            }
        };
        for sample in self.samples(points, is_closed) {
            let Some(sample) = sample.filter(|s| self.is_seen(s)) else {
                close(&mut open, &mut runs);
                continue;
            };
            let rings = (sample.plane - self.view.map.centre).length() / self.view.map.ring_m;
            let width_class = classes.iter().position(|&(most, _)| rings <= most).unwrap_or(0);
            match &mut open {
                Some(run) if run.width_class == width_class => run.points.push(sample.px),
                Some(run) => {
                    run.points.push(sample.px);
                    close(&mut open, &mut runs);
                    open = Some(Run { points: vec![sample.px], width_class });
                }
                None => open = Some(Run { points: vec![sample.px], width_class }),
            }
        }
        close(&mut open, &mut runs);
        runs
    }

    /// The outline of an area, where (nearly) all of it is seen.
    pub(super) fn area(&self, points: &[DVec2]) -> Option<crate::scene::Outline> {
        let samples: Vec<Sample> = self.samples(points, true).into_iter().collect::<Option<_>>()?;
        let seen = samples.iter().filter(|s| self.is_seen(s)).count();
        let is_whole = samples.len() > 3 && seen as f64 >= SEEN_SHARE * samples.len() as f64;
        let px: Vec<DVec2> = samples.iter().map(|s| s.px).collect();
        is_whole.then(|| crate::scene::Outline::closed(simplified(&px)))
    }

    fn sample(&self, plane: DVec2) -> Sample {
        let height = (self.height_m)(plane);
        let z = if height.is_finite() { height } else { 0.0 };
        Sample { plane, px: self.view.px_from_plane(plane.extend(z)), z }
    }

    fn is_seen(&self, s: &Sample) -> bool {
        let out_m = (s.plane - self.view.map.centre).length();
        out_m <= self.view.rim_m && s.px.is_finite() && (self.is_visible)(s.plane.extend(s.z))
    }

    /// Samples along the line; none stands for a gap.
    fn samples(&self, points: &[DVec2], is_closed: bool) -> Vec<Option<Sample>> {
        let closing = if is_closed { points.first().copied() } else { None };
        let mut out: Vec<Option<Sample>> = Vec::with_capacity(points.len());
        let mut last: Option<Sample> = None;
        for &point in points.iter().chain(&closing) {
            if !point.is_finite() {
                out.push(None);
                last = None;
                continue;
            }
            match last {
                Some(from) if !self.may_reach(from.plane, point) => {
                    // far off the map: no heights are asked for on the way
                    if out.last().is_some_and(Option::is_some) {
                        out.push(None);
                    }
                    last = Some(Sample { plane: point, px: DVec2::NAN, z: 0.0 });
                }
                Some(from) => {
                    let from = if from.px.is_finite() { from } else { self.sample(from.plane) };
                    let to = self.sample(point);
                    if out.last().is_none_or(Option::is_none) {
                        out.push(Some(from));
                    }
                    self.between(&from, &to, MOST_HALVINGS, &mut out);
                    out.push(Some(to));
                    last = Some(to);
                }
                None => last = Some(Sample { plane: point, px: DVec2::NAN, z: 0.0 }),
            }
        }
        out
    }

    /// Whether a straight piece comes within the rim.
    fn may_reach(&self, a: DVec2, b: DVec2) -> bool {
        let (centre, d) = (self.view.map.centre, b - a);
        let t = ((centre - a).dot(d) / d.length_squared()).clamp(0.0, 1.0);
        let nearest = if t.is_finite() { a + t * d } else { a };
        (nearest - centre).length() <= self.view.rim_m
    }

    fn between(&self, a: &Sample, b: &Sample, halvings: u32, out: &mut Vec<Option<Sample>>) {
        let is_long = (b.px - a.px).length() > STEP_PX;
        if !is_long || halvings == 0 || !self.may_reach(a.plane, b.plane) {
            return;
        }
        let middle = self.sample(0.5 * (a.plane + b.plane));
        self.between(a, &middle, halvings - 1, out);
        out.push(Some(middle));
        self.between(&middle, b, halvings - 1, out);
    }
}

/// Fewer corners, none of the others farther off than the error.
fn simplified(points: &[DVec2]) -> Vec<DVec2> {
    let mut keep = vec![false; points.len()];
    let Some(end) = points.len().checked_sub(1) else { return Vec::new() };
    (keep[0], keep[end]) = (true, true);
    let mut open = vec![(0, end)];
    while let Some((from, to)) = open.pop() {
        let (a, d) = (points[from], points[to] - points[from]);
        let off = |p: DVec2| {
            let t = ((p - a).dot(d) / d.length_squared().max(1e-12)).clamp(0.0, 1.0);
            (p - a - t * d).length()
        };
        let farthest = (from + 1..to).map(|i| (i, off(points[i]))).max_by(|x, y| x.1.total_cmp(&y.1));
        if let Some((i, far)) = farthest
            && far > ERROR_PX
        {
            keep[i] = true;
            open.extend([(from, i), (i, to)]);
        }
    }
    points.iter().zip(keep).filter_map(|(&p, kept)| kept.then_some(p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::DeformedMap;

    fn view() -> MapView {
        MapView::fitted(DeformedMap::default(), [1000, 1000], 100e3, 3000.0, 100.0)
    }

    const CLASSES: [(f64, f64); 2] = [(1.0, 1.0), (f64::INFINITY, 0.5)];

    #[test]
    fn a_straight_line_is_bent_as_the_map_bends_it() {
        let view = view();
        let height = |_: DVec2| 0.0;
        let drape = Drape { view: &view, height_m: &height, is_visible: &|_| true };
        let runs = drape.runs(&[DVec2::new(-60e3, 20e3), DVec2::new(60e3, 20e3)], false, &CLASSES);
        assert_eq!(runs.len(), 1);
        let off = |x: f64| {
            let p = view.px_from_plane(DVec3::new(x, 20e3, 0.0));
            let pieces = runs[0].points.windows(2);
            pieces
                .map(|w| {
                    let d = w[1] - w[0];
                    let t = ((p - w[0]).dot(d) / d.length_squared()).clamp(0.0, 1.0);
                    (p - w[0] - t * d).length()
                })
                .fold(f64::INFINITY, f64::min)
        };
        for i in -50..=50 {
            assert!(off(f64::from(i) * 1200.0) < 0.45, "{i}");
        }
        assert!(runs[0].points.len() < 120, "{} corners", runs[0].points.len());
    }

    #[test]
    fn hidden_and_far_parts_are_cut_and_widths_change_at_the_ring() {
        let view = view();
        let drape = Drape { view: &view, height_m: &|_| f64::NAN, is_visible: &|p: DVec3| p.x > 0.0 || p.x < -30e3 };
        let runs = drape.runs(&[DVec2::new(-150e3, 0.0), DVec2::new(150e3, 0.0)], false, &CLASSES);
        let classes: Vec<usize> = runs.iter().map(|r| r.width_class).collect();
        assert_eq!(classes, [1, 0, 1]);
        let rim = view.px_from_plane(DVec3::new(100e3, 0.0, 0.0)).x;
        assert!(runs.iter().flat_map(|r| &r.points).all(|p| p.x <= rim + 1e-9));
        assert!(drape.runs(&[DVec2::new(0.0, 300e3), DVec2::new(9e3, 300e3)], false, &CLASSES).is_empty());
        assert!(drape.runs(&[DVec2::NAN, DVec2::ONE], false, &CLASSES).is_empty());
        assert!(drape.area(&[]).is_none());
    }
}
