//! In what surroundings a bit is coded.

use super::mixing::INPUTS;

/// What one bit is coded in: a slot for each input, and a set of weights.
pub(super) type Contexts = ([usize; INPUTS], usize);

/// A vertex and those around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) vertex: u32,
    pub(super) level: u32,
    /// Neighbours of the same level.
    pub(super) beside: [u32; 4],
    pub(super) parent: u32,
    /// Neighbours of the parent.
    pub(super) beside_parent: [u32; 4],
}

/// Slots of one input of one kind of bit.
const PART: usize = 1 << 13;
const KINDS: usize = 4;
pub(super) const SLOTS: usize = KINDS * INPUTS * PART;
pub(super) const WEIGHT_SETS: usize = KINDS * QUESTIONS * 4;

/// What may be asked of what begins: each coefficient, and these.
const QUESTIONS: usize = 6;
/// Whether any does.
pub(super) const ANY: usize = 3;
/// Whether the one along the normal does, when some do.
pub(super) const NORMAL_OF_SOME: usize = 4;
/// Whether one along the surface does.
pub(super) const TANGENT: usize = 5;

const BEGIN: usize = 0;
const OPEN: usize = 1;
const SIGN: usize = 2;
const REFINE: usize = 3;

/// Sizes of few kinds: eight.
fn eight(x: u32) -> usize {
    const CLASS: [u8; 16] = [0, 1, 2, 3, 4, 4, 5, 5, 5, 6, 6, 6, 6, 6, 6, 7];
    usize::from(CLASS[x.min(15) as usize])
}

/// Five.
fn five(x: u32) -> usize {
    const CLASS: [u8; 8] = [0, 1, 2, 2, 3, 3, 3, 4];
    usize::from(CLASS[x.min(7) as usize])
}

fn sizes(of: &[u32; 4], c: usize, known: &[[i32; 3]]) -> u32 {
    of.iter().map(|&v| known[v as usize][c].unsigned_abs()).sum()
}

fn slots(kind: usize, at: [usize; INPUTS]) -> [usize; INPUTS] {
    std::array::from_fn(|i| {
        debug_assert!(at[i] < PART, "context {i} of kind {kind}: {}", at[i]);
        (kind * INPUTS + i) * PART + (at[i] & (PART - 1))
    })
}

impl Place {
    /// A vertex of the base mesh; `none` stands for vertices that are not there.
    pub(super) fn base(vertex: u32, none: u32) -> Self {
        Self { vertex, level: 0, beside: [none; 4], parent: none, beside_parent: [none; 4] }
    }

    fn weights(&self, kind: usize, c: usize) -> usize {
        (kind * QUESTIONS + c) * 4 + self.level.min(3) as usize
    }

    pub(super) fn of_beginning(&self, question: usize, plane: u32, known: &[[i32; 3]]) -> Contexts {
        let own = known[self.vertex as usize].map(|q| q.unsigned_abs() >> plane);
        let each = |v: u32| {
            let [a, b, c] = known[v as usize];
            match question {
                1 => b.unsigned_abs(),
                2 => c.unsigned_abs(),
                TANGENT => b.unsigned_abs() + c.unsigned_abs(),
                _ => a.unsigned_abs(),
            }
        };
        let beside = self.beside.map(|v| each(v) >> plane);
        let around: u32 = beside.iter().sum();
        let parent = each(self.parent) >> plane;
        let above = self.beside_parent.iter().map(|&v| each(v)).sum::<u32>() >> plane;
        // what of the vertex itself says something
        let (x, y) = match question {
            1 => (own[0], own[2]),
            2 => (own[0], own[1]),
            TANGENT => (own[0], 0),
            _ => (own[1], own[2]),
        };
        let pattern = beside.iter().fold(0, |n, &e| 3 * n + e.min(2) as usize);
        let l = self.level.min(11) as usize;
        let (p, q) = (plane as usize, question);
        let at = [
            q + 6 * (eight(around) + 8 * (five(parent) + 5 * l)),
            q + 6 * (p + 32 * l),
            q + 6 * (pattern + 81 * five(parent)),
            q + 6 * (five(x) + 5 * (five(y) + 5 * eight(around + 2 * parent))),
            q + 6 * (eight(above) + 8 * (eight(around) + 8 * five(parent))),
            q + 6 * (eight((4 * around + 2 * above + 4 * parent) / 4) + 8 * p),
        ];
        (slots(BEGIN, at), self.weights(BEGIN, q))
    }

