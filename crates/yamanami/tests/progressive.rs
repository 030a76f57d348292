//! Progressive files: what goes in comes out, and any prefix is a coarser model.

use glam::DVec3;
use std::path::Path;
use yamanami::core::{BaseMesh, Predictor, SemiRegular};
use yamanami::io::progressive::ProgressiveLimits;
use yamanami::{ProgressiveOptions, ProgressiveSurface, decode_progressive, encode_progressive, read_progressive};

/// A bumpy ball on the octahedron.
fn ball(levels: u32) -> (SemiRegular, Vec<DVec3>) {
    let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let mesh = SemiRegular::new(BaseMesh::new(6, faces).unwrap(), levels).unwrap();
    let mut unit = vec![DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
    for v in 6..mesh.vertex_count(levels) {
        let [p, q] = mesh.parents(v).unwrap();
        unit.push((unit[p as usize] + unit[q as usize]).normalize());
    }
    let bumps = |u: DVec3| 1.0 + 0.1 * (5.0 * u.x).sin() * (4.0 * u.y).cos() + 0.01 * (21.0 * u.z + 9.0 * u.x).sin();
    (mesh, unit.into_iter().map(|u| DVec3::new(30.0, -7.0, 2.0) + 4.0 * bumps(u) * u).collect())
}

/// A wavy piece of cloth: with border, with a vertex of four triangles and one of one, and a triangle apart.
fn cloth(levels: u32) -> (SemiRegular, Vec<DVec3>) {
    let faces = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 5, 2], [7, 8, 6]];
    let mesh = SemiRegular::new(BaseMesh::new(9, faces).unwrap(), levels).unwrap();
    let mut flat = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 1], [4, 1], [5, 5], [6, 5], [5, 6]]
        .map(|[x, y]| DVec3::new(x.into(), y.into(), 0.0))
        .to_vec();
    for v in 9..mesh.vertex_count(levels) {
        let [p, q] = mesh.parents(v).unwrap();
        flat.push(0.5 * (flat[p as usize] + flat[q as usize]));
    }
    (mesh, flat.into_iter().map(|p| p + DVec3::Z * (2.0 * p.x).sin() * (1.5 * p.y).cos()).collect())
}

fn lone_triangle(levels: u32) -> (SemiRegular, Vec<DVec3>) {
    let mesh = SemiRegular::new(BaseMesh::new(3, vec![[0, 1, 2]]).unwrap(), levels).unwrap();
    let mut all = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    for v in 3..mesh.vertex_count(levels) {
        let [p, q] = mesh.parents(v).unwrap();
        let middle = 0.5 * (all[p as usize] + all[q as usize]);
        all.push(middle + DVec3::new(0.0, 0.0, 0.3 * middle.x * middle.y));
    }
    (mesh, all)
}

fn decode(bytes: &[u8]) -> ProgressiveSurface {
    decode_progressive(Path::new("m.yamap"), bytes, ProgressiveLimits::default()).unwrap()
}

fn options() -> Vec<ProgressiveOptions> {
    let usual = ProgressiveOptions { title: "a title".into(), source: "a source".into(), ..Default::default() };
    let hat = ProgressiveOptions { predictor: Predictor::Hat, ..usual.clone() };
    let plain = ProgressiveOptions { update: 0.0, ..usual.clone() };
    vec![usual, hat, plain]
}

#[test]
fn whole_files_are_as_exact_as_they_say() {
    for (mesh, positions_m) in [ball(4), cloth(4), lone_triangle(5), lone_triangle(0)] {
        for options in options() {
            let file = encode_progressive(&mesh, &positions_m, &options).unwrap();
            let read = decode(&file.bytes);
            assert_eq!((read.report.bytes, read.report.planes), (read.report.bytes_of, read.report.planes_of));
            assert_eq!((read.meta.title.as_str(), read.meta.source.as_str()), ("a title", "a source"));
            let levels = mesh.levels();
            assert_eq!(
                (read.mesh.levels(), read.mesh.base().triangles().len()),
                (levels, mesh.base().triangles().len())
            );
            for (v, &old) in file.old_vertices.iter().enumerate() {
                let error_m = read.positions_m[v].distance(positions_m[old as usize]);
                assert!(error_m <= file.max_error_m, "vertex {v}: {error_m} m, said to be {} m", file.max_error_m);
            }
            assert!(file.max_error_m < 6e-4, "{} m", file.max_error_m);
            // the same surface: each triangle is one of the old ones
            let sorted = |mut t: [u32; 3]| {
                let least = (0..3).min_by_key(|&k| t[k]).unwrap();
                t.rotate_left(least);
                t
            };
            let mut new: Vec<_> = read
                .mesh
                .triangles(levels)
                .into_iter()
                .map(|t| sorted(t.map(|v| file.old_vertices[v as usize])))
                .collect();
            let mut old: Vec<_> = mesh.triangles(levels).into_iter().map(sorted).collect();
            new.sort_unstable();
            old.sort_unstable();
            assert_eq!(new, old);
            // a model that was read is told by the same bytes of its head, and keeps its numbers
            let again = encode_progressive(&read.mesh, &read.positions_m, &options).unwrap();
            assert!(again.old_vertices.iter().enumerate().all(|(new, &old)| new as u32 == old));
        }
    }
}

