//! Small LandXML and CityGML files, and what should hold for every TIN.

// each test file uses some of these
#![allow(dead_code)]

use std::path::Path;
use yamanami_core::Tin;
use yamanami_io::tin_file::{ReadTin, TinReadOptions, read_tin, read_tin_from_bytes, write_tin};

pub(crate) fn read(path: &Path) -> ReadTin {
    read_tin(path, &TinReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

pub(crate) fn parse(text: &str) -> Result<ReadTin, String> {
    read_tin_from_bytes("a.xml", text.as_bytes(), &TinReadOptions::default()).map_err(|e| e.to_string())
}

/// Writes a TIN, reads it, and finds nothing changed.
#[track_caller]
pub(crate) fn comes_back(tin: &Tin, file: &str) {
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

/// A surface of two faces around which the rest of a file is written.
pub(crate) fn landxml(units: &str, before: &str, source: &str, faces: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\">\n<Units>{units}</Units>\n{before}\n\
         <Surfaces><Surface name=\"ground &amp; more\">{source}<Definition surfType=\"TIN\">\n<Pnts>\n\
         <P id=\"7\">0 0 1</P>\n<P id=\"900000\">0 10 2</P>\n<P id=\"3\">10 10 3</P>\n<P id=\"4\">10 0 4</P>\n</Pnts>\n\
         <Faces>\n{faces}\n</Faces></Definition></Surface></Surfaces></LandXML>"
    )
}

pub(crate) const METRES: &str = "<Metric linearUnit=\"meter\"/>";
pub(crate) const FACES: &str = "<F>7 900000 3</F>\n<F n=\"1 0 0\">7 3 4</F>";

/// A city model with this inside of its relief.
pub(crate) fn city_model(srs: &str, relief: &str) -> String {
    format!(
        "<core:CityModel><gml:boundedBy><gml:Envelope srsName=\"{srs}\"/></gml:boundedBy>\n<dem:ReliefFeature>\n\
         {relief}</dem:ReliefFeature></core:CityModel>"
    )
}

pub(crate) fn tin_relief(name: &str, lod: u32, rings: &[&str]) -> String {
    let triangle = |ring: &&str| {
        format!(
            "<gml:Triangle><gml:exterior><gml:LinearRing><gml:posList>{ring}</gml:posList></gml:LinearRing></gml:exterior></gml:Triangle>\n"
        )
    };
    format!(
        "<dem:TINRelief><gml:name>{name}</gml:name><dem:lod>{lod}</dem:lod><dem:tin><gml:TriangulatedSurface>\
         <gml:trianglePatches>\n{}</gml:trianglePatches></gml:TriangulatedSurface></dem:tin></dem:TINRelief>",
        rings.iter().map(triangle).collect::<String>()
    )
}

pub(crate) const ONE: &str = "0 0 1 10 0 2 10 10 3 0 0 1";
pub(crate) const TWO: &str = "0 0 1 10 10 3 0 10 4 0 0 1";
