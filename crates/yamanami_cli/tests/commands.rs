//! Every command on real terrain: exit codes, files, and numbers for programs.

mod common;

use common::{error, json, run, stdout};

#[test]
fn info_tells_a_dem_a_database_and_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let dem = json(folder, "info @ --picture %/map.png");
    assert_eq!(
        (dem["kind"].as_str(), dem["width"].as_u64(), dem["height"].as_u64()),
        (Some("dem"), Some(257), Some(257))
    );
    assert_eq!(dem["crs"]["epsg"], 32619);
    assert_eq!(dem["step_x_m"], 50.0);
    assert_eq!(dem["no_data_share"], 0.0);
    let (low, high) = (dem["min_m"].as_f64().unwrap(), dem["max_m"].as_f64().unwrap());
    assert!(low > 400.0 && low < 450.0 && high > 1880.0 && high < 1917.0, "{low} {high}");
    let map = image::open(folder.join("map.png")).unwrap().into_rgb8();
    assert_eq!(map.dimensions(), (640, 640));
    let colours: std::collections::HashSet<_> = map.pixels().collect();
    assert!(colours.len() > 1000, "a map has relief");

    stdout(folder, "build @ -o %/m.yama");
    let database = json(folder, "info %/m.yama --verify");
    assert_eq!(database["kind"], "database");
    assert_eq!(database["samples"], 257 * 257);
    assert_eq!(database["max_m"], dem["max_m"]);
    assert_eq!(database["verified"], true);

    stdout(folder, "extract %/m.yama --tolerance 20 -o %/m.ply");
    let mesh = json(folder, "info %/m.ply");
    assert_eq!(mesh["kind"], "mesh");
    assert_eq!((mesh["is_terrain"].as_bool(), mesh["t_vertices"].as_u64()), (Some(true), Some(0)));
    let several = json(folder, "info @ %/m.yama %/m.ply");
    assert_eq!(several.as_array().map(Vec::len), Some(3));
    assert!(stdout(folder, "info @").contains("EPSG:32619"));
}

#[test]
fn info_tells_what_is_wrong_with_a_scan() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // a tetrahedron with its first face twice, a face with a corner twice, and two vertices too many, one of them lost
    let scan = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 6\n\
        property list uchar int vertex_indices\nend_header\n0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n0 0 1 9 9 9\n\
        nan 0 0 9 9 9\n5 5 5 9 9 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n3 2 1 0\n3 1 1 0\n";
    std::fs::write(folder.join("scan.ply"), scan).unwrap();
    let told = json(folder, "info %/scan.ply");
    let numbers = ["faces", "vertices", "components", "open_edges", "non_manifold_edges", "duplicate_faces"];
    assert_eq!(numbers.map(|name| told[name].as_u64().unwrap()), [6, 5, 1, 0, 3, 1]);
    let numbers = ["repeated_corner_faces", "zero_area_faces", "isolated_vertices", "unwelded_places"];
    assert_eq!(numbers.map(|name| told[name].as_u64().unwrap()), [1, 0, 1, 0]);
    assert_eq!((told["has_colours"].as_bool(), told["has_texcoords"].as_bool()), (Some(true), Some(false)));
    let text = stdout(folder, "info %/scan.ply");
    assert!(text.contains("3 non-manifold edges, 1 duplicate faces, 1 faces with a repeated corner"), "{text}");
    assert!(text.contains("1 vertices without a place left out"), "{text}");
}

#[test]
fn extracted_meshes_keep_their_promise_at_every_sample() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "build @ -o %/m.yama");
    let mut last = u64::MAX;
    for tolerance in [1, 5, 20] {
        for source in ["@", "%/m.yama"] {
            let result = json(folder, &format!("extract {source} --tolerance {tolerance} --check -o %/m.glb"));
            let check = &result["check"];
            assert!(check["max_vertical_m"].as_f64().unwrap() <= f64::from(tolerance), "{result}");
            assert_eq!(check["conforming"], true, "{result}");
            assert_eq!(check["samples_measured"], 257 * 257);
            if source == "@" {
                let triangles = result["triangles"].as_u64().unwrap();
                assert!(triangles < last, "a larger tolerance needs fewer triangles");
                last = triangles;
            }
        }
    }
}

