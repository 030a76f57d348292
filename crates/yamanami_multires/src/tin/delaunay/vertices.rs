//! The vertices of points and lines: one a place in plan.

use super::outliers::{Fences, is_placed};
use super::{name, place};
use crate::MultiresError;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;
use yamanami_core::{Breakline, BreaklineKind};

/// Vertex of no line.
pub(super) const NO_LINE: u32 = u32::MAX;
/// Places must have numbers that the triangulation can hold.
const MOST_PLACES: usize = 1 << 29;
/// The triangulation's predicates are exact down to far below this, metres; nearer to zero is zero.
const LEAST_M: f64 = 1e-30;

/// Vertices: those with a height first, those of lines without (NaN) last.
pub(super) struct Vertices {
    /// Metres.
    pub(super) positions: Vec<DVec3>,
    /// The vertices of each line.
    pub(super) paths: Vec<Vec<u32>>,
    /// The line that a vertex has its height from, or [`NO_LINE`].
    pub(super) line_of: Vec<u32>,
}

/// A given point: its place, its number among all, points first.
struct Given {
    x: f64,
    y: f64,
    number: u32,
}

pub(super) fn gather(
    points: &[DVec3],
    lines: &[Breakline],
    notes: &mut Vec<String>,
) -> Result<Vertices, MultiresError> {
    let total = points.len() + lines.iter().map(|l| l.points.len()).sum::<usize>();
    if total > MOST_PLACES {
        return Err(MultiresError::TooManyTriangles { triangles: 2 * total });
    }
    let mut all: Vec<DVec3> = kept_points(points, notes);
    let of_points = all.len();
    let mut line_of_given = Vec::new();
    let mut spans = Vec::with_capacity(lines.len());
    for (number, line) in lines.iter().enumerate() {
        let start = all.len();
        all.extend(line.points.iter().filter(|p| is_placed(p.with_z(0.0))).map(|p| {
            // an infinite height is none
            DVec3::new(settle(p.x), settle(p.y), if p.z.is_finite() { p.z } else { f64::NAN })
        }));
        let dropped = line.points.len() - (all.len() - start);
        if dropped > 0 {
            notes.push(format!("{}: {dropped} points that are nowhere dropped", name(lines, number as u32)));
        }
        line_of_given.resize(all.len() - of_points, number as u32);
        spans.push(start..all.len());
    }

    let mut order: Vec<Given> =
        all.iter().enumerate().map(|(i, p)| Given { x: p.x, y: p.y, number: i as u32 }).collect();
    order.par_sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.number.cmp(&b.number)));
    let line_of = |number: u32| (number as usize).checked_sub(of_points).map_or(NO_LINE, |i| line_of_given[i]);
    let mut twins = Twins::default();
    // the first at each place stands for all there
    let mut first_of: Vec<u32> = vec![0; all.len()];
    let mut height_from: Vec<u32> = vec![NO_LINE; all.len()];
    for group in order.chunk_by(|a, b| a.x == b.x && a.y == b.y) {
        let first = group[0].number;
        let (z_m, line) = if let [_] = group {
            (all[first as usize].z, line_of(first))
        } else {
            twins.settle(group, &all, of_points, line_of)
        };
        for given in group {
            first_of[given.number as usize] = first;
        }
        all[first as usize].z = z_m;
        height_from[first as usize] = line;
    }
    twins.note(lines, notes);
    Ok(number(all, &first_of, &height_from, spans, lines, notes))
}

/// The points that are somewhere, near the others.
fn kept_points(points: &[DVec3], notes: &mut Vec<String>) -> Vec<DVec3> {
    let fences = Fences::of(points);
    let mut kept = Vec::with_capacity(points.len());
    let (mut nowhere, mut far, mut first_far) = (0, 0, DVec3::ZERO);
    for &p in points {
        if !is_placed(p) {
            nowhere += 1;
        } else if !fences.hold(p) {
            far += 1;
            if far == 1 {
                first_far = p;
            }
        } else {
            kept.push(DVec3::new(settle(p.x), settle(p.y), p.z));
        }
    }
    if nowhere > 0 {
        notes.push(format!("{nowhere} points that are nowhere (not finite, or beyond 10^9 m) dropped"));
    }
    if far > 0 {
        notes.push(format!(
            "{far} points far outside of all others dropped, the first at {} with height {:.3} m",
            place(first_far),
            first_far.z
        ));
    }
    kept
}

