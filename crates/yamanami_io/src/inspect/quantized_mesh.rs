//! One tile of quantized-mesh 1.0, read as far as it goes.
//!
//! Based on: Cesium, "Quantized-mesh-1.0 terrain format", 2013 to 2024.

use super::{Bytes, Faults};
use serde_json::Value;

/// The greatest coordinate of a vertex.
const GRID: i64 = 32767;

/// More vertices than this have corners of four bytes.
const MOST_OF_TWO_BYTES: usize = 1 << 16;

/// The lists of vertices on a tile's border, in the order of the file.
pub const SIDE_NAMES: [&str; 4] = ["west", "south", "east", "north"];

/// A tile as it is stored.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct QuantizedMesh {
    /// Centre of the tile, Earth-centred metres.
    pub centre_m: [f64; 3],
    /// Least and greatest height above the ellipsoid, metres.
    pub heights_m: [f64; 2],
    /// Centre of the bounding sphere, Earth-centred metres.
    pub sphere_centre_m: [f64; 3],
    /// Its radius, metres.
    pub sphere_radius_m: f64,
    /// The horizon occlusion point, in radii of the ellipsoid.
    pub horizon_point: [f64; 3],
    /// West to east, south to north, least to greatest height: 0 to 32767 each.
    pub vertices: Vec<[u16; 3]>,
    /// Corners, all in range.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices listed for each side of [`SIDE_NAMES`].
    pub sides: [Vec<u32>; 4],
    /// Two bytes of octahedral normal for each vertex; empty where there are none.
    pub normals: Vec<[u8; 2]>,
    /// The metadata extension.
    pub metadata: Option<Value>,
}

impl QuantizedMesh {
    /// Height of a vertex, metres.
    pub fn height_m(&self, vertex: [u16; 3]) -> f64 {
        let [low, high] = self.heights_m;
        low + f64::from(vertex[2]) / GRID as f64 * (high - low)
    }
}

/// Reads a tile without gzip around it; `None` where nothing of its surface can be made out.
pub fn quantized_mesh(bytes: &[u8], faults: &mut Faults) -> Option<QuantizedMesh> {
    let mut bytes = Bytes::new(bytes);
    let length = bytes.left();
    let mut tile = QuantizedMesh::default();
    let Some(count) = header(&mut bytes, &mut tile) else {
        faults.add("QM02", "header", "92 bytes", format!("{length} bytes"));
        return None;
    };
    check_header(&tile, faults);
    if count == 0 {
        faults.add("QM02", "vertices", "at least three", "none");
        return None;
    }
    let Some(codes) = count.checked_mul(6).and_then(|size| bytes.take(size)) else {
        faults.add("QM02", "vertices", format!("{count} vertices of 6 bytes"), format!("{} bytes left", bytes.left()));
        return None;
    };
    tile.vertices = vertices(codes, count, faults);
    let mut wide = count > MOST_OF_TWO_BYTES;
    let start = bytes;
    let mut own = Faults::default();
    if !corners(&mut bytes, wide, &mut tile, &mut own) && !wide {
        // some encoders always write four bytes
        let mut again = start;
        let mut others = QuantizedMesh { vertices: std::mem::take(&mut tile.vertices), ..QuantizedMesh::default() };
        let none = &mut Faults::default();
        let is_sound =
            corners(&mut again, true, &mut others, none) && sides(&mut again.clone(), true, &mut others, none);
        if is_sound && !others.triangles.is_empty() {
            let found = format!("corners of four bytes for {count} vertices");
            faults.add("QM08", "triangles", "corners of two bytes up to 65536 vertices", found);
            (tile.triangles, wide, bytes, own) = (others.triangles, true, again, Faults::default());
        }
        tile.vertices = others.vertices;
    }
    for fault in own.0 {
        faults.0.push(fault);
    }
    let mut is_used = vec![false; count];
    tile.triangles.iter().flatten().for_each(|&k| is_used[k as usize] = true);
    let unused = is_used.iter().filter(|used| !**used).count();
    if unused > 0 {
        faults.add("QM24", "triangles", "every vertex in a triangle", format!("{unused} of {count} in none"));
    }
    if sides(&mut bytes, wide, &mut tile, faults) {
        extensions(bytes, &mut tile, faults);
    }
    Some(tile)
}

/// Gives the number of vertices.
fn header(bytes: &mut Bytes<'_>, tile: &mut QuantizedMesh) -> Option<usize> {
    tile.centre_m = [bytes.f64()?, bytes.f64()?, bytes.f64()?];
    tile.heights_m = [bytes.f32()?.into(), bytes.f32()?.into()];
    tile.sphere_centre_m = [bytes.f64()?, bytes.f64()?, bytes.f64()?];
    tile.sphere_radius_m = bytes.f64()?;
    tile.horizon_point = [bytes.f64()?, bytes.f64()?, bytes.f64()?];
    bytes.u32().map(|count| count as usize)
}

fn check_header(tile: &QuantizedMesh, faults: &mut Faults) {
    let numbers = [
        ("centre", &tile.centre_m[..]),
        ("heights", &tile.heights_m),
        ("bounding sphere's centre", &tile.sphere_centre_m),
        ("bounding sphere's radius", std::slice::from_ref(&tile.sphere_radius_m)),
        ("horizon occlusion point", &tile.horizon_point),
    ];
    for (what, values) in numbers {
        if !values.iter().all(|v| v.is_finite()) {
            faults.add("QM03", format!("header, {what}"), "finite numbers", format!("{values:?}"));
        }
    }
    let [low, high] = tile.heights_m;
    if low > high {
        faults.add("QM04", "header", "a least height up to the greatest", format!("{low} m to {high} m"));
    }
}

