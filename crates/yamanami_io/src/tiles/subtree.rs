//! `.subtree` files of 3D Tiles 1.1: which tiles of a few levels there are, and what is known of each.
//!
//! Based on: "3D Tiles Specification 1.1", Open Geospatial Consortium 22-025r4, 2023, implicit tiling and metadata: bits by
//! level and, within a level, by Morton order; properties of the tiles that are there, in the same order.

use super::tileset::Subdivision;
use crate::IoError;
use serde_json::{Value, json};
use std::path::Path;

const MAGIC: &[u8; 4] = b"subt";
const HEADER: usize = 24;
/// Most bits of one stream.
const MOST_TILES: u64 = 1 << 25;

/// A subtree.
#[derive(Debug, Clone, PartialEq)]
pub struct Subtree {
    /// In four or in eight.
    pub subdivision: Subdivision,
    /// Its levels.
    pub levels: u32,
    /// Which tiles there are, by [`tile_number`].
    pub tiles: Vec<bool>,
    /// Which tiles have a file.
    pub contents: Vec<bool>,
    /// Which subtrees hang below, by Morton number one level below the finest.
    pub children: Vec<bool>,
    /// What is known of each tile that is there, in order; or empty.
    pub facts: Vec<TileFacts>,
}

/// What is known of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileFacts {
    /// Its bounds.
    pub bounds: TileBounds,
    /// Its geometric error, metres.
    pub error_m: f64,
}

/// Bounds of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TileBounds {
    /// Centre and three half axes, metres.
    Box([f64; 12]),
    /// West, south, east, north (radians), lowest and highest (metres).
    Region([f64; 6]),
}

impl TileBounds {
    fn values(&self) -> &[f64] {
        match self {
            Self::Box(values) => values,
            Self::Region(values) => values,
        }
    }
}

/// A tile's place in Morton order: the lowest bits of x, y and z (where there is one), then the next.
pub fn morton(subdivision: Subdivision, place: [u32; 3]) -> u64 {
    let axes = subdivision.axes();
    (0..64 / axes).fold(0, |number, bit| {
        (0..axes).fold(number, |number, axis| {
            let set = u64::from(place[axis as usize].checked_shr(bit).unwrap_or(0) & 1);
            number | set << (bit * axes + axis)
        })
    })
}

/// Tiles in so many levels.
fn tiles_in(subdivision: Subdivision, levels: u32) -> u64 {
    let axes = subdivision.axes();
    ((1u64 << (axes * levels)) - 1) / ((1 << axes) - 1)
}

/// Number of a tile within its subtree: `level` and `place` count from the subtree's root.
pub fn tile_number(subdivision: Subdivision, level: u32, place: [u32; 3]) -> usize {
    (tiles_in(subdivision, level) + morton(subdivision, place)) as usize
}

/// The `schema` of a tileset whose subtrees have [`TileFacts`] with such bounds.
pub fn facts_schema(bounds: &TileBounds) -> Value {
    let (semantic, count) = match bounds {
        TileBounds::Box(_) => ("TILE_BOUNDING_BOX", 12),
        TileBounds::Region(_) => ("TILE_BOUNDING_REGION", 6),
    };
    let array = json!({"type": "SCALAR", "componentType": "FLOAT64", "array": true, "count": count, "required": true, "semantic": semantic});
    let error =
        json!({"type": "SCALAR", "componentType": "FLOAT64", "required": true, "semantic": "TILE_GEOMETRIC_ERROR"});
    json!({"id": "yamanami", "classes": {"tile": {"properties": {"bounds": array, "error": error}}}})
}

impl Subtree {
    /// A subtree without tiles.
    pub fn new(subdivision: Subdivision, levels: u32) -> Self {
        let tiles = tiles_in(subdivision, levels) as usize;
        let children = 1usize << (subdivision.axes() * levels);
        Self {
            subdivision,
            levels,
            tiles: vec![false; tiles],
            contents: vec![false; tiles],
            children: vec![false; children],
            facts: Vec::new(),
        }
    }

