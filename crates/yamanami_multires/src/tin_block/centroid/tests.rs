//! The decimation against a slow twin, and what it keeps.

use super::*;
use crate::tin_block::net::slope_of;
use crate::tin_block::tests::rough_tin;
use glam::DVec3;
use proptest::prelude::*;
use std::collections::BTreeSet;
use yamanami_testkit::check_conforming;
use yamanami_testkit::laws::Kind;

/// What picking a triangle costs and leaves, by the letter of the paper; `None` where it cannot be picked.
fn slow_pick(left: &[[DVec3; 3]], picked: [DVec3; 3]) -> Option<(f64, Vec<[DVec3; 3]>)> {
    let edges = |t: &[DVec3; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let open = |triangles: &[[DVec3; 3]]| {
        let all: Vec<[DVec3; 2]> = triangles.iter().flat_map(edges).collect();
        all.iter().filter(|e| !all.contains(&[e[1], e[0]])).copied().collect::<Vec<_>>()
    };
    let is_left = |a: DVec3, b: DVec3, c: DVec3| (b - a).truncate().perp_dot((c - a).truncate()) > 0.0;
    let (ring, mut rest): (Vec<[DVec3; 3]>, Vec<[DVec3; 3]>) =
        left.iter().partition(|t| t.iter().any(|p| picked.contains(p)));
    let hole = open(&ring);
    // a corner on the border stays on an edge of the hole
    let is_inner = hole.iter().flatten().all(|p| !picked.contains(p));
    let is_simple = hole.iter().all(|e| hole.iter().filter(|f| f[0] == e[0]).count() == 1);
    let middle = (picked[0] + picked[1] + picked[2]) / 3.0;
    if !is_inner || !is_simple || !hole.iter().all(|e| is_left(middle, e[0], e[1])) {
        return None;
    }
    rest.extend(hole.into_iter().map(|[a, b]| [a, b, middle]));
    Some((ring.iter().map(|&t| slope_of(t)).sum::<f64>() / ring.len() as f64, rest))
}

fn as_set(triangles: &[[DVec3; 3]]) -> BTreeSet<Vec<[u64; 3]>> {
    let sorted = |t: &[DVec3; 3]| {
        let mut places = t.map(|p| p.to_array().map(f64::to_bits)).to_vec();
        places.sort_unstable();
        places
    };
    triangles.iter().map(sorted).collect()
}

#[test]
fn each_step_is_the_cheapest_that_a_slow_search_finds() {
    for seed in 0..3 {
        let source = rough_tin(9, seed);
        let mut work = Work::new(Net::new(&source), CostReading::Plain);
        let triangles = |work: &Work| {
            let mesh = work.net.to_mesh();
            (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect::<Vec<_>>()
        };
        let mut left = triangles(&work);
        while let Some(triangle) = work.picks.least() {
            let (picked, cost_here) = (work.net.places(triangle), work.picks.cost(triangle));
            let before = work.net.len();
            work.step(triangle);
            if work.net.len() == before {
                continue;
            }
            let least = left.iter().filter_map(|&t| slow_pick(&left, t)).map(|(cost, _)| cost).fold(f64::MAX, f64::min);
            let (cost, rest) = slow_pick(&left, picked).unwrap();
            assert!((cost - cost_here).abs() < 1e-12 && cost <= least + 1e-12, "{cost} {least}");
            left = triangles(&work);
            assert!(as_set(&left) == as_set(&rest));
        }
        assert!(left.iter().all(|&t| slow_pick(&left, t).is_none()) && left.len() < source.triangles.len() / 2);
    }
}

#[test]
fn levels_halve_and_a_regular_step_takes_four() {
    let source = rough_tin(40, 7);
    for reading in CostReading::ALL {
        let chain = centroid_chain(&source, 4, reading).unwrap();
        assert_eq!(chain[0], source);
        for (level, mesh) in chain.iter().enumerate() {
            let want = source.triangles.len() >> level;
            assert!(mesh.triangles.len() <= want && mesh.triangles.len() + 12 > want, "{reading:?} {level}");
        }
    }
}

#[test]
fn what_cannot_be_read_is_refused_and_tiny_meshes_stay() {
    let place = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let positions = vec![place(0.0, 0.0), place(1.0, 0.0), place(0.0, 1.0)];
    let chain = |positions: Vec<DVec3>, triangles| {
        centroid_chain(&TriangleMesh::new(positions, triangles), 3, CostReading::Plain)
    };
    assert_eq!(chain(positions.clone(), vec![[0, 1, 2]]).unwrap()[2].triangles.len(), 1);
    assert!(matches!(chain(positions.clone(), vec![[0, 1, 3]]), Err(MultiresError::BadCorner { vertex: 3, .. })));
    assert!(matches!(chain(positions.clone(), vec![[0, 1, 1]]), Err(MultiresError::NotASurface { .. })));
    assert!(matches!(chain(positions, vec![]), Err(MultiresError::NoTriangles { .. })));
    // two triangles that meet in a point only, and one twice: nothing to take, and no panic
    let bow = vec![place(0.0, 0.0), place(1.0, 0.0), place(0.0, 1.0), place(-1.0, 0.0), place(0.0, -1.0)];
    assert_eq!(chain(bow, vec![[0, 1, 2], [0, 3, 4], [0, 1, 2]]).unwrap()[1].triangles.len(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn no_level_cracks_flips_or_moves_its_border(seed in any::<u64>(), side in 6u32..24, reading in 0usize..4) {
        let source = rough_tin(side, seed);
        for mesh in centroid_chain(&source, 4, CostReading::ALL[reading]).unwrap() {
            prop_assert_eq!(check_conforming(&mesh, &source, Kind::Terrain), Ok(()));
        }
    }
}
