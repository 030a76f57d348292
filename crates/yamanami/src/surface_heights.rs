//! Heights of a terrain's surface at any place and on any level, from memory or straight from a database, by any number of
//! threads.
//!
//! A place lies in one of a level's triangles, and its plane is evaluated; so what is told here is the surface that meshes
//! show, not a guess between samples.

use crate::{Data, Error, Terrain};
use glam::DVec2;
use std::path::Path;
use yamanami_core::{GeoReference, Lattice, LatticeNode, PAGE_CELLS, PageId};
use yamanami_io::{crs, store::TerrainStore};
use yamanami_multires::wavelet::{GridData, TerrainData};

/// Lattice points read at once; places that need more are divided.
const MOST_PATCH_POINTS: u64 = 4 << 20;

/// Where the heights are.
#[derive(Debug)]
enum Source<'a> {
    Grid(&'a GridData),
    Store(&'a TerrainStore),
    Opened(Box<TerrainStore>),
}

/// The surface of a terrain, to be asked for heights.
#[derive(Debug)]
pub struct SurfaceHeights<'a> {
    source: Source<'a>,
    geo: GeoReference,
    lattice: Lattice,
    has_holes: bool,
}

/// A window of a level.
struct Patch {
    x0: u32,
    y0: u32,
    width: u32,
    heights_m: Vec<f32>,
    /// By square, which halves are shown; empty when all are.
    shown: Vec<u8>,
}

impl SurfaceHeights<'static> {
    /// Opens a terrain's database.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let store = TerrainStore::open(path)?;
        let (geo, lattice, has_holes) = (store.meta().geo.clone(), store.lattice().clone(), store.meta().has_holes);
        Ok(Self { source: Source::Opened(Box::new(store)), geo, lattice, has_holes })
    }
}

impl<'a> SurfaceHeights<'a> {
    /// Of an opened terrain.
    pub fn of(terrain: &'a Terrain) -> Result<Self, Error> {
        let lattice = terrain.surface().numbers().lattice().clone();
        let source = match (terrain.surface().data(), terrain.store()) {
            (Data::Grid(grid), _) => Source::Grid(grid),
            (Data::Paged(_), Some(store)) => Source::Store(store),
            (Data::Paged(_), None) => return Err(Error::Request("this terrain has lost its database".to_owned())),
        };
        let has_holes = terrain.surface().data().has_holes();
        Ok(Self { source, geo: terrain.geo().clone(), lattice, has_holes })
    }

    /// Where the grid lies.
    pub fn geo(&self) -> &GeoReference {
        &self.geo
    }

    /// The lattice of the grid.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Column and row of a longitude and latitude in degrees; `None` where the CRS has no such place. East of the date line
    /// the grid goes on.
    pub fn grid_from_lon_lat(&self, lon: f64, lat: f64) -> Option<DVec2> {
        let [mut x, y] = crs::from_lon_lat(&self.geo.crs, lon, lat)?;
        if let Some(round) = crs::way_round(&self.geo.crs) {
            let middle = self.geo.source_from_grid(f64::from(self.lattice.width() - 1) / 2.0, 0.0)[0];
            x += ((middle - x) / round).round() * round;
        }
        Some(DVec2::from(self.geo.grid_from_source(x, y)))
    }

    /// Heights in metres at columns and rows, of a level's triangles; NaN outside of the surface.
    pub fn at(&self, level: u32, places: &[DVec2]) -> Result<Vec<f32>, Error> {
        let mut heights_m = vec![f32::NAN; places.len()];
        self.fill(level.min(self.lattice.levels()), places, &mut heights_m)?;
        Ok(heights_m)
    }

