//! The layout of a packed surface: its head and indexes, as types and from bytes that cannot be trusted.
//!
//! Pure: no file, no database, no compression, so that a browser reads it by range requests with the same code. A reader
//! asks for the first bytes ([`PackHead::length`], [`PackHead::parse`]), then for indexes ([`PackSection::parse_entries`]),
//! then for entries, whose bytes [`PackEntry::is_whole`] checks. The idea of one file that a static host serves by ranges is
//! that of cloud optimised GeoTIFF and of Protomaps' PMTiles.

use crate::IoError;
use crate::store::{ANNEX_ROW, BASE_ROW, BLOCK_NODES, ClusterMeta, TerrainMeta, row_crc32, row_id};
use serde::{Deserialize, Serialize};
use std::path::Path;
use yamanami_core::{Lattice, PAGE_CELLS, PageId};

/// First bytes of a packed surface.
pub const MAGIC: &[u8; 8] = b"YAMAPAK1";
/// Bytes before the head: magic, its length, its checksum.
pub const PREFIX_BYTES: usize = 16;
/// No head is longer.
pub const MOST_HEAD_BYTES: usize = 1 << 20;
/// Bytes of an entry of an index.
pub const ENTRY_BYTES: usize = 16;
/// Sections begin at a multiple of this.
pub const ALIGNMENT: usize = 16;

/// What a packed surface is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PackKind {
    /// A terrain.
    Terrain,
    /// A scanned model.
    Model,
    /// A TIN.
    Tin,
}

/// The head: what the surface says of itself and where its sections are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PackHead {
    /// What it is of.
    pub kind: PackKind,
    /// A name for people.
    pub title: String,
    /// The table `meta` of the database.
    pub meta: serde_json::Map<String, serde_json::Value>,
    /// Of a terrain, by level: radius in metres of spheres around a level's nodes that hold all their descendants.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bound_radius_m: Vec<f64>,
    /// Bytes of the whole.
    pub bytes: u64,
    /// The sections in the order in which they follow each other, coarse first.
    pub sections: Vec<PackSection>,
}

/// A section: an index, and the entries' bytes right after it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PackSection {
    /// `level` of a terrain; else `nodes`, `pages` or `annex`.
    pub name: String,
    /// A terrain's level, 0 the finest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<u32>,
    /// Number of entries.
    pub entries: u64,
    /// Where the index begins.
    pub index_at: u64,
    /// Bytes of the index and the entries.
    pub bytes: u64,
}

/// Where a row's bytes are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PackEntry {
    /// Where they begin.
    pub offset: u64,
    /// How many they are.
    pub length: u32,
    /// Checksum of row number and bytes: [`row_crc32`].
    pub crc32: u32,
}

