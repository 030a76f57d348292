//! What a terrain and a model want of a packed surface, and how the bytes that come become pages of theirs.

use crate::stream::{Arrived, Item};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;
use yamanami::core::{BASE_CLUSTERS, GroupId, NodeId, PageId, TerrainPage};
use yamanami::io::pack::layout::{PackHead, PackKind};
use yamanami::io::store::{ClusterCodec, ClusterMeta, ClusterTable, PageCodec, TerrainMeta, group_row, row_id};
use yamanami::multires::wavelet::PagedData;
use yamanami::{Data, Model, Subject, Terrain};

/// Rows wanted at once.
pub(crate) const ROWS_AT_ONCE: usize = 96;

/// The bridge between rows of a packed surface and a subject.
pub(crate) trait Feed {
    /// What is fed.
    type Subject: Subject;

    /// The rows that these nodes need, what they are told as differences from first.
    fn rows(&self, subject: &Self::Subject, wanted: &[NodeId]) -> Vec<Item>;

    /// Takes rows that came; those that are damaged are left out for good, and counted.
    fn take(&mut self, subject: &mut Self::Subject, arrived: Vec<Arrived>) -> Taken;
}

/// What came of some rows.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Taken {
    /// Pages that are in memory now.
    pub(crate) pages: usize,
    /// What was wrong with the first damaged one.
    pub(crate) damage: Option<String>,
}

/// Feeds a terrain.
#[derive(Debug)]
pub(crate) struct TerrainFeed {
    pub(crate) meta: TerrainMeta,
    codec: PageCodec,
    /// Rows that came before what they are told from.
    early: HashMap<PageId, Vec<u8>>,
    damaged: HashSet<PageId>,
    /// Pages that stay in memory whatever is shown: of profiles and maps.
    pinned: HashMap<PageId, Option<Arc<TerrainPage>>>,
}

impl TerrainFeed {
    /// A terrain without any page, and its feed.
    pub(crate) fn open(head: &PackHead) -> Result<(Self, Terrain), String> {
        let meta = head.terrain()?;
        let codec =
            PageCodec::new(meta.size, meta.quantum, meta.has_holes, meta.error_steps_per_octave, meta.level0_slack_m)
                .map_err(|e| e.to_string())?;
        let terrain = Terrain::from_pages(&meta).map_err(|e| e.to_string())?;
        let (early, damaged, pinned) = Default::default();
        Ok((Self { meta, codec, early, damaged, pinned }, terrain))
    }

    /// The rows that must have come before anything is shown: the two coarsest levels. Empty once they have.
    pub(crate) fn first_rows(&self, terrain: &Terrain) -> Vec<Item> {
        let levels = self.codec.lattice().levels();
        let first = (levels.saturating_sub(1)..=levels).rev().flat_map(|level| pages_of_level(&self.codec, level));
        first
            .filter(|&id| resident(terrain, id).is_none() && !self.damaged.contains(&id))
            .map(|id| self.item(id))
            .collect()
    }

    /// Whether a page that everything needs is damaged.
    pub(crate) fn is_lost(&self) -> bool {
        let levels = self.codec.lattice().levels();
        self.damaged.iter().any(|id| id.level + 1 >= levels)
    }

    /// Keeps pages in memory from now on; others are let go.
    pub(crate) fn pin(&mut self, ids: impl IntoIterator<Item = PageId>) {
        let mut before = std::mem::take(&mut self.pinned);
        self.pinned = ids.into_iter().map(|id| (id, before.remove(&id).flatten())).collect();
    }

    /// The rows of pinned pages that are not in memory. Those that were dropped are put back.
    pub(crate) fn pinned_rows(&mut self, terrain: &Terrain) -> Vec<Item> {
        let mut missing = Vec::new();
        for (&id, kept) in &mut self.pinned {
            match (resident(terrain, id), &kept) {
                (Some(page), _) => *kept = Some(page),
                (None, Some(page)) => terrain.insert(Arc::clone(page)),
                (None, None) => missing.push(id),
            }
        }
        missing.sort_unstable_by_key(|id| (std::cmp::Reverse(id.level), id.y, id.x));
        self.with_coarser(terrain, &missing)
    }

    /// The pages that are kept.
    pub(crate) fn pinned_ids(&self) -> Vec<PageId> {
        self.pinned.keys().copied().collect()
    }

