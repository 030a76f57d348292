//! The certified distance against cases with a known answer, against brute force on samples, and against itself under
//! changes that must not matter.

use glam::DVec3;
use proptest::prelude::*;
use yamanami_core::TriangleMesh;
use yamanami_multires::bound::{BoundOptions, TwoWayBound, distance_bound, faces_beyond};

/// A square of side 1 at a height, in `n` by `n` cells of two triangles.
fn square(n: u32, z: f64) -> TriangleMesh {
    let at = |i: u32| f64::from(i) / f64::from(n);
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| DVec3::new(at(i), at(j), z))).collect();
    let cell = |k: u32| {
        let a = k / n * (n + 1) + k % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    TriangleMesh::new(positions, (0..n * n).flat_map(cell).collect())
}

/// An octahedron whose triangles are split in four so many times, corners on a sphere.
fn sphere(levels: u32, radius: f64) -> TriangleMesh {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut faces = vec![
        [x, y, z],
        [y, -x, z],
        [-x, -y, z],
        [-y, x, z],
        [y, x, -z],
        [-x, y, -z],
        [-y, -x, -z],
        [x, -y, -z],
    ];
    for _ in 0..levels {
        let split = |[a, b, c]: [DVec3; 3]| {
            let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(split).collect();
    }
    soup(faces.into_iter().map(|f| f.map(|p| p * radius)))
}

/// Triangles that share no corner.
fn soup(faces: impl IntoIterator<Item = [DVec3; 3]>) -> TriangleMesh {
    let positions: Vec<DVec3> = faces.into_iter().flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(positions, triangles)
}

fn moved(mesh: &TriangleMesh, by: impl Fn(DVec3) -> DVec3) -> TriangleMesh {
    TriangleMesh::new(mesh.positions.iter().map(|&p| by(p)).collect(), mesh.triangles.clone())
}

/// Distance of a point to a mesh, all triangles tried, by ways of its own: the plane where the foot is inside, else edges.
fn distance(p: DVec3, mesh: &TriangleMesh) -> f64 {
    let to_edge = |a: DVec3, b: DVec3| {
        let along = b - a;
        let share = along.dot(p - a) / along.length_squared();
        p.distance(if share.is_finite() { a + along * share.clamp(0.0, 1.0) } else { a })
    };
    let to_triangle = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let edges = to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let foot = p - normal * normal.dot(p - a);
        let inside = |a: DVec3, b: DVec3| (b - a).cross(foot - a).dot(normal) > 0.0;
        if inside(a, b) && inside(b, c) && inside(c, a) { edges.min(p.distance(foot)) } else { edges }
    };
    (0..mesh.triangles.len()).map(to_triangle).fold(f64::INFINITY, f64::min)
}

/// The largest distance from points of a regular grid in each triangle of `a` to `b`.
fn sampled(a: &TriangleMesh, b: &TriangleMesh, cuts: u32) -> f64 {
    let mut most = 0.0f64;
    for t in 0..a.triangles.len() {
        let [p, q, r] = a.corners(t);
        for i in 0..=cuts {
            for j in 0..=cuts - i {
                let (u, v) = (f64::from(i) / f64::from(cuts), f64::from(j) / f64::from(cuts));
                most = most.max(distance(p + (q - p) * u + (r - p) * v, b));
            }
        }
    }
    most
}

fn bound(a: &TriangleMesh, b: &TriangleMesh) -> TwoWayBound {
    distance_bound(a, b, &BoundOptions::default())
}

/// Rounding of lengths about one.
const TINY: f64 = 1e-12;

fn assert_about(found: &TwoWayBound, [ab, ba]: [f64; 2], gap: f64) {
    for (one, exact) in [(found.a_to_b, ab), (found.b_to_a, ba)] {
        assert!(one.upper_m >= exact && one.lower_m <= exact, "{one:?}, expected around {exact}");
    }
    let (upper, exact) = (found.upper_m(), ab.max(ba));
    assert!(upper <= exact * (1.0 + gap) + 4.0 * TINY, "{upper} for {exact}");
    assert!(found.lower_m() >= exact / (1.0 + gap) - 4.0 * TINY, "{} for {exact}", found.lower_m());
}

#[test]
fn parallel_squares() {
    for (n, m) in [(1, 1), (1, 7), (5, 3), (40, 1)] {
        assert_about(&bound(&square(n, 0.0), &square(m, 0.25)), [0.25; 2], 0.05);
        assert!(bound(&square(n, 0.0), &square(m, 0.0)).upper_m() <= 4.0 * TINY, "one surface, cut in two ways");
    }
}

#[test]
fn one_surface_in_two_meshes_needs_few_steps() {
    let coarse = square(1, 0.0);
    let found =
        distance_bound(&coarse, &square(64, 0.0), &BoundOptions { most_steps: Some(200_000), ..Default::default() });
    assert!(found.upper_m() <= 4.0 * TINY, "{found:?}");
}

