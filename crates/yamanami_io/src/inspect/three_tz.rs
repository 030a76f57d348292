//! A 3tz archive: the index of its names, and what is wrong with it.
//!
//! Based on: Maxar, "3D Tiles archive format (3TZ) 1.3", 2022.

use super::Faults;
use crate::IoError;
use md5::{Digest, Md5};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Name of the index in the archive.
const INDEX: &str = "@3dtilesIndex1@";

/// Bytes of an entry of the index: a hash and an offset.
const ENTRY: usize = 24;

/// What an archive has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct ThreeTz {
    /// Files beside the index.
    pub files: usize,
    /// Entries of the index.
    pub indexed: usize,
}

/// Judges the archive and its index.
pub fn three_tz(path: &Path, faults: &mut Faults) -> Result<ThreeTz, IoError> {
    let file = File::open(path).map_err(|e| IoError::io(path, e))?;
    let mut archive = match zip::ZipArchive::new(file) {
        Ok(archive) => archive,
        Err(cause) => {
            faults.add("TZ01", "directory", "a zip archive", cause.to_string());
            return Ok(ThreeTz { files: 0, indexed: 0 });
        }
    };
    let mut files: Vec<(u128, u64, String)> = Vec::new();
    let mut last = (0, String::new());
    for k in 0..archive.len() {
        let raw = archive.by_index_raw(k);
        let named = raw.and_then(|entry| Ok((entry.name()?.into_owned(), entry.header_start(), entry.compression())));
        let (name, start, method) = match named {
            Ok(named) => named,
            Err(cause) => {
                faults.add("TZ01", format!("entry {k}"), "an entry that can be read", cause.to_string());
                continue;
            }
        };
        let allowed = ["Stored", "Deflated", "Zstd"].contains(&format!("{method:?}").as_str());
        if !allowed {
            faults.add("TZ07", name.clone(), "stored, deflate or zstd", format!("{method:?}"));
        }
        if start >= last.0 {
            last = (start, name.clone());
        }
        if name == INDEX || name.ends_with('/') {
            continue;
        }
        if name.contains('\\') || name.starts_with('/') || name.split('/').any(|p| p == "..") {
            faults.add("TZ08", name.clone(), "a path below the archive with slashes", name.clone());
        }
        files.push((hash(&name), start, name));
    }
    if !files.iter().any(|(_, _, name)| name == "tileset.json") {
        faults.add("TZ06", "directory", "tileset.json at the top", "none");
    }
    let count = files.len();
    let mut bytes = Vec::new();
    let most = (count as u64 + 1) * 2 * ENTRY as u64;
    let read = archive.by_name(INDEX).map(|entry| entry.take(most).read_to_end(&mut bytes).map(|_| ()));
    match read {
        Ok(Ok(())) => {}
        Ok(Err(cause)) => {
            faults.add("TZ02", INDEX, "an index that can be read", cause.to_string());
            return Ok(ThreeTz { files: count, indexed: 0 });
        }
        Err(_) => {
            faults.add("TZ02", "directory", format!("the index {INDEX}"), "none");
            return Ok(ThreeTz { files: count, indexed: 0 });
        }
    }
    if last.1 != INDEX {
        faults.add("TZ02", "directory", format!("{INDEX} as the last entry"), last.1);
    }
    check_index(&bytes, &mut files, faults);
    Ok(ThreeTz { files: count, indexed: bytes.len() / ENTRY })
}

/// The hash of a name as the number by which the index is sorted: its two halves, little endian, the first one leading.
fn hash(name: &str) -> u128 {
    sort_key(&Md5::digest(name.as_bytes()))
}

fn sort_key(bytes: &[u8]) -> u128 {
    let half = |at: usize| {
        let mut half = [0; 8];
        half.copy_from_slice(&bytes[at..at + 8]);
        u128::from(u64::from_le_bytes(half))
    };
    half(0) << 64 | half(8)
}

fn check_index(bytes: &[u8], files: &mut [(u128, u64, String)], faults: &mut Faults) {
    if !bytes.len().is_multiple_of(ENTRY) {
        faults.add("TZ02", INDEX, format!("a multiple of {ENTRY} bytes"), bytes.len().to_string());
    }
    let mut entries: Vec<(u128, u64)> = Vec::with_capacity(bytes.len() / ENTRY);
    for entry in bytes.chunks_exact(ENTRY) {
        let mut offset = [0; 8];
        offset.copy_from_slice(&entry[16..]);
        entries.push((sort_key(&entry[..16]), u64::from_le_bytes(offset)));
    }
    if let Some(k) = entries.windows(2).position(|pair| pair[0].0 >= pair[1].0) {
        faults.add(
            "TZ03",
            format!("{INDEX}, entry {}", k + 1),
            "hashes in rising order",
            "one that is not above the last",
        );
        entries.sort_unstable();
    }
    files.sort();
    for (hash, start, name) in files.iter() {
        match entries.binary_search_by_key(hash, |e| e.0) {
            Err(_) => faults.add("TZ04", name.clone(), format!("its hash in {INDEX}"), "none"),
            Ok(k) if entries[k].1 != *start => {
                let found = format!("byte {}", entries[k].1);
                faults.add("TZ05", name.clone(), format!("an offset to its header at byte {start}"), found);
            }
            Ok(_) => {}
        }
    }
    for (hash, offset) in &entries {
        if files.binary_search_by_key(hash, |f| f.0).is_err() {
            faults.add("TZ04", INDEX, "hashes of names in the archive", format!("{hash:032x} for byte {offset}"));
        }
    }
}
