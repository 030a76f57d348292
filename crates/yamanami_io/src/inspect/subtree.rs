//! A `.subtree` file of implicit tiling: which tiles, contents and further subtrees there are.
//!
//! Based on: Open Geospatial Consortium, "3D Tiles Specification 1.1", 2023, part "Implicit tiling".

use super::{Bytes, Faults};
use serde_json::Value;

/// Which of a subtree's items are there.
#[derive(Debug, Clone)]
pub enum Availability {
    /// All or none.
    Constant(bool),
    /// One bit each, the first in the lowest.
    Bits(Vec<u8>),
}

impl Availability {
    /// Whether an item is there.
    pub fn has(&self, item: u64) -> bool {
        match self {
            Self::Constant(all) => *all,
            Self::Bits(bytes) => {
                let byte = usize::try_from(item / 8).ok().and_then(|at| bytes.get(at));
                byte.is_some_and(|byte| byte >> (item % 8) & 1 == 1)
            }
        }
    }
}

/// Most tiles of a subtree whose metadata are read.
const MOST_FACTS: u64 = 1 << 24;

/// What a subtree file says.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Subtree {
    /// Tiles by level, then in Morton order.
    pub tiles: Availability,
    /// The same for each content of a tile.
    pub contents: Vec<Availability>,
    /// Subtrees below the deepest level.
    pub children: Availability,
    /// What metadata say of the tiles: a semantic like `TILE_GEOMETRIC_ERROR`, numbers a tile, and the numbers of all tiles that
    /// are available, in order.
    pub facts: Vec<(String, usize, Vec<f64>)>,
}

/// Place of a tile in the Morton order of its level; `place` is column, row and, of an octree, layer.
pub fn morton(place: &[u32]) -> u64 {
    let ways = place.len();
    let bits = if ways > 2 { 21 } else { 31 };
    let spread = |(axis, &value): (usize, &u32)| {
        (0..bits).map(|bit| u64::from(value >> bit & 1) << (bit as usize * ways + axis)).sum::<u64>()
    };
    place.iter().enumerate().map(spread).sum()
}

/// Reads a binary or JSON subtree of `levels` levels with `fan` (4 or 8) children a tile. `schema` is the tileset's, `external`
/// gives the bytes of a buffer outside the file.
pub fn subtree(
    bytes: &[u8],
    levels: u32,
    fan: u64,
    schema: &Value,
    external: &dyn Fn(&str) -> Option<Vec<u8>>,
    faults: &mut Faults,
) -> Option<Subtree> {
    let (json, binary) = chunks(bytes, faults)?;
    let document: Value = match serde_json::from_slice(json) {
        Ok(document) => document,
        Err(cause) => {
            faults.add("IM03", "JSON", "a JSON object", cause.to_string());
            return None;
        }
    };
    let mut reader = Reader { document: &document, binary, external, faults };
    let tiles = fan.checked_pow(levels).map_or(u64::MAX, |leaves| (leaves - 1) / (fan - 1));
    let leaves = fan.checked_pow(levels).unwrap_or(u64::MAX);
    let mut found = Subtree {
        tiles: reader.availability("tileAvailability", &document["tileAvailability"], tiles)?,
        children: reader.availability("childSubtreeAvailability", &document["childSubtreeAvailability"], leaves)?,
        contents: match &document["contentAvailability"] {
            Value::Null => Vec::new(),
            Value::Array(list) => {
                list.iter().filter_map(|one| reader.availability("contentAvailability", one, tiles)).collect()
            }
            // as the extension of 3D Tiles 1.0 had it
            one => reader.availability("contentAvailability", one, tiles).into_iter().collect(),
        },
        facts: Vec::new(),
    };
    let there = (0..tiles.min(MOST_FACTS)).filter(|&item| found.tiles.has(item)).count();
    found.facts = reader.facts(schema, there);
    Some(found)
}

/// The JSON and the binary chunk.
fn chunks<'b>(bytes: &'b [u8], faults: &mut Faults) -> Option<(&'b [u8], &'b [u8])> {
    if bytes.trim_ascii_start().starts_with(b"{") {
        return Some((bytes, &[]));
    }
    let mut reader = Bytes::new(bytes);
    if reader.array() != Some(*b"subt") {
        faults.add("IM03", "start", "'subt'", format!("{:?}", &bytes[..bytes.len().min(4)]));
        return None;
    }
    let header = (|| Some((reader.u32()?, reader.u64()?, reader.u64()?)))();
    let Some((version, json, binary)) = header else {
        faults.add("IM03", "header", "24 bytes", format!("{} bytes", bytes.len()));
        return None;
    };
    if version != 1 {
        faults.add("IM03", "header", "version 1", version.to_string());
    }
    for (what, length) in [("JSON", json), ("binary", binary)] {
        if length % 8 != 0 {
            faults.add("IM03", format!("{what} chunk"), "a length that is a multiple of 8", length.to_string());
        }
    }
    let taken = usize::try_from(json).ok().and_then(|n| reader.take(n));
    let parts = taken.and_then(|json| Some((json, reader.take(usize::try_from(binary).ok()?)?)));
    if parts.is_none() || reader.left() > 0 {
        let found = format!("{} bytes", bytes.len());
        faults.add("IM03", "header", format!("24 + {json} + {binary} bytes"), found);
    }
    parts
}

struct Reader<'r> {
    document: &'r Value,
    binary: &'r [u8],
    external: &'r dyn Fn(&str) -> Option<Vec<u8>>,
    faults: &'r mut Faults,
}

