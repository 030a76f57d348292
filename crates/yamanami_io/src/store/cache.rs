//! Decoded pages, least recently used first to go.

use std::collections::HashMap;
use std::sync::Arc;
use yamanami_core::{PageId, TerrainPage};

/// Keeps pages up to a number of bytes.
#[derive(Debug)]
pub(super) struct PageCache {
    limit: usize,
    bytes: usize,
    clock: u64,
    pages: HashMap<PageId, (Arc<TerrainPage>, u64)>,
}

/// The newest page stays however little is allowed, or a chain of pages could not be read.
const LEAST_PAGES: usize = 1;

fn size(page: &TerrainPage) -> usize {
    size_of::<TerrainPage>() + page.heights_m.len() * 4 + page.errors.len() * 2 + page.shown.len()
}

impl PageCache {
    pub(super) fn new(limit: usize) -> Self {
        Self { limit, bytes: 0, clock: 0, pages: HashMap::new() }
    }

    pub(super) fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
        self.shrink();
    }

    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    pub(super) fn get(&mut self, id: PageId) -> Option<Arc<TerrainPage>> {
        self.clock += 1;
        let (page, used) = self.pages.get_mut(&id)?;
        *used = self.clock;
        Some(page.clone())
    }

    pub(super) fn insert(&mut self, page: Arc<TerrainPage>) {
        self.clock += 1;
        self.bytes += size(&page);
        if let Some((old, _)) = self.pages.insert(page.id, (page, self.clock)) {
            self.bytes -= size(&old);
        }
        self.shrink();
    }

    fn shrink(&mut self) {
        while self.bytes > self.limit && self.pages.len() > LEAST_PAGES {
            let Some(oldest) = self.pages.iter().min_by_key(|(_, (_, used))| *used).map(|(&id, _)| id) else { return };
            if let Some((page, _)) = self.pages.remove(&oldest) {
                self.bytes -= size(&page);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(x: u32) -> Arc<TerrainPage> {
        let id = PageId { level: 0, x, y: 0 };
        Arc::new(TerrainPage { id, width: 0, height: 0, heights_m: vec![0.0; 1000], errors: vec![], shown: vec![] })
    }

    #[test]
    fn the_page_not_used_for_longest_goes_first() {
        let mut cache = PageCache::new(3 * size(&page(0)));
        for x in 0..3 {
            cache.insert(page(x));
        }
        assert!(cache.get(page(0).id).is_some());
        cache.insert(page(3));
        assert!(cache.get(page(1).id).is_none());
        assert!([0, 2, 3].into_iter().all(|x| cache.get(page(x).id).is_some()));
        cache.set_limit(0);
        assert_eq!(cache.bytes(), size(&page(0)));
    }
}
