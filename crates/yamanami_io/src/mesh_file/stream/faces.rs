//! Faces by stretches: polygons cut into fans; the plain layouts without a decision for each value.

use super::super::ply_header::{Element, Encoding, Kind, Number};
use super::TriangleSink;
use super::window::{Window, decode};
use crate::IoError;
use std::path::Path;

/// Triangles given at a time, about.
const RUN: usize = 1 << 15;
/// Most items of a list. A polygon with more corners is a damaged count.
const LIST_LIMIT: u64 = 1 << 20;

/// A record of numbers around one list, of which only the list varies in length.
#[derive(Debug, Clone, Copy)]
struct Plain {
    before: usize,
    count: Number,
    item: Number,
    after: usize,
}

impl Plain {
    fn of(element: &Element, corners: usize) -> Option<Self> {
        let bytes = |k: std::ops::Range<usize>| {
            element.properties[k].iter().try_fold(0, |sum, p| match p.kind {
                Kind::Scalar(number) => Some(sum + number.size()),
                Kind::List { .. } => None,
            })
        };
        let Kind::List { count, item } = element.properties[corners].kind else { return None };
        let [before, after] = [bytes(0..corners)?, bytes(corners + 1..element.properties.len())?];
        Some(Self { before, count, item, after })
    }
}

/// Gives all triangles to `sink`.
pub(super) fn each_run(
    path: &Path,
    window: &mut Window<'_>,
    element: &Element,
    vertices: u32,
    sink: &mut TriangleSink<'_>,
) -> Result<(), IoError> {
    let is_list = |&k: &usize| matches!(element.properties[k].kind, Kind::List { .. });
    let Some(corners_at) = element.property(&["vertex_indices", "vertex_index"]).filter(is_list) else {
        return Err(IoError::malformed(path, "element 'face'", "a list 'vertex_indices'", "none"));
    };
    let plain = Plain::of(element, corners_at).filter(|_| window.encoding() != Encoding::Ascii);
    let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(RUN + 64);
    let (mut corners, mut items) = (Vec::new(), Vec::new());
    let mut number = 0;
    while number < element.count {
        if let Some(plain) = plain {
            number += three_cornered(window, plain, element.count - number, vertices, &mut triangles)
                .map_err(|e| IoError::io(path, e))?;
        }
        // what the quick way left: a polygon, something wrong, or a layout it does not know
        if number < element.count && triangles.len() < RUN {
            for k in 0..element.properties.len() {
                value(path, window, element, number, k, &mut items)?;
                if k == corners_at {
                    std::mem::swap(&mut items, &mut corners);
                }
            }
            fan(path, number, &corners, vertices, &mut triangles)?;
            number += 1;
        }
        if triangles.len() >= RUN || number == element.count {
            sink(&triangles)?;
            triangles.clear();
        }
    }
    Ok(())
}

/// Takes records while they are sound triangles and a run has room; says how many.
fn three_cornered(
    window: &mut Window<'_>,
    plain: Plain,
    most: u64,
    vertices: u32,
    triangles: &mut Vec<[u32; 3]>,
) -> std::io::Result<u64> {
    let list = plain.before + plain.count.size();
    let size = list + 3 * plain.item.size() + plain.after;
    // the end of the file may be near: then the records that are left
    window.want(size * most.min(RUN as u64) as usize)?;
    let encoding = window.encoding();
    let room = (RUN - triangles.len().min(RUN)).min(most.min(RUN as u64) as usize);
    let records = window.ahead().chunks_exact(size).take(room);
    let before = triangles.len();
    if encoding == Encoding::LittleEndian && plain.count.size() == 1 && matches!(plain.item, Number::I32 | Number::U32)
    {
        for r in records {
            let corner = |k: usize| {
                let b = &r[list + 4 * k..list + 4 * k + 4];
                u32::from_le_bytes([b[0], b[1], b[2], b[3]])
            };
            let t = [corner(0), corner(1), corner(2)];
            if r[plain.before] != 3 || t[0].max(t[1]).max(t[2]) >= vertices {
                break;
            }
            triangles.push(t);
        }
    } else {
        for r in records {
            let t = [0, 1, 2].map(|k| decode(&r[list + k * plain.item.size()..], plain.item, encoding));
            let is_sound = decode(&r[plain.before..], plain.count, encoding) == 3.0
                && t.iter().all(|&c| c >= 0.0 && c < f64::from(vertices) && c.fract() == 0.0);
            if !is_sound {
                break;
            }
            triangles.push(t.map(|c| c as u32));
        }
    }
    let taken = triangles.len() - before;
    window.pass(taken * size);
    Ok(taken as u64)
}

fn fan(path: &Path, number: u64, corners: &[f64], vertices: u32, triangles: &mut Vec<[u32; 3]>) -> Result<(), IoError> {
    let bad = |expected: String, found: f64| {
        Err(IoError::malformed(path, format!("face {number}"), expected, found.to_string()))
    };
    if corners.len() < 3 {
        return bad("at least 3 corners".into(), corners.len() as f64);
    }
    if let Some(&c) = corners.iter().find(|&&c| !(c >= 0.0 && c < f64::from(vertices) && c.fract() == 0.0)) {
        return bad(format!("corners below {vertices}"), c);
    }
    for pair in corners[1..].windows(2) {
        triangles.push([corners[0] as u32, pair[0] as u32, pair[1] as u32]);
    }
    Ok(())
}

/// The next value of a record's property; of a list its length, with the items in `items`.
pub(super) fn value(
    path: &Path,
    window: &mut Window<'_>,
    element: &Element,
    record: u64,
    property: usize,
    items: &mut Vec<f64>,
) -> Result<f64, IoError> {
    let place = || format!("{} {record}, '{}'", element.name, element.properties[property].name);
    let mut next = |number| {
        let value = window.next(number).map_err(|e| IoError::io(path, e))?;
        value.ok_or_else(|| IoError::malformed(path, place(), "a number", "none"))
    };
    match element.properties[property].kind {
        Kind::Scalar(number) => next(number),
        Kind::List { count, item } => {
            let length = next(count)?;
            if !(length >= 0.0 && length.fract() == 0.0 && length <= LIST_LIMIT as f64) {
                let expected = format!("a list of at most {LIST_LIMIT} items");
                return Err(IoError::malformed(path, place(), expected, length.to_string()));
            }
            items.clear();
            for _ in 0..length as usize {
                items.push(next(item)?);
            }
            Ok(length)
        }
    }
}
