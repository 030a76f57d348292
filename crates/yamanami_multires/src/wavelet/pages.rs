//! A terrain of which only some pages are in memory.
//!
//! Pages are added through a shared reference while the surface is in use, and dropped through an exclusive one. A point on
//! the border of pages may be read from any of them; a midpoint belongs to the page right of and below its border.

use super::data::{TerrainData, gradient};
use std::sync::{Arc, OnceLock};
use yamanami_core::{ErrorCode, Lattice, LatticeNode, PAGE_CELLS, PageId, TerrainPage};

/// Heights and errors by pages.
#[derive(Debug, Clone)]
pub struct PagedData {
    lattice: Lattice,
    has_holes: bool,
    /// By level, row by row of its pages.
    pages: Vec<Vec<OnceLock<Arc<TerrainPage>>>>,
    columns: Vec<u32>,
}

impl PagedData {
    /// No page yet.
    pub fn new(lattice: Lattice, has_holes: bool) -> Self {
        let grid = |level| lattice.squares(level).map(|n| n.div_ceil(PAGE_CELLS));
        let levels = 0..=lattice.levels();
        let columns = levels.clone().map(|level| grid(level)[0]).collect();
        let pages = levels
            .map(|level| {
                let [nx, ny] = grid(level);
                (0..nx * ny).map(|_| OnceLock::new()).collect()
            })
            .collect();
        Self { lattice, has_holes, pages, columns }
    }

    /// The page that a midpoint belongs to.
    #[inline]
    pub fn page_of(&self, node: LatticeNode) -> PageId {
        let [nx, ny] = self.lattice.squares(node.level);
        let tile = |k: u32, squares: u32| k.min(squares - 1) / PAGE_CELLS;
        PageId { level: node.level, x: tile(node.x, nx), y: tile(node.y, ny) }
    }

    /// The pages that must be in memory before a midpoint can be applied: its own and, on a border in a surface with
    /// holes, those before it.
    pub fn needed_pages(&self, node: LatticeNode) -> impl Iterator<Item = PageId> {
        let own = self.page_of(node);
        let before = |tile: u32, k: u32| {
            if self.has_holes && k.is_multiple_of(PAGE_CELLS) { tile.saturating_sub(1) } else { tile }
        };
        let (x, y) = (before(own.x, node.x), before(own.y, node.y));
        (y..=own.y).flat_map(move |y| (x..=own.x).map(move |x| PageId { x, y, ..own }))
    }

    /// Bytes of the pages in memory.
    pub fn resident_bytes(&self) -> usize {
        self.resident().map(|id| self.page_bytes(id)).sum()
    }

    /// Bytes of a page in memory.
    pub fn page_bytes(&self, id: PageId) -> usize {
        self.page(id).map_or(0, |page| page.heights_m.len() * 4 + page.errors.len() * 2 + page.shown.len())
    }

    /// All pages of a level.
    pub fn pages_of_level(&self, level: u32) -> impl Iterator<Item = PageId> {
        let columns = self.columns[level as usize];
        let rows = self.pages[level as usize].len() as u32 / columns;
        (0..rows).flat_map(move |y| (0..columns).map(move |x| PageId { level, x, y }))
    }

    /// Adds a page; one that is there already stays.
    pub fn insert(&self, page: Arc<TerrainPage>) {
        let slot = self.slot(page.id);
        // a page never changes: the first one is as good
        let _ = slot.set(page);
    }

    /// Drops a page.
    pub fn remove(&mut self, id: PageId) {
        let index = (id.y * self.columns[id.level as usize] + id.x) as usize;
        self.pages[id.level as usize][index].take();
    }

    /// A page, when in memory.
    #[inline]
    pub fn page(&self, id: PageId) -> Option<&Arc<TerrainPage>> {
        self.slot(id).get()
    }

    /// All pages in memory, coarse levels first.
    pub fn resident(&self) -> impl Iterator<Item = PageId> {
        self.pages.iter().rev().flatten().filter_map(|slot| slot.get().map(|page| page.id))
    }

