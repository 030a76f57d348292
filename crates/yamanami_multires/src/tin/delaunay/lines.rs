//! Lines woven into the triangulation: every step of theirs becomes edges, and where two cross, a vertex.
//!
//! Crossings are split here and not by the triangulation's own means, so that each has a height from both lines, the notes
//! can name them, and the path of a line is known afterwards.

use super::vertices::NO_LINE;
use super::{Cdt, name, place};
use glam::DVec3;
use spade::handles::FixedVertexHandle;
use spade::{Point2, PositionInTriangulation, Triangulation};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use yamanami_core::{Breakline, BreaklineKind};

/// Notes of one sort that are written out.
const MOST_NOTES: usize = 20;
/// Rounded crossings may cross their neighbours again, but not for long.
const MOST_DEPTH: usize = 24;
/// So often in a row may an edge be split without a step forward.
const PATIENCE: usize = 100;
/// A crossing no farther from the end of an edge is that end, metres: a new vertex there would be rounding alone.
const TOUCH_M: f64 = 1e-6;
/// The same for large coordinates, of their size.
const TOUCH_OF_SIZE: f64 = 4e-15;

/// An edge that a line runs along.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kept {
    /// The first line that does.
    line: u32,
    /// The ends of the line's step that the edge is a piece of: they say how high the line is here.
    step: [u32; 2],
    /// Whether an odd number of boundaries do.
    pub(super) is_border: bool,
}

/// What the lines have become.
pub(super) struct Woven {
    /// By the two vertices, the lesser first.
    pub(super) edges: HashMap<[u32; 2], Kept>,
    /// The vertices along each line.
    pub(super) paths: Vec<Vec<u32>>,
}

pub(super) struct Weaver<'a> {
    cdt: &'a mut Cdt,
    positions: &'a mut Vec<DVec3>,
    line_of: &'a mut Vec<u32>,
    lines: &'a [Breakline],
    /// Vertices that were given without a height: what a line says there counts for nothing.
    heightless: Range<u32>,
    tolerance_m: f64,
    touch_m: f64,
    woven: Woven,
    /// Edges that were split later: the vertices between their ends.
    splits: HashMap<[u32; 2], Vec<u32>>,
    meaned: usize,
    disputed: Vec<(u32, u32, DVec3, f64)>,
    lost: Vec<(u32, DVec3)>,
    lifted: usize,
    lifted_m: f64,
}

impl<'a> Weaver<'a> {
    pub(super) fn new(
        cdt: &'a mut Cdt,
        positions: &'a mut Vec<DVec3>,
        line_of: &'a mut Vec<u32>,
        lines: &'a [Breakline],
        heightless: Range<u32>,
        tolerance_m: f64,
    ) -> Self {
        let size = positions.iter().fold(0.0, |size: f64, p| size.max(p.x.abs()).max(p.y.abs()));
        let touch_m = TOUCH_M.max(size * TOUCH_OF_SIZE);
        let woven = Woven { edges: HashMap::new(), paths: Vec::new() };
        let (splits, disputed, lost) = (HashMap::new(), Vec::new(), Vec::new());
        Self {
            cdt,
            positions,
            line_of,
            lines,
            heightless,
            tolerance_m,
            touch_m,
            woven,
            splits,
            meaned: 0,
            disputed,
            lost,
            lifted: 0,
            lifted_m: 0.0,
        }
    }

    /// Weaves the next line in.
    pub(super) fn weave(&mut self, line: u32, path: &[u32]) {
        let is_border = self.kind(line) == BreaklineKind::Boundary;
        let mut woven: Vec<u32> = path.first().copied().into_iter().collect();
        for step in path.windows(2) {
            let kept = Kept { line, step: [step[0], step[1]], is_border };
            woven.extend_from_slice(&self.run(step[0], step[1], kept, 0)[1..]);
        }
        self.woven.paths.push(woven);
    }

    /// The edges from `from` to `to`: the vertices on the way, both ends with them.
    fn run(&mut self, from: u32, to: u32, kept: Kept, depth: usize) -> Vec<u32> {
        let mut path = vec![from];
        let mut at = from;
        // where to go, the next last
        let mut targets = vec![to];
        let mut patience = PATIENCE;
        while let Some(&target) = targets.last() {
            if at == target {
                targets.pop();
            } else if patience == 0 || targets.len() > MOST_DEPTH || depth > MOST_DEPTH {
                self.lost.push((kept.line, self.positions[at as usize]));
                path.push(target);
                at = target;
            } else if let Some(across) = self.first_across(at, target) {
                let middle = self.split(at, target, across, kept, depth);
                if middle == at || middle == target {
                    patience -= 1;
                } else {
                    targets.push(middle);
                }
            } else {
                self.keep(at, target, kept, &mut path);
                at = target;
                patience = PATIENCE;
            }
        }
        path
    }