#[test]
fn spheres_of_two_sizes() {
    // between polyhedra: flat against round, and the same directions against each other
    let (inner, outer) = (sphere(3, 1.0), sphere(3, 1.5));
    assert_about(&bound(&inner, &inner), [0.0; 2], 0.05);
    let found = bound(&inner, &outer);
    assert!(found.lower_m() > 0.45 && found.upper_m() < 0.5 * 1.05 + TINY, "{found:?}");
    let coarse = bound(&sphere(5, 1.0), &sphere(1, 1.0));
    // a face of the octahedron split once: corners at right angles, and half of that
    let middle =
        (DVec3::X + DVec3::Y).normalize() + (DVec3::Y + DVec3::Z).normalize() + (DVec3::Z + DVec3::X).normalize();
    let deepest = 1.0 - middle.length() / 3.0;
    assert!(
        coarse.upper_m() <= deepest * 1.06 && coarse.lower_m() >= deepest * 0.9,
        "{coarse:?}, expected about {deepest}"
    );
}

#[test]
fn one_vertex_out_of_place() {
    let flat = square(10, 0.0);
    let mut peak = flat.clone();
    peak.positions[60].z = 0.03;
    let found = bound(&flat, &peak);
    assert_about(&bound(&peak, &flat), [0.03, found.a_to_b.upper_m], 0.05);
    assert!(found.b_to_a.place.distance(peak.positions[60]) < 0.01, "{:?}", found.b_to_a);
    assert!(peak.triangles[found.b_to_a.triangle as usize].contains(&60));
}

#[test]
fn a_piece_that_the_other_lacks() {
    let one = square(4, 0.0);
    let mut two = one.clone();
    let first = two.positions.len() as u32;
    two.positions.extend([DVec3::new(0.5, 0.5, 2.0), DVec3::new(0.6, 0.5, 2.0), DVec3::new(0.5, 0.6, 3.0)]);
    two.triangles.push([first, first + 1, first + 2]);
    assert_about(&bound(&two, &one), [3.0, 0.0], 0.05);
    let [beyond, none] = faces_beyond(&two, &one, 0.5);
    assert_eq!((beyond.len(), none.len()), (1, 0));
    assert_eq!(beyond[0].triangle, 32);
}

#[test]
fn degenerate_triangles_count_as_points_and_lines() {
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let point = soup([[p(0.3, 0.3, 1.0); 3]]);
    let line = soup([[p(0.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(0.5, 0.0, 1.0)]]);
    let flat = square(3, 0.0);
    assert_about(&bound(&point, &flat), [1.0, p(0.3, 0.3, 1.0).distance(p(1.0, 1.0, 0.0))], 0.05);
    assert_about(&bound(&line, &flat), [1.0, 2f64.sqrt()], 0.05);
    assert_about(&bound(&point, &point), [0.0; 2], 0.05);
    let needle = soup([[p(0.0, 0.0, 0.5), p(1.0, 1e-14, 0.5), p(0.5, 1e-15, 0.5)]]);
    assert_about(&bound(&needle, &flat), [0.5, 1.25f64.sqrt()], 0.05);
}

#[test]
fn nothing_against_nothing_and_against_something() {
    let (empty, flat) = (TriangleMesh::default(), square(1, 0.0));
    assert_eq!(bound(&empty, &empty).upper_m(), 0.0);
    assert_eq!(bound(&flat, &empty).lower_m(), f64::INFINITY);
    assert_eq!(bound(&empty, &flat).upper_m(), f64::INFINITY);
    assert_eq!(faces_beyond(&flat, &empty, 10.0).map(|b| b.len()), [2, 0]);
    let mut broken = flat.clone();
    broken.positions[0].x = f64::NAN;
    let found = bound(&broken, &flat);
    assert!(found.upper_m() == f64::INFINITY && found.lower_m() == 0.0);
    assert_eq!(faces_beyond(&broken, &flat, 10.0).map(|b| b.len()), [2, 2]);
}

#[test]
fn within_is_answered_either_way() {
    let (a, b) = (sphere(3, 1.0), sphere(2, 1.02));
    let exact = distance_bound(&a, &b, &BoundOptions { relative_gap: 1e-3, ..Default::default() });
    for (share, within) in [(0.5, false), (0.99, false), (1.01, true), (3.0, true)] {
        let at_most_m = exact.lower_m() * share;
        let found = distance_bound(&a, &b, &BoundOptions { at_most_m, ..Default::default() });
        assert_eq!(found.upper_m() <= at_most_m, within, "{share}: {found:?}");
        assert!(within || found.lower_m() > at_most_m, "{share}: {found:?}");
        assert_eq!(faces_beyond(&a, &b, at_most_m).iter().all(Vec::is_empty), within, "{share}");
    }
}

#[test]
fn steps_that_run_out_leave_a_bound() {
    let (a, b) = (sphere(4, 1.0), sphere(3, 1.0));
    let few = distance_bound(&a, &b, &BoundOptions { most_steps: Some(0), relative_gap: 1e-6, ..Default::default() });
    let many = distance_bound(&a, &b, &BoundOptions { relative_gap: 1e-3, ..Default::default() });
    // a corner's distance and the size of a face
    assert!(few.upper_m() >= many.lower_m() && few.upper_m() < 0.2, "{few:?} {many:?}");
    assert!(few.lower_m() > 0.9 * many.lower_m(), "{few:?} {many:?}");
}

#[test]
fn the_same_on_any_number_of_threads() {
    let (a, b) = (sphere(5, 1.0), moved(&sphere(4, 1.0), |p| p + DVec3::splat(1e-3)));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (bound(&a, &b), faces_beyond(&a, &b, 3e-3)))
    };
    let one = on(1);
    assert!(!one.1[0].is_empty(), "some face is beyond");
    assert_eq!(one, on(5));
}

