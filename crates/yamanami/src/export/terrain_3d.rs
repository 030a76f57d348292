//! 3D Tiles of terrains: an implicit quadtree over a region of the globe, or over the terrain's own metres where its CRS is
//! not known. Tiles are cut with borders that are the same lines on both sides; there are no skirts.

use super::placement::Placement;
use super::terrain_tiles::{TILES_AT_ONCE, TerrainTiles, normals, trim};
use super::tileset_files::{TilePlace, TileRecord, TileTree, box_of, content_path, kept_content};
use super::{ExportJob, ExportOptions, ExportReport};
use crate::{Error, Subject, Terrain};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use yamanami_core::{Aabb, GeoReference, LatticeNode};
use yamanami_io::crs;
use yamanami_io::mesh_file::MeshMeta;
use yamanami_io::tiles::glb::{GlbFacts, LatticeMesh, TileClaim, encode_glb, step_below_m};
use yamanami_io::tiles::subtree::{TileBounds, TileFacts};
use yamanami_io::tiles::tileset::{BoundingVolume, Subdivision};
use yamanami_io::tiles::{TileFolder, TileOutput};
use yamanami_multires::tiles::{CutOptions, CutScratch, GRID, Placement as TileSpace, Tile, TilePiece};

/// Samples along the side of a leaf, at most: at the usual tolerance 20,000 to 60,000 triangles.
const LEAF_SAMPLES: f64 = 256.0;
/// The leaves' error in spacings of the samples when none is asked for.
const USUAL_TOLERANCE: f64 = 0.25;
/// Steps of the lattice in the leaves' error.
const STEPS_AN_ERROR: f64 = 32.0;
/// No place of the ellipsoid curves more sharply, less what a geoid bends.
const RADIUS_M: f64 = 6_300_000.0;
/// Room before and after the data, in parts of their size; not alike, lest a tile's wall and a row of samples be almost one.
const ROOM: [f64; 2] = [0.71e-4, 1.37e-4];
/// Places along a border that are looked at for how far it bulges.
const LOOKS: usize = 65;

/// The square that is divided: its south-west and size, in degrees or in metres.
#[derive(Debug, Clone, Copy)]
struct Square {
    low: [f64; 2],
    size: [f64; 2],
}

/// Where tiles stand.
pub(super) struct Ground {
    pub placement: Option<Placement>,
    square: Square,
    pub space: TileSpace,
    last: u32,
    pub step_m: f64,
}

/// Writes the tiles, subtrees and `tileset.json` of a terrain.
pub(super) fn write(terrain: &mut Terrain, job: &ExportJob<'_>, folder: &TileFolder) -> Result<ExportReport, Error> {
    let mut notes = Vec::new();
    let (ground, cut) = Ground::of(terrain, job.options, &mut notes)?;
    let mut report = ExportReport { notes, ..ExportReport::default() };
    let mut tiles = BTreeMap::new();
    let all: Vec<Tile> = {
        let cutter = TerrainTiles::new(terrain, &ground.space, &cut);
        (0..=ground.last).flat_map(|zoom| cutter.tiles(zoom)).collect()
    };
    for (done, batch) in all.chunks(TILES_AT_ONCE).enumerate() {
        let cutter = TerrainTiles::new(terrain, &ground.space, &cut);
        let made: Vec<Option<(TileRecord, bool)>> = batch
            .par_iter()
            .map_init(CutScratch::default, |scratch, &tile| ground.make(terrain, &cutter, tile, scratch, folder, job))
            .collect::<Result<_, Error>>()?;
        for (tile, made) in batch.iter().zip(made) {
            if let Some((record, kept)) = made {
                tiles.insert((tile.zoom, [tile.x, tile.y, 0]), record);
                report.kept += u64::from(kept);
            }
        }
        trim(terrain);
        (job.progress)(((done + 1) * TILES_AT_ONCE).min(all.len()) as f32 / all.len() as f32);
    }
    if tiles.is_empty() {
        return Err(Error::Request(format!("{}: has no data to write", terrain.title())));
    }
    let mut tree = TileTree {
        subdivision: Subdivision::Quadtree,
        tiles,
        root_volume: BoundingVolume::default(),
        transform: ground.placement.as_ref().map(Placement::transform),
        size_m: terrain.bounds().diagonal(),
    };
    tree.nest();
    tree.root_volume = ground.root_volume(&tree);
    tree.write(folder, terrain.title())?;
    report.zooms = tree.zooms();
    Ok(report)
}

