//! PMTiles 3: a tile pyramid in one file that is read by ranges.
//!
//! Format: B. Liu (Protomaps), "PMTiles Version 3 Specification", 2022. Tiles lie in the order of their numbers along
//! Hilbert's curve (D. Hilbert, 1891), equal ones once.

use crate::IoError;
use crate::mesh_file::{atomic, packing::Packing};
use crate::tiles::TileOutput;
use flate2::{Compression, write::GzEncoder};
use std::collections::HashMap;
use std::fs::File;
use std::hash::{DefaultHasher, Hasher};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

const HEADER_BYTES: usize = 127;
/// Header and root directory are read at once.
const MOST_START_BYTES: usize = 16_384;
/// Entries of a leaf directory to begin with.
const FIRST_LEAF_ENTRIES: usize = 4096;
/// No zoom is finer: numbers of tiles stay within 64 bits.
const MOST_ZOOM: u32 = 26;

/// What an archive says of itself.
#[derive(Debug, Clone)]
pub struct PmtilesFacts {
    /// Coarsest and finest zoom.
    pub zooms: [u32; 2],
    /// West, south, east, north, degrees.
    pub bounds_deg: [f64; 4],
    /// The metadata, a JSON object.
    pub metadata: serde_json::Value,
}

/// An archive of PNG tiles in the making. Tiles may come in any order and from several threads.
#[derive(Debug)]
pub struct PmtilesArchive {
    target: PathBuf,
    spool: Mutex<Spool>,
}

/// Contents as they came, and which tile has which.
#[derive(Debug)]
struct Spool {
    file: File,
    end: u64,
    contents: Vec<(u64, u32)>,
    known: HashMap<[u64; 2], u32>,
    /// Number and content of every tile.
    tiles: Vec<(u64, u32)>,
}

/// An entry of a directory: so many tiles from a number on have the same content; of a leaf directory none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Entry {
    tile: u64,
    run: u32,
    offset: u64,
    length: u32,
}

impl PmtilesArchive {
    /// Begins an archive; nothing at `target` changes before [`finish`](Self::finish).
    pub fn create(target: &Path) -> Result<Self, IoError> {
        let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let file = tempfile::tempfile_in(folder).map_err(|e| IoError::io(target, e))?;
        let spool = Spool { file, end: 0, contents: Vec::new(), known: HashMap::new(), tiles: Vec::new() };
        Ok(Self { target: target.to_owned(), spool: Mutex::new(spool) })
    }

    /// Puts the tiles in order and gives the archive its name.
    pub fn finish(self, facts: &PmtilesFacts) -> Result<(), IoError> {
        let mut spool = self.spool.into_inner().unwrap_or_else(PoisonError::into_inner);
        let failed = |e: std::io::Error| IoError::io(&self.target, e);
        spool.tiles.sort_unstable();
        spool.tiles.dedup_by_key(|(tile, _)| *tile);
        let (entries, order, data_bytes) = spool.entries();
        let (root, leaves) = directories(&entries).map_err(failed)?;
        let metadata = gzip(facts.metadata.to_string().as_bytes()).map_err(failed)?;
        let at = HEADER_BYTES as u64;
        let places = [
            (at, root.len() as u64),
            (at + root.len() as u64, metadata.len() as u64),
            (at + (root.len() + metadata.len()) as u64, leaves.len() as u64),
            (at + (root.len() + metadata.len() + leaves.len()) as u64, data_bytes),
        ];
        let counts = [spool.tiles.len() as u64, entries.len() as u64, order.len() as u64];
        let header = header(&places, &counts, facts);
        atomic::write(&self.target, Packing::None, |out| {
            [&header[..], &root, &metadata, &leaves].into_iter().try_for_each(|part| out.write_all(part))?;
            let mut bytes = Vec::new();
            for content in order {
                spool.read(content, &mut bytes)?;
                out.write_all(&bytes)?;
            }
            Ok(())
        })
    }
}

impl TileOutput for PmtilesArchive {
    /// Takes `zoom/column/row.png`.
    fn put(&self, path: &str, bytes: &[u8]) -> Result<(), IoError> {
        let tile = parse(path).ok_or_else(|| IoError::BadRequest {
            what: "path of a tile".to_owned(),
            expected: "zoom/column/row.png".to_owned(),
            given: path.to_owned(),
        })?;
        let length = u32::try_from(bytes.len())
            .map_err(|_| IoError::too_large(&self.target, "bytes of a tile", bytes.len() as u64, u32::MAX.into()))?;
        let mut spool = self.spool.lock().unwrap_or_else(PoisonError::into_inner);
        let key = fingerprint(bytes);
        let content = match spool.known.get(&key) {
            Some(&content) => content,
            None => spool.add(key, bytes, length).map_err(|e| IoError::io(&self.target, e))?,
        };
        spool.tiles.push((tile, content));
        Ok(())
    }

    fn has(&self, _path: &str) -> bool {
        false
    }
}

impl Spool {
    fn add(&mut self, key: [u64; 2], bytes: &[u8], length: u32) -> std::io::Result<u32> {
        self.file.write_all(bytes)?;
        let content = u32::try_from(self.contents.len()).map_err(std::io::Error::other)?;
        self.contents.push((self.end, length));
        self.known.insert(key, content);
        self.end += bytes.len() as u64;
        Ok(content)
    }

    fn read(&mut self, content: u32, bytes: &mut Vec<u8>) -> std::io::Result<()> {
        let (offset, length) = self.contents[content as usize];
        bytes.resize(length as usize, 0);
        self.file.seek(SeekFrom::Start(offset))?;
        self.file.read_exact(bytes)
    }

