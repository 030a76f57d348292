//! `tileset.json` of 3D Tiles 1.1.
//!
//! Based on: "3D Tiles Specification 1.1", Open Geospatial Consortium 22-025r4, 2023.

use crate::IoError;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Longest text that is read, bytes.
const MOST_BYTES: usize = 1 << 28;
/// Most levels of tiles: places of tiles are numbers of 32 bits.
const MOST_LEVELS: u32 = 32;
/// Most tiles in the finest level of a subtree.
const MOST_SUBTREE_BITS: u32 = 24;

/// A tileset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Tileset {
    /// The format's version, and who wrote it.
    pub asset: Asset,
    /// What the tiles' metadata mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<serde_json::Value>,
    /// Error of showing nothing at all, metres.
    pub geometric_error: f64,
    /// The coarsest tile.
    pub root: Tile,
    /// Names of extensions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub extensions_used: Vec<String>,
    /// Anything else.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extras: Option<serde_json::Value>,
}

/// About the tileset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Asset {
    /// `1.1`.
    pub version: String,
    /// The writing program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub generator: Option<String>,
    /// Who is to be named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub copyright: Option<String>,
}

/// A tile, or the pattern of all tiles below it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Tile {
    /// Holds all of it.
    pub bounding_volume: BoundingVolume,
    /// Error of showing this tile instead of its source, metres.
    pub geometric_error: f64,
    /// `REPLACE` or `ADD`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refine: Option<String>,
    /// From its coordinates to its parent's, column by column.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transform: Option<[f64; 16]>,
    /// Its file, or the pattern of files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<Content>,
    /// How the tiles below are numbered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub implicit_tiling: Option<ImplicitTiling>,
    /// The tiles below, where they are written out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<Tile>,
}

/// A box (centre and three half axes, metres) or a region (west, south, east, north, radians; lowest and highest, metres).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundingVolume {
    /// Centre and half axes.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub oriented_box: Option<[f64; 12]>,
    /// On the ellipsoid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<[f64; 6]>,
    /// Centre and radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<[f64; 4]>,
}

/// A tile's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Content {
    /// Relative to the tileset; `{level}`, `{x}`, `{y}` and `{z}` stand for a tile's place.
    pub uri: String,
    /// Holds what is in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bounding_volume: Option<BoundingVolume>,
}

/// Tiles by number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ImplicitTiling {
    /// In four or in eight.
    pub subdivision_scheme: Subdivision,
    /// Levels of a subtree.
    pub subtree_levels: u32,
    /// Levels in all.
    pub available_levels: u32,
    /// Where subtrees are.
    pub subtrees: SubtreeFiles,
}

/// Pattern of the files of subtrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SubtreeFiles {
    /// Like [`Content::uri`].
    pub uri: String,
}

/// In how many parts a tile is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Subdivision {
    /// Four, in plan.
    Quadtree,
    /// Eight.
    Octree,
}

impl Subdivision {
    /// Axes that are halved.
    pub fn axes(self) -> u32 {
        match self {
            Self::Quadtree => 2,
            Self::Octree => 3,
        }
    }

    /// The names in a path of this division, e.g. `{level}/{x}/{y}`.
    pub fn pattern(self) -> &'static str {
        match self {
            Self::Quadtree => "{level}/{x}/{y}",
            Self::Octree => "{level}/{x}/{y}/{z}",
        }
    }

    /// The same with a tile's place.
    pub fn path(self, level: u32, [x, y, z]: [u32; 3]) -> String {
        match self {
            Self::Quadtree => format!("{level}/{x}/{y}"),
            Self::Octree => format!("{level}/{x}/{y}/{z}"),
        }
    }
}

impl Tileset {
    /// As text.
    pub fn to_json(&self) -> Vec<u8> {
        // numbers, texts and lists always become JSON
        serde_json::to_vec_pretty(self).unwrap_or_default()
    }

