//! The files around the tiles of an implicit tileset: subtrees and `tileset.json`.

use super::ZoomReport;
use crate::Error;
use glam::DVec3;
use std::collections::BTreeMap;
use yamanami_core::Aabb;
use yamanami_io::tiles::glb::GlbFacts;
use yamanami_io::tiles::subtree::{Subtree, TileBounds, TileFacts, facts_schema, morton, tile_number};
use yamanami_io::tiles::tileset::{
    Asset, BoundingVolume, Content, ImplicitTiling, Subdivision, SubtreeFiles, Tile, Tileset,
};
use yamanami_io::tiles::{TileFolder, TileOutput};

/// A tile's level and place.
pub(super) type TilePlace = (u32, [u32; 3]);

/// What is known of a tile that is there.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileRecord {
    /// Its bounds and error; they hold what is below it.
    pub facts: TileFacts,
    /// Whether it has a file.
    pub has_content: bool,
    pub triangles: u64,
    pub bytes: u64,
}

/// All tiles of a tileset.
pub(super) struct TileTree {
    pub subdivision: Subdivision,
    pub tiles: BTreeMap<TilePlace, TileRecord>,
    /// The whole that is divided.
    pub root_volume: BoundingVolume,
    /// To Earth-centred coordinates.
    pub transform: Option<[f64; 16]>,
    /// Error of showing nothing, metres.
    pub size_m: f64,
}

/// Path of a tile's file.
pub(super) fn content_path(subdivision: Subdivision, (level, place): TilePlace) -> String {
    format!("content/{}.glb", subdivision.path(level, place))
}

/// What an earlier run wrote as a tile's file, and its bytes.
pub(super) fn kept_content(
    folder: &TileFolder,
    subdivision: Subdivision,
    tile: TilePlace,
) -> Option<(GlbFacts, usize)> {
    if !folder.is_resumed() {
        return None;
    }
    let file = std::fs::read(folder.part().join(content_path(subdivision, tile))).ok()?;
    Some((GlbFacts::of(&file)?, file.len()))
}

/// The box of an axis-aligned box; no half axis is nothing.
pub(super) fn box_of(bounds: &Aabb, least_m: f64) -> [f64; 12] {
    let (c, h) = (bounds.centre(), (0.5 * (bounds.max - bounds.min)).max(DVec3::splat(least_m)));
    [c.x, c.y, c.z, h.x, 0.0, 0.0, 0.0, h.y, 0.0, 0.0, 0.0, h.z]
}

impl TileTree {
    /// Levels of a subtree: some thousand tiles.
    fn subtree_levels(&self) -> u32 {
        match self.subdivision {
            Subdivision::Quadtree => 6,
            Subdivision::Octree => 4,
        }
    }

    /// Makes errors and bounds nest: a tile's are not below its children's. Adds tiles without files above those with.
    pub(super) fn nest(&mut self) {
        let deepest = self.tiles.keys().map(|&(level, _)| level).max().unwrap_or(0);
        for level in (1..=deepest).rev() {
            let of_level: Vec<([u32; 3], TileFacts)> =
                self.tiles.range((level, [0; 3])..(level + 1, [0; 3])).map(|(&(_, p), r)| (p, r.facts)).collect();
            for (place, facts) in of_level {
                let above = (level - 1, place.map(|c| c >> 1));
                let empty = TileRecord { facts, has_content: false, triangles: 0, bytes: 0 };
                self.tiles
                    .entry(above)
                    .and_modify(|parent| parent.facts = around(parent.facts, facts))
                    .or_insert(empty);
            }
        }
    }

