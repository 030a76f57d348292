//! Which slots of a buffer changed since the last upload.

use std::ops::Range;

/// A set of changed slots that yields them as few, near-minimal ranges.
#[derive(Debug, Clone, Default)]
pub(crate) struct DirtySlots {
    /// Changed slots in no order, each once.
    slots: Vec<u32>,
    /// One bit a slot: whether it is in `slots`.
    marks: Vec<u64>,
}

impl DirtySlots {
    /// Marks a slot as changed.
    #[inline]
    pub(crate) fn mark(&mut self, slot: u32) {
        let (word, bit) = (slot as usize / 64, 1u64 << (slot % 64));
        if word >= self.marks.len() {
            self.marks.resize((word + 1).next_power_of_two(), 0);
        }
        if self.marks[word] & bit == 0 {
            self.marks[word] |= bit;
            self.slots.push(slot);
        }
    }

    /// Marks the first `len` slots.
    pub(crate) fn mark_all(&mut self, len: u32) {
        (0..len).for_each(|slot| self.mark(slot));
    }

    /// Forgets all marks.
    pub(crate) fn clear(&mut self) {
        for &slot in &self.slots {
            self.marks[slot as usize / 64] = 0;
        }
        self.slots.clear();
    }

    /// Takes the marked slots below `len` as ascending ranges; ranges at most `gap` slots apart become one.
    pub(crate) fn take_ranges(&mut self, len: u32, gap: u32) -> Vec<Range<u32>> {
        self.slots.sort_unstable();
        let mut ranges: Vec<Range<u32>> = Vec::new();
        for &slot in self.slots.iter().take_while(|&&slot| slot < len) {
            match ranges.last_mut() {
                Some(last) if slot - last.end <= gap => last.end = slot + 1,
                _ => ranges.push(slot..slot + 1),
            }
        }
        self.clear();
        ranges
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ranges_cover_every_mark_and_little_else(
            marks in proptest::collection::vec(0u32..500, 0..80), gap in 0u32..9, len in 1u32..500
        ) {
            let mut dirty = DirtySlots::default();
            marks.iter().for_each(|&slot| dirty.mark(slot));
            let ranges = dirty.take_ranges(len, gap);
            let marked = |slot: u32| marks.contains(&slot);
            for slot in 0..len {
                let covered = ranges.iter().any(|r| r.contains(&slot));
                prop_assert!(covered || !marked(slot));
            }
            for range in &ranges {
                prop_assert!(range.end <= len && marked(range.start) && marked(range.end - 1));
            }
            for pair in ranges.windows(2) {
                prop_assert!(pair[1].start - pair[0].end > gap);
            }
            prop_assert!(dirty.take_ranges(len, gap).is_empty());
        }
    }
}
