//! Meshes larger than the memory allowed: as good as those reduced whole, closed where they were, and nothing left behind.

use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;
use yamanami::core::TriangleMesh;
use yamanami::io::mesh_file::{MeshMeta, read_mesh, write_mesh};
use yamanami::measure::surface_distance;
use yamanami::multires::collapse::{CollapseOptions, StoppedBy, collapse};
use yamanami::{Error, LargeOptions, LargeReport, LargeTarget, reduce_large};

/// A closed ring with bumps of many sizes, rougher on one side.
fn ring(around: u32, across: u32) -> TriangleMesh {
    let mut positions = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (f64::from(i) / f64::from(around) * TAU, f64::from(j) / f64::from(across) * TAU);
            let bump = |n: f64| ((n * u).sin() * (n * v + n).cos()) / n;
            let rough = 0.5 + 0.5 * u.cos();
            let r = 1.0 + 0.3 * bump(3.0) + rough * (0.6 * bump(8.0) + 0.6 * bump(21.0) + 0.4 * bump(40.0));
            let out = 3.0 + r * v.cos();
            positions.push(DVec3::new(out * u.cos(), out * u.sin(), r * v.sin()) * 10.0 + DVec3::splat(4000.0));
        }
    }
    let at = |i: u32, j: u32| i % around * across + j % across;
    let square = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let triangles = (0..around).flat_map(|i| (0..across).map(move |j| (i, j))).flat_map(square).collect();
    TriangleMesh::new(positions, triangles)
}

/// Vertices minus edges plus faces, where every edge has two faces that run along it in opposite directions.
fn euler_of_closed(mesh: &TriangleMesh) -> Result<i64, String> {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for t in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            edges.entry([a.min(b), a.max(b)]).or_default()[usize::from(a < b)] += 1;
        }
    }
    if let Some((edge, sides)) = edges.iter().find(|(_, sides)| **sides != [1, 1]) {
        return Err(format!("edge {edge:?} has {sides:?} faces"));
    }
    Ok(mesh.positions.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64)
}

fn options(target: LargeTarget, memory_bytes: u64) -> LargeOptions {
    LargeOptions::new(target, memory_bytes)
}

fn reduced(mesh: &TriangleMesh, options: &LargeOptions) -> (LargeReport, TriangleMesh) {
    let folder = tempfile::tempdir().unwrap();
    let [input, output] = ["in.ply", "out.ply"].map(|name| folder.path().join(name));
    write_mesh(&input, mesh, &MeshMeta::default()).unwrap();
    let report = reduce_large(&input, &output, options, &|_| ()).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "no scratch file is left");
    (report, read_mesh(&output).unwrap())
}

#[test]
fn blocks_do_not_show_in_the_result() {
    let mesh = ring(240, 160);
    let ratio = 0.02;
    let (report, small) = reduced(&mesh, &options(LargeTarget::Ratio(ratio), 32_000_000));
    assert!(report.blocks[0] > 3 && report.seam_faces > 100, "{report:?}");
    assert_eq!((report.source_faces, report.stopped_by), (mesh.triangles.len() as u64, StoppedBy::Target));
    assert_eq!(euler_of_closed(&small), Ok(0), "a ring stays a ring");
    let target = (mesh.triangles.len() as f64 * ratio) as usize;
    assert!(small.triangles.len().abs_diff(target) <= 2, "{} faces", small.triangles.len());

    let whole = collapse(&mesh, &CollapseOptions { target_faces: target, ..CollapseOptions::default() });
    let error_m = |m: &TriangleMesh| surface_distance(&mesh, m, 100_000, 1).rms_m;
    let (blocks_m, whole_m) = (error_m(&small), error_m(&whole.mesh));
    assert!(blocks_m < 1.1 * whole_m, "RMS {blocks_m} m by blocks, {whole_m} m as a whole");
}

#[test]
fn results_do_not_depend_on_threads() {
    let mesh = ring(180, 120);
    let options = options(LargeTarget::Faces(500), 29_000_000);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (report, once) = alone.install(|| reduced(&mesh, &options));
    assert!(report.blocks[0] > 3, "{report:?}");
    assert_eq!(reduced(&mesh, &options).1, once);
}

#[test]
fn what_fits_is_reduced_whole() {
    let mesh = ring(60, 40);
    let (report, small) = reduced(&mesh, &options(LargeTarget::Faces(400), 1 << 30));
    assert!(report.blocks.is_empty());
    let whole = collapse(&mesh, &CollapseOptions { target_faces: 400, ..CollapseOptions::default() });
    assert_eq!(small.triangles, whole.mesh.triangles);
}

fn refused(input: &Path, options: &LargeOptions) -> String {
    let output = input.with_file_name("out.ply");
    let before = std::fs::read_dir(input.parent().unwrap()).unwrap().count();
    let error: Error = reduce_large(input, &output, options, &|_| ()).unwrap_err();
    assert_eq!(std::fs::read_dir(input.parent().unwrap()).unwrap().count(), before, "neither result nor scratch file");
    let line = error.to_string();
    assert!(!line.contains('\n'), "{line}");
    line
}

#[test]
fn failures_are_one_line_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.ply");
    let mesh = ring(180, 120);
    write_mesh(&input, &mesh, &MeshMeta::default()).unwrap();
    let small = options(LargeTarget::Ratio(0.01), 29_000_000);

    let line = refused(&input, &options(LargeTarget::Ratio(0.9), 29_000_000));
    assert!(line.contains("memory: a result of 38880 faces: expected at least"), "{line}");
    let line = refused(&input, &options(LargeTarget::Ratio(0.01), 1_000_000));
    assert!(line.contains("memory: ") && line.contains("given 1 MB"), "{line}");

    let bytes = std::fs::read(&input).unwrap();
    // a corner of the last face
    let mut damaged = bytes.clone();
    let last = bytes.len() - 4;
    damaged[last..].copy_from_slice(&u32::MAX.to_le_bytes());
    std::fs::write(&input, &damaged).unwrap();
    let line = refused(&input, &small);
    assert!(line.contains("in.ply: face 43199: expected corners below 21600"), "{line}");

    std::fs::write(&input, &bytes[..bytes.len() / 2]).unwrap();
    assert!(refused(&input, &small).contains("element 'face': expected at least"));

    std::fs::write(&input, &bytes).unwrap();
    let nowhere = LargeOptions { scratch: Some(folder.path().join("absent")), ..small };
    assert!(refused(&input, &nowhere).contains("absent: "));
}
