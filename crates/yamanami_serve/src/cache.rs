//! Finished answers, up to so many bytes; what was not asked for longest goes first.

use bytes::Bytes;
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Answers by key.
#[derive(Debug)]
pub(crate) struct Cache<K> {
    most_bytes: usize,
    kept: Mutex<Kept<K>>,
}

#[derive(Debug)]
struct Kept<K> {
    bytes: usize,
    clock: u64,
    answers: HashMap<K, (Bytes, u64)>,
}

/// What an answer costs beside its bytes, so that empty ones count too.
const ENTRY_BYTES: usize = 128;

impl<K: Hash + Eq + Clone> Cache<K> {
    pub(crate) fn new(most_bytes: usize) -> Self {
        Self { most_bytes, kept: Mutex::new(Kept { bytes: 0, clock: 0, answers: HashMap::new() }) }
    }

    fn lock(&self) -> MutexGuard<'_, Kept<K>> {
        // nothing in here leaves half a change behind
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn get(&self, key: &K) -> Option<Bytes> {
        let mut kept = self.lock();
        kept.clock += 1;
        let clock = kept.clock;
        kept.answers.get_mut(key).map(|(bytes, used)| {
            *used = clock;
            bytes.clone()
        })
    }

    pub(crate) fn put(&self, key: K, bytes: Bytes) {
        let mut kept = self.lock();
        kept.clock += 1;
        kept.bytes += bytes.len() + ENTRY_BYTES;
        let clock = kept.clock;
        if let Some((old, _)) = kept.answers.insert(key, (bytes, clock)) {
            kept.bytes -= old.len() + ENTRY_BYTES;
        }
        while kept.bytes > self.most_bytes {
            let Some(oldest) = kept.answers.iter().min_by_key(|(_, (_, used))| *used).map(|(key, _)| key.clone())
            else {
                return;
            };
            if let Some((old, _)) = kept.answers.remove(&oldest) {
                kept.bytes -= old.len() + ENTRY_BYTES;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_never_holds_more_than_it_may() {
        let cache = Cache::new(3000);
        for key in 0..10 {
            cache.put(key, Bytes::from(vec![0; 800]));
            cache.get(&0);
            assert!(cache.lock().bytes <= 3000);
        }
        assert!(cache.get(&0).is_some() && cache.get(&9).is_some() && cache.get(&1).is_none());
        cache.put(0, Bytes::from(vec![0; 5000]));
        assert_eq!((cache.lock().bytes, cache.lock().answers.len()), (0, 0));
    }
}
