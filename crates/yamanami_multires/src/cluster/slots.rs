//! A small hash table from numbers to numbers, for what would else be sorted: edges, vertices of a patch.
//!
//! Based on: Knuth, "The Art of Computer Programming", volume 3, 6.4 (open addressing).

/// No value yet.
pub(super) const NONE: u32 = u32::MAX;

/// No key. Edges have two ends that differ, vertices are below 2³².
const FREE: u64 = u64::MAX;

/// The table. It never grows: it is made for the most keys that there can be.
#[derive(Debug, Default)]
pub(super) struct Slots {
    slots: Vec<(u64, u32)>,
    shift: u32,
}

impl Slots {
    /// Empties it, and makes room for so many keys.
    pub(super) fn reset(&mut self, keys: usize) {
        let size = (keys + keys / 2).next_power_of_two().max(16);
        self.shift = 64 - size.trailing_zeros();
        self.slots.clear();
        self.slots.resize(size, (FREE, NONE));
    }

    /// The slot of a key.
    pub(super) fn slot_of(&mut self, key: u64) -> usize {
        let last = self.slots.len() - 1;
        let mut slot = ((key ^ key >> 32).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> self.shift) as usize;
        loop {
            match self.slots[slot].0 {
                found if found == key => return slot,
                FREE => {
                    self.slots[slot].0 = key;
                    return slot;
                }
                _ => slot = (slot + 1) & last,
            }
        }
    }

    /// The value in a slot.
    pub(super) fn value(&mut self, slot: usize) -> &mut u32 {
        &mut self.slots[slot].1
    }

    /// All keys with their values, in no order.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u64, u32)> {
        self.slots.iter().copied().filter(|slot| slot.0 != FREE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_put_in_is_found() {
        let mut slots = Slots::default();
        for keys in [1u64, 40, 3000] {
            slots.reset(keys as usize);
            for key in (0..keys).chain(0..keys / 2) {
                let slot = slots.slot_of(key << 32 | 7);
                let value = slots.value(slot);
                *value = if *value == NONE { 1 } else { *value + 1 };
            }
            let mut all: Vec<(u64, u32)> = slots.iter().collect();
            all.sort_unstable();
            assert!(all.into_iter().eq((0..keys).map(|key| (key << 32 | 7, 1 + u32::from(key < keys / 2)))));
        }
    }
}
