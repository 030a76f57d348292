//! A whole map in one call: the ground meshed for the picture, coloured and drawn, names and lines laid over it.

use super::check::measure_mesh;
use super::{BaseOptions, DeformedScene, MapErrors, MapImage, draw_base, rank_by_prominence};
use crate::Error;
use glam::{DVec2, DVec3};
use image::RgbaImage;
use std::collections::HashSet;
use yamanami_core::{MapLine, MapView, NamedPlace, TriangleMesh};
use yamanami_gpu::{ResidentBuffers, Wireframe};
use yamanami_io::crs::AzimuthalPlane;
use yamanami_lod::BandTable;
use yamanami_map::{
    Composed, Fonts, HorizonTable, InkStyle, ReliefStyle, SeenFrom, Sheet, SheetOptions, Sightline, paint,
};
use yamanami_multires::rtin::band_mesh::{BandMeshOptions, PAPER_REACH_M, PeakRule, band_mesh};
use yamanami_multires::rtin::summits;

/// Which mesh is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MapMesh {
    /// As coarse as the bound on its error in the picture allows.
    Exact {
        /// No ground is drawn further from its place, pixels.
        tolerance_px: f32,
        /// Most triangles, the tolerance notwithstanding.
        budget: Option<u32>,
    },
    /// The paper's table of bands, heights moved to keep peaks.
    Paper,
    /// Every sample.
    Full,
}

/// A map to be made.
#[derive(Debug)]
pub struct MapJob {
    /// Projection and picture.
    pub view: MapView,
    /// Which mesh is drawn.
    pub mesh: MapMesh,
    /// Colours of the ground.
    pub relief: ReliefStyle,
    /// Lines along the ridges.
    pub ink: Option<InkStyle>,
    /// The mesh's edges.
    pub wireframe: Option<Wireframe>,
    /// Four samples a pixel.
    pub antialias: bool,
    /// Whether the true error of every sample is measured.
    pub is_checked: bool,
    /// From where places must be seen to be named.
    pub seen_from: SeenFrom,
    /// The sheet around it.
    pub sheet: SheetOptions,
    /// Name of the map; empty for none.
    pub title: String,
    /// Whose data it shows, one line each.
    pub credits: Vec<String>,
    /// A picture to lay over the plain map, and the plane it is laid into.
    pub image: Option<(MapImage, AzimuthalPlane)>,
    /// What it is lettered with.
    pub fonts: Fonts,
}

/// A map made: the ground as a picture, and the sheet to be laid over it.
#[derive(Debug)]
pub struct MadeMap {
    /// The ground; transparent where there is none.
    pub base: RgbaImage,
    /// Names, lines and all else.
    pub composed: Composed,
    /// Triangles drawn.
    pub triangles: usize,
    /// No ground is drawn further from its place, pixels; unknown for the paper's mesh.
    pub error_px: Option<f32>,
    /// What was measured, if it was.
    pub errors: Option<MapErrors>,
    /// Share of the picture's disc that the picture laid over it covers, 0 to 1; none without one.
    pub image_share: Option<f64>,
    /// For each named place, how far its place lies from where the mesh shows it, pixels; NaN for the paper's mesh.
    pub name_error_px: Vec<f64>,
}

/// Hidden ground is drawn this much paler.
const VEIL: ([u8; 3], f32) = ([226, 230, 234], 0.55);
/// Azimuths of the table of horizons, and the metres between its distances.
const HORIZON: (usize, f64) = (3600, 250.0);
/// A picture over the plain map is faded out at this many radii of it.
const IMAGE_RINGS: f64 = 1.3;
/// Lines that lie this far below the horizon before them are still drawn, metres.
const LINE_SLACK_M: f64 = 60.0;
/// Summits of less prominence rank no name, metres.
const LEAST_PROMINENCE_M: f64 = 20.0;

/// Longitudes and latitudes to the plane; what has no coordinates keeps none.
pub fn lay_places(places: &mut [NamedPlace], plane: &AzimuthalPlane) {
    for place in places {
        place.position = plane.to_plane(place.position.x, place.position.y);
    }
}

/// Longitudes and latitudes of lines to the plane.
pub fn lay_lines(lines: &mut [MapLine], plane: &AzimuthalPlane) {
    for point in lines.iter_mut().flat_map(|line| &mut line.points) {
        *point = plane.to_plane(point.x, point.y);
    }
}

