//! Tiles as binary glTF: positions as whole steps of a lattice that all tiles share, packed as `KHR_mesh_quantization` and
//! `EXT_meshopt_compression` allow, or plain for any reader.
//!
//! Based on: "glTF 2.0", ISO/IEC 12113:2022; "KHR_mesh_quantization" and "EXT_meshopt_compression", Khronos Group;
//! Kapoulkine, meshoptimizer (order of triangles and vertices, codecs).
//!
//! Places are z up; the node's matrix turns them to the y up of glTF, which readers of 3D Tiles turn back, and scales steps
//! to metres. Steps are a power of two and the node's place is a whole number of them, so two tiles that share a place in
//! steps share it in metres to the last bit.

mod attributes;

use crate::mesh_file::{MeshMeta, glb_head, one_line};
use attributes::{Stream, colours, normals, places};
use glam::DVec3;
use serde_json::{Value, json};
use yamanami_core::Aabb;

/// A mesh on a lattice.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LatticeMesh {
    /// Metres in a step; a power of two where places must agree between tiles.
    pub step_m: f64,
    /// Places in steps, z up. No axis may span more than [`MOST_STEPS`].
    pub places: Vec<[i64; 3]>,
    /// Corners, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals, one a place, or empty.
    pub normals: Vec<[f32; 3]>,
    /// Colours (sRGB and alpha), one a place, or empty.
    pub colours: Vec<[u8; 4]>,
}

/// Most steps that a mesh may span: what single precision keeps exactly.
pub const MOST_STEPS: i64 = (1 << 24) - 2;

/// A power of two of metres, at most `wanted_m` where that can be counted in steps over the box.
pub fn step_below_m(wanted_m: f64, bounds: &Aabb) -> f64 {
    let least_m = 1.1 * (bounds.max - bounds.min).max_element() / MOST_STEPS as f64;
    let power = |m: f64| if m > 0.0 { m.log2() } else { -60.0 };
    power(wanted_m).floor().max(power(least_m).ceil()).clamp(-200.0, 200.0).exp2()
}

/// How attributes are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum GlbPacking {
    /// Single precision, for any reader.
    Plain,
    /// `KHR_mesh_quantization`: small integers.
    Quantised,
    /// That, and `EXT_meshopt_compression`.
    #[default]
    Meshopt,
}

impl LatticeMesh {
    /// Drops triangles without area, and places that no triangle has; puts triangles and places in the order in which they
    /// are drawn and packed best.
    fn in_order(&self, packing: GlbPacking) -> Self {
        let corner = |i: u32| self.places[i as usize];
        let has_area = |t: &&[u32; 3]| {
            let [a, b, c] = t.map(corner);
            a != b && b != c && c != a
        };
        let indices: Vec<u32> = self.triangles.iter().filter(has_area).flatten().copied().collect();
        let indices = match packing {
            GlbPacking::Meshopt => meshopt::optimize_vertex_cache_strip(&indices, self.places.len()),
            _ => meshopt::optimize_vertex_cache(&indices, self.places.len()),
        };
        let mut order = Vec::with_capacity(self.places.len());
        let mut number = vec![u32::MAX; self.places.len()];
        let mut numbered = indices;
        for index in &mut numbered {
            let slot = &mut number[*index as usize];
            if *slot == u32::MAX {
                *slot = order.len() as u32;
                order.push(*index as usize);
            }
            *index = *slot;
        }
        Self {
            step_m: self.step_m,
            places: order.iter().map(|&i| self.places[i]).collect(),
            triangles: numbered.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            normals: order.iter().filter_map(|&i| self.normals.get(i)).copied().collect(),
            colours: order.iter().filter_map(|&i| self.colours.get(i)).copied().collect(),
        }
    }
}

/// What a tile's file says of the tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileClaim {
    /// It is nowhere further from its source, metres.
    pub error_m: f64,
    /// Lowest and highest above the ellipsoid, metres, where that is known.
    pub height_range_m: Option<[f64; 2]>,
}