    fn fill(&self, level: u32, places: &[DVec2], out: &mut [f32]) -> Result<(), Error> {
        let last = DVec2::new(f64::from(self.lattice.width() - 1), f64::from(self.lattice.height() - 1));
        let inside = |p: &DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(last).all();
        let mut bounds: Option<[DVec2; 2]> = None;
        for &p in places.iter().filter(|p| inside(p)) {
            bounds = Some(bounds.map_or([p, p], |[low, high]| [low.min(p), high.max(p)]));
        }
        let Some([low, high]) = bounds else { return Ok(()) };
        let squares = self.lattice.squares(level);
        let cell = |along: f64, squares: u32| ((along as u32) >> level).min(squares - 1);
        let [x0, x1] = [low.x, high.x].map(|x| cell(x, squares[0]));
        let [y0, y1] = [low.y, high.y].map(|y| cell(y, squares[1]));
        let [width, height] = [x1 - x0 + 2, y1 - y0 + 2];
        if u64::from(width) * u64::from(height) > MOST_PATCH_POINTS && places.len() > 1 {
            let middle = places.len() / 2;
            let (first, second) = out.split_at_mut(middle);
            self.fill(level, &places[..middle], first)?;
            return self.fill(level, &places[middle..], second);
        }
        let patch = self.patch(level, [x0, y0], [width, height])?;
        for (p, out) in places.iter().zip(out).filter(|(p, _)| inside(p)) {
            let [x, y] = [cell(p.x, squares[0]), cell(p.y, squares[1])];
            let [west, north] = self.lattice.sample(level, x, y).map(f64::from);
            let [east, south] = self.lattice.sample(level, x + 1, y + 1).map(f64::from);
            let u = ((p.x - west) / (east - west)).clamp(0.0, 1.0);
            let v = ((p.y - north) / (south - north)).clamp(0.0, 1.0);
            *out = patch.height_m(x, y, u, v);
        }
        Ok(())
    }

    fn patch(&self, level: u32, [x0, y0]: [u32; 2], [width, height]: [u32; 2]) -> Result<Patch, Error> {
        let store = match &self.source {
            Source::Grid(grid) => return Ok(self.patch_of(grid, level, [x0, y0], [width, height])),
            Source::Store(store) => *store,
            Source::Opened(store) => store,
        };
        let heights_m = store.read_height_block(level, x0, y0, width, height)?;
        let mut patch = Patch { x0, y0, width, heights_m, shown: Vec::new() };
        if !self.has_holes {
            return Ok(patch);
        }
        patch.shown = vec![0; ((width - 1) * (height - 1)) as usize];
        let (x_end, y_end) = (x0 + width - 1, y0 + height - 1);
        for py in y0 / PAGE_CELLS..=(y_end - 1) / PAGE_CELLS {
            for px in x0 / PAGE_CELLS..=(x_end - 1) / PAGE_CELLS {
                let page = store.page(PageId { level, x: px, y: py })?;
                let [left, top, across] = [px * PAGE_CELLS, py * PAGE_CELLS, page.width - 1];
                for y in y0.max(top)..y_end.min(top + page.height - 1) {
                    for x in x0.max(left)..x_end.min(left + across) {
                        let from = ((y - top) * across + x - left) as usize;
                        let halves = page.shown.get(from).copied().unwrap_or(3);
                        patch.shown[((y - y0) * (width - 1) + x - x0) as usize] = halves;
                    }
                }
            }
        }
        Ok(patch)
    }

    fn patch_of(&self, grid: &GridData, level: u32, [x0, y0]: [u32; 2], [width, height]: [u32; 2]) -> Patch {
        let nodes = |columns: u32, rows: u32| {
            (y0..y0 + rows).flat_map(move |y| (x0..x0 + columns).map(move |x| LatticeNode { level, x, y }))
        };
        let halves =
            |n: LatticeNode| [0, 1].map(|half| u8::from(grid.shown(level, n.x, n.y, half)) << half).iter().sum();
        let shown = if self.has_holes { nodes(width - 1, height - 1).map(halves).collect() } else { Vec::new() };
        let heights_m = nodes(width, height).map(|n| grid.height_m(n)).collect();
        Patch { x0, y0, width, heights_m, shown }
    }
}

impl Patch {
    /// Height in metres in square (x, y) at shares u and v of its sides from its north-west corner.
    fn height_m(&self, x: u32, y: u32, u: f64, v: f64) -> f32 {
        let [column, row] = [(x - self.x0) as usize, (y - self.y0) as usize];
        let at = |dx: usize, dy: usize| f64::from(self.heights_m[(row + dy) * self.width as usize + column + dx]);
        let is_upper = u >= v;
        let halves = self.shown.get(row * (self.width as usize - 1) + column).copied().unwrap_or(3);
        // on the diagonal either half will do
        if halves & if is_upper { 1 } else { 2 } == 0 && !(u == v && halves != 0) {
            return f32::NAN;
        }
        let (north_west, south_east) = (at(0, 0), at(1, 1));
        let z = if is_upper {
            let corner = at(1, 0);
            north_west + u * (corner - north_west) + v * (south_east - corner)
        } else {
            let corner = at(0, 1);
            north_west + v * (corner - north_west) + u * (south_east - corner)
        };
        z as f32
    }
}
