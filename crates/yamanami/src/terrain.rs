//! An opened terrain: from elevation files, built in memory, or from a `.yama` database, read by pages.

#[cfg(feature = "files")]
use crate::yama;
use crate::{Data, Error, Subject};
use glam::DVec3;
#[cfg(feature = "files")]
use std::path::PathBuf;
use std::sync::Arc;
use yamanami_core::{Aabb, GeoReference, HeightField, Lattice, LatticeNode, NodeId, PageId, TerrainPage};
use yamanami_gpu::RenderOptions;
#[cfg(feature = "files")]
use yamanami_io::dem;
use yamanami_io::store::TerrainMeta;
#[cfg(feature = "files")]
use yamanami_io::store::TerrainStore;
use yamanami_multires::MultiresError;
use yamanami_multires::wavelet::{BuildOptions, NodeNumbers, PagedData, TerrainData, TerrainSurface, build};

/// How to open.
#[cfg(feature = "files")]
#[derive(Debug, Clone, Default)]
pub struct OpenOptions {
    /// For elevation files.
    pub dem: dem::OpenOptions,
}

/// A terrain ready to be shown, extracted or stored.
#[derive(Debug)]
pub struct Terrain {
    surface: TerrainSurface<Data>,
    #[cfg(feature = "files")]
    store: Option<TerrainStore>,
    size: [usize; 2],
    range_m: [f32; 2],
    title: String,
}

impl Terrain {
    /// Opens one `.yama`, or one or more elevation files as a mosaic. `progress` hears of the share built, 0 to 1.
    #[cfg(feature = "files")]
    pub fn open(paths: &[PathBuf], options: &OpenOptions, progress: &dyn Fn(f32)) -> Result<Self, Error> {
        let title =
            paths.first().and_then(|p| p.file_name()).map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let is_yama = |p: &PathBuf| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("yama"));
        match paths {
            [path] if is_yama(path) => yama::open(path, title),
            _ if paths.iter().any(is_yama) => {
                Err(Error::Request("a .yama database stands alone: give it as the only input".to_owned()))
            }
            _ => Self::build(dem::open(paths, &options.dem)?.read_all()?, title, progress),
        }
    }

    /// Builds the surface of a height field in memory.
    pub fn build(field: HeightField, title: String, progress: &dyn Fn(f32)) -> Result<Self, Error> {
        let size = [field.width(), field.height()];
        let range_m = field.range_m().unwrap_or([0.0; 2]);
        let surface = build(field, &BuildOptions { progress: Some(progress) })?;
        Ok(Self {
            surface: surface.map_data(Data::Grid),
            #[cfg(feature = "files")]
            store: None,
            size,
            range_m,
            title,
        })
    }

    /// A terrain whose pages are brought by its user. Nothing can be shown before those of the coarsest level are there.
    pub fn from_pages(meta: &TerrainMeta) -> Result<Self, Error> {
        let [width, height] = meta.size.map(|n| n as usize);
        let lattice = Lattice::new(width, height);
        let numbers = NodeNumbers::new(lattice.clone()).ok_or(MultiresError::TooLarge { width, height })?;
        let data = Data::Paged(PagedData::new(lattice, meta.has_holes));
        let surface = TerrainSurface::new(numbers, data, meta.geo.clone(), meta.bound_radius_m.clone());
        Ok(Self {
            surface,
            #[cfg(feature = "files")]
            store: None,
            size: [width, height],
            range_m: meta.height_range_m,
            title: meta.title.clone(),
        })
    }

    /// Brings a page into memory.
    pub fn insert(&self, page: Arc<TerrainPage>) {
        if let Data::Paged(data) = self.surface.data() {
            data.insert(page);
        }
    }

    /// The pages that these nodes need and that are not in memory, each once, about `most` of them.
    pub fn absent(&self, wanted: &[NodeId], most: usize) -> Vec<PageId> {
        let Data::Paged(data) = self.surface.data() else { return Vec::new() };
        let mut pages = Vec::new();
        for &node in wanted {
            let place = self.surface.numbers().place(node);
            for id in data.needed_pages(place) {
                if data.page(id).is_none() && !pages.contains(&id) {
                    pages.push(id);
                }
            }
            if pages.len() >= most {
                break;
            }
        }
        pages
    }

    #[cfg(feature = "files")]
    pub(crate) fn from_store(
        surface: TerrainSurface<PagedData>,
        store: TerrainStore,
        size: [usize; 2],
        range_m: [f32; 2],
        title: String,
    ) -> Self {
        Self { surface: surface.map_data(Data::Paged), store: Some(store), size, range_m, title }
    }

    /// The multiresolution surface.
    pub fn surface(&self) -> &TerrainSurface<Data> {
        &self.surface
    }

    /// The database behind the terrain, if any.
    #[cfg(feature = "files")]
    pub fn store(&self) -> Option<&TerrainStore> {
        self.store.as_ref()
    }

    /// Columns and rows of the source.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Lowest and highest height in metres.
    pub fn range_m(&self) -> [f32; 2] {
        self.range_m
    }

    /// Name for pictures and files.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Where the grid lies.
    pub fn geo(&self) -> &GeoReference {
        self.surface.geo()
    }

    /// East-west and north-south extent in metres.
    pub fn extent_m(&self) -> [f64; 2] {
        let step_m = self.geo().step_m;
        [step_m[0] * (self.size[0] - 1) as f64, step_m[1] * (self.size[1] - 1) as f64]
    }

    /// Brings the pages of absent nodes into memory, at most `max_pages`; gives how many were read.
    #[cfg(feature = "files")]
    pub fn load(&self, wanted: &[NodeId], max_pages: usize) -> Result<usize, Error> {
        let (Data::Paged(data), Some(store)) = (self.surface.data(), &self.store) else { return Ok(0) };
        let pages = self.absent(wanted, max_pages);
        for &id in &pages {
            data.insert(store.page(id)?);
        }
        Ok(pages.len())
    }

    /// Drops pages that no node of `in_use` needs until at most `max_bytes` stay; pages of coarse levels stay longest.
    pub fn shrink(&mut self, max_bytes: usize, in_use: impl Fn(NodeId) -> bool) {
        let numbers = self.surface.numbers().clone();
        let base = numbers.lattice().levels();
        let Data::Paged(data) = self.surface.data_mut() else { return };
        let mut bytes = data.resident_bytes();
        if bytes <= max_bytes {
            return;
        }
        let pages: Vec<PageId> = data.resident().collect();
        let used: std::collections::HashSet<PageId> = pages
            .iter()
            .copied()
            .filter(|&id| {
                id.level + 1 >= base
                    || data.page(id).is_some_and(|page| {
                        page_nodes(page.id, page.width, page.height)
                            .any(|n| numbers.exists(n) && in_use(numbers.number(n)))
                    })
            })
            .collect();
        for &id in pages.iter().rev() {
            if bytes <= max_bytes {
                break;
            }
            // a midpoint on the border also needs the pages left of and above its own
            let neighbours =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| PageId { x: id.x + dx, y: id.y + dy, ..id });
            if neighbours.iter().all(|n| !used.contains(n)) {
                bytes -= data.page_bytes(id);
                data.remove(id);
            }
        }
    }

    /// Height at a place of the local frame from what is in memory on a coarse level, metres; for cameras, not for
    /// surveying.
    pub fn rough_height_m(&self, x_m: f64, y_m: f64, level: u32) -> f64 {
        let [column, row] = self.geo().grid_from_local(x_m, y_m);
        let lattice = self.surface.numbers().lattice();
        let points = lattice.points(level);
        let place =
            |v: f64, points: u32| (v / f64::from(1u32 << level)).round().clamp(0.0, f64::from(points - 1)) as u32;
        let node = LatticeNode { level, x: place(column, points[0]), y: place(row, points[1]) };
        f64::from(self.surface.data().height_m(node))
    }

    /// The finest level that is in memory as a whole and has at most `most` points a side.
    pub fn overview_level(&self, most: u32) -> u32 {
        let lattice = self.surface.numbers().lattice();
        (0..lattice.levels())
            .find(|&level| lattice.points(level).into_iter().max().unwrap_or(0) <= most)
            .unwrap_or(lattice.levels())
    }

    /// Brings a whole coarse level into memory.
    #[cfg(feature = "files")]
    pub fn load_level(&self, level: u32) -> Result<(), Error> {
        let (Data::Paged(data), Some(store)) = (self.surface.data(), &self.store) else { return Ok(()) };
        for id in data.pages_of_level(level) {
            data.insert(store.page(id)?);
        }
        Ok(())
    }

    /// Reads back the whole grid of heights; filled where there is no data.
    #[cfg(feature = "files")]
    pub fn full_heights_m(&self) -> Result<Arc<[f32]>, Error> {
        match (self.surface.data(), &self.store) {
            (Data::Grid(grid), _) => Ok(grid.heights_m().into()),
            (Data::Paged(_), Some(store)) => {
                let [w, h] = self.size;
                Ok(store.read_height_block(0, 0, 0, w as u32, h as u32)?.into())
            }
            (Data::Paged(_), None) => Err(Error::Request("this terrain has lost its database".to_owned())),
        }
    }
}

