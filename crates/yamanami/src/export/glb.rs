//! One binary glTF: the front within a tolerance or a budget, packed like a tile.

use super::{ExportJob, ExportReport, ExportSubject, ZoomReport};
use crate::{Criteria, Error, Subject, extract};
use yamanami_core::TriangleMesh;
use yamanami_io::mesh_file::{MeshMeta, write_file};
use yamanami_io::tiles::glb::{LatticeMesh, TileClaim, encode_glb, step_below_m};

/// Steps in the error that is allowed, and in an edge.
const STEPS: f64 = 64.0;

pub(super) fn file(subject: ExportSubject<'_>, job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    match subject {
        ExportSubject::Terrain(terrain) => of(terrain, job),
        ExportSubject::Model(model) => of(model, job),
    }
}

fn of(subject: &mut impl Subject, job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    let options = job.options;
    let criteria = Criteria {
        terrain_tolerance_m: options.tolerance_m.unwrap_or(0.0) as f32,
        budget_triangles: options.budget_triangles,
        ..Criteria::default()
    };
    let extracted = extract(subject, &criteria)?;
    let mesh = on_lattice(&extracted.mesh);
    let error_m = f64::from(extracted.error_left) + 0.5 * 3f64.sqrt() * mesh.step_m;
    let meta = MeshMeta { title: subject.title().to_owned(), ..MeshMeta::default() };
    let file = encode_glb(&mesh, options.packing, &meta, &TileClaim { error_m, height_range_m: None });
    write_file(job.output, &file)?;
    let triangles = mesh.triangles.len() as u64;
    let whole = ZoomReport { tiles: 1, triangles, bytes: file.len() as u64, error_m, ..ZoomReport::default() };
    Ok(ExportReport { zooms: vec![whole], ..ExportReport::default() })
}

/// A mesh with its places on steps far shorter than its edges.
fn on_lattice(mesh: &TriangleMesh) -> LatticeMesh {
    let edges = mesh.triangles.iter().map(|t| {
        let [a, b] = [t[0], t[1]].map(|v| mesh.positions[v as usize]);
        a.distance(b)
    });
    let mean_edge_m = edges.sum::<f64>() / mesh.triangles.len().max(1) as f64;
    let step_m = step_below_m(mean_edge_m / STEPS, &mesh.bounds());
    LatticeMesh {
        step_m,
        places: mesh.positions.iter().map(|p| (*p / step_m).round().to_array().map(|c| c as i64)).collect(),
        triangles: mesh.triangles.clone(),
        normals: mesh.normals.clone(),
        colours: mesh.colours.clone(),
    }
}
