//! TIN files: every LandXML and CityGML file of the shared data set (skipped where it is absent), small ones for what those
//! do not have, and any TIN written and read again.

use glam::DVec3;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use yamanami_core::{Aabb, Breakline, BreaklineKind, FOOT_M, Tin, TriangleMesh, US_SURVEY_FOOT_M};
use yamanami_io::crs;
use yamanami_io::tin_file::{ReadTin, TinReadOptions, read_tin, read_tin_from_bytes, write_tin};

fn data(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/tin").join(name);
    if !path.exists() {
        println!("skipped: {name} is not here");
        return None;
    }
    Some(path)
}

fn read(path: &Path) -> ReadTin {
    read_tin(path, &TinReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn parse(text: &str) -> Result<ReadTin, String> {
    read_tin_from_bytes("a.xml", text.as_bytes(), &TinReadOptions::default()).map_err(|e| e.to_string())
}

/// Writes a TIN, reads it, and finds nothing changed.
#[track_caller]
fn comes_back(tin: &Tin, file: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    write_tin(&path, tin).unwrap();
    let again = read(&path);
    assert_eq!(again.notes, tin_notes(tin));
    assert!(again.tin.mesh.positions == tin.mesh.positions, "vertices changed");
    assert!(again.tin == *tin, "{:?} {:?} {:?}", again.tin.name, again.tin.crs, again.tin.breaklines);
}

/// What reading a TIN of ours has to say: a CRS that is known by name only.
fn tin_notes(tin: &Tin) -> Vec<String> {
    let unknown = tin.crs.epsg.is_none() && !tin.crs.name.is_empty();
    let note = || format!("line 4: the coordinate system '{}' is not known by formula", tin.crs.name);
    unknown.then(note).into_iter().collect()
}

#[track_caller]
fn check_bounds(bounds: Aabb, min: [f64; 3], max: [f64; 3], within: f64) {
    let near = |a: DVec3, b: [f64; 3]| (a - DVec3::from(b)).abs().max_element() < within;
    assert!(near(bounds.min, min) && near(bounds.max, max), "{bounds:?}");
}

#[test]
fn landxml_with_hidden_faces() {
    let Some(path) = data("landxml12_total_topp_44094f.xml.gz") else { return };
    let ReadTin { tin, notes, other_surfaces, .. } = read(&path);
    assert_eq!((tin.name.as_str(), tin.unit_m), ("00201-31B Total topp", 1.0));
    assert_eq!((notes, other_surfaces), (Vec::<String>::new(), Vec::new()));
    assert_eq!((tin.mesh.positions.len(), tin.mesh.triangles.len(), tin.hidden.len()), (22_273, 36_093, 8_001));
    // northing comes first in the file
    assert_eq!(tin.mesh.positions[0], DVec3::new(148_256.750_057_824_334, 6_398_905.993_796_474_3, 3.243_035_398_846));
    let b = tin.mesh.bounds();
    assert!((b.min.z - 0.80).abs() < 0.9 && (b.max.z - 8.52).abs() < 0.01, "{b:?}");
    let size = b.max - b.min;
    println!("{b:?} {size}");
    comes_back(&tin, "a.xml");
    comes_back(&tin, "a.landxml.zst");
}

#[test]
fn landxml_in_feet() {
    let Some(path) = data("landxml20_olympus_24612f.xml.gz") else { return };
    let ReadTin { tin, notes, .. } = read(&path);
    assert_eq!(notes, Vec::<String>::new());
    assert_eq!((tin.mesh.positions.len(), tin.mesh.triangles.len(), tin.hidden.len()), (12_390, 24_612, 0));
    assert_eq!(tin.unit_m, FOOT_M);
    let b = tin.mesh.bounds();
    let size_ft = (b.max - b.min) / FOOT_M;
    println!("{size_ft} {b:?}");
    assert!((b.min.z / FOOT_M - 570.3).abs() < 0.06 && (b.max.z / FOOT_M - 856.7).abs() < 0.06, "{b:?}");
    assert_eq!(tin.breaklines.len(), 37);
    assert!(tin.breaklines.iter().all(|line| line.kind == BreaklineKind::Boundary && line.name == "texture"));
    comes_back(&tin, "a.xml.gz");
}

#[test]
fn landxml_in_survey_feet() {
    let Some(path) = data("landxml12_bridgeton_topo_3199f.xml") else { return };
    let ReadTin { tin, notes, .. } = read(&path);
    println!("{notes:?}");
    assert_eq!((tin.mesh.positions.len(), tin.mesh.triangles.len()), (1_657, 3_199));
    assert_eq!(tin.unit_m, US_SURVEY_FOOT_M);
    let b = tin.mesh.bounds();
    assert!((b.min.z / tin.unit_m - 447.4).abs() < 0.06 && (b.max.z / tin.unit_m - 548.9).abs() < 0.06, "{b:?}");
    assert_eq!(tin.mesh.positions[0].y, 1_069_494.216_552_734_4 * US_SURVEY_FOOT_M);
    comes_back(&tin, "a.xml");
}
