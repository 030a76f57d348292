//! Remeshing: a scan of any kind of surface becomes semi-regular, a small base mesh whose triangles are split four to one, again
//! and again, each vertex on the scan or where the triangles around it come closest to it.
//!
//! Based on: Lee, Sweldens, Schröder, Cowsar, Dobkin, "MAPS: Multiresolution Adaptive Parameterization of Surfaces", 1998 (base
//! mesh and parametrisation by decimation); Guskov, Vidimče, Sweldens, Schröder, "Normal Meshes", 2000 (details along normals);
//! Khodakovsky, Schröder, Sweldens, "Progressive Geometry Compression", 2000 (what it is good for).

mod decimate;
mod density;
mod even;
mod fit;
mod history;
mod lattice;
mod measure;
mod net;
mod pin;
mod predict;
mod refine;
mod relax;
mod source;
mod star;
mod walk;

use crate::MultiresError;
use crate::bound::Judge;
use decimate::Decimated;
use glam::DVec3;
pub use measure::SurfaceKind;
use net::Net;
use source::Source;
use yamanami_core::{SemiRegular, TriangleMesh};

/// Faces of a base mesh, at least: for any, for each handle, for each part and line of border.
const LEAST_BASE: [usize; 3] = [48, 120, 8];

/// Faces of the net that is evened out, at least, if there are so many: fine enough to feel thin parts.
const FINE_FACES: usize = 60_000;

/// Faces from which on vertices are displaced along normals: enough to have an idea of the shape.
const PARAMETRIC_FACES: usize = 4000;

/// A root mean square of the distances, over the diagonal, with which a base mesh is large enough; half of it for each level more than
/// asked for.
const GOOD_RMS: f64 = 1e-4;

/// Base meshes that are tried, each four times as large as the one before, and the levels below which no larger one is.
const MOST_ATTEMPTS: usize = 3;
const LEAST_LEVELS: u32 = 3;

/// Most levels.
const MOST_LEVELS: u32 = 12;

/// How to remesh.
#[derive(Clone, Copy, Default)]
pub struct RemeshOptions<'a> {
    /// Faces of the base mesh, about; it has more where the surface needs them. By default some fifty to two hundred, so that
    /// the result has about as many faces as the source.
    pub base_faces: Option<usize>,
    /// How often the base mesh is split. By default until there are about as many faces as the source has.
    pub levels: Option<u32>,
    /// So many levels more than the source's number of faces asks for. Without meaning where `levels` is given.
    pub finer: u32,
    /// Hears of the share done, 0 to 1.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
}

impl std::fmt::Debug for RemeshOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RemeshOptions")
            .field("base_faces", &self.base_faces)
            .field("levels", &self.levels)
            .field("finer", &self.finer)
            .finish_non_exhaustive()
    }
}

/// How well it went.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RemeshReport {
    /// Faces of the source, those with a repeated corner left out.
    pub source_faces: usize,
    /// Faces of the base mesh.
    pub base_faces: usize,
    /// How often it is split.
    pub levels: u32,
    /// The level up to which vertices were placed by the parametrisation and evened out.
    pub parametric_level: u32,
    /// Length of the diagonal of the source's box, metres.
    pub diagonal_m: f64,
    /// Root mean square of the distances from samples on the source to the result, metres.
    pub source_to_result_rms_m: f64,
    /// The other way, metres.
    pub result_to_source_rms_m: f64,
    /// The greatest of these distances either way, metres. From samples: not a bound.
    pub greatest_m: f64,
    /// Share of the vertices that are displaced from their prediction along its normal alone.
    pub normal_share: f64,
    /// Faces that face away from the source where they are.
    pub folded_faces: usize,
    /// Parts, borders and handles of the source.
    pub source_kind: SurfaceKind,
    /// Those of the result.
    pub result_kind: SurfaceKind,
}

impl RemeshReport {
    /// Root mean square of the distances both ways, metres.
    pub fn rms_m(&self) -> f64 {
        ((self.source_to_result_rms_m.powi(2) + self.result_to_source_rms_m.powi(2)) / 2.0).sqrt()
    }
}

/// A remeshed surface.
#[derive(Debug, Clone)]
pub struct Remeshed {
    /// How the vertices hang together.
    pub topology: SemiRegular,
    /// Their places, metres.
    pub positions: Vec<DVec3>,
    /// Colours sampled from the source, or empty.
    pub colours: Vec<[u8; 4]>,
    /// How well it went.
    pub report: RemeshReport,
}

impl Remeshed {
    /// The finest level as a mesh.
    pub fn mesh(&self) -> TriangleMesh {
        TriangleMesh {
            positions: self.positions.clone(),
            triangles: self.topology.triangles(self.topology.levels()),
            colours: self.colours.clone(),
            ..TriangleMesh::default()
        }
    }
}

