//! Vertices by stretches: where the values of a record lie, and the plain layouts without a decision for each value.

use super::super::ply_header::{Element, Encoding, Kind, Number};
use super::faces::value;
use super::window::{Window, decode};
use super::{VertexRun, VertexSink};
use crate::IoError;
use glam::DVec3;
use std::path::Path;

/// Vertices given at a time.
const RUN: usize = 1 << 14;

/// A value of a record: which property, and at which byte where records are of fixed size.
#[derive(Debug, Clone, Copy)]
struct Field {
    property: usize,
    at: usize,
    number: Number,
}

/// Where the values of a vertex lie.
#[derive(Debug)]
pub(super) struct Layout {
    /// Bytes of a record, or `None` when it has lists.
    size: Option<usize>,
    place: [Field; 3],
    /// Red, green, blue.
    colour: Option<[Field; 3]>,
    alpha: Option<Field>,
}

impl Layout {
    pub(super) fn of(path: &Path, element: &Element) -> Result<Self, IoError> {
        let field = |names: &[&str]| {
            let property = element.property(names)?;
            let mut at = 0;
            for before in &element.properties[..property] {
                at += if let Kind::Scalar(number) = before.kind { number.size() } else { 0 };
            }
            let Kind::Scalar(number) = element.properties[property].kind else { return None };
            Some(Field { property, at, number })
        };
        let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(|name| field(&[name])) else {
            let found: Vec<&str> = element.properties.iter().map(|p| p.name.as_str()).collect();
            let found = format!("'{}'", found.join(" "));
            return Err(IoError::malformed(path, "element 'vertex'", "properties x, y and z", found));
        };
        let names = [
            ["red", "green", "blue"],
            ["diffuse_red", "diffuse_green", "diffuse_blue"],
            ["r", "g", "b"],
        ];
        let colour = names.into_iter().find_map(|names| match names.map(|name| field(&[name])) {
            [Some(r), Some(g), Some(b)] => Some([r, g, b]),
            _ => None,
        });
        Ok(Self {
            size: element.is_fixed().then(|| element.least_bytes(Encoding::LittleEndian)),
            place: [x, y, z],
            colour,
            alpha: field(&["alpha", "diffuse_alpha", "a"]).filter(|_| colour.is_some()),
        })
    }

    pub(super) fn has_colours(&self) -> bool {
        self.colour.is_some()
    }

    pub(super) fn is_single_precision(&self) -> bool {
        self.place.iter().all(|f| !matches!(f.number, Number::F64 | Number::I32 | Number::U32))
    }

    /// Red, green, blue and alpha; `get` knows the values.
    fn colour_of(&self, get: impl Fn(Field) -> f64) -> Option<[u8; 4]> {
        let byte = |field: Field| {
            let value = get(field);
            let of_255 = match field.number {
                Number::F32 | Number::F64 => value * 255.0,
                Number::U16 => value / 257.0,
                _ => value,
            };
            // casts clamp, and make nothing of what is no number
            of_255.round() as u8
        };
        let [r, g, b] = self.colour?.map(byte);
        Some([r, g, b, self.alpha.map_or(255, byte)])
    }
}

/// Gives all vertices to `sink`.
pub(super) fn each_run(
    path: &Path,
    window: &mut Window<'_>,
    element: &Element,
    layout: &Layout,
    sink: &mut VertexSink<'_>,
) -> Result<(), IoError> {
    let (mut positions, mut colours) = (Vec::with_capacity(RUN), Vec::new());
    let mut first = 0u64;
    while first < element.count {
        let run = (element.count - first).min(RUN as u64) as usize;
        positions.clear();
        colours.clear();
        match layout.size {
            Some(size) if window.encoding() != Encoding::Ascii => {
                if !window.want(run * size).map_err(|e| IoError::io(path, e))? {
                    let whole = first + (window.ahead().len() / size) as u64;
                    let place = format!("vertex {whole}");
                    return Err(IoError::malformed(path, place, "a whole record", "the end of the file"));
                }
                let records = &window.ahead()[..run * size];
                read_places(records, size, layout, window.encoding(), &mut positions);
                if layout.has_colours() {
                    let encoding = window.encoding();
                    let of = |r: &[u8]| layout.colour_of(|f| decode(&r[f.at..], f.number, encoding));
                    colours.extend(records.chunks_exact(size).filter_map(of));
                }
                window.pass(run * size);
            }
            _ => {
                let mut record = vec![0.0; element.properties.len()];
                let mut items = Vec::new();
                for number in first..first + run as u64 {
                    for (k, into) in record.iter_mut().enumerate() {
                        *into = value(path, window, element, number, k, &mut items)?;
                    }
                    positions.push(DVec3::from(layout.place.map(|f| record[f.property])));
                    colours.extend(layout.colour_of(|f| record[f.property]));
                }
            }
        }
        if let Some(k) = positions.iter().position(|p| !p.is_finite()) {
            let (place, found) = (format!("vertex {}", first + k as u64), positions[k].to_string());
            return Err(IoError::malformed(path, place, "three finite numbers", found));
        }
        sink(VertexRun { first: first as u32, positions: &positions, colours: &colours })?;
        first += run as u64;
    }
    Ok(())
}

fn read_places(records: &[u8], size: usize, layout: &Layout, encoding: Encoding, positions: &mut Vec<DVec3>) {
    let at = layout.place.map(|f| f.at);
    let all = |number| layout.place.iter().all(|f| f.number == number);
    match encoding {
        Encoding::LittleEndian if all(Number::F32) => {
            let get = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            positions.extend(records.chunks_exact(size).map(|r| DVec3::from(at.map(|k| get(&r[k..k + 4])))));
        }
        Encoding::LittleEndian if all(Number::F64) => {
            let get = |b: &[u8]| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]);
            positions.extend(records.chunks_exact(size).map(|r| DVec3::from(at.map(|k| get(&r[k..k + 8])))));
        }
        _ => positions.extend(
            records
                .chunks_exact(size)
                .map(|r| DVec3::from(layout.place.map(|f| decode(&r[f.at..], f.number, encoding)))),
        ),
    }
}
