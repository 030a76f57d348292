//! Writes a TIN as a surface of LandXML 1.2: all vertices, shown and hidden faces, breaklines, unit and CRS.
//!
//! Based on: LandXML.org, "LandXML 1.2 schema", 2008.

use super::landxml_words::unit_of;
use super::number::in_unit;
use glam::DVec3;
use quick_xml::escape::escape;
use std::borrow::Cow;
use std::io::{Result, Write};
use yamanami_core::{BreaklineKind, Tin};

/// Writes a TIN that was checked.
pub(super) fn write(out: &mut dyn Write, tin: &Tin) -> Result<()> {
    // the schema asks for a date; the same TIN gives the same bytes, so no clock is read
    let name_space = "http://www.landxml.org/schema/LandXML-1.2";
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(
        out,
        "<LandXML xmlns=\"{name_space}\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
         xsi:schemaLocation=\"{name_space} {name_space}/LandXML-1.2.xsd\" date=\"2000-01-01\" time=\"00:00:00\" \
         version=\"1.2\" language=\"English\" readOnly=\"false\">"
    )?;
    let (system, linear, unit_m) = unit_of(tin.unit_m);
    let others = match system {
        "Imperial" => [("squareFoot", "areaUnit"), ("cubicFeet", "volumeUnit"), ("fahrenheit", "temperatureUnit")],
        _ => [("squareMeter", "areaUnit"), ("cubicMeter", "volumeUnit"), ("celsius", "temperatureUnit")],
    };
    write!(out, "<Units><{system} linearUnit=\"{linear}\"")?;
    for (unit, attribute) in others {
        write!(out, " {attribute}=\"{unit}\"")?;
    }
    let pressure = if system == "Imperial" { "inchHG" } else { "milliBars" };
    writeln!(out, " pressureUnit=\"{pressure}\"/></Units>")?;
    write_crs(out, tin)?;
    let name = attribute(&tin.name);
    writeln!(out, "<Project name=\"{name}\"/>")?;
    writeln!(out, "<Application name=\"yamanami\"/>")?;
    writeln!(out, "<Surfaces>\n<Surface name=\"{name}\">")?;
    write_lines(out, tin, unit_m)?;
    writeln!(out, "<Definition surfType=\"TIN\">\n<Pnts>")?;
    for (i, place) in tin.mesh.positions.iter().enumerate() {
        write!(out, "<P id=\"{}\">", i + 1)?;
        write_place(out, *place, unit_m)?;
        writeln!(out, "</P>")?;
    }
    writeln!(out, "</Pnts>\n<Faces>")?;
    for [a, b, c] in tin.mesh.triangles.iter().map(ids) {
        writeln!(out, "<F>{a} {b} {c}</F>")?;
    }
    for [a, b, c] in tin.hidden.iter().map(ids) {
        writeln!(out, "<F i=\"1\">{a} {b} {c}</F>")?;
    }
    writeln!(out, "</Faces>\n</Definition>\n</Surface>\n</Surfaces>\n</LandXML>")
}

fn ids(triangle: &[u32; 3]) -> [u64; 3] {
    triangle.map(|i| u64::from(i) + 1)
}

fn write_crs(out: &mut dyn Write, tin: &Tin) -> Result<()> {
    if tin.crs.epsg.is_none() && tin.crs.name.is_empty() {
        return Ok(());
    }
    write!(out, "<CoordinateSystem name=\"{}\"", attribute(&tin.crs.name))?;
    if let Some(epsg) = tin.crs.epsg {
        write!(out, " epsgCode=\"{epsg}\"")?;
    }
    writeln!(out, "/>")
}

/// The lines in their order: a group of boundaries or of breaklines ends where the other begins.
fn write_lines(out: &mut dyn Write, tin: &Tin, unit_m: f64) -> Result<()> {
    if tin.breaklines.is_empty() {
        return Ok(());
    }
    writeln!(out, "<SourceData>")?;
    for group in tin.breaklines.chunk_by(|a, b| is_boundary(a.kind) == is_boundary(b.kind)) {
        let boundaries = is_boundary(group[0].kind);
        writeln!(out, "{}", if boundaries { "<Boundaries>" } else { "<Breaklines>" })?;
        for line in group {
            let name = attribute(&line.name);
            match line.kind {
                BreaklineKind::Hard => write!(out, "<Breakline brkType=\"standard\" name=\"{name}\">")?,
                BreaklineKind::Soft => write!(out, "<Breakline brkType=\"nondestructive\" name=\"{name}\">")?,
                BreaklineKind::Boundary => match line.name.as_str() {
                    "outer" | "void" | "island" => write!(out, "<Boundary bndType=\"{name}\" edgeTrim=\"false\">")?,
                    // an island cuts nothing away
                    _ => write!(out, "<Boundary bndType=\"island\" edgeTrim=\"false\" name=\"{name}\">")?,
                },
            }
            write!(out, "<PntList3D>")?;
            for (i, place) in line.points.iter().enumerate() {
                write!(out, "{}", if i == 0 { "" } else { " " })?;
                write_place(out, *place, unit_m)?;
            }
            writeln!(out, "</PntList3D>{}", if boundaries { "</Boundary>" } else { "</Breakline>" })?;
        }
        writeln!(out, "{}", if boundaries { "</Boundaries>" } else { "</Breaklines>" })?;
    }
    writeln!(out, "</SourceData>")
}

fn is_boundary(kind: BreaklineKind) -> bool {
    kind == BreaklineKind::Boundary
}

/// Northing, easting, height.
fn write_place(out: &mut dyn Write, place: DVec3, unit_m: f64) -> Result<()> {
    let [northing, easting, height] = [place.y, place.x, place.z].map(|metres| in_unit(metres, unit_m));
    write!(out, "{northing} {easting} {height}")
}

/// A name as the value of an attribute: one line, without what XML cannot hold.
fn attribute(name: &str) -> String {
    let clean = |c: char| if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { ' ' } else { c };
    let clean: String = name.chars().map(clean).collect();
    match escape(&clean) {
        Cow::Borrowed(same) => same.to_owned(),
        Cow::Owned(escaped) => escaped,
    }
}
