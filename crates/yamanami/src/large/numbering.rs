//! A set of vertices that numbers its members in order, a little over a bit for each vertex of the mesh.

/// Words between two counts.
const STEP: usize = 8;

/// A set, and the rank of each member.
#[derive(Debug, Default)]
pub(super) struct Numbering {
    words: Vec<u64>,
    /// Members before each stretch of [`STEP`] words.
    before: Vec<u32>,
}

impl Numbering {
    /// The empty set of vertices below a number.
    pub(super) fn new(vertices: u64) -> Self {
        let words = (vertices as usize).div_ceil(64);
        Self { words: vec![0; words], before: vec![0; words.div_ceil(STEP)] }
    }

    pub(super) fn clear(&mut self) {
        self.words.fill(0);
    }

    pub(super) fn insert(&mut self, vertex: u32) {
        self.words[vertex as usize / 64] |= 1 << (vertex % 64);
    }

    #[inline]
    pub(super) fn contains(&self, vertex: u32) -> bool {
        self.words[vertex as usize / 64] >> (vertex % 64) & 1 == 1
    }

    /// Makes ranks right after the last member came; gives the number of members.
    pub(super) fn count(&mut self) -> usize {
        let mut sum = 0;
        for (before, words) in self.before.iter_mut().zip(self.words.chunks(STEP)) {
            *before = sum;
            sum += words.iter().map(|w| w.count_ones()).sum::<u32>();
        }
        sum as usize
    }

    /// How many members are smaller, if this is one.
    #[inline]
    pub(super) fn rank(&self, vertex: u32) -> Option<u32> {
        if !self.contains(vertex) {
            return None;
        }
        let word = vertex as usize / 64;
        let step = word / STEP;
        let between: u32 = self.words[step * STEP..word].iter().map(|w| w.count_ones()).sum();
        let below = self.words[word] & ((1u64 << (vertex % 64)) - 1);
        Some(self.before[step] + between + below.count_ones())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_are_numbered_in_order() {
        let mut set = Numbering::new(5000);
        let members: Vec<u32> = (0..5000).filter(|v| v % 7 == 3 || v % 64 == 63 || *v == 0).collect();
        for &v in &members {
            set.insert(v);
        }
        assert_eq!(set.count(), members.len());
        for v in 0..5000 {
            assert_eq!(set.rank(v).map(|r| r as usize), members.binary_search(&v).ok());
        }
        set.clear();
        assert_eq!(set.count(), 0);
        assert_eq!(set.rank(63), None);
    }
}
