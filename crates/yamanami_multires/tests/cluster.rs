//! The laws over cluster hierarchies of made meshes: closed, open, in pieces and with defects.

use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::{ActiveSet, Hierarchy, NodeId, Surface, TriangleMesh};
use yamanami_multires::cluster::{ClusterBuild, ClusterOptions, ClusterSurface, build};
use yamanami_testkit::laws::{Kind, closure_law_of, hierarchy_law, surface_law};
use yamanami_testkit::{RandomFront, Rng, ball, ring, torus};

fn built(mesh: &TriangleMesh) -> ClusterBuild {
    build(mesh, &ClusterOptions::default()).unwrap()
}

/// A small cluster makes many nodes of a small mesh.
fn finely_built(mesh: &TriangleMesh) -> ClusterSurface {
    let options = ClusterOptions { cluster_triangles: 24, group_clusters: 6, ..ClusterOptions::default() };
    build(mesh, &options).unwrap().into_surface().unwrap()
}

/// Undirected edges with the number of their triangles.
fn edges(mesh: &TriangleMesh) -> HashMap<[u32; 2], usize> {
    let mut edges = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (v, w) in [(a, b), (b, c), (c, a)] {
            *edges.entry([v.min(w), v.max(w)]).or_default() += 1;
        }
    }
    edges
}

/// Takes random fronts and looks at the edges of each.
fn cuts(surface: &ClusterSurface, count: u64, check: impl Fn(&HashMap<[u32; 2], usize>)) {
    let nodes = surface.node_bound() as usize;
    let mut rng = Rng::new(99);
    for seed in 0..count {
        let mut front = RandomFront::new(surface, seed);
        front.wander(4 * nodes, 1 + rng.below(nodes));
        check(&edges(&surface.mesh_of(&|n: NodeId| front.is_active(n))));
    }
}

#[test]
fn closed_meshes_obey_the_laws() {
    for mesh in [ring(96, 40), ball(26)] {
        let surface = finely_built(&mesh);
        assert!(surface.base_triangle_count() <= 48, "{}", surface.base_triangle_count());
        assert!(surface.node_bound() > 40);
        hierarchy_law(&surface);
        for seed in 0..4 {
            closure_law_of(&surface, seed, Kind::Solid);
            surface_law(&surface, seed);
        }
    }
}

#[test]
fn a_thousand_cuts_have_no_crack() {
    let surface = finely_built(&ring(90, 36));
    cuts(&surface, 1000, |edges| assert!(edges.values().all(|&n| n == 2)));
}

#[test]
fn the_full_front_is_the_source() {
    let mut mesh = ball(20);
    mesh.colours = mesh.positions.iter().map(|p| [(100.0 + 90.0 * p.x) as u8, 7, 200, 255]).collect();
    let surface = built(&mesh).into_surface().unwrap();
    let full = surface.mesh_of(&|_: NodeId| true);
    let key = |mesh: &TriangleMesh, t: [u32; 3]| {
        let mut corners =
            t.map(|v| (mesh.positions[v as usize].to_array().map(f64::to_bits), mesh.colours[v as usize]));
        let least = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
        corners.rotate_left(least);
        corners
    };
    let sorted = |mesh: &TriangleMesh| {
        let mut keys: Vec<_> = mesh.triangles.iter().map(|&t| key(mesh, t)).collect();
        keys.sort_unstable();
        keys
    };
    assert_eq!(sorted(&full), sorted(&mesh));
    let coarse = surface.mesh_of(&|_: NodeId| false);
    for (p, c) in coarse.positions.iter().zip(&coarse.colours) {
        let expected = 100.0 + 90.0 * p.x;
        assert!((f64::from(c[0]) - expected).abs() < 12.0, "{c:?} at {p}, expected about {expected}");
    }
}

#[test]
fn the_result_does_not_depend_on_the_threads() {
    let mesh = ring(120, 60);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let built = pool.install(|| built(&mesh));
        (built.nodes, built.base_clusters, built.base, built.pages)
    };
    assert!(with(1) == with(3));
}

#[test]
fn the_unit_of_length_does_not_matter() {
    let mesh = ring(120, 60);
    let mut large = mesh.clone();
    large.positions.iter_mut().for_each(|p| *p *= 1024.0);
    let (one, other) = (built(&mesh), built(&large));
    assert_eq!(one.base.triangles, other.base.triangles);
    for (a, b) in one.pages.iter().zip(&other.pages) {
        assert_eq!(a.triangles, b.triangles);
    }
    for (a, b) in one.nodes.iter().zip(&other.nodes) {
        assert!((a.error_m * 1024.0 - b.error_m).abs() <= 1e-3 * b.error_m, "{} {}", a.error_m, b.error_m);
    }
}

