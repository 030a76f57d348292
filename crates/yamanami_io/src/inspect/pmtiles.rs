//! A PMTiles archive, version 3: header, directories, tiles.
//!
//! Based on: Protomaps, "PMTiles Version 3 Specification", 2022 to 2024.

use super::{Bytes, Faults, LIMIT_BYTES, without_gzip};
use crate::IoError;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

const HEADER: usize = 127;

/// Most bytes of a directory, unpacked, and most tiles looked at.
const MOST_DIRECTORY: u64 = 64 << 20;
const MOST_ENTRIES: usize = 1 << 26;

/// A tile of an archive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct PmTile {
    /// Its number along the curve.
    pub id: u64,
    /// Zoom, column, row from the north.
    pub place: [u32; 3],
    /// First byte in the file.
    pub offset: u64,
    /// Bytes.
    pub length: u32,
}

/// An archive.
#[derive(Debug)]
#[non_exhaustive]
pub struct PmTiles {
    path: PathBuf,
    file: Mutex<File>,
    /// Its tiles, by number.
    pub tiles: Vec<PmTile>,
    /// 2 is PNG, 3 JPEG, 4 WebP.
    pub tile_type: u8,
    /// 1 is none, 2 gzip.
    pub tile_compression: u8,
}

/// What the header says.
struct Header {
    root: [u64; 2],
    metadata: [u64; 2],
    leaves: [u64; 2],
    data: [u64; 2],
    /// Addressed tiles, entries, contents.
    counts: [u64; 3],
    /// Whether clustered, compression of directories, of tiles, type, least and greatest zoom.
    flags: [u8; 6],
    /// West, south, east, north, in ten millionths of a degree.
    bounds: [i32; 4],
}

impl Header {
    fn read(bytes: &[u8]) -> Option<Self> {
        let mut reader = Bytes::new(bytes);
        reader.take(8)?;
        let mut pair = || Some([reader.u64()?, reader.u64()?]);
        let (root, metadata, leaves, data) = (pair()?, pair()?, pair()?, pair()?);
        let counts = [reader.u64()?, reader.u64()?, reader.u64()?];
        let flags = reader.array()?;
        let mut corner = || reader.array().map(i32::from_le_bytes);
        let bounds = [corner()?, corner()?, corner()?, corner()?];
        Some(Self { root, metadata, leaves, data, counts, flags, bounds })
    }
}

impl PmTiles {
    /// Opens an archive and judges its header and directories; `None` where it is none.
    pub fn open(path: &Path, faults: &mut Faults) -> Result<Option<Self>, IoError> {
        let mut file = File::open(path).map_err(|e| IoError::io(path, e))?;
        let length = file.metadata().map_err(|e| IoError::io(path, e))?.len();
        let mut head = Vec::new();
        (&mut file).take(HEADER as u64).read_to_end(&mut head).map_err(|e| IoError::io(path, e))?;
        if head.get(..7) != Some(b"PMTiles") || head.get(7) != Some(&3) {
            faults.add("PM01", "header", "'PMTiles' version 3", format!("{:?}", head.get(..8)));
            return Ok(None);
        }
        let Some(header) = Header::read(&head) else {
            faults.add("PM01", "header", format!("{HEADER} bytes"), format!("{} bytes", head.len()));
            return Ok(None);
        };
        let [clustered, internal, tile_compression, tile_type, ..] = header.flags;
        let mut archive =
            Self { path: path.to_owned(), file: Mutex::new(file), tiles: Vec::new(), tile_type, tile_compression };
        let sections = [
            ("root directory", header.root),
            ("metadata", header.metadata),
            ("leaf directories", header.leaves),
            ("tile data", header.data),
        ];
        for (name, [start, size]) in sections {
            if start.checked_add(size).is_none_or(|end| end > length) {
                let found = format!("{size} bytes from byte {start}");
                faults.add("PM02", name, format!("a section within {length} bytes"), found);
                return Ok(Some(archive));
            }
        }
        if header.root[0] + header.root[1] > 16384 {
            faults.add("PM09", "root directory", "within the first 16384 bytes", format!("{:?}", header.root));
        }
        if !(1..=2).contains(&internal) {
            faults.add("PM10", "header", "directories plain or packed by gzip", format!("compression {internal}"));
            return Ok(Some(archive));
        }
        archive.check_metadata(&header, faults)?;
        let entries = archive.directory(&header, header.root, 0, faults)?;
        archive.check_entries(&header, &entries, clustered == 1, faults);
        Ok(Some(archive))
    }

