//! `reduce` and pictures of models: every way to stop, what is told, and what is written.

mod common;

use common::{error, json, run, stdout};
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::Path;

/// Writes a lumpy ball of `4 * rings * (rings - 1)` triangles.
fn ball(folder: &Path, rings: usize) {
    let across = 2 * rings;
    let mut text = String::from("v 0 0 1\nv 0 0 -1\n");
    for ring in 1..rings {
        let polar = PI * ring as f64 / rings as f64;
        for k in 0..across {
            let azimuth = TAU * k as f64 / across as f64;
            let radius = 1.0 + 0.03 * (7.0 * azimuth).sin() * (9.0 * polar).sin();
            let (x, y) = (azimuth.cos() * polar.sin(), azimuth.sin() * polar.sin());
            let _ = writeln!(text, "v {} {} {}", radius * x, radius * y, radius * polar.cos());
        }
    }
    let at = |ring: usize, k: usize| 3 + (ring - 1) * across + k % across;
    for k in 0..across {
        let _ = writeln!(text, "f 1 {} {}", at(1, k), at(1, k + 1));
        let _ = writeln!(text, "f 2 {} {}", at(rings - 1, k + 1), at(rings - 1, k));
        for ring in 1..rings - 1 {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1)];
            let _ = writeln!(text, "f {a} {c} {d}\nf {a} {d} {b}");
        }
    }
    std::fs::write(folder.join("ball.obj"), text).unwrap();
}

#[test]
fn every_way_to_say_how_far_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder, 32);
    let source = 4 * 32 * 31;
    for (how, target) in [("--faces 500", 500), ("--ratio 0.1", source / 10), ("--ratio 0.25", source / 4)] {
        for method in ["memoryless", "garland97"] {
            let result = json(folder, &format!("reduce %/ball.obj -o %/small.ply {how} --method {method}"));
            let faces = result["faces"].as_i64().unwrap();
            assert!((faces - target as i64).abs() <= 2, "{how} {method}: {result}");
            assert_eq!(
                (result["stopped_by"].as_str(), result["source_faces"].as_u64()),
                (Some("target"), Some(source))
            );
            let seen = json(folder, "info %/small.ply");
            assert_eq!(seen["faces"].as_i64(), Some(faces), "{seen}");
        }
    }
    let result = json(folder, "reduce %/ball.obj -o %/small.glb --error 0.02");
    assert_eq!(result["stopped_by"], "error");
    assert!(result["faces"].as_u64().unwrap() < source / 2, "{result}");
}

#[test]
fn a_display_is_drawn_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder, 32);
    let result = json(folder, "reduce %/ball.obj -o %/small.ply --display 64x48 --views 3 --polygons-per-pixel 0.5");
    let display = &result["display"];
    let covered: Vec<u64> = display["covered_px"].as_array().unwrap().iter().map(|v| v.as_u64().unwrap()).collect();
    assert_eq!((covered.len(), display["pixels"].as_u64()), (3, covered.iter().copied().max()));
    // a ball of 94 % of the height
    assert!(covered.iter().all(|&n| (1300..1800).contains(&n)), "{covered:?}");
    let target = (display["pixels"].as_f64().unwrap() * 0.5).round() as u64;
    assert_eq!(result["target_faces"].as_u64(), Some(target));
    assert!(result["faces"].as_u64().unwrap().abs_diff(target) <= 2, "{result}");
    let table = stdout(folder, "reduce %/ball.obj -o %/small.ply --display 64x48");
    assert!(table.contains("nothing to do: the source has 3,968 faces"), "{table}");
    assert!(table.contains("pixels (1x)") && table.contains("64x48"), "{table}");
    assert_eq!(json(folder, "info %/small.ply")["faces"], 3968);
    let near = "--eye 0,-4,0 --target 0,0,0 --fov 30";
    let one = json(folder, &format!("reduce %/ball.obj -o %/small.ply --display 64x48 {near} --polygons-per-pixel 1"));
    assert_eq!(one["display"]["covered_px"].as_array().map(Vec::len), Some(1));
}

#[test]
fn the_hidden_side_becomes_a_polygon_or_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder, 32);
    let how = "--display 160x120 --polygons-per-pixel 0.05";
    let closed = json(folder, &format!("reduce %/ball.obj -o %/closed.ply {how} --hide-back close"));
    assert!(closed["hidden_faces"].as_u64().unwrap() > 1200, "{closed}");
    assert_eq!((closed["closing"]["polygons"].as_u64(), closed["closing"]["left_open"].as_u64()), (Some(1), Some(0)));
    assert!(closed["faces"].as_u64().unwrap() <= closed["target_faces"].as_u64().unwrap(), "{closed}");
    let info = json(folder, "info %/closed.ply");
    assert_eq!(info["open_edges"].as_u64(), Some(0), "{info}");
    let open = json(folder, &format!("reduce %/ball.obj -o %/open.ply {how} --hide-back drop"));
    assert!(open["closing"].is_null() && open["hidden_faces"] == closed["hidden_faces"], "{open}");
}