/// Remeshes a surface. It must be one: at most two triangles at an edge, one fan at a vertex, all facing one way; parts that only
/// look joined because vertices lie at one place are apart. Where the base mesh is left to this function and turns out too small for
/// the shape, larger ones are tried. The result depends on mesh and options only, never on the number of threads.
pub fn remesh(mesh: &TriangleMesh, options: &RemeshOptions<'_>) -> Result<Remeshed, MultiresError> {
    let progress = |share: f32| {
        if let Some(progress) = options.progress {
            progress(share);
        }
    };
    let source = Source::new(mesh)?;
    let faces = source.triangles().len();
    let kind = SurfaceKind::of(&source.surface);
    let target = base_faces(options, faces, kind);
    let decimating = |left: usize| progress(0.4 * (faces - left) as f32 / (faces - target.min(faces)).max(1) as f32);
    let mut decimated = decimate::decimate(&source, target, &decimating);
    let mut best: Option<Remeshed> = None;
    for attempt in 0..MOST_ATTEMPTS {
        let (from, share) = [(0.4, 0.3), (0.7, 0.2), (0.9, 0.1)][attempt];
        let laying = |done: f32| progress(from + share * done);
        let found = lay(mesh, &source, kind, &decimated, options, &laying)?;
        let RemeshReport { base_faces, levels, .. } = found.report;
        let good_m = GOOD_RMS * 0.5f64.powi(options.finer as i32) * source.diagonal_m();
        let is_good = found.report.rms_m() <= good_m;
        if best.as_ref().is_none_or(|b| found.report.rms_m() < b.report.rms_m()) {
            best = Some(found);
        }
        if is_good || options.base_faces.is_some() || levels <= LEAST_LEVELS {
            break;
        }
        decimated.go_back(4 * base_faces);
    }
    progress(1.0);
    best.ok_or(MultiresError::NoTriangles { triangles: mesh.triangles.len() })
}

/// Lays a semi-regular mesh over the source, on the base mesh that is left.
fn lay(
    mesh: &TriangleMesh,
    source: &Source,
    source_kind: SurfaceKind,
    decimated: &Decimated,
    options: &RemeshOptions<'_>,
    progress: &dyn Fn(f32),
) -> Result<Remeshed, MultiresError> {
    let faces = source.triangles().len();
    let too_large = |faces: usize| MultiresError::TooLargeToRemesh { triangles: faces };
    let base = lattice::base_mesh(source, decimated).map_err(|_| too_large(faces))?;
    let result_kind = SurfaceKind::of(&base);
    let base_faces = base.triangles().len();
    let levels = options.levels.unwrap_or_else(|| levels_for(base_faces, faces).saturating_add(options.finer));
    if levels > MOST_LEVELS || base_faces << (2 * levels) > 1 << 30 {
        return Err(too_large(base_faces.saturating_mul(1 << (2 * levels.min(20)))));
    }
    let topology = SemiRegular::new(base, levels).map_err(|_| too_large(base_faces << (2 * levels)))?;

    let level_of = |least: usize, most: u32| {
        (0..most).find(|&level| topology.triangle_count(level) as usize >= least).unwrap_or(most)
    };
    let fine_level = level_of(FINE_FACES, levels);
    let laying = |share: f32| progress(0.7 * share);
    let places = lattice::places(source, decimated, &topology, fine_level, &laying).map_err(|_| too_large(faces))?;
    let fine = Net::new(source, &topology, fine_level, places);
    let parametric_level = level_of(PARAMETRIC_FACES, fine_level);
    let mut net = fine.coarser(parametric_level);
    let mut normal = 0;
    for _ in parametric_level..levels {
        normal += refine::refine(&mut net, &fine).iter().filter(|&&is_normal| is_normal).count();
    }
    progress(0.9);

    let folded_faces = net.folded();
    let colours = if source.colours.is_empty() {
        Vec::new()
    } else {
        net.places.iter().map(|&place| source.colour(place)).collect()
    };
    let positions: Vec<DVec3> = fit::fit(&net).iter().map(|&p| source.metres(p)).collect();
    let result = TriangleMesh::new(positions, topology.triangles(levels));
    let to_result = measure::samples(mesh, &Judge::new(&result));
    let to_source = measure::samples(&result, &Judge::new(mesh));
    let report = RemeshReport {
        source_faces: faces,
        base_faces,
        levels,
        parametric_level,
        diagonal_m: source.diagonal_m(),
        source_to_result_rms_m: to_result.rms_m,
        result_to_source_rms_m: to_source.rms_m,
        greatest_m: to_result.greatest_m.max(to_source.greatest_m),
        normal_share: normal as f64 / result.positions.len() as f64,
        folded_faces,
        source_kind,
        result_kind,
    };
    Ok(Remeshed { topology, positions: result.positions, colours, report })
}

/// Faces to aim at for the base mesh: what is asked for, else so many that splits lead to the number that the source has.
fn base_faces(options: &RemeshOptions<'_>, faces: usize, kind: SurfaceKind) -> usize {
    if let Some(wanted) = options.base_faces {
        return wanted;
    }
    let [any, handle, part] = LEAST_BASE;
    let least = any + handle * kind.genus + part * (kind.components - 1 + kind.borders);
    match options.levels {
        Some(levels) => (faces >> (2 * levels).min(60)).max(least),
        None => {
            // one level at least, however many parts there are
            let mut wanted = faces / 4;
            while wanted / 4 >= least {
                wanted /= 4;
            }
            wanted
        }
    }
}

/// Levels that lead from the faces of a base mesh to about as many as the source has.
fn levels_for(base_faces: usize, faces: usize) -> u32 {
    let ratio = faces as f64 / base_faces as f64;
    ((ratio.ln() / 4f64.ln()).round() as u32).min(MOST_LEVELS)
}
