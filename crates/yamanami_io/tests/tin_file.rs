//! TIN files: every LandXML and CityGML file of the shared data set (skipped where it is absent), and any TIN written and
//! read again.

mod tin_xml_samples;

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use robust::{Coord, orient2d};
use std::path::{Path, PathBuf};
use tin_xml_samples::{comes_back, read};
use yamanami_core::{Breakline, BreaklineKind, Crs, FOOT_M, Tin, TriangleMesh, US_SURVEY_FOOT_M};
use yamanami_io::crs;
use yamanami_io::tin_file::{ReadTin, is_tin_name, write_tin};

fn data(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/tin").join(name);
    if !path.exists() {
        println!("skipped: {name} is not here");
        return None;
    }
    Some(path)
}

#[test]
fn landxml_with_hidden_faces() {
    let Some(path) = data("landxml12_total_topp_44094f.xml.gz") else { return };
    let ReadTin { tin, notes, other_surfaces, .. } = read(&path);
    assert_eq!((tin.name.as_str(), tin.unit_m), ("00201-31B Total topp", 1.0));
    assert_eq!((notes, other_surfaces), (Vec::<String>::new(), Vec::new()));
    assert_eq!((tin.mesh.positions.len(), tin.mesh.triangles.len(), tin.hidden.len()), (22_273, 36_093, 8_001));
    // northing comes first in the file
    assert_eq!(tin.mesh.positions[0], DVec3::new(148256.75005782433, 6398905.993796474, 3.243035398846));
    let b = tin.mesh.bounds();
    assert!((b.min.z - 0.80).abs() < 0.01 && (b.max.z - 8.52).abs() < 0.01, "{b:?}");
    assert_eq!((b.max - b.min).truncate().round(), DVec2::new(695.0, 459.0));
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
    assert_eq!(((b.max - b.min) / FOOT_M).truncate().round(), DVec2::new(2258.0, 2297.0));
    assert!((b.min.z / FOOT_M - 570.3).abs() < 0.06 && (b.max.z / FOOT_M - 856.7).abs() < 0.06, "{b:?}");
    assert_eq!(tin.breaklines.len(), 37);
    assert!(tin.breaklines.iter().all(|line| line.kind == BreaklineKind::Boundary && line.name == "texture"));
    comes_back(&tin, "a.xml.gz");
}

#[test]
fn landxml_in_survey_feet() {
    let Some(path) = data("landxml12_bridgeton_topo_3199f.xml") else { return };
    let ReadTin { tin, notes, .. } = read(&path);
    assert_eq!(notes, Vec::<String>::new());
    assert_eq!((tin.mesh.positions.len(), tin.mesh.triangles.len()), (1_657, 3_199));
    assert_eq!(tin.unit_m, US_SURVEY_FOOT_M);
    let b = tin.mesh.bounds();
    assert!((b.min.z / tin.unit_m - 447.4).abs() < 0.06 && (b.max.z / tin.unit_m - 548.9).abs() < 0.06, "{b:?}");
    assert_eq!(tin.mesh.positions[0].y, 1_069_494.216_552_734_4 * US_SURVEY_FOOT_M);
    comes_back(&tin, "a.xml");
}

#[test]
fn citygml_relief() {
    let Some(path) = data("citygml_plateau_yokosuka_dem_52396535.gml") else { return };
    let ReadTin { tin, notes, .. } = read(&path);
    assert_eq!(tin.name, "52396535");
    assert_eq!(tin.mesh.triangles.len(), 1_066);
    assert_eq!(tin.crs, crs::from_epsg(6677).unwrap());
    assert_eq!(notes.len(), 1, "{notes:?}");
    let b = tin.mesh.bounds();
    assert_eq!((b.min.z, b.max.z), (-0.02, 24.199632));
    // the first corner of the file, there and back
    let [lon, lat] = crs::to_lon_lat(&tin.crs, tin.mesh.positions[0].x, tin.mesh.positions[0].y).unwrap();
    assert!((lat - 35.199998634140194).abs() < 1e-11 && (lon - 139.688429791429).abs() < 1e-11, "{lon} {lat}");
    println!("{} vertices", tin.mesh.positions.len());
    comes_back(&tin, "a.xml");
}

/// A triangle of three corners, counter-clockwise from above.
fn upward(positions: &[DVec3], corners: [prop::sample::Index; 3]) -> Option<[u32; 3]> {
    let [a, b, c] = corners.map(|index| index.index(positions.len()) as u32);
    let [pa, pb, pc] = [a, b, c].map(|i| Coord { x: positions[i as usize].x, y: positions[i as usize].y });
    let triangle = if orient2d(pa, pb, pc) < 0.0 { [a, c, b] } else { [a, b, c] };
    (a != b && b != c && c != a).then_some(triangle)
}

