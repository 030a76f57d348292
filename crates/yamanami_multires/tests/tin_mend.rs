//! Mending: what comes out is safe, comes out again as it is, and every face that went is told of.

use glam::DVec3;
use proptest::prelude::*;
use yamanami_core::{Tin, TriangleMesh};
use yamanami_multires::tin::{DelaunayOptions, Fault, MendedTin, mend, triangulate};

fn tin(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Tin {
    Tin::of_mesh("", TriangleMesh::new(positions.iter().map(|&p| p.into()).collect(), triangles.to_vec()))
}

/// A unit square with its diagonal, and points around it.
const PLACES: [[f64; 3]; 8] = [
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.0, 0.0, 5.0],
    [0.5, 0.0, 1.0],
    [0.25, 0.25, 0.0],
    [0.5, -1.0, 0.0],
];

fn told(mended: &MendedTin) -> Vec<(Fault, usize, &str)> {
    mended.faults.iter().map(|m| (m.fault, m.count, m.first.as_str())).collect()
}

#[test]
fn a_sound_tin_stays() {
    let sound = tin(&PLACES, &[[0, 1, 2], [0, 2, 3]]);
    let mended = mend(sound.clone());
    assert_eq!((mended.tin, mended.faults), (sound, vec![]));
}

#[test]
fn each_fault_is_mended_and_told() {
    let faces = [[0, 1, 2], [0, 3, 2], [2, 0, 1], [0, 1, 4], [0, 5, 1], [0, 1, 1], [0, 1, 6], [5, 2, 3]];
    let mended = mend(tin(&PLACES, &faces));
    assert_eq!(mended.tin.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    let expected = [
        (Fault::Sliver, 2, "face 5 at 0.500 0.000 1.000"),
        (Fault::Wall, 1, "face 4 at 0.333 0.000 2.333"),
        (Fault::Turned, 1, "face 2 at 0.333 0.667 1.000"),
        (Fault::DuplicateFace, 1, "face 3 at 0.667 0.333 1.000"),
        (Fault::CrowdedEdge, 2, "face 7 at 0.417 0.083 0.667"),
    ];
    assert_eq!(told(&mended), expected);
    assert_eq!(mended.tin.mesh.positions.len(), 8, "isolated vertices stay");
}

#[test]
fn later_faces_over_earlier_ones_go() {
    let shift = |by: f64| [[0.0, 0.0, by], [4.0, 0.0, by], [0.0, 4.0, by]].map(|[x, y, z]| [x + by, y + by, z]);
    let positions: Vec<[f64; 3]> = [0.0, 1.0, 9.0, 1.5].into_iter().flat_map(shift).collect();
    let faces: Vec<[u32; 3]> = (0..4).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mended = mend(tin(&positions, &faces));
    assert_eq!(mended.tin.mesh.triangles, [faces[0], faces[2]]);
    assert_eq!(told(&mended)[0].0, Fault::Overlap);
    assert_eq!(
        mended.faults[0].to_string(),
        "2 faces that cover an earlier one in plan dropped, the first: face 2 at 2.333 2.333 1.000"
    );
}

#[test]
fn what_is_not_there_goes_and_what_is_twice_is_one() {
    let mut bad = tin(&PLACES, &[[0, 1, 2], [0, 2, 99], [8, 3, 9]]);
    bad.mesh.positions.extend([DVec3::from(PLACES[0]), DVec3::from(PLACES[2]), DVec3::NAN]);
    bad.hidden = vec![[8, 2, 3], [0, 1, 10], [8, 9, 7]];
    let mended = mend(bad);
    assert_eq!(mended.tin.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mended.tin.hidden, [[0, 2, 3], [0, 2, 7]]);
    assert_eq!(mended.tin.mesh.positions.len(), 8);
    let kinds: Vec<_> = told(&mended).iter().map(|m| (m.0, m.1)).collect();
    let expected = [
        (Fault::NowhereVertex, 1),
        (Fault::MissingCorner, 2),
        (Fault::DuplicatePoint, 2),
        (Fault::Turned, 1),
    ];
    assert_eq!(kinds, expected);
}

#[test]
fn t_junctions_are_found_and_left() {
    let open = tin(&PLACES, &[[0, 1, 2], [7, 5, 0]]);
    let mended = mend(open.clone());
    assert_eq!(mended.tin, open);
    assert_eq!(told(&mended), [(Fault::TJunction, 1, "vertex 6 at 0.500 0.000 1.000")]);
    assert!(!mended.faults[0].fault.is_change());
}

#[test]
fn triangulations_are_sound() {
    let points: Vec<DVec3> = (0..2000u32)
        .map(|i| DVec3::new(f64::from(i * 7919 % 1009) * 0.37, f64::from(i * 104_729 % 997) * 0.21, f64::from(i % 13)))
        .collect();
    let made = triangulate(&points, &[], &DelaunayOptions::default()).unwrap().tin;
    let mended = mend(made.clone());
    assert_eq!((mended.tin, mended.faults), (made, vec![]));
}

/// Whether two counter-clockwise triangles of whole coordinates have area in common: by clipping one with the other.
fn share_area(a: [[i64; 2]; 3], b: [[i64; 2]; 3]) -> bool {
    let to_f64 = |t: [[i64; 2]; 3]| t.map(|p| p.map(|v| v as f64));
    let mut polygon: Vec<[f64; 2]> = to_f64(a).to_vec();
    let b = to_f64(b);
    for k in 0..3 {
        let (p, q) = (b[k], b[(k + 1) % 3]);
        let side = |r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let mut clipped = Vec::new();
        for i in 0..polygon.len() {
            let (r, s) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let (at_r, at_s) = (side(r), side(s));
            if at_r >= 0.0 {
                clipped.push(r);
            }
            if at_r * at_s < 0.0 {
                let t = at_r / (at_r - at_s);
                clipped.push([r[0] + t * (s[0] - r[0]), r[1] + t * (s[1] - r[1])]);
            }
        }
        polygon = clipped;
    }
    let area: f64 = (0..polygon.len())
        .map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
        .map(|(r, s)| r[0] * s[1] - r[1] * s[0])
        .sum();
    area > 1e-6
}

proptest! {
    #[test]
    fn any_soup_comes_out_safe(
        places in prop::collection::vec((0..7i32, 0..7i32, 0..2i32), 3..30),
        corners in prop::collection::vec((0..32u32, 0..32u32, 0..32u32), 0..60),
    ) {
        let positions: Vec<[f64; 3]> = places.iter().map(|&(x, y, z)| [x, y, z].map(f64::from)).collect();
        let faces: Vec<[u32; 3]> = corners.iter().map(|&(a, b, c)| [a, b, c]).collect();
        let mended = mend(tin(&positions, &faces));
        let mesh = &mended.tin.mesh;
        let plan = |t: usize| mesh.corners(t).map(|p| [p.x as i64, p.y as i64]);
        for t in 0..mesh.triangles.len() {
            let [a, b, c] = plan(t);
            prop_assert!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0);
            for u in 0..t {
                prop_assert!(!share_area(plan(t), plan(u)), "{t} covers {u}");
            }
        }
        let gone: usize = mended
            .faults
            .iter()
            .filter(|m| !matches!(m.fault, Fault::NowhereVertex | Fault::DuplicatePoint | Fault::Turned | Fault::TJunction))
            .map(|m| m.count)
            .sum();
        prop_assert_eq!(mesh.triangles.len() + gone, faces.len());
        let again = mend(mended.tin.clone());
        prop_assert_eq!(&again.tin, &mended.tin);
        prop_assert!(again.faults.iter().all(|m| !m.fault.is_change()));
    }
}