/// Each coordinate is the sum of all differences up to it; what leaves the range is brought back to its end.
fn vertices(codes: &[u8], count: usize, faults: &mut Faults) -> Vec<[u16; 3]> {
    let mut vertices = vec![[0; 3]; count];
    for (axis, codes) in codes.chunks_exact(count * 2).enumerate() {
        let mut value = 0i64;
        for (number, (vertex, code)) in vertices.iter_mut().zip(codes.chunks_exact(2)).enumerate() {
            let code = i64::from(u16::from_le_bytes([code[0], code[1]]));
            // differences without their sign: 0, -1, 1, -2, …
            value += (code >> 1) ^ -(code & 1);
            if !(0..=GRID).contains(&value) {
                let what = ["u", "v", "height"][axis];
                faults.add("QM05", format!("{what} of vertex {number}"), "0 to 32767", value.to_string());
            }
            vertex[axis] = value.clamp(0, GRID) as u16;
        }
    }
    vertices
}

/// A number of two or four bytes.
fn number(bytes: &[u8]) -> u32 {
    match *bytes {
        [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
        [a, b] => u32::from(u16::from_le_bytes([a, b])),
        _ => 0,
    }
}

/// The triangles; whether all corners are in range.
fn corners(bytes: &mut Bytes<'_>, wide: bool, tile: &mut QuantizedMesh, faults: &mut Faults) -> bool {
    let size = if wide { 4 } else { 2 };
    let codes = bytes.take(bytes.at.wrapping_neg() % size).and_then(|_| bytes.u32()).and_then(|count| {
        let bytes_of_all = (count as usize).checked_mul(3 * size)?;
        bytes.take(bytes_of_all)
    });
    let Some(codes) = codes else {
        faults.add("QM02", "triangles", "as many as their count says", format!("{} bytes left", bytes.left()));
        return false;
    };
    let limit = tile.vertices.len() as u32;
    let (mut mark, mut sound, mut corners, mut whole) = (0u32, true, [0; 3], true);
    for (k, code) in codes.chunks_exact(size).map(number).enumerate() {
        // a code is how far below the mark the corner is; 0 is new, and lifts the mark
        let mut corner = mark.wrapping_sub(code);
        if code > mark && !wide {
            // what a browser's array of 16 bits makes of it
            corner &= 0xffff;
            if corner < limit {
                let found = format!("code {code} above the mark {mark}");
                faults.add("QM08", format!("triangle {}", k / 3), "codes up to the high-water mark", found);
            }
        }
        if corner >= limit {
            let (expected, found) = (format!("corners below {limit}"), format!("code {code} at the mark {mark}"));
            let code = if code > mark { "QM06" } else { "QM07" };
            faults.add(code, format!("triangle {}", k / 3), expected, found);
            (sound, whole) = (false, false);
        }
        if code == 0 {
            mark = mark.saturating_add(1);
        }
        corners[k % 3] = corner;
        if k % 3 == 2 {
            if whole {
                tile.triangles.push(corners);
            }
            whole = true;
        }
    }
    sound
}

/// The lists of the sides; whether all are there.
fn sides(bytes: &mut Bytes<'_>, wide: bool, tile: &mut QuantizedMesh, faults: &mut Faults) -> bool {
    let size = if wide { 4 } else { 2 };
    for (side, name) in SIDE_NAMES.into_iter().enumerate() {
        let listed = bytes.u32().and_then(|count| bytes.take((count as usize).checked_mul(size)?));
        let Some(listed) = listed else {
            faults.add("QM02", format!("{name} side"), "a whole list", format!("{} bytes left", bytes.left()));
            return false;
        };
        let limit = tile.vertices.len() as u32;
        for vertex in listed.chunks_exact(size).map(number) {
            if vertex < limit {
                tile.sides[side].push(vertex);
            } else {
                let expected = format!("vertices below {limit}");
                faults.add("QM07", format!("{name} side"), expected, vertex.to_string());
            }
        }
    }
    true
}

/// The extensions behind the lists: normals, water, metadata.
fn extensions(mut bytes: Bytes<'_>, tile: &mut QuantizedMesh, faults: &mut Faults) {
    while bytes.left() > 0 {
        let place = format!("extension at byte {}", bytes.at);
        let Some((kind, length)) = bytes.u8().zip(bytes.u32()) else {
            faults.add("QM17", place, "five bytes of kind and length", "the end of the file");
            return;
        };
        let Some(content) = bytes.take(length as usize) else {
            faults.add("QM17", place, format!("{length} bytes"), format!("{} bytes left", bytes.left()));
            return;
        };
        match kind {
            1 if content.len() == 2 * tile.vertices.len() => {
                tile.normals = content.chunks_exact(2).map(|n| [n[0], n[1]]).collect();
            }
            1 => {
                let expected = format!("two bytes a normal, {}", 2 * tile.vertices.len());
                faults.add("QM17", place, expected, length.to_string());
            }
            2 if length != 1 && length != 1 << 16 => {
                faults.add("QM17", place, "a water mask of 1 or 65536 bytes", length.to_string());
            }
            4 => match metadata(content) {
                Some(value) => tile.metadata = Some(value),
                None => faults.add("QM22", place, "its length and that many bytes of JSON", "something else"),
            },
            2 => {}
            _ => faults.add("QM23", place, "kind 1, 2 or 4", kind.to_string()),
        }
    }
}

fn metadata(content: &[u8]) -> Option<Value> {
    let mut bytes = Bytes::new(content);
    let length = bytes.u32()? as usize;
    let text = bytes.take(length)?;
    serde_json::from_slice::<Value>(text).ok().filter(Value::is_object)
}