    fn check_metadata(&self, header: &Header, faults: &mut Faults) -> Result<(), IoError> {
        let bytes = self.section(header.metadata[0], header.metadata[1])?;
        let plain = without_gzip(&bytes, "PM06", faults);
        let is_object =
            plain.is_some_and(|p| serde_json::from_slice::<serde_json::Value>(&p).is_ok_and(|v| v.is_object()));
        if !is_object {
            faults.add("PM06", "metadata", "a JSON object", "something else");
        }
        Ok(())
    }

    /// Tile number, offset in the tile data, length, run.
    fn directory(
        &self,
        header: &Header,
        [start, size]: [u64; 2],
        depth: u32,
        faults: &mut Faults,
    ) -> Result<Vec<[u64; 4]>, IoError> {
        let place = format!("directory at byte {start}");
        if size > MOST_DIRECTORY {
            faults.add("PM03", place, format!("at most {MOST_DIRECTORY} bytes"), size.to_string());
            return Ok(Vec::new());
        }
        let bytes = self.section(start, size)?;
        let Some(plain) = without_gzip(&bytes, "PM03", faults) else { return Ok(Vec::new()) };
        let Some(entries) = entries(&plain) else {
            faults.add("PM03", place, "a directory of whole entries", "something else");
            return Ok(Vec::new());
        };
        let mut all = Vec::new();
        for [id, offset, length, run] in entries {
            if run > 0 {
                all.push([id, offset, length, run]);
                continue;
            }
            let inside = offset.checked_add(length).is_some_and(|end| end <= header.leaves[1]);
            if !inside || depth >= 4 {
                faults.add(
                    "PM03",
                    place.clone(),
                    "leaf directories within their section",
                    format!("{length} bytes from {offset}"),
                );
                continue;
            }
            all.extend(self.directory(header, [header.leaves[0] + offset, length], depth + 1, faults)?);
            if all.len() > MOST_ENTRIES {
                faults.add("PM03", place.clone(), format!("at most {MOST_ENTRIES} entries"), "more");
                break;
            }
        }
        Ok(all)
    }

    fn check_entries(&mut self, header: &Header, entries: &[[u64; 4]], clustered: bool, faults: &mut Faults) {
        let (mut next, mut end, mut addressed) = (0u64, 0u64, 0u64);
        let mut contents: Vec<u64> = Vec::new();
        let mut zooms = [u32::MAX, 0];
        for (k, &[id, offset, length, run]) in entries.iter().enumerate() {
            let place = format!("entry {k}");
            if id < next {
                faults.add("PM04", place.clone(), format!("a tile number of at least {next}"), id.to_string());
            }
            if offset.checked_add(length).is_none_or(|end| end > header.data[1]) || length == 0 {
                let expected = format!("a tile within {} bytes of data", header.data[1]);
                faults.add("PM02", place.clone(), expected, format!("{length} bytes from byte {offset}"));
                continue;
            }
            if clustered && offset > end {
                faults.add("PM04", place, format!("clustered tiles: an offset up to {end}"), offset.to_string());
            }
            end = end.max(offset + length);
            next = id.saturating_add(run);
            addressed = addressed.saturating_add(run);
            contents.push(offset);
            for id in id..next.min(id.saturating_add(MOST_ENTRIES as u64)) {
                let Some(place) = tile_of(id) else {
                    faults.add("PM04", format!("entry {k}"), "a zoom up to 30", id.to_string());
                    break;
                };
                if self.tiles.len() >= MOST_ENTRIES {
                    return;
                }
                zooms = [zooms[0].min(place[0]), zooms[1].max(place[0])];
                self.tiles.push(PmTile { id, place, offset: header.data[0] + offset, length: length as u32 });
            }
        }
        self.tiles.sort_by_key(|t| t.id);
        contents.sort_unstable();
        contents.dedup();
        let found = [addressed, entries.len() as u64, contents.len() as u64];
        for ((name, stated), own) in ["addressed tiles", "entries", "contents"].iter().zip(header.counts).zip(found) {
            // 0 means unknown
            if stated != 0 && stated != own {
                faults.add("PM05", format!("number of {name}"), own.to_string(), stated.to_string());
            }
        }
        let stated = [u32::from(header.flags[4]), u32::from(header.flags[5])];
        if !self.tiles.is_empty() && stated != zooms {
            faults.add("PM07", "header", format!("zooms {} to {}", zooms[0], zooms[1]), format!("{stated:?}"));
        }
        let [west, south, east, north] = header.bounds.map(|v| f64::from(v) / 1e7);
        if !(-180.0 <= west && west < east && east <= 180.0 && -90.0 <= south && south < north && north <= 90.0) {
            faults.add("PM08", "header", "bounds on the globe", format!("{west}, {south}, {east}, {north}"));
        }
    }