/// The file of a mesh. A mesh without triangles gives a scene without a mesh.
pub fn encode_glb(mesh: &LatticeMesh, packing: GlbPacking, meta: &MeshMeta, claim: &TileClaim) -> Vec<u8> {
    let mesh = mesh.in_order(packing);
    let mut document = json!({
        "asset": {"version": "2.0", "generator": "yamanami"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{}],
    });
    for (key, text) in [("name", &meta.title), ("crs", &meta.crs), ("note", &meta.note)] {
        if !text.is_empty() {
            let node = &mut document["nodes"][0];
            let slot = if key == "name" { &mut node[key] } else { &mut node["extras"][key] };
            *slot = json!(one_line(text));
        }
    }
    document["nodes"][0]["extras"]["error_m"] = json!(claim.error_m);
    if let Some(range) = claim.height_range_m {
        document["nodes"][0]["extras"]["height_range_m"] = json!(range);
    }
    let mut buffers = Buffers { packing, ..Buffers::default() };
    if !mesh.triangles.is_empty() {
        let (stream, origin, scale) = places(&mesh, packing);
        let translation = origin.map(|c| c as f64 * mesh.step_m);
        document["nodes"][0]["mesh"] = json!(0);
        document["nodes"][0]["matrix"] = json!(y_up(scale, translation));
        let mut attributes = json!({"POSITION": buffers.attribute(&stream)});
        if !mesh.normals.is_empty() {
            attributes["NORMAL"] = json!(buffers.attribute(&normals(&mesh.normals, packing)));
        }
        if !mesh.colours.is_empty() {
            attributes["COLOR_0"] = json!(buffers.attribute(&colours(&mesh.colours)));
        }
        let indices = buffers.triangles(&mesh.triangles, mesh.places.len());
        document["meshes"] =
            json!([{"primitives": [{"attributes": attributes, "indices": indices, "material": 0, "mode": 4}]}]);
        // the format's own default would be a mirror; colours of vertices stay as they are
        let shade = if mesh.colours.is_empty() { [0.72, 0.70, 0.66, 1.0] } else { [1.0; 4] };
        document["materials"] = json!([{
            "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": shade, "metallicFactor": 0.0, "roughnessFactor": 1.0},
        }]);
        buffers.describe(&mut document);
    }
    let mut file = glb_head(document.to_string(), buffers.bytes.len());
    file.extend(buffers.bytes);
    file
}

/// What a tile written here says of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlbFacts {
    /// The box of its places, metres, z up.
    pub bounds: Aabb,
    /// Its triangles.
    pub triangles: u64,
    /// What it claims.
    pub claim: TileClaim,
}

impl GlbFacts {
    /// Looks into a file; `None` where it is none of [`encode_glb`], or has no mesh.
    pub fn of(file: &[u8]) -> Option<Self> {
        let length = u32::from_le_bytes(file.get(12..16)?.try_into().ok()?) as usize;
        let document: Value = serde_json::from_slice(file.get(20..20usize.checked_add(length)?)?).ok()?;
        let node = document["nodes"].get(0)?;
        let matrix: Vec<f64> = node["matrix"].as_array()?.iter().filter_map(Value::as_f64).collect();
        let [scale, .., x, z, minus_y, _] = matrix.as_slice() else { return None };
        let places = document["accessors"].get(0)?;
        let corner = |key: &str| {
            let c = |k: usize| places[key].get(k).and_then(Value::as_f64);
            Some(DVec3::new(c(0)?, c(1)?, c(2)?) * *scale + DVec3::new(*x, -minus_y, *z))
        };
        let corners = document["accessors"].as_array()?.last()?["count"].as_u64()?;
        Some(Self {
            bounds: Aabb { min: corner("min")?, max: corner("max")? },
            triangles: corners / 3,
            claim: TileClaim {
                error_m: node["extras"]["error_m"].as_f64()?,
                height_range_m: match node["extras"]["height_range_m"].as_array().map(Vec::as_slice) {
                    Some([low, high]) => Some([low.as_f64()?, high.as_f64()?]),
                    _ => None,
                },
            },
        })
    }
}