/// Name, level and number of entries of a section.
type SectionKey = (&'static str, Option<u32>, u64);

impl PackEntry {
    /// Whether these are the bytes of the row.
    pub fn is_whole(&self, row: i64, bytes: &[u8]) -> bool {
        bytes.len() == self.length as usize && row_crc32(row, bytes) == self.crc32
    }

    #[cfg(any(test, feature = "files"))]
    pub(super) fn to_bytes(self) -> [u8; ENTRY_BYTES] {
        let mut bytes = [0; ENTRY_BYTES];
        bytes[..8].copy_from_slice(&self.offset.to_le_bytes());
        bytes[8..12].copy_from_slice(&self.length.to_le_bytes());
        bytes[12..].copy_from_slice(&self.crc32.to_le_bytes());
        bytes
    }

    pub(super) fn from_bytes(bytes: &[u8; ENTRY_BYTES]) -> Self {
        let [a, b, c, d, e, f, g, h, l0, l1, l2, l3, c0, c1, c2, c3] = *bytes;
        Self {
            offset: u64::from_le_bytes([a, b, c, d, e, f, g, h]),
            length: u32::from_le_bytes([l0, l1, l2, l3]),
            crc32: u32::from_le_bytes([c0, c1, c2, c3]),
        }
    }
}

impl PackSection {
    /// Where in the whole the entries from `first` to before `end` are described; nothing past the last entry.
    pub fn index_range(&self, first: u64, end: u64) -> std::ops::Range<u64> {
        let at = |entry: u64| self.index_at + ENTRY_BYTES as u64 * entry.min(self.entries);
        at(first)..at(end.max(first))
    }

    /// The entries from `first` on by their bytes of the index; `name` is the surface's, for messages.
    pub fn parse_entries(&self, name: &Path, first: u64, index: &[u8]) -> Result<Vec<PackEntry>, IoError> {
        let wrong = |found: &str| {
            let place = format!("index of section {} from entry {first} on", self.label());
            IoError::malformed(name, place, "entries that follow each other within the section", found)
        };
        let (entries, rest) = index.as_chunks::<ENTRY_BYTES>();
        let end = first.saturating_add(entries.len() as u64);
        if !rest.is_empty() || end > self.entries {
            return Err(wrong(&format!("{} bytes", index.len())));
        }
        let entries: Vec<PackEntry> = entries.iter().map(PackEntry::from_bytes).collect();
        let section_end = self.index_at + self.bytes;
        let data_at = self.index_range(self.entries, self.entries).start;
        let mut next = if first == 0 { Some(data_at) } else { None };
        for entry in &entries {
            let follows = next.is_none_or(|at| at == entry.offset) && entry.offset >= data_at;
            let entry_end = entry.offset.checked_add(entry.length.into()).filter(|&end| end <= section_end);
            let Some(entry_end) = entry_end.filter(|_| follows) else {
                return Err(wrong(&format!("{} bytes at {}", entry.length, entry.offset)));
            };
            next = Some(entry_end);
        }
        if end == self.entries && next.unwrap_or(data_at) != section_end && !(entries.is_empty() && first > 0) {
            return Err(wrong("room after the last"));
        }
        Ok(entries)
    }

    /// Row number of an entry of a terrain's section: its pages row by row.
    pub fn terrain_row(&self, lattice: &Lattice, entry: u64) -> Option<i64> {
        let level = self.level.filter(|&level| level <= lattice.levels() && entry < self.entries)?;
        let columns = u64::from(lattice.squares(level)[0].div_ceil(PAGE_CELLS));
        let [x, y] = [entry % columns, entry / columns].map(|place| u32::try_from(place).ok());
        Some(row_id(PageId { level, x: x?, y: y? }))
    }

    /// Row number of an entry of a model's or a TIN's section.
    pub fn model_row(&self, entry: u64) -> Option<i64> {
        let entry = i64::try_from(entry).ok().filter(|_| entry < self.entries)?;
        match self.name.as_str() {
            "nodes" if entry == 0 => Some(BASE_ROW),
            "nodes" => (entry - 1).checked_mul(BLOCK_NODES as i64),
            "pages" => Some(BASE_ROW + entry),
            "annex" => Some(ANNEX_ROW),
            _ => None,
        }
    }

    fn label(&self) -> String {
        self.level.map_or_else(|| self.name.clone(), |level| format!("{} {level}", self.name))
    }
}

impl PackHead {
    /// Bytes up to the end of the head, from the first [`PREFIX_BYTES`].
    pub fn length(name: &Path, prefix: &[u8]) -> Result<usize, IoError> {
        let wrong = |place: &str, expected: &str, found: String| IoError::malformed(name, place, expected, found);
        let Some(prefix) = prefix.first_chunk::<PREFIX_BYTES>() else {
            return Err(wrong("head", "at least 16 bytes", prefix.len().to_string()));
        };
        if !prefix.starts_with(MAGIC) {
            return Err(wrong("bytes 0 to 7", "\"YAMAPAK1\" (a packed surface)", "something else".into()));
        }
        let length = u32::from_le_bytes([prefix[8], prefix[9], prefix[10], prefix[11]]) as usize;
        if length > MOST_HEAD_BYTES {
            return Err(wrong("bytes 8 to 11", "a head of at most 1048576 bytes", length.to_string()));
        }
        Ok(PREFIX_BYTES + length)
    }

    /// The head from the first bytes of a packed surface, which may go on after it. Facts and sections are checked against
    /// each other.
    pub fn parse(name: &Path, start: &[u8]) -> Result<Self, IoError> {
        let end = Self::length(name, start)?;
        let wrong = |expected: String, found: String| IoError::malformed(name, "head", expected, found);
        let Some(json) = start.get(PREFIX_BYTES..end) else {
            return Err(wrong(format!("{end} bytes"), format!("{}: cut short", start.len())));
        };
        if crc32fast::hash(json).to_le_bytes() != start[12..PREFIX_BYTES] {
            return Err(wrong("a whole head".into(), "a checksum that does not match".into()));
        }
        let head: Self = serde_json::from_slice(json).map_err(|e| wrong("facts and sections".into(), e.to_string()))?;
        head.check(end).map_err(|found| wrong("a surface that can be".into(), found))?;
        Ok(head)
    }

    /// The head's bytes with what comes before and after it, up to `sections_at`.
    #[cfg(any(test, feature = "files"))]
    pub(super) fn to_bytes(&self, sections_at: usize) -> Option<Vec<u8>> {
        let json = serde_json::to_vec(self).ok().filter(|json| json.len() <= MOST_HEAD_BYTES)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(crc32fast::hash(&json).to_le_bytes());
        bytes.extend(json);
        bytes.resize(sections_at.max(bytes.len()), 0);
        Some(bytes)
    }

    /// What a terrain says of itself; what is wrong else.
    pub fn terrain(&self) -> Result<TerrainMeta, String> {
        TerrainMeta::from_json(&self.meta, self.bound_radius_m.clone()).map_err(|e| e.to_string())
    }

    /// What a model or a TIN says of itself; what is wrong else.
    pub fn clusters(&self) -> Result<ClusterMeta, String> {
        let meta = ClusterMeta::from_json(&self.meta).map_err(|e| e.to_string())?;
        if meta.tin.is_some() == (self.kind == PackKind::Tin) { Ok(meta) } else { Err("two kinds of model".into()) }
    }

    fn check(&self, head_end: usize) -> Result<(), String> {
        let mut next = None;
        for section in &self.sections {
            let label = section.label();
            let index_bytes = section.entries.saturating_mul(ENTRY_BYTES as u64);
            let follows = match next {
                None => section.index_at >= head_end as u64 && section.index_at.is_multiple_of(ALIGNMENT as u64),
                Some(at) => section.index_at == at,
            };
            let end = section.index_at.checked_add(section.bytes);
            next = end.filter(|&end| follows && section.bytes >= index_bytes && end <= self.bytes);
            if next.is_none() {
                return Err(format!("section {label} at {} of {} bytes", section.index_at, section.bytes));
            }
        }
        if next != Some(self.bytes) {
            return Err(format!("sections that do not make {} bytes", self.bytes));
        }
        let expected = self.expected_sections()?;
        let given = self.sections.iter().map(|s| (s.name.as_str(), s.level, s.entries));
        if given.eq(expected.iter().map(|&(name, level, entries)| (name, level, entries))) {
            Ok(())
        } else {
            Err("other sections than the surface has".into())
        }
    }

    /// The sections that a surface has.
    fn expected_sections(&self) -> Result<Vec<SectionKey>, String> {
        if self.kind == PackKind::Terrain {
            let [columns, rows] = self.terrain()?.size;
            let lattice = Lattice::new(columns as usize, rows as usize);
            let pages = |level| lattice.squares(level).map(|n| u64::from(n.div_ceil(PAGE_CELLS))).iter().product();
            return Ok((0..=lattice.levels()).rev().map(|level| ("level", Some(level), pages(level))).collect());
        }
        let nodes = u64::from(self.clusters()?.nodes);
        let mut sections = vec![("nodes", None, 1 + nodes.div_ceil(BLOCK_NODES as u64)), ("pages", None, 1 + nodes)];
        if self.kind == PackKind::Tin {
            sections.push(("annex", None, 1));
        }
        Ok(sections)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A model of nothing but a base mesh, whose head says so much of itself.
    fn head() -> PackHead {
        let meta = r#"{"kind":"clusters","title":"a","source":"b","source_faces":1,"source_vertices":3,"x_min_m":0.0,
            "x_max_m":0.1,"y_min_m":0.0,"y_max_m":1e-7,"z_min_m":0.0,"z_max_m":0.30000000000000004,"quantum_m":0.0009765625,
            "max_error_m":0.0,"has_colours":0,"nodes":0,"triangles":1,"vertices":3}"#;
        let section =
            |name: &str, index_at| PackSection { name: name.into(), level: None, entries: 1, index_at, bytes: 20 };
        PackHead {
            kind: PackKind::Model,
            title: "a".into(),
            meta: serde_json::from_str(meta).unwrap(),
            bound_radius_m: Vec::new(),
            bytes: 1064,
            sections: vec![section("nodes", 1024), section("pages", 1044)],
        }
    }

    #[test]
    fn a_head_comes_back_with_the_last_digit_of_every_number() {
        let bytes = head().to_bytes(1024).unwrap();
        assert_eq!(bytes.len(), 1024);
        assert_eq!(PackHead::parse(Path::new("a"), &bytes).unwrap(), head());
        let short = PackHead::parse(Path::new("a"), &bytes[..40]).unwrap_err().to_string();
        assert!(short.contains("cut short"), "{short}");
    }

    #[test]
    fn sections_that_do_not_follow_each_other_are_refused() {
        let refused = |change: fn(&mut PackHead)| {
            let mut changed = head();
            change(&mut changed);
            PackHead::parse(Path::new("a"), &changed.to_bytes(1024).unwrap()).unwrap_err();
        };
        refused(|head| head.bytes += 1);
        refused(|head| head.kind = PackKind::Terrain);
        refused(|head| head.sections[1].index_at += 16);
        refused(|head| head.sections[0].bytes = u64::MAX);
        refused(|head| head.sections[0].entries = u64::MAX);
        refused(|head| head.sections.truncate(1));
        refused(|head| head.sections.swap(0, 1));
    }

    #[test]
    fn entries_lie_within_their_section() {
        let section = &head().sections[0];
        let parse = |offset, length| {
            let entry = PackEntry { offset, length, crc32: 0 };
            section.parse_entries(Path::new("a"), 0, &entry.to_bytes())
        };
        assert_eq!(parse(1040, 4).unwrap()[0].length, 4);
        assert_eq!(section.parse_entries(Path::new("a"), 1, &[]).unwrap(), []);
        for (offset, length) in [(1040, 5), (1040, 3), (1039, 4), (1041, 4), (u64::MAX, 4)] {
            parse(offset, length).unwrap_err();
        }
        section.parse_entries(Path::new("a"), 0, &[0; 15]).unwrap_err();
        section.parse_entries(Path::new("a"), 0, &[0; 32]).unwrap_err();
    }

    proptest! {
        #[test]
        fn any_bytes_are_safe(bytes in proptest::collection::vec(any::<u8>(), 0..200), at in 0usize..1024, byte: u8) {
            let _ = PackHead::parse(Path::new("a"), &bytes);
            let _ = head().sections[1].parse_entries(Path::new("a"), 0, &bytes);
            let mut damaged = head().to_bytes(1024).unwrap();
            damaged[at] = byte;
            if let Ok(parsed) = PackHead::parse(Path::new("a"), &damaged) {
                prop_assert_eq!(parsed, head());
            }
        }
    }
}
