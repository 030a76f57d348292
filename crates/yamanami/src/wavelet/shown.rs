//! A semi-regular model ready to be shown, flown around or extracted: read from a progressive file, or from its beginning.

use super::SemiRegularModel;
use crate::{Error, Subject, coloured_style, read_progressive};
use std::path::Path;
use yamanami_core::{Aabb, NodeId, TriangleMesh};
use yamanami_gpu::RenderOptions;
use yamanami_io::progressive::{ProgressiveLimits, ProgressiveMeta, ProgressiveReport};
use yamanami_multires::semi_regular::SemiRegularSurface;

/// A semi-regular model with all its fronts.
#[derive(Debug)]
pub struct WaveletModel {
    surface: SemiRegularSurface,
    title: String,
    bounds: Aabb,
    has_colours: bool,
    /// What its file says of itself, and how much of it was read.
    file: Option<(ProgressiveMeta, ProgressiveReport)>,
}

impl WaveletModel {
    /// A model in memory.
    pub fn new(model: SemiRegularModel) -> Result<Self, Error> {
        let mut bounds = Aabb::EMPTY;
        model.positions.iter().for_each(|&p| bounds.include(p));
        let has_colours = !model.colours.is_empty();
        let surface = SemiRegularSurface::new(model.mesh, model.positions, model.colours)?;
        Ok(Self { surface, title: model.title, bounds, has_colours, file: None })
    }

    /// Reads the first `max_bytes` of a progressive file, or as many as it has.
    pub fn open(path: &Path, max_bytes: u64) -> Result<Self, Error> {
        let found = read_progressive(path, max_bytes, ProgressiveLimits::default())?;
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let title = if found.meta.title.is_empty() { name } else { found.meta.title.clone() };
        let model = SemiRegularModel { title, mesh: found.mesh, positions: found.positions_m, colours: Vec::new() };
        Ok(Self { file: Some((found.meta, found.report)), ..Self::new(model)? })
    }

    /// What its file says of itself, and how much of it was read.
    pub fn file(&self) -> Option<&(ProgressiveMeta, ProgressiveReport)> {
        self.file.as_ref()
    }

    /// The finest mesh.
    pub fn finest(&self) -> TriangleMesh {
        let mesh = self.surface.mesh();
        TriangleMesh::new(self.surface.positions().to_vec(), mesh.triangles(mesh.levels()))
    }
}

impl Subject for WaveletModel {
    type Surface = SemiRegularSurface;

    fn surface(&self) -> &SemiRegularSurface {
        &self.surface
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn full_triangles(&self) -> u64 {
        let mesh = self.surface.mesh();
        u64::from(mesh.triangle_count(mesh.levels()))
    }

    fn deepest_level(&self) -> u32 {
        self.surface.mesh().levels()
    }

    fn usual_style(&self) -> RenderOptions {
        RenderOptions {
            tint_range_m: Some([self.bounds.min.z, self.bounds.max.z]),
            deepest_level: self.deepest_level(),
            ..coloured_style(self.has_colours)
        }
    }

    fn is_paged(&self) -> bool {
        false
    }

    fn load(&mut self, _wanted: &[NodeId], _max_pages: usize) -> Result<usize, Error> {
        Ok(0)
    }

    fn shrink(&mut self, _max_bytes: usize, _in_use: impl Fn(NodeId) -> bool) {}
}