/// The matrix, column by column, from z up in units of `scale` metres to y up.
fn y_up(scale: f64, [x, y, z]: [f64; 3]) -> [f64; 16] {
    let s = scale;
    // adding zero makes -0 and 0 one
    [s, 0., 0., 0., 0., 0., -s, 0., 0., s, 0., 0., x, z, -y, 1.].map(|v| v + 0.0)
}

/// The binary part as it grows, and what lies where.
#[derive(Default)]
struct Buffers {
    packing: GlbPacking,
    bytes: Vec<u8>,
    /// Bytes of all views unpacked.
    unpacked: usize,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffers {
    fn attribute(&mut self, stream: &Stream) -> usize {
        let packed = (self.packing == GlbPacking::Meshopt).then(|| stream.packed());
        let view = self.view(&stream.bytes, stream.stride, stream.count(), 34962, packed, "ATTRIBUTES", stream.filter);
        self.views[view]["byteStride"] = json!(stream.stride);
        let mut accessor = json!({
            "bufferView": view, "componentType": stream.component, "count": stream.count(), "type": stream.shape,
        });
        if stream.normalised {
            accessor["normalized"] = json!(true);
        }
        if let Some([min, max]) = stream.range {
            accessor["min"] = json!(min);
            accessor["max"] = json!(max);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn triangles(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        let indices = triangles.as_flattened();
        // the greatest number of each kind restarts strips and may not be used
        let (component, size) = if vertices < 65_536 { (5123, 2) } else { (5125, 4) };
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes().into_iter().take(size)).collect();
        let packed = (self.packing == GlbPacking::Meshopt)
            .then(|| meshopt::encode_index_buffer(indices, vertices).unwrap_or_default());
        let view = self.view(&bytes, size, indices.len(), 34963, packed, "TRIANGLES", None);
        self.accessors
            .push(json!({"bufferView": view, "componentType": component, "count": indices.len(), "type": "SCALAR"}));
        self.accessors.len() - 1
    }

    fn view(
        &mut self,
        bytes: &[u8],
        stride: usize,
        count: usize,
        target: u32,
        packed: Option<Vec<u8>>,
        mode: &str,
        filter: Option<&str>,
    ) -> usize {
        let length = bytes.len();
        let at = self.bytes.len();
        let view = match packed {
            None => {
                self.bytes.extend(bytes);
                json!({"buffer": 0, "byteOffset": at, "byteLength": length, "target": target})
            }
            Some(packed) => {
                self.bytes.extend(&packed);
                let mut extension = json!({
                    "buffer": 0, "byteOffset": at, "byteLength": packed.len(),
                    "byteStride": stride, "count": count, "mode": mode,
                });
                if let Some(filter) = filter {
                    extension["filter"] = json!(filter);
                }
                json!({
                    "buffer": 1, "byteOffset": self.unpacked, "byteLength": length, "target": target,
                    "extensions": {"EXT_meshopt_compression": extension},
                })
            }
        };
        self.unpacked += length.next_multiple_of(4);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.views.len() - 1
    }

    fn describe(&self, document: &mut Value) {
        document["accessors"] = json!(self.accessors);
        document["bufferViews"] = json!(self.views);
        let binary = json!({"byteLength": self.bytes.len()});
        let used: &[&str] = match self.packing {
            GlbPacking::Plain => &[],
            GlbPacking::Quantised => &["KHR_mesh_quantization"],
            GlbPacking::Meshopt => &["KHR_mesh_quantization", "EXT_meshopt_compression"],
        };
        document["buffers"] = match self.packing {
            GlbPacking::Meshopt => {
                let fallback = json!({"EXT_meshopt_compression": {"fallback": true}});
                json!([binary, {"byteLength": self.unpacked, "extensions": fallback}])
            }
            _ => json!([binary]),
        };
        if !used.is_empty() {
            document["extensionsUsed"] = json!(used);
            document["extensionsRequired"] = json!(used);
        }
    }
}

#[cfg(test)]
mod tests;
