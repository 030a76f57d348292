//! The bytes of a tile.

use super::GRID;
use super::globe::Bounds;
use glam::DVec3;

/// More vertices than this have corners of four bytes.
const MOST_OF_TWO_BYTES: usize = 1 << 16;

/// Number of the extension with normals. There is none with metadata: CesiumJS refuses tiles that have one where `layer.json`
/// lists all that is available.
const NORMALS: u8 = 1;

/// The mesh of a tile.
#[derive(Debug, Clone, Copy)]
pub struct MeshTile<'a> {
    /// West, south, east and north, degrees.
    pub rectangle_deg: [f64; 4],
    /// From the west and from the south, 0 to [`GRID`].
    pub places: &'a [[u16; 2]],
    /// Heights above the ellipsoid, metres: multiples of the quantum.
    pub heights_m: &'a [f64],
    /// A power of two: 32767 of it are no less than what lies between the lowest and the highest vertex. Metres.
    pub quantum_m: f64,
    /// Corners, counter-clockwise from above; vertices are numbered as they first appear.
    pub triangles: &'a [[u32; 3]],
    /// Vertices on the west, south, east and north side, in order along it.
    pub sides: &'a [Vec<u32>; 4],
    /// Unit normals: east, north, up; or empty.
    pub normals: &'a [[f32; 3]],
}

/// Encodes a tile, not packed. Decoders find every height to the bit: least and greatest height are multiples of the
/// quantum, 32767 quanta apart.
pub fn encode(tile: &MeshTile<'_>) -> Vec<u8> {
    let [low, high] = tile.heights_m.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &z| [a.min(z), b.max(z)]);
    let [low, high] = if low <= high { [low, high] } else { [0.0; 2] };
    let bounds = Bounds::of(tile.rectangle_deg, [low, high]);
    let count = tile.places.len();
    let wide = count > MOST_OF_TWO_BYTES;
    let mut out = Vec::with_capacity(128 + count * 8 + tile.triangles.len() * if wide { 12 } else { 6 });
    let point = |out: &mut Vec<u8>, p: DVec3| p.to_array().iter().for_each(|v| out.extend(v.to_le_bytes()));
    point(&mut out, bounds.centre_m);
    out.extend((low as f32).to_le_bytes());
    out.extend(((low + f64::from(GRID) * tile.quantum_m) as f32).to_le_bytes());
    point(&mut out, bounds.centre_m);
    out.extend(bounds.radius_m.to_le_bytes());
    point(&mut out, bounds.horizon);
    out.extend((count as u32).to_le_bytes());
    differences(&mut out, tile.places.iter().map(|p| p[0]));
    differences(&mut out, tile.places.iter().map(|p| p[1]));
    let quanta = |z: &f64| ((z - low) / tile.quantum_m).round().clamp(0.0, f64::from(GRID)) as u16;
    differences(&mut out, tile.heights_m.iter().map(quanta));
    let align = if wide { 4 } else { 2 };
    out.resize(out.len().next_multiple_of(align), 0);
    out.extend((tile.triangles.len() as u32).to_le_bytes());
    let number = |out: &mut Vec<u8>, v: u32| {
        if wide { out.extend(v.to_le_bytes()) } else { out.extend((v as u16).to_le_bytes()) }
    };
    let mut mark = 0;
    for &corner in tile.triangles.iter().flatten() {
        number(&mut out, mark - corner);
        mark += u32::from(corner == mark);
    }
    for side in tile.sides {
        out.extend((side.len() as u32).to_le_bytes());
        side.iter().for_each(|&v| number(&mut out, v));
    }
    if !tile.normals.is_empty() {
        extension(&mut out, NORMALS, &normals(tile));
    }
    out
}

/// Each value less the one before it, the sign in the lowest bit.
fn differences(out: &mut Vec<u8>, values: impl Iterator<Item = u16>) {
    let mut last = 0i32;
    for value in values {
        let difference = i32::from(value) - last;
        last = i32::from(value);
        out.extend((((difference << 1) ^ (difference >> 31)) as u16).to_le_bytes());
    }
}

fn extension(out: &mut Vec<u8>, number: u8, body: &[u8]) {
    out.push(number);
    out.extend((body.len() as u32).to_le_bytes());
    out.extend(body);
}

/// Normals on an octahedron, two bytes each, Earth-centred.
fn normals(tile: &MeshTile<'_>) -> Vec<u8> {
    let [west, south, east, north] = tile.rectangle_deg;
    let along = |k: u16, from: f64, to: f64| (from + (to - from) * f64::from(k) / f64::from(GRID)).to_radians();
    let turned = tile.places.iter().zip(tile.normals).map(|(place, normal)| {
        let (sin_lon, cos_lon) = along(place[0], west, east).sin_cos();
        let (sin_lat, cos_lat) = along(place[1], south, north).sin_cos();
        let [e, n, u] = normal.map(f64::from);
        DVec3::new(
            -sin_lon * e - sin_lat * cos_lon * n + cos_lat * cos_lon * u,
            cos_lon * e - sin_lat * sin_lon * n + cos_lat * sin_lon * u,
            cos_lat * n + sin_lat * u,
        )
    });
    turned.flat_map(octahedral).collect()
}

/// Based on: Cigolle, Donow, Evangelakos, Mara, McGuire, Meyer, "A survey of efficient representations for independent unit
/// vectors", 2014.
fn octahedral(v: DVec3) -> [u8; 2] {
    let sum = v.x.abs() + v.y.abs() + v.z.abs();
    let [mut x, mut y] = [v.x / sum, v.y / sum];
    if v.z < 0.0 {
        [x, y] = [(1.0 - y.abs()) * x.signum(), (1.0 - x.abs()) * y.signum()];
    }
    [x, y].map(|k| ((k.clamp(-1.0, 1.0) * 0.5 + 0.5) * 255.0).round() as u8)
}
