//! The triangles of a page to bits and back: each is glued to an open edge of those before it where it can be.
//!
//! Based on: Gumhold, Straßer, "Real time compression of triangle mesh connectivity", 1998 (the border that grows triangle
//! by triangle); Rossignac, "Edgebreaker", 1999 (most third corners are new, or the neighbour on the border). Where we
//! differ: any triangles in any order can be coded; a good order, see [`super::order`], only makes them cheap.

use super::super::binary::{BinaryDecoder, BinaryEncoder, Probability};
use std::collections::VecDeque;

/// No vertex.
pub(super) const NONE: u32 = u32::MAX;
/// A triangle is looked for at so many open edges, the youngest first.
pub(super) const GATES: usize = 24;
/// Vertices that a third corner is likely to be.
const CANDIDATES: usize = 4;

/// An open edge, in the direction in which a triangle glued to it has it, and the vertex across.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Gate {
    pub(super) from: u32,
    pub(super) to: u32,
    pub(super) across: u32,
}

/// Where a vertex of the page is first seen, and what is known of its surroundings then.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Placing {
    pub(super) vertex: u32,
    /// Corners of its triangle that were placed before, or [`NONE`].
    pub(super) beside: [u32; 2],
    /// The vertex across the edge between these, when it was placed before, or [`NONE`].
    pub(super) across: u32,
}

/// The other ends of the two youngest open edges at a vertex, in one direction; [`NONE`] where there are fewer.
#[derive(Debug, Clone, Copy)]
struct Ends([u32; 2]);

impl Ends {
    const NOWHERE: Self = Self([NONE; 2]);

    fn push(&mut self, end: u32) {
        self.0 = [end, self.0[0]];
    }

    fn forget(&mut self, end: u32) {
        match self.0 {
            [young, old] if young == end => self.0 = [old, NONE],
            [young, old] if old == end => self.0 = [young, NONE],
            _ => {}
        }
    }
}

/// The border of the triangles so far. Vertices are numbered: first the page's own, then the others by first use.
#[derive(Debug)]
pub(super) struct Border {
    open: VecDeque<Gate>,
    /// By vertex: where open edges from it lead.
    out_of: Vec<Ends>,
    /// By vertex: where open edges to it come from.
    into: Vec<Ends>,
    own: u32,
    next_own: u32,
    seen: Vec<bool>,
    pub(super) placings: Vec<Placing>,
}

impl Border {
    pub(super) fn new(own: u32) -> Self {
        let n = own as usize;
        let (out_of, into) = (vec![Ends::NOWHERE; n], vec![Ends::NOWHERE; n]);
        Self { open: VecDeque::new(), out_of, into, own, next_own: 0, seen: vec![false; n], placings: Vec::new() }
    }

    fn is_open(&self, from: u32, to: u32) -> bool {
        self.out_of[from as usize].0.contains(&to) || self.into[to as usize].0.contains(&from)
    }

    fn forget_closed(&mut self) {
        while self.open.back().is_some_and(|g| !self.is_open(g.from, g.to)) {
            self.open.pop_back();
        }
    }

    /// The open edges that a triangle may be glued to, best first.
    pub(super) fn gates(&self) -> impl Iterator<Item = Gate> {
        self.open.iter().rev().filter(|g| self.is_open(g.from, g.to)).take(GATES).copied()
    }

    /// The best gate; those passed over are put last.
    fn gate(&mut self) -> Option<Gate> {
        self.forget_closed();
        self.open.back().copied()
    }

    fn pass_over(&mut self) {
        if let Some(gate) = self.open.pop_back() {
            self.open.push_front(gate);
        }
    }

    /// Goes past so many gates to the one that a triangle is glued to.
    pub(super) fn reach(&mut self, passed: usize) -> Option<Gate> {
        for _ in 0..passed {
            self.gate()?;
            self.pass_over();
        }
        self.gate()
    }

    /// Makes room for another vertex that is not the page's own; gives its number.
    pub(super) fn add_other(&mut self) -> u32 {
        self.out_of.push(Ends::NOWHERE);
        self.into.push(Ends::NOWHERE);
        self.out_of.len() as u32 - 1
    }

    fn vertices(&self) -> u32 {
        self.out_of.len() as u32
    }

    /// The first of the page's own vertices that was not seen yet.
    fn next_own(&mut self) -> u32 {
        while self.next_own < self.own && self.seen[self.next_own as usize] {
            self.next_own += 1;
        }
        if self.next_own < self.own { self.next_own } else { NONE }
    }

    fn is_placed(&self, v: u32) -> bool {
        self.seen.get(v as usize).copied().unwrap_or(false)
    }

    /// Notes corners that are seen for the first time.
    pub(super) fn place(&mut self, corners: [u32; 3], across: u32) {
        for i in [2, 0, 1] {
            let vertex = corners[i];
            if vertex < self.own && !self.seen[vertex as usize] {
                let known = |v: u32| if self.is_placed(v) { v } else { NONE };
                let beside = [known(corners[(i + 1) % 3]), known(corners[(i + 2) % 3])];
                let across = if i == 2 { known(across) } else { NONE };
                self.placings.push(Placing { vertex, beside, across });
                self.seen[vertex as usize] = true;
            }
        }
    }

