//! The edges that may be collapsed, the cheapest first, to within a few per cent: sorted into classes of cost, so that each
//! comes and goes in constant time.
//!
//! Idea: Dial, "Algorithm 360: Shortest-path forest with topological ordering", 1969 (a queue of buckets).

use super::net::NONE;

/// Low bits of a cost that do not count: a class is 1/64 of an octave, about 1.5 % wide.
const IGNORED_BITS: u32 = 17;

/// Costs below 2⁻⁶⁰ are one class, and those above 2⁶⁶.
const CLASSES: usize = 126 << (23 - IGNORED_BITS);

fn class_of(cost: f32) -> usize {
    const LEAST: u32 = (127 - 60) << (23 - IGNORED_BITS);
    ((cost.to_bits() >> IGNORED_BITS).saturating_sub(LEAST) as usize).min(CLASSES - 1)
}

/// An edge that may be collapsed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) cost: f32,
    pub(super) ends: [u32; 2],
    /// How often its ends had changed: where they have since, it is void.
    pub(super) stamp: u32,
    /// Whether the cost was measured, or only estimated.
    pub(super) is_measured: bool,
}

/// The queue. Of one class the last to come is the first to go, so that there is one result.
#[derive(Debug)]
pub(super) struct Queue {
    /// The last candidate of each class.
    head: Vec<u32>,
    /// A bit for each class that has one.
    filled: Vec<u64>,
    /// Candidates, each with the one before it in its class; and those gone, in a list of their own.
    items: Vec<(Candidate, u32)>,
    gone: u32,
    /// No filled word is before it.
    first: usize,
}

impl Queue {
    pub(super) fn new(room: usize) -> Self {
        let words = CLASSES.div_ceil(64);
        Self {
            head: vec![NONE; CLASSES],
            filled: vec![0; words],
            items: Vec::with_capacity(room),
            gone: NONE,
            first: words,
        }
    }

    /// Costs are not negative.
    pub(super) fn push(&mut self, candidate: Candidate) {
        let class = class_of(candidate.cost);
        let item = (candidate, self.head[class]);
        self.head[class] = if self.gone == NONE {
            self.items.push(item);
            self.items.len() as u32 - 1
        } else {
            let place = self.gone;
            self.gone = std::mem::replace(&mut self.items[place as usize], item).1;
            place
        };
        self.filled[class / 64] |= 1 << (class % 64);
        self.first = self.first.min(class / 64);
    }

    pub(super) fn pop(&mut self) -> Option<Candidate> {
        while *self.filled.get(self.first)? == 0 {
            self.first += 1;
        }
        let class = 64 * self.first + self.filled[self.first].trailing_zeros() as usize;
        let place = self.head[class];
        let (candidate, before) = self.items[place as usize];
        self.head[class] = before;
        if before == NONE {
            self.filled[class / 64] &= !(1 << (class % 64));
        }
        self.items[place as usize].1 = self.gone;
        self.gone = place;
        Some(candidate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheapest_come_first() {
        let mut queue = Queue::new(4);
        let costs = [3.0f32, 0.0, 1e-17, 7e7, 2.0, 1e-17, 1e18, 0.5, 2.1];
        for (i, cost) in (0u32..).zip(costs) {
            queue.push(Candidate { cost, ends: [i, i + 1], stamp: 0, is_measured: false });
        }
        let mut last = queue.pop().unwrap();
        for n in 1..costs.len() + 3 {
            if n < 4 {
                queue.push(Candidate { cost: 1e9, ..last });
            }
            let now = queue.pop().unwrap();
            assert!(now.cost * 1.016 >= last.cost);
            last = now;
        }
        assert!(queue.pop().is_none());
    }
}
