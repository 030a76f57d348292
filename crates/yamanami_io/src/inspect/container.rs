//! Where the files of a tileset lie: in a folder, in a zip archive, or alone.
//!
//! Formats: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification", read by the zip crate.

use crate::IoError;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Most bytes of a file in a tileset.
pub const LIMIT_BYTES: u64 = 1 << 30;

/// Deepest folder below a tileset that is listed.
const DEEPEST: usize = 12;

/// The files of a tileset, named by paths with slashes.
#[derive(Debug)]
pub struct Container {
    path: PathBuf,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Folder,
    Zip(Box<Mutex<zip::ZipArchive<File>>>, BTreeMap<String, usize>),
}

impl Container {
    /// A folder.
    pub fn folder(path: &Path) -> Self {
        Self { path: path.to_owned(), kind: Kind::Folder }
    }

    /// A zip archive.
    pub fn zip(path: &Path) -> Result<Self, IoError> {
        let file = File::open(path).map_err(|e| IoError::io(path, e))?;
        let bad = |e: zip::result::ZipError| IoError::malformed(path, "directory", "a zip archive", e.to_string());
        let mut archive = zip::ZipArchive::new(file).map_err(bad)?;
        let mut names = BTreeMap::new();
        for k in 0..archive.len() {
            let name = archive.by_index_raw(k).and_then(|e| Ok(e.name()?.into_owned())).map_err(bad)?;
            names.insert(name, k);
        }
        Ok(Self { path: path.to_owned(), kind: Kind::Zip(Box::new(Mutex::new(archive)), names) })
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The bytes of a file; `None` where there is none of that name. Names that lead out of the container name nothing.
    pub fn read(&self, name: &str) -> Result<Option<Vec<u8>>, IoError> {
        let mut bytes = Vec::new();
        let label = self.path.join(name);
        let too_large = || IoError::too_large(&label, "bytes of a tile", LIMIT_BYTES + 1, LIMIT_BYTES);
        match &self.kind {
            Kind::Folder => {
                if !is_inside(name) {
                    return Ok(None);
                }
                let file = match File::open(&label) {
                    Ok(file) if file.metadata().is_ok_and(|m| m.is_file()) => file,
                    Ok(_) => return Ok(None),
                    Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
                    Err(e) => return Err(IoError::io(&label, e)),
                };
                file.take(LIMIT_BYTES + 1).read_to_end(&mut bytes).map_err(|e| IoError::io(&label, e))?;
            }
            Kind::Zip(archive, names) => {
                let Some(&number) = names.get(name) else { return Ok(None) };
                // a panic while it was held cannot have broken it: it only seeks
                let mut archive = archive.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                let bad = |e: String| IoError::malformed(&label, "archive", "an entry that can be read", e);
                let entry = archive.by_index(number).map_err(|e| bad(e.to_string()))?;
                entry.take(LIMIT_BYTES + 1).read_to_end(&mut bytes).map_err(|e| bad(e.to_string()))?;
            }
        }
        if bytes.len() as u64 > LIMIT_BYTES { Err(too_large()) } else { Ok(Some(bytes)) }
    }

    /// Whether there is a file of that name.
    pub fn has(&self, name: &str) -> bool {
        match &self.kind {
            Kind::Folder => is_inside(name) && self.path.join(name).is_file(),
            Kind::Zip(_, names) => names.contains_key(name),
        }
    }

    /// Names of all files, sorted.
    pub fn list(&self) -> Result<Vec<String>, IoError> {
        let mut names = Vec::new();
        match &self.kind {
            Kind::Folder => walk(&self.path, "", 0, &mut names)?,
            Kind::Zip(_, all) => names.extend(all.keys().filter(|n| !n.ends_with('/')).cloned()),
        }
        names.sort();
        Ok(names)
    }
}

fn is_inside(name: &str) -> bool {
    !name.starts_with('/') && !name.contains('\\') && name.split('/').all(|part| part != "..")
}

fn walk(folder: &Path, before: &str, depth: usize, names: &mut Vec<String>) -> Result<(), IoError> {
    let failed = |e| IoError::io(folder, e);
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = format!("{before}{}", entry.file_name().to_string_lossy());
        let kind = entry.file_type().map_err(failed)?;
        if kind.is_dir() && depth < DEEPEST {
            walk(&entry.path(), &format!("{name}/"), depth + 1, names)?;
        } else if kind.is_file() {
            names.push(name);
        }
    }
    Ok(())
}
