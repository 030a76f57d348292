//! Builds the cluster hierarchy of a mesh file and prints what the decision note on it needs: size, levels, times, and the
//! promised error beside the measured one.
//!
//! `cargo run --release -p yamanami --example clusters -- MESH [COPIES]`; COPIES puts so many copies of the mesh in a row.

use glam::DVec3;
use std::time::Instant;
use yamanami::core::{Hierarchy, MeshMirror, NodeId, Surface, TriangleMesh, View};
use yamanami::io::mesh_file::read_mesh;
use yamanami::measure::surface_distance;
use yamanami::multires::cluster::{ClusterOptions, ClusterSurface, build};
use yamanami::{Controller, Criteria, Step, ViewCriterion};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let name = args.next().ok_or("which mesh?")?;
    let copies: u32 = args.next().map_or(Ok(1), |n| n.parse())?;
    let one = read_mesh(&name)?;
    let mesh = in_a_row(&one, copies);
    let start = Instant::now();
    let built = build(&mesh, &ClusterOptions::default())?;
    let build_s = start.elapsed().as_secs_f64();
    let summary = built.summary;
    let stored: usize = built.pages.iter().map(|p| p.triangles.len()).sum::<usize>() + built.base.triangles.len();
    let clusters: usize = built.nodes.iter().map(|n| n.cluster_triangles.len()).sum();
    let levels = built.nodes.iter().map(|n| n.level + 1).max().unwrap_or(0);
    println!(
        "{name}: {} triangles, {:.2} s = {:.0} triangles/s on {} threads",
        summary.source_triangles,
        build_s,
        summary.source_triangles as f64 / build_s,
        rayon::current_num_threads()
    );
    println!(
        "{} nodes, {clusters} clusters of {:.1} triangles, {levels} levels, {} rounds, factor {:.3}, base {} triangles",
        built.nodes.len(),
        stored as f64 / (clusters + built.base_clusters.len()) as f64,
        summary.rounds,
        stored as f64 / summary.source_triangles as f64,
        built.base.triangles.len()
    );
    println!("{} stuck groups, {} tried again", summary.stuck_groups, summary.retried_groups);
    let surface = built.into_surface()?;
    println!("{:.1} bytes a source triangle resident", surface.resident_bytes() as f64 / mesh.triangles.len() as f64);
    controls(&surface, &mesh);
    if copies == 1 {
        errors(&surface, &mesh);
    }
    Ok(())
}

fn in_a_row(mesh: &TriangleMesh, copies: u32) -> TriangleMesh {
    let step = DVec3::X * 1.1 * mesh.bounds().diagonal();
    let mut row = TriangleMesh::default();
    for i in 0..copies {
        let first = row.positions.len() as u32;
        row.positions.extend(mesh.positions.iter().map(|&p| p + step * f64::from(i)));
        row.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    row
}

/// Times the controller from nothing, and along a flight.
fn controls(surface: &ClusterSurface, mesh: &TriangleMesh) {
    let bounds = mesh.bounds();
    let (middle, size) = (bounds.centre(), bounds.diagonal());
    let view = |i: usize| {
        let turn = i as f64 * 0.01;
        let eye = middle + DVec3::new(turn.cos(), turn.sin(), 0.3) * size * 0.8;
        View { eye, target: middle, fov_y_rad: 0.8, viewport_px: [1920, 1080] }
    };
    for tolerance_px in [4.0, 1.0, 0.25] {
        let criteria = |i: usize| Criteria {
            view: Some(ViewCriterion { view: view(i), tolerance_px, cull: true }),
            ..Criteria::default()
        };
        let mut controller = Controller::new(surface);
        let start = Instant::now();
        let report = controller.update(surface, &criteria(0), |_, _| ());
        let scratch_ms = start.elapsed().as_secs_f64() * 1e3;
        let mut sink = MeshMirror::default();
        surface.emit_base(&mut sink);
        let (mut steps, mut update_ms, mut emit_ms) = (0, 0.0, 0.0);
        let mut delta = Vec::new();
        for i in 1..=100 {
            delta.clear();
            let start = Instant::now();
            let r = controller.update(surface, &criteria(i), |step, _| delta.push(step));
            update_ms += start.elapsed().as_secs_f64() * 10.0;
            steps += r.refined + r.coarsened;
            let start = Instant::now();
            // into a sink that takes all: the cost of emitting alone
            for &step in &delta {
                match step {
                    Step::Refine(n) => surface.refine(n, &|_: NodeId| false, &mut Nowhere),
                    Step::Coarsen(n) => surface.coarsen(n, &|_: NodeId| false, &mut Nowhere),
                }
            }
            emit_ms += start.elapsed().as_secs_f64() * 10.0;
        }
        println!(
            "{tolerance_px} px: {} triangles, {} of {} nodes, from nothing {scratch_ms:.3} ms; a frame {update_ms:.4} ms, {:.1} steps, emitting {emit_ms:.4} ms",
            report.triangles,
            report.refined,
            surface.node_bound(),
            steps as f64 / 100.0
        );
    }
}

struct Nowhere;

impl yamanami::core::Sink for Nowhere {
    fn add_vertex(&mut self, id: u32, vertex: yamanami::core::SurfaceVertex) {
        std::hint::black_box((id, vertex));
    }
    fn update_vertex(&mut self, id: u32, vertex: yamanami::core::SurfaceVertex) {
        std::hint::black_box((id, vertex));
    }
    fn remove_vertex(&mut self, id: u32) {
        std::hint::black_box(id);
    }
    fn add_triangle(&mut self, key: u64, corners: [u32; 3]) {
        std::hint::black_box((key, corners));
    }
    fn remove_triangle(&mut self, key: u64) {
        std::hint::black_box(key);
    }
}

/// For some tolerances the error promised and the one measured, of the diagonal.
fn errors(surface: &ClusterSurface, mesh: &TriangleMesh) {
    let diagonal = mesh.bounds().diagonal();
    for share in [3e-2, 1e-2, 3e-3, 1e-3, 3e-4] {
        let tolerance_m = (share * diagonal) as f32;
        let front = surface.mesh_of(&|n: NodeId| surface.error_m(n) > tolerance_m);
        let promised =
            (0..surface.node_bound()).map(|n| surface.error_m(n)).filter(|&e| e <= tolerance_m).fold(0f32, f32::max);
        let measured = surface_distance(mesh, &front, 300_000, 1);
        println!(
            "tolerance {share:.0e}: {} triangles, promised {:.2e}, measured at most {:.2e}, RMS {:.2e}",
            front.triangles.len(),
            f64::from(promised) / diagonal,
            measured.hausdorff_m / diagonal,
            measured.rms_m / diagonal
        );
    }
}
