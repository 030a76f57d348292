//! Triangles by what they miss: a queue that is exact to a 64th.
//!
//! Which of two nearly equal errors goes first makes no difference to the result's size, and buckets cost less than a heap of
//! millions. Of a bucket the last that came goes first: its triangles are still near at hand.

/// Bits of a number's 52 after the point that do not count: 6 do.
const IGNORED_BITS: u32 = 52 - 6;

/// A triangle, and how often it had been looked at when it was put here.
pub(super) type Entry = (u32, u32);

#[derive(Debug)]
pub(super) struct Queue {
    /// By error, from the least that is put here on.
    buckets: Vec<Vec<Entry>>,
    least: usize,
    /// No bucket beyond has any.
    top: usize,
}

/// Errors are not negative: their bits are in their order.
fn bucket(error_m: f64) -> usize {
    (error_m.to_bits() >> IGNORED_BITS) as usize
}

impl Queue {
    /// For errors above one.
    pub(super) fn above(error_m: f64) -> Self {
        Self { buckets: Vec::new(), least: bucket(error_m.max(0.0)), top: 0 }
    }

    pub(super) fn push(&mut self, error_m: f64, entry: Entry) {
        let at = bucket(error_m).saturating_sub(self.least);
        if at >= self.buckets.len() {
            self.buckets.resize_with(at + 1, Vec::new);
        }
        self.buckets[at].push(entry);
        self.top = self.top.max(at);
    }

    pub(super) fn pop(&mut self) -> Option<Entry> {
        loop {
            if let Some(entry) = self.buckets.get_mut(self.top)?.pop() {
                return Some(entry);
            }
            self.top = self.top.checked_sub(1)?;
        }
    }
}