/// The box of a terrain in the coordinates of its CRS.
fn source_bounds(terrain: &Terrain) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    terrain.bounds().corners().into_iter().for_each(|p| bounds.include(terrain.source_from_local(p)));
    bounds
}

/// Degrees of a column and row, or metres from the first sample.
fn plane(geo: &GeoReference, placement: Option<&Placement>, [column, row]: [f64; 2]) -> [f64; 2] {
    match placement {
        Some(placement) => {
            let [x, y] = geo.source_from_grid(column, row);
            placement.lon_lat_deg(DVec3::new(x, y, 0.0)).unwrap_or([f64::NAN; 2])
        }
        None => geo.local_from_grid(column, row),
    }
}

impl Square {
    /// Around all samples, as wide on the ground as it is high.
    fn around(terrain: &Terrain, placement: Option<&Placement>) -> Self {
        let [columns, rows] = terrain.size().map(|n| (n - 1) as f64);
        let mut range = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for k in 0..LOOKS {
            let share = k as f64 / (LOOKS - 1) as f64;
            for at in [
                [share * columns, 0.0],
                [share * columns, rows],
                [0.0, share * rows],
                [columns, share * rows],
            ] {
                let [x, y] = plane(terrain.geo(), placement, at);
                range = [range[0].min(x), range[1].min(y), range[2].max(x), range[3].max(y)];
            }
        }
        let size = [range[2] - range[0], range[3] - range[1]].map(|s| s * (1.0 + ROOM[0] + ROOM[1]));
        let middle = [0, 1].map(|k| 0.5 * (range[k] + range[k + 2]) + 0.5 * (ROOM[1] - ROOM[0]) * size[k]);
        // on the globe a square of degrees is narrower towards the poles
        let narrow = placement.map_or(1.0, |_| middle[1].to_radians().cos().max(0.02));
        let side = (size[0] * narrow).max(size[1]);
        let size = match placement {
            Some(_) => [(side / narrow).min(360.0), side.min(180.0)],
            None => [side; 2],
        };
        let mut low = [middle[0] - 0.5 * size[0], middle[1] - 0.5 * size[1]];
        if placement.is_some() {
            low[1] = low[1].clamp(-90.0, 90.0 - size[1]);
        }
        Self { low, size }
    }

    fn tile_space(&self, p: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| (p[axis] - self.low[axis]) / self.size[axis])
    }

    fn plane(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.low[axis] + at[axis] * self.size[axis])
    }

    /// Where the samples lie in the square.
    fn space(&self, terrain: &Terrain, placement: Option<&Placement>) -> TileSpace {
        let (geo, size, square) = (terrain.geo().clone(), terrain.size().map(|n| n as u32), *self);
        let forward = {
            let (geo, placement) = (geo.clone(), placement.cloned());
            move |at: [f64; 2]| square.tile_space(plane(&geo, placement.as_ref(), at))
        };
        if placement.is_none() || geo.crs.geographic || geo.crs.web_mercator {
            let x = (0..size[0]).map(|c| forward([f64::from(c), 0.0])[0]).collect();
            let y = (0..size[1]).map(|r| forward([0.0, f64::from(r)])[1]).collect();
            return TileSpace::axes(x, y);
        }
        TileSpace::warped(size, forward, move |at| {
            let [lon, lat] = square.plane(at);
            crs::from_lon_lat(&geo.crs, lon, lat).map_or([f64::NAN; 2], |[x, y]| geo.grid_from_source(x, y))
        })
    }
}

