//! Implicit tiling: the tiles that subtrees say are there.
//!
//! Based on: Open Geospatial Consortium, "3D Tiles Specification 1.1", 2023, part "Implicit tiling".

use super::tree::{Document, MOST_TILES, Tile, Tree, beside, contents};
use super::volume::Volume;
use crate::validate::report::ValidateReport;
use serde_json::Value;
use std::collections::HashMap;
use yamanami_io::inspect::{Faults, Subtree, morton, subtree};

/// Levels of one subtree that are looked into: its leaves are then some millions.
const MOST_LEVELS: u64 = 11;

/// The pattern that a tile stands for.
struct Pattern<'p> {
    document: &'p Document<'p>,
    ways: usize,
    subtree_levels: u32,
    available_levels: u32,
    subtrees: &'p str,
    contents: Vec<&'p str>,
    /// The tile that stands for all.
    head: Tile,
}

/// Level and place of a tile.
type Place = (u32, Vec<u32>);

fn filled(template: &str, (level, place): &Place) -> String {
    let mut text = template.replace("{level}", &level.to_string());
    for (name, value) in ["{x}", "{y}", "{z}"].iter().zip(place) {
        text = text.replace(name, &value.to_string());
    }
    text
}

/// Puts the tiles that tile `number` stands for below it; it is itself the root of them.
pub(super) fn expand(
    tree: &mut Tree<'_>,
    document: &Document<'_>,
    value: &Value,
    number: usize,
    report: &mut ValidateReport,
) {
    let head = tree.tiles[number].clone();
    let extension = &value["extensions"]["3DTILES_implicit_tiling"];
    let tiling = if extension.is_object() { extension } else { &value["implicitTiling"] };
    let ways = match tiling["subdivisionScheme"].as_str() {
        Some("QUADTREE") => 2,
        Some("OCTREE") => 3,
        _ => 0,
    };
    let levels = tiling["availableLevels"].as_u64().or_else(|| tiling["maximumLevel"].as_u64().map(|m| m + 1));
    let subtree_levels = tiling["subtreeLevels"].as_u64();
    let uri = tiling["subtrees"]["uri"].as_str();
    let sound = |n: Option<u64>, most: u64| n.filter(|n| (1..=most).contains(n));
    let most = if ways == 3 { MOST_LEVELS * 2 / 3 } else { MOST_LEVELS };
    let (Some(levels), Some(subtree_levels), Some(subtrees)) = (sound(levels, 31), sound(subtree_levels, most), uri)
    else {
        let expected = format!("a scheme, availableLevels up to 31, subtreeLevels up to {most} and subtrees.uri");
        report.add("IM01", &head.name, "implicitTiling", expected, tiling.to_string());
        return;
    };
    if ways == 0 || matches!(head.volume, Some(Volume::Sphere { .. })) {
        let expected = "QUADTREE or OCTREE within a region or a box";
        report.add("IM01", &head.name, "implicitTiling", expected, tiling["subdivisionScheme"].to_string());
        return;
    }
    let contents = contents(value).into_iter().filter_map(|c| c["uri"].as_str()).collect();
    let (subtree_levels, available_levels) = (subtree_levels as u32, levels as u32);
    let pattern = Pattern { document, ways, subtree_levels, available_levels, subtrees, contents, head };
    pattern.expand(tree, number, report);
}