    /// Writes subtrees and `tileset.json`, the latter last.
    pub(super) fn write(&self, output: &dyn TileOutput, title: &str) -> Result<(), Error> {
        let levels = self.subtree_levels();
        let mut subtrees: BTreeMap<TilePlace, Subtree> = BTreeMap::new();
        for (&(level, place), record) in &self.tiles {
            let depth = level % levels;
            let root = (level - depth, place.map(|c| c >> depth));
            let below = place.map(|c| c & ((1 << depth) - 1));
            let number = tile_number(self.subdivision, depth, below);
            let subtree = subtrees.entry(root).or_insert_with(|| Subtree::new(self.subdivision, levels));
            subtree.tiles[number] = true;
            subtree.contents[number] = record.has_content;
            if depth == 0 && level > 0 {
                let above = (level - levels, place.map(|c| c >> levels));
                let below = place.map(|c| c & ((1 << levels) - 1));
                let parent = subtrees.entry(above).or_insert_with(|| Subtree::new(self.subdivision, levels));
                parent.children[morton(self.subdivision, below) as usize] = true;
            }
        }
        for (&(level, place), subtree) in &mut subtrees {
            let mut facts = Vec::new();
            for depth in 0..levels {
                let mut of_level: Vec<(usize, TileFacts)> = self
                    .tiles
                    .range((level + depth, [0; 3])..(level + depth + 1, [0; 3]))
                    .filter(|((_, p), _)| p.map(|c| c >> depth) == place)
                    .map(|((_, p), record)| {
                        (tile_number(self.subdivision, depth, p.map(|c| c & ((1 << depth) - 1))), record.facts)
                    })
                    .collect();
                of_level.sort_by_key(|&(number, _)| number);
                facts.extend(of_level.into_iter().map(|(_, facts)| facts));
            }
            subtree.facts = facts;
            output.put(&format!("subtrees/{}.subtree", self.subdivision.path(level, place)), &subtree.encode())?;
        }
        output.put("tileset.json", &self.tileset(title).to_json())?;
        Ok(())
    }

    fn tileset(&self, title: &str) -> Tileset {
        let deepest = self.tiles.keys().map(|&(level, _)| level).max().unwrap_or(0);
        // what a reader has that halves the error from level to level and does not know each tile's own
        let halved = |(&(level, _), record): (&TilePlace, &TileRecord)| record.facts.error_m * f64::from(1u32 << level);
        let root_error_m = self.tiles.iter().map(halved).fold(0.0, f64::max);
        let pattern = self.subdivision.pattern();
        let bounds = self.tiles.values().next().map(|record| record.facts.bounds);
        Tileset {
            asset: Asset { version: "1.1".to_owned(), generator: Some("yamanami".to_owned()), copyright: None },
            schema: bounds.map(|bounds| facts_schema(&bounds)),
            geometric_error: root_error_m.max(self.size_m),
            root: Tile {
                bounding_volume: self.root_volume.clone(),
                geometric_error: root_error_m,
                refine: Some("REPLACE".to_owned()),
                transform: self.transform,
                content: Some(Content { uri: format!("content/{pattern}.glb"), bounding_volume: None }),
                implicit_tiling: Some(ImplicitTiling {
                    subdivision_scheme: self.subdivision,
                    subtree_levels: self.subtree_levels(),
                    available_levels: deepest + 1,
                    subtrees: SubtreeFiles { uri: format!("subtrees/{pattern}.subtree") },
                }),
                children: Vec::new(),
            },
            extensions_used: Vec::new(),
            extras: Some(serde_json::json!({"title": title})),
        }
    }

    /// Tiles by level.
    pub(super) fn zooms(&self) -> Vec<ZoomReport> {
        let mut zooms: Vec<ZoomReport> = Vec::new();
        for (&(level, _), record) in self.tiles.iter().filter(|(_, record)| record.has_content) {
            if zooms.last().is_none_or(|z| z.zoom != level) {
                zooms.push(ZoomReport { zoom: level, ..ZoomReport::default() });
            }
            if let Some(zoom) = zooms.last_mut() {
                zoom.tiles += 1;
                zoom.triangles += record.triangles;
                zoom.bytes += record.bytes;
                zoom.error_m = zoom.error_m.max(record.facts.error_m);
            }
        }
        zooms
    }
}

/// A parent that holds its child.
fn around(parent: TileFacts, child: TileFacts) -> TileFacts {
    let bounds = match (parent.bounds, child.bounds) {
        (TileBounds::Box(a), TileBounds::Box(b)) => {
            let corners =
                |v: [f64; 12], sign: f64| DVec3::new(v[0] + sign * v[3], v[1] + sign * v[7], v[2] + sign * v[11]);
            let min = corners(a, -1.0).min(corners(b, -1.0));
            TileBounds::Box(box_of(&Aabb { min, max: corners(a, 1.0).max(corners(b, 1.0)) }, 0.0))
        }
        (TileBounds::Region(a), TileBounds::Region(b)) => TileBounds::Region(std::array::from_fn(|k| match k {
            0 | 1 | 4 => a[k].min(b[k]),
            _ => a[k].max(b[k]),
        })),
        (other, _) => other,
    };
    TileFacts { bounds, error_m: parent.error_m.max(child.error_m) }
}
