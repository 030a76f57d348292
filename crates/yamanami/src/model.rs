//! A scanned model at every level of detail: from a mesh file, built in memory, or from a `.yama` database, read by pages.

use crate::{Error, GroundOptions, Subject, coloured_style, is_tin_file, read_ground};
use rayon::prelude::*;
use std::path::Path;
use yamanami_core::{Aabb, BASE_CLUSTERS, ClusterPage, Crs, Hierarchy, NodeId, Snap, Tin, TriangleMesh};
use yamanami_gpu::RenderOptions;
use yamanami_io::store::{
    ClusterCodec, ClusterMeta, ClusterStore, ClusterWriter, Rounding, TinAnnex, TinMeta, put_in_order,
};
use yamanami_io::{IoError, mesh_file};
use yamanami_multires::cluster::{ClusterBuild, ClusterOptions, ClusterSurface, build, build_tin};

/// A model ready to be shown or extracted.
#[derive(Debug)]
pub struct Model {
    surface: ClusterSurface,
    store: Option<ClusterStore>,
    facts: Facts,
    /// What a TIN in memory has beside its triangles.
    annex: TinAnnex,
    notes: Vec<String>,
}

/// What is known of a model beside its hierarchy.
#[derive(Debug, Clone)]
struct Facts {
    title: String,
    bounds: Aabb,
    faces: u64,
    vertices: u64,
    has_colours: bool,
    deepest_level: u32,
    tin: Option<TinMeta>,
}

/// Pages coded between two writes.
const PAGES_AT_ONCE: usize = 64;

/// How to store a model.
#[derive(Debug, Clone, Default)]
pub struct ModelStoreOptions {
    /// Vertices may be so far from their places, metres; `None`: a small part of the source's edges.
    pub max_error_m: Option<f64>,
    /// Where the model comes from: files, licence.
    pub source: String,
}

/// What a stored model takes.
#[derive(Debug, Clone, Copy)]
pub struct ModelStored {
    /// Bytes of the pages' triangles and vertices.
    pub page_bytes: u64,
    /// Triangles of all levels.
    pub triangles: u64,
    /// Vertices of all levels.
    pub vertices: u64,
    /// Nodes of the hierarchy.
    pub nodes: usize,
    /// No vertex is further from its place, metres.
    pub max_error_m: f64,
}

/// A hierarchy as it was built, to be stored or shown.
#[derive(Debug)]
pub struct ModelBuild {
    build: ClusterBuild,
    mean_edge_m: f64,
    facts: Facts,
    annex: TinAnnex,
}

impl ModelBuild {
    /// Builds the hierarchy of a mesh. `progress` hears of the share done, 0 to 1.
    pub fn of_mesh(mesh: &TriangleMesh, title: String, progress: &(dyn Fn(f32) + Sync)) -> Result<Self, Error> {
        if mesh.triangles.is_empty() {
            return Err(Error::Request(format!("{title}: expected a mesh with triangles, found none")));
        }
        let built = build(mesh, &ClusterOptions { progress: Some(progress), ..ClusterOptions::default() })?;
        Ok(Self::of_built(built, mesh, title))
    }

    /// Builds the hierarchy of a TIN that does not overlap in plan: its vertices are kept bit for bit, errors are vertical.
    /// `progress` hears of the share done, 0 to 1.
    pub fn of_tin(tin: &Tin, title: String, progress: &(dyn Fn(f32) + Sync)) -> Result<Self, Error> {
        if tin.mesh.triangles.is_empty() {
            return Err(Error::Request(format!("{title}: expected a TIN with triangles, found none")));
        }
        let snap = Snap::of(&tin.mesh.positions, tin.unit_m);
        let options = ClusterOptions { progress: Some(progress), ..ClusterOptions::default() };
        let mut built = Self::of_built(build_tin(tin, Some(snap), &options)?, &tin.mesh, title);
        built.facts.tin = Some(TinMeta { crs: tin.crs.clone(), unit_m: tin.unit_m, snap });
        built.annex = TinAnnex::of(tin);
        Ok(built)
    }

