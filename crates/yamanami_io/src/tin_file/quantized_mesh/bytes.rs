//! The bytes of a tile: header, vertices as differences, corners below a rising mark, the vertices of the four sides,
//! extensions.
//!
//! Based on: Cesium, "Quantized-mesh-1.0 terrain format", 2013 to 2024.

use crate::IoError;
use crate::tin_file::Notes;
use std::path::Path;

/// The greatest coordinate of a vertex.
pub(super) const GRID: f64 = 32767.0;

/// More vertices than this have corners of four bytes.
const MOST_OF_TWO_BYTES: usize = 1 << 16;

/// What of the header matters here.
#[derive(Debug)]
pub(super) struct Header {
    /// Centre of the tile, Earth-centred.
    pub(super) centre_m: [f64; 3],
    /// Least and greatest height above the ellipsoid.
    pub(super) heights_m: [f64; 2],
    /// Radius of the sphere around the tile.
    pub(super) radius_m: f64,
}

/// A tile as it is stored.
#[derive(Debug)]
pub(super) struct Decoded {
    pub(super) header: Header,
    /// From west to east, from south to north, from the least to the greatest height: 0 to 32767.
    pub(super) vertices: Vec<[u16; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Reads on through bytes.
#[derive(Debug, Clone)]
struct Cursor<'a> {
    name: &'a Path,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], IoError> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.bytes.len());
        let Some(end) = end else {
            let found = format!("{} bytes", self.bytes.len() - self.at);
            return Err(self.bad(&format!("{what} of {count} bytes"), found));
        };
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn array<const SIZE: usize>(&mut self, what: &str) -> Result<[u8; SIZE], IoError> {
        let mut array = [0; SIZE];
        array.copy_from_slice(self.take(SIZE, what)?);
        Ok(array)
    }

    fn count(&mut self, what: &str) -> Result<usize, IoError> {
        Ok(u32::from_le_bytes(self.array(what)?) as usize)
    }

    fn double(&mut self) -> Result<f64, IoError> {
        Ok(f64::from_le_bytes(self.array("header")?))
    }

    /// `count` numbers of two or four bytes.
    fn numbers(
        &mut self,
        count: usize,
        wide: bool,
        what: &str,
    ) -> Result<impl Iterator<Item = u32> + use<'a>, IoError> {
        let size = if wide { 4 } else { 2 };
        let bytes = self.take(count.saturating_mul(size), what)?;
        let number = move |b: &[u8]| match *b {
            [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
            [a, b] => u32::from(u16::from_le_bytes([a, b])),
            _ => 0,
        };
        Ok(bytes.chunks_exact(size).map(number))
    }

    fn bad(&self, expected: &str, found: impl Into<String>) -> IoError {
        IoError::malformed(self.name, format!("byte {}", self.at), expected, found)
    }
}

/// Decodes a tile.
pub(super) fn decode(name: &Path, bytes: &[u8], notes: &mut Notes) -> Result<Decoded, IoError> {
    let mut cursor = Cursor { name, bytes, at: 0 };
    let header = header(&mut cursor)?;
    let count = cursor.count("number of vertices")?;
    let vertices = vertices(&mut cursor, count)?;
    let wide = count > MOST_OF_TWO_BYTES;
    let as_told = corners(cursor.clone(), wide, &vertices, notes);
    let triangles = as_told.or_else(|why| {
        if wide {
            return Err(why);
        }
        // some encoders always write four bytes
        let triangles = corners(cursor, true, &vertices, notes).map_err(|_| why)?;
        notes.say(format!("corners of four bytes, which {count} vertices need not have"));
        Ok(triangles)
    })?;
    Ok(Decoded { header, vertices, triangles })
}

fn header(cursor: &mut Cursor<'_>) -> Result<Header, IoError> {
    let centre_m = [cursor.double()?, cursor.double()?, cursor.double()?];
    let heights_m = [f32::from_le_bytes(cursor.array("header")?), f32::from_le_bytes(cursor.array("header")?)];
    let heights_m = heights_m.map(f64::from);
    if !heights_m.iter().all(|h| h.is_finite()) {
        return Err(cursor.bad("finite heights", format!("{heights_m:?}")));
    }
    cursor.take(3 * 8, "header")?;
    let radius_m = cursor.double()?;
    // where the horizon hides the tile
    cursor.take(3 * 8, "header")?;
    Ok(Header { centre_m, heights_m, radius_m })
}

/// Each coordinate is the sum of all differences up to it.
fn vertices(cursor: &mut Cursor<'_>, count: usize) -> Result<Vec<[u16; 3]>, IoError> {
    let start = cursor.clone();
    let all = cursor.take(count.saturating_mul(6), "vertices")?;
    let mut vertices = vec![[0; 3]; count];
    if count == 0 {
        return Err(start.bad("vertices", "none"));
    }
    for (axis, codes) in all.chunks_exact(count * 2).enumerate() {
        let mut value = 0i64;
        for (number, (vertex, code)) in vertices.iter_mut().zip(codes.chunks_exact(2)).enumerate() {
            let code = i64::from(u16::from_le_bytes([code[0], code[1]]));
            // differences without their sign: 0, -1, 1, -2, …
            value += (code >> 1) ^ -(code & 1);
            vertex[axis] = u16::try_from(value).ok().filter(|&v| f64::from(v) <= GRID).ok_or_else(|| {
                let what = ["u", "v", "height"][axis];
                start.bad(&format!("{what} of vertex {number} from 0 to {GRID}"), value.to_string())
            })?;
        }
    }
    Ok(vertices)
}

/// The triangles; the lists of the sides and the extensions behind them are checked.
fn corners(
    mut cursor: Cursor<'_>,
    wide: bool,
    vertices: &[[u16; 3]],
    notes: &mut Notes,
) -> Result<Vec<[u32; 3]>, IoError> {
    let align = if wide { 4 } else { 2 };
    cursor.take(cursor.at.wrapping_neg() % align, "padding")?;
    let count = cursor.count("number of triangles")?;
    let start = cursor.clone();
    let codes = cursor.numbers(count.saturating_mul(3), wide, "corners")?;
    let limit = vertices.len() as u32;
    let mut triangles = Vec::with_capacity(count);
    let mut corners = [0; 3];
    let mut mark = 0u32;
    for (k, code) in codes.enumerate() {
        // a code is how far below the mark the corner is; 0 is new, and lifts the mark
        let mut corner = mark.wrapping_sub(code);
        if !wide {
            // some encoders count in two bytes
            corner &= 0xffff;
        }
        if corner >= limit {
            return Err(start.bad(&format!("corners of triangle {} below {limit}", k / 3), corner.to_string()));
        }
        if code == 0 && mark < limit {
            mark += 1;
        }
        corners[k % 3] = corner;
        if k % 3 == 2 {
            triangles.push(corners);
        }
    }
    sides(&mut cursor, wide, vertices, notes)?;
    extensions(cursor, notes);
    Ok(triangles)
}

/// Checks the lists of the vertices on each side.
fn sides(cursor: &mut Cursor<'_>, wide: bool, vertices: &[[u16; 3]], notes: &mut Notes) -> Result<(), IoError> {
    for (side, axis, value) in [("west", 0, 0.0), ("south", 1, 0.0), ("east", 0, GRID), ("north", 1, GRID)] {
        let count = cursor.count("number of vertices on a side")?;
        let start = cursor.clone();
        for number in cursor.numbers(count, wide, "vertices on a side")? {
            match vertices.get(number as usize) {
                None => {
                    let expected = format!("vertices on the {side} side below {}", vertices.len());
                    return Err(start.bad(&expected, number.to_string()));
                }
                Some(vertex) if f64::from(vertex[axis]) != value => {
                    notes.count("vertices listed for a side on which they are not", format_args!("vertex {number}"));
                }
                Some(_) => {}
            }
        }
    }
    Ok(())
}

/// Walks over the extensions: normals, water, metadata.
fn extensions(mut cursor: Cursor<'_>, notes: &mut Notes) {
    while cursor.at < cursor.bytes.len() {
        let at = cursor.at;
        let walked = cursor.take(1, "extension").and_then(|_| {
            let length = cursor.count("length of an extension")?;
            cursor.take(length, "extension")
        });
        if walked.is_err() {
            notes.say(format!("an extension at byte {at} is cut short"));
            return;
        }
    }
}