fn settle(coordinate: f64) -> f64 {
    if coordinate.abs() < LEAST_M { 0.0 } else { coordinate }
}

/// Points and lines at one place, as the notes tell of them.
#[derive(Default)]
struct Twins {
    points: usize,
    greatest_m: f64,
    greatest_at: DVec3,
    on_lines: usize,
    on_lines_m: f64,
    touching: Vec<(u32, u32, DVec3, f64)>,
}

impl Twins {
    /// The height of those at one place and the line it comes from.
    fn settle(&mut self, group: &[Given], all: &[DVec3], of_points: usize, line_of: impl Fn(u32) -> u32) -> (f64, u32) {
        let place = all[group[0].number as usize];
        let points = group.partition_point(|g| (g.number as usize) < of_points);
        let heights = |part: &[Given]| part.iter().map(|g| all[g.number as usize].z).collect::<Vec<f64>>();
        let mut z_m = f64::NAN;
        if points > 0 {
            let z = heights(&group[..points]);
            let (low, high) = z.iter().fold((z[0], z[0]), |(low, high), &z| (low.min(z), high.max(z)));
            z_m = if low == high { low } else { z.iter().sum::<f64>() / z.len() as f64 };
            self.points += points - 1;
            if high - low > self.greatest_m {
                (self.greatest_m, self.greatest_at) = (high - low, place);
            }
        }
        let mut from = NO_LINE;
        for given in &group[points..] {
            let (line, line_z_m) = (line_of(given.number), all[given.number as usize].z);
            if line_z_m.is_nan() {
                continue;
            }
            if from == NO_LINE {
                if points > 0 && z_m != line_z_m {
                    self.on_lines += 1;
                    self.on_lines_m = self.on_lines_m.max((z_m - line_z_m).abs());
                }
                (z_m, from) = (line_z_m, line);
            } else if line_z_m != z_m {
                self.touching.push((from, line, place, (line_z_m - z_m).abs()));
            }
        }
        (z_m, from)
    }

    fn note(self, lines: &[Breakline], notes: &mut Vec<String>) {
        if self.points > 0 {
            let mut text = format!("{} points at places that others have", self.points);
            if self.greatest_m > 0.0 {
                let (most_m, at) = (self.greatest_m, place(self.greatest_at));
                text += &format!(": heights meaned, they differ by up to {most_m:.3} m at {at}");
            }
            notes.push(text);
        }
        if self.on_lines > 0 {
            let (count, most_m) = (self.on_lines, self.on_lines_m);
            notes.push(format!("{count} points at points of lines got their heights, up to {most_m:.3} m away"));
        }
        let touching = self.touching.iter().map(|&(first, second, at, by_m)| {
            let [first, second] = [first, second].map(|l| name(lines, l));
            format!("{first} and {second} share {} at heights {by_m:.3} m apart: the first has it", place(at))
        });
        super::lines::note_some(touching, notes);
    }
}

/// Numbers the places, those with heights first, each in the order in which it was first given.
fn number(
    all: Vec<DVec3>,
    first_of: &[u32],
    height_from: &[u32],
    spans: Vec<std::ops::Range<usize>>,
    lines: &[Breakline],
    notes: &mut Vec<String>,
) -> Vertices {
    let mut numbers = vec![u32::MAX; all.len()];
    let (mut positions, mut line_of) = (Vec::new(), Vec::new());
    for with_height in [true, false] {
        for (i, &p) in all.iter().enumerate() {
            if first_of[i] as usize == i && p.z.is_nan() != with_height {
                numbers[i] = positions.len() as u32;
                positions.push(p);
                line_of.push(height_from[i]);
            }
        }
    }
    let mut paths = Vec::with_capacity(lines.len());
    for (line, span) in spans.into_iter().enumerate() {
        let mut path: Vec<u32> = span.map(|i| numbers[first_of[i] as usize]).collect();
        path.dedup();
        let is_ring = lines[line].kind == BreaklineKind::Boundary;
        if is_ring && path.len() > 2 && path.first() != path.last() {
            path.push(path[0]);
        }
        if path.len() < if is_ring { 4 } else { 2 } {
            let least = if is_ring { "three" } else { "two" };
            notes.push(format!("{} has not {least} different points: dropped", name(lines, line as u32)));
            path.clear();
        }
        paths.push(path);
    }
    Vertices { positions, paths, line_of }
}