impl Ground {
    /// Finds a terrain's place and divides it; says how it is to be cut.
    pub(super) fn of(
        terrain: &Terrain,
        options: &ExportOptions,
        notes: &mut Vec<String>,
    ) -> Result<(Self, CutOptions), Error> {
        let geo = terrain.geo();
        let placement = Placement::of(&geo.crs, &source_bounds(terrain), options.heights, &options.geoid, notes)?;
        if placement.is_none() {
            notes.push(
                "the CRS is not known: the tiles are in metres from the first sample, not on the globe".to_owned(),
            );
        }
        let tolerance_m = options.tolerance_m.unwrap_or(USUAL_TOLERANCE * geo.step_m[0].max(geo.step_m[1]));
        let square = Square::around(terrain, placement.as_ref());
        let space = square.space(terrain, placement.as_ref());
        let longest = terrain.size().into_iter().max().unwrap_or(2) as f64;
        let usual = (longest / LEAF_SAMPLES).log2().ceil().max(0.0) as u32;
        let last = options.zooms.map_or(usual, |[_, last]| last);
        let cut = CutOptions {
            zooms: [0, last],
            tolerance_m,
            globe_radius_m: placement.as_ref().map(|_| RADIUS_M),
            height_range_m: terrain.range_m().map(f64::from),
            fill_m: None,
        };
        let [width_m, height_m] = terrain.extent_m();
        let size = Aabb { min: DVec3::ZERO, max: DVec3::new(width_m, height_m, 0.0) };
        let step_m = step_below_m(tolerance_m / STEPS_AN_ERROR, &size);
        Ok((Self { placement, square, space, last, step_m }, cut))
    }

    /// What a tile is sure of: the error of its piece, and a step along each axis.
    pub(super) fn error_m(&self, piece: &TilePiece) -> f64 {
        piece.error_m + 3f64.sqrt() * self.step_m
    }

    /// Cuts a tile and writes it, unless it is there; `None` when there is nothing in it.
    fn make(
        &self,
        terrain: &Terrain,
        cutter: &TerrainTiles<'_>,
        tile: Tile,
        scratch: &mut CutScratch,
        folder: &TileFolder,
        job: &ExportJob<'_>,
    ) -> Result<Option<(TileRecord, bool)>, Error> {
        let place: TilePlace = (tile.zoom, [tile.x, tile.y, 0]);
        if let Some((facts, bytes)) = kept_content(folder, Subdivision::Quadtree, place) {
            return Ok(Some((self.record(tile, &facts, bytes), true)));
        }
        let piece = cutter.cut(tile, scratch)?;
        if piece.is_empty() {
            return Ok(None);
        }
        let (mesh, height_range_m) = self.mesh(tile, &piece, terrain)?;
        let claim = TileClaim { error_m: self.error_m(&piece), height_range_m };
        let file = encode_glb(&mesh, job.options.packing, &MeshMeta::default(), &claim);
        folder.put(&content_path(Subdivision::Quadtree, place), &file)?;
        Ok(GlbFacts::of(&file).map(|facts| (self.record(tile, &facts, file.len()), false)))
    }

    /// A tile on the lattice of all, and its lowest and highest above the ellipsoid.
    pub(super) fn mesh(
        &self,
        tile: Tile,
        piece: &TilePiece,
        terrain: &Terrain,
    ) -> Result<(LatticeMesh, Option<[f64; 2]>), Error> {
        let mut mesh =
            LatticeMesh { step_m: self.step_m, triangles: piece.triangles.clone(), ..LatticeMesh::default() };
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for (&place, &z) in piece.places.iter().zip(&piece.heights_m) {
            let at = self.square.plane(tile_place(tile, place));
            let (p, height_m) = match &self.placement {
                Some(placement) => {
                    let height_m = placement.ellipsoidal_m(at, z);
                    (placement.local_from_geographic(at, height_m), height_m)
                }
                None => (DVec3::new(at[0], at[1], z), z),
            };
            if !p.is_finite() {
                return Err(Error::Request(format!("the geoid has no height at {:.5}, {:.5}", at[0], at[1])));
            }
            range = [range[0].min(height_m), range[1].max(height_m)];
            mesh.places.push((p / self.step_m).round().to_array().map(|c| c as i64));
        }
        mesh.normals = self.normals(tile, piece, terrain)?;
        Ok((mesh, self.placement.as_ref().map(|_| range)))
    }