    pub(super) fn of_open(&self, plane: u32, known: &[[i32; 3]], is_open: &[bool]) -> Contexts {
        let own = known[self.vertex as usize].iter().map(|q| q.unsigned_abs() >> plane).max().unwrap_or(0);
        let pattern = self.beside.iter().fold(0, |n, &v| 2 * n + usize::from(is_open[v as usize]));
        let open = pattern.count_ones() as usize;
        let above = self.beside_parent.iter().filter(|&&v| is_open[v as usize]).count();
        let around: u32 = (0..3).map(|c| sizes(&self.beside, c, known) >> plane).sum();
        let parent = known[self.parent as usize].iter().map(|q| q.unsigned_abs() >> plane).max().unwrap_or(0);
        let l = self.level.min(11) as usize;
        let p = plane as usize;
        let at = [
            open + 5 * (five(own) + 5 * (above + 5 * five(parent))),
            p + 32 * l,
            pattern + 16 * (five(own) + 5 * l),
            eight(around) + 8 * (five(own) + 5 * open),
            eight(around) + 8 * (five(parent) + 5 * five(own)),
            open + 5 * (above + 5 * p),
        ];
        (slots(OPEN, at), self.weights(OPEN, 0))
    }

    pub(super) fn of_sign(&self, c: usize, plane: u32, known: &[[i32; 3]]) -> Contexts {
        let sign = |v: u32| (known[v as usize][c].signum() + 1) as usize;
        let pattern = self.beside.iter().fold(0, |n, &v| 3 * n + sign(v));
        let sum: i32 = self.beside.iter().map(|&v| known[v as usize][c] >> plane).sum();
        let above: i32 = self.beside_parent.iter().map(|&v| known[v as usize][c] >> plane).sum();
        let parent = known[self.parent as usize][c] >> plane;
        let class = |x: i32| (x.clamp(-4, 4) + 4) as usize;
        let l = self.level.min(11) as usize;
        let [x, y] = [1, 2].map(|k| (known[self.vertex as usize][(c + k) % 3].signum() + 1) as usize);
        let at = [
            c + 3 * pattern,
            c + 3 * (class(sum) + 9 * class(parent)),
            c + 3 * (class(above) + 9 * class(parent)),
            c + 3 * (x + 3 * y + 9 * class(sum)),
            c + 3 * (l + 12 * class(parent)),
            c + 3 * (l + 12 * class(sum)),
        ];
        (slots(SIGN, at), self.weights(SIGN, c))
    }

    pub(super) fn of_refining(&self, c: usize, plane: u32, known: &[[i32; 3]]) -> Contexts {
        let own = known[self.vertex as usize][c].unsigned_abs() >> (plane + 1);
        let around = sizes(&self.beside, c, known) >> plane;
        let parent = known[self.parent as usize][c].unsigned_abs() >> plane;
        let above = sizes(&self.beside_parent, c, known) >> plane;
        let l = self.level.min(11) as usize;
        let p = plane as usize;
        let at = [
            c + 3 * (eight(own) + 8 * eight(around / 2)),
            c + 3 * (eight(own) + 8 * l),
            c + 3 * (p + 32 * l),
            c + 3 * (eight(own) + 8 * eight(parent)),
            c + 3 * (eight(own) + 8 * eight(above / 2)),
            c + 3 * (eight(own) + 8 * p),
        ];
        (slots(REFINE, at), self.weights(REFINE, c))
    }
}