    /// A pinned page, when it has come.
    pub(crate) fn pinned_page(&self, id: PageId, terrain: &Terrain) -> Option<Arc<TerrainPage>> {
        self.pinned.get(&id).cloned().flatten().or_else(|| resident(terrain, id))
    }

    /// Whether all pinned pages have come, but for damaged ones.
    pub(crate) fn has_pinned(&self, terrain: &Terrain) -> bool {
        self.pinned.iter().all(|(&id, kept)| kept.is_some() || resident(terrain, id).is_some() || self.is_damaged(id))
    }

    /// Whether a page, or one that it is told from, is damaged.
    pub(crate) fn is_damaged(&self, id: PageId) -> bool {
        let mut next = Some(id);
        while let Some(id) = next {
            if self.damaged.contains(&id) {
                return true;
            }
            next = self.codec.parent(id);
        }
        false
    }

    /// Rows of absent pages, each after those of the absent coarser pages that it is told from.
    fn with_coarser(&self, terrain: &Terrain, pages: &[PageId]) -> Vec<Item> {
        let mut items = Vec::new();
        for &page in pages {
            let mut way = Vec::new();
            let mut next = Some(page);
            while let Some(id) = next.filter(|&id| resident(terrain, id).is_none()) {
                way.push(id);
                next = self.codec.parent(id);
            }
            if way.iter().any(|id| self.damaged.contains(id)) {
                continue;
            }
            let rows = way.into_iter().rev().filter(|id| !self.early.contains_key(id)).map(|id| self.item(id));
            items.extend(rows.filter(|item| !items.contains(item)).collect::<Vec<_>>());
        }
        items
    }

    fn item(&self, id: PageId) -> Item {
        let columns = self.codec.pages(id.level)[0];
        Item {
            section: (self.codec.lattice().levels() - id.level) as usize,
            entry: u64::from(id.y) * u64::from(columns) + u64::from(id.x),
        }
    }

    fn id(&self, item: Item) -> Option<PageId> {
        let level = self.codec.lattice().levels().checked_sub(item.section as u32)?;
        let columns = u64::from(self.codec.pages(level)[0]);
        Some(PageId { level, x: (item.entry % columns) as u32, y: (item.entry / columns) as u32 })
    }

    /// Decodes early rows whose coarser page is there now.
    fn decode(&mut self, terrain: &Terrain, taken: &mut Taken) {
        loop {
            let parent_of = |id: PageId| self.codec.parent(id);
            let ready =
                self.early.keys().copied().find(|&id| parent_of(id).is_none_or(|p| resident(terrain, p).is_some()));
            let Some(id) = ready else { return };
            let bytes = self.early.remove(&id).unwrap_or_default();
            let parent = self.codec.parent(id).and_then(|parent| resident(terrain, parent));
            match self.codec.decode_page(id, &bytes, parent.as_deref()) {
                Ok(page) => {
                    terrain.insert(Arc::new(page));
                    taken.pages += 1;
                }
                Err(found) => self.damage(id, found, taken),
            }
        }
    }

    fn damage(&mut self, id: PageId, found: &str, taken: &mut Taken) {
        self.damaged.insert(id);
        let place = format!("page {}, {} of level {}: {found}", id.x, id.y, id.level);
        taken.damage.get_or_insert(place);
    }
}

impl Feed for TerrainFeed {
    type Subject = Terrain;

    fn rows(&self, terrain: &Terrain, wanted: &[NodeId]) -> Vec<Item> {
        self.with_coarser(terrain, &terrain.absent(wanted, ROWS_AT_ONCE))
    }

    fn take(&mut self, terrain: &mut Terrain, arrived: Vec<Arrived>) -> Taken {
        let mut taken = Taken::default();
        for Arrived { item, place, bytes } in arrived {
            let Some(id) = self.id(item) else { continue };
            if place.is_whole(row_id(id), &bytes) {
                self.early.insert(id, bytes);
            } else {
                self.damage(id, "its checksum does not match", &mut taken);
            }
        }
        self.decode(terrain, &mut taken);
        taken
    }
}

fn pages_of_level(codec: &PageCodec, level: u32) -> impl Iterator<Item = PageId> {
    let [columns, rows] = codec.pages(level);
    (0..rows).flat_map(move |y| (0..columns).map(move |x| PageId { level, x, y }))
}

