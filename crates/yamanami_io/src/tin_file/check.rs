//! What holds for every TIN that is read or written: finite positions, indices in range, triangles of three different
//! corners, counter-clockwise from above, lines of two points or more.

use super::upward::plan_area;
use super::{Notes, ReadTin, TinReadOptions};
use crate::{IoError, crs};
use glam::DVec3;
use std::path::Path;
use yamanami_core::{Crs, Tin};

/// Farthest that anything lies from zero along an axis, metres: there a double is a tenth of a millimetre wide.
const FARTHEST_M: f64 = 1e12;

/// Whether a place can be one of a survey.
fn is_place(p: DVec3) -> bool {
    p.abs().cmple(DVec3::splat(FARTHEST_M)).all()
}

/// Whether a number can be metres in a unit.
pub(super) fn is_unit(unit_m: f64) -> bool {
    unit_m.is_finite() && unit_m > 0.0
}

/// The options that no file could obey.
pub(super) fn options(options: &TinReadOptions) -> Result<(), IoError> {
    match options.unit_m {
        Some(unit_m) if !is_unit(unit_m) => Err(IoError::BadRequest {
            what: "unit of the coordinates".into(),
            expected: "metres above zero".into(),
            given: unit_m.to_string(),
        }),
        _ => Ok(()),
    }
}

/// The CRS of a code, known by formula or not.
pub(super) fn crs_of_epsg(epsg: u32) -> Crs {
    crs::from_epsg(epsg).unwrap_or_else(|| Crs { epsg: Some(epsg), name: format!("EPSG:{epsg}"), ..Crs::default() })
}

/// The CRS that is asked for, unknown if none is.
pub(super) fn crs(options: &TinReadOptions) -> Crs {
    options.epsg.map(crs_of_epsg).unwrap_or_default()
}

/// Checks a TIN that was read, so that nothing after it needs to: drops what cannot be used, turns triangles upwards.
pub(super) fn readable(mut tin: Tin, mut notes: Notes) -> ReadTin {
    drop_lost_vertices(&mut tin, &mut notes);
    let vertices = tin.mesh.positions.len();
    let keep = |t: &[u32; 3], number: usize, notes: &mut Notes| {
        let [a, b, c] = *t;
        let in_range = t.iter().all(|&i| (i as usize) < vertices);
        let differ = a != b && b != c && c != a;
        if !in_range {
            notes.count("triangles with a corner that has no place dropped", format_args!("triangle {number}"));
        } else if !differ {
            notes.count("triangles with two equal corners dropped", format_args!("triangle {number}"));
        }
        in_range && differ
    };
    let kept: Vec<bool> = tin.mesh.triangles.iter().enumerate().map(|(i, t)| keep(t, i + 1, &mut notes)).collect();
    if kept.contains(&false) {
        retain(&mut tin.mesh.triangles, &kept);
        retain(&mut tin.mesh.material_of, &kept);
    }
    let mut number = 0;
    tin.hidden.retain(|t| {
        number += 1;
        keep(t, number, &mut notes)
    });
    for line in &mut tin.breaklines {
        line.points.retain(|&p| is_place(p));
    }
    let lines = tin.breaklines.len();
    tin.breaklines.retain(|line| line.points.len() >= 2);
    if tin.breaklines.len() < lines {
        notes.say(format!("{} lines of fewer than two points dropped", lines - tin.breaklines.len()));
    }
    let turned = turn_up(&tin.mesh.positions, &mut tin.mesh.triangles) + turn_up(&tin.mesh.positions, &mut tin.hidden);
    if turned > 0 && turned < tin.mesh.triangles.len() + tin.hidden.len() {
        notes.say(format!("{turned} triangles that faced down turned up"));
    }
    let lack = tin.mesh.triangles.is_empty().then(|| {
        let found = format!("{vertices} points and none that is shown");
        ["triangles".to_owned(), "at least one".to_owned(), found]
    });
    ReadTin { tin, notes: notes.into_lines(), other_surfaces: Vec::new(), lack }
}

fn retain<T>(values: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    values.retain(|_| kept.next() != Some(&false));
}

/// Leaves out vertices that are nowhere; triangles that use them get corners out of range.
fn drop_lost_vertices(tin: &mut Tin, notes: &mut Notes) {
    let positions = &mut tin.mesh.positions;
    let Some(first) = positions.iter().position(|&p| !is_place(p)) else { return };
    let mut next = 0;
    let number_of: Vec<u32> = positions
        .iter()
        .map(|p| {
            let number = if is_place(*p) { next } else { u32::MAX };
            next += u32::from(is_place(*p));
            number
        })
        .collect();
    notes.say(format!(
        "points without a place within {FARTHEST_M:e} m dropped: {}, first point {}",
        positions.len() - next as usize,
        first + 1
    ));
    positions.retain(|&p| is_place(p));
    for i in tin.mesh.triangles.iter_mut().chain(&mut tin.hidden).flatten() {
        *i = number_of.get(*i as usize).copied().unwrap_or(u32::MAX);
    }
}

/// Turns triangles that are clockwise from above; how many.
fn turn_up(positions: &[DVec3], triangles: &mut [[u32; 3]]) -> usize {
    let mut turned = 0;
    for t in triangles {
        if plan_area(t.map(|i| positions[i as usize])) < 0.0 {
            t.swap(1, 2);
            turned += 1;
        }
    }
    turned
}

/// Checks a TIN that is to be written.
pub(super) fn writable(path: &Path, tin: &Tin) -> Result<(), IoError> {
    let bad = |expected: &str, given: String| IoError::BadRequest {
        what: format!("{}: TIN to write", path.display()),
        expected: expected.into(),
        given,
    };
    let vertices = tin.mesh.positions.len();
    if tin.mesh.triangles.is_empty() {
        return Err(bad("at least one triangle", "none".into()));
    }
    if let Some(t) = tin.mesh.triangles.iter().chain(&tin.hidden).find(|t| t.iter().any(|&i| i as usize >= vertices)) {
        return Err(bad(&format!("corners below {vertices}"), format!("a triangle with {t:?}")));
    }
    if let Some(i) = tin.mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(bad("finite positions", format!("vertex {i} at {}", tin.mesh.positions[i])));
    }
    if let Some(i) = tin.breaklines.iter().position(|l| l.points.len() < 2 || l.points.iter().any(|p| !p.is_finite())) {
        return Err(bad("lines of two finite points or more", format!("line {i}")));
    }
    if !is_unit(tin.unit_m) {
        return Err(bad("a unit of metres above zero", tin.unit_m.to_string()));
    }
    Ok(())
}