impl Pattern<'_> {
    fn expand(&self, tree: &mut Tree<'_>, number: usize, report: &mut ValidateReport) {
        let origin: Place = (0, vec![0; self.ways]);
        let mut numbers: HashMap<Place, usize> = HashMap::from([(origin.clone(), number)]);
        let mut stack = vec![origin];
        while let Some(root) = stack.pop() {
            let Some((label, found)) = self.read(tree, &root, report) else { continue };
            let mut faults = Faults::default();
            let mut taken = 0;
            let mut level_places = vec![(root.clone(), 0u64)];
            let mut row = 0;
            let mut rows = HashMap::new();
            for depth in 0..self.subtree_levels {
                let before = self.before(depth);
                // metadata count the tiles that are there, in order
                if !found.facts.is_empty() {
                    for item in before..before + (1u64 << (self.ways as u32 * depth)) {
                        if found.tiles.has(item) {
                            rows.insert(item, row);
                            row += 1;
                        }
                    }
                }
                let mut next = Vec::new();
                for (place, curve) in level_places {
                    let item = before + curve;
                    if !found.tiles.has(item) {
                        continue;
                    }
                    taken += 1;
                    let files: Vec<bool> = found.contents.iter().map(|c| c.has(item)).collect();
                    self.take(tree, &mut numbers, &place, &files, &found, rows.get(&item).copied(), report);
                    if tree.tiles.len() >= MOST_TILES {
                        report.add("TS16", &label, "", format!("at most {MOST_TILES} tiles"), "more");
                        return;
                    }
                    for child in 0..1u64 << self.ways {
                        next.push((self.child(&place, child), curve << self.ways | child));
                    }
                }
                level_places = next;
            }
            self.check_rest(&found, taken, &mut faults);
            for (place, curve) in level_places {
                if found.children.has(curve) {
                    stack.push(place);
                }
            }
            report.add_all(&label, faults.into_vec());
        }
    }

    /// Items of the levels above one.
    fn before(&self, depth: u32) -> u64 {
        let fan = 1u64 << self.ways;
        (fan.pow(depth) - 1) / (fan - 1)
    }

    fn child(&self, (level, place): &Place, child: u64) -> Place {
        let halves = place.iter().enumerate().map(|(axis, &c)| 2 * c + (child >> axis & 1) as u32).collect();
        (level + 1, halves)
    }

    fn read(&self, tree: &mut Tree<'_>, root: &Place, report: &mut ValidateReport) -> Option<(String, Subtree)> {
        let uri = filled(self.subtrees, root);
        let name = beside(self.document.name, &uri)?;
        tree.named.insert(name.clone());
        let Some(bytes) = tree.container.read(&name).ok().flatten() else {
            report.add("IM02", &self.head.name, "subtrees", format!("{name} to be there"), "no such file");
            return None;
        };
        let container = tree.container;
        let mut named = Vec::new();
        let external = |uri: &str| beside(&name, uri).and_then(|n| container.read(&n).ok().flatten());
        if let Ok(document) = serde_json::from_slice::<Value>(&bytes) {
            let uris = document["buffers"].as_array().into_iter().flatten().filter_map(|b| b["uri"].as_str());
            named.extend(uris.filter_map(|uri| beside(&name, uri)));
        }
        let mut faults = Faults::default();
        let found = subtree(&bytes, self.subtree_levels, 1 << self.ways, self.document.schema, &external, &mut faults);
        tree.named.extend(named);
        report.add_all(&name, faults.into_vec());
        found.map(|found| (name, found))
    }

    /// What is available without being reached.
    fn check_rest(&self, found: &Subtree, taken: u64, faults: &mut Faults) {
        let items = self.before(self.subtree_levels);
        let there = (0..items).filter(|&item| found.tiles.has(item)).count() as u64;
        if there > taken {
            faults.add("IM07", "tileAvailability", "tiles below tiles", format!("{} without a parent", there - taken));
        }
        for contents in &found.contents {
            let alone = (0..items).filter(|&item| contents.has(item) && !found.tiles.has(item)).count();
            if alone > 0 {
                faults.add("IM08", "contentAvailability", "contents of tiles", format!("{alone} without a tile"));
            }
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn take(
        &self,
        tree: &mut Tree<'_>,
        numbers: &mut HashMap<Place, usize>,
        place: &Place,
        files: &[bool],
        found: &Subtree,
        row: Option<usize>,
        report: &mut ValidateReport,
    ) {
        let name = format!(
            "{} tile {}",
            self.document.name,
            filled(["{level}/{x}/{y}", "{level}/{x}/{y}/{z}"][self.ways - 2], place)
        );
        if place.0 >= self.available_levels {
            report.add("IM09", &name, "", format!("levels below {}", self.available_levels), place.0.to_string());
        }
        let number = if place.0 == 0 { numbers[place] } else { self.push(tree, numbers, place, name.clone()) };
        self.facts(tree, number, found, row, report);
        for (template, _) in self.contents.iter().zip(files).filter(|(_, there)| **there) {
            let Some(content) = beside(self.document.name, &filled(template, place)) else { continue };
            tree.named.insert(content.clone());
            if tree.container.has(&content) {
                tree.tiles[number].contents.push(content);
            } else {
                report.add("TS09", &name, "content", format!("{content} to be there"), "no such file");
            }
        }
    }

    fn push(&self, tree: &mut Tree<'_>, numbers: &mut HashMap<Place, usize>, place: &Place, name: String) -> usize {
        let above: Place = (place.0 - 1, place.1.iter().map(|c| c >> 1).collect());
        let parent = numbers[&above];
        let bits: Vec<u32> = place.1.iter().map(|c| c & 1).collect();
        // without metadata, a child has a part of its parent's volume and half of its error
        let mut volume = self.head.volume;
        for level in (0..place.0).rev() {
            let bits: Vec<u32> = place.1.iter().map(|c| c >> level & 1).collect();
            volume = volume.and_then(|v| v.part(&bits));
        }
        debug_assert_eq!(morton(&bits) >> self.ways, 0);
        let number = tree.push(Tile {
            parent: Some(parent),
            depth: self.head.depth + place.0,
            name,
            world_from_tile: self.head.world_from_tile,
            volume,
            error_m: self.head.error_m / f64::from(1u32 << place.0),
            is_added: self.head.is_added,
            contents: Vec::new(),
            has_children: false,
        });
        numbers.insert(place.clone(), number);
        number
    }

    /// What metadata say of a tile stands above what follows from its place.
    fn facts(
        &self,
        tree: &mut Tree<'_>,
        number: usize,
        found: &Subtree,
        row: Option<usize>,
        report: &mut ValidateReport,
    ) {
        let Some(row) = row else { return };
        let parent_m = tree.tiles[number].parent.map_or(f64::INFINITY, |p| tree.tiles[p].error_m);
        let tile = &mut tree.tiles[number];
        for (semantic, width, values) in &found.facts {
            let Some(own) = values.get(row * width..(row + 1) * width) else { continue };
            match semantic.as_str() {
                "TILE_GEOMETRIC_ERROR" => {
                    tile.error_m = own[0];
                    if own[0].is_nan() || own[0] < 0.0 {
                        report.add(
                            "TS04",
                            &tile.name,
                            "metadata",
                            "a geometricError, not negative",
                            own[0].to_string(),
                        );
                    }
                    if own[0] > parent_m {
                        let expected = format!("a geometricError of at most its parent's {parent_m}");
                        report.add("TS05", &tile.name, "metadata", expected, own[0].to_string());
                    }
                }
                "TILE_BOUNDING_BOX" | "TILE_BOUNDING_REGION" | "TILE_BOUNDING_SPHERE" => {
                    let key = semantic["TILE_BOUNDING_".len()..].to_lowercase();
                    match Volume::of_numbers(&key, own) {
                        Ok(volume) => tile.volume = Some(volume.moved(&tile.world_from_tile)),
                        Err(why) => report.add("TS14", &tile.name, "metadata", "a region, box or sphere", why),
                    }
                }
                _ => {}
            }
        }
    }
}
