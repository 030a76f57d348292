//! Branch and bound over the pieces of triangles.
//!
//! The distance to one triangle of the other surface is a convex function, so over a convex piece it is greatest at a corner:
//! that, for the triangle nearest to the piece's centre, bounds the piece from above. Where the bound is not good enough the
//! piece is cut along that triangle's own edges; after few cuts every part lies over one triangle and the bound is
//! exact. Distance changes no faster than place does, which bounds what is left.
//!
//! Work goes in rounds of chunks whose size depends on the input alone. A chunk knows the greatest distance found before its
//! round and in itself, never what another thread has found meanwhile: the result is the same on any number of threads.

use super::frame::MOST_CUTS;
use super::piece::Piece;
use super::tree::{NONE, Near, Tree};
use glam::DVec3;
use rayon::prelude::*;

/// Faces of a chunk in the first round.
const FACES: usize = 256;

/// Most pieces of a chunk in later rounds.
const PIECES: usize = 32;

/// Steps of a chunk; what is left then is spread over the chunks of the next round.
const STEPS: usize = 8192;

/// Vertices of a chunk.
const VERTICES: usize = 512;

/// Chunks from which on threads are worth waking.
const SIDE_BY_SIDE: usize = 16;

/// A distance that does not matter, units.
const NOTHING: f64 = 1.0 / (1u64 << 40) as f64;

/// A vertex at this share of a limit needs no nearer triangle.
const NEAR_ENOUGH: f64 = 0.5;

/// A cut closer to a corner than this share of the piece's radius is not worth making.
const LEAST_CUT: f64 = 1e-3;

/// What is asked.
#[derive(Debug, Clone, Copy)]
pub(super) enum Goal {
    /// The greatest distance up to a relative gap; no further than needed to know that it is within `at_most` units.
    Greatest { gap: f64, at_most: f64 },
    /// Which faces are within so many units.
    Within { limit: f64 },
}

/// One surface seen from the other.
#[derive(Debug)]
pub(super) struct Direction<'a> {
    pub(super) from: &'a Tree,
    pub(super) from_triangles: &'a [[u32; 3]],
    pub(super) to: &'a Tree,
    /// A triangle of `to` near each vertex that a triangle of `from` has: with [`Goal::Greatest`] the nearest.
    near: Vec<Near>,
}

/// A place far from the other surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Far {
    pub(super) distance2: f64,
    pub(super) place: DVec3,
    /// Of `from`, in its tree's order.
    pub(super) face: u32,
    /// The nearest triangle of `to`, in its tree's order.
    pub(super) near: u32,
}

impl Far {
    const NOWHERE: Self = Self { distance2: -1.0, place: DVec3::ZERO, face: 0, near: 0 };
}

/// What is known of a direction.
#[derive(Debug)]
pub(super) struct Outcome {
    /// No point is farther, squared units.
    pub(super) upper2: f64,
    /// The farthest point seen.
    pub(super) farthest: Far,
    /// With [`Goal::Within`]: for each face that is not within, a place that shows it.
    pub(super) beyond: Vec<Far>,
}

impl<'a> Direction<'a> {
    /// Finds the nearest triangle for every vertex of `from`, which has `vertices`, or one that is near enough for the goal.
    /// Both surfaces have triangles.
    pub(super) fn new(
        from: &'a Tree,
        from_triangles: &'a [[u32; 3]],
        vertices: usize,
        to: &'a Tree,
        goal: Goal,
    ) -> Self {
        let enough = if let Goal::Within { limit } = goal { (limit * NEAR_ENOUGH).powi(2) } else { 0.0 };
        // in the order of the tree, so that the last answer is a good guess for the next question
        let mut near = vec![Near::NOTHING; vertices];
        let mut asked = Vec::with_capacity(vertices);
        for (&number, corners) in from.numbers.iter().zip(&from.triangles) {
            for (&v, &p) in from_triangles[number as usize].iter().zip(corners) {
                if near[v as usize].slot == 0 {
                    near[v as usize].slot = 1;
                    asked.push((v, p));
                }
            }
        }
        let answer = |asked: &[(u32, DVec3)]| {
            let mut slot = 0;
            let nearest = |&(v, p): &(u32, DVec3)| {
                let last = to.near(p, slot);
                let found = if last.distance2 <= enough { last } else { to.nearest(p, last) };
                slot = found.slot;
                (v, found)
            };
            asked.iter().map(nearest).collect::<Vec<_>>()
        };
        let chunks = asked.par_chunks(VERTICES);
        let answers: Vec<Vec<(u32, Near)>> = if chunks.len() < SIDE_BY_SIDE {
            asked.chunks(VERTICES).map(answer).collect()
        } else {
            chunks.map(answer).collect()
        };
        for (v, found) in answers.into_iter().flatten() {
            near[v as usize] = found;
        }
        Self { from, from_triangles, to, near }
    }

    fn corners_near(&self, face: usize) -> [Near; 3] {
        self.from_triangles[self.from.numbers[face] as usize].map(|v| self.near[v as usize])
    }

