//! Writing a DXF of release 12, which every CAD program reads: a `3DFACE` a triangle, hidden ones on a layer of their own
//! that is frozen, lines as polylines in space.
//!
//! Based on: Autodesk, "DXF reference", 2018.

use super::layers::{FACES, HIDDEN, LINES};
use super::{APPLICATION, TITLE, units};
use crate::tin_file::number::in_unit;
use glam::DVec3;
use std::io::{Result, Write};
use yamanami_core::{Breakline, Tin};

/// Longest text of extended data, bytes.
const TEXT_LIMIT: usize = 255;

/// Colours (of AutoCAD's index) and the flag of frozen layers.
const GREEN: u8 = 3;
const GREY: u8 = 8;
const RED: u8 = 1;
const FROZEN: u8 = 1;

/// Writes a TIN. One whose unit no drawing can state is written in metres.
pub(in crate::tin_file) fn write(mut out: &mut dyn Write, tin: &Tin) -> Result<()> {
    let (unit_m, unit) = match units::number(tin.unit_m) {
        Some(number) => (tin.unit_m, number),
        None => (1.0, units::METRE),
    };
    write!(out, "999\nwritten by yamanami, x east, y north, z up\n")?;
    if !tin.name.is_empty() {
        write!(out, "999\n{TITLE}{}\n", escaped(&tin.name))?;
    }
    let bounds = tin.mesh.bounds();
    write!(out, "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n{unit}\n")?;
    for (variable, corner) in [("$EXTMIN", bounds.min), ("$EXTMAX", bounds.max)] {
        write!(out, "9\n{variable}\n")?;
        point(&mut out, 0, corner, unit_m)?;
    }
    write!(out, "0\nENDSEC\n")?;
    tables(&mut out)?;
    write!(out, "0\nSECTION\n2\nENTITIES\n")?;
    for (layer, triangles) in [(FACES, &tin.mesh.triangles), (HIDDEN, &tin.hidden)] {
        for corners in triangles {
            let [a, b, c] = corners.map(|i| tin.mesh.positions[i as usize]);
            write!(out, "0\n3DFACE\n8\n{layer}\n")?;
            // three corners are four, the last of them twice
            for (number, corner) in [a, b, c, c].into_iter().enumerate() {
                point(&mut out, number, corner, unit_m)?;
            }
        }
    }
    for line in &tin.breaklines {
        polyline(&mut out, line, unit_m)?;
    }
    write!(out, "0\nENDSEC\n0\nEOF\n")
}

fn tables(out: &mut impl Write) -> Result<()> {
    write!(out, "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLTYPE\n70\n1\n")?;
    write!(out, "0\nLTYPE\n2\nCONTINUOUS\n70\n0\n3\nSolid line\n72\n65\n73\n0\n40\n0\n0\nENDTAB\n")?;
    let faces = [(FACES, 0, GREEN), (HIDDEN, FROZEN, GREY)];
    let layers = faces.into_iter().chain(LINES.map(|(_, name)| (name, 0, RED)));
    write!(out, "0\nTABLE\n2\nLAYER\n70\n{}\n", faces.len() + LINES.len())?;
    for (name, flags, colour) in layers {
        write!(out, "0\nLAYER\n2\n{name}\n70\n{flags}\n62\n{colour}\n6\nCONTINUOUS\n")?;
    }
    write!(out, "0\nENDTAB\n0\nTABLE\n2\nAPPID\n70\n1\n0\nAPPID\n2\n{APPLICATION}\n70\n0\n0\nENDTAB\n0\nENDSEC\n")
}

fn polyline(out: &mut impl Write, line: &Breakline, unit_m: f64) -> Result<()> {
    let layer = LINES.iter().find(|(kind, _)| *kind == line.kind).map_or("0", |(_, layer)| layer);
    // 66: vertices follow; 70: in space
    write!(out, "0\nPOLYLINE\n8\n{layer}\n66\n1\n70\n8\n10\n0\n20\n0\n30\n0\n")?;
    if !line.name.is_empty() {
        write!(out, "1001\n{APPLICATION}\n1000\n{}\n", escaped(&line.name))?;
    }
    for &p in &line.points {
        write!(out, "0\nVERTEX\n8\n{layer}\n")?;
        point(out, 0, p, unit_m)?;
        write!(out, "70\n32\n")?;
    }
    write!(out, "0\nSEQEND\n8\n{layer}\n")
}

fn point(out: &mut impl Write, number: usize, p: DVec3, unit_m: f64) -> Result<()> {
    let [x, y, z] = p.to_array().map(|metres| in_unit(metres, unit_m));
    write!(out, "{}\n{x}\n{}\n{y}\n{}\n{z}\n", 10 + number, 20 + number, 30 + number)
}

/// Text of one line in ASCII, other characters escaped.
fn escaped(text: &str) -> String {
    let mut plain = String::new();
    for c in text.chars() {
        let start = plain.len();
        match c {
            ' '..='~' => plain.push(c),
            _ if c.is_control() => plain.push(' '),
            '\u{80}'..='\u{ffff}' => plain.push_str(&format!("\\U+{:04X}", u32::from(c))),
            // the escape has four digits
            _ => plain.push('?'),
        }
        if plain.len() > TEXT_LIMIT {
            plain.truncate(start);
            break;
        }
    }
    plain
}