    /// The first kept edge that the way crosses between its ends.
    fn first_across(&self, from: u32, to: u32) -> Option<[u32; 2]> {
        let mut edges = self.cdt.get_conflicting_edges_between_vertices(handle(from), handle(to));
        edges.next().map(|e| e.vertices().map(|v| v.fix().index() as u32))
    }

    /// Keeps the edges of a way that crosses none.
    fn keep(&mut self, from: u32, to: u32, kept: Kept, path: &mut Vec<u32>) {
        let edges = self.cdt.try_add_constraint(handle(from), handle(to));
        if edges.is_empty() {
            self.lost.push((kept.line, self.positions[from as usize]));
            path.push(to);
        }
        for edge in edges {
            let [a, b] = self.cdt.directed_edge(edge).vertices().map(|v| v.fix().index() as u32);
            self.register(a, b, kept);
            path.push(b);
            if b != to {
                self.meet(b, kept);
            }
        }
    }

    fn register(&mut self, a: u32, b: u32, kept: Kept) {
        self.woven.edges.entry(key(a, b)).and_modify(|there| there.is_border ^= kept.is_border).or_insert(kept);
    }

    /// A line passes exactly through a vertex.
    fn meet(&mut self, vertex: u32, Kept { line, step, .. }: Kept) {
        if self.is_heightless(step) {
            return;
        }
        let p = self.positions[vertex as usize];
        let z_m = self.height_of(step, p);
        let by_m = (z_m - p.z).abs();
        let there = self.line_of[vertex as usize];
        if there == NO_LINE {
            if self.kind(line) == BreaklineKind::Hard {
                self.line_of[vertex as usize] = line;
                if by_m > self.tolerance_m {
                    self.lifted += 1;
                    self.lifted_m = self.lifted_m.max(by_m);
                }
                self.positions[vertex as usize].z = z_m;
            }
        } else if by_m > self.tolerance_m && there != line {
            self.disputed.push((there, line, p, by_m));
        }
    }

    /// Splits a kept edge where the way from `from` to `to` crosses it, and tells the vertex there. Where the end of one
    /// all but touches the other, that end is it, and nothing else is split.
    fn split(&mut self, from: u32, to: u32, [u, v]: [u32; 2], kept: Kept, depth: usize) -> u32 {
        if let Some(end) = [u, v].into_iter().find(|&end| self.touches(end, from, to)) {
            return end;
        }
        let other = self.woven.edges.remove(&key(u, v)).unwrap_or(kept);
        let touching = [from, to].into_iter().find(|&end| self.touches(end, u, v));
        let crossing = self.crossing([from, to], [u, v], [kept, other]);
        if let Some(edge) = self.cdt.get_edge_from_neighbors(handle(u), handle(v)) {
            let edge = edge.fix().as_undirected();
            self.cdt.remove_constraint_edge(edge);
        }
        let middle = touching.or_else(|| self.vertex_at(crossing, kept.line.min(other.line)));
        let Some(middle) = middle else { return from };
        let mut path = self.run(u, middle, other, depth + 1);
        path.extend_from_slice(&self.run(middle, v, other, depth + 1)[1..]);
        if path.len() > 2 {
            if u > v {
                path.reverse();
            }
            self.splits.insert(key(u, v), path[1..path.len() - 1].to_vec());
        }
        middle
    }

    /// Whether a vertex lies between two others, nearer to the straight way than a crossing can be told.
    fn touches(&self, vertex: u32, from: u32, to: u32) -> bool {
        let [p, a, b] = [vertex, from, to].map(|v| self.positions[v as usize].truncate());
        let (along, off) = (b - a, p - a);
        let t = along.dot(off) / along.length_squared();
        vertex != from && vertex != to && t > 0.0 && t < 1.0 && (off - along * t).length() <= self.touch_m
    }

    /// Where two edges of lines cross, with the height that the lines settle on.
    fn crossing(&mut self, [a, b]: [u32; 2], [u, v]: [u32; 2], of: [Kept; 2]) -> DVec3 {
        let [a, b, u, v] = [a, b, u, v].map(|i| self.positions[i as usize]);
        let (along, across, apart) = (b - a, v - u, u - a);
        let area = along.x * across.y - along.y * across.x;
        let t = ((apart.x * across.y - apart.y * across.x) / area).clamp(0.0, 1.0);
        let p = if t.is_nan() { a } else { a + along * t };
        let mut sides = of.map(|kept| {
            let order = (self.is_heightless(kept.step), rank(self.kind(kept.line)), kept.line);
            (order, self.height_of(kept.step, p))
        });
        if sides[1].0 < sides[0].0 {
            sides.swap(0, 1);
        }
        let [((_, first_rank, first), first_z_m), ((is_heightless, second_rank, second), second_z_m)] = sides;
        let by_m = (first_z_m - second_z_m).abs();
        if is_heightless {
            return p.with_z(first_z_m);
        }
        if by_m > self.tolerance_m {
            self.disputed.push((first, second, p, by_m));
        } else if first_rank == second_rank {
            self.meaned += usize::from(by_m > 0.0);
            return p.with_z(0.5 * (first_z_m + second_z_m));
        }
        p.with_z(first_z_m)
    }