    /// Notes a corner, the `i`th of a triangle that is glued to nothing, if it is seen for the first time.
    fn place_corner(&mut self, triangle: [u32; 3], i: usize) {
        let vertex = triangle[i];
        if vertex < self.own && !self.seen[vertex as usize] {
            let known = |k: usize| if k < i && self.is_placed(triangle[k]) { triangle[k] } else { NONE };
            let beside = [known(0), known(1)];
            self.placings.push(Placing { vertex, beside, across: NONE });
            self.seen[vertex as usize] = true;
        }
    }

    /// Notes the corners of a triangle that is glued to nothing.
    pub(super) fn place_one_by_one(&mut self, triangle: [u32; 3]) {
        (0..3).for_each(|i| self.place_corner(triangle, i));
    }

    /// Adds a triangle: its edges close open ones or are open themselves.
    pub(super) fn add(&mut self, [a, b, c]: [u32; 3]) {
        let edges = [(a, b, c), (c, a, b), (b, c, a)];
        let closes = edges.map(|(from, to, _)| self.is_open(from, to));
        for ((from, to, _), _) in edges.into_iter().zip(closes).filter(|(_, closes)| *closes) {
            self.out_of[from as usize].forget(to);
            self.into[to as usize].forget(from);
        }
        for ((from, to, across), _) in edges.into_iter().zip(closes).filter(|(_, closes)| !closes) {
            self.open.push_back(Gate { from: to, to: from, across });
            self.out_of[to as usize].push(from);
            self.into[from as usize].push(to);
        }
    }

    /// The third corners that close one more edge of the border, the likeliest first; [`NONE`] for what there is not.
    fn candidates(&self, p: u32, q: u32) -> [u32; CANDIDATES] {
        let ([a, b], [c, d]) = (self.out_of[q as usize].0, self.into[p as usize].0);
        let mut all = [a, c, b, d];
        for i in 0..CANDIDATES {
            if all[i] == p || all[i] == q || all[..i].contains(&all[i]) {
                all[i] = NONE;
            }
        }
        all
    }

    /// Which candidates there are, as a number below 4.
    fn situation(&self, candidates: [u32; CANDIDATES]) -> usize {
        usize::from(candidates[0] != NONE) | usize::from(candidates[1] != NONE) << 1
    }

    /// Whether a gate lies between two vertices that are not the page's own: most likely on the border of the patch.
    fn is_outer(&self, gate: Gate) -> usize {
        usize::from(gate.from >= self.own && gate.to >= self.own)
    }

    /// Notes the vertices that no triangle uses.
    pub(super) fn place_rest(&mut self) {
        for vertex in (0..self.own).filter(|&v| !self.seen[v as usize]) {
            self.placings.push(Placing { vertex, beside: [NONE; 2], across: NONE });
        }
    }
}

/// Turns a triangle so that it begins with a gate's edge; gives how far it was turned.
pub(super) fn turned(corners: [u32; 3], gate: Gate) -> Option<(u32, [u32; 3])> {
    let [a, b, c] = corners;
    [[a, b, c], [b, c, a], [c, a, b]]
        .into_iter()
        .zip(0..)
        .find(|([p, q, _], _)| (*p, *q) == (gate.from, gate.to))
        .map(|(turned, by)| (by, turned))
}

/// What the bits of triangles are likely to be.
#[derive(Debug)]
struct Model {
    glued: [Probability; 2],
    passed: [[Probability; GATES]; 2],
    turns: [Probability; 2],
    third: [[Probability; CANDIDATES + 2]; 4],
    corner: [[Probability; 2]; 3],
}

impl Model {
    const fn new() -> Self {
        const P: Probability = Probability::EVEN;
        Self {
            glued: [P; 2],
            passed: [[P; GATES]; 2],
            turns: [P; 2],
            third: [[P; CANDIDATES + 2]; 4],
            corner: [[P; 2]; 3],
        }
    }
}

/// Bits of a number below `count`.
fn index_bits(count: u32) -> u32 {
    u32::BITS - count.saturating_sub(1).leading_zeros()
}