    /// As a file.
    pub fn encode(&self) -> Vec<u8> {
        let mut binary = Binary::default();
        let tiles = binary.availability(&self.tiles);
        let contents = if self.contents == self.tiles { tiles.clone() } else { binary.availability(&self.contents) };
        let children = binary.availability(&self.children);
        let mut document = json!({
            "tileAvailability": tiles,
            "contentAvailability": [contents],
            "childSubtreeAvailability": children,
        });
        if !self.facts.is_empty() {
            let bounds = binary.view(self.facts.iter().flat_map(|f| f.bounds.values()).flat_map(|v| v.to_le_bytes()));
            let errors = binary.view(self.facts.iter().flat_map(|f| f.error_m.to_le_bytes()));
            document["propertyTables"] = json!([{
                "class": "tile",
                "count": self.facts.len(),
                "properties": {"bounds": {"values": bounds}, "error": {"values": errors}},
            }]);
            document["tileMetadata"] = json!(0);
        }
        if !binary.views.is_empty() {
            document["buffers"] = json!([{"byteLength": binary.bytes.len()}]);
            document["bufferViews"] = json!(binary.views);
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(8), b' ');
        let mut file = MAGIC.to_vec();
        file.extend(1u32.to_le_bytes());
        file.extend((text.len() as u64).to_le_bytes());
        file.extend((binary.bytes.len() as u64).to_le_bytes());
        file.extend(text);
        file.extend(binary.bytes);
        file
    }

    /// Reads a file; `name` is for messages. Facts are read where they have the semantics of [`facts_schema`] and its names.
    pub fn decode(name: &Path, bytes: &[u8], subdivision: Subdivision, levels: u32) -> Result<Self, IoError> {
        let bad = |place: &str, expected: &str, found: String| IoError::malformed(name, place, expected, found);
        let most = MOST_TILES.ilog2() / subdivision.axes();
        if levels == 0 || levels > most {
            return Err(bad("levels", &format!("1 to {most}"), levels.to_string()));
        }
        let word = |at: usize| bytes.get(at..at + 8).map(|b| u64::from_le_bytes(b.try_into().unwrap_or_default()));
        if bytes.len() < HEADER || &bytes[..4] != MAGIC || bytes[4..8] != [1, 0, 0, 0] {
            return Err(bad("header", "a subtree of version 1", format!("{} bytes of something else", bytes.len())));
        }
        let (text_length, length) = (word(8).unwrap_or(0), word(16).unwrap_or(0));
        if text_length.saturating_add(length) != (bytes.len() - HEADER) as u64 {
            let expected = format!("{text_length} + {length} bytes after the header");
            return Err(bad("header", &expected, format!("{}", bytes.len() - HEADER)));
        }
        let (text, binary) = bytes[HEADER..].split_at(text_length as usize);
        let document: Value =
            serde_json::from_slice(text).map_err(|e| bad("JSON", "a subtree's description", e.to_string()))?;
        let reader = Reader { name, document: &document, binary };
        let tiles = tiles_in(subdivision, levels) as usize;
        let children = 1usize << (subdivision.axes() * levels);
        let mut subtree = Self {
            subdivision,
            levels,
            tiles: reader.bits("tileAvailability", &document["tileAvailability"], tiles)?,
            contents: match document["contentAvailability"].get(0) {
                Some(first) => reader.bits("contentAvailability", first, tiles)?,
                None => vec![false; tiles],
            },
            children: reader.bits("childSubtreeAvailability", &document["childSubtreeAvailability"], children)?,
            facts: Vec::new(),
        };
        subtree.facts = reader.facts(subtree.tiles.iter().filter(|&&t| t).count())?;
        Ok(subtree)
    }
}

/// The binary part as it grows; every view begins at a multiple of eight.
#[derive(Default)]
struct Binary {
    bytes: Vec<u8>,
    views: Vec<Value>,
}

