//! `map` as a user meets it: what it writes, what it promises, and what it says to wrong input.

mod common;

use common::{error, json, run, stdout};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The bundled mountains of New Hampshire, near Mount Washington: a map of 5 km.
const AT: &str = "--at 44.27,-71.30 --radius 5 --ring 1.5 --eye 2500 --spacing 50 --size 400x400";

fn names(folder: &Path) {
    let csv = "name,kana,lat,lon,elevation\n\
               Mount Washington,,44.2706,-71.3033,1917\n\
               Mount Clay,くれいさん,44.2855,-71.3161,1684\n\
               Nowhere,,,,\n\
               富士山,ふじさん,35.36,138.73,3776\n";
    fs::write(folder.join("names.csv"), csv).unwrap();
}

#[test]
fn a_map_keeps_its_promise_and_tells_where_every_name_is() {
    let folder = TempDir::new().unwrap();
    names(folder.path());
    let told = json(folder.path(), &format!("map @ {AT} --places %/names.csv --check -o %/m.png"));
    let bound = told["error_bound_px"].as_f64().unwrap();
    assert!(bound <= 1.0, "no coarser than asked");
    assert!(told["measured"]["max_px"].as_f64().unwrap() <= bound + 1e-4, "what is measured is within the bound");
    assert!(told["triangles"].as_u64() < told["full_triangles"].as_u64());
    let of = |name: &str| told["names"].as_array().unwrap().iter().find(|n| n["name"] == name).cloned();
    let summit = of("Mount Washington").unwrap();
    assert_eq!(summit["outcome"], "shown");
    assert!(summit["ground_error_px"].as_f64().unwrap() <= bound + 1e-4);
    assert!(summit["distance_m"].as_f64().unwrap() < 500.0);
    assert_eq!(of("富士山").unwrap()["outcome"], "beyond_rim");
    let picture = image::open(folder.path().join("m.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (400, 400));
}

#[test]
fn vectors_have_live_text_and_pages_are_pages() {
    let folder = TempDir::new().unwrap();
    names(folder.path());
    stdout(folder.path(), &format!("map @ {AT} --places %/names.csv -o %/m.svg"));
    let svg = fs::read_to_string(folder.path().join("m.svg")).unwrap();
    assert!(svg.contains("<text") && svg.contains("Mount Washington"));
    stdout(folder.path(), &format!("map @ {AT} --places %/names.csv -o %/m.pdf"));
    assert!(fs::read(folder.path().join("m.pdf")).unwrap().starts_with(b"%PDF"));
}

#[test]
fn every_mesh_draws_the_same_place() {
    let folder = TempDir::new().unwrap();
    for lod in ["exact", "full"] {
        stdout(folder.path(), &format!("map @ {AT} --bare --lod {lod} -o %/{lod}.png"));
    }
    let picture = |lod: &str| image::open(folder.path().join(format!("{lod}.png"))).unwrap().into_rgb8();
    let (exact, full) = (picture("exact"), picture("full"));
    let off: u64 = exact.iter().zip(full.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    assert!((off as f64) < 2.0 * exact.len() as f64, "less than two of 255 in the mean");
    let budget = json(folder.path(), &format!("map @ {AT} --bare --budget 600 -o %/b.png"));
    assert!(budget["triangles"].as_u64().unwrap() <= 600);
}

#[test]
fn what_cannot_be_is_refused_in_one_line() {
    let folder = TempDir::new().unwrap();
    let place = "--at 44.27,-71.30 --radius 5 --spacing 50 -o %/m.png";
    let refused = |more: &str, code: i32| error(folder.path(), &format!("map @ {more}"), code);
    let said = refused(&format!("{place} --alpha 1.5"), 2);
    assert!(said.contains("alpha: expected 0 to 1, got 1.5"), "{said}");
    let said = refused(&format!("{place} --ring 0"), 2);
    assert!(said.contains("ring radius: expected above 0 m, got 0"), "{said}");
    let said = refused(&format!("{place} --ring 1 --eye 1200"), 1);
    assert!(said.contains("eye height: expected above all ground near the ring, got 1200 m"), "{said}");
    let said = refused("--at 35.36,138.73 -o %/m.png", 1);
    assert!(said.contains("centre") && said.contains("35.36") && said.contains("138.73"), "{said}");
    fs::write(folder.path().join("bad.csv"), "name,height\nA,1\n").unwrap();
    let said = refused(&format!("{place} --places %/bad.csv"), 1);
    assert!(said.contains("bad.csv"), "{said}");
    image::RgbImage::new(8, 8).save(folder.path().join("photo.png")).unwrap();
    let said = refused(&format!("{place} --ring 1.5 --eye 2500 --image %/photo.png"), 1);
    assert!(said.contains("photo.png: expected a place on Earth"), "{said}");
    assert!(!folder.path().join("m.png").exists(), "nothing is left behind");
}

#[test]
fn part_of_the_data_and_letters_without_glyphs_are_told() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("odd.csv"), "name,lat,lon\nᚠᚢᚦ,44.2706,-71.3033\n").unwrap();
    let wide = "--at 44.27,-71.30 --radius 20 --ring 3 --eye 2500 --spacing 100 --size 300x300 --no-data blank";
    let output = run(folder.path(), &format!("map @ {wide} --places %/odd.csv -o %/m.png"));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    assert!(stderr.contains("the data cover") && stderr.contains("only that is drawn"), "{stderr}");
    assert!(stderr.contains('ᚠ'), "the letter is named: {stderr}");
    let picture = image::open(folder.path().join("m.png")).unwrap();
    assert_eq!(picture.width(), 300);
}
