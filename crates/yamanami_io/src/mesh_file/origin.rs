//! Where a mesh is read from: its name for messages, its folder for the files it names, and what is worth telling.

use crate::IoError;
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use yamanami_core::{Material, Texture};

/// Most bytes of a file that a mesh file names: pictures, buffers, material libraries.
const BESIDE_LIMIT: u64 = 4 << 30;
/// Most different things told about a file; a hostile one could have a million.
const NOTES_LIMIT: usize = 20;

/// One file that is being read.
pub(super) struct Origin<'a> {
    pub(super) name: &'a Path,
    /// Where files beside it are looked for; `None` when only bytes were given.
    folder: Option<&'a Path>,
    notes: Vec<String>,
    pictures: HashMap<String, Option<Texture>>,
}

impl<'a> Origin<'a> {
    pub(super) fn new(name: &'a Path, folder: Option<&'a Path>) -> Self {
        Self { name, folder, notes: Vec::new(), pictures: HashMap::new() }
    }

    pub(super) fn bad(
        &self,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> IoError {
        IoError::malformed(self.name, place, expected, found)
    }

    /// Keeps something that the reader of the mesh may want to know, once.
    pub(super) fn note(&mut self, line: impl Into<String>) {
        let line = super::one_line(&line.into());
        if self.notes.len() < NOTES_LIMIT && !self.notes.contains(&line) {
            self.notes.push(line);
        }
    }

    pub(super) fn into_notes(self) -> Vec<String> {
        self.notes
    }

    /// A path that a file names, if it stays in the folder of that file.
    fn beside(&self, named: &str) -> Option<PathBuf> {
        let inner = Path::new(named);
        let stays = inner.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        (stays && !named.is_empty()).then_some(self.folder?.join(inner))
    }

    /// The bytes of a file beside this one; why not, otherwise.
    pub(super) fn read_beside(&self, named: &str) -> Result<Vec<u8>, String> {
        if self.folder.is_none() {
            return Err("only the bytes of one file were given".into());
        }
        let path = self.beside(named).ok_or("it lies outside the file's folder")?;
        let size = std::fs::metadata(&path).map_err(|e| e.to_string())?;
        if !size.is_file() || size.len() > BESIDE_LIMIT {
            return Err(format!("it is no file of at most {BESIDE_LIMIT} bytes"));
        }
        std::fs::read(&path).map_err(|e| e.to_string())
    }

    /// A picture that a material names. Absolute paths and those of other machines are tried by their last part.
    pub(super) fn picture(&mut self, named: &str) -> Option<Texture> {
        if let Some(known) = self.pictures.get(named) {
            return known.clone();
        }
        let name = file_name(named);
        let slashed = named.replace('\\', "/");
        let bytes = self.read_beside(&slashed).or_else(|why| self.read_beside(&name).map_err(|_| why));
        let texture = match bytes {
            Ok(bytes) if !name.is_empty() => Some(Texture { name, bytes: Arc::from(bytes) }),
            Ok(_) => None,
            Err(why) => {
                self.note(format!("texture '{named}' not read: {why}"));
                None
            }
        };
        self.pictures.insert(named.to_owned(), texture.clone());
        texture
    }

    /// A material that is a picture and nothing else, named like it.
    pub(super) fn picture_material(&mut self, named: &str) -> Material {
        let texture = self.picture(named);
        Material { name: file_name(named), texture, ..Material::default() }
    }
}

/// The last part of a path of any system.
pub(super) fn file_name(path: &str) -> String {
    path.rsplit(['/', '\\']).next().unwrap_or_default().trim().to_owned()
}