    fn of_built(built: ClusterBuild, mesh: &TriangleMesh, title: String) -> Self {
        let edges = mesh.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            a.distance(b) + b.distance(c) + c.distance(a)
        });
        let mean_edge_m = edges.sum::<f64>() / (3 * mesh.triangles.len()) as f64;
        let facts = Facts {
            title,
            bounds: mesh.bounds(),
            faces: mesh.triangles.len() as u64,
            vertices: mesh.positions.len() as u64,
            has_colours: !mesh.colours.is_empty(),
            deepest_level: deepest(built.nodes.iter().map(|n| n.level)),
            tin: None,
        };
        Self { build: built, mean_edge_m, facts, annex: TinAnnex::default() }
    }

    /// Writes it as a database. `path` changes only when all is written. `progress` hears of the share done, 0 to 1.
    pub fn store_as(
        mut self,
        path: &Path,
        options: &ModelStoreOptions,
        progress: &dyn Fn(f32),
    ) -> Result<ModelStored, Error> {
        let build = &mut self.build;
        put_in_order(&build.nodes, &build.base_clusters, &mut build.base, &mut build.pages);
        let bounds = self.facts.bounds;
        let quantum_m = match options.max_error_m {
            _ if let Some(tin) = &self.facts.tin => tin.snap.metres(1.0),
            Some(error_m) => ClusterMeta::quantum_within_m(&bounds, error_m),
            None => ClusterMeta::usual_quantum_m(&bounds, self.mean_edge_m),
        };
        let all = || std::iter::once(&build.base).chain(&build.pages);
        let mut meta = ClusterMeta {
            title: self.facts.title.clone(),
            source: options.source.clone(),
            source_faces: self.facts.faces,
            source_vertices: self.facts.vertices,
            bounds,
            quantum_m,
            max_error_m: 0.0,
            has_colours: self.facts.has_colours,
            nodes: build.nodes.len() as u32,
            triangles: all().map(|p| p.triangles.len() as u64).sum(),
            vertices: all().map(|p| p.vertices.len() as u64).sum(),
            tin: self.facts.tin.clone(),
        };
        let mut rounding = Rounding::new(ClusterCodec::new(&meta));
        if meta.tin.is_none() {
            std::iter::once(&mut build.base).chain(&mut build.pages).try_for_each(|page| rounding.round(page))?;
        }
        let max_error_m = rounding.max_error_m();
        meta.max_error_m = max_error_m;
        if let Some(asked_m) = options.max_error_m.filter(|&asked_m| asked_m < max_error_m) {
            return Err(Error::Request(format!(
                "{}: a model of this size is stored within {max_error_m:e} m at best, {asked_m:e} m was asked for",
                path.display()
            )));
        }
        let mut stored = ModelStored {
            page_bytes: 0,
            triangles: meta.triangles,
            vertices: meta.vertices,
            nodes: build.nodes.len(),
            max_error_m,
        };
        let base_vertices = build.base.vertices.len() as u32;
        let mut writer = ClusterWriter::create(path, meta, &build.nodes, base_vertices, &build.base_clusters)?;
        let codec = writer.codec();
        let first_vertices = build.nodes.iter().map(|n| n.first_vertex);
        let pages: Vec<(&ClusterPage, u32)> =
            std::iter::once((&build.base, 0)).chain(build.pages.iter().zip(first_vertices)).collect();
        for (done, batch) in pages.chunks(PAGES_AT_ONCE).enumerate() {
            let coded: Result<Vec<Vec<u8>>, IoError> =
                batch.par_iter().map(|(page, first)| codec.encode(page, *first)).collect();
            for ((page, _), bytes) in batch.iter().zip(coded?) {
                stored.page_bytes += bytes.len() as u64;
                writer.insert(page.group, &bytes)?;
            }
            progress(((done + 1) * PAGES_AT_ONCE).min(pages.len()) as f32 / pages.len() as f32);
        }
        if self.facts.tin.is_some() {
            writer.insert_annex(&self.annex)?;
        }
        writer.finish()?;
        Ok(stored)
    }

    /// All of it in memory, ready to be shown.
    pub fn into_model(self) -> Result<Model, Error> {
        let ClusterBuild { nodes, base_clusters, base, pages, .. } = self.build;
        let mut surface = ClusterSurface::new(&nodes, &base_clusters, base)?;
        pages.into_iter().try_for_each(|page| surface.insert(page))?;
        Ok(Model { surface, store: None, facts: self.facts, annex: self.annex, notes: Vec::new() })
    }
}

fn deepest(levels: impl Iterator<Item = u32>) -> u32 {
    levels.max().unwrap_or(0)
}