#[test]
fn every_prefix_is_a_model_and_longer_ones_are_closer() {
    for (mesh, positions_m) in [ball(3), cloth(3)] {
        for options in options() {
            let file = encode_progressive(&mesh, &positions_m, &options).unwrap();
            let head = (0..file.bytes.len())
                .find(|&n| decode_progressive(Path::new("m"), &file.bytes[..n], ProgressiveLimits::default()).is_ok())
                .unwrap();
            let error_m = |n: usize| {
                let read = decode(&file.bytes[..n]);
                assert_eq!(read.report.bytes, n as u64);
                let squares = read
                    .positions_m
                    .iter()
                    .zip(&file.old_vertices)
                    .map(|(p, &v)| p.distance_squared(positions_m[v as usize]));
                (squares.sum::<f64>() / positions_m.len() as f64).sqrt()
            };
            let errors: Vec<f64> = (head..=file.bytes.len()).step_by(5).map(error_m).collect();
            let mut least = f64::MAX;
            for (i, &error) in errors.iter().enumerate() {
                assert!(error < 1.3 * least, "{error} m after {least} m, in step {i} of {}", errors.len());
                least = least.min(error);
            }
            assert!(
                errors[errors.len() - 1] < 1e-3 * errors[0],
                "from {} m to {} m",
                errors[0],
                errors[errors.len() - 1]
            );
        }
    }
}

#[test]
fn threads_change_nothing() {
    let (mesh, positions_m) = ball(5);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let file = encode_progressive(&mesh, &positions_m, &options()[0]).unwrap();
            (decode(&file.bytes[..file.bytes.len() / 2]).positions_m, file.bytes)
        })
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let (mesh, mut positions_m) = lone_triangle(2);
    let usual = ProgressiveOptions::default();
    let error = |positions_m: &[DVec3], options: &ProgressiveOptions| {
        encode_progressive(&mesh, positions_m, options).unwrap_err().to_string()
    };
    assert!(error(&positions_m[1..], &usual).contains("15 vertices expected"));
    assert!(error(&positions_m, &ProgressiveOptions { precision: 0.0, ..usual.clone() }).contains("precision"));
    assert!(error(&positions_m, &ProgressiveOptions { level_ratio: -1.0, ..usual.clone() }).contains("ratio"));
    let empty = SemiRegular::new(BaseMesh::new(0, Vec::new()).unwrap(), 2).unwrap();
    assert!(encode_progressive(&empty, &[], &usual).unwrap_err().to_string().contains("empty"));
    positions_m[3].y = f64::NAN;
    assert!(error(&positions_m, &usual).contains("vertex 3"));
}

#[test]
fn files_are_read_from_disk_in_part() {
    let (mesh, positions_m) = ball(2);
    let file = encode_progressive(&mesh, &positions_m, &ProgressiveOptions::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.yamap");
    yamanami::io::progressive::write(&path, &file.bytes).unwrap();
    let n = file.bytes.len() as u64 - 60;
    let read = read_progressive(&path, n, ProgressiveLimits::default()).unwrap();
    assert_eq!((read.report.bytes, read.report.bytes_of), (n, file.bytes.len() as u64));
    assert_eq!(read.positions_m, decode(&file.bytes[..n as usize]).positions_m);
    let missing = read_progressive(&folder.path().join("n.yamap"), n, ProgressiveLimits::default());
    assert!(missing.unwrap_err().to_string().contains("n.yamap"));
}
