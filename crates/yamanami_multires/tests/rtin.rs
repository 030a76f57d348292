//! The laws of the design page over right triangles on nested grids, and what fronts of them show.

use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::sync::Mutex;
use yamanami_core::{FieldLevel, Hierarchy, MeshMirror, NestedField, NodeId, Surface};
use yamanami_multires::rtin::{BuildOptions, Rtin, SummitRule, summits};
use yamanami_testkit::laws::{closure_law, hierarchy_law, surface_law};
use yamanami_testkit::{RandomFront, nested_ground};

fn field(halves: &[u32]) -> NestedField {
    nested_ground(halves, 200.0, 900.0, 7)
}

fn rtin(halves: &[u32]) -> Rtin {
    Rtin::build(field(halves), &BuildOptions::default()).unwrap()
}

const FIELDS: &[&[u32]] = &[&[2], &[8], &[22], &[18, 10], &[16, 32], &[14, 10, 8], &[6, 12, 24], &[6, 4, 4, 6]];

#[test]
fn every_field_obeys_the_hierarchy_law() {
    for halves in FIELDS.iter().copied().chain([&[90][..], &[100, 20]]) {
        hierarchy_law(&rtin(halves));
    }
}

#[test]
fn every_front_is_conforming() {
    for halves in FIELDS {
        closure_law(&rtin(halves), 5);
    }
}

#[test]
fn refining_then_coarsening_restores_the_sink() {
    for halves in FIELDS {
        surface_law(&rtin(halves), 9);
    }
}

fn random_front(rtin: &Rtin, seed: u64, share: f64) -> Vec<bool> {
    let mut front = RandomFront::new(rtin, seed);
    front.wander(usize::MAX, (share * f64::from(rtin.node_bound())) as usize);
    let mut active = vec![false; rtin.node_bound() as usize];
    front.nodes().into_iter().for_each(|n| active[n as usize] = true);
    active
}

#[test]
fn a_front_emitted_whole_is_the_front_reached_by_steps() {
    for halves in FIELDS {
        let rtin = rtin(halves);
        let front = random_front(&rtin, 3, 0.4);
        let active = |n: NodeId| front[n as usize];
        let mut by_steps = MeshMirror::default();
        rtin.emit_base(&mut by_steps);
        for node in (0..rtin.node_bound()).filter(|&n| active(n)) {
            rtin.refine(node, &|n: NodeId| n < node && active(n), &mut by_steps);
        }
        let mut whole = MeshMirror::default();
        rtin.emit_front(&active, &mut whole);
        assert_eq!(whole, by_steps, "{halves:?}");
    }
}

/// All samples of a front with the front's height there, by place in half finest spacings.
fn shown(rtin: &Rtin, active: &(impl Fn(NodeId) -> bool + Sync)) -> HashMap<[i64; 2], (f64, f64)> {
    let unit_m = 0.5 * rtin.field().levels().last().unwrap().spacing_m();
    let all = Mutex::new(HashMap::new());
    rtin.for_each_sample(active, |p, [a, b, c]| {
        let normal = (b - a).cross(c - a);
        let z = a.z - normal.truncate().dot(p.truncate() - a.truncate()) / normal.z;
        let place = [p.x, p.y].map(|v| (v / unit_m).round() as i64);
        assert!(all.lock().unwrap().insert(place, (p.z, z)).is_none(), "{p} twice");
    });
    all.into_inner().unwrap()
}

#[test]
fn every_sample_is_measured_once_and_the_full_front_meets_it() {
    for halves in FIELDS {
        let rtin = rtin(halves);
        let all = shown(&rtin, &|_| true);
        for (place, (sample_m, z)) in &all {
            assert_eq!(sample_m, z, "{halves:?}: {place:?}");
        }
        let finest = rtin.field().levels().len() - 1;
        for (i, level) in rtin.field().levels().iter().enumerate() {
            let reach = if i == 0 { level.half() } else { level.half() - 3 } as usize;
            let middle = level.half() as usize;
            for row in middle - reach..=middle + reach {
                for column in middle - reach..=middle + reach {
                    let p = [column as i64 - middle as i64, middle as i64 - row as i64].map(|v| v << (finest - i + 1));
                    let z = f64::from(level.heights_m()[row * level.width() + column]);
                    assert_eq!(all.get(&p).map(|s| s.0), Some(z), "{halves:?}: {p:?}");
                }
            }
        }
    }
}

#[test]
fn errors_bound_the_true_vertical_distance() {
    for halves in FIELDS {
        let rtin = rtin(halves);
        for tolerance_m in [0.0, 1.0, 10.0, 60.0, 200.0] {
            let samples = shown(&rtin, &|n: NodeId| rtin.error_m(n) > tolerance_m);
            let worst = samples.values().map(|(sample_m, z)| (sample_m - z).abs()).fold(0.0, f64::max);
            assert!(worst <= f64::from(tolerance_m) + 1e-9, "{halves:?}: {worst} m at {tolerance_m} m");
        }
    }
}

