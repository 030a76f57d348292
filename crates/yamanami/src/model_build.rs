//! Building the hierarchy of a scanned model or a TIN, to be shown at once or stored as a `.yama` database.

use crate::model::{Facts, deepest};
use crate::{Error, Model};
use rayon::prelude::*;
use std::path::Path;
use yamanami_core::{ClusterPage, Snap, Tin, TriangleMesh};
use yamanami_io::IoError;
use yamanami_io::store::{ClusterCodec, ClusterMeta, ClusterWriter, Rounding, TinAnnex, TinMeta, put_in_order};
use yamanami_multires::cluster::{ClusterBuild, ClusterOptions, ClusterSurface, build, build_tin};

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
        Ok(Model::of_parts(surface, self.facts, self.annex))
    }
}