impl Subject for Terrain {
    type Surface = TerrainSurface<Data>;

    fn surface(&self) -> &Self::Surface {
        &self.surface
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn bounds(&self) -> Aabb {
        let ([east_m, north_m], [low, high]) = (self.extent_m(), self.range_m.map(f64::from));
        Aabb { min: DVec3::new(0.0, -north_m, low), max: DVec3::new(east_m, 0.0, high) }
    }

    fn full_triangles(&self) -> u64 {
        let [columns, rows] = self.size.map(|n| n as u64);
        2 * (columns - 1) * (rows - 1)
    }

    fn deepest_level(&self) -> u32 {
        self.surface.numbers().lattice().levels()
    }

    fn usual_style(&self) -> RenderOptions {
        RenderOptions {
            tint_range_m: Some(self.range_m.map(f64::from)),
            deepest_level: self.deepest_level(),
            ..RenderOptions::default()
        }
    }

    fn is_paged(&self) -> bool {
        matches!(self.surface.data(), Data::Paged(_))
    }

    #[cfg(feature = "files")]
    fn load(&mut self, wanted: &[NodeId], max_pages: usize) -> Result<usize, Error> {
        Self::load(self, wanted, max_pages)
    }

    fn shrink(&mut self, max_bytes: usize, in_use: impl Fn(NodeId) -> bool) {
        Self::shrink(self, max_bytes, in_use);
    }

    fn local_from_source(&self, place: DVec3) -> DVec3 {
        let [x, y] = self.geo().local_from_source(place.x, place.y);
        DVec3::new(x, y, place.z)
    }

    fn source_from_local(&self, place: DVec3) -> DVec3 {
        let [x, y] = self.geo().source_from_local(place.x, place.y);
        DVec3::new(x, y, place.z)
    }

    fn as_terrain(&self) -> Option<&Terrain> {
        Some(self)
    }
}

fn page_nodes(id: PageId, width: u32, height: u32) -> impl Iterator<Item = LatticeNode> {
    let cells = yamanami_core::PAGE_CELLS;
    (0..height).flat_map(move |y| {
        (0..width).map(move |x| LatticeNode { level: id.level, x: id.x * cells + x, y: id.y * cells + y })
    })
}