impl Model {
    /// Opens a `.yama`, or builds a TIN or mesh file in memory. `progress` hears of the share built, 0 to 1.
    pub fn open(path: &Path, progress: &(dyn Fn(f32) + Sync)) -> Result<Self, Error> {
        let title = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        if mesh_file::is_mesh_name(path) {
            return ModelBuild::of_mesh(&mesh_file::read_mesh(path)?, title, progress)?.into_model();
        }
        if is_tin_file(path) {
            let read = read_ground(&[path.to_owned()], &GroundOptions::default())?;
            let built = ModelBuild::of_tin(&read.tin, title, progress)?;
            return Ok(Self { notes: read.notes, ..built.into_model()? });
        }
        let store = ClusterStore::open(path)?;
        let meta = store.meta();
        let facts = Facts {
            title: if meta.title.is_empty() { title } else { meta.title.clone() },
            bounds: meta.bounds,
            faces: meta.source_faces,
            vertices: meta.source_vertices,
            has_colours: meta.has_colours,
            deepest_level: deepest(store.nodes().iter().map(|n| n.level)),
            tin: meta.tin.clone(),
        };
        let base = store.page(BASE_CLUSTERS)?;
        let surface =
            ClusterSurface::new(store.nodes(), store.base_clusters(), base).map_err(|e| damaged(&store, &e))?;
        Ok(Self { surface, store: Some(store), facts, annex: TinAnnex::default(), notes: Vec::new() })
    }

    /// The database behind the model, if any.
    pub fn store(&self) -> Option<&ClusterStore> {
        self.store.as_ref()
    }

    /// The facts of a TIN; `None` for a scan.
    pub fn tin(&self) -> Option<&TinMeta> {
        self.facts.tin.as_ref()
    }

    /// What a TIN's file knew beside its visible triangles.
    pub fn annex(&self) -> Result<TinAnnex, Error> {
        match &self.store {
            Some(store) => Ok(store.annex()?),
            None => Ok(self.annex.clone()),
        }
    }

    /// What was dropped, mended or assumed when the source was read, one line each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Whether vertices have colours of their own.
    pub fn has_colours(&self) -> bool {
        self.facts.has_colours
    }

    /// Vertices of the source.
    pub fn source_vertices(&self) -> u64 {
        self.facts.vertices
    }
}

/// Nodes or a page that were read soundly but do not fit together.
fn damaged(store: &ClusterStore, found: &dyn std::fmt::Display) -> Error {
    IoError::malformed(store.path(), "hierarchy", "nodes and pages that fit together", found.to_string()).into()
}

impl Subject for Model {
    type Surface = ClusterSurface;

    fn surface(&self) -> &ClusterSurface {
        &self.surface
    }

    fn title(&self) -> &str {
        &self.facts.title
    }

    fn bounds(&self) -> Aabb {
        self.facts.bounds
    }

    fn full_triangles(&self) -> u64 {
        self.facts.faces
    }

    fn deepest_level(&self) -> u32 {
        self.facts.deepest_level
    }

    fn usual_style(&self) -> RenderOptions {
        let style = if self.is_ground() && !self.facts.has_colours {
            // a breakline is an edge, and looks like one
            RenderOptions { flat: true, ..RenderOptions::default() }
        } else {
            coloured_style(self.facts.has_colours)
        };
        RenderOptions {
            tint_range_m: Some([self.facts.bounds.min.z, self.facts.bounds.max.z]),
            deepest_level: self.facts.deepest_level,
            ..style
        }
    }

    fn is_ground(&self) -> bool {
        self.facts.tin.is_some()
    }

    fn is_paged(&self) -> bool {
        self.store.is_some()
    }

    fn crs_and_unit(&self, _in_source: bool) -> (Crs, f64) {
        self.facts.tin.as_ref().map_or((Crs::default(), 1.0), |tin| (tin.crs.clone(), tin.unit_m))
    }

    fn load(&mut self, wanted: &[NodeId], max_pages: usize) -> Result<usize, Error> {
        let Some(store) = &self.store else { return Ok(0) };
        let absent = wanted.iter().copied().filter(|&node| !self.surface.is_resident(node));
        let mut absent: Vec<NodeId> = absent.take(max_pages).collect();
        absent.sort_unstable();
        absent.dedup();
        for some in absent.chunks(PAGES_AT_ONCE) {
            let pages: Result<Vec<ClusterPage>, IoError> = some.par_iter().map(|&node| store.page(node)).collect();
            for page in pages? {
                self.surface.insert(page).map_err(|e| damaged(store, &e))?;
            }
        }
        Ok(absent.len())
    }

    fn shrink(&mut self, max_bytes: usize, in_use: impl Fn(NodeId) -> bool) {
        if self.store.is_none() {
            return;
        }
        // parents have lower numbers, so the coarsest go last
        for node in (0..self.surface.node_bound()).rev() {
            if self.surface.resident_bytes() <= max_bytes {
                return;
            }
            if self.surface.is_resident(node) && !in_use(node) {
                self.surface.remove(node);
            }
        }
    }
}
