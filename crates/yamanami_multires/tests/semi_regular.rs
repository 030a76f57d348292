//! The laws over semi-regular surfaces: closed, with border, of one triangle, in pieces; and the meshes of kept details.

use glam::DVec3;
use proptest::prelude::*;
use yamanami_core::{ActiveSet, BaseMesh, Hierarchy, MeshMirror, NodeId, SemiRegular, Surface, TriangleMesh};
use yamanami_multires::bound::{BoundOptions, distance_bound};
use yamanami_multires::semi_regular::{SemiRegularSurface, close, recognise, thresholded};
use yamanami_testkit::laws::{Kind, closure_law_of, hierarchy_law, surface_law};
use yamanami_testkit::{Rng, check_conforming, models};

/// Midpoints stand off their edges at random, half as far a level; those on the border stay on it.
fn rough(base: &TriangleMesh, levels: u32, roughness: f64, seed: u64) -> (SemiRegular, Vec<DVec3>) {
    let surface = BaseMesh::new(base.positions.len() as u32, base.triangles.clone()).unwrap();
    let mesh = SemiRegular::new(surface, levels).unwrap();
    let mut rng = Rng::new(seed);
    let mut positions = base.positions.clone();
    let mut ring = Vec::new();
    for level in 1..=levels {
        for v in mesh.new_vertices(level) {
            let [p, q] = mesh.parents(v).unwrap().map(|end| positions[end as usize]);
            let off = DVec3::from(std::array::from_fn(|_| 2.0 * rng.unit() - 1.0));
            let by = if mesh.ring(level, v, &mut ring) { roughness * (q - p).length() } else { 0.0 };
            positions.push(0.5 * (p + q) + by * off);
        }
    }
    (mesh, positions)
}

fn bases() -> Vec<(TriangleMesh, u32)> {
    let sheet = |n: u32, m: u32| models::sheet([n, m], [false, false], |u, v| DVec3::new(u, v, 0.0));
    let mut pieces = models::torus(4, 3, 0.0);
    let first = pieces.positions.len() as u32;
    pieces.positions.extend([DVec3::ONE * 9.0, DVec3::ONE * 9.0 + DVec3::X, DVec3::ONE * 9.0 + DVec3::Y]);
    pieces.triangles.push([first, first + 1, first + 2]);
    vec![
        (models::sphere(0), 4),
        (models::torus(5, 3, 0.0), 3),
        (sheet(3, 2), 4),
        (sheet(1, 1), 5),
        (TriangleMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]), 5),
        (pieces, 3),
        (sheet(3, 3), 1),
        (sheet(2, 1), 0),
    ]
}

fn surfaces() -> Vec<SemiRegularSurface> {
    let built = (0u64..).zip(bases()).map(|(seed, (base, levels))| {
        let (mesh, positions) = rough(&base, levels, 0.2, seed);
        SemiRegularSurface::new(mesh, positions, Vec::new()).unwrap()
    });
    built.collect()
}

#[test]
fn every_surface_obeys_the_hierarchy_law() {
    surfaces().iter().for_each(hierarchy_law);
}

#[test]
fn every_front_is_conforming() {
    for surface in surfaces() {
        for seed in 0..3 {
            closure_law_of(&surface, seed, Kind::Solid);
        }
    }
}

#[test]
fn refining_then_coarsening_restores_the_sink() {
    for surface in surfaces() {
        surface_law(&surface, 1);
    }
}

#[test]
fn a_front_emitted_whole_is_the_front_reached_by_steps() {
    for surface in surfaces() {
        for tolerance_m in [0.3, 0.1, 0.03] {
            let active = |node: NodeId| surface.exists(node) && surface.error_m(node) > tolerance_m;
            let mut by_steps = MeshMirror::default();
            surface.emit_base(&mut by_steps);
            for node in (0..surface.node_bound()).filter(|&n| active(n)) {
                surface.refine(node, &|n: NodeId| n < node && active(n), &mut by_steps);
            }
            let mut whole = MeshMirror::default();
            surface.emit_front(&active, &mut whole);
            assert_eq!(whole, by_steps);
            assert_eq!(whole.to_mesh().positions, surface.mesh_of(&active).positions);
        }
    }
}