/// Meshes of a few triangles: all shapes of soup, or a bent square against another.
fn small_mesh() -> impl Strategy<Value = TriangleMesh> {
    let place = prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array);
    let any = prop::collection::vec(prop::array::uniform3(place), 1..8).prop_map(soup);
    let bent = (1u32..6, prop::collection::vec(-0.1..0.1f64, 36)).prop_map(|(n, bends)| {
        let mut mesh = square(n, 0.0);
        mesh.positions.iter_mut().zip(bends).for_each(|(p, bend)| p.z = bend);
        mesh
    });
    prop_oneof![any, bent]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn never_below_samples_and_close(a in small_mesh(), b in small_mesh(), gap in 0.001..0.3f64) {
        let found = distance_bound(&a, &b, &BoundOptions { relative_gap: gap, ..Default::default() });
        for (one, most) in [(found.a_to_b, sampled(&a, &b, 12)), (found.b_to_a, sampled(&b, &a, 12))] {
            prop_assert!(one.upper_m >= most, "{:?} sampled {}", one, most);
            prop_assert!(one.lower_m <= one.upper_m);
        }
        prop_assert!(found.upper_m() <= found.lower_m() * (1.0 + gap) + 4.0 * TINY, "{:?}", found);
        let worst = if found.a_to_b.lower_m > found.b_to_a.lower_m { (found.a_to_b, &b) } else { (found.b_to_a, &a) };
        prop_assert!((distance(worst.0.place, worst.1) - worst.0.lower_m).abs() < 8.0 * TINY);
    }

    #[test]
    fn faces_within_are_within(a in small_mesh(), b in small_mesh(), share in 0.1..1.2f64) {
        let limit_m = bound(&a, &b).lower_m() * share;
        let [beyond, _] = faces_beyond(&a, &b, limit_m);
        for t in 0..a.triangles.len() as u32 {
            let alone = soup([a.corners(t as usize)]);
            match beyond.iter().find(|face| face.triangle == t) {
                Some(face) => {
                    prop_assert!(distance(face.place, &b) >= limit_m - 8.0 * TINY);
                    let nearest = soup([b.corners(face.nearest as usize)]);
                    prop_assert!((distance(face.place, &nearest) - face.distance_m).abs() < 8.0 * TINY);
                }
                None => prop_assert!(sampled(&alone, &b, 12) <= limit_m),
            }
        }
    }

    #[test]
    fn scale_by_a_power_of_two_is_exact(a in small_mesh(), b in small_mesh(), exponent in -300i32..300) {
        let scale = f64::from(exponent).exp2();
        let [small, large] = [bound(&a, &b), bound(&moved(&a, |p| p * scale), &moved(&b, |p| p * scale))];
        prop_assert_eq!(large.a_to_b.upper_m, small.a_to_b.upper_m * scale);
        prop_assert_eq!(large.b_to_a.lower_m, small.b_to_a.lower_m * scale);
        prop_assert_eq!(large.a_to_b.triangle, small.a_to_b.triangle);
    }

    #[test]
    fn far_from_the_origin_nothing_is_lost(a in small_mesh(), b in small_mesh()) {
        // places that both frames hold exactly
        let round = |p: DVec3| (p * 65536.0).round() / 65536.0;
        let (a, b) = (moved(&a, round), moved(&b, round));
        let far = DVec3::new(1e6, -2e6, 3e6);
        let [near, far] = [bound(&a, &b), bound(&moved(&a, |p| p + far), &moved(&b, |p| p + far))];
        prop_assert_eq!(near.upper_m(), far.upper_m());
        prop_assert_eq!(near.lower_m(), far.lower_m());
    }
}
