//! The bytes of a packed surface straight from the `.yama`: a few parts in memory, the rest rows of the database.

use super::layout::{ALIGNMENT, ENTRY_BYTES, PREFIX_BYTES, PackEntry, PackHead, PackKind, PackSection};
use crate::IoError;
use crate::mesh_file::{atomic, packing::Packing};
use crate::store::{ANNEX_ROW, Content, RawRow, RawStore};
use std::ops::Range;
use std::path::Path;
use yamanami_core::Lattice;

/// Bytes written at once.
const PIECE_BYTES: u64 = 1 << 20;

/// An open `.yama`, seen as a packed surface.
#[derive(Debug)]
pub struct PackSource {
    store: RawStore,
    head: PackHead,
    /// All before the first section.
    start: Vec<u8>,
    sections: Vec<Section>,
    tag: u64,
}

/// A section's index, and the rows it describes.
#[derive(Debug)]
struct Section {
    index_at: u64,
    end: u64,
    index: Vec<u8>,
    rows: Vec<i64>,
    of_nodes: bool,
}

/// What a place of the whole belongs to: bytes in memory, or a row; where it begins in the whole.
enum Segment<'a> {
    Memory(u64, &'a [u8]),
    Row { begins: u64, length: u64, row: i64, of_nodes: bool },
}

impl PackSource {
    /// Opens a `.yama` and reads which rows it has.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let store = RawStore::open(path.as_ref())?;
        let kind = match store.content() {
            Content::Terrain => PackKind::Terrain,
            Content::Clusters => PackKind::Model,
            Content::Tin => PackKind::Tin,
        };
        let mut named = Vec::new();
        let mut bound_radius_m = Vec::new();
        let pages = store.pages()?;
        if kind == PackKind::Terrain {
            bound_radius_m = store.bound_radius_m()?;
            for rows in pages.chunk_by(|a, b| a.row >> 48 == b.row >> 48) {
                let level = u32::try_from(63 - (rows[0].row >> 48)).unwrap_or(u32::MAX);
                named.push(("level", Some(level), rows.to_vec()));
            }
        } else {
            let (annex, pages): (Vec<_>, Vec<_>) = pages.into_iter().partition(|page| page.row == ANNEX_ROW);
            named.extend([("nodes", None, store.node_blocks()?), ("pages", None, pages)]);
            if kind == PackKind::Tin {
                named.push(("annex", None, annex));
            }
        }
        let mut head = PackHead {
            kind,
            title: String::new(),
            meta: store.facts()?.to_json(),
            bound_radius_m,
            bytes: 0,
            sections: named.iter().map(|(name, level, rows)| section(name, *level, rows)).collect(),
        };
        let path = store.path().to_owned();
        let damaged = |found: String| IoError::malformed(&path, "rows", "those of a whole surface", found);
        head.title = head.meta.get("title").and_then(|title| title.as_str()).unwrap_or_default().to_owned();
        let start = place(&mut head).ok_or_else(|| {
            IoError::too_large(store.path(), "facts, bytes", 0, super::layout::MOST_HEAD_BYTES as u64)
        })?;
        // what a reader would refuse is not given out
        PackHead::parse(store.path(), &start)?;
        let lattice = head.terrain().map(|meta| Lattice::new(meta.size[0] as usize, meta.size[1] as usize)).ok();
        let mut sections = Vec::with_capacity(named.len());
        for (described, (name, _, rows)) in head.sections.iter().zip(named) {
            let index = index_of(described, &rows);
            described.parse_entries(store.path(), 0, &index)?;
            let row = |entry| {
                lattice.as_ref().map_or_else(|| described.model_row(entry), |l| described.terrain_row(l, entry))
            };
            if let Some((_, wrong)) = (0..).zip(&rows).find(|&(entry, found)| row(entry) != Some(found.row)) {
                return Err(damaged(format!("row {}", wrong.row)));
            }
            sections.push(Section {
                index_at: described.index_at,
                end: described.index_at + described.bytes,
                index,
                rows: rows.iter().map(|row| row.row).collect(),
                of_nodes: name == "nodes",
            });
        }
        let mut tag = crc32fast::Hasher::new();
        sections.iter().for_each(|section| tag.update(&section.index));
        let tag = u64::from(crc32fast::hash(&start)) << 32 | u64::from(tag.finalize());
        Ok(Self { store, head, start, sections, tag })
    }

    /// The file behind it.
    pub fn path(&self) -> &Path {
        self.store.path()
    }

    /// What the surface says of itself and where its sections are.
    pub fn head(&self) -> &PackHead {
        &self.head
    }

    /// Bytes of the whole.
    pub fn bytes(&self) -> u64 {
        self.head.bytes
    }

    /// Changes when any byte of the whole does: of the checksums of its head and of all rows.
    pub fn tag(&self) -> u64 {
        self.tag
    }

    /// The bytes of a range, which must lie within the whole.
    pub fn read(&self, range: Range<u64>) -> Result<Vec<u8>, IoError> {
        let mut bytes = Vec::new();
        let mut at = range.start;
        while at < range.end {
            let piece = self.read_piece(at..range.end, u64::MAX)?;
            at += piece.len() as u64;
            bytes.extend(piece);
        }
        Ok(bytes)
    }

    /// The first bytes of a range, for sending a long one piece by piece: at least one byte of a range that is not empty;
    /// no row that would begin after `about` bytes.
    pub fn read_piece(&self, range: Range<u64>, about: u64) -> Result<Vec<u8>, IoError> {
        if range.end > self.head.bytes {
            return Err(IoError::BadRequest {
                what: "range of a packed surface".into(),
                expected: format!("bytes up to {}", self.head.bytes),
                given: format!("{} to {}", range.start, range.end),
            });
        }
        let mut bytes = Vec::new();
        let mut at = range.start;
        while at < range.end && (bytes.is_empty() || at - range.start < about) {
            let (begins, whole) = match self.segment(at) {
                Some(Segment::Memory(begins, part)) => (begins, std::borrow::Cow::Borrowed(part)),
                Some(Segment::Row { begins, length, row, of_nodes }) => {
                    let row = if of_nodes { self.store.node_block(row) } else { self.store.page(row) }?;
                    if row.len() as u64 != length {
                        return Err(IoError::malformed(self.path(), "rows", "a file that stays as it is", "a change"));
                    }
                    (begins, std::borrow::Cow::Owned(row))
                }
                None => break,
            };
            let first = (at - begins) as usize;
            let end = whole.len().min((range.end - begins).try_into().unwrap_or(usize::MAX));
            bytes.extend_from_slice(&whole[first..end]);
            at = begins + end as u64;
        }
        Ok(bytes)
    }

    /// What the byte at a place within the whole belongs to; never empty.
    fn segment(&self, at: u64) -> Option<Segment<'_>> {
        if at < self.start.len() as u64 {
            return Some(Segment::Memory(0, &self.start));
        }
        let section = &self.sections[self.sections.partition_point(|section| section.end <= at)..].first()?;
        if at < section.index_at + section.index.len() as u64 {
            return Some(Segment::Memory(section.index_at, &section.index));
        }
        let (entries, _) = section.index.as_chunks::<ENTRY_BYTES>();
        let number = entries.partition_point(|entry| PackEntry::from_bytes(entry).offset <= at).checked_sub(1)?;
        let PackEntry { offset, length, .. } = PackEntry::from_bytes(&entries[number]);
        let of_nodes = section.of_nodes;
        Some(Segment::Row { begins: offset, length: length.into(), row: section.rows[number], of_nodes })
    }
}

