//! A scanned model at every level of detail: from a mesh file, built in memory, or from a `.yama` database, read by pages.

use crate::{Error, Subject, coloured_style};
#[cfg(feature = "files")]
use crate::{GroundOptions, ModelBuild, is_tin_file, read_ground};
#[cfg(feature = "files")]
use rayon::prelude::*;
#[cfg(feature = "files")]
use std::path::Path;
#[cfg(feature = "files")]
use yamanami_core::BASE_CLUSTERS;
use yamanami_core::{Aabb, ClusterPage, Crs, Hierarchy, NodeId};
use yamanami_gpu::RenderOptions;
use yamanami_io::store::{ClusterMeta, ClusterTable, TinMeta};
#[cfg(feature = "files")]
use yamanami_io::store::{ClusterStore, TinAnnex};
#[cfg(feature = "files")]
use yamanami_io::{IoError, mesh_file};
use yamanami_multires::cluster::ClusterSurface;

/// A model ready to be shown or extracted.
#[derive(Debug)]
pub struct Model {
    surface: ClusterSurface,
    #[cfg(feature = "files")]
    store: Option<ClusterStore>,
    facts: Facts,
    /// What a TIN in memory has beside its triangles.
    #[cfg(feature = "files")]
    annex: TinAnnex,
    notes: Vec<String>,
}

/// What is known of a model beside its hierarchy.
#[derive(Debug, Clone)]
pub(crate) struct Facts {
    pub(crate) title: String,
    pub(crate) bounds: Aabb,
    pub(crate) faces: u64,
    pub(crate) vertices: u64,
    pub(crate) has_colours: bool,
    pub(crate) deepest_level: u32,
    pub(crate) tin: Option<TinMeta>,
}

/// Pages read at once.
#[cfg(feature = "files")]
const PAGES_AT_ONCE: usize = 64;

/// The deepest of some levels.
pub(crate) fn deepest(levels: impl Iterator<Item = u32>) -> u32 {
    levels.max().unwrap_or(0)
}

impl Facts {
    fn of(meta: &ClusterMeta, table: &ClusterTable) -> Self {
        Self {
            title: meta.title.clone(),
            bounds: meta.bounds,
            faces: meta.source_faces,
            vertices: meta.source_vertices,
            has_colours: meta.has_colours,
            deepest_level: deepest(table.nodes().iter().map(|n| n.level)),
            tin: meta.tin.clone(),
        }
    }
}

impl Model {
    /// Opens a `.yama`, or builds a TIN or mesh file in memory. `progress` hears of the share built, 0 to 1.
    #[cfg(feature = "files")]
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
        let mut facts = Facts::of(store.meta(), store.table());
        if facts.title.is_empty() {
            facts.title = title;
        }
        let base = store.page(BASE_CLUSTERS)?;
        let surface =
            ClusterSurface::new(store.nodes(), store.base_clusters(), base).map_err(|e| damaged(&store, &e))?;
        Ok(Self { surface, store: Some(store), facts, annex: TinAnnex::default(), notes: Vec::new() })
    }

    /// A model in memory.
    #[cfg(feature = "files")]
    pub(crate) fn of_parts(surface: ClusterSurface, facts: Facts, annex: TinAnnex) -> Self {
        Self { surface, store: None, facts, annex, notes: Vec::new() }
    }

    /// A model whose pages are brought by its user: its facts and nodes, and the page of its base mesh.
    pub fn from_pages(meta: &ClusterMeta, table: &ClusterTable, base: ClusterPage) -> Result<Self, Error> {
        Ok(Self {
            surface: ClusterSurface::new(table.nodes(), table.base_clusters(), base)?,
            #[cfg(feature = "files")]
            store: None,
            facts: Facts::of(meta, table),
            #[cfg(feature = "files")]
            annex: TinAnnex::default(),
            notes: Vec::new(),
        })
    }

    /// Brings a node's page into memory.
    pub fn insert(&mut self, page: ClusterPage) -> Result<(), Error> {
        Ok(self.surface.insert(page)?)
    }

    /// Those of these nodes whose pages are not in memory, each once, at most `most`.
    pub fn absent(&self, wanted: &[NodeId], most: usize) -> Vec<NodeId> {
        let absent = wanted.iter().copied().filter(|&node| !self.surface.is_resident(node));
        let mut absent: Vec<NodeId> = absent.take(most).collect();
        absent.sort_unstable();
        absent.dedup();
        absent
    }

    /// The database behind the model, if any.
    #[cfg(feature = "files")]
    pub fn store(&self) -> Option<&ClusterStore> {
        self.store.as_ref()
    }

    /// The facts of a TIN; `None` for a scan.
    pub fn tin(&self) -> Option<&TinMeta> {
        self.facts.tin.as_ref()
    }

    /// What a TIN's file knew beside its visible triangles.
    #[cfg(feature = "files")]
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
#[cfg(feature = "files")]
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

    #[cfg(feature = "files")]
    fn is_paged(&self) -> bool {
        self.store.is_some()
    }

    fn crs_and_unit(&self, _in_source: bool) -> (Crs, f64) {
        self.facts.tin.as_ref().map_or((Crs::default(), 1.0), |tin| (tin.crs.clone(), tin.unit_m))
    }

    #[cfg(feature = "files")]
    fn load(&mut self, wanted: &[NodeId], max_pages: usize) -> Result<usize, Error> {
        let absent = if self.store.is_some() { self.absent(wanted, max_pages) } else { Vec::new() };
        let Some(store) = &self.store else { return Ok(0) };
        for some in absent.chunks(PAGES_AT_ONCE) {
            let pages: Result<Vec<ClusterPage>, IoError> = some.par_iter().map(|&node| store.page(node)).collect();
            for page in pages? {
                self.surface.insert(page).map_err(|e| damaged(store, &e))?;
            }
        }
        Ok(absent.len())
    }

    fn shrink(&mut self, max_bytes: usize, in_use: impl Fn(NodeId) -> bool) {
        // what was built in memory cannot be read again
        if !self.is_paged() {
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