/// Makes a map of a scene's ground. `places` and `lines` lie in the plane already. `progress` hears what is done and the
/// share of it.
pub fn make_map(
    scene: &mut DeformedScene,
    job: &MapJob,
    centre_lon_lat: Option<DVec2>,
    places: &[NamedPlace],
    lines: &[MapLine],
    progress: &dyn Fn(&str, f32),
) -> Result<MadeMap, Error> {
    let view = &job.view;
    scene.check(&view.map).map_err(|fault| Error::Request(fault.to_string()))?;
    progress("mesh", 0.0);
    let (built, error_px, errors) = match job.mesh {
        MapMesh::Exact { tolerance_px, budget } => {
            let error_px = scene.update(view, tolerance_px, budget)?.report.error_left;
            (None, Some(error_px), job.is_checked.then(|| scene.measure(view)))
        }
        MapMesh::Paper => {
            let mesh = paper_mesh(scene, view)?;
            let errors = job.is_checked.then(|| measure_mesh(view, scene.field().widest(), &mesh));
            (Some(ResidentBuffers::from_mesh(&mesh)), None, errors)
        }
        MapMesh::Full => (Some(scene.full_mesh()), Some(0.0), None),
    };
    let field = scene.field();
    progress("colours", 0.0);
    let mut pictures = paint(field, &job.relief, view.map.centre);
    let image_share = job.image.as_ref().map(|(image, plane)| {
        let (reach_m, metres_per_px) = (IMAGE_RINGS * view.map.ring_m, view.map.ring_m / view.ring_px);
        image.lay_over(&mut pictures, plane, view.map.centre, reach_m, metres_per_px)
    });
    let mut options = BaseOptions::painted(pictures)?;
    options.ink = job.ink;
    options.wireframe = job.wireframe;
    options.antialias = job.antialias;
    // summits are asked one by one; for lines and veils, which are many points, a table answers
    let has_veil = view.map.alpha > 0.0;
    let horizon =
        (has_veil || !lines.is_empty()).then(|| HorizonTable::new(field, &view.map, view.rim_m, HORIZON.0, HORIZON.1));
    options.veil = horizon.clone().filter(|_| has_veil).map(|table| (table, VEIL.0, VEIL.1));
    let mesh = built.as_ref().unwrap_or_else(|| scene.canvas().buffers());
    let triangles = mesh.triangle_count();
    let base = draw_base(mesh, view, &options, &|share| progress("drawing", share))?;
    progress("names", 0.0);
    let mut named = places.to_vec();
    if !named.is_empty() {
        rank_by_prominence(&mut named, field, &summits(field.widest(), LEAST_PROMINENCE_M));
    }
    let sight = Sightline::new(field, view.map, job.seen_from);
    let key = |p: DVec2| [p.x.to_bits(), p.y.to_bits()];
    let own: HashSet<[u64; 2]> = named.iter().map(|place| key(place.position)).collect();
    let is_seen = |p: DVec3| match &horizon {
        Some(table) if !own.contains(&key(p.truncate())) => table.sees(&view.map, p, LINE_SLACK_M),
        _ => sight.sees(p),
    };
    let tint: Vec<(f64, [u8; 3])> =
        job.relief.tints.iter().map(|stop| (f64::from(stop.height_m), stop.colour)).collect();
    let sheet = Sheet {
        view,
        title: &job.title,
        centre_lon_lat,
        credits: &job.credits,
        places: &named,
        lines,
        silhouettes: &[],
        tint: &tint,
        options: &job.sheet,
        fonts: &job.fonts,
    };
    let composed = sheet.compose(&|p| if field.is_known(p) { field.height_m(p) } else { f64::NAN }, &is_seen);
    let name_error_px = match (&built, job.mesh) {
        (None, _) => composed.labels.iter().map(|label| summit_error_px(scene, view, label.at)).collect(),
        (_, MapMesh::Full) => vec![0.0; composed.labels.len()],
        _ => vec![f64::NAN; composed.labels.len()],
    };
    Ok(MadeMap { base, composed, triangles, error_px, errors, image_share, name_error_px })
}

/// How far the ground at a named place is drawn from its place.
fn summit_error_px(scene: &DeformedScene, view: &MapView, at: DVec3) -> f64 {
    if !at.is_finite() {
        return f64::NAN;
    }
    let ground = at.truncate().extend(scene.field().height_m(at.truncate()));
    scene.error_px_at(view, ground)
}

/// The paper's mesh of the ground, by its printed table.
fn paper_mesh(scene: &DeformedScene, view: &MapView) -> Result<TriangleMesh, Error> {
    let grid = scene.field().widest();
    let table = BandTable::paper();
    let options = BandMeshOptions {
        eye: view.map.centre,
        block_m: 32.0 * grid.spacing_m(),
        reach_m: PAPER_REACH_M.min(view.rim_m),
        peaks: PeakRule::Paper,
    };
    Ok(band_mesh(grid, &options, |r_m| table.level_at(r_m), &[])?.mesh)
}
