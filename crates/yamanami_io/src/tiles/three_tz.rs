//! 3tz archives: a tileset as one zip whose last member is an index by the hash of each path.
//!
//! Based on: "3TZ Specification 1.3", Maxar and Cesium. The index has 24 bytes a file, the MD5 of its path and where its
//! local header begins, in the order of the hashes read as two little-endian words.

use crate::IoError;
use md5::{Digest, Md5};
use std::fs::{self, File};
use std::io::{Error, Read, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// Name of the index.
pub const INDEX_NAME: &str = "@3dtilesIndex1@";

/// Packs the files of a folder; names that begin with a dot stay out. `path` appears whole or not at all.
pub fn pack_3tz(folder: &Path, path: &Path) -> Result<(), IoError> {
    let mut names = Vec::new();
    list(folder, "", &mut names)?;
    // a reader of the stream meets the description first
    names.sort_by_key(|name| (name != "tileset.json", name.clone()));
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    let packed = write(folder, &names, &part).and_then(|()| fs::rename(&part, path)).map_err(|e| IoError::io(path, e));
    if packed.is_err() {
        // the first failure is the one to report
        let _ = fs::remove_file(&part);
    }
    packed
}

/// Paths of all files below a folder, relative, divided by `/`.
fn list(folder: &Path, prefix: &str, names: &mut Vec<String>) -> Result<(), IoError> {
    for entry in fs::read_dir(folder).map_err(|e| IoError::io(folder, e))? {
        let entry = entry.map_err(|e| IoError::io(folder, e))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let kind = entry.file_type().map_err(|e| IoError::io(entry.path(), e))?;
        if kind.is_dir() {
            list(&entry.path(), &format!("{prefix}{name}/"), names)?;
        } else if !name.starts_with('.') {
            names.push(format!("{prefix}{name}"));
        }
    }
    Ok(())
}

fn write(folder: &Path, names: &[String], part: &Path) -> std::io::Result<()> {
    let file = File::options().read(true).write(true).create(true).truncate(true).open(part)?;
    let mut archive = ZipWriter::new(file);
    for name in names {
        let bytes = fs::read(folder.join(name))?;
        archive.start_file(name, options(if name.ends_with(".glb") { &[] } else { &bytes })).map_err(Error::other)?;
        archive.write_all(&bytes)?;
    }
    let archive = archive.finish_into_readable().map_err(Error::other)?;
    let (index, file) = index(archive)?;
    let mut archive = ZipWriter::new_append(file).map_err(Error::other)?;
    archive.start_file(INDEX_NAME, options(&[])).map_err(Error::other)?;
    archive.write_all(&index)?;
    archive.finish().map_err(Error::other)?.sync_all()
}

/// Glb tiles are packed already; the rest shrinks.
fn options(bytes: &[u8]) -> SimpleFileOptions {
    let method = if bytes.is_empty() { CompressionMethod::Stored } else { CompressionMethod::Deflated };
    SimpleFileOptions::default().compression_method(method)
}

/// The index of all members so far.
fn index(mut archive: ZipArchive<File>) -> std::io::Result<(Vec<u8>, File)> {
    let mut entries = Vec::with_capacity(archive.len());
    for k in 0..archive.len() {
        let member = archive.by_index_raw(k).map_err(Error::other)?;
        let hash: [u8; 16] = Md5::digest(member.name_raw()).into();
        entries.push((hash, member.header_start()));
    }
    entries.sort_by_key(|(hash, _)| order(hash));
    let index = entries.iter().flat_map(|(hash, at)| hash.iter().copied().chain(at.to_le_bytes())).collect();
    Ok((index, archive.into_inner()))
}

fn order(hash: &[u8; 16]) -> [u64; 2] {
    let (words, _) = hash.as_chunks::<8>();
    [u64::from_le_bytes(words[0]), u64::from_le_bytes(words[1])]
}

/// Reads one file of an archive by its index; `None` where it has none of that path.
pub fn read_3tz(path: &Path, name: &str) -> Result<Option<Vec<u8>>, IoError> {
    let file = File::open(path).map_err(|e| IoError::io(path, e))?;
    let bad = |place: &str, e: &dyn std::fmt::Display| IoError::malformed(path, place, "a 3tz archive", e.to_string());
    let mut archive = ZipArchive::new(file).map_err(|e| bad("directory", &e))?;
    let last = archive.len().checked_sub(1).ok_or_else(|| bad("directory", &"nothing"))?;
    let mut index = Vec::new();
    {
        let member = archive.by_index(last).map_err(|e| bad("last member", &e))?;
        if member.name_raw() != INDEX_NAME.as_bytes() {
            return Err(bad("last member", &String::from_utf8_lossy(member.name_raw())));
        }
        let most = 24 * last as u64;
        member.take(most + 1).read_to_end(&mut index).map_err(|e| bad(INDEX_NAME, &e))?;
    }
    let (entries, rest) = index.as_chunks::<24>();
    if !rest.is_empty() || entries.len() != last {
        return Err(bad(INDEX_NAME, &format!("{} bytes for {last} files", index.len())));
    }
    let hash: [u8; 16] = Md5::digest(name.as_bytes()).into();
    let hash_of = |entry: &[u8; 24]| -> [u8; 16] { std::array::from_fn(|k| entry[k]) };
    let Ok(found) = entries.binary_search_by_key(&order(&hash), |entry| order(&hash_of(entry))) else {
        return Ok(None);
    };
    let at = u64::from_le_bytes(std::array::from_fn(|k| entries[found][16 + k]));
    let mut member = archive.by_name(name).map_err(|e| bad(name, &e))?;
    if member.header_start() != at {
        return Err(bad(INDEX_NAME, &format!("{name} at {at}, which is at {}", member.header_start())));
    }
    let mut bytes = Vec::new();
    member.read_to_end(&mut bytes).map_err(|e| IoError::io(path, e))?;
    Ok(Some(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_archive_has_all_files_and_an_index_to_their_headers() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("tiles.part");
        fs::create_dir_all(folder.join("content/0/0")).unwrap();
        fs::write(folder.join("tileset.json"), "{}".repeat(50)).unwrap();
        fs::write(folder.join(".job"), "x").unwrap();
        for k in 0..9 {
            fs::write(folder.join(format!("content/0/0/{k}.glb")), vec![k; 100 + usize::from(k)]).unwrap();
        }
        let path = root.path().join("a.3tz");
        pack_3tz(&folder, &path).unwrap();
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 2);
        for k in 0..9 {
            let bytes = read_3tz(&path, &format!("content/0/0/{k}.glb")).unwrap().unwrap();
            assert_eq!(bytes, vec![k; 100 + usize::from(k)]);
        }
        assert_eq!(read_3tz(&path, "tileset.json").unwrap().unwrap(), "{}".repeat(50).as_bytes());
        assert_eq!(read_3tz(&path, ".job").unwrap(), None);
        // the last member is stored as it is, and each offset is that of a local header
        let file = fs::read(&path).unwrap();
        let mut archive = ZipArchive::new(std::io::Cursor::new(&file)).unwrap();
        assert_eq!(archive.len(), 11);
        let start = archive.by_index(10).unwrap().data_start().unwrap() as usize;
        for entry in file[start..start + 240].as_chunks::<24>().0 {
            let at = u64::from_le_bytes(std::array::from_fn(|k| entry[16 + k])) as usize;
            assert_eq!(&file[at..at + 4], b"PK\x03\x04");
        }
        assert!(read_3tz(&folder.join("tileset.json"), "x").is_err());
    }

    #[test]
    fn hashes_are_ordered_as_words() {
        assert!(order(&[0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0]) > order(&[9; 16].map(|_| 0)));
        assert!(
            order(&[255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 9])
                < order(&[0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])
        );
    }
}