    /// Normals from the heights around each vertex, at the spacing of the tile's zoom: the same on both sides of a border.
    fn normals(&self, tile: Tile, piece: &TilePiece, terrain: &Terrain) -> Result<Vec<[f32; 3]>, Error> {
        let geo = terrain.geo();
        let level = self.last - tile.zoom;
        let places = piece.places.iter().map(|&place| tile_place(tile, place));
        let found = normals(terrain, &self.space, level, places)?;
        let turned = |(&place, (node, normal)): (&[u16; 2], (LatticeNode, [f32; 3]))| {
            let spacing = f64::from(1u32 << node.level);
            let at = self.square.plane(tile_place(tile, place));
            match &self.placement {
                // rows and columns run east and south
                Some(placement) if geo.crs.geographic || geo.crs.web_mercator => placement.turned_at(at, normal),
                Some(placement) => {
                    let column = spacing * f64::from(node.x);
                    let [x, y] = geo.source_from_grid(column, spacing * f64::from(node.y));
                    placement.turned(DVec3::new(x, y, 0.0), normal)
                }
                None => normal,
            }
        };
        Ok(piece.places.iter().zip(found).map(turned).collect())
    }

    fn record(&self, tile: Tile, facts: &GlbFacts, bytes: usize) -> TileRecord {
        let error_m = facts.claim.error_m;
        let bounds = match facts.claim.height_range_m {
            Some([low, high]) => {
                let corner = |x: u32, y: u32| {
                    let scale = f64::from(1u32 << tile.zoom);
                    self.square
                        .plane([f64::from(tile.x + x) / scale, f64::from(tile.y + y) / scale])
                        .map(f64::to_radians)
                };
                let ([west, south], [east, north]) = (corner(0, 0), corner(1, 1));
                // straight edges lie below the round ground by less than the error
                TileBounds::Region([west, south, east, north, low - error_m, high + self.step_m])
            }
            None => {
                let step = DVec3::splat(0.5 * self.step_m);
                let bounds = Aabb { min: facts.bounds.min - step, max: facts.bounds.max + step };
                TileBounds::Box(box_of(&bounds, 0.0))
            }
        };
        TileRecord {
            facts: TileFacts { bounds, error_m },
            has_content: true,
            triangles: facts.triangles,
            bytes: bytes as u64,
        }
    }

    /// The whole square, as high as all tiles.
    fn root_volume(&self, tree: &TileTree) -> BoundingVolume {
        let Square { low: [x, y], size: [w, h] } = self.square;
        match tree.tiles.values().next().map(|root| root.facts.bounds) {
            Some(TileBounds::Region([.., low, high])) => {
                let [west, south, east, north] = [x, y, x + w, y + h].map(f64::to_radians);
                BoundingVolume { region: Some([west, south, east, north, low, high]), ..BoundingVolume::default() }
            }
            Some(TileBounds::Box(root)) => {
                let (low, high) = (root[2] - root[11], root[2] + root[11]);
                let whole = Aabb { min: DVec3::new(x, y, low), max: DVec3::new(x + w, y + h, high) };
                BoundingVolume { oriented_box: Some(box_of(&whole, 0.0)), ..BoundingVolume::default() }
            }
            None => BoundingVolume::default(),
        }
    }
}

/// Tile space of a place of a tile's lattice. It is worked out from whole numbers, so that tiles that share a place agree on it
/// to the last bit, whatever their zooms.
pub(super) fn tile_place(tile: Tile, [u, v]: [u16; 2]) -> [f64; 2] {
    let along = |tile_at: u32, k: u16, zoom: u32| {
        (u64::from(tile_at) * u64::from(GRID) + u64::from(k)) as f64 / (f64::from(GRID) * f64::from(1u32 << zoom))
    };
    [along(tile.x, u, tile.zoom), along(tile.y, v, tile.zoom)]
}
