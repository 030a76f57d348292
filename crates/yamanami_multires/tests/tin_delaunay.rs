//! Points and breaklines become a TIN: every line an edge chain, every face counter-clockwise, nothing covered twice.

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use std::collections::HashSet;
use yamanami_core::{Breakline, BreaklineKind, TriangleMesh};
use yamanami_multires::MultiresError;
use yamanami_multires::tin::{DelaunayOptions, Triangulated, triangulate};

fn line(name: &str, kind: BreaklineKind, points: &[[f64; 3]]) -> Breakline {
    Breakline { name: name.into(), kind, points: points.iter().map(|&p| DVec3::from(p)).collect() }
}

fn hard(name: &str, points: &[[f64; 3]]) -> Breakline {
    line(name, BreaklineKind::Hard, points)
}

/// A 10 by 10 grid of points, 1 m apart, with heights 0.
fn grid() -> Vec<DVec3> {
    (0..100).map(|i| DVec3::new(f64::from(i % 10), f64::from(i / 10), 0.0)).collect()
}

fn orientation(mesh: &TriangleMesh, t: usize) -> f64 {
    let [a, b, c] = mesh.corners(t).map(|p| robust::Coord { x: p.x, y: p.y });
    robust::orient2d(a, b, c)
}

fn plan_area(mesh: &TriangleMesh) -> f64 {
    (0..mesh.triangles.len()).map(|t| 0.5 * orientation(mesh, t)).sum()
}

fn hull_area(points: &[DVec2]) -> f64 {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while chain.len() > 1
                && (chain[chain.len() - 1] - chain[chain.len() - 2]).perp_dot(p - chain[chain.len() - 1]) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain
    };
    let mut ring = chain(&mut sorted.iter().copied());
    ring.pop();
    ring.extend(chain(&mut sorted.iter().rev().copied()));
    ring.windows(2).map(|w| 0.5 * w[0].perp_dot(w[1])).sum()
}

/// What holds of every result.
fn check(made: &Triangulated) {
    let mesh = &made.tin.mesh;
    let mut directed = HashSet::new();
    for (t, corners) in mesh.triangles.iter().enumerate() {
        assert!(orientation(mesh, t) > 0.0, "face {t} is not counter-clockwise");
        for k in 0..3 {
            let edge = [corners[k], corners[(k + 1) % 3]];
            assert!(directed.insert(edge.map(|v| bits(mesh.positions[v as usize]))), "an edge is used twice");
        }
    }
}

fn bits(p: DVec3) -> [u64; 3] {
    p.to_array().map(|v| (v + 0.0).to_bits())
}

/// Steps of lines that are no edges.
fn missing_steps(made: &Triangulated) -> usize {
    let mesh = &made.tin.mesh;
    let edges: HashSet<_> = mesh
        .triangles
        .iter()
        .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]])
        .flat_map(|[a, b]| [[a, b], [b, a]])
        .map(|e| e.map(|v| bits(mesh.positions[v as usize])))
        .collect();
    let steps = made.tin.breaklines.iter().flat_map(|l| l.points.windows(2));
    steps.filter(|w| !edges.contains(&[bits(w[0]), bits(w[1])])).count()
}

#[test]
fn a_square_of_lines_stays() {
    let ring = hard("dam", &[[2.5, 2.5, 5.0], [6.5, 2.5, 5.0], [6.5, 6.5, 5.0], [2.5, 6.5, 5.0], [2.5, 2.5, 5.0]]);
    let made = triangulate(&grid(), &[ring], &DelaunayOptions::default()).unwrap();
    check(&made);
    assert_eq!(missing_steps(&made), 0);
    assert_eq!(made.notes, Vec::<String>::new());
    assert_eq!(made.tin.mesh.positions.len(), 104);
    assert!((plan_area(&made.tin.mesh) - 81.0).abs() < 1e-9);
}

#[test]
fn crossings_are_vertices_and_named() {
    let lines = [
        hard("ridge", &[[0.5, 0.5, 1.0], [8.5, 8.5, 1.0]]),
        hard("drain", &[[0.5, 8.5, 4.0], [8.5, 0.5, 4.0]]),
        hard("kerb", &[[0.2, 5.3, 4.02], [4.2, 5.3, 4.02]]),
    ];
    let made = triangulate(&grid(), &lines, &DelaunayOptions::default()).unwrap();
    check(&made);
    assert_eq!(missing_steps(&made), 0);
    let notes = made.notes.join("\n");
    assert!(notes.contains("line 'ridge' and line 'drain' cross at 4.500 4.500 at heights 3.000 m apart"), "{notes}");
    assert!(notes.contains("1 crossings of lines got the mean of both heights"), "{notes}");
    assert!(made.tin.breaklines[0].points.contains(&DVec3::new(4.5, 4.5, 1.0)));
    assert!(made.tin.breaklines[1].points.contains(&DVec3::new(4.5, 4.5, 1.0)));
    let kerb = &made.tin.breaklines[2].points;
    assert!(kerb.iter().any(|p| (p.z - 4.01).abs() < 1e-12), "{kerb:?}");
}