    #[inline]
    fn slot(&self, id: PageId) -> &OnceLock<Arc<TerrainPage>> {
        &self.pages[id.level as usize][(id.y * self.columns[id.level as usize] + id.x) as usize]
    }

    /// A page in memory that holds a point, with the point's place in it.
    #[inline]
    fn holding(&self, node: LatticeNode) -> Option<(&TerrainPage, usize)> {
        let own = self.page_of(node);
        let index = |page: &TerrainPage| {
            ((node.y - page.id.y * PAGE_CELLS) * page.width + node.x - page.id.x * PAGE_CELLS) as usize
        };
        if let Some(page) = self.page(own) {
            return Some((page, index(page)));
        }
        // on a border the page before holds the point too
        let before =
            |tile: u32, k: u32| if k > 0 && k.is_multiple_of(PAGE_CELLS) && tile > 0 { tile - 1 } else { tile };
        let (x, y) = (before(own.x, node.x), before(own.y, node.y));
        [(x, own.y), (own.x, y), (x, y)].into_iter().find_map(|(x, y)| {
            let page = self.page(PageId { x, y, ..own })?;
            Some((&**page, index(page)))
        })
    }
}

impl TerrainData for PagedData {
    #[inline]
    fn height_m(&self, node: LatticeNode) -> f32 {
        // a point past the lattice folds onto its last column or row
        let [nx, ny] = self.lattice.points(node.level);
        let node = LatticeNode { x: node.x.min(nx - 1), y: node.y.min(ny - 1), ..node };
        self.holding(node).map_or(0.0, |(page, i)| page.heights_m[i])
    }

    fn sample_height_m(&self, column: u32, row: u32) -> f32 {
        // a point first appears on the coarsest level that has it; the last column and row are on every level
        let own = |k: u32, size: u32| if k == size - 1 { u32::MAX.trailing_ones() } else { k.trailing_zeros() };
        let level = own(column, self.lattice.width()).min(own(row, self.lattice.height())).min(self.lattice.levels());
        let [nx, ny] = self.lattice.points(level);
        let place = |k: u32, size: u32, points: u32| if k == size - 1 { points - 1 } else { k >> level };
        self.height_m(LatticeNode {
            level,
            x: place(column, self.lattice.width(), nx),
            y: place(row, self.lattice.height(), ny),
        })
    }

    fn gradient(&self, node: LatticeNode) -> [f64; 2] {
        let [nx, ny] = self.lattice.points(node.level);
        let inside = LatticeNode { x: node.x.min(nx - 1), y: node.y.min(ny - 1), ..node };
        let Some((page, _)) = self.holding(inside) else { return [0.0; 2] };
        let first = [page.id.x * PAGE_CELLS, page.id.y * PAGE_CELLS];
        let z = |x: u32, y: u32| f64::from(page.heights_m[((y - first[1]) * page.width + x - first[0]) as usize]);
        gradient(inside, first, [first[0] + page.width, first[1] + page.height], z)
    }

    #[inline]
    fn error(&self, node: LatticeNode) -> ErrorCode {
        self.holding(node).map_or(ErrorCode(u16::MAX), |(page, i)| page.errors[i])
    }

    #[inline]
    fn shown(&self, level: u32, x: u32, y: u32, half: u32) -> bool {
        if !self.has_holes {
            return true;
        }
        let id = PageId { level, x: x / PAGE_CELLS, y: y / PAGE_CELLS };
        let Some(page) = self.page(id) else { return true };
        let (x, y) = (x - id.x * PAGE_CELLS, y - id.y * PAGE_CELLS);
        page.shown.get((y * (page.width - 1) + x) as usize).is_none_or(|bits| bits >> half & 1 == 1)
    }

    fn has_holes(&self) -> bool {
        self.has_holes
    }

    #[inline]
    fn is_resident(&self, node: LatticeNode) -> bool {
        // with holes, applying a midpoint asks about both triangles at its edge and their children's squares
        self.needed_pages(node).all(|id| self.page(id).is_some())
    }
}