#[test]
fn colours_and_normals_are_those_of_the_vertices() {
    let (mesh, positions) = rough(&models::sphere(0), 4, 0.0, 1);
    let positions: Vec<DVec3> = positions.iter().map(|p| p.normalize()).collect();
    let colours: Vec<[u8; 4]> = (0..positions.len()).map(|v| [v as u8, (v >> 8) as u8, 3, 255]).collect();
    let surface = SemiRegularSurface::new(mesh, positions, colours.clone()).unwrap();
    let full = surface.mesh_of(&|_: NodeId| true);
    assert_eq!(full.colours, colours);
    for (p, n) in full.positions.iter().zip(&full.normals) {
        assert!(p.dot(DVec3::from(n.map(f64::from))) > 0.99);
    }
    let mut mirror = MeshMirror::default();
    surface.emit_base(&mut mirror);
    assert_eq!(mirror.vertices[&5].colour, [5, 0, 3]);
    surface.refine(6, &|_: NodeId| false, &mut mirror);
    // a chord of a right angle bulges by 1 - √½
    assert!((f64::from(mirror.vertices[&6].detail_m) - (1.0 - 0.5f64.sqrt())).abs() < 0.01);
}

#[test]
fn an_error_promised_is_kept_on_every_front() {
    for (seed, (base, levels)) in (0u64..).zip(bases()) {
        let (mesh, positions) = rough(&base, levels, 0.2, seed);
        let surface = SemiRegularSurface::new(mesh, positions, Vec::new()).unwrap();
        let full = surface.mesh_of(&|_: NodeId| true);
        let check = |what: &str, active: &dyn ActiveSet| {
            let promised_m = (0..surface.node_bound())
                .filter(|&n| surface.exists(n) && !active.is_active(n))
                .fold(0.0, |worst, n| f64::max(worst, f64::from(surface.error_m(n))));
            let front = surface.mesh_of(active);
            // so far off at least
            let options = BoundOptions { relative_gap: 0.02, ..BoundOptions::default() };
            let off_m = distance_bound(&front, &full, &options).lower_m();
            assert!(off_m <= promised_m, "{what}: {off_m} m off where {promised_m} m are promised");
        };
        for tolerance_m in [0.3, 0.1, 0.05] {
            check("one tolerance", &|n: NodeId| surface.exists(n) && surface.error_m(n) > tolerance_m);
        }
        let mut rng = Rng::new(4);
        for _ in 0..2 {
            let mut kept: Vec<bool> = (0..surface.node_bound()).map(|_| rng.chance(0.03)).collect();
            close(surface.mesh(), &mut kept).unwrap();
            check("a random front", &|n: NodeId| kept[n as usize]);
        }
    }
}

#[test]
fn what_is_flat_needs_no_node() {
    let base = models::sheet([3, 2], [false, false], |u, v| DVec3::new(4.0 * u, 4.0 * v, 1.0));
    let (mesh, positions) = rough(&base, 4, 0.0, 0);
    let surface = SemiRegularSurface::new(mesh, positions, Vec::new()).unwrap();
    assert!((0..surface.node_bound()).all(|n| surface.error_m(n) < 1e-6));
    // one spike: its node and what that needs
    let (mesh, mut positions) = rough(&base, 4, 0.0, 0);
    let spike = positions.len() - 1;
    positions[spike].z += 0.5;
    let surface = SemiRegularSurface::new(mesh, positions, Vec::new()).unwrap();
    let needed = (0..surface.node_bound()).filter(|&n| surface.error_m(n) > 1e-6).count();
    assert!((4..40).contains(&needed), "{needed}");
    assert!((0.5..0.51).contains(&surface.error_m(spike as u32)));
}

#[test]
fn a_plain_mesh_recognised_is_shown_as_it_was() {
    let source = models::sphere(4);
    let found = recognise(&source).unwrap();
    let positions: Vec<DVec3> = found.source_vertex.iter().map(|&v| source.positions[v as usize]).collect();
    let surface = SemiRegularSurface::new(found.mesh, positions, Vec::new()).unwrap();
    assert_eq!(surface.base_triangle_count(), 8);
    let full = surface.mesh_of(&|_: NodeId| true);
    let sorted = |mesh: &TriangleMesh| {
        let corners = |t| mesh.corners(t).map(|p: DVec3| p.to_array().map(f64::to_bits));
        let mut all: Vec<_> = (0..mesh.triangles.len()).map(corners).collect();
        for t in &mut all {
            let least = (0..3).min_by_key(|&k| t[k]).unwrap();
            t.rotate_left(least);
        }
        all.sort_unstable();
        all
    };
    assert_eq!(sorted(&full), sorted(&source));
}

#[test]
fn moving_along_the_surface_is_no_error() {
    let base = TriangleMesh::new(vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0], vec![[0, 1, 2]]);
    let (mesh, mut positions) = rough(&base, 1, 0.0, 0);
    positions[3].x += 0.5;
    positions[4] += DVec3::new(0.25, -0.25, 0.0);
    positions[5].y -= 1.0;
    let surface = SemiRegularSurface::new(mesh, positions, Vec::new()).unwrap();
    assert!((3..6).all(|node| surface.error_m(node) == 0.0));
}

