//! Remeshing of made surfaces of known kind: what is kept, how close it is, and what is refused.

use glam::DVec3;
use yamanami_core::TriangleMesh;
use yamanami_multires::MultiresError;
use yamanami_multires::remesh::{RemeshOptions, Remeshed, remesh};
use yamanami_testkit::models::{sheet, sphere, torus};

fn with(base_faces: usize, levels: u32) -> RemeshOptions<'static> {
    RemeshOptions { base_faces: Some(base_faces), levels: Some(levels), ..RemeshOptions::default() }
}

/// Whether kind and numbers are kept, and no point is farther than a share of the diagonal.
fn is_sound(remeshed: &Remeshed, greatest: f64) {
    let report = &remeshed.report;
    assert_eq!(report.source_kind, report.result_kind);
    assert_eq!(remeshed.topology.levels(), report.levels);
    assert_eq!(remeshed.positions.len(), remeshed.topology.vertex_count(report.levels) as usize);
    assert!(remeshed.positions.iter().all(|p| p.is_finite()));
    assert!(report.greatest_m <= greatest * report.diagonal_m, "{report:?}");
    assert!(report.folded_faces * 100 <= remeshed.mesh().triangles.len(), "{report:?}");
}

/// A bump on a square with a hole in its middle.
fn holed() -> TriangleMesh {
    let mut mesh = sheet([24, 24], [false; 2], |u, v| {
        DVec3::new(u, v, 0.2 * (-20.0 * ((u - 0.3).powi(2) + (v - 0.6).powi(2))).exp())
    });
    let middle = |t: &[u32; 3], mesh: &TriangleMesh| t.iter().map(|&v| mesh.positions[v as usize]).sum::<DVec3>() / 3.0;
    let all = mesh.clone();
    mesh.triangles.retain(|t| (middle(t, &all).truncate() - DVec3::splat(0.5).truncate()).length() > 0.15);
    mesh
}

#[test]
fn a_sphere_stays_one() {
    let remeshed = remesh(&sphere(4), &with(20, 3)).unwrap();
    is_sound(&remeshed, 0.02);
    assert_eq!(remeshed.report.result_kind.genus, 0);
    assert!(remeshed.report.base_faces <= 20, "{:?}", remeshed.report);
    let radii = remeshed.positions.iter().map(|p| p.length());
    assert!(radii.fold(1.0, f64::min) > 0.98);
}

#[test]
fn a_torus_keeps_its_handle() {
    let remeshed = remesh(&torus(48, 24, 0.0), &with(60, 2)).unwrap();
    is_sound(&remeshed, 0.03);
    assert_eq!((remeshed.report.result_kind.genus, remeshed.report.result_kind.borders), (1, 0));
}

#[test]
fn borders_and_holes_are_kept() {
    let remeshed = remesh(&holed(), &with(40, 3)).unwrap();
    is_sound(&remeshed, 0.02);
    assert_eq!(remeshed.report.result_kind.borders, 2);
    let bounds = remeshed.mesh().bounds();
    for corner in [bounds.min.truncate(), bounds.max.truncate() - 1.0] {
        assert!(corner.length() < 1e-9, "{bounds:?}");
    }
}

#[test]
fn parts_are_kept_and_may_be_small() {
    let mut two = torus(24, 12, 0.02);
    let other = sphere(1);
    let first = two.positions.len() as u32;
    two.positions.extend(other.positions.iter().map(|&p| p * 0.2 + DVec3::new(3.0, 0.0, 0.0)));
    two.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    let remeshed = remesh(&two, &with(1, 2)).unwrap();
    assert_eq!(remeshed.report.result_kind.components, 2);
    assert_eq!(remeshed.report.source_kind, remeshed.report.result_kind);
}

#[test]
fn by_default_there_are_about_as_many_faces() {
    let source = torus(64, 32, 0.02);
    let remeshed = remesh(&source, &RemeshOptions::default()).unwrap();
    let faces = remeshed.mesh().triangles.len();
    assert!(faces >= source.triangles.len() / 2 && faces <= 2 * source.triangles.len(), "{faces}");
}

#[test]
fn colours_are_sampled() {
    let mut source = sphere(3);
    source.colours = source.positions.iter().map(|p| [if p.z > 0.0 { 200 } else { 0 }, 7, 7, 255]).collect();
    let remeshed = remesh(&source, &with(20, 2)).unwrap();
    assert_eq!(remeshed.colours.len(), remeshed.positions.len());
    for (p, c) in remeshed.positions.iter().zip(&remeshed.colours) {
        assert_eq!(c[1..], [7, 7, 255]);
        assert!(p.z.abs() < 0.3 || (c[0] == 200) == (p.z > 0.0), "{p} {c:?}");
    }
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let source = torus(40, 20, 0.05);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| remesh(&source, &with(50, 2)).unwrap())
    };
    let (one, two) = (run(1), run(2));
    assert_eq!(one.positions, two.positions);
    assert_eq!(one.report, two.report);
}

#[test]
fn one_triangle_is_a_base_mesh() {
    let one = TriangleMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]);
    let remeshed = remesh(&one, &with(1, 3)).unwrap();
    is_sound(&remeshed, 1e-9);
    assert_eq!(remeshed.mesh().triangles.len(), 64);
}

#[test]
fn what_is_no_surface_is_refused_with_its_place() {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y, DVec3::new(1.0, 1.0, 2.0)];
    let refused = |triangles: &[[u32; 3]]| {
        remesh(&TriangleMesh::new(corners.clone(), triangles.to_vec()), &RemeshOptions::default()).unwrap_err()
    };
    let fin = refused(&[[0, 1, 2], [1, 0, 4], [0, 1, 3]]);
    assert!(matches!(fin, MultiresError::NotASurface { place_m: [0.5, 0.0, 0.0], .. }), "{fin}");
    let turned = refused(&[[0, 1, 2], [0, 1, 4]]);
    assert!(matches!(turned, MultiresError::NotASurface { place_m: [0.5, 0.0, 0.0], .. }), "{turned}");
    let pinched = refused(&[[0, 1, 2], [0, 3, 5]]);
    assert_eq!(pinched.to_string(), "not a surface at (0.000000, 0.000000, 0.000000): parts touch at vertex 0 alone");
    assert!(matches!(refused(&[]), MultiresError::NoTriangles { triangles: 0 }));
    assert!(matches!(refused(&[[0, 0, 1]]), MultiresError::NoTriangles { triangles: 1 }));
    assert!(matches!(refused(&[[0, 1, 9]]), MultiresError::BadCorner { vertex: 9, .. }));
    let huge = remesh(&sphere(1), &with(8, 30)).unwrap_err();
    assert!(matches!(huge, MultiresError::TooLargeToRemesh { .. }), "{huge}");
}