#[test]
fn open_sheets_and_pieces_are_built_down_to_little() {
    // a sheet with a wavy border and a hole
    let n = 60;
    let mut sheet = torus(n, n, |u, v| DVec3::new(u, v, 0.2 * (3.0 * u).sin() * (2.0 * v).cos()));
    sheet.triangles.retain(|t| {
        let far = |v: u32| v.is_multiple_of(n) || v < n;
        let wraps = t.iter().any(|&v| far(v)) && t.iter().any(|&v| v % n == n - 1 || v / n == n - 1);
        let middle = t.iter().all(|&v| (20..30).contains(&(v % n)) && (20..30).contains(&(v / n)));
        !wraps && !middle
    });
    let surface = finely_built(&sheet);
    hierarchy_law(&surface);
    surface_law(&surface, 1);
    assert!(surface.base_triangle_count() <= 200, "{}", surface.base_triangle_count());
    cuts(&surface, 200, |edges| assert!(edges.values().all(|&n| n <= 2)));

    // many balls far apart
    let mut pieces = TriangleMesh::default();
    for i in 0..150u32 {
        let piece = ball(3);
        let first = pieces.positions.len() as u32;
        let at = DVec3::new(f64::from(i % 13), f64::from(i / 13), f64::from(i % 7)) * 5.0;
        pieces.positions.extend(piece.positions.iter().map(|&p| p + at));
        pieces.triangles.extend(piece.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let surface = finely_built(&pieces);
    hierarchy_law(&surface);
    surface_law(&surface, 2);
    // a closed piece keeps four faces, or vanishes as a whole
    assert!(surface.base_triangle_count() <= 1500, "{}", surface.base_triangle_count());
    cuts(&surface, 50, |edges| assert!(edges.values().all(|&n| n == 2)));
}

#[test]
fn any_triangles_at_all_build_into_something_lawful() {
    let mut rng = Rng::new(5);
    for trial in 0..12 {
        // random corners among few vertices: fans, edges of many triangles, twins, flat triangles, vertices in no triangle
        let vertices = 20 + 40 * trial;
        let place = |rng: &mut Rng| DVec3::new(rng.unit(), rng.unit(), if trial % 2 == 0 { 0.0 } else { rng.unit() });
        let positions = (0..vertices).map(|_| place(&mut rng)).collect();
        let near = |rng: &mut Rng, v: usize| ((v + rng.below(9)) % vertices) as u32;
        let triangles = (0..1500)
            .map(|_| {
                let v = rng.below(vertices);
                [near(&mut rng, v), near(&mut rng, v), near(&mut rng, v)]
            })
            .collect();
        let surface = finely_built(&TriangleMesh::new(positions, triangles));
        hierarchy_law(&surface);
        surface_law(&surface, 3);
    }
    let one = TriangleMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]);
    let surface = finely_built(&one);
    assert_eq!((surface.base_triangle_count(), surface.node_bound()), (1, 0));
}

/// How far the vertices of each front are from the source's surface, and the source's vertices from the front's, measured
/// plainly.
fn farthest(from: &TriangleMesh, to: &TriangleMesh) -> f64 {
    let mut worst = 0f64;
    for &p in &from.positions {
        let nearest = (0..to.triangles.len()).map(|t| point_distance(p, to.corners(t))).fold(f64::INFINITY, f64::min);
        worst = worst.max(nearest);
    }
    worst
}

fn point_distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = [(a, b), (b, c), (c, a)].iter().all(|&(v, w)| (w - v).cross(p - v).dot(normal) >= 0.0);
    if inside {
        return (p - a).dot(normal.normalize()).abs();
    }
    let on_edge = |v: DVec3, w: DVec3| {
        let t = ((p - v).dot(w - v) / (w - v).length_squared()).clamp(0.0, 1.0);
        (v + (w - v) * t - p).length()
    };
    on_edge(a, b).min(on_edge(b, c)).min(on_edge(c, a))
}

#[test]
fn an_error_promised_is_kept() {
    let mesh = ring(60, 30);
    let surface = finely_built(&mesh);
    for tolerance_m in [0.3, 0.1, 0.05, 0.02, 0.005] {
        let front = surface.mesh_of(&|n: NodeId| surface.error_m(n) > tolerance_m);
        let off = farthest(&front, &mesh).max(farthest(&mesh, &front));
        assert!(off <= f64::from(tolerance_m), "{off} m off at {tolerance_m} m");
    }
}
