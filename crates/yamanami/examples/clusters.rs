//! Builds the cluster hierarchy of a mesh file and prints what the decision note on it needs: size, levels, times, and the
//! promised error beside the measured one.
//!
//! `cargo run --release -p yamanami --example clusters -- MESH [COPIES [FIELD]]`: COPIES builds so many copies of the mesh
//! in a row, FIELD times the controller over a field of FIELD by FIELD copies of the hierarchy.

use glam::DVec3;
use std::time::Instant;
use yamanami::core::{
    ActiveSet, BASE_CLUSTERS, ClusterPage, Hierarchy, NodeId, NodeList, Sink, Sphere, Surface, SurfaceVertex,
    TriangleMesh, View,
};
use yamanami::io::mesh_file::read_mesh;
use yamanami::measure::surface_distance;
use yamanami::multires::cluster::{ClusterBuild, ClusterOptions, ClusterSurface, build};
use yamanami::{Controller, Criteria, Step, ViewCriterion};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let name = args.next().ok_or("which mesh?")?;
    let copies: u32 = args.next().map_or(Ok(1), |n| n.parse())?;
    let field: u32 = args.next().map_or(Ok(0), |n| n.parse())?;
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
    if field > 0 {
        let step_m = mesh.bounds().diagonal();
        let field = Resident(field_of(&built, field, step_m)?);
        let side_m = step_m * f64::from(field.0.roots().len() as u32).sqrt();
        controls(&field, mesh.bounds().centre(), side_m, None);
    }
    let surface = built.into_surface()?;
    println!("{:.1} bytes a source triangle resident", surface.resident_bytes() as f64 / mesh.triangles.len() as f64);
    controls(&surface, mesh.bounds().centre(), mesh.bounds().diagonal(), Some(&surface));
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

/// A hierarchy whose pages count as being in memory.
struct Resident(ClusterSurface);

impl Hierarchy for Resident {
    fn node_bound(&self) -> NodeId {
        self.0.node_bound()
    }
    fn exists(&self, node: NodeId) -> bool {
        self.0.exists(node)
    }
    fn roots(&self) -> Vec<NodeId> {
        self.0.roots()
    }
    fn parents(&self, node: NodeId) -> NodeList {
        self.0.parents(node)
    }
    fn children(&self, node: NodeId) -> NodeList {
        self.0.children(node)
    }
    fn parent_count(&self, node: NodeId) -> usize {
        self.0.parent_count(node)
    }
    fn error_m(&self, node: NodeId) -> f32 {
        self.0.error_m(node)
    }
    fn bound(&self, node: NodeId) -> Sphere {
        self.0.bound(node)
    }
    fn error_and_bound(&self, node: NodeId) -> (f32, Sphere) {
        self.0.error_and_bound(node)
    }
    fn triangles_added(&self, node: NodeId, active: &dyn ActiveSet) -> i32 {
        self.0.triangles_added(node, active)
    }
    fn base_triangle_count(&self) -> usize {
        self.0.base_triangle_count()
    }
    fn level(&self, node: NodeId) -> u32 {
        self.0.level(node)
    }
}

/// Copies of a hierarchy's nodes side by side, as the nodes of one.
fn field_of(built: &ClusterBuild, side: u32, step_m: f64) -> Result<ClusterSurface, Box<dyn std::error::Error>> {
    let (count, clusters) = (built.nodes.len() as u32, built.base_clusters.len() as u16);
    let mut base = ClusterPage { group: BASE_CLUSTERS, vertices: vec![], removed: vec![], triangles: vec![] };
    let (mut nodes, mut base_clusters) = (Vec::new(), Vec::new());
    let mut next = side * side * built.base.vertices.len() as u32;
    for copy in 0..side * side {
        let first = base.vertices.len() as u32;
        base.vertices.extend_from_slice(&built.base.vertices);
        base.triangles.extend(built.base.triangles.iter().map(|t| t.map(|v| v + first)));
        base_clusters.extend_from_slice(&built.base_clusters);
        for node in &built.nodes {
            let mut node = node.clone();
            node.bound.centre += DVec3::new(f64::from(copy % side), f64::from(copy / side), 0.0) * step_m;
            node.first_vertex = next;
            next += node.vertex_count;
            for (group, place) in &mut node.replaced {
                match *group {
                    BASE_CLUSTERS => *place += copy as u16 * clusters,
                    _ => *group += copy * count,
                }
            }
            nodes.push(node);
        }
    }
    Ok(ClusterSurface::new(&nodes, &base_clusters, base)?)
}

/// Times the controller from nothing, and along a flight; and the emitting of what changes.
fn controls(hierarchy: &impl Hierarchy, middle: DVec3, size: f64, surface: Option<&ClusterSurface>) {
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
        let mut best_ms = f64::INFINITY;
        for _ in 0..5 {
            let mut controller = Controller::new(hierarchy);
            let start = Instant::now();
            controller.update(hierarchy, &criteria(0), |_, _| ());
            best_ms = best_ms.min(start.elapsed().as_secs_f64() * 1e3);
        }
        let mut controller = Controller::new(hierarchy);
        let report = controller.update(hierarchy, &criteria(0), |_, _| ());
        let (mut steps, mut update_ms, mut emit_ms) = (0, 0.0, 0.0);
        let mut delta = Vec::new();
        for i in 1..=100 {
            delta.clear();
            let start = Instant::now();
            let r = controller.update(hierarchy, &criteria(i), |step, _| delta.push(step));
            update_ms += start.elapsed().as_secs_f64() * 10.0;
            steps += r.refined + r.coarsened;
            let Some(surface) = surface else { continue };
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
            "{tolerance_px} px: {} triangles, {} of {} nodes, from nothing {best_ms:.3} ms; a frame {update_ms:.4} ms, \
             {:.1} steps, emitting {emit_ms:.4} ms",
            report.triangles,
            report.refined,
            hierarchy.node_bound(),
            f64::from(steps as u32) / 100.0
        );
    }
}

/// Takes all and keeps nothing.
struct Nowhere;

impl Sink for Nowhere {
    fn add_vertex(&mut self, id: u32, vertex: SurfaceVertex) {
        std::hint::black_box((id, vertex));
    }
    fn update_vertex(&mut self, id: u32, vertex: SurfaceVertex) {
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