impl Reader<'_> {
    fn availability(&mut self, name: &str, value: &Value, items: u64) -> Option<Availability> {
        let stated = value["availableCount"].as_u64();
        if let Some(constant) = value["constant"].as_u64() {
            if constant > 1 {
                self.faults.add("IM03", format!("{name}.constant"), "0 or 1", constant.to_string());
            }
            let there = if constant == 1 { items } else { 0 };
            if let Some(stated) = stated.filter(|&s| s != there) {
                self.faults.add("IM06", name, format!("{there} available"), stated.to_string());
            }
            return Some(Availability::Constant(constant == 1));
        }
        let Some(view) = value["bitstream"].as_u64().or_else(|| value["bufferView"].as_u64()) else {
            self.faults.add("IM03", name, "'constant' or 'bitstream'", value.to_string());
            return None;
        };
        let bytes = self.view(name, view)?;
        let needed = items.div_ceil(8);
        if (bytes.len() as u64) < needed {
            let found = format!("{} bytes", bytes.len());
            self.faults.add("IM05", name, format!("{needed} bytes for {items} items"), found);
            return None;
        }
        let ones = |range: std::ops::Range<u64>, bits: &Availability| range.filter(|&i| bits.has(i)).count() as u64;
        let length = bytes.len() as u64;
        let bits = Availability::Bits(bytes);
        let there = ones(0..items, &bits);
        if let Some(stated) = stated.filter(|&s| s != there) {
            self.faults.add("IM06", name, format!("{there} available, as the bits say"), stated.to_string());
        }
        let beyond = ones(items..(needed * 8).min(length * 8), &bits);
        if beyond > 0 {
            self.faults.add("IM05", name, "no bits beyond the last item", format!("{beyond}"));
        }
        Some(bits)
    }

    /// The metadata of tiles that the specification gives a meaning.
    fn facts(&mut self, schema: &Value, tiles: usize) -> Vec<(String, usize, Vec<f64>)> {
        let mut facts = Vec::new();
        let document = self.document;
        let Some(number) = document["tileMetadata"].as_u64() else { return facts };
        let Some(table) = usize::try_from(number).ok().and_then(|k| document["propertyTables"].get(k)) else {
            self.faults.add("IM10", "tileMetadata", "a property table that is there", number.to_string());
            return facts;
        };
        if table["count"].as_u64() != Some(tiles as u64) {
            let expected = format!("a property table of {tiles} tiles");
            self.faults.add("IM10", "tileMetadata", expected, table["count"].to_string());
        }
        let class = &schema["classes"][table["class"].as_str().unwrap_or_default()]["properties"];
        for (name, property) in class.as_object().into_iter().flatten() {
            let semantic = property["semantic"].as_str().unwrap_or_default();
            let size = match property["componentType"].as_str() {
                Some("FLOAT32") => 4,
                Some("FLOAT64") => 8,
                _ => continue,
            };
            let width = if property["array"] == true { property["count"].as_u64().unwrap_or(0) as usize } else { 1 };
            let view = table["properties"][name]["values"].as_u64();
            let known = semantic.starts_with("TILE_") && property["type"] == "SCALAR" && (1..=64).contains(&width);
            let Some(view) = view.filter(|_| known) else { continue };
            let Some(bytes) = self.view(name, view) else { continue };
            if bytes.len() < tiles * width * size {
                let expected = format!("{} bytes for {tiles} tiles", tiles * width * size);
                self.faults.add("IM10", name.clone(), expected, format!("{} bytes", bytes.len()));
                continue;
            }
            let number = |raw: &[u8]| match *raw {
                [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
                [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
                _ => f64::NAN,
            };
            let values = bytes.chunks_exact(size).take(tiles * width).map(number).collect();
            facts.push((semantic.to_owned(), width, values));
        }
        facts
    }

    fn view(&mut self, name: &str, number: u64) -> Option<Vec<u8>> {
        let item = |list: &str, number: u64| self.document[list].get(usize::try_from(number).ok()?).cloned();
        let Some(view) = item("bufferViews", number) else {
            self.faults.add("IM04", name, "a buffer view that is there", number.to_string());
            return None;
        };
        let field = |value: &Value, key: &str| value[key].as_u64().and_then(|v| usize::try_from(v).ok());
        let number = view["buffer"].as_u64().unwrap_or(u64::MAX);
        let Some(buffer) = item("buffers", number) else {
            self.faults.add("IM04", name, "a buffer that is there", number.to_string());
            return None;
        };
        let content = match buffer["uri"].as_str() {
            Some(uri) => (self.external)(uri),
            None => Some(self.binary.to_vec()),
        };
        let Some(content) = content else {
            self.faults.add("IM04", name, "the file of a buffer", buffer["uri"].to_string());
            return None;
        };
        if field(&buffer, "byteLength").is_none_or(|length| length > content.len()) {
            let expected = format!("buffer {number} of at most {} bytes", content.len());
            self.faults.add("IM04", name, expected, buffer["byteLength"].to_string());
        }
        let start = field(&view, "byteOffset").unwrap_or(0);
        let part = field(&view, "byteLength").and_then(|n| content.get(start..start.checked_add(n)?));
        if part.is_none() {
            let expected = format!("a buffer view within {} bytes", content.len());
            self.faults.add("IM04", name, expected, format!("{} from {start}", view["byteLength"]));
        }
        part.map(<[u8]>::to_vec)
    }
}

#[cfg(test)]
mod tests {
    use super::morton;

    #[test]
    fn morton_order_interleaves() {
        assert_eq!(morton(&[1, 0]), 1);
        assert_eq!(morton(&[0, 1]), 2);
        assert_eq!(morton(&[3, 5]), 0b100111);
        assert_eq!(morton(&[1, 1, 1]), 7);
    }
}