/// A page of a terrain, when it is in memory.
pub(crate) fn resident(terrain: &Terrain, id: PageId) -> Option<Arc<TerrainPage>> {
    let data: &Data = terrain.surface().data();
    let Data::Paged(data) = data else { return None };
    PagedData::page(data, id).cloned()
}

/// Feeds a model.
#[derive(Debug)]
pub(crate) struct ModelFeed {
    codec: ClusterCodec,
    table: ClusterTable,
    damaged: HashSet<GroupId>,
}

/// A model of which the nodes have not all come.
#[derive(Debug)]
pub(crate) struct ModelOpening {
    meta: ClusterMeta,
    /// Blocks of nodes by row.
    blocks: BTreeMap<i64, Vec<u8>>,
    base: Option<Vec<u8>>,
}

/// Sections of a model.
const NODES: usize = 0;
const PAGES: usize = 1;

impl ModelOpening {
    /// Begins with the head.
    pub(crate) fn new(head: &PackHead) -> Result<Self, String> {
        debug_assert!(head.kind != PackKind::Terrain);
        Ok(Self { meta: head.clusters()?, blocks: BTreeMap::new(), base: None })
    }

    /// Rows that have not come.
    pub(crate) fn rows(&self) -> Vec<Item> {
        let blocks = (0..).zip(ClusterTable::rows(self.meta.nodes)).filter(|(_, row)| !self.blocks.contains_key(row));
        let blocks = blocks.map(|(entry, _)| Item { section: NODES, entry });
        blocks.chain(self.base.is_none().then_some(Item { section: PAGES, entry: 0 })).collect()
    }

    /// Takes rows; the model once all have come.
    pub(crate) fn take(&mut self, arrived: Vec<Arrived>) -> Result<Option<(ModelFeed, Model)>, String> {
        for Arrived { item, place, bytes } in arrived {
            let row = match item.section {
                NODES => ClusterTable::rows(self.meta.nodes).nth(item.entry as usize),
                _ => Some(group_row(BASE_CLUSTERS)),
            };
            let row = row.filter(|&row| place.is_whole(row, &bytes)).ok_or("nodes: their checksum does not match")?;
            if item.section == NODES {
                self.blocks.insert(row, bytes);
            } else {
                self.base = Some(bytes);
            }
        }
        let Some(base) = self.base.as_ref().filter(|_| self.rows().is_empty()) else { return Ok(None) };
        let table = ClusterTable::read(
            &self.meta,
            |row| self.blocks.get(&row).cloned().ok_or_else(|| "nodes are missing".to_owned()),
            |row| format!("nodes from {row} on are damaged"),
        )?;
        let codec = ClusterCodec::new(&self.meta);
        let shape = table.shape(BASE_CLUSTERS).ok_or("the base mesh is missing")?;
        let base = codec.decode(shape, base).map_err(|found| format!("base mesh: {found}"))?;
        let model = Model::from_pages(&self.meta, &table, base).map_err(|e| e.to_string())?;
        Ok(Some((ModelFeed { codec, table, damaged: HashSet::new() }, model)))
    }
}

impl Feed for ModelFeed {
    type Subject = Model;

    fn rows(&self, model: &Model, wanted: &[NodeId]) -> Vec<Item> {
        let sound: Vec<NodeId> = wanted.iter().copied().filter(|node| !self.damaged.contains(node)).collect();
        let absent = model.absent(&sound, ROWS_AT_ONCE);
        absent.into_iter().map(|node| Item { section: PAGES, entry: 1 + u64::from(node) }).collect()
    }

    fn take(&mut self, model: &mut Model, arrived: Vec<Arrived>) -> Taken {
        let mut taken = Taken::default();
        for Arrived { item, place, bytes } in arrived {
            let node = match u32::try_from(item.entry) {
                Ok(entry @ 1..) if item.section == PAGES => entry - 1,
                _ => continue,
            };
            let page = match self.table.shape(node) {
                Some(_) if !place.is_whole(group_row(node), &bytes) => Err("its checksum does not match".to_owned()),
                Some(shape) => self.codec.decode(shape, &bytes).map_err(str::to_owned),
                None => Err("there is no such node".to_owned()),
            };
            match page.and_then(|page| model.insert(page).map_err(|e| e.to_string())) {
                Ok(()) => taken.pages += 1,
                Err(found) => {
                    self.damaged.insert(node);
                    taken.damage.get_or_insert(format!("page of node {node}: {found}"));
                }
            }
        }
        taken
    }
}