#[test]
fn twins_are_meaned_and_lines_win() {
    let mut points = grid();
    points.push(DVec3::new(3.0, 3.0, 2.0));
    points.push(DVec3::new(7.0, 7.0, 0.0));
    let lines = [hard("", &[[1.0, 1.0, 9.0], [5.0, 1.0, 9.0]])];
    let made = triangulate(&points, &lines, &DelaunayOptions::default()).unwrap();
    check(&made);
    let z_of = |x, y| made.tin.mesh.positions.iter().find(|p| p.x == x && p.y == y).unwrap().z;
    assert_eq!(z_of(3.0, 3.0), 1.0);
    assert_eq!(z_of(1.0, 1.0), 9.0);
    assert_eq!(z_of(3.0, 1.0), 9.0, "a point on a hard line has its height");
    let notes = made.notes.join("\n");
    assert!(
        notes.contains(
            "2 points at places that others have: heights meaned, they differ by up to 2.000 m at 3.000 3.000"
        ),
        "{notes}"
    );
    assert!(notes.contains("2 points at points of lines got their heights"), "{notes}");
}

#[test]
fn rings_keep_the_inside_and_rings_in_them_are_holes() {
    let square = |name: &str, low: f64, high: f64| {
        line(
            name,
            BreaklineKind::Boundary,
            &[[low, low, f64::NAN], [high, low, f64::NAN], [high, high, f64::NAN], [low, high, f64::NAN]],
        )
    };
    let lines = [square("outer", 0.5, 8.5), square("hole", 2.5, 6.5), square("island", 3.5, 5.5)];
    let made = triangulate(&grid(), &lines, &DelaunayOptions::default()).unwrap();
    check(&made);
    assert_eq!(missing_steps(&made), 0);
    assert!((plan_area(&made.tin.mesh) - (64.0 - 16.0 + 4.0)).abs() < 1e-9);
    assert!(made.tin.mesh.positions.iter().all(|p| p.z == 0.0), "heights of rings come from the points");
}

#[test]
fn a_line_without_heights_disputes_none() {
    let ring = line(
        "site",
        BreaklineKind::Boundary,
        &[[0.5, 0.5, f64::NAN], [8.5, 0.5, f64::NAN], [8.5, 8.5, f64::NAN], [0.5, 8.5, f64::NAN]],
    );
    let made =
        triangulate(&grid(), &[ring, hard("dam", &[[0.2, 4.3, 7.0], [8.9, 4.4, 7.0]])], &DelaunayOptions::default())
            .unwrap();
    assert_eq!(made.notes, Vec::<String>::new());
    assert_eq!(made.tin.mesh.positions.iter().filter(|p| p.z == 7.0).count(), 2, "its crossings: the ends are outside");
}

#[test]
fn long_triangles_are_left_out_on_request() {
    let mut points = grid();
    points.push(DVec3::new(60.0, 4.0, 0.0));
    let options = DelaunayOptions { longest_edge_m: Some(1.5), ..DelaunayOptions::default() };
    let made = triangulate(&points, &[], &options).unwrap();
    assert!((plan_area(&made.tin.mesh) - 81.0).abs() < 1e-9);
    assert_eq!(made.tin.mesh.positions.len(), 100, "vertices without a face are gone");
}

#[test]
fn large_coordinates_do_not_jitter() {
    let shift = DVec3::new(15_443_063.527_071, -3_915_404.016_93, 0.0);
    let points: Vec<DVec3> = grid().iter().map(|&p| p * 0.001 + shift).collect();
    let made = triangulate(&points, &[], &DelaunayOptions::default()).unwrap();
    check(&made);
    assert_eq!(made.tin.mesh.positions, points);
}

