//! A small hash table from keys to vertex numbers that is emptied in no time.

/// Open addressing; an entry counts when it has the table's stamp.
#[derive(Debug, Clone)]
pub(super) struct Table {
    /// Stamp in the upper bits, key in the lower [`KEY_BITS`].
    keys: Vec<u64>,
    values: Vec<u32>,
    len: usize,
    stamp: u64,
}

const KEY_BITS: u32 = 36;
const FIRST_CAPACITY: usize = 1 << 12;

impl Default for Table {
    fn default() -> Self {
        Self { keys: vec![0; FIRST_CAPACITY], values: vec![0; FIRST_CAPACITY], len: 0, stamp: 1 }
    }
}

impl Table {
    pub(super) fn clear(&mut self) {
        self.len = 0;
        self.stamp += 1;
        if self.stamp >> (64 - KEY_BITS) != 0 {
            self.keys.fill(0);
            self.stamp = 1;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.len == 0
    }

    #[inline]
    fn slot(&self, full: u64) -> usize {
        let mask = self.keys.len() - 1;
        let mut slot = (full.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize & mask;
        while self.keys[slot] != full && self.keys[slot] >> KEY_BITS == self.stamp {
            slot = (slot + 1) & mask;
        }
        slot
    }

    #[inline]
    pub(super) fn get(&self, key: u64) -> Option<u32> {
        let full = self.stamp << KEY_BITS | key;
        let slot = self.slot(full);
        (self.keys[slot] == full).then(|| self.values[slot])
    }

    /// The value of a key, given by `make` the first time.
    #[inline]
    pub(super) fn entry(&mut self, key: u64, make: impl FnOnce() -> u32) -> &mut u32 {
        let full = self.stamp << KEY_BITS | key;
        let mut slot = self.slot(full);
        if self.keys[slot] != full {
            if self.len * 2 >= self.keys.len() {
                self.grow();
                slot = self.slot(full);
            }
            self.keys[slot] = full;
            self.values[slot] = make();
            self.len += 1;
        }
        &mut self.values[slot]
    }

    fn grow(&mut self) {
        let capacity = self.keys.len() * 2;
        let keys = std::mem::replace(&mut self.keys, vec![0; capacity]);
        let values = std::mem::replace(&mut self.values, vec![0; capacity]);
        for (full, value) in keys.into_iter().zip(values) {
            if full >> KEY_BITS == self.stamp {
                let slot = self.slot(full);
                self.keys[slot] = full;
                self.values[slot] = value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_what_it_was_given_until_cleared() {
        let mut table = Table::default();
        for round in 0..3u32 {
            for key in 0..20_000u64 {
                assert_eq!(*table.entry(key * 7919, || key as u32 + round), key as u32 + round);
            }
            assert!((0..20_000u64).all(|key| table.get(key * 7919) == Some(key as u32 + round)));
            assert_eq!(table.get(1), None);
            table.clear();
            assert!(table.is_empty() && table.get(0).is_none());
        }
    }
}
