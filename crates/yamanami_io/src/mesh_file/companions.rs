//! The files beside a mesh file: pictures of its materials, under names that harm no other file.

use super::origin::file_name;
use super::{atomic, packing::Packing};
use crate::IoError;
use std::path::Path;
use std::sync::Arc;
use yamanami_core::{Texture, TriangleMesh};

/// The pictures of a mesh's materials.
#[derive(Default)]
pub(super) struct Pictures {
    /// Names and content, each once.
    files: Vec<(String, Arc<[u8]>)>,
    /// For each material its number in `files`.
    of_material: Vec<Option<usize>>,
}

impl Pictures {
    /// Names for all pictures of a mesh that is to be written at `path`. A file that is there already and is not the
    /// same picture keeps its name to itself.
    pub(super) fn of(path: &Path, mesh: &TriangleMesh) -> Self {
        let mut pictures = Self::default();
        for material in &mesh.materials {
            let number = material.texture.as_ref().map(|texture| pictures.number(path, texture));
            pictures.of_material.push(number);
        }
        pictures
    }

    fn number(&mut self, path: &Path, texture: &Texture) -> usize {
        let same = |(_, bytes): &(String, Arc<[u8]>)| Arc::ptr_eq(bytes, &texture.bytes) || *bytes == texture.bytes;
        if let Some(known) = self.files.iter().position(same) {
            return known;
        }
        let plain = word(&file_name(&texture.name), "texture");
        let stem = word(&path.file_stem().unwrap_or_default().to_string_lossy(), "mesh");
        let is_free = |name: &str| {
            let beside = path.with_file_name(name);
            let taken = self.files.iter().any(|(known, _)| known.eq_ignore_ascii_case(name)) || beside == path;
            let is_same = || {
                // only a file of the same length is worth reading
                let length = std::fs::metadata(&beside).map(|m| m.len());
                match length {
                    Ok(length) if length == texture.bytes.len() as u64 => {
                        std::fs::read(&beside).is_ok_and(|old| *old == *texture.bytes)
                    }
                    Ok(_) => false,
                    Err(_) => true,
                }
            };
            !taken && is_same()
        };
        let prefixed = format!("{stem}_{plain}");
        let numbered = (2..).map(|k| format!("{stem}_{k}_{plain}"));
        let mut names = [plain.clone(), prefixed].into_iter().chain(numbered);
        let name = names.find(|name| is_free(name)).unwrap_or_default();
        self.files.push((name, texture.bytes.clone()));
        self.files.len() - 1
    }

    /// Names of the pictures, by number.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(name, _)| name.as_str())
    }

    /// The number of a material's picture.
    pub(super) fn number_of(&self, material: usize) -> Option<usize> {
        self.of_material.get(material).copied().flatten()
    }

    /// The name of a material's picture.
    pub(super) fn name_of(&self, material: usize) -> Option<&str> {
        self.number_of(material).map(|k| self.files[k].0.as_str())
    }

    /// Writes those that are not there yet.
    pub(super) fn write(&self, path: &Path) -> Result<(), IoError> {
        for (name, bytes) in &self.files {
            let beside = path.with_file_name(name);
            if !beside.exists() {
                atomic::write(&beside, Packing::None, |out| out.write_all(bytes))?;
            }
        }
        Ok(())
    }
}

/// A name as one word, as OBJ and MTL files need it.
pub(super) fn word(name: &str, otherwise: &str) -> String {
    let word: String =
        name.chars().map(|c| if c.is_whitespace() || c.is_control() || c == '#' { '_' } else { c }).collect();
    if word.trim_matches(['_', '.']).is_empty() { otherwise.to_owned() } else { word }
}
