//! What a path is: by what lies in it and how files begin.

use crate::Error;
use std::io::Read;
use std::path::Path;
use yamanami_io::IoError;
use yamanami_io::inspect::{Container, LIMIT_BYTES};

/// Kinds of tilesets and tiles.
pub(super) enum Kind {
    QuantizedMesh,
    Terrain(Vec<u8>),
    /// Where it lies and the name of its document.
    Tileset(Container, String),
    ThreeTz,
    Glb(Vec<u8>),
    Raster,
    PmTiles,
}

/// Deepest folders that are looked into for a tile.
const DEEPEST: usize = 4;

impl Kind {
    pub(super) fn of(path: &Path) -> Result<Self, Error> {
        let failed = |e| IoError::io(path, e);
        if std::fs::metadata(path).map_err(failed)?.is_dir() {
            return Self::of_folder(path);
        }
        let mut bytes = Vec::new();
        let mut file = std::fs::File::open(path).map_err(failed)?;
        (&mut file).take(16).read_to_end(&mut bytes).map_err(failed)?;
        let ending = |e: &str| path.to_string_lossy().to_lowercase().trim_end_matches(".gz").ends_with(e);
        if bytes.starts_with(b"PMTiles") || ending(".pmtiles") {
            return Ok(Self::PmTiles);
        }
        if bytes.starts_with(b"PK") || ending(".3tz") {
            return Ok(Self::ThreeTz);
        }
        if ending(".json") {
            let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if name == "layer.json" {
                let text =
                    format!("{}: name the folder of a quantized-mesh pyramid, not its layer.json", path.display());
                return Err(Error::Request(text));
            }
            return Ok(Self::Tileset(Container::folder(folder), name));
        }
        file.take(LIMIT_BYTES).read_to_end(&mut bytes).map_err(failed)?;
        if bytes.starts_with(b"glTF") || ending(".glb") {
            return Ok(Self::Glb(bytes));
        }
        if ending(".terrain") {
            return Ok(Self::Terrain(bytes));
        }
        let expected =
            "expected a folder of tiles, tileset.json, .3tz, .pmtiles, .terrain or .glb, found something else";
        Err(Error::Request(format!("{}: {expected}", path.display())))
    }

    fn of_folder(path: &Path) -> Result<Self, Error> {
        if path.join("tileset.json").is_file() {
            return Ok(Self::Tileset(Container::folder(path), "tileset.json".into()));
        }
        if path.join("layer.json").is_file() {
            return Ok(Self::QuantizedMesh);
        }
        match ending_in(path, 0)?.as_deref() {
            Some("terrain") => Ok(Self::QuantizedMesh),
            Some(_) => Ok(Self::Raster),
            None => {
                let expected =
                    "expected layer.json, tileset.json or tiles named z/x/y.terrain or z/x/y.png, found none";
                Err(Error::Request(format!("{}: {expected}", path.display())))
            }
        }
    }
}

/// The ending of the first tile below a folder.
fn ending_in(folder: &Path, depth: usize) -> Result<Option<String>, Error> {
    let failed = |e| IoError::io(folder, e);
    let mut folders = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() {
            folders.push(path);
        } else if let Some(ending) = path.extension().and_then(|e| e.to_str())
            && ["terrain", "png"].contains(&ending)
        {
            return Ok(Some(ending.to_owned()));
        }
    }
    folders.sort();
    for folder in folders.iter().filter(|_| depth < DEEPEST) {
        if let Some(ending) = ending_in(folder, depth + 1)? {
            return Ok(Some(ending));
        }
    }
    Ok(None)
}