#[test]
fn what_looks_the_same_is_found_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder, 48);
    let result = json(folder, "reduce %/ball.obj -o %/small.ply --look same --display 128x96 --views 2");
    let (faces, look) = (result["faces"].as_u64().unwrap(), &result["look"]);
    assert!(faces < 4 * 48 * 47 / 2, "{result}");
    assert!(look["difference"]["flip_mean"].as_f64().unwrap() > 0.0, "{result}");
    let probes = look["probes"].as_array().unwrap();
    assert!(probes.iter().any(|p| p["same"] == true && p["faces"].as_u64() == Some(faces)), "{result}");
    assert!(stdout(folder, "reduce %/ball.obj -o %/small.ply --look same --display 128x96").contains("looks same"));
}

#[test]
fn models_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder, 16);
    let drawn = json(folder, "render %/ball.obj -o %/ball.png --size 160x120 --draw software");
    assert_eq!(drawn["triangles"], 4 * 16 * 15);
    let covered = drawn["covered_px"].as_u64().unwrap();
    let picture = image::open(folder.join("ball.png")).unwrap().into_rgb8();
    assert_eq!(picture.dimensions(), (160, 120));
    let ground = picture.get_pixel(0, 0);
    let shown = picture.pixels().filter(|p| *p != ground).count() as u64;
    assert!(covered > 5000 && shown >= covered && shown < covered + 600, "{covered} {shown}");
    for style in ["--flat", "--one-sample", "--wireframe", "--up y", "--eye 9,0,0 --target 0,0,0"] {
        stdout(folder, &format!("render %/ball.obj -o %/b.png --size 160x120 --draw software {style}"));
    }
    let line = error(folder, "render %/ball.obj -o %/b.png --image %/ball.png", 2);
    assert!(line.contains("--image"), "{line}");
}

#[test]
fn a_model_larger_than_memory_is_reduced_by_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder, 64);
    json(folder, "reduce %/ball.obj -o %/ball.ply --ratio 1");
    let result = json(folder, "reduce %/ball.ply -o %/small.ply --ratio 0.05 --memory 27MB");
    let source = 4 * 64 * 63;
    assert_eq!((result["source_faces"].as_u64(), result["stopped_by"].as_str()), (Some(source), Some("target")));
    assert!(result["blocks"][0].as_u64() > Some(2) && result["faces"].as_u64().unwrap().abs_diff(source / 20) <= 2);
    let seen = json(folder, "info %/small.ply");
    assert_eq!(seen["faces"], result["faces"], "{seen}");
    let text = stdout(folder, "reduce %/ball.ply -o %/small.ply --faces 900 --memory 27MB");
    assert!(text.contains("blocks") && text.contains("allowed"), "{text}");
    assert!(stdout(folder, "reduce %/ball.ply -o %/small.ply --faces 900 --memory 1GB").contains("fits into memory"));
    let line = error(folder, "reduce %/ball.ply -o %/small.ply --faces 900 --memory 3MB", 1);
    assert!(line.contains("memory: ") && line.contains("given 3 MB"), "{line}");
    let line = error(folder, "reduce %/ball.obj -o %/small.ply --faces 900 --memory 3MB", 1);
    assert!(line.contains("only PLY files"), "{line}");
    let line = error(folder, "reduce %/ball.ply -o %/small.ply --memory 1GB", 2);
    assert!(line.contains("how far?"), "{line}");
    // the argument parser says what goes with what, in more than a line
    let both = run(folder, "reduce %/ball.ply -o %/small.ply --faces 9 --error 1 --memory 1GB");
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn what_makes_no_sense_is_said_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder, 8);
    let line = error(folder, "reduce %/ball.obj -o %/small.ply", 2);
    assert!(line.contains("how far?"), "{line}");
    let line = error(folder, "reduce %/ball.obj -o %/small.ply --faces 9 --hide-back drop", 2);
    assert!(line.contains("--display"), "{line}");
    let line = error(folder, "reduce %/ball.obj -o %/ball.obj --faces 9", 1);
    assert!(line.contains("is an input"), "{line}");
    // topology allows no fewer than four faces of a closed surface
    let result = json(folder, "reduce %/ball.obj -o %/small.ply --faces 1");
    assert_eq!((result["stopped_by"].as_str(), result["faces"].as_u64() >= Some(4)), (Some("topology"), true));
    let text = stdout(folder, "reduce %/ball.obj -o %/small.ply --faces 1");
    assert!(text.contains("no edge is left") && text.contains("1 were wanted"), "{text}");
}
