//! Attributes of vertices as the bytes that glTF and the meshopt codecs want.

use super::{GlbPacking, LatticeMesh};
use crate::mesh_file::linear_word_of_byte;

const BYTE: u32 = 5120;
const WORD: u32 = 5123;
const FLOAT: u32 = 5126;
/// The codec of `EXT_meshopt_compression` is the older of two.
const CODEC: i32 = 0;

/// One attribute of all vertices.
pub(super) struct Stream {
    /// As a reader sees them.
    pub bytes: Vec<u8>,
    /// What the codec packs where that is something else: the filter's own form.
    filtered: Option<Vec<u8>>,
    pub filter: Option<&'static str>,
    pub stride: usize,
    pub component: u32,
    pub shape: &'static str,
    pub normalised: bool,
    /// Least and greatest, where they must be stated.
    pub range: Option<[[f64; 3]; 2]>,
}

impl Stream {
    pub(super) fn count(&self) -> usize {
        self.bytes.len() / self.stride
    }

    pub(super) fn packed(&self) -> Vec<u8> {
        let bytes = self.filtered.as_ref().unwrap_or(&self.bytes);
        fn pack<const N: usize>(bytes: &[u8]) -> Vec<u8> {
            let (elements, _) = bytes.as_chunks::<N>();
            meshopt::encode_vertex_buffer_level(elements, 2, Some(CODEC)).unwrap_or_default()
        }
        match self.stride {
            4 => pack::<4>(bytes),
            8 => pack::<8>(bytes),
            _ => pack::<12>(bytes),
        }
    }
}

/// Places, where the lattice's step (0, 0, 0) of the stream lies, and the metres in its unit.
pub(super) fn places(mesh: &LatticeMesh, packing: GlbPacking) -> (Stream, [i64; 3], f64) {
    let mut low = [i64::MAX; 3];
    let mut high = [i64::MIN; 3];
    for place in &mesh.places {
        for axis in 0..3 {
            low[axis] = low[axis].min(place[axis]);
            high[axis] = high[axis].max(place[axis]);
        }
    }
    let small = (0..3).all(|k| high[k] - low[k] <= i64::from(u16::MAX));
    let middle: [i64; 3] = std::array::from_fn(|k| low[k] + (high[k] - low[k]) / 2);
    let quantised = packing != GlbPacking::Plain && small;
    let (origin, scale) = if quantised { (low, mesh.step_m) } else { (middle, mesh.step_m) };
    let (unit, scale) = if packing == GlbPacking::Plain { (mesh.step_m, 1.0) } else { (1.0, scale) };
    let local = |place: &[i64; 3]| -> [i64; 3] { std::array::from_fn(|k| place[k] - origin[k]) };
    let range = [low, high].map(|p| local(&p).map(|c| f64::from((c as f64 * unit) as f32)));
    let stream = if quantised {
        let four = |p: &[i64; 3]| {
            let [x, y, z] = local(p);
            [x as u16, y as u16, z as u16, 0]
        };
        Stream {
            bytes: mesh.places.iter().flat_map(four).flat_map(u16::to_le_bytes).collect(),
            filtered: None,
            filter: None,
            stride: 8,
            component: WORD,
            shape: "VEC3",
            normalised: false,
            range: Some(range),
        }
    } else {
        let numbers = || mesh.places.iter().flat_map(&local);
        // the exponent is none, so the mantissa is the number itself
        let whole = packing == GlbPacking::Meshopt;
        Stream {
            bytes: numbers().flat_map(|c| ((c as f64 * unit) as f32).to_le_bytes()).collect(),
            filtered: whole.then(|| numbers().flat_map(|c| ((c as i32 as u32) & 0x00ff_ffff).to_le_bytes()).collect()),
            filter: whole.then_some("EXPONENTIAL"),
            stride: 12,
            component: FLOAT,
            shape: "VEC3",
            normalised: false,
            range: Some(range),
        }
    };
    (stream, origin, scale)
}

pub(super) fn normals(normals: &[[f32; 3]], packing: GlbPacking) -> Stream {
    let plain = Stream {
        bytes: Vec::new(),
        filtered: None,
        filter: None,
        stride: 4,
        component: BYTE,
        shape: "VEC3",
        normalised: true,
        range: None,
    };
    let byte = |c: f32| (c.clamp(-1.0, 1.0) * 127.0).round() as i8;
    let bytes = || normals.iter().flat_map(|n| [byte(n[0]), byte(n[1]), byte(n[2]), 0]).map(|b| b as u8).collect();
    match packing {
        GlbPacking::Plain => Stream {
            bytes: normals.iter().flatten().flat_map(|c| c.to_le_bytes()).collect(),
            stride: 12,
            component: FLOAT,
            normalised: false,
            ..plain
        },
        GlbPacking::Quantised => Stream { bytes: bytes(), ..plain },
        GlbPacking::Meshopt => {
            let four: Vec<[f32; 4]> = normals.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
            let octahedral = meshopt::encode_filter_oct::<i8>(&four, 8);
            let filtered = octahedral.into_iter().flatten().map(|c| c as u8).collect();
            Stream { bytes: bytes(), filtered: Some(filtered), filter: Some("OCTAHEDRAL"), ..plain }
        }
    }
}

pub(super) fn colours(colours: &[[u8; 4]]) -> Stream {
    let linear: Vec<u16> = (0..=255).map(linear_word_of_byte).collect();
    let words = |&[r, g, b, a]: &[u8; 4]| {
        let [r, g, b] = [r, g, b].map(|c| linear[usize::from(c)]);
        [r, g, b, u16::from(a) * 257]
    };
    Stream {
        bytes: colours.iter().flat_map(words).flat_map(u16::to_le_bytes).collect(),
        filtered: None,
        filter: None,
        stride: 8,
        component: WORD,
        shape: "VEC4",
        normalised: true,
        range: None,
    }
}
