//! The laws over cluster hierarchies of real scans. Skipped where the shared data are absent.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use yamanami_core::{ActiveSet, Hierarchy, NodeId, Surface, TriangleMesh};
use yamanami_io::mesh_file::read_mesh;
use yamanami_measure::surface_distance;
use yamanami_multires::cluster::{ClusterOptions, ClusterSurface, build};
use yamanami_testkit::laws::{Kind, closure_law_of, hierarchy_law, surface_law};
use yamanami_testkit::{RandomFront, Rng};

fn scan(name: &str) -> Option<TriangleMesh> {
    let folder: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/mesh");
    let path = folder.join(name);
    path.exists().then(|| read_mesh(path).unwrap())
}

fn built(mesh: &TriangleMesh) -> ClusterSurface {
    build(mesh, &ClusterOptions::default()).unwrap().into_surface().unwrap()
}

/// The most triangles at an edge, and how many edges have not two.
fn edges(mesh: &TriangleMesh) -> (usize, usize) {
    let mut edges: HashMap<[u32; 2], usize> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (v, w) in [(a, b), (b, c), (c, a)] {
            *edges.entry([v.min(w), v.max(w)]).or_default() += 1;
        }
    }
    (edges.values().copied().max().unwrap_or(0), edges.values().filter(|&&n| n != 2).count())
}

#[test]
fn closed_scans_obey_the_laws() {
    for name in ["stanford_bunny_69451f.obj", "gargoyle_50000f_vertexcolour.ply"] {
        let Some(mesh) = scan(name) else { return };
        let surface = built(&mesh);
        hierarchy_law(&surface);
        surface_law(&surface, 1);
        let full = surface.mesh_of(&|_: NodeId| true);
        assert_eq!(full.triangles.len(), mesh.triangles.len(), "{name}");
        if edges(&full) == (2, 0) {
            assert!(surface.base_triangle_count() <= 256, "{name}: {}", surface.base_triangle_count());
            closure_law_of(&surface, 1, Kind::Solid);
        }
    }
}

#[test]
fn a_defective_scan_gets_no_worse_in_any_cut() {
    let Some(mesh) = scan("bunny_defective_99785f.ply") else { return };
    let surface = built(&mesh);
    hierarchy_law(&surface);
    surface_law(&surface, 2);
    let nodes = surface.node_bound() as usize;
    let source = edges(&surface.mesh_of(&|_: NodeId| true));
    let mut rng = Rng::new(4);
    for seed in 0..60 {
        let mut front = RandomFront::new(&surface, seed);
        front.wander(4 * nodes, 1 + rng.below(nodes));
        let (most, odd) = edges(&surface.mesh_of(&|n: NodeId| front.is_active(n)));
        assert!(most <= source.0 && odd <= source.1, "{most} {odd}, the source {source:?}");
    }
}

#[test]
fn what_is_promised_of_a_scan_is_kept() {
    let Some(mesh) = scan("gargoyle_50000f_vertexcolour.ply") else { return };
    let surface = built(&mesh);
    let diagonal_m = mesh.bounds().diagonal();
    for share in [1e-2, 2e-3] {
        let tolerance_m = (share * diagonal_m) as f32;
        let front = surface.mesh_of(&|n: NodeId| surface.error_m(n) > tolerance_m);
        let measured_m = surface_distance(&mesh, &front, 100_000, 3).hausdorff_m;
        assert!(measured_m <= f64::from(tolerance_m), "{measured_m} m off, {tolerance_m} m promised");
    }
}
