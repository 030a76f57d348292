//! Each step of cleaning does what it says, says what it did, and leaves a sound mesh alone.

use super::*;
use proptest::prelude::*;

const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> TriangleMesh {
    TriangleMesh::new(points.iter().map(|&p| p.into()).collect(), triangles.to_vec())
}

/// Every face with its own vertices.
fn soup(mesh: &TriangleMesh) -> TriangleMesh {
    let positions = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]).collect();
    TriangleMesh::new(positions, (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

#[test]
fn a_sound_mesh_stays_as_it_is() {
    let mut solid = mesh(&CORNERS, &TETRAHEDRON);
    let options = CleanOptions { min_component_faces: 4, orient: true, drop_zero_area: true, ..CleanOptions::safe() };
    assert_eq!(clean(&mut solid, &options), CleanReport::default());
    assert_eq!(solid, mesh(&CORNERS, &TETRAHEDRON));
}

#[test]
fn a_soup_is_welded_and_seams_are_kept() {
    let mut faces = soup(&mesh(&CORNERS, &TETRAHEDRON));
    let welding = CleanOptions { weld_m: Some(0.0), ..CleanOptions::default() };
    assert_eq!(clean(&mut faces, &welding).welded_vertices, 8);
    assert_eq!(faces.positions.len(), 4);

    let mut seamed = soup(&mesh(&CORNERS, &TETRAHEDRON));
    // the first face is another colour
    seamed.colours = (0..12).map(|i| [if i < 3 { 9 } else { 200 }; 4]).collect();
    assert_eq!(clean(&mut seamed, &welding).welded_vertices, 5);
    assert_eq!((seamed.positions.len(), seamed.colours.len()), (7, 7));
    let across = CleanOptions { weld_across_seams: true, ..welding };
    assert_eq!(clean(&mut seamed, &across).welded_vertices, 3);
}

#[test]
fn near_vertices_weld_across_cells() {
    let points = [[0.999, 0.0, 0.0], [1.001, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0005, 5.0, 0.0]];
    let mut sheet = mesh(&points, &[[0, 2, 3], [1, 2, 4]]);
    let options = CleanOptions { weld_m: Some(0.01), drop_duplicates: true, ..CleanOptions::default() };
    let report = clean(&mut sheet, &options);
    assert_eq!((report.welded_vertices, report.duplicate_faces), (2, 1));
    assert_eq!(sheet.positions, mesh(&[points[0], points[2], points[3]], &[]).positions);
}

#[test]
fn faces_that_are_none_and_loose_parts_go_with_their_materials() {
    let mut points = CORNERS.to_vec();
    points.extend([[2.0, 0.0, 0.0], [7.0, 7.0, 7.0], [8.0, 7.0, 7.0], [7.0, 8.0, 7.0]]);
    let mut triangles = TETRAHEDRON.to_vec();
    triangles.extend([[0, 1, 4], [1, 1, 2], [2, 1, 0], [5, 6, 7]]);
    let mut scan = mesh(&points, &triangles);
    scan.material_of = (0..8).collect();
    let options = CleanOptions { drop_zero_area: true, min_component_faces: 2, ..CleanOptions::safe() };
    let report = clean(&mut scan, &options);
    let expected = CleanReport {
        repeated_corner_faces: 1,
        zero_area_faces: 1,
        duplicate_faces: 1,
        small_components: 1,
        small_component_faces: 1,
        isolated_vertices: 4,
        ..CleanReport::default()
    };
    assert_eq!(report, expected);
    assert_eq!((scan.triangles, scan.material_of), (TETRAHEDRON.to_vec(), vec![0, 1, 2, 3]));
    assert_eq!(report.changes().len(), 6);
}

#[test]
fn turned_faces_turn_back_and_a_band_with_a_twist_is_told() {
    let mut solid = mesh(&CORNERS, &TETRAHEDRON);
    solid.triangles[2].swap(0, 1);
    let options = CleanOptions { orient: true, ..CleanOptions::default() };
    assert_eq!(clean(&mut solid, &options).turned_faces, 1);
    assert_eq!(solid.triangles[2], [2, 3, 1]);

    // a band of six faces whose ends meet upside down
    let n = 6u32;
    let points: Vec<[f64; 3]> = (0..n).map(|k| [f64::from(k), f64::from(k * k % 7), f64::from(k % 2)]).collect();
    let triangles: Vec<[u32; 3]> = (0..n)
        .map(|k| {
            let t = [k, k + 1, k + 2].map(|v| v % n);
            if k % 2 == 0 { t } else { [t[1], t[0], t[2]] }
        })
        .collect();
    let band = clean(&mut mesh(&points, &triangles), &options);
    let twisted: Vec<[u32; 3]> = (0..5).map(|k| [k, k + 1, k + 2].map(|v| v % 5)).collect();
    let moebius = clean(&mut mesh(&points[..5], &twisted), &options);
    assert_eq!((band.one_sided_edges, moebius.one_sided_edges), (0, 1));
}

proptest! {
    #[test]
    fn any_faces_come_out_valid_and_a_second_time_changes_nothing(
        points in prop::collection::vec(prop::array::uniform3(-2..3i32), 3..20),
        faces in prop::collection::vec(prop::array::uniform3(0..1000u32), 1..40),
        weld in prop_oneof![Just(None), Just(Some(0.0)), Just(Some(0.5))],
        least in 0..4usize,
    ) {
        let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
        let faces: Vec<[u32; 3]> = faces.iter().map(|t| t.map(|i| i % points.len() as u32)).collect();
        let mut mesh = mesh(&points, &faces);
        let options = CleanOptions { weld_m: weld, min_component_faces: least, orient: true, drop_zero_area: true,
            ..CleanOptions::safe() };
        let report = clean(&mut mesh, &options);
        let gone = report.repeated_corner_faces + report.zero_area_faces + report.duplicate_faces
            + report.small_component_faces;
        prop_assert_eq!(mesh.triangles.len() + gone, faces.len());
        prop_assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
        let again = clean(&mut mesh, &options);
        prop_assert_eq!(again, CleanReport { one_sided_edges: again.one_sided_edges, ..CleanReport::default() });
    }
}
