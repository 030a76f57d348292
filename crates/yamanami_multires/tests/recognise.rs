//! Levels of semi-regular meshes are found again, whatever the base mesh and the order.

use glam::DVec3;
use proptest::prelude::*;
use std::collections::BTreeSet;
use yamanami_core::{BaseMesh, SemiRegular, TriangleMesh};
use yamanami_multires::semi_regular::{Recognised, recognise};
use yamanami_testkit::{Rng, ball, models};

fn base_of(kind: usize, n: u32, m: u32) -> TriangleMesh {
    match kind {
        0 => models::torus(n + 2, m + 2, 0.0),
        1 => models::sphere(0),
        2 => models::sheet([n, m], [false, false], |u, v| DVec3::new(u, v, 0.0)),
        3 => models::sheet([n + 2, m], [true, false], |u, v| DVec3::new(u, v, 0.0)),
        4 => TriangleMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]),
        _ => ball(n),
    }
}

fn together(a: &TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let mut all = a.clone();
    let first = all.positions.len() as u32;
    all.positions.extend(&b.positions);
    all.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    all
}

fn split(base: &TriangleMesh, levels: u32) -> TriangleMesh {
    let surface = BaseMesh::new(base.positions.len() as u32, base.triangles.clone()).unwrap();
    let mesh = SemiRegular::new(surface, levels).unwrap();
    let mut positions = base.positions.clone();
    for v in mesh.vertex_count(0)..mesh.vertex_count(levels) {
        let [p, q] = mesh.parents(v).unwrap();
        positions.push(0.5 * (positions[p as usize] + positions[q as usize]));
    }
    TriangleMesh::new(positions, mesh.triangles(levels))
}

fn shuffled(mesh: &TriangleMesh, seed: u64) -> TriangleMesh {
    let mut rng = Rng::new(seed);
    let mut to: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    rng.shuffle(&mut to);
    let mut positions = mesh.positions.clone();
    for (p, &v) in mesh.positions.iter().zip(&to) {
        positions[v as usize] = *p;
    }
    let mut triangles: Vec<_> = mesh.triangles.iter().map(|t| t.map(|v| to[v as usize])).collect();
    rng.shuffle(&mut triangles);
    for t in &mut triangles {
        t.rotate_left(rng.below(3));
    }
    TriangleMesh::new(positions, triangles)
}

fn set_of(triangles: impl Iterator<Item = [u32; 3]>) -> BTreeSet<[u32; 3]> {
    let least_first = |mut t: [u32; 3]| {
        let least = (0..3).min_by_key(|&k| t[k]).unwrap();
        t.rotate_left(least);
        t
    };
    triangles.map(least_first).collect()
}

/// The mesh made again from its levels is the one given.
fn assert_same(found: &Recognised, mesh: &TriangleMesh) {
    let source: BTreeSet<u32> = found.source_vertex.iter().copied().collect();
    assert_eq!(source.len(), found.source_vertex.len());
    assert_eq!(found.source_vertex.len() as u32, found.mesh.vertex_count(found.mesh.levels()));
    let again = found.mesh.triangles(found.mesh.levels()).into_iter();
    assert_eq!(
        set_of(again.map(|t| t.map(|v| found.source_vertex[v as usize]))),
        set_of(mesh.triangles.iter().copied())
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn levels_are_found_again(kind in 0usize..6, n in 1u32..6, m in 1u32..6, levels in 0u32..5, seed in any::<u64>()) {
        let mesh = shuffled(&split(&base_of(kind, n, m), levels), seed);
        let found = recognise(&mesh).unwrap();
        prop_assert!(found.mesh.levels() >= levels);
        assert_same(&found, &mesh);
    }

    #[test]
    fn parts_agree_on_their_levels(a in 0usize..6, b in 0usize..6, [k, l] in [0u32..4, 0u32..4], seed in any::<u64>()) {
        let mesh = together(&split(&base_of(a, 3, 2), k), &split(&base_of(b, 1, 4), l));
        let mesh = shuffled(&mesh, seed);
        let found = recognise(&mesh).unwrap();
        prop_assert!(found.mesh.levels() >= k.min(l));
        assert_same(&found, &mesh);
    }
}

#[test]
fn plain_meshes_are_merged_as_deep_as_they_go() {
    let levels = |mesh: &TriangleMesh| {
        let mesh = shuffled(mesh, 3);
        let found = recognise(&mesh).unwrap();
        assert_same(&found, &mesh);
        (found.mesh.levels(), found.mesh.base().triangles().len())
    };
    assert_eq!(levels(&models::sphere(5)), (5, 8));
    let flat = |n: u32, m: u32| models::sheet([n, m], [false, false], |u, v| DVec3::new(u, v, 0.0));
    assert_eq!(levels(&flat(32, 32)), (5, 2));
    assert_eq!(levels(&flat(48, 16)), (4, 6));
    assert_eq!(levels(&flat(33, 32)), (0, 2112));
    // a torus of three by three squares is the smallest without double edges
    assert_eq!(levels(&models::torus(48, 24, 0.0)), (3, 36));
    assert_eq!(levels(&models::torus(64, 64, 0.0)), (4, 32));
    assert_eq!(levels(&together(&models::sphere(4), &flat(4, 8))), (2, 132));
    assert_eq!(levels(&split(&base_of(4, 0, 0), 6)), (6, 1));
}

#[test]
fn what_is_no_surface_is_refused_with_its_place() {
    let complaint = |triangles: &[[u32; 3]]| {
        let at = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE];
        recognise(&TriangleMesh::new(at.to_vec(), triangles.to_vec())).unwrap_err().to_string()
    };
    assert_eq!(
        complaint(&[[4, 1, 2], [4, 1, 3]]),
        "not a surface at (1.000000, 0.500000, 0.500000): more than two triangles, or two that face different ways, meet at the edge of \
         vertices 4 and 1"
    );
    assert_eq!(
        complaint(&[[2, 0, 1], [2, 3, 4]]),
        "not a surface at (0.000000, 1.000000, 0.000000): parts touch at vertex 2 alone"
    );
    assert!(complaint(&[[1, 2, 1]]).contains("triangle 0 has the corners [1, 2, 1]"));
    assert!(complaint(&[[1, 2, 5]]).contains("names vertex 5"));
    assert!(complaint(&[]).contains("nothing to build"));
}

#[test]
fn vertices_without_triangles_are_left_out() {
    let mut mesh = split(&base_of(4, 0, 0), 2);
    mesh.positions.insert(0, DVec3::ONE);
    mesh.triangles.iter_mut().for_each(|t| *t = t.map(|v| v + 1));
    let found = recognise(&mesh).unwrap();
    assert_eq!((found.mesh.levels(), found.source_vertex.len()), (2, 15));
    assert_same(&found, &mesh);
}
