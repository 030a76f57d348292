//! Breaklines of TIN files, with triangles or without.

use glam::DVec3;
use std::path::PathBuf;
use yamanami_core::{BreaklineKind, FOOT_M};
use yamanami_io::tin_file::{TinReadOptions, read_breaklines, read_tin};

const DXF: &str =
    "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nbreak\n10\n0\n20\n0\n30\n1\n11\n5\n21\n5\n31\n2\n0\nENDSEC\n0\nEOF\n";

const LANDXML: &str = "<?xml version=\"1.0\"?>\n<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\">\
    <Units><Imperial linearUnit=\"foot\"/></Units><Surfaces><Surface name=\"none\"/><Surface name=\"s\"><SourceData>\
    <Breaklines><Breakline brkType=\"nondestructive\" name=\"bank\"><PntList3D>0 10 1 20 30 2</PntList3D></Breakline>\
    </Breaklines></SourceData></Surface></Surfaces></LandXML>";

const CITYGML: &str = "<core:CityModel xmlns:core=\"c\" xmlns:dem=\"d\" xmlns:gml=\"g\"><core:cityObjectMember>\
    <dem:ReliefFeature><dem:reliefComponent><dem:BreaklineRelief><dem:ridgeOrValleyLines><gml:MultiCurve>\
    <gml:curveMember><gml:LineString srsName=\"EPSG:6677\" srsDimension=\"3\"><gml:posList>1000 2000 3 1010 2020 4\
    </gml:posList></gml:LineString></gml:curveMember></gml:MultiCurve></dem:ridgeOrValleyLines></dem:BreaklineRelief>\
    </dem:reliefComponent></dem:ReliefFeature></core:cityObjectMember></core:CityModel>";

fn file(folder: &tempfile::TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn files_of_lines_alone_have_lines_and_no_tin() {
    let folder = tempfile::tempdir().unwrap();
    let options = TinReadOptions::default();
    for (name, text, points, kind) in [
        ("a.dxf", DXF, [DVec3::new(0.0, 0.0, 1.0), DVec3::new(5.0, 5.0, 2.0)], BreaklineKind::Hard),
        ("a.xml", LANDXML, [DVec3::new(10.0, 0.0, 1.0), DVec3::new(30.0, 20.0, 2.0)], BreaklineKind::Soft),
        ("a.gml", CITYGML, [DVec3::new(1000.0, 2000.0, 3.0), DVec3::new(1010.0, 2020.0, 4.0)], BreaklineKind::Hard),
    ] {
        let path = file(&folder, name, text);
        let read = read_breaklines(&path, &options).unwrap();
        let unit_m = if name == "a.xml" { FOOT_M } else { 1.0 };
        let [line] = &read.lines[..] else { panic!("{name}: {read:?}") };
        assert_eq!((&line.points[..], line.kind), (&points.map(|p| p * unit_m)[..], kind), "{name}");
        let error = read_tin(&path, &options).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("1 lines"), "{error}");
    }
}

#[test]
fn a_file_without_lines_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.2dm", "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 0 1 0\nE3T 1 1 2 3 1\n");
    let error = read_breaklines(&path, &TinReadOptions::default()).unwrap_err().to_string();
    assert!(error.ends_with("a.2dm: whole file: expected breaklines, found none, and 1 triangles"), "{error}");
}

#[test]
fn what_lies_beyond_all_surveys_is_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let nodes = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 0 1 0\nND 4 1e13 0 0\nE3T 1 1 2 3 1\nE3T 2 2 4 3 1\n";
    let read = read_tin(file(&folder, "a.2dm", nodes), &TinReadOptions::default()).unwrap();
    assert_eq!((read.tin.mesh.positions.len(), read.tin.mesh.triangles.len()), (3, 1));
    assert!(read.notes.iter().any(|n| n.contains("within 1e12 m dropped: 1, first point 4")), "{:?}", read.notes);
}