/// Writes a `.yama` as a packed surface. `path` changes only when all is written; `progress` hears of the share done, 0 to 1.
pub fn write_pack(source: &PackSource, path: impl AsRef<Path>, progress: &dyn Fn(f32)) -> Result<(), IoError> {
    atomic::write(path.as_ref(), Packing::None, |out| {
        let mut at = 0;
        while at < source.bytes() {
            let piece = source.read_piece(at..source.bytes(), PIECE_BYTES).map_err(std::io::Error::other)?;
            out.write_all(&piece)?;
            at += piece.len() as u64;
            progress(at as f32 / source.bytes() as f32);
        }
        Ok(())
    })
}

/// A section that is not placed yet.
fn section(name: &str, level: Option<u32>, rows: &[RawRow]) -> PackSection {
    let data: u64 = rows.iter().map(|row| u64::from(row.length)).sum();
    let entries = rows.len() as u64;
    PackSection { name: name.to_owned(), level, entries, index_at: 0, bytes: entries * ENTRY_BYTES as u64 + data }
}

/// Places the sections one after another behind the head, which tells their places and so gets longer with them.
fn place(head: &mut PackHead) -> Option<Vec<u8>> {
    let mut sections_at = 0;
    loop {
        let mut next = sections_at as u64;
        for section in &mut head.sections {
            section.index_at = next;
            next += section.bytes;
        }
        head.bytes = next;
        let bytes = head.to_bytes(sections_at)?;
        if bytes.len() == sections_at {
            return Some(bytes);
        }
        sections_at = bytes.len().next_multiple_of(ALIGNMENT).max(PREFIX_BYTES);
    }
}

fn index_of(section: &PackSection, rows: &[RawRow]) -> Vec<u8> {
    let mut offset = section.index_range(section.entries, section.entries).start;
    let mut index = Vec::with_capacity(rows.len() * ENTRY_BYTES);
    for row in rows {
        index.extend(PackEntry { offset, length: row.length, crc32: row.crc32 }.to_bytes());
        offset += u64::from(row.length);
    }
    index
}
