//! Reduction within a certified distance: the limit holds by brute force, little is left unused, and what must stay stays.

use glam::DVec3;
use yamanami_core::TriangleMesh;
use yamanami_multires::bound::{BoundOptions, distance_bound};
use yamanami_multires::collapse::{CollapseOptions, StoppedBy, collapse, collapse_within};

/// A square of side 1 in `n` by `n` cells of two triangles, with heights.
fn square(n: u32, height: impl Fn(f64, f64) -> f64) -> TriangleMesh {
    let at = |i: u32| f64::from(i) / f64::from(n);
    let place = |i, j| DVec3::new(at(i), at(j), height(at(i), at(j)));
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| place(i, j)).collect();
    let cell = |k: u32| {
        let a = k / n * (n + 1) + k % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    TriangleMesh::new(positions, (0..n * n).flat_map(cell).collect())
}

fn bumps() -> TriangleMesh {
    square(28, |x, y| 0.1 * (7.0 * x).sin() * (5.0 * y).cos() + 0.02 * (40.0 * x * y).sin())
}

fn certified_m(a: &TriangleMesh, b: &TriangleMesh) -> f64 {
    distance_bound(a, b, &BoundOptions { relative_gap: 1e-3, ..Default::default() }).upper_m()
}

#[test]
fn the_limit_holds_and_is_used() {
    let source = bumps();
    let mut faces = source.triangles.len();
    for limit_m in [1e-3, 1e-2] {
        let found = collapse_within(&source, limit_m, &CollapseOptions::default());
        assert!(found.certified_m <= limit_m && found.certified_m > 0.7 * limit_m, "{}", found.certified_m);
        let distance_m = certified_m(&source, &found.collapsed.mesh);
        assert!(distance_m <= limit_m * 1.001, "{distance_m} over {limit_m}");
        assert!(distance_m >= 0.7 * limit_m, "{distance_m} of {limit_m}");
        assert!(found.collapsed.mesh.triangles.len() < faces, "a wider limit needs fewer faces");
        assert_eq!(found.collapsed.stopped_by, StoppedBy::Error);
        faces = found.collapsed.mesh.triangles.len();
    }
}

#[test]
fn no_more_faces_than_one_run_of_the_same_distance() {
    let source = bumps();
    for target_faces in [700, 200, 60] {
        let plain = collapse(&source, &CollapseOptions { target_faces, ..Default::default() });
        let limit_m = certified_m(&source, &plain.mesh);
        let found = collapse_within(&source, limit_m, &CollapseOptions::default());
        let (ours, theirs) = (found.collapsed.mesh.triangles.len(), plain.mesh.triangles.len());
        assert!(ours <= theirs, "{ours} for {theirs} within {limit_m}");
    }
}

#[test]
fn a_flat_surface_needs_almost_nothing() {
    let found = collapse_within(&square(16, |_, _| 0.0), 1e-9, &CollapseOptions::default());
    assert!(found.collapsed.mesh.triangles.len() < 40, "{}", found.collapsed.mesh.triangles.len());
}

#[test]
fn what_is_locked_stays_and_the_target_is_kept() {
    let source = bumps();
    let locked: Vec<bool> = (0..source.positions.len()).map(|v| v % 37 == 0).collect();
    let options = CollapseOptions { locked: Some(&locked), target_faces: 300, ..Default::default() };
    let found = collapse_within(&source, 0.05, &options).collapsed;
    for (v, &place) in source.positions.iter().enumerate().filter(|(v, _)| locked[*v]) {
        let kept = found.source_vertex.iter().position(|&s| s as usize == v);
        assert!(kept.is_some_and(|k| found.mesh.positions[k] == place), "vertex {v}");
    }
    for (&place, &s) in found.mesh.positions.iter().zip(&found.source_vertex).filter(|(_, s)| **s != u32::MAX) {
        assert_eq!(place, source.positions[s as usize]);
    }
    assert!((299..=300).contains(&found.mesh.triangles.len()), "{}", found.mesh.triangles.len());
    assert_eq!(found.stopped_by, StoppedBy::Target);
}

#[test]
fn where_nothing_can_go_the_source_comes_back() {
    let source = bumps();
    for limit_m in [0.0, -1.0, f64::NAN, 1e-300] {
        let found = collapse_within(&source, limit_m, &CollapseOptions::default());
        assert_eq!((found.collapsed.mesh, found.certified_m), (source.clone(), 0.0));
    }
    let empty = collapse_within(&TriangleMesh::default(), 1.0, &CollapseOptions::default());
    assert!(empty.collapsed.mesh.triangles.is_empty());
    let line = TriangleMesh::new(vec![DVec3::ZERO, DVec3::X], vec![[0, 1, 1]]);
    assert_eq!(collapse_within(&line, 0.1, &CollapseOptions::default()).certified_m, 0.0);
}

#[test]
fn pieces_all_survive() {
    let mut source = bumps();
    let first = source.positions.len() as u32;
    source.positions.extend([DVec3::new(0.5, 0.5, 0.4), DVec3::new(0.51, 0.5, 0.4), DVec3::new(0.5, 0.51, 0.4)]);
    source.triangles.push([first, first + 1, first + 2]);
    let found = collapse_within(&source, 0.01, &CollapseOptions::default());
    assert!(found.collapsed.mesh.positions.iter().any(|p| p.z > 0.39), "the speck is farther than the limit");
}

#[test]
fn the_same_on_any_number_of_threads() {
    let source = bumps();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| collapse_within(&source, 2e-3, &CollapseOptions::default()))
    };
    let [one, four] = [on(1), on(4)];
    assert_eq!(one.collapsed.mesh, four.collapsed.mesh);
    assert_eq!(one.certified_m, four.certified_m);
}