    fn is_heightless(&self, step: [u32; 2]) -> bool {
        step.iter().any(|end| self.heightless.contains(end))
    }

    /// Height of a line's step at a place on it.
    fn height_of(&self, step: [u32; 2], p: DVec3) -> f64 {
        let [a, b] = step.map(|v| self.positions[v as usize]);
        height_along(a, b, p)
    }

    /// The vertex at a place: a new one, unless there is one.
    fn vertex_at(&mut self, p: DVec3, line: u32) -> Option<u32> {
        let plan = spade::mitigate_underflow(Point2::new(p.x, p.y));
        let on_edge = match self.cdt.locate(plan) {
            PositionInTriangulation::OnVertex(v) => return Some(v.index() as u32),
            PositionInTriangulation::OnEdge(edge) => {
                Some(self.cdt.directed_edge(edge).vertices().map(|v| v.fix().index() as u32))
            }
            _ => None,
        };
        let vertex = self.cdt.insert(plan).ok()?.index() as u32;
        self.positions.push(DVec3::new(plan.x, plan.y, p.z));
        self.line_of.push(line);
        if let Some([x, y]) = on_edge
            && let Some(kept) = self.woven.edges.remove(&key(x, y))
        {
            self.splits.insert(key(x, y), vec![vertex]);
            self.register(x, vertex, kept);
            self.register(vertex, y, kept);
        }
        Some(vertex)
    }

    fn kind(&self, line: u32) -> BreaklineKind {
        self.lines[line as usize].kind
    }

    /// The edges and paths, all splits in them.
    pub(super) fn finish(mut self, notes: &mut Vec<String>) -> Woven {
        for path in &mut self.woven.paths {
            let mut whole: Vec<u32> = path.first().copied().into_iter().collect();
            for step in path.windows(2) {
                expand(&self.splits, step[0], step[1], &mut whole);
            }
            *path = whole;
        }
        if self.meaned > 0 {
            notes.push(format!("{} crossings of lines got the mean of both heights", self.meaned));
        }
        let disputed = self.disputed.iter().map(|&(first, second, at, by_m)| {
            let [first, second] = [first, second].map(|l| name(self.lines, l));
            format!("{first} and {second} cross at {} at heights {by_m:.3} m apart: the first has it", place(at))
        });
        note_some(disputed, notes);
        if self.lifted > 0 {
            let (count, most_m) = (self.lifted, self.lifted_m);
            notes.push(format!("{count} points on hard lines got their heights, up to {most_m:.3} m away"));
        }
        let lost = self.lost.iter().map(|&(line, at)| {
            format!("{}: a step at {} could not be kept among others next to it", name(self.lines, line), place(at))
        });
        note_some(lost, notes);
        self.woven
    }
}

/// Appends the vertices after `a` up to `b`, through every split of the edge between them. An edge on a way round itself,
/// among lines that all but coincide, is an edge again.
fn expand(splits: &HashMap<[u32; 2], Vec<u32>>, a: u32, b: u32, path: &mut Vec<u32>) {
    let mut around = HashSet::new();
    // edges to walk, the next last; without a way, the end of what an edge was split into
    let mut steps = vec![(a, b, true)];
    while let Some((a, b, is_way)) = steps.pop() {
        if !is_way {
            around.remove(&key(a, b));
            continue;
        }
        let Some(between) = splits.get(&key(a, b)).filter(|_| around.insert(key(a, b))) else {
            path.push(b);
            continue;
        };
        steps.push((a, b, false));
        let mut to = b;
        let mut back_to = |from: u32| {
            steps.push((from, to, true));
            to = from;
        };
        if a < b {
            between.iter().rev().for_each(|&v| back_to(v));
        } else {
            between.iter().for_each(|&v| back_to(v));
        }
        back_to(a);
    }
}

/// Height of the straight way from `a` to `b` at its place nearest to `p` in plan.
pub(super) fn height_along(a: DVec3, b: DVec3, p: DVec3) -> f64 {
    let (along, to) = ((b - a).truncate(), (p - a).truncate());
    let t = (along.dot(to) / along.length_squared()).clamp(0.0, 1.0);
    if t.is_nan() { a.z } else { a.z + t * (b.z - a.z) }
}

/// Appends notes of one sort, of many only the first.
pub(super) fn note_some(all: impl ExactSizeIterator<Item = String>, notes: &mut Vec<String>) {
    let more = all.len().saturating_sub(MOST_NOTES);
    notes.extend(all.take(MOST_NOTES));
    if more > 0 {
        notes.push(format!("and {more} more like these"));
    }
}

/// Whose height goes first.
fn rank(kind: BreaklineKind) -> u8 {
    match kind {
        BreaklineKind::Hard => 0,
        BreaklineKind::Soft => 1,
        BreaklineKind::Boundary => 2,
    }
}

fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn handle(vertex: u32) -> FixedVertexHandle {
    FixedVertexHandle::from_index(vertex as usize)
}
