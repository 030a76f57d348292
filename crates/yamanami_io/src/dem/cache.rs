//! Decoded chunks, the least recently used thrown out first, bounded in bytes.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Part number, chunk column, chunk row.
pub(super) type ChunkKey = (usize, usize, usize);

#[derive(Debug)]
pub(super) struct ChunkCache {
    limit_bytes: usize,
    used_bytes: usize,
    clock: u64,
    chunks: HashMap<ChunkKey, (u64, Arc<[f32]>)>,
    by_use: BTreeMap<u64, ChunkKey>,
}

impl ChunkCache {
    pub(super) fn new(limit_bytes: usize) -> Self {
        Self { limit_bytes, used_bytes: 0, clock: 0, chunks: HashMap::new(), by_use: BTreeMap::new() }
    }

    pub(super) fn get(&mut self, key: ChunkKey) -> Option<Arc<[f32]>> {
        let (last_use, heights_m) = self.chunks.get_mut(&key)?;
        self.by_use.remove(last_use);
        self.clock += 1;
        *last_use = self.clock;
        self.by_use.insert(self.clock, key);
        Some(heights_m.clone())
    }

    /// Keeps a chunk, dropping older ones. A chunk larger than the limit is kept alone, so that windows inside it do
    /// not decode it again and again.
    pub(super) fn insert(&mut self, key: ChunkKey, heights_m: Arc<[f32]>) {
        let bytes = size_of_val(&*heights_m);
        if self.chunks.contains_key(&key) {
            return;
        }
        while self.used_bytes + bytes > self.limit_bytes {
            let Some((_, oldest)) = self.by_use.pop_first() else { break };
            if let Some((_, dropped)) = self.chunks.remove(&oldest) {
                self.used_bytes -= size_of_val(&*dropped);
            }
        }
        self.clock += 1;
        self.used_bytes += bytes;
        self.by_use.insert(self.clock, key);
        self.chunks.insert(key, (self.clock, heights_m));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_holds_and_the_oldest_goes_first() {
        let mut cache = ChunkCache::new(64);
        let chunk: Arc<[f32]> = vec![0.0; 4].into();
        for i in 0..4 {
            cache.insert((0, i, 0), chunk.clone());
        }
        assert!(cache.get((0, 0, 0)).is_some(), "used again, so now the newest");
        cache.insert((0, 4, 0), chunk.clone());
        assert!(cache.get((0, 0, 0)).is_some());
        assert!(cache.get((0, 1, 0)).is_none());
        assert!(cache.used_bytes <= 64 && cache.chunks.len() == 4);
        cache.insert((1, 0, 0), vec![0.0; 100].into());
        assert!(cache.get((1, 0, 0)).is_some() && cache.chunks.len() == 1, "larger than the cache: kept alone");
        cache.insert((0, 0, 0), chunk.clone());
        assert_eq!(cache.used_bytes, 16);
    }
}