    /// Reads and checks a text; `name` is for messages.
    pub fn read(name: &Path, bytes: &[u8]) -> Result<Self, IoError> {
        if bytes.len() > MOST_BYTES {
            return Err(IoError::too_large(name, "bytes of a tileset", bytes.len() as u64, MOST_BYTES as u64));
        }
        let tileset: Self = serde_json::from_slice(bytes).map_err(|e| {
            IoError::malformed(name, format!("line {}", e.line()), "a tileset of 3D Tiles", e.to_string())
        })?;
        let version = &tileset.asset.version;
        if version != "1.1" && version != "1.0" {
            return Err(IoError::malformed(name, "asset.version", "1.0 or 1.1", version.clone()));
        }
        if let Some(implicit) = &tileset.root.implicit_tiling {
            implicit.check(name)?;
        }
        Ok(tileset)
    }
}

impl ImplicitTiling {
    fn check(&self, name: &Path) -> Result<(), IoError> {
        let most = MOST_SUBTREE_BITS / self.subdivision_scheme.axes();
        if !(1..=most).contains(&self.subtree_levels) {
            let (expected, found) = (format!("1 to {most}"), self.subtree_levels.to_string());
            return Err(IoError::malformed(name, "subtreeLevels", expected, found));
        }
        if !(1..=MOST_LEVELS).contains(&self.available_levels) {
            let (expected, found) = (format!("1 to {MOST_LEVELS}"), self.available_levels.to_string());
            return Err(IoError::malformed(name, "availableLevels", expected, found));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn tileset() -> Tileset {
        Tileset {
            asset: Asset { version: "1.1".to_owned(), generator: Some("yamanami".to_owned()), copyright: None },
            schema: None,
            geometric_error: 100.0,
            root: Tile {
                bounding_volume: BoundingVolume {
                    region: Some([-2.1, 0.59, -2.0, 0.6, 0.0, 900.0]),
                    ..BoundingVolume::default()
                },
                geometric_error: 50.0,
                refine: Some("REPLACE".to_owned()),
                content: Some(Content { uri: "content/{level}/{x}/{y}.glb".to_owned(), bounding_volume: None }),
                implicit_tiling: Some(ImplicitTiling {
                    subdivision_scheme: Subdivision::Quadtree,
                    subtree_levels: 4,
                    available_levels: 6,
                    subtrees: SubtreeFiles { uri: "subtrees/{level}/{x}/{y}.subtree".to_owned() },
                }),
                ..Tile::default()
            },
            extensions_used: Vec::new(),
            extras: None,
        }
    }

    #[test]
    fn a_tileset_comes_back() {
        let bytes = tileset().to_json();
        let text: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
        assert_eq!(text["root"]["implicitTiling"]["subdivisionScheme"], json!("QUADTREE"));
        assert_eq!(text["root"]["boundingVolume"]["region"][5], json!(900.0));
        assert!(text["root"].get("children").is_none() && text.get("extras").is_none());
        assert_eq!(Tileset::read(Path::new("t"), &bytes).unwrap(), tileset());
    }

    #[test]
    fn nonsense_is_refused_in_one_line() {
        let complaint = |spoil: &dyn Fn(&mut Tileset)| {
            let mut set = tileset();
            spoil(&mut set);
            Tileset::read(Path::new("t"), &set.to_json()).unwrap_err().to_string()
        };
        assert!(complaint(&|t| t.asset.version = "7".to_owned()).contains("asset.version"));
        let implicit = |t: &mut Tileset, change: &dyn Fn(&mut ImplicitTiling)| {
            t.root.implicit_tiling.as_mut().map(change).unwrap_or_default();
        };
        assert!(complaint(&|t| implicit(t, &|i| i.subtree_levels = 40)).contains("1 to 12"));
        assert!(complaint(&|t| implicit(t, &|i| i.available_levels = 0)).contains("availableLevels"));
        assert!(Tileset::read(Path::new("t"), b"{\"asset\":{").is_err());
    }
}