    /// The greatest distance of a vertex, squared.
    fn greatest_at_vertices(&self) -> f64 {
        (0..self.from.triangles.len()).flat_map(|face| self.corners_near(face)).map(|n| n.distance2).fold(0.0, f64::max)
    }
}

/// Work of one chunk.
#[derive(Debug, Clone, Copy)]
enum Chunk {
    /// Faces from..to of a direction.
    Faces { direction: usize, first: usize, end: usize },
    /// Pieces from..to of a direction's pool.
    Pieces { direction: usize, first: usize, end: usize },
}

/// A chunk at work, then what it found.
#[derive(Debug)]
struct State {
    goal: Goal,
    /// Nothing is cut any more.
    last: bool,
    steps: usize,
    threshold2: f64,
    upper2: f64,
    farthest: Far,
    beyond: Vec<Far>,
    stack: Vec<Piece>,
}

impl State {
    fn new(goal: Goal, known2: f64, last: bool) -> Self {
        let threshold2 = threshold2(goal, known2);
        Self {
            goal,
            last,
            steps: 0,
            threshold2,
            upper2: 0.0,
            farthest: Far::NOWHERE,
            beyond: Vec::new(),
            stack: Vec::new(),
        }
    }

    /// Notes a distance that some point has. Whether its face may still be within.
    #[inline]
    fn see(&mut self, far: Far) -> bool {
        if far.distance2 > self.farthest.distance2 {
            self.farthest = far;
            self.threshold2 = self.threshold2.max(threshold2(self.goal, far.distance2));
        }
        match self.goal {
            Goal::Greatest { .. } => true,
            Goal::Within { .. } => far.distance2 <= self.threshold2,
        }
    }

    fn is_beyond(&mut self, far: Far) {
        self.stack.retain(|piece| piece.face != far.face);
        self.beyond.push(far);
    }

    /// A whole face, with what its corners tell.
    fn face(&mut self, direction: &Direction<'_>, face: usize) {
        let corners = &direction.from.triangles[face];
        let near = direction.corners_near(face);
        for (&place, n) in corners.iter().zip(&near) {
            let far = Far { distance2: n.distance2, place, face: face as u32, near: n.slot };
            if !self.see(far) {
                return self.is_beyond(far);
            }
        }
        let mut upper2 = f64::INFINITY;
        for (k, n) in near.iter().enumerate() {
            if near[..k].iter().any(|earlier| earlier.slot == n.slot) {
                continue;
            }
            let at = |(p, m): (&DVec3, &Near)| {
                if m.slot == n.slot { m.distance2 } else { direction.to.near(*p, n.slot).distance2 }
            };
            upper2 = upper2.min(corners.iter().zip(&near).map(at).fold(0.0, f64::max));
            if upper2 <= self.threshold2 {
                self.upper2 = self.upper2.max(upper2);
                return;
            }
        }
        self.stack.push(Piece::whole(corners, face as u32, near[0].slot));
    }

    /// Takes the topmost piece: it is good enough, or parts of it come back.
    fn step(&mut self, direction: &Direction<'_>, mut piece: Piece) {
        self.steps += 1;
        let to = direction.to;
        let is_cut_no_more = self.last || piece.cuts >= MOST_CUTS;
        // a bound above the threshold only matters where the piece has to be taken as it is
        let enough2 = if is_cut_no_more { f64::INFINITY } else { self.threshold2 };
        let greatest = |slot: u32| {
            let triangle = &to.triangles[slot as usize];
            let mut greatest2 = 0.0f64;
            for &p in piece.corners() {
                greatest2 = greatest2.max(super::triangle::distance2(p, triangle));
                if greatest2 > enough2 {
                    return f64::INFINITY;
                }
            }
            greatest2
        };
        let mut upper2 = greatest(piece.near);
        if upper2 > self.threshold2 {
            let (centre, radius) = piece.ball();
            // the way from triangle to triangle is shorter than through the tree
            if piece.is_guess && !is_cut_no_more && self.cut_along(to, piece, radius) {
                return;
            }
            let found = to.nearest(centre, to.near(centre, piece.near));
            let far = Far { distance2: found.distance2, place: centre, face: piece.face, near: found.slot };
            if !self.see(far) {
                return self.is_beyond(far);
            }
            if found.slot != piece.near {
                upper2 = upper2.min(greatest(found.slot));
            }
            upper2 = upper2.min((found.distance2.sqrt() + radius).powi(2));
            if upper2 > self.threshold2 {
                piece.near = found.slot;
                if !is_cut_no_more {
                    if !self.cut_along(to, piece, radius) {
                        piece.is_guess = false;
                        self.stack.extend(piece.halves());
                    }
                    return;
                }
                if let Goal::Within { .. } = self.goal {
                    return self.is_beyond(far);
                }
            }
        }
        self.upper2 = self.upper2.max(upper2);
    }