    fn section(&self, start: u64, size: u64) -> Result<Vec<u8>, IoError> {
        let failed = |e| IoError::io(&self.path, e);
        let mut file = self.file.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        file.seek(SeekFrom::Start(start)).map_err(failed)?;
        let mut bytes = Vec::new();
        (&mut *file).take(size.min(LIMIT_BYTES)).read_to_end(&mut bytes).map_err(failed)?;
        Ok(bytes)
    }

    /// The bytes of a tile, as they lie in the archive.
    pub fn read(&self, tile: &PmTile) -> Result<Vec<u8>, IoError> {
        self.section(tile.offset, tile.length.into())
    }
}

/// A number of seven bits a byte.
fn varint(bytes: &mut Bytes<'_>) -> Option<u64> {
    let mut value = 0u64;
    for shift in (0..64).step_by(7) {
        let byte = bytes.u8()?;
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some(value);
        }
    }
    None
}

/// Tile number, offset, length, run of each entry.
fn entries(bytes: &[u8]) -> Option<Vec<[u64; 4]>> {
    let mut bytes = Bytes::new(bytes);
    let count = usize::try_from(varint(&mut bytes)?).ok()?;
    // each entry takes four bytes at least
    if count > bytes.left() / 4 {
        return None;
    }
    let mut entries = vec![[0; 4]; count];
    let mut id = 0u64;
    for entry in &mut entries {
        id = id.checked_add(varint(&mut bytes)?)?;
        entry[0] = id;
    }
    for entry in &mut entries {
        entry[3] = varint(&mut bytes)?;
    }
    for entry in &mut entries {
        entry[2] = varint(&mut bytes)?;
    }
    let mut after = None;
    for entry in &mut entries {
        entry[1] = match varint(&mut bytes)? {
            0 => after?,
            offset => offset - 1,
        };
        after = Some(entry[1].checked_add(entry[2])?);
    }
    Some(entries)
}

/// Zoom, column and row of a number along the Hilbert curves.
fn tile_of(id: u64) -> Option<[u32; 3]> {
    let mut before = 0u64;
    for zoom in 0..=30u32 {
        let tiles = 1u64 << (2 * zoom);
        if id < before + tiles {
            let (mut t, mut x, mut y) = (id - before, 0u64, 0u64);
            for level in 0..zoom {
                let s = 1u64 << level;
                let rx = 1 & (t / 2);
                let ry = 1 & (t ^ rx);
                if ry == 0 {
                    if rx == 1 {
                        (x, y) = (s - 1 - x, s - 1 - y);
                    }
                    (x, y) = (y, x);
                }
                (x, y, t) = (x + s * rx, y + s * ry, t / 4);
            }
            return Some([zoom, x as u32, y as u32]);
        }
        before += tiles;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::tile_of;

    #[test]
    fn numbers_are_those_of_the_specification() {
        for (id, place) in [
            (0, [0, 0, 0]),
            (1, [1, 0, 0]),
            (2, [1, 0, 1]),
            (3, [1, 1, 1]),
            (4, [1, 1, 0]),
            (5, [2, 0, 0]),
        ] {
            assert_eq!(tile_of(id), Some(place));
        }
        assert_eq!(tile_of(19_078_479), Some([12, 3423, 1763]));
        assert_eq!(tile_of(u64::MAX), None);
    }
}
