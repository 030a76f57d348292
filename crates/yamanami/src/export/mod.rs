//! Standard files for other programs' viewers: what all kinds share, and the way to each.

mod geodetic;
mod glb;
mod mesh_tiles;
mod model_cells;
mod model_tiles;
mod placement;
mod quantized_mesh;
mod terrain_3d;
mod terrain_rgb;
mod terrain_tiles;
#[cfg(test)]
mod tests_3d;
mod tiles3d;
mod tileset_files;

pub use placement::{GeoidChoice, HeightKind};
pub use yamanami_io::tiles::glb::GlbPacking;

pub use mesh_tiles::MeshTiles;

use crate::{Error, Model, Terrain};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;
use yamanami_io::dem::TileEncoding;

/// What to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ExportKind {
    /// A folder of 3D Tiles 1.1.
    Tiles3d,
    /// The same in one archive (3tz).
    Tiles3tz,
    /// A folder of quantized-mesh 1.0 tiles with `layer.json`.
    QuantizedMesh,
    /// Heights as colours of PNG tiles: a folder, or one PMTiles archive.
    TerrainRgb,
    /// One binary glTF.
    Glb,
}

/// What is written.
#[derive(Debug)]
pub enum ExportSubject<'a> {
    /// Ground.
    Terrain(&'a mut Terrain),
    /// A scan or a TIN.
    Model(&'a mut Model),
}

/// What tiles hold where there is no data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fill {
    /// Ground at this height above the ellipsoid, metres.
    At(f64),
    /// Nothing.
    Nothing,
}

/// How to write. What a kind has no use for it ignores.
#[derive(Debug, Clone)]
pub struct ExportOptions {
    /// Largest error of the finest zoom, metres; else as the spacing of the samples asks for.
    pub tolerance_m: Option<f64>,
    /// Coarsest and finest zoom; else all that the data ask for.
    pub zooms: Option<[u32; 2]>,
    /// What lies where there is no data.
    pub fill: Fill,
    /// Whether vertices carry normals.
    pub normals: bool,
    /// From where the source's heights count; else as it says, or from the ellipsoid.
    pub heights: Option<HeightKind>,
    /// The geoid from which they count.
    pub geoid: GeoidChoice,
    /// How glTF is packed.
    pub packing: GlbPacking,
    /// Most triangles of one glTF.
    pub budget_triangles: Option<u32>,
    /// What the colours of terrain-rgb mean.
    pub tile_encoding: TileEncoding,
    /// Pixels along a side of terrain-rgb tiles.
    pub tile_px: u32,
    /// Whether every sample is measured against what was written; slow.
    pub check: bool,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self {
            tolerance_m: None,
            zooms: None,
            fill: Fill::At(0.0),
            normals: false,
            heights: None,
            geoid: GeoidChoice::default(),
            packing: GlbPacking::default(),
            budget_triangles: None,
            tile_encoding: TileEncoding::TerrainRgb,
            tile_px: 256,
            check: false,
        }
    }
}

/// One export.
#[derive(Clone, Copy)]
pub struct ExportJob<'a> {
    /// The input files, for telling whether an unfinished tree is of the same job.
    pub sources: &'a [PathBuf],
    /// The file or folder to write.
    pub output: &'a Path,
    /// How.
    pub options: &'a ExportOptions,
    /// Hears of the share done, 0 to 1, from any thread.
    pub progress: &'a (dyn Fn(f32) + Sync),
}

impl std::fmt::Debug for ExportJob<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ExportJob").field("output", &self.output).finish_non_exhaustive()
    }
}

/// What was written of one zoom.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ZoomReport {
    /// The zoom.
    pub zoom: u32,
    /// Tiles.
    pub tiles: u64,
    /// Their triangles; 0 where tiles have none.
    pub triangles: u64,
    /// Their bytes as written.
    pub bytes: u64,
    /// No sample is further from the tiles than that, metres.
    pub error_m: f64,
    /// The same as measured, where that was asked for, metres.
    pub measured_m: Option<f64>,
}

/// What was written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExportReport {
    /// By zoom, coarse first; one entry where there are no zooms.
    pub zooms: Vec<ZoomReport>,
    /// Tiles that an earlier, unfinished run had written already.
    pub kept: u64,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// Writes a subject as files of a kind.
pub fn export(kind: ExportKind, subject: ExportSubject<'_>, job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    match kind {
        ExportKind::Tiles3d => tiles3d::folder(subject, job),
        ExportKind::Tiles3tz => tiles3d::archive(subject, job),
        ExportKind::QuantizedMesh => quantized_mesh::folder(subject, job),
        ExportKind::TerrainRgb => terrain_rgb::tiles(subject, job),
        ExportKind::Glb => glb::file(subject, job),
    }
}

impl ExportJob<'_> {
    /// All that the tiles of a job depend on, as a text: an unfinished tree goes on only with the same.
    pub fn identity(&self, kind: ExportKind) -> String {
        let mut text = format!("yamanami {} {kind:?}\n{:?}\n", env!("CARGO_PKG_VERSION"), self.options);
        for source in self.sources {
            let (mut bytes, mut seconds) = (0, 0.0);
            if let Ok(meta) = std::fs::metadata(source) {
                bytes = meta.len();
                let modified = meta.modified().ok().and_then(|at| at.duration_since(UNIX_EPOCH).ok());
                seconds = modified.map_or(0.0, |since| since.as_secs_f64());
            }
            let path = std::fs::canonicalize(source).unwrap_or_else(|_| source.clone());
            // writing to a text does not fail
            let _ = writeln!(text, "{} {bytes} {seconds}", path.display());
        }
        text
    }
}

impl<'a> ExportSubject<'a> {
    /// The terrain of a kind that is for terrain alone.
    pub fn terrain(self, kind: &str) -> Result<&'a mut Terrain, Error> {
        match self {
            Self::Terrain(terrain) => Ok(terrain),
            Self::Model(_) => {
                Err(Error::Request(format!("{kind} is for elevation grids; scans and TINs go to 3dtiles, 3tz or glb")))
            }
        }
    }
}
