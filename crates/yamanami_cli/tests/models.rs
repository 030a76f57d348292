//! A scan from file to database, flight, picture and mesh, as a user would go.

mod common;

use common::{error, json, stdout};
use std::fmt::Write as _;
use std::path::Path;

/// A closed bumpy ring in colours, as an ascii PLY.
fn write_ring(path: &Path, n: u32, m: u32) {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        n * m,
        2 * n * m
    );
    for i in 0..n * m {
        let turn = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        let (u, v) = (turn(i % n, n), turn(i / n, m));
        let r = 1.0 + 0.06 * (8.0 * u).sin() * (5.0 * v).cos();
        let p = [(3.0 + r * v.cos()) * u.cos(), (3.0 + r * v.cos()) * u.sin(), r * v.sin()];
        let _ = writeln!(
            text,
            "{} {} {} {} {} 40",
            p[0],
            p[1],
            p[2],
            128 + (p[0] * 25.0) as i32,
            128 + (p[2] * 90.0) as i32
        );
    }
    for i in 0..n * m {
        let number = |x: u32, y: u32| (y % m) * n + x % n;
        let (x, y) = (i % n, i / n);
        let [a, b, c, d] = [number(x, y), number(x + 1, y), number(x + 1, y + 1), number(x, y + 1)];
        let _ = writeln!(text, "3 {a} {b} {c}\n3 {a} {c} {d}");
    }
    std::fs::write(path, text).unwrap();
}

#[test]
fn a_scan_is_built_told_flown_drawn_and_extracted() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_ring(&folder.join("ring.ply"), 140, 90);
    let built = json(folder, "build %/ring.ply -o %/ring.yama");
    assert_eq!(built["faces"], 25_200);
    assert!(built["bytes_per_face"].as_f64().unwrap() < 12.0, "{built}");
    let apart = json(folder, "compare %/ring.ply %/ring.yama --samples 100000");
    assert!(apart["hausdorff_m"].as_f64().unwrap() <= built["max_error_m"].as_f64().unwrap(), "{apart}");
    let told = json(folder, "info %/ring.yama --verify");
    assert_eq!((told["kind"].as_str(), told["faces"].as_u64()), (Some("database"), Some(25_200)));
    assert_eq!((told["has_colours"].as_bool(), told["verified"].as_bool()), (Some(true), Some(true)));
    assert!(stdout(folder, "info %/ring.yama").contains("database of a model"));
    assert_eq!(json(folder, "info %/ring.yama %/ring.ply").as_array().map(Vec::len), Some(2));

    for source in ["%/ring.yama", "%/ring.ply"] {
        let flight = json(folder, &format!("fly {source} --budget 6000 --frames 20 --no-draw --compare"));
        assert_eq!((flight["path"].as_str(), flight["frames"].as_array().unwrap().len()), (Some("orbit"), 20));
        for frame in flight["frames"].as_array().unwrap() {
            assert!(frame["triangles"].as_u64().unwrap() <= 6000, "{frame}");
        }
        let changed: u64 = flight["frames"].as_array().unwrap().iter().map(|f| f["refined"].as_u64().unwrap()).sum();
        assert!(changed > 20, "{}", flight["summary"]);
        assert!(flight["comparison"]["rebuild_over_differences"].as_f64().is_some());

        let mut last = u64::MAX;
        for tolerance in ["0", "0.05", "0.3"] {
            let result = json(folder, &format!("extract {source} --tolerance {tolerance} --check -o %/part.ply"));
            assert_eq!(
                (result["check"]["open_edges"].as_u64(), result["limited_by"].as_str()),
                (Some(0), Some("tolerance"))
            );
            let triangles = result["triangles"].as_u64().unwrap();
            assert!(triangles < last);
            last = triangles;
        }
        let mesh = json(folder, "info %/part.ply");
        assert_eq!((mesh["open_edges"].as_u64(), mesh["non_manifold_edges"].as_u64()), (Some(0), Some(0)));
        let few = json(folder, &format!("extract {source} --budget 5000 -o %/few.glb"));
        assert!(few["triangles"].as_u64().unwrap() <= 5000 && few["limited_by"] == "budget", "{few}");
    }

    let drawn = json(folder, "render %/ring.yama --budget 9000 --size 320x200 --draw software -o %/ring.png");
    assert!(drawn["triangles"].as_u64().unwrap() <= 9000);
    let picture = image::open(folder.join("ring.png")).unwrap().into_rgb8();
    let colours: std::collections::HashSet<_> = picture.pixels().collect();
    assert!(picture.dimensions() == (320, 200) && colours.len() > 300, "{} colours", colours.len());
}

#[test]
fn what_is_no_model_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_ring(&folder.join("ring.ply"), 20, 12);
    stdout(folder, "build %/ring.ply -o %/ring.yama");
    assert!(error(folder, "fly %/ring.yama --path valley --no-draw", 2).contains("no valleys"));
    assert!(error(folder, "build %/ring.ply @ -o %/both.yama", 2).contains("stands alone"));
    assert!(error(folder, "build %/ring.ply --max-error 0 -o %/exact.yama", 1).contains("at best"));
    assert!(error(folder, "build %/ring.yama -o %/again.yama", 1).contains("database already"));
    let whole = std::fs::read(folder.join("ring.yama")).unwrap();
    std::fs::write(folder.join("cut.yama"), &whole[..whole.len() / 2]).unwrap();
    assert!(error(folder, "fly %/cut.yama --no-draw", 1).contains("cut short"));
    std::fs::write(folder.join("none.obj"), "v 0 0 0\n").unwrap();
    error(folder, "build %/none.obj -o %/none.yama", 1);
}
