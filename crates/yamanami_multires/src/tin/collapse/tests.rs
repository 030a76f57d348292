//! What every collapse of a TIN must keep: a TIN, its domain, its lines, what is locked.

use super::super::vertical::{Ground, vertical_distance_m};
use super::{NONE, Reduced, Task, area2, reduce};
use glam::DVec3;
use proptest::prelude::*;
use std::collections::HashMap;
use yamanami_core::Snap;

/// A shaken grid with random diagonals over hills, far from zero.
fn ground(n: usize, seed: u64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut state = seed | 1;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1u64 << 24) as f64
    };
    let mut positions = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let inner = |k: usize| k > 0 && k < n;
            let dx = if inner(i) && inner(j) { 0.5 * random() - 0.25 } else { 0.0 };
            let dy = if inner(i) && inner(j) { 0.5 * random() - 0.25 } else { 0.0 };
            let (x, y) = (i as f64 + dx, j as f64 + dy);
            let z = 3.0 * (0.4 * x).sin() * (0.3 * y).cos() + 0.2 * random();
            // single precision, as scanners give
            positions.push(DVec3::new(x as f32 as f64 + 5e5, y as f32 as f64 + 4e6, z as f32 as f64));
        }
    }
    let mut triangles = Vec::new();
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend(if random() < 0.5 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    (positions, triangles)
}

fn area(positions: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let origin = positions[0];
    let p = |v: u32| positions[v as usize] - origin;
    triangles.iter().map(|&[a, b, c]| 0.5 * area2(p(a), p(b), p(c))).sum()
}

/// No overlap: all triangles face up, no directed edge is there twice, and the area is that of the domain.
fn check_tin(out: &Reduced, area_m2: f64) {
    let mut edges = HashMap::new();
    for (t, &[a, b, c]) in out.triangles.iter().enumerate() {
        let [p, q, r] = [a, b, c].map(|v| out.positions[v as usize]);
        assert!(area2(p, q, r) > 0.0, "triangle {t} is flat or turned over");
        for edge in [(a, b), (b, c), (c, a)] {
            assert!(edges.insert(edge, t).is_none(), "edge {edge:?} is there twice");
        }
    }
    let now_m2 = area(&out.positions, &out.triangles);
    assert!((now_m2 - area_m2).abs() < 1e-6 * area_m2, "{now_m2} of {area_m2}");
}

/// With a border that may not stray: it is straight but for its corners.
fn task<'a>(positions: &'a [DVec3], triangles: &'a [[u32; 3]], is_locked: &'a [bool], target: usize) -> Task<'a> {
    Task { positions, triangles, is_locked, lines: &[], target, most_stray_m: 1e-7, snap: None }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_tin_stays_a_tin(n in 3usize..16, seed in any::<u64>(), share in 0.05f64..0.9, snapped in any::<bool>()) {
        let (positions, triangles) = ground(n, seed);
        let none = vec![false; positions.len()];
        let target = (share * triangles.len() as f64) as usize;
        let snap = snapped.then_some(Snap { unit_m: 0.3048, per_unit: 1000.0 });
        let out = reduce(Task { snap, ..task(&positions, &triangles, &none, target) });
        check_tin(&out, area(&positions, &triangles));
        // corners go when they may
        let free = reduce(Task { snap, most_stray_m: f64::INFINITY, ..task(&positions, &triangles, &none, target) });
        let lost = area(&positions, &triangles) - area(&free.positions, &free.triangles);
        let most = free.stray_m * 4.0 * n as f64 + 1e-6;
        prop_assert!((-1e-6..=most).contains(&lost), "{lost} of {most}");
        for (&p, &source) in out.positions.iter().zip(&out.source) {
            match snap {
                _ if source != NONE => prop_assert_eq!(p, positions[source as usize]),
                Some(snap) => prop_assert_eq!(p, snap.place(p)),
                None => {}
            }
        }
    }

    #[test]
    fn what_is_locked_stays(n in 3usize..12, seed in any::<u64>(), locks in proptest::collection::vec(any::<bool>(), 169)) {
        let (positions, triangles) = ground(n, seed);
        let out = reduce(task(&positions, &triangles, &locks[..positions.len()], 0));
        check_tin(&out, area(&positions, &triangles));
        for v in (0..positions.len()).filter(|&v| locks[v]) {
            prop_assert!(out.source.contains(&(v as u32)), "locked vertex {v} is gone");
        }
    }

    #[test]
    fn breaklines_stray_no_further_than_allowed(n in 6usize..14, seed in any::<u64>(), most_stray_m in 0.0f64..0.6) {
        let (positions, triangles) = ground(n, seed);
        let none = vec![false; positions.len()];
        // lines along edges of the mesh: one up the middle, one across it, which meet
        let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
        let mut lines: Vec<[u32; 2]> = (0..n).map(|j| [at(n / 2, j), at(n / 2, j + 1)]).collect();
        lines.extend((1..n - 1).map(|i| [at(i, n / 3), at(i + 1, n / 3)]));
        let out = reduce(Task { lines: &lines, most_stray_m, ..task(&positions, &triangles, &none, triangles.len() / 8) });
        prop_assert!(out.stray_m <= most_stray_m);
        let edges: std::collections::HashSet<(u32, u32)> =
            out.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        prop_assert!(!out.lines.is_empty());
        for &[a, b] in &out.lines {
            prop_assert!(edges.contains(&(a, b)) || edges.contains(&(b, a)), "line edge {a} {b} is no edge");
        }
        // every vertex of the old lines is near a new one
        for &v in lines.as_flattened() {
            let p = positions[v as usize];
            let nearest = out.lines.iter().map(|e| {
                let [a, b] = e.map(|v| out.positions[v as usize]);
                super::chains::distance_m(p, a, b)
            });
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            prop_assert!(nearest <= most_stray_m + 1e-9, "{nearest} m");
        }
    }

    #[test]
    fn no_place_is_further_than_the_vertical_distance(n in 3usize..10, seed in any::<u64>(), at in proptest::collection::vec((0.0f64..1.0, 0.0f64..1.0), 60)) {
        let (positions, triangles) = ground(n, seed);
        let none = vec![false; positions.len()];
        let out = reduce(task(&positions, &triangles, &none, triangles.len() / 3));
        let origin = positions[0];
        let [fine, coarse] = [&positions, &out.positions].map(|all| all.iter().map(|&p| p - origin).collect::<Vec<_>>());
        let fine = Ground { positions: &fine, triangles: &triangles };
        let coarse = Ground { positions: &coarse, triangles: &out.triangles };
        let bound_m = vertical_distance_m(fine, coarse);
        let height = |g: &Ground<'_>, x: f64, y: f64| g.triangles.iter().find_map(|t| {
            let [a, b, c] = t.map(|v| g.positions[v as usize]);
            let p = DVec3::new(x, y, 0.0);
            let w = [area2(b, c, p), area2(c, a, p), area2(a, b, p)];
            w.iter().all(|w| *w >= 0.0).then(|| (w[0] * a.z + w[1] * b.z + w[2] * c.z) / (w[0] + w[1] + w[2]))
        });
        for (u, v) in at {
            let (x, y) = (u * n as f64, v * n as f64);
            if let (Some(a), Some(b)) = (height(&fine, x, y), height(&coarse, x, y)) {
                prop_assert!((a - b).abs() <= bound_m + 1e-9, "{} of {bound_m}", (a - b).abs());
            }
        }
    }
}