/// Codes triangles of `own` vertices, numbered as [`Border`] says; gives the bytes and the placings.
pub(super) fn encode(own: u32, triangles: &[[u32; 3]]) -> (Vec<u8>, Vec<Placing>) {
    let mut coder = BinaryEncoder::new();
    let mut model = Model::new();
    let mut border = Border::new(own);
    let mut last_glued = false;
    for &triangle in triangles {
        let found = border.gates().zip(0..).find_map(|(gate, passed)| turned(triangle, gate).map(|t| (passed, t)));
        coder.put(found.is_some(), &mut model.glued[usize::from(last_glued)]);
        last_glued = found.is_some();
        let Some((passed, (by, corners))) = found else {
            for (i, corner) in triangle.into_iter().enumerate() {
                put_corner(&mut coder, &mut model.corner[i], &mut border, corner);
                border.place_corner(triangle, i);
            }
            border.add(triangle);
            continue;
        };
        let mut gate = border.gate();
        for i in 0..=passed {
            let outer = gate.map_or(0, |g| border.is_outer(g));
            coder.put(i < passed, &mut model.passed[outer][i]);
            if i < passed {
                gate = border.reach(1);
            }
        }
        coder.put(by > 0, &mut model.turns[0]);
        if by > 0 {
            coder.put(by > 1, &mut model.turns[1]);
        }
        let [p, q, third] = corners;
        let candidates = border.candidates(p, q);
        let likely = &mut model.third[border.situation(candidates)];
        let next_own = border.next_own();
        let is_new = third == next_own;
        coder.put(is_new, &mut likely[0]);
        let mut done = is_new;
        for (candidate, p) in candidates.into_iter().zip(&mut likely[1..=CANDIDATES]) {
            if !done && candidate != NONE {
                done = third == candidate;
                coder.put(done, p);
            }
        }
        if !done {
            put_seen_or_other(&mut coder, &mut likely[CANDIDATES + 1], &mut border, third);
        }
        border.place(corners, gate.map_or(NONE, |g| g.across));
        border.add(corners);
    }
    border.place_rest();
    (coder.finish(), border.placings)
}

fn put_corner(coder: &mut BinaryEncoder, p: &mut [Probability; 2], border: &mut Border, corner: u32) {
    let is_new = corner == border.next_own();
    coder.put(is_new, &mut p[0]);
    if !is_new {
        put_seen_or_other(coder, &mut p[1], border, corner);
    }
}

fn put_seen_or_other(coder: &mut BinaryEncoder, p: &mut Probability, border: &mut Border, corner: u32) {
    let is_other = corner >= border.vertices();
    coder.put(is_other, p);
    if is_other {
        border.add_other();
    } else {
        coder.put_even(corner, index_bits(border.vertices()));
    }
}

/// Undoes [`encode`] for `count` triangles and `others` vertices that are not the page's own; `None` when the bytes are no
/// such triangles.
pub(super) fn decode(own: u32, others: u32, count: usize, bytes: &[u8]) -> Option<(Vec<[u32; 3]>, Vec<Placing>)> {
    let mut coder = BinaryDecoder::new(bytes)?;
    let mut model = Model::new();
    let mut border = Border::new(own);
    // a triangle may take a small part of a bit, but what is allocated grows with what was read
    let mut triangles = Vec::with_capacity(count.min(1 << 12));
    let mut last_glued = false;
    let most = own.checked_add(others)?;
    for _ in 0..count {
        if coder.is_overrun() {
            return None;
        }
        last_glued = coder.get(&mut model.glued[usize::from(last_glued)]);
        if !last_glued {
            let mut triangle = [NONE; 3];
            for i in 0..3 {
                triangle[i] = get_corner(&mut coder, &mut model.corner[i], &mut border, most)?;
                border.place_corner(triangle, i);
            }
            border.add(triangle);
            triangles.push(triangle);
            continue;
        }
        let mut gate = border.gate()?;
        let mut passed = 0;
        while coder.get(&mut model.passed[border.is_outer(gate)][passed]) {
            passed += 1;
            gate = border.reach(1).filter(|_| passed < GATES)?;
        }
        let mut by = usize::from(coder.get(&mut model.turns[0]));
        if by > 0 {
            by += usize::from(coder.get(&mut model.turns[1]));
        }
        let Gate { from: p, to: q, across } = gate;
        let candidates = border.candidates(p, q);
        let likely = &mut model.third[border.situation(candidates)];
        let next_own = border.next_own();
        let mut third = if coder.get(&mut likely[0]) { next_own } else { NONE };
        for (candidate, p) in candidates.into_iter().zip(&mut likely[1..=CANDIDATES]) {
            if third == NONE && candidate != NONE && coder.get(p) {
                third = candidate;
            }
        }
        if third == NONE {
            third = get_seen_or_other(&mut coder, &mut likely[CANDIDATES + 1], &mut border, most)?;
        }
        let corners = [p, q, third];
        border.place(corners, across);
        border.add(corners);
        triangles.push([corners[(3 - by) % 3], corners[(4 - by) % 3], corners[(5 - by) % 3]]);
    }
    border.place_rest();
    (border.vertices() == most && coder.is_exhausted()).then_some((triangles, border.placings))
}

fn get_corner(coder: &mut BinaryDecoder<'_>, p: &mut [Probability; 2], border: &mut Border, most: u32) -> Option<u32> {
    if coder.get(&mut p[0]) {
        return Some(border.next_own()).filter(|&v| v != NONE);
    }
    get_seen_or_other(coder, &mut p[1], border, most)
}

fn get_seen_or_other(
    coder: &mut BinaryDecoder<'_>,
    p: &mut Probability,
    border: &mut Border,
    most: u32,
) -> Option<u32> {
    if coder.get(p) {
        return (border.vertices() < most).then(|| border.add_other());
    }
    Some(coder.get_even(index_bits(border.vertices()))).filter(|&v| v < border.vertices())
}