    /// Cuts along the edges of the triangle that the piece is near; its neighbours are the guesses for what lies outside. Not
    /// where none of the edges crosses the piece.
    fn cut_along(&mut self, to: &Tree, piece: Piece, radius: f64) -> bool {
        let [a, b, c] = to.triangles[piece.near as usize];
        let normal = (b - a).cross(c - a);
        let mut inside = piece;
        let mut is_cut = false;
        for (k, (from, along)) in [(a, b - a), (b, c - b), (c, a - c)].into_iter().enumerate() {
            let outwards = along.cross(normal);
            let least = LEAST_CUT * radius * outwards.length();
            if let Some([behind, mut before]) = inside.cut(from, outwards, least) {
                let across = to.across[piece.near as usize][k];
                before.is_guess = across != NONE;
                if before.is_guess {
                    before.near = across;
                }
                self.stack.push(before);
                inside = behind;
                is_cut = true;
            }
        }
        if is_cut {
            inside.is_guess = false;
            self.stack.push(inside);
        }
        is_cut
    }
}

fn threshold2(goal: Goal, known2: f64) -> f64 {
    match goal {
        // the question is only whether it is within, until it is not
        Goal::Greatest { at_most, .. } if at_most > 0.0 && known2 <= at_most * at_most => at_most * at_most,
        Goal::Greatest { gap, .. } => (known2.sqrt() * (1.0 + gap) + NOTHING).powi(2),
        Goal::Within { limit } => limit.max(0.0).powi(2),
    }
}

/// Searches both directions together, which share the greatest distance known.
pub(super) fn search(directions: [&Direction<'_>; 2], goal: Goal, most_steps: u64) -> [Outcome; 2] {
    let mut known2 = directions.map(Direction::greatest_at_vertices).into_iter().fold(0.0, f64::max);
    let mut outcomes = [0; 2].map(|_| Outcome { upper2: 0.0, farthest: Far::NOWHERE, beyond: Vec::new() });
    let mut chunks = Vec::new();
    for (direction, d) in directions.iter().enumerate() {
        let faces = d.from.triangles.len();
        let chunk = |first: usize| Chunk::Faces { direction, first, end: faces.min(first + FACES) };
        chunks.extend((0..faces).step_by(FACES).map(chunk));
    }
    let mut pools: [Vec<Piece>; 2] = [Vec::new(), Vec::new()];
    let mut steps = 0u64;
    while !chunks.is_empty() {
        let last = steps >= most_steps;
        let work = |&chunk: &Chunk| run(directions, &pools, chunk, State::new(goal, known2, last));
        let found: Vec<(usize, State)> = if chunks.len() < SIDE_BY_SIDE {
            chunks.iter().map(work).collect()
        } else {
            chunks.par_iter().map(work).collect()
        };
        let mut left: [Vec<Piece>; 2] = [Vec::new(), Vec::new()];
        for (direction, state) in found {
            let outcome = &mut outcomes[direction];
            outcome.upper2 = outcome.upper2.max(state.upper2);
            if state.farthest.distance2 > outcome.farthest.distance2 {
                outcome.farthest = state.farthest;
            }
            known2 = known2.max(state.farthest.distance2);
            steps += state.steps as u64;
            outcome.beyond.extend(state.beyond);
            left[direction].extend(state.stack);
        }
        if let Goal::Greatest { at_most, .. } = goal
            && at_most > 0.0
            && known2 > at_most * at_most
        {
            // it is not within: how far exactly is not asked
            outcomes.iter_mut().for_each(|outcome| outcome.upper2 = f64::INFINITY);
            break;
        }
        chunks.clear();
        for (direction, (left, outcome)) in left.iter_mut().zip(&mut outcomes).enumerate() {
            outcome.beyond.sort_by_key(|far| far.face);
            outcome.beyond.dedup_by_key(|far| far.face);
            left.retain(|piece| outcome.beyond.binary_search_by_key(&piece.face, |far| far.face).is_err());
            let pieces = (left.len() / SIDE_BY_SIDE).clamp(1, PIECES);
            let chunk = |first: usize| Chunk::Pieces { direction, first, end: left.len().min(first + pieces) };
            chunks.extend((0..left.len()).step_by(pieces).map(chunk));
        }
        pools = left;
    }
    outcomes
}

/// Works a chunk off, as far as its steps go.
fn run(directions: [&Direction<'_>; 2], pools: &[Vec<Piece>; 2], chunk: Chunk, mut state: State) -> (usize, State) {
    let allowed = if state.last { usize::MAX } else { STEPS };
    match chunk {
        Chunk::Faces { direction, first, end } => {
            for face in first..end {
                let height = state.stack.len();
                state.face(directions[direction], face);
                while state.steps < allowed && state.stack.len() > height {
                    let Some(piece) = state.stack.pop() else { break };
                    state.step(directions[direction], piece);
                }
            }
            (direction, state)
        }
        Chunk::Pieces { direction, first, end } => {
            state.stack.extend(&pools[direction][first..end]);
            while state.steps < allowed {
                let Some(piece) = state.stack.pop() else { break };
                state.step(directions[direction], piece);
            }
            (direction, state)
        }
    }
}