#[test]
fn what_is_nowhere_or_far_off_is_dropped_and_told() {
    let mut points: Vec<DVec3> =
        (0..400).map(|i| DVec3::new(5e5 + f64::from(i % 20), 4e6 + f64::from(i / 20), 10.0)).collect();
    points.extend([
        DVec3::ZERO,
        DVec3::new(f64::NAN, 0.0, 0.0),
        DVec3::new(5e5, 4e6, -9999.0),
        DVec3::splat(1e30),
    ]);
    let made = triangulate(&points, &[], &DelaunayOptions::default()).unwrap();
    assert_eq!(made.tin.mesh.positions.len(), 400);
    let notes = made.notes.join("\n");
    assert!(
        notes.contains("2 points that are nowhere") && notes.contains("2 points far outside of all others"),
        "{notes}"
    );
}

#[test]
fn too_little_is_an_error() {
    let on_a_line: Vec<DVec3> = (0..9).map(|i| DVec3::splat(f64::from(i))).collect();
    for points in [&on_a_line[..0], &on_a_line[..1], &on_a_line[..2], &on_a_line[..]] {
        let result = triangulate(points, &[], &DelaunayOptions::default());
        assert!(matches!(result, Err(MultiresError::NoNetwork { .. })));
    }
    let nan = line("", BreaklineKind::Soft, &[[0.0, 0.0, f64::NAN], [1.0, 0.0, f64::NAN], [0.0, 1.0, f64::NAN]]);
    assert!(triangulate(&[], &[nan], &DelaunayOptions::default()).is_ok(), "in plan it is a surface, at height 0");
}

/// Points and lines on a coarse lattice, shifted off round numbers, so that everything coincides often.
fn lattice_scene(scale: f64, turn: f64) -> impl Strategy<Value = (Vec<DVec3>, Vec<Breakline>)> {
    let place = move || {
        (0..12, 0..12, 0..5).prop_map(move |(x, y, z)| {
            let p = DVec2::from_angle(turn).rotate(DVec2::new(f64::from(x), f64::from(y)) * scale);
            DVec3::new(p.x + 1e5, p.y - 3e6, f64::from(z))
        })
    };
    let kind = prop_oneof![3 => Just(BreaklineKind::Hard), 1 => Just(BreaklineKind::Soft)];
    let lines = prop::collection::vec(
        (prop::collection::vec(place(), 0..7), kind).prop_map(|(points, kind)| Breakline {
            name: String::new(),
            kind,
            points,
        }),
        0..8,
    );
    (prop::collection::vec(place(), 3..120), lines)
}

proptest! {
    #[test]
    fn any_points_and_lines_make_a_sound_tin((points, lines) in prop_oneof![lattice_scene(1.0, 0.0), lattice_scene(0.1, 0.0), lattice_scene(1.0 / 3.0, 0.5)]) {
        let Ok(made) = triangulate(&points, &lines, &DelaunayOptions::default()) else { return Ok(()) };
        check(&made);
        prop_assert_eq!(missing_steps(&made), 0);
        let mesh = &made.tin.mesh;
        let plan: Vec<DVec2> = mesh.positions.iter().map(|p| p.truncate()).collect();
        let origin = plan[0];
        let hull = hull_area(&plan.iter().map(|&p| p - origin).collect::<Vec<_>>());
        prop_assert!((plan_area(mesh) - hull).abs() < 1e-6 * hull.max(1.0), "{} of {hull}", plan_area(mesh));
        let places: HashSet<_> = plan.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
        prop_assert_eq!(places.len(), plan.len());
        for p in points.iter().chain(lines.iter().flat_map(|l| &l.points)) {
            prop_assert!(places.contains(&p.truncate().to_array().map(f64::to_bits)));
        }
        prop_assert!(!made.notes.iter().any(|n| n.contains("could not be kept")), "{:?}", made.notes);
        prop_assert_eq!(triangulate(&points, &lines, &DelaunayOptions::default()).unwrap(), made);
    }

    #[test]
    fn without_lines_it_is_delaunay(points in prop::collection::vec((0..9, 0..9), 3..60)) {
        let points: Vec<DVec3> = points.iter().map(|&(x, y)| DVec3::new(f64::from(x), f64::from(y), 0.0)).collect();
        let Ok(made) = triangulate(&points, &[], &DelaunayOptions::default()) else { return Ok(()) };
        let mesh = &made.tin.mesh;
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(t).map(|p| robust::Coord { x: p.x, y: p.y });
            for p in &mesh.positions {
                let inside = robust::incircle(a, b, c, robust::Coord { x: p.x, y: p.y });
                prop_assert!(inside <= 0.0);
            }
        }
    }
}