    /// All entries, the order of the contents in the archive, and the bytes of these.
    fn entries(&self) -> (Vec<Entry>, Vec<u32>, u64) {
        let mut entries: Vec<Entry> = Vec::new();
        let mut order = Vec::new();
        let mut placed: HashMap<u32, u64> = HashMap::new();
        let mut end = 0;
        let mut last = None;
        for &(tile, content) in &self.tiles {
            if let (Some(entry), true) = (entries.last_mut(), last == Some(content))
                && entry.tile + u64::from(entry.run) == tile
            {
                entry.run += 1;
                continue;
            }
            last = Some(content);
            let length = self.contents[content as usize].1;
            let offset = *placed.entry(content).or_insert_with(|| {
                order.push(content);
                end += u64::from(length);
                end - u64::from(length)
            });
            entries.push(Entry { tile, run: 1, offset, length });
        }
        (entries, order, end)
    }
}

/// Equal contents have equal fingerprints, and others, for all that is likely, others.
fn fingerprint(bytes: &[u8]) -> [u64; 2] {
    [0, 1].map(|seed| {
        let mut hasher = DefaultHasher::new();
        hasher.write_u8(seed);
        hasher.write(bytes);
        hasher.finish()
    })
}

fn parse(path: &str) -> Option<u64> {
    let mut parts = path.strip_suffix(".png")?.split('/').map(|part| part.parse::<u32>().ok());
    let (zoom, x, y) = (parts.next()??, parts.next()??, parts.next()??);
    let is_tile = parts.next().is_none() && zoom <= MOST_ZOOM && x < 1 << zoom && y < 1 << zoom;
    is_tile.then(|| tile_number(zoom, x, y))
}

/// A tile's number: those of coarser zooms first, then along Hilbert's curve.
pub fn tile_number(zoom: u32, x: u32, y: u32) -> u64 {
    let coarser = ((1u64 << (2 * zoom)) - 1) / 3;
    let (mut x, mut y) = (x, y);
    let mut along = 0;
    for bit in (0..zoom).rev() {
        let side = 1u32 << bit;
        let [right, below] = [x & side, y & side].map(|v| u64::from(v != 0));
        along += (u64::from(side) * u64::from(side)) * ((3 * right) ^ below);
        // the curve enters each quarter turned its own way
        if below == 0 {
            if right == 1 {
                x = (side - 1).wrapping_sub(x);
                y = (side - 1).wrapping_sub(y);
            }
            std::mem::swap(&mut x, &mut y);
        }
    }
    coarser + along
}

fn put_varint(bytes: &mut Vec<u8>, mut n: u64) {
    while n >= 0x80 {
        bytes.push(n as u8 | 0x80);
        n >>= 7;
    }
    bytes.push(n as u8);
}

fn gzip(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}

fn directory(entries: &[Entry]) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    put_varint(&mut bytes, entries.len() as u64);
    let mut last = 0;
    for entry in entries {
        put_varint(&mut bytes, entry.tile - last);
        last = entry.tile;
    }
    entries.iter().for_each(|entry| put_varint(&mut bytes, entry.run.into()));
    entries.iter().for_each(|entry| put_varint(&mut bytes, entry.length.into()));
    let mut next = None;
    for entry in entries {
        // 0: right after the one before
        put_varint(&mut bytes, if next == Some(entry.offset) { 0 } else { entry.offset + 1 });
        next = Some(entry.offset + u64::from(entry.length));
    }
    gzip(&bytes)
}

/// The root directory, and the leaves where the root alone would be too long.
fn directories(entries: &[Entry]) -> std::io::Result<(Vec<u8>, Vec<u8>)> {
    let root = directory(entries)?;
    if HEADER_BYTES + root.len() <= MOST_START_BYTES {
        return Ok((root, Vec::new()));
    }
    let mut leaf_entries = FIRST_LEAF_ENTRIES;
    loop {
        let (mut leaves, mut pointers) = (Vec::new(), Vec::new());
        for some in entries.chunks(leaf_entries) {
            let leaf = directory(some)?;
            let (offset, length) = (leaves.len() as u64, leaf.len() as u32);
            pointers.push(Entry { tile: some[0].tile, run: 0, offset, length });
            leaves.extend(leaf);
        }
        let root = directory(&pointers)?;
        if HEADER_BYTES + root.len() <= MOST_START_BYTES {
            return Ok((root, leaves));
        }
        leaf_entries *= 2;
    }
}

fn header(places: &[(u64, u64); 4], counts: &[u64; 3], facts: &PmtilesFacts) -> Vec<u8> {
    const GZIP: u8 = 2;
    const NONE: u8 = 1;
    const PNG: u8 = 2;
    let mut bytes = b"PMTiles\x03".to_vec();
    places.iter().flat_map(|(at, length)| [*at, *length]).chain(*counts).for_each(|n| bytes.extend(n.to_le_bytes()));
    let [coarsest, finest] = facts.zooms.map(|zoom| zoom as u8);
    let clustered = 1;
    bytes.extend([clustered, GZIP, NONE, PNG, coarsest, finest]);
    let [west, south, east, north] = facts.bounds_deg;
    let degrees = |deg: f64| ((deg.clamp(-180.0, 180.0) * 1e7).round() as i32).to_le_bytes();
    [west, south, east, north].into_iter().for_each(|deg| bytes.extend(degrees(deg)));
    bytes.push(finest);
    [0.5 * (west + east.min(180.0)), 0.5 * (south + north)].into_iter().for_each(|deg| bytes.extend(degrees(deg)));
    bytes
}

#[cfg(test)]
mod tests;