/// Numbers as files have them and as they do not.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1e7..1e7f64,
        (-9_999_999i32..9_999_999).prop_map(|n| f64::from(n) / 1000.0),
        Just(-0.0),
        -1e-9..1e-9f64
    ]
}

fn place() -> impl Strategy<Value = DVec3> {
    [number(), number(), number()].prop_map(DVec3::from)
}

fn tin() -> impl Strategy<Value = Tin> {
    let corners = || prop::collection::vec(any::<[prop::sample::Index; 3]>(), 1..30);
    let kind = prop::sample::select(vec![BreaklineKind::Hard, BreaklineKind::Soft, BreaklineKind::Boundary]);
    let name = "[ -~あ-ん]{0,12}|outer|void";
    let lines = prop::collection::vec((name, kind, prop::collection::vec(place(), 2..6)), 0..5);
    let unit = prop::sample::select(vec![1.0, FOOT_M, US_SURVEY_FOOT_M, 0.001, 1000.0]);
    let crs = prop_oneof![
        Just(Crs::default()),
        (6669u32..=6687).prop_map(|epsg| crs::from_epsg(epsg).unwrap()),
        "[A-Z][ -~]{0,9}[a-z]".prop_map(|name| Crs { epsg: Some(2264), name, ..Crs::default() }),
    ];
    (name, prop::collection::vec(place(), 3..40), corners(), corners(), lines, unit, crs).prop_map(
        |(name, positions, shown, hidden, lines, unit_m, crs)| {
            let positions: Vec<DVec3> = positions.into_iter().map(|place| place * unit_m).collect();
            let triangles = shown.into_iter().filter_map(|corners| upward(&positions, corners)).collect();
            let hidden = hidden.into_iter().filter_map(|corners| upward(&positions, corners)).collect();
            let line = |(name, kind, points): (String, BreaklineKind, Vec<DVec3>)| Breakline {
                name,
                kind,
                points: points.into_iter().map(|place| place * unit_m).collect(),
            };
            let breaklines = lines.into_iter().map(line).collect();
            Tin { name, mesh: TriangleMesh::new(positions, triangles), hidden, breaklines, crs, unit_m }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]
    #[test]
    fn any_tin_comes_back(tin in tin()) {
        prop_assume!(!tin.mesh.triangles.is_empty());
        comes_back(&tin, "a.landxml");
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let good = Tin::of_mesh("a", TriangleMesh::new(positions, vec![[0, 1, 2]]));
    let folder = tempfile::tempdir().unwrap();
    let line = |tin: &Tin, file: &str| write_tin(folder.path().join(file), tin).unwrap_err().to_string();
    let mut bad = good.clone();
    bad.hidden.push([0, 1, 3]);
    assert!(line(&bad, "a.xml").ends_with("expected corners below 3, given a triangle with [0, 1, 3]"));
    let bad = Tin { unit_m: f64::NAN, ..good.clone() };
    assert!(line(&bad, "a.xml").ends_with("expected a unit of metres above zero, given NaN"));
    let mut bad = good.clone();
    bad.mesh.positions[1].z = f64::INFINITY;
    assert!(line(&bad, "a.xml").contains("expected finite positions, given vertex 1 at "));
    assert!(line(&Tin::default(), "a.xml").ends_with("expected at least one triangle, given none"));
    assert!(line(&good, "a.doc").contains("'doc' is not a TIN format known here"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn meshes_are_terrain_too() {
    // clockwise in the file
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let upside_down = Tin::of_mesh("ground", TriangleMesh::new(positions, vec![[0, 2, 1]]));
    let folder = tempfile::tempdir().unwrap();
    for file in ["ground.ply", "ground.obj.gz", "ground.stl"] {
        let path = folder.path().join(file);
        write_tin(&path, &upside_down).unwrap();
        let tin = read(&path).tin;
        assert_eq!((tin.name.as_str(), tin.mesh.triangles.len(), tin.unit_m), ("ground", 1, 1.0));
        let [a, b, c] = tin.mesh.corners(0).map(DVec3::truncate);
        assert!((b - a).perp_dot(c - a) > 0.0, "{file}");
    }
    let names = ["a.xml", "a.landxml.gz", "a.gml", "a.PLY.zst", "a.obj", "a.tif", "a"];
    assert_eq!(names.map(|name| is_tin_name(Path::new(name))), [true, true, true, true, true, false, false]);
}