/// No error is larger than it must be: some front without the node, or without one that needs it, is as far off.
#[test]
fn errors_are_reached() {
    for halves in [&[8][..], &[6, 4]] {
        let rtin = rtin(halves);
        let count = rtin.node_bound() as usize;
        let mut reached_m = vec![0f64; count];
        for node in (0..rtin.node_bound()).rev() {
            let mut gone = vec![false; count];
            gone[node as usize] = true;
            for n in node..rtin.node_bound() {
                gone[n as usize] |= rtin.parents(n).iter().any(|&p| gone[p as usize]);
            }
            let samples = shown(&rtin, &|n: NodeId| !gone[n as usize]);
            let own_m = samples.values().map(|(sample_m, z)| (sample_m - z).abs()).fold(0.0, f64::max);
            let of_children = rtin.children(node).iter().map(|&c| reached_m[c as usize]).fold(0.0, f64::max);
            reached_m[node as usize] = own_m.max(of_children);
            let (expected, error_m) = (reached_m[node as usize], f64::from(rtin.error_m(node)));
            assert!((error_m - expected).abs() <= 1e-6 * expected, "{halves:?} node {node}: {error_m}, {expected}");
        }
    }
}

#[test]
fn a_front_is_asked_at_any_place() {
    let rtin = rtin(&[18, 10]);
    let front = random_front(&rtin, 8, 0.2);
    let active = |n: NodeId| front[n as usize];
    for (place, (_, z)) in shown(&rtin, &active) {
        let place_m = DVec2::new(place[0] as f64, place[1] as f64) * 50.0;
        let at = rtin.front_at(&active, place_m);
        assert!((at.height_m - z).abs() < 1e-6 && at.weights.iter().all(|&w| w >= -1e-12), "{place:?} {at:?}");
        let back: DVec3 = (0..3).map(|i| at.weights[i] * at.corners[i]).sum();
        assert!((back - place_m.extend(at.height_m)).length() < 1e-6);
    }
    let off = rtin.front_at(&active, DVec2::new(1e9, -1e9));
    let corner = rtin.front_at(&active, DVec2::new(32.0 * 200.0, -32.0 * 200.0));
    assert_eq!(off, corner);
    assert!(rtin.front_at(&active, DVec2::NAN).corners[0].is_finite());
}

#[test]
fn normals_are_the_finest_grid_s() {
    let slope = |spacing_m: f64, half: i32| {
        let z =
            |n: i32| 0.5 * spacing_m * f64::from(n % (2 * half + 1)) - 0.25 * spacing_m * f64::from(n / (2 * half + 1));
        FieldLevel::new(spacing_m, half as u32, (0..(2 * half + 1).pow(2)).map(|n| z(n) as f32).collect())
    };
    // two planes of one slope, one above the other: the finer grid's stands out by a step
    let rtin = Rtin::build(NestedField::new(vec![slope(100.0, 10), slope(50.0, 8)]), &BuildOptions::default()).unwrap();
    let mesh = rtin.mesh_of(&|_: NodeId| true);
    let expected = DVec3::new(-0.5, -0.25, 1.0).normalize();
    for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
        if p.truncate().abs().max_element() < 400.0 {
            assert!((DVec3::from(n.map(f64::from)) - expected).length() < 1e-6, "{p} {n:?}");
        }
    }
}

#[test]
fn longest_edges_point_to_the_centre_and_the_base_is_eight_triangles() {
    let base = rtin(&[20, 14]).mesh_of(&|_: NodeId| false);
    assert_eq!((base.triangles.len(), base.positions.len()), (8, 9));
    for t in 0..8 {
        let [a, b, c] = base.corners(t).map(|p| p.truncate());
        assert!(a == DVec2::ZERO || b == DVec2::ZERO, "longest edge from the centre");
        assert!((b - a).length() > (c - a).length() && (a - c).dot(b - c) == 0.0);
    }
}

#[test]
fn prominent_summits_stay_longer() {
    let plain = rtin(&[40]);
    let rule = SummitRule { factor: 0.5, min_prominence_m: 20.0 };
    let raised = Rtin::build(field(&[40]), &BuildOptions { summits: Some(rule) }).unwrap();
    hierarchy_law(&raised);
    let found = summits(plain.field().widest(), 20.0);
    assert!(found.len() > 10, "{} summits", found.len());
    let lost = |rtin: &Rtin, tolerance_m: f32| {
        let front = |n: NodeId| rtin.error_m(n) > tolerance_m;
        let worst = |s: &yamanami_multires::rtin::Summit| {
            let place = rtin.field().widest().plane_from_grid(s.column, s.row);
            (rtin.front_at(&front, place).height_m - f64::from(s.height_m)).abs()
        };
        let high = found.iter().filter(|s| s.prominence_m * 0.5 > f64::from(tolerance_m) + 1e-3);
        high.map(worst).fold(0.0, f64::max)
    };
    assert!(lost(&plain, 30.0) > 0.0);
    assert!(lost(&raised, 30.0) < 1e-6, "a summit of 60 m is a vertex at a tolerance of 30 m");
    assert!((0..plain.node_bound()).all(|n| raised.error_m(n) >= plain.error_m(n)));
}

#[test]
fn what_is_too_high_is_refused() {
    let mut heights = vec![0.0; 25];
    heights[7] = 6e5;
    let error = Rtin::build(NestedField::new(vec![FieldLevel::new(10.0, 2, heights)]), &BuildOptions::default());
    assert!(error.unwrap_err().to_string().contains("column 2, row 1"));
}