#[test]
fn a_mesh_file_holds_what_was_promised() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for name in ["m.glb", "m.ply", "m.obj", "m.stl"] {
        for frame in ["source", "local"] {
            let made = json(folder, &format!("extract @ --tolerance 20 --frame {frame} -o %/{name}"));
            let seen = json(folder, &format!("compare @ %/{name}"));
            assert_eq!(seen["frame"], frame);
            assert_eq!(seen["faces"], made["triangles"]);
            assert_eq!(seen["samples_uncovered"], 0, "{name} {frame}: {seen}");
            assert_eq!(seen["conforming"], true, "{name} {frame}: {seen}");
            // single precision in STL and GLB
            assert!(seen["max_vertical_m"].as_f64().unwrap() <= 20.002, "{name} {frame}: {seen}");
        }
    }
    let meshes = json(folder, "compare %/m.ply %/m.obj --samples 20000");
    assert!(meshes["hausdorff_m"].as_f64().unwrap() < 1e-6, "{meshes}");
    assert!(meshes["rms_m"].is_number() && meshes["a_to_b"]["max_m"].is_number());
}

#[test]
fn a_budget_and_a_view_bound_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let result = json(folder, "extract @ --budget 3000 --check -o %/m.ply");
    let triangles = result["triangles"].as_u64().unwrap();
    assert!((2940..=3000).contains(&triangles), "{result}");
    assert_eq!(result["limited_by"], "budget");
    let left = result["error_left_m"].as_f64().unwrap();
    assert!(result["check"]["max_vertical_m"].as_f64().unwrap() <= left);
    let eye = "--eye 310000,4895000,3000 --target 316000,4904500,1500 --size 800x600";
    let seen = json(folder, &format!("extract @ --tolerance-px 2 {eye} -o %/v.ply"));
    let all = json(folder, &format!("extract @ --tolerance-px 2 {eye} --no-cull -o %/v.ply"));
    assert!(seen["triangles"].as_u64() < all["triangles"].as_u64());
    assert!(seen["error_left_px"].as_f64().unwrap() <= 2.0);
}

#[test]
fn databases_are_lossless_or_within_the_error_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let exact = json(folder, "build @ -o %/exact.yama");
    let rough = json(folder, "build @ -o %/rough.yama --max-error 0.5");
    assert!(rough["bytes"].as_u64().unwrap() < exact["bytes"].as_u64().unwrap() / 2);
    assert!(exact["bytes_per_sample"].is_number() && exact["build_s"].is_number());
    assert_eq!(json(folder, "compare @ %/exact.yama")["max_vertical_m"], 0.0);
    let off = json(folder, "compare @ %/rough.yama");
    let max = off["max_vertical_m"].as_f64().unwrap();
    assert!(max > 0.0 && max <= 0.5, "{off}");
}

#[test]
fn pictures_are_drawn_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let fine = json(folder, "render @ -o %/fine.png --size 320x180 --draw software");
    assert_eq!(fine["drawn_with"], "software");
    assert!(fine["error_left_px"].as_f64().unwrap() <= 0.5);
    stdout(folder, "render @ -o %/few.png --size 320x180 --draw software --budget 300 --wireframe --colour level");
    stdout(folder, "render @ -o %/jpeg.jpg --size 160x90 --draw software --colour plain");
    stdout(folder, "render @ -o %/draped.png --size 160x90 --draw software --image %/few.png");
    let same = json(folder, "compare %/fine.png %/fine.png");
    assert_eq!((same["flip_mean"].as_f64(), same["mean_abs_difference_of_255"].as_f64()), (Some(0.0), Some(0.0)));
    let apart = json(folder, "compare %/fine.png %/few.png");
    assert!(apart["ssim"].as_f64().unwrap() < 0.99 && apart["flip_mean"].as_f64().unwrap() > 0.01, "{apart}");
    assert!(error(folder, "compare %/fine.png %/jpeg.jpg", 1).contains("320x180"));
}

