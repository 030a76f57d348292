//! The surfaces that are served, by names that are no paths.

use crate::error::ServeError;
use crate::fault::Fault;
use crate::reply::Content;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use std::time::SystemTime;
use tokio::sync::OnceCell;
use yamanami::io::pack::PackSource;
use yamanami::io::pack::layout::PackKind;
use yamanami::{ExportOptions, HeightTiles, MeshTiles, SurfaceHeights};

/// Side of map tiles, pixels.
pub(crate) const TILE_PX: u32 = 256;

/// A surface that is served.
#[derive(Debug)]
pub(crate) struct Served {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) kind: PackKind,
    pub(crate) path: PathBuf,
    pub(crate) source: PackSource,
    /// Of a terrain.
    pub(crate) ground: Option<SurfaceHeights<'static>>,
    pub(crate) info: Value,
    /// Of a terrain whose place on the globe is known, once it was asked for.
    pub(crate) meshes: OnceLock<Result<MeshTiles, Fault>>,
    pub(crate) picture: OnceCell<Content>,
    stamp: Option<Stamp>,
}

/// By what a file is known to be the same.
#[derive(Debug, PartialEq, Eq)]
struct Stamp {
    bytes: u64,
    modified: Option<SystemTime>,
    #[cfg(unix)]
    inode: [u64; 2],
}

impl Stamp {
    fn of(path: &Path) -> Option<Self> {
        #[cfg(unix)]
        use std::os::unix::fs::MetadataExt;
        let meta = std::fs::metadata(path).ok()?;
        Some(Self {
            bytes: meta.len(),
            modified: meta.modified().ok(),
            #[cfg(unix)]
            inode: [meta.dev(), meta.ino()],
        })
    }
}

/// All that is served.
#[derive(Debug, Default)]
pub struct Surfaces {
    pub(crate) all: Vec<Arc<Served>>,
    by_name: BTreeMap<String, Arc<Served>>,
}

impl Surfaces {
    /// Opens a `.yama` and adds it under a name made of its own.
    pub fn add(&mut self, path: &Path) -> Result<(), ServeError> {
        let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        let name = self.free_name(&stem);
        let served = Arc::new(Served::open(path, name)?);
        self.by_name.insert(served.name.clone(), served.clone());
        self.all.push(served);
        Ok(())
    }

    /// The names under which surfaces are served.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.all.iter().map(|served| served.name.as_str())
    }

    pub(crate) fn get(&self, name: &str) -> Result<&Arc<Served>, Fault> {
        self.by_name.get(name).ok_or_else(|| Fault::not_found("there is no such surface"))
    }

    /// Small letters, digits and dashes, as no other surface has it.
    fn free_name(&self, stem: &str) -> String {
        let plain: String =
            stem.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect();
        let words: Vec<&str> = plain.split('-').filter(|word| !word.is_empty()).collect();
        let name: String = if words.is_empty() { "surface".into() } else { words.join("-") };
        let name: String = name.chars().take(60).collect();
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        std::iter::once(name.clone()).chain(numbered).find(|n| !self.by_name.contains_key(n)).unwrap_or(name)
    }
}

impl Served {
    fn open(path: &Path, name: String) -> Result<Self, ServeError> {
        let stamp = Stamp::of(path);
        let source = PackSource::open(path)?;
        let head = source.head();
        let kind = head.kind;
        let ground = if kind == PackKind::Terrain { Some(SurfaceHeights::open(path)?) } else { None };
        let title = if head.title.is_empty() { name.clone() } else { head.title.clone() };
        let info = info(&name, &title, &source, ground.as_ref());
        Ok(Self {
            name,
            title,
            kind,
            path: path.to_owned(),
            source,
            ground,
            info,
            meshes: OnceLock::new(),
            picture: OnceCell::new(),
            stamp,
        })
    }

    /// That the file is still the one that was opened.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        if Stamp::of(&self.path) == self.stamp { Ok(()) } else { Err(Fault::gone(&self.name)) }
    }

    /// The terrain, if it is one.
    pub(crate) fn ground(&self) -> Result<&SurfaceHeights<'static>, Fault> {
        self.ground.as_ref().ok_or_else(|| Fault::not_found(format!("{} is no elevation grid", self.name)))
    }

    /// The terrain as map tiles.
    pub(crate) fn tiles(&self) -> Result<HeightTiles<'_>, Fault> {
        HeightTiles::new(self.ground()?, TILE_PX)
            .map_err(|_| Fault::not_found(format!("{}: longitudes and latitudes are not known for its CRS", self.name)))
    }

    /// The terrain as quantized-mesh tiles.
    pub(crate) fn meshes(&self) -> Result<&MeshTiles, Fault> {
        self.tiles()?;
        let open = || MeshTiles::open(self.path.clone(), ExportOptions::default()).map_err(|e| self.unreadable(e));
        self.meshes.get_or_init(open).as_ref().map_err(Clone::clone)
    }

    /// A fault of reading it.
    pub(crate) fn unreadable(&self, error: impl Into<yamanami::Error>) -> Fault {
        // why it cannot be read is most often that it is no longer there
        self.check().err().unwrap_or_else(|| Fault::unreadable(&self.name, &error.into()))
    }

    /// Its tag, as headers have it.
    pub(crate) fn tag(&self) -> String {
        format!("\"{:016x}\"", self.source.tag())
    }
}

/// What programs may want to know.
fn info(name: &str, title: &str, source: &PackSource, ground: Option<&SurfaceHeights<'_>>) -> Value {
    let head = source.head();
    let mut info = json!({
        "name": name,
        "title": title,
        "kind": head.kind,
        "bytes": head.bytes,
        "facts": head.meta,
        "pack": format!("/s/{name}/surface.pack"),
        "picture": format!("/s/{name}/picture.png"),
        "view": format!("/view/#s={name}"),
    });
    if let Some(ground) = ground {
        info["height"] = format!("/s/{name}/height").into();
        info["profile"] = format!("/s/{name}/profile").into();
        if let Ok(tiles) = HeightTiles::new(ground, TILE_PX) {
            info["bounds_deg"] = json!(tiles.bounds_deg());
            info["layer_json"] = format!("/s/{name}/quantized-mesh/layer.json").into();
            info["tilejson"] = format!("/s/{name}/terrain-rgb/tilejson.json").into();
        }
    }
    info
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_whatever_the_files_are_called() {
        let surfaces = Surfaces::default();
        let name = |stem: &str| surfaces.free_name(stem);
        assert_eq!(name("Mt. Fuji (5m)"), "mt-fuji-5m");
        assert_eq!(name("../../etc/passwd"), "etc-passwd");
        assert_eq!(name("富士山"), "surface");
        assert_eq!(name(""), "surface");
        assert_eq!(name(&"a".repeat(500)).len(), 60);
    }
}