#[test]
fn two_sides_of_one_triangle_and_places_all_in_one_are_lawful() {
    let pillow = TriangleMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2], [0, 2, 1]]);
    let (mesh, positions) = rough(&pillow, 4, 0.2, 3);
    let surface = SemiRegularSurface::new(mesh.clone(), positions, Vec::new()).unwrap();
    hierarchy_law(&surface);
    surface_law(&surface, 2);
    let nowhere = vec![DVec3::ONE; mesh.vertex_count(4) as usize];
    let surface = SemiRegularSurface::new(mesh, nowhere, Vec::new()).unwrap();
    assert!((3..surface.node_bound()).all(|node| surface.error_m(node) == 0.0));
    hierarchy_law(&surface);
}

#[test]
fn the_result_does_not_depend_on_the_threads() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (mesh, positions) = rough(&models::torus(5, 3, 0.0), 5, 0.2, 8);
        let surface = pool.install(|| SemiRegularSurface::new(mesh, positions, Vec::new()).unwrap());
        let all: Vec<_> = (0..surface.node_bound()).map(|n| surface.error_and_bound(n)).collect();
        (all, surface.mesh_of(&|_: NodeId| false))
    };
    assert!(with(1) == with(3));
}

#[test]
fn what_does_not_fit_is_refused_in_one_line() {
    let complaint = |spoil: &dyn Fn(&mut Vec<DVec3>), colours: usize| {
        let (mesh, mut positions) = rough(&models::sphere(0), 1, 0.0, 0);
        spoil(&mut positions);
        SemiRegularSurface::new(mesh, positions, vec![[0; 4]; colours]).unwrap_err().to_string()
    };
    let start = "a semi-regular mesh of 18 vertices: expected as many ";
    assert_eq!(complaint(&|p| p.truncate(5), 0), format!("{start}places, given 5"));
    assert_eq!(complaint(&|_| (), 7), format!("{start}colours, given 7"));
    assert_eq!(complaint(&|p| p[2].y = f64::NAN, 0), format!("{start}places within ±1e30 m, given 17"));
    assert_eq!(complaint(&|p| p[2].y = f64::INFINITY, 0), format!("{start}places within ±1e30 m, given 17"));
    let (mesh, positions) = rough(&models::sphere(0), 1, 0.0, 0);
    assert!(thresholded(&mesh, &[true; 3], &positions).unwrap_err().to_string().contains("marks, given 3"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_mesh_of_kept_details_has_no_crack(which in 0usize..8, share in 0.0f64..0.2, seed in any::<u64>()) {
        let (base, levels) = bases().swap_remove(which);
        let (mesh, positions) = rough(&base, levels, 0.2, seed);
        let mut rng = Rng::new(seed);
        let kept: Vec<bool> = positions.iter().map(|_| rng.chance(share)).collect();
        let found = thresholded(&mesh, &kept, &positions).unwrap();
        prop_assert_eq!(check_conforming(&found.mesh, &base, Kind::Solid), Ok(()));
        prop_assert!(found.vertices.is_sorted());
        for (v, _) in kept.iter().enumerate().filter(|(_, kept)| **kept) {
            prop_assert!(found.vertices.binary_search(&(v as u32)).is_ok());
        }
        // every vertex is in some triangle, and where it should be
        let mut used = vec![false; found.vertices.len()];
        found.mesh.triangles.as_flattened().iter().for_each(|&v| used[v as usize] = true);
        prop_assert!(used.iter().all(|&u| u));
        let places: Vec<DVec3> = found.vertices.iter().map(|&v| positions[v as usize]).collect();
        prop_assert_eq!(places, found.mesh.positions);
    }
}

#[test]
fn everything_kept_is_the_finest_mesh_and_nothing_the_base() {
    for (base, levels) in bases() {
        let (mesh, positions) = rough(&base, levels, 0.2, 5);
        let sorted = |triangles: &[[u32; 3]]| {
            let mut all = triangles.to_vec();
            for t in &mut all {
                let least = (0..3).min_by_key(|&k| t[k]).unwrap();
                t.rotate_left(least);
            }
            all.sort_unstable();
            all
        };
        let all = thresholded(&mesh, &vec![true; positions.len()], &positions).unwrap();
        assert_eq!(sorted(&all.mesh.triangles), sorted(&mesh.triangles(levels)));
        assert_eq!(all.mesh.positions, positions);
        let none = thresholded(&mesh, &vec![false; positions.len()], &positions).unwrap();
        assert_eq!(sorted(&none.mesh.triangles), sorted(&base.triangles));
        assert_eq!(none.mesh.positions, base.positions);
    }
}
