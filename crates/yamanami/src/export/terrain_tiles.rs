//! Tiles of an opened terrain, whether it is in memory or read by pages.

use crate::{Data, Error, Terrain};
use glam::DVec3;
use yamanami_core::LatticeNode;
use yamanami_multires::tiles::{CutOptions, CutScratch, Cutter, Placement, Tile, TilePiece};
use yamanami_multires::wavelet::{GridData, PagedData, TerrainData};

/// Bytes of pages that a terrain keeps between two batches of tiles.
const PAGE_BYTES: usize = 256 << 20;

/// Tiles cut between two looks at how much memory the pages take.
pub(crate) const TILES_AT_ONCE: usize = 256;

/// Cuts tiles out of a terrain; from several threads.
#[derive(Debug)]
pub(crate) struct TerrainTiles<'a> {
    terrain: &'a Terrain,
    placement: &'a Placement,
    last: u32,
    cutter: Either<'a>,
}

#[derive(Debug)]
enum Either<'a> {
    Grid(Cutter<'a, GridData>),
    Paged(Cutter<'a, PagedData>),
}

impl<'a> TerrainTiles<'a> {
    pub(crate) fn new(terrain: &'a Terrain, placement: &'a Placement, options: &CutOptions) -> Self {
        let surface = terrain.surface();
        let (lattice, step_m) = (surface.numbers().lattice(), terrain.geo().step_m);
        let cutter = match surface.data() {
            Data::Grid(grid) => Either::Grid(Cutter::over(grid, lattice, step_m, placement, options)),
            Data::Paged(pages) => Either::Paged(Cutter::over(pages, lattice, step_m, placement, options)),
        };
        Self { terrain, placement, last: options.zooms[1], cutter }
    }

    /// The tiles of a zoom that the terrain's bounds reach into.
    pub(crate) fn tiles(&self, zoom: u32) -> Vec<Tile> {
        match &self.cutter {
            Either::Grid(cutter) => cutter.tiles(zoom).collect(),
            Either::Paged(cutter) => cutter.tiles(zoom).collect(),
        }
    }

    /// Normals of a tile's vertices, from heights as far apart as the samples of the finest zoom times what the tile is coarser.
    pub(crate) fn normals(&self, tile: Tile, piece: &TilePiece) -> Result<Vec<[f32; 3]>, Error> {
        let places = piece.places.iter().map(|&place| tile.place(place));
        let found = normals(self.terrain, self.placement, self.last - tile.zoom, places)?;
        Ok(found.into_iter().map(|(_, normal)| normal).collect())
    }

    /// Cuts a tile; reads the pages that it needs.
    pub(crate) fn cut(&self, tile: Tile, scratch: &mut CutScratch) -> Result<TilePiece, Error> {
        loop {
            let cut = match &self.cutter {
                Either::Grid(cutter) => cutter.cut(tile, scratch),
                Either::Paged(cutter) => cutter.cut(tile, scratch),
            };
            let absent = match cut {
                Ok(piece) => return Ok(piece),
                Err(absent) => absent,
            };
            load(self.terrain, absent.0)?;
        }
    }
}

/// Reads the pages of midpoints that are not in memory.
pub(crate) fn load(terrain: &Terrain, absent: Vec<LatticeNode>) -> Result<(), Error> {
    let (Data::Paged(pages), Some(store)) = (terrain.surface().data(), terrain.store()) else {
        return Err(Error::Request("this terrain has lost its database".to_owned()));
    };
    let mut wanted: Vec<_> = absent.into_iter().flat_map(|node| pages.needed_pages(node)).collect();
    wanted.sort_unstable();
    wanted.dedup();
    for id in wanted {
        if pages.page(id).is_none() {
            pages.insert(store.page(id)?);
        }
    }
    Ok(())
}

/// Normals (along columns eastwards, against rows northwards, up) of the ground at places of tile space, from the heights
/// around the nearest point of a level: a function of the place alone. With each, that point.
pub(crate) fn normals(
    terrain: &Terrain,
    placement: &Placement,
    level: u32,
    places: impl Iterator<Item = [f64; 2]>,
) -> Result<Vec<(LatticeNode, [f32; 3])>, Error> {
    let (step_m, data) = (terrain.geo().step_m, terrain.surface().data());
    let lattice = terrain.surface().numbers().lattice();
    let level = level.min(lattice.levels());
    let spacing = f64::from(1u32 << level);
    let points = lattice.points(level);
    let nodes: Vec<LatticeNode> = places
        .map(|at| {
            let grid = placement.grid(at);
            let [x, y] = [0, 1].map(|k| (grid[k] / spacing).round().clamp(0.0, f64::from(points[k] - 1)) as u32);
            LatticeNode { level, x, y }
        })
        .collect();
    let absent: Vec<LatticeNode> = nodes.iter().copied().filter(|&n| !data.is_resident(n)).collect();
    if !absent.is_empty() {
        load(terrain, absent)?;
    }
    let normal = |node: LatticeNode| {
        let [gx, gy] = data.gradient(node);
        let up = DVec3::new(-gx / (spacing * step_m[0]), gy / (spacing * step_m[1]), 1.0);
        (node, up.normalize().as_vec3().to_array())
    };
    Ok(nodes.into_iter().map(normal).collect())
}

/// Drops what pages of a terrain are too many, between two batches.
pub(crate) fn trim(terrain: &mut Terrain) {
    terrain.shrink(PAGE_BYTES, |_| false);
}
