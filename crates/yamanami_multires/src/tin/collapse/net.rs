//! The triangulation that a collapse works on: who is around a vertex, and what each vertex may do.

use glam::DVec3;
use std::collections::HashMap;

/// No vertex, no corner.
pub(super) const NONE: u32 = u32::MAX;

/// What a vertex may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Inside a smooth part: it may go anywhere.
    Free,
    /// On a line that must stay a line (the border, a breakline), between the two given vertices of it: it may go along it.
    Chain([u32; 2]),
    /// Neither moves nor goes.
    Fixed,
    /// Gone.
    Gone,
}

/// An edge without its direction.
pub(super) fn edge_key(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

/// A triangulation under work.
#[derive(Debug)]
pub(super) struct Net {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) kinds: Vec<Kind>,
    pub(super) is_alive: Vec<bool>,
    /// First corner (3 × triangle + place) of each vertex, and for each corner the next of the same vertex.
    head: Vec<u32>,
    next: Vec<u32>,
}

impl Net {
    /// `is_locked` by vertex; `lines` are edges of breaklines. Borders are found.
    pub(super) fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>, is_locked: &[bool], lines: &[[u32; 2]]) -> Self {
        let n = positions.len();
        let mut net = Self {
            kinds: vec![Kind::Gone; n],
            is_alive: vec![true; triangles.len()],
            head: vec![NONE; n],
            next: vec![NONE; 3 * triangles.len()],
            positions,
            triangles,
        };
        for t in (0..net.triangles.len()).rev() {
            for (k, v) in net.triangles[t].into_iter().enumerate() {
                let corner = (3 * t + k) as u32;
                net.next[corner as usize] = net.head[v as usize];
                net.head[v as usize] = corner;
            }
        }
        net.find_kinds(is_locked, lines);
        net
    }

    fn find_kinds(&mut self, is_locked: &[bool], lines: &[[u32; 2]]) {
        let mut on_lines: HashMap<u32, Vec<u32>> = HashMap::new();
        for &[a, b] in lines {
            on_lines.entry(a).or_default().push(b);
            on_lines.entry(b).or_default().push(a);
        }
        // around a vertex, each neighbour is where one triangle ends and the next begins; on the border it is one alone
        let mut around: Vec<(u32, i32)> = Vec::with_capacity(16);
        let mut ring: Vec<[u32; 2]> = Vec::with_capacity(16);
        for v in 0..self.positions.len() as u32 {
            if self.head[v as usize] == NONE {
                continue;
            }
            if is_locked[v as usize] {
                self.kinds[v as usize] = Kind::Fixed;
                continue;
            }
            if self.is_closed(v, &mut ring) && !on_lines.contains_key(&v) {
                self.kinds[v as usize] = Kind::Free;
                continue;
            }
            around.clear();
            for [_, from, to] in self.star(v) {
                around.push((from, 1));
                around.push((to, -1));
            }
            around.sort_unstable();
            let mut line: Vec<u32> = Vec::new();
            let mut is_plain = true;
            for run in around.chunk_by(|a, b| a.0 == b.0) {
                match run {
                    [(_, 1 | -1)] => line.push(run[0].0),
                    [(_, -1), (_, 1)] => {}
                    _ => is_plain = false,
                }
            }
            // more than one way in and out: the surface only touches itself here
            is_plain &= line.len() <= 2;
            if let Some(more) = on_lines.get(&v) {
                line.extend(more);
                line.sort_unstable();
                line.dedup();
            }
            self.kinds[v as usize] = match line[..] {
                _ if !is_plain => Kind::Fixed,
                [] => Kind::Free,
                [a, b] => Kind::Chain([a, b]),
                _ => Kind::Fixed,
            };
        }
    }

    /// Whether the triangles around a vertex close one ring.
    fn is_closed(&self, v: u32, ring: &mut Vec<[u32; 2]>) -> bool {
        ring.clear();
        ring.extend(self.star(v).map(|[_, from, to]| [from, to]));
        let [first, mut at] = ring[0];
        for _ in 1..ring.len() {
            match ring.iter().find(|side| side[0] == at) {
                Some(&[_, to]) if at != first => at = to,
                _ => return false,
            }
        }
        at == first
    }

    /// The corners of a vertex that are alive.
    pub(super) fn corners(&self, v: u32) -> impl Iterator<Item = u32> {
        let mut corner = self.head[v as usize];
        std::iter::from_fn(move || {
            while corner != NONE {
                let this = corner;
                corner = self.next[corner as usize];
                if self.is_alive[this as usize / 3] {
                    return Some(this);
                }
            }
            None
        })
    }

    /// The triangle of a corner, turned to begin with it.
    pub(super) fn turned(&self, corner: u32) -> [u32; 3] {
        let t = self.triangles[corner as usize / 3];
        match corner % 3 {
            0 => t,
            1 => [t[1], t[2], t[0]],
            _ => [t[2], t[0], t[1]],
        }
    }

    /// The triangles around a vertex, turned to begin with it.
    pub(super) fn star(&self, v: u32) -> impl Iterator<Item = [u32; 3]> {
        self.corners(v).map(|corner| self.turned(corner))
    }

    /// Joins `gone` to `kept`: the triangles with both vanish, those of `gone` become `kept`'s. Gives how many vanished.
    pub(super) fn join(&mut self, gone: u32, kept: u32) -> usize {
        let mut vanished = 0;
        let mut corner = self.head[gone as usize];
        let (mut first, mut last) = (NONE, NONE);
        while corner != NONE {
            let after = self.next[corner as usize];
            let t = corner as usize / 3;
            if self.is_alive[t] {
                if self.triangles[t].contains(&kept) {
                    self.is_alive[t] = false;
                    vanished += 1;
                } else {
                    self.triangles[t][corner as usize % 3] = kept;
                    if first == NONE {
                        first = corner;
                    } else {
                        self.next[last as usize] = corner;
                    }
                    last = corner;
                }
            }
            corner = after;
        }
        // in front of what `kept` has, the dead dropped on the way
        let mut kept_corner = self.head[kept as usize];
        while kept_corner != NONE {
            let after = self.next[kept_corner as usize];
            if self.is_alive[kept_corner as usize / 3] {
                if first == NONE {
                    first = kept_corner;
                } else {
                    self.next[last as usize] = kept_corner;
                }
                last = kept_corner;
            }
            kept_corner = after;
        }
        if last != NONE {
            self.next[last as usize] = NONE;
        }
        self.head[kept as usize] = first;
        self.head[gone as usize] = NONE;
        self.kinds[gone as usize] = Kind::Gone;
        vanished
    }
}