#[test]
fn flights_keep_their_budget_frame_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let flight = json(folder, "fly @ --budget 5000 --frames 40 --no-draw --compare --save-path %/path.json");
    let frames = flight["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 40);
    for frame in frames {
        let triangles = frame["triangles"].as_u64().unwrap();
        assert!((4900..=5000).contains(&triangles), "{frame}");
        for key in ["refined", "coarsened", "update_ms", "upload_bytes", "draw_ms", "error_px"] {
            assert!(frame[key].is_number(), "{key}: {frame}");
        }
    }
    assert!(flight["comparison"]["rebuild_over_differences"].is_number());
    let again = json(folder, "fly @ --budget 5000 --path %/path.json --no-draw");
    let counts = |f: &serde_json::Value| {
        f["frames"].as_array().unwrap().iter().map(|f| f["triangles"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(counts(&flight), counts(&again), "a recorded path is the same flight");
    let paper = json(folder, "fly @ --budget 5000 --lod paper --frames 20 --no-draw --rebuild");
    assert!(paper["frames"][19]["top_threshold_m"].is_number());
    let limited = json(folder, "fly @ --budget 5000 --frames 3 --no-draw --step-limit 50");
    assert_eq!(limited["frames"][0]["limited_by"], "steps");
}

#[test]
fn a_flight_leaves_plots_pictures_and_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let arguments =
        "fly @ --tolerance-px 2 --frames 12 --path orbit --size 160x90 --draw software -o %/out --pictures 3";
    let table = stdout(folder, arguments);
    assert!(table.lines().count() > 12 && table.contains("triangles"), "{table}");
    for name in [
        "flight.json",
        "triangles.png",
        "time.png",
        "frame-00000.png",
        "frame-00005.png",
        "frame-00011.png",
    ] {
        assert!(folder.join("out").join(name).is_file(), "{name}");
    }
    let saved: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("out/flight.json")).unwrap()).unwrap();
    assert_eq!(saved["frames"].as_array().map(Vec::len), Some(12));
    let fast = json(folder, "fly @ --speed 100 --frames 5 --budget 1000 --no-draw");
    assert_eq!(fast["frames"].as_array().map(Vec::len), Some(5));
}

#[test]
fn generated_terrain_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "generate fractal -o %/f.tif --size 65x49 --spacing 0.5 --holes discs:3 --seed 4");
    let info = json(folder, "info %/f.tif");
    assert_eq!((info["width"].as_u64(), info["height"].as_u64()), (Some(65), Some(49)));
    assert_eq!(info["step_x_m"], 0.5);
    assert!(info["no_data_samples"].as_u64().unwrap() > 0);
    let holed = json(folder, "extract %/f.tif --tolerance 5 --check -o %/f.ply");
    assert_eq!(holed["check"]["conforming"], true, "{holed}");
    stdout(folder, "generate cone -o %/c.asc --size 21x17 --relief 80");
    assert_eq!(json(folder, "info %/c.asc")["max_m"], 80.0);
    stdout(folder, "build %/f.tif -o %/f.yama");
    assert_eq!(json(folder, "extract %/f.yama --tolerance 5 --check -o %/f.ply")["check"]["conforming"], true);
}

#[test]
fn a_generated_pagoda_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = stdout(folder, "generate pagoda -o %/p.ply --faces 30000");
    assert!(text.contains("--eye"), "{text}");
    let info = json(folder, "info %/p.ply");
    let faces = info["faces"].as_u64().unwrap();
    assert!(faces.abs_diff(30_000) <= 300, "{info}");
    stdout(folder, "generate pagoda -o %/holed.stl --faces 5000 --holes occluded --noise 0 --seed 3");
}

#[test]
fn help_and_version_succeed() {
    let folder = tempfile::tempdir().unwrap();
    let help = stdout(folder.path(), "--help");
    for command in [
        "demo",
        "info",
        "build",
        "view",
        "fly",
        "render",
        "extract",
        "compare",
        "generate",
        "reproduce",
    ] {
        assert!(help.contains(command), "{command}");
        assert!(stdout(folder.path(), &format!("{command} --help")).contains("Usage"), "{command}");
    }
    assert!(run(folder.path(), "--version").status.success());
}
