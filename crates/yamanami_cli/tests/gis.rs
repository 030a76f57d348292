//! Heights, sections, volumes and water from the command line, on the full surface.

mod common;

use common::{error, json, stdout};

#[test]
fn heights_come_for_points_and_for_tables() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let points = json(folder, "heights @ --at 316000,4904000 --at 0,0");
    assert!((points[0]["height_m"].as_f64().unwrap() - 1748.358).abs() < 1e-3);
    assert!((points[0]["slope_deg"].as_f64().unwrap() - 18.80).abs() < 0.01);
    assert!((points[0]["aspect_deg"].as_f64().unwrap() - 198.03).abs() < 0.01);
    assert!(points[1]["height_m"].is_null() && points[1]["aspect_deg"].is_null());
    assert!(
        stdout(folder, "heights @ --at 316000,4904000").contains("1748.358 m, slope 18.80°, falls to 198.0° (south)")
    );

    std::fs::write(folder.join("p.csv"), "id;Y;X\na;4904000;316000\nb;1;2\n").unwrap();
    let table = "id;Y;X;height_m;slope_deg;aspect_deg\na;4904000;316000;1748.3584;18.800;198.03\nb;1;2;;;\n";
    assert_eq!(stdout(folder, "heights @ --points %/p.csv"), table);
    let done = json(folder, "heights @ --points %/p.csv -o %/o.csv");
    assert_eq!((done["points"].as_u64(), done["points_outside"].as_u64()), (Some(2), Some(1)));
    assert_eq!(std::fs::read_to_string(folder.join("o.csv")).unwrap(), table);

    // the mesh of every sample stands where the grid does
    stdout(folder, "extract @ --tolerance 0 -o %/m.ply");
    let mesh = json(folder, "heights %/m.ply --at 316012.5,4904003");
    let grid = json(folder, "heights @ --at 316012.5,4904003");
    assert!((mesh[0]["height_m"].as_f64().unwrap() - grid[0]["height_m"].as_f64().unwrap()).abs() < 1e-6);

    std::fs::write(folder.join("bad.csv"), "x,y\n1,2\n3\n").unwrap();
    assert!(error(folder, "heights @ --points %/bad.csv", 1).contains("line 3: expected numbers"));
    assert!(error(folder, "heights @ --points %/p.csv -o %/p.csv", 1).contains("is an input"));
}

#[test]
fn a_profile_is_a_table_and_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let line = r#"{"type": "LineString", "coordinates": [[311000, 4900000], [318000, 4905000], [321000, 4900500]]}"#;
    std::fs::write(folder.join("l.geojson"), line).unwrap();
    let told = json(folder, "profile @ --line-file %/l.geojson -o %/p.csv -o %/p.png");
    let number = |name: &str| told[name].as_f64().unwrap();
    assert!((number("length_m") - 14_010.7).abs() < 0.1 && (number("covered_m") - number("length_m")).abs() < 1e-3);
    assert!(number("ground_m") > number("length_m") && number("mean_slope_deg") > 5.0);
    assert!(told.get("runs").is_none());
    let table = std::fs::read_to_string(folder.join("p.csv")).unwrap();
    assert_eq!(table.lines().count() as u64, told["vertices"].as_u64().unwrap() + 1);
    assert!(table.starts_with("run,distance_m,x,y,z_m\n1,0.0000,311000.0000,4900000.0000,1226.0890\n"), "{table:.90}");
    assert_eq!(image::open(folder.join("p.png")).unwrap().width(), 1600);
    // beyond the border the section ends
    let short = json(folder, "profile @ --line 300000,4900000;310000,4900000");
    assert!((short["covered_m"].as_f64().unwrap() - 250.0).abs() < 1e-6);
    assert_eq!(short["runs"].as_array().map(Vec::len), Some(1));
    assert!(error(folder, "profile @ --line 1,2;3,4", 1).contains("lies nowhere"));
    assert!(error(folder, "profile @ --line-file %/p.csv -o %/p.gif", 1).contains("unknown ending"));
}

#[test]
fn volumes_and_water_are_those_of_the_full_surface() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    stdout(folder, "extract @ --tolerance 30 -o %/a.ply");
    stdout(folder, "extract @ --tolerance 60 -o %/b.ply");
    let same = json(folder, "volume %/a.ply %/a.ply");
    assert_eq!((same["cut_m3"].as_f64(), same["fill_m3"].as_f64()), (Some(0.0), Some(0.0)));
    assert!((same["overlap_m2"].as_f64().unwrap() - 12_800.0 * 12_800.0).abs() < 1.0);
    let coarse = json(folder, "volume %/a.ply %/b.ply");
    let net = coarse["fill_m3"].as_f64().unwrap() - coarse["cut_m3"].as_f64().unwrap();
    assert!((coarse["net_m3"].as_f64().unwrap() - net).abs() < 1e-3 && net != 0.0);

    // the judge agrees with the volumes, and with itself
    let judged = json(folder, "compare %/a.ply %/b.ply --samples 1000");
    let mean = judged["mean_signed_vertical_m"].as_f64().unwrap();
    assert!((mean - net / (12_800.0 * 12_800.0)).abs() < 1e-9);
    assert!(judged["max_vertical_m"].as_f64().unwrap() >= 30.0);
    let equal = json(folder, "compare %/a.ply %/a.ply --samples 1000");
    assert_eq!((equal["max_vertical_m"].as_f64(), equal["rms_vertical_m"].as_f64()), (Some(0.0), Some(0.0)));

    let lake = json(folder, "volume @ --level 620");
    assert!((lake["area_m2"].as_f64().unwrap() - 12_909_080.777).abs() < 0.01, "{lake}");
    assert!((lake["greatest_depth_m"].as_f64().unwrap() - 198.077).abs() < 0.001);
    let valley = json(folder, "volume @ --level 620 --seed 322250,4908600");
    assert!(valley["volume_m3"].as_f64().unwrap() < lake["volume_m3"].as_f64().unwrap());
    assert!(valley["area_m2"].as_f64().unwrap() > 0.0 && valley["reaches_border"] == true);
    assert!(error(folder, "volume @ --level 620 --seed 0,0", 1).contains("lies outside"));
    assert!(error(folder, "volume @ %/absent.ply", 1).contains("absent.ply"));
}

#[test]
fn slopes_aspects_and_water_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut seen = std::collections::HashSet::new();
    for look in ["", "--colour slope", "--colour aspect", "--water 900"] {
        stdout(folder, &format!("render @ -o %/p.png --size 160x100 --draw software {look}"));
        assert!(seen.insert(image::open(folder.join("p.png")).unwrap().into_rgb8().into_raw()), "{look}");
    }
}
