//! Decoded tiles that are needed again: those of neighbours and of other levels. Bounded by bytes.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex};

/// Values by key. The oldest go when there are too many.
#[derive(Debug)]
pub(super) struct Cache<K, V> {
    inner: Mutex<Inner<K, V>>,
    most_bytes: usize,
}

#[derive(Debug)]
struct Inner<K, V> {
    held: HashMap<K, (Arc<V>, usize, u64)>,
    bytes: usize,
    clock: u64,
}

impl<K: Hash + Eq + Copy, V> Cache<K, V> {
    pub(super) fn new(most_bytes: usize) -> Self {
        Self { inner: Mutex::new(Inner { held: HashMap::new(), bytes: 0, clock: 0 }), most_bytes }
    }

    /// The value of a key, made where it is not held. `make` gives it with its size in bytes.
    pub(super) fn get<E>(&self, key: K, make: impl FnOnce() -> Result<(V, usize), E>) -> Result<Arc<V>, E> {
        if let Some(value) = self.held(&key) {
            return Ok(value);
        }
        // made without the lock: two threads may make the same, which costs time and nothing else
        let (value, bytes) = make()?;
        let value = Arc::new(value);
        let mut inner = self.inner.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        inner.clock += 1;
        let clock = inner.clock;
        if let Some((_, old, _)) = inner.held.insert(key, (value.clone(), bytes, clock)) {
            inner.bytes -= old;
        }
        inner.bytes += bytes;
        if inner.bytes > self.most_bytes {
            inner.drop_half(self.most_bytes / 2);
        }
        Ok(value)
    }

    fn held(&self, key: &K) -> Option<Arc<V>> {
        let mut inner = self.inner.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        inner.clock += 1;
        let clock = inner.clock;
        let (value, _, used) = inner.held.get_mut(key)?;
        *used = clock;
        Some(value.clone())
    }
}

impl<K: Hash + Eq + Copy, V> Inner<K, V> {
    fn drop_half(&mut self, target: usize) {
        let mut ages: Vec<(u64, K)> = self.held.iter().map(|(key, (_, _, used))| (*used, *key)).collect();
        ages.sort_unstable_by_key(|(used, _)| *used);
        for (_, key) in ages {
            if self.bytes <= target {
                break;
            }
            if let Some((_, bytes, _)) = self.held.remove(&key) {
                self.bytes -= bytes;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Cache;

    #[test]
    fn the_oldest_go() {
        let cache = Cache::new(10);
        let get = |key: u32| *cache.get::<()>(key, || Ok((key * 2, 4))).unwrap();
        assert_eq!([get(1), get(2), get(1), get(3)], [2, 4, 2, 6]);
        let again = |key: u32| cache.get(key, || Err(())).is_ok();
        assert!(!again(2) && again(3));
    }
}
