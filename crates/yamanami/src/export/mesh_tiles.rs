//! quantized-mesh tiles one by one, as they are asked for, straight from a database.

use super::ExportOptions;
use super::geodetic::{Geodetic, ranges};
use super::quantized_mesh::{bytes_of, tiles_of};
use super::terrain_tiles::{TerrainTiles, trim};
use crate::{Error, OpenOptions, Terrain};
use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};
use yamanami_io::tiles::quantized_mesh::Layer;
use yamanami_multires::tiles::{CutScratch, Tile};

/// A terrain as a pyramid of quantized-mesh tiles; any number of threads may ask.
#[derive(Debug)]
pub struct MeshTiles {
    terrain: RwLock<Terrain>,
    geodetic: Geodetic,
    options: ExportOptions,
    layer: Layer,
}

impl MeshTiles {
    /// Opens a database. An error where its CRS does not lead to longitude and latitude.
    pub fn open(path: PathBuf, options: ExportOptions) -> Result<Self, Error> {
        let terrain = Terrain::open(&[path], &OpenOptions::default(), &|_| ())?;
        let geodetic = Geodetic::of(&terrain, &options, &mut Vec::new())?;
        let [first, last] = geodetic.options.zooms;
        let mut available = vec![Vec::new(); last as usize + 1];
        let cutter = TerrainTiles::new(&terrain, &geodetic.placement, &geodetic.options);
        for zoom in first..=last {
            let there: Vec<[u32; 2]> = tiles_of(&cutter, &geodetic, zoom).into_iter().map(Geodetic::wrapped).collect();
            available[zoom as usize] = ranges(&there);
        }
        let layer = Layer {
            name: terrain.title().to_owned(),
            attribution: String::new(),
            bounds_deg: geodetic.bounds_deg(),
            has_normals: options.normals,
            error_m: vec![None; available.len()],
            available,
        };
        Ok(Self { terrain: RwLock::new(terrain), geodetic, options, layer })
    }

    /// The text of `layer.json`.
    pub fn layer_json(&self) -> String {
        self.layer.to_json()
    }

    /// A tile as it is served, packed with gzip; `None` where there is none. Rows count from the south.
    pub fn tile(&self, zoom: u32, x: u32, y: u32) -> Result<Option<Vec<u8>>, Error> {
        let ranges = self.layer.available.get(zoom as usize).map(Vec::as_slice).unwrap_or_default();
        if !ranges.iter().any(|[x0, x1, y0, y1]| (*x0..=*x1).contains(&x) && (*y0..=*y1).contains(&y)) {
            return Ok(None);
        }
        let mut made = None;
        {
            let terrain = self.terrain.read().unwrap_or_else(PoisonError::into_inner);
            let cutter = TerrainTiles::new(&terrain, &self.geodetic.placement, &self.geodetic.options);
            // beyond the date line columns go on
            let [[_, east], _] = self.geodetic.placement.bounds();
            let beyond = Tile { zoom, x: x + (2 << zoom), y };
            let is_beyond = f64::from(beyond.x) < east * f64::from(1u32 << zoom);
            for tile in is_beyond.then_some(beyond).into_iter().chain([Tile { zoom, x, y }]) {
                let piece = cutter.cut(tile, &mut CutScratch::default())?;
                if !piece.is_empty() {
                    made = Some(bytes_of(&cutter, &piece, tile, self.options.normals)?);
                    break;
                }
            }
        }
        // while others cut, pages may be too many for a while
        if let Ok(mut terrain) = self.terrain.try_write() {
            trim(&mut terrain);
        }
        Ok(made)
    }
}
