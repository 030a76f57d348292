//! Wavelets, remeshing and progressive models, as a user would go.

mod common;

use common::{error, json, stdout};

#[test]
fn a_ball_under_all_wavelets() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "generate carved-ball -o %/ball.ply");
    let study = json(folder, "wavelet %/ball.ply -o %/plots");
    assert_eq!((study["base_faces"].as_u64(), study["levels"].as_u64()), (Some(8), Some(4)));
    let rows = study["wavelets"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().filter_map(|row| row["wavelet"].as_str()).collect();
    assert_eq!(names, ["lazy", "kdisk:0", "kdisk:1", "kdisk:2", "kdisk:3", "kdisk:4", "orthogonal"]);
    for row in rows {
        assert!(row["reconstruction_share_of_diagonal"].as_f64().unwrap() < 1e-14, "{row}");
    }
    // formula (13), and the least-squares limit
    assert_eq!(rows[3]["non_zeros"]["coarse_rows"]["most_frequent"], 72.0);
    assert_eq!(rows[3]["non_zeros"]["new_rows"]["most_frequent"], 89.0);
    let l2 = |row: usize| rows[row]["levels"][2]["l2_m"].as_f64().unwrap();
    assert!(l2(6) <= l2(3) && l2(3) < l2(0), "{} {} {}", l2(6), l2(3), l2(0));
    let kept = &rows[3]["kept"][1];
    assert!(kept["surface_rms_m"].as_f64().unwrap() <= kept["surface_hausdorff_m"].as_f64().unwrap(), "{kept}");
    assert!(kept["closed_vertices"].as_u64() >= kept["vertices"].as_u64(), "{kept}");
    assert_eq!(std::fs::read_dir(folder.join("plots")).unwrap().count(), 5);
    assert!(stdout(folder, "wavelet %/ball.ply --wavelets kdisk:2 --thresholds 0.1,0.2").contains("2.000e-1 m"));
}

#[test]
fn heights_under_wavelets() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), "generate fractal -o %/dem.tif --size 65x129");
    let study = json(folder.path(), "wavelet %/dem.tif --wavelets lazy,kdisk:2,orthogonal");
    assert_eq!((study["base_faces"].as_u64(), study["levels"].as_u64()), (Some(4), Some(6)));
    let share = |row: usize| study["wavelets"][row]["kept"][1]["l2_m"].as_f64().unwrap();
    assert!(share(1) < 0.9 * share(0) && share(1) < 1.01 * share(2), "{} {} {}", share(0), share(1), share(2));
}

#[test]
fn a_scan_is_remeshed_and_its_levels_are_found_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "generate ball -o %/ball.ply --splits 5");
    stdout(folder, "reduce %/ball.ply --faces 3000 -o %/scan.ply");
    let remeshed = json(folder, "remesh %/scan.ply -o %/regular.ply --base-faces 60");
    assert!(remeshed["rms_share_of_diagonal"].as_f64().unwrap() < 2e-3, "{remeshed}");
    assert_eq!(remeshed["source"], remeshed["result"], "parts, borders and handles");
    let study = json(folder, "wavelet %/regular.ply --wavelets kdisk:1");
    assert_eq!((&study["levels"], &study["base_faces"]), (&remeshed["levels"], &remeshed["base_faces"]));
    assert!(json(folder, "wavelet %/scan.ply --remesh --wavelets lazy")["levels"].as_u64().unwrap() > 1);
}

#[test]
fn any_beginning_of_a_progressive_model_is_a_coarser_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "generate carved-ball -o %/ball.ply --splits 5");
    let built = json(folder, "build %/ball.ply --progressive -o %/ball.yama");
    assert_eq!(built["levels"], 5);
    let bytes = built["bytes"].as_u64().unwrap();
    let told = json(folder, "info %/ball.yama");
    assert_eq!((told["kind"].as_str(), told["bytes"].as_u64()), (Some("progressive"), Some(bytes)));
    let mut last = f64::INFINITY;
    for some in [bytes / 16, bytes / 4, bytes] {
        stdout(folder, &format!("extract %/ball.yama --bytes {some} -o %/part.ply"));
        let rms = json(folder, "compare %/ball.ply %/part.ply --samples 20000")["rms_m"].as_f64().unwrap();
        assert!(rms < last, "{some} bytes: {rms} after {last}");
        last = rms;
    }
    assert!(last < 1e-4 * 20.0, "{last}");
    // shown and cut to size like any model
    let front = json(folder, "extract %/ball.yama --budget 2000 --check -o %/front.ply");
    assert!(front["triangles"].as_u64().unwrap() <= 2000, "{front}");
    assert_eq!(
        json(folder, "fly %/ball.yama --budget 1500 --frames 5 --no-draw")["frames"].as_array().unwrap().len(),
        5
    );
    stdout(folder, "render %/ball.yama -o %/ball.png --size 160x120 --draw software");
    let finer = json(folder, "build %/ball.ply --progressive --max-error 0.00002 -o %/finer.yama");
    assert!(finer["max_error_m"].as_f64().unwrap() <= 2e-5 && finer["bytes"].as_u64().unwrap() > bytes, "{finer}");

    // a file cut short: what is there; within its head: one line
    let whole = std::fs::read(folder.join("ball.yama")).unwrap();
    std::fs::write(folder.join("cut.yama"), &whole[..whole.len() / 3]).unwrap();
    let told = json(folder, "info %/cut.yama");
    assert_eq!((told["bytes"].as_u64(), told["bytes_of"].as_u64()), (Some(bytes / 3), Some(bytes)));
    std::fs::write(folder.join("head.yama"), &whole[..20]).unwrap();
    assert!(error(folder, "info %/head.yama", 1).contains("head.yama"));
}

#[test]
fn what_has_no_levels_or_is_no_surface_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write("plain.off", "OFF\n5 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 2 1\n3 0 1 2\n3 0 2 3\n3 1 4 2\n");
    let line = error(folder, "wavelet %/plain.off", 1);
    assert!(line.contains("no subdivision connectivity") && line.contains("--remesh"), "{line}");
    write("fins.off", "OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 -1 0\n3 0 1 2\n3 0 1 3\n3 0 1 4\n");
    for command in [
        "wavelet %/fins.off",
        "remesh %/fins.off -o %/a.ply",
        "build %/fins.off --progressive -o %/a.yama",
    ] {
        let line = error(folder, command, 1);
        assert!(line.contains("fins.off") && line.contains("meet at the edge"), "{line}");
    }
    assert!(error(folder, "wavelet %/absent.ply", 1).contains("absent.ply"));
    assert!(error(folder, "extract %/plain.off --bytes 9 -o %/a.ply", 1).contains("progressive"));
    for wrong in ["kdisk:9", "kdisk:-1", "haar"] {
        let output = common::run(folder, &format!("wavelet %/plain.off --wavelets {wrong}"));
        assert_eq!(output.status.code(), Some(2), "{wrong}");
    }
    // a lone triangle, split: the least base mesh
    write("one.off", "OFF\n6 4 0\n0 0 0\n2 0 0\n0 2 0\n1 0 0.5\n1 1 0\n0 1 0\n3 0 3 5\n3 3 1 4\n3 5 4 2\n3 3 4 5\n");
    let study = json(folder, "wavelet %/one.off");
    assert_eq!((study["base_faces"].as_u64(), study["levels"].as_u64()), (Some(1), Some(1)));
    let built = json(folder, "build %/one.off --progressive -o %/one.yama");
    assert_eq!(built["finest_faces"], 4);
    assert!(json(folder, "info %/one.yama")["faces"].as_u64() == Some(4));
}
