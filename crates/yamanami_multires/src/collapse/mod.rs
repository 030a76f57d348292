//! Edge collapse: a triangle mesh with fewer triangles that stays as close to the source as it can.
//!
//! Based on: Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997; Lindstrom and Turk, "Fast and
//! Memory Efficient Polygonal Simplification", 1998 (no quadric is remembered: each is worked out anew from the surface at
//! hand, and the volume is kept); Hoppe, "New Quadric Metric for Simplifying Meshes with Appearance Attributes", 1999.

mod appearance;
mod appearance_sum;
mod garland;
mod lanes;
mod order;
mod patches;
mod plane_sum;
mod prepare;
pub(crate) mod quadric;
mod rounds;
pub(crate) mod stars;
mod surroundings;
mod within;
mod work;

use prepare::Prepared;
use rounds::Stop;
pub use within::{CollapsedWithin, collapse_within};
use yamanami_core::TriangleMesh;

/// Which collapse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Memoryless quadrics, volume kept, in passes over the cheapest edges.
    #[default]
    Memoryless,
    /// The ten steps of Garland and Heckbert 1997, one edge at a time from a heap, as Mizuno et al. use them.
    Garland97,
}

/// How much a unit of an attribute's change counts beside a distance: the distance, as a share of the model's diagonal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttributeWeights {
    /// For unit normals.
    pub normal: f64,
    /// For colours, each channel 0 to 1.
    pub colour: f64,
    /// For texture coordinates.
    pub texcoord: f64,
}

impl Default for AttributeWeights {
    fn default() -> Self {
        Self { normal: 0.0, colour: 0.005, texcoord: 0.02 }
    }
}

/// How far to collapse.
pub struct CollapseOptions<'a> {
    /// Stops at this many faces.
    pub target_faces: usize,
    /// Stops where the next collapse would move the surface further than this by its own estimate, metres.
    pub max_error_m: f64,
    /// Vertices that must stay as they are, one flag a vertex.
    pub locked: Option<&'a [bool]>,
    /// Which collapse.
    pub method: Method,
    /// Attributes in the metric.
    pub weights: AttributeWeights,
    /// Hears of the share done, 0 to 1.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
}

impl Default for CollapseOptions<'_> {
    fn default() -> Self {
        Self {
            target_faces: 0,
            max_error_m: f64::INFINITY,
            locked: None,
            method: Method::default(),
            weights: AttributeWeights::default(),
            progress: None,
        }
    }
}

impl std::fmt::Debug for CollapseOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CollapseOptions")
            .field("target_faces", &self.target_faces)
            .field("max_error_m", &self.max_error_m)
            .field("locked", &self.locked.map(<[bool]>::len))
            .field("method", &self.method)
            .field("weights", &self.weights)
            .finish_non_exhaustive()
    }
}

/// Why a collapse ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    /// The target was reached.
    Target,
    /// The next step would have cost more than allowed.
    Error,
    /// No edge was left that may go without harm: a fold, a pinched or lost surface, a locked vertex.
    Topology,
}

/// A reduced mesh.
#[derive(Debug, Clone)]
pub struct Collapsed {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// For each vertex of the result the source vertex that it is, untouched, or `u32::MAX` for a moved one.
    pub source_vertex: Vec<u32>,
    /// What ended it.
    pub stopped_by: StoppedBy,
    /// The largest distance that any step moved the surface by its own estimate, metres. Not a bound: measure the result.
    pub estimate_m: f64,
}

/// Collapses edges of a mesh until something in `options` stops it. The result depends on mesh and options only, never on
/// the number of threads. Indices must be in range and positions finite, as every reader here guarantees.
///
/// # Panics
/// When a triangle names a vertex that the mesh does not have, or `locked` is not one flag a vertex.
pub fn collapse(mesh: &TriangleMesh, options: &CollapseOptions<'_>) -> Collapsed {
    let mut prepared = Prepared::new(mesh, options.locked);
    let metres = prepared.metres_a_unit();
    let stop = Stop { faces: options.target_faces, error: options.max_error_m / metres };
    let start = prepared.work.faces();
    let progress = |left: usize| {
        if let Some(progress) = options.progress {
            progress((start - left) as f32 / (start.saturating_sub(options.target_faces)).max(1) as f32);
        }
    };
    let (stopped_by, estimate) = match options.method {
        Method::Memoryless => {
            let diagonal = mesh.bounds().diagonal() / metres;
            let AttributeWeights { normal, colour, texcoord } = options.weights;
            let [normal, colour, texcoord] = [normal, colour, texcoord].map(|w| w * diagonal);
            let scales = prepared.work.appearance.scales(normal, colour, texcoord);
            let n = mesh.positions.len();
            patches::run(&mut prepared.work, &mut prepared.sources, n, scales, stop, &progress)
        }
        Method::Garland97 => garland::run(&mut prepared.work, stop, &progress),
    };
    let (mesh, source_vertex) = prepared.finish(mesh);
    Collapsed { mesh, source_vertex, stopped_by, estimate_m: estimate * metres }
}