impl Binary {
    fn view(&mut self, bytes: impl Iterator<Item = u8>) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset}));
        self.bytes.resize(self.bytes.len().next_multiple_of(8), 0);
        self.views.len() - 1
    }

    /// A constant where all are alike, else bits, the lowest of a byte first.
    fn availability(&mut self, available: &[bool]) -> Value {
        let count = available.iter().filter(|&&a| a).count();
        if count == 0 || count == available.len() {
            return json!({"constant": u8::from(count > 0)});
        }
        let byte = |bits: &[bool]| bits.iter().rev().fold(0u8, |byte, &bit| byte << 1 | u8::from(bit));
        let view = self.view(available.chunks(8).map(byte));
        json!({"bitstream": view, "availableCount": count})
    }
}

struct Reader<'a> {
    name: &'a Path,
    document: &'a Value,
    binary: &'a [u8],
}

impl<'a> Reader<'a> {
    fn bad(&self, place: &str, expected: &str, found: &Value) -> IoError {
        IoError::malformed(self.name, place, expected, found.to_string())
    }

    /// Bytes of a view; only the binary part of the file itself is a buffer here.
    fn view(&self, place: &str, number: &Value) -> Result<&'a [u8], IoError> {
        let view = number.as_u64().and_then(|n| self.document["bufferViews"].get(usize::try_from(n).ok()?));
        let view = view.ok_or_else(|| self.bad(place, "the number of a view", number))?;
        let buffer = &self.document["buffers"][view["buffer"].as_u64().unwrap_or(0) as usize];
        if buffer.get("uri").is_some() {
            return Err(IoError::unsupported(self.name, "a subtree with buffers of their own", "put them into it"));
        }
        let number = |key: &str| view[key].as_u64().and_then(|v| usize::try_from(v).ok());
        let range = number("byteOffset").unwrap_or(0)..;
        let bytes = self.binary.get(range).zip(number("byteLength")).and_then(|(b, length)| b.get(..length));
        bytes.ok_or_else(|| self.bad(place, "a view within the file", view))
    }

    fn bits(&self, place: &str, value: &Value, count: usize) -> Result<Vec<bool>, IoError> {
        if let Some(constant) = value["constant"].as_u64().filter(|&c| c < 2) {
            return Ok(vec![constant == 1; count]);
        }
        let stream = value.get("bitstream").ok_or_else(|| self.bad(place, "a constant or bits", value))?;
        let bytes = self.view(place, stream)?;
        if bytes.len() != count.div_ceil(8) {
            let expected = format!("{} bytes of bits", count.div_ceil(8));
            return Err(self.bad(place, &expected, &json!(bytes.len())));
        }
        Ok((0..count).map(|k| bytes[k / 8] >> (k % 8) & 1 == 1).collect())
    }

    fn facts(&self, count: usize) -> Result<Vec<TileFacts>, IoError> {
        let Some(table) = self.document["tileMetadata"].as_u64() else { return Ok(Vec::new()) };
        let table = &self.document["propertyTables"][table as usize];
        let place = "propertyTables";
        let (bounds, errors) = (&table["properties"]["bounds"]["values"], &table["properties"]["error"]["values"]);
        if bounds.is_null() || errors.is_null() {
            return Ok(Vec::new());
        }
        let (bounds, errors) = (self.view(place, bounds)?, self.view(place, errors)?);
        let width = if bounds.len() == count * 96 { 96 } else { 48 };
        if bounds.len() != count * width || errors.len() != count * 8 {
            return Err(self.bad(place, &format!("bounds and errors of {count} tiles"), table));
        }
        let number = |b: &[u8]| f64::from_le_bytes(b.try_into().unwrap_or_default());
        let facts = bounds.chunks_exact(width).zip(errors.chunks_exact(8)).map(|(bounds, error)| {
            let value = |k: usize| number(&bounds[8 * k..8 * k + 8]);
            let bounds = match width {
                96 => TileBounds::Box(std::array::from_fn(value)),
                _ => TileBounds::Region(std::array::from_fn(value)),
            };
            TileFacts { bounds, error_m: number(error) }
        });
        Ok(facts.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(subtree: &Subtree) -> Subtree {
        Subtree::decode(Path::new("s"), &subtree.encode(), subtree.subdivision, subtree.levels).unwrap()
    }

    #[test]
    fn numbers_are_as_in_the_specification() {
        use Subdivision::{Octree, Quadtree};
        assert_eq!(morton(Quadtree, [5, 3, 0]), 0b01_10_11, "x is the lower bit of each pair");
        assert_eq!(morton(Octree, [1, 0, 1]), 0b101);
        assert_eq!(morton(Octree, [2, 1, 3]), 0b101_110);
        assert_eq!(morton(Quadtree, [u32::MAX, 0, 0]), 0x5555_5555_5555_5555);
        assert_eq!((tile_number(Quadtree, 0, [0; 3]), tile_number(Quadtree, 1, [1, 0, 0])), (0, 2));
        assert_eq!((tile_number(Quadtree, 2, [0, 0, 0]), tile_number(Octree, 2, [0, 0, 0])), (5, 9));
    }

    #[test]
    fn bytes_are_as_worked_out_by_hand() {
        // the root and its north-east child, one subtree below the south-east
        let mut subtree = Subtree::new(Subdivision::Quadtree, 2);
        subtree.tiles[0] = true;
        subtree.tiles[tile_number(Subdivision::Quadtree, 1, [1, 1, 0])] = true;
        subtree.contents = subtree.tiles.clone();
        subtree.children[morton(Subdivision::Quadtree, [3, 0, 0]) as usize] = true;
        let file = subtree.encode();
        assert_eq!(&file[..8], b"subt\x01\0\0\0");
        let text_length = u64::from_le_bytes(file[8..16].try_into().unwrap()) as usize;
        assert_eq!((text_length % 8, &file[16..24]), (0, [16, 0, 0, 0, 0, 0, 0, 0].as_slice()));
        assert_eq!(&file[HEADER + text_length..], [0b1_0001, 0, 0, 0, 0, 0, 0, 0, 0b10_0000, 0, 0, 0, 0, 0, 0, 0]);
        let document: Value = serde_json::from_slice(&file[HEADER..HEADER + text_length]).unwrap();
        assert_eq!(document["tileAvailability"], json!({"bitstream": 0, "availableCount": 2}));
        assert_eq!(document["contentAvailability"], json!([{"bitstream": 0, "availableCount": 2}]));
        assert_eq!(document["bufferViews"][1], json!({"buffer": 0, "byteOffset": 8, "byteLength": 2}));
        assert_eq!(read(&subtree), subtree);
    }

    proptest! {
        #[test]
        fn subtrees_come_back(seed in any::<u64>(), levels in 1u32..4, octree in any::<bool>(), boxes in any::<bool>()) {
            let subdivision = if octree { Subdivision::Octree } else { Subdivision::Quadtree };
            let mut subtree = Subtree::new(subdivision, levels);
            let mut noise = seed | 1;
            let mut next = || { noise ^= noise << 13; noise ^= noise >> 7; noise ^= noise << 17; noise };
            subtree.tiles.iter_mut().for_each(|t| *t = next() % 3 > 0);
            subtree.contents = subtree.tiles.iter().map(|&t| t && next() % 4 > 0).collect();
            subtree.children.iter_mut().for_each(|t| *t = next() % 2 > 0);
            for _ in subtree.tiles.iter().filter(|&&t| t) {
                let value = (next() % 1000) as f64;
                let bounds = if boxes { TileBounds::Box([value; 12]) } else { TileBounds::Region([value; 6]) };
                subtree.facts.push(TileFacts { bounds, error_m: value });
            }
            prop_assert_eq!(read(&subtree), subtree);
        }

        #[test]
        fn damage_is_an_error_and_no_panic(at in 0usize..400, value in any::<u8>(), cut in 0usize..400) {
            let mut subtree = Subtree::new(Subdivision::Quadtree, 3);
            subtree.tiles[3] = true;
            subtree.facts.push(TileFacts { bounds: TileBounds::Region([0.5; 6]), error_m: 1.0 });
            let mut file = subtree.encode();
            let at = at % file.len();
            file[at] = value;
            let _ = Subtree::decode(Path::new("s"), &file, Subdivision::Quadtree, 3);
            file.truncate(cut);
            let _ = Subtree::decode(Path::new("s"), &file, Subdivision::Octree, 2);
        }
    }
}
