//! Small valid mesh files of every format, with all that each can carry.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part of this

use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use yamanami_core::{Material, Texture, TriangleMesh};
use yamanami_io::mesh_file::{MeshMeta, write_mesh};

/// The folder of larger test data beside the checkout, where there is one.
pub fn shared_data() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if !folder.is_dir() {
        println!("skipped: no test data beside the checkout");
        return None;
    }
    Some(folder)
}

/// What starts like a picture; nothing here decodes it.
pub fn picture(kind: &str, content: u8) -> Arc<[u8]> {
    let start: &[u8] = if kind == "png" { b"\x89PNG\r\n\x1a\n" } else { b"\xff\xd8\xff\xe0" };
    Arc::from([start, &[content; 21]].concat())
}

/// A roof of two painted slopes with a seam at its ridge.
pub fn roof() -> TriangleMesh {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let texture = |name: &str, kind: &str, content| Texture { name: name.into(), bytes: picture(kind, content) };
    TriangleMesh {
        positions: vec![
            corner(0.0, 0.0, 0.0),
            corner(4.0, 0.0, 0.0),
            corner(4.0, 2.5, 1.5),
            corner(0.0, 2.5, 1.5),
            corner(0.0, 2.5, 1.5),
            corner(4.0, 2.5, 1.5),
            corner(4.0, 5.0, 0.0),
            corner(0.0, 5.0, 0.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
        normals: vec![[0.0, 0.0, 1.0]; 8],
        colours: (0..8u8).map(|k| [k, 255 - 30 * k, 128, 255]).collect(),
        texcoords: (0..8u8).map(|k| [f32::from(k % 2), 0.5 + f32::from(k) / 16.0]).collect(),
        materials: vec![
            Material { name: "tiles".into(), base_colour: [1.0; 4], texture: Some(texture("tiles.png", "png", 1)) },
            Material {
                name: "copper".into(),
                base_colour: [0.25, 0.5, 0.75, 0.5],
                texture: Some(texture("green copper.jpg", "jpg", 2)),
            },
        ],
        material_of: vec![0, 0, 1, 1],
    }
}

/// The bytes of a mesh written in a format.
pub fn written(mesh: &TriangleMesh, format: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("mesh.{format}"));
    write_mesh(&path, mesh, &MeshMeta::default()).unwrap();
    std::fs::read(&path).unwrap()
}

/// A GLB of a document and its buffer.
pub fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    let padded = format!("{json}{}", " ".repeat(json.len().next_multiple_of(4) - json.len()));
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    bytes.extend((padded.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(padded.as_bytes());
    bytes.extend((buffer.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(buffer);
    let total = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&total.to_le_bytes());
    bytes
}

/// A stream of the reference encoder of meshopt: packed, unpacked, count, stride.
pub fn stream(name: &str) -> (Vec<u8>, Vec<u8>, usize, usize) {
    let list: Vec<serde_json::Value> =
        serde_json::from_str(include_str!("../fixtures/mesh/meshopt_streams.json")).unwrap();
    let found = list.iter().find(|s| s["name"] == name).unwrap();
    let bytes = |key: &str| {
        let digits = found[key].as_str().unwrap();
        (0..digits.len()).step_by(2).map(|k| u8::from_str_radix(&digits[k..k + 2], 16).unwrap()).collect()
    };
    let number = |key: &str| found[key].as_u64().unwrap() as usize;
    (bytes("packed"), bytes("unpacked"), number("count"), number("stride"))
}

/// A GLB whose vertices (words at byte 8 of 20) and corners are packed by meshopt, under either name of the extension.
pub fn packed_glb(extension: &str) -> Vec<u8> {
    let (vertices, _, count, stride) = stream("version 1, level 3");
    let (corners, _, corner_count, corner_stride) = stream("triangles in cache order");
    let (length, corner_length) = (count * stride, corner_count * corner_stride);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsRequired":["{extension}","KHR_mesh_quantization"],
        "scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"byteOffset":8,"componentType":5123,"count":{count},"type":"VEC3"}},
        {{"bufferView":1,"componentType":5125,"count":{corner_count},"type":"SCALAR"}}],
        "buffers":[{{"byteLength":{packed}}},{{"byteLength":{unpacked}}}],
        "bufferViews":[{{"buffer":1,"byteLength":{length},"byteStride":{stride},"extensions":{{"{extension}":
        {{"buffer":0,"byteLength":{a},"byteStride":{stride},"count":{count},"mode":"ATTRIBUTES"}}}}}},
        {{"buffer":1,"byteOffset":{length},"byteLength":{corner_length},"extensions":{{"{extension}":
        {{"buffer":0,"byteOffset":{a},"byteLength":{b},"byteStride":{corner_stride},"count":{corner_count},
        "mode":"TRIANGLES"}}}}}}]}}"#,
        packed = vertices.len() + corners.len(),
        unpacked = length + corner_length,
        a = vertices.len(),
        b = corners.len(),
    );
    glb(&json, &[vertices, corners].concat())
}

/// Three floats a vertex, then three bytes of a triangle, as base64.
const TRIANGLE: &str = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC";

/// A glTF of text, its buffer in a data uri, with a sparse accessor that lifts its third corner to 2 m.
pub fn sparse_gltf() -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":1,
        "indices":{{"bufferView":1,"byteOffset":2,"componentType":5121}},
        "values":{{"bufferView":2}}}}}},
        {{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":3}},
        {{"buffer":1,"byteLength":12}}],
        "buffers":[{{"uri":"data:application/octet-stream;base64,{TRIANGLE}","byteLength":39}},
        {{"uri":"data:;base64,AAAAAAAAAEAAAAAA","byteLength":12}}]}}"#
    )
}

/// A PLY whose faces give texture coordinates by corner, and the picture of each.
pub const CORNER_PLY: &str = "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b b.png\n\
    element vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty float red\nproperty float green\n\
    property float blue\nelement face 3\nproperty list uchar int vertex_indices\nproperty int texnumber\n\
    property list uchar float texcoord\nend_header\n\
    0 0 0 1 0 0\n1 0 0 0 0.5 0\n1 1 0 0 0 1\n0 1 0 1 1 1\n2 0 0 0 0 0\n\
    4 0 1 2 3 0 8 0 0 1 0 1 1 0 1\n3 1 4 2 1 6 0 0 1 0 1 1\n3 4 2 1 -1 0\n";

/// An OBJ with colours, all kinds of corners, and polygons.
pub const PAINTED_OBJ: &str = "mtllib roof.mtl\nv 0 0 0 1 0 0\nv 2 0 0 0 1 0\nv 2 2 0 0 0 1\nv 0 2 0\nv 1 3 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\nusemtl tiles\nf -3/1 -1/2 -2/3\n\
    f 1 2 3 5 4\n";

/// Every format once or more: a name and the bytes.
pub fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let strips = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\n\
        endsolid";
    let off = "STCNOFF 4 1 0 # counts\n0 0 0 0 0 1 255 0 0 255 0 0\n1 0 0 0 0 1 0 255 0 9 1 0\n1 1 0 0 0 1 0 0 255 9 1 1\n\
        0 1 0 0 0 1 9 9 9 9 0 1\n4 0 1 2 3 255 0 0\n";
    vec![
        ("a.ply", written(&roof(), "ply")),
        ("b.ply", CORNER_PLY.into()),
        ("c.ply", strips.into()),
        ("d.ply.gz", written(&roof(), "ply.gz")),
        ("e.ply.zst", written(&roof(), "ply.zst")),
        ("f.ply", big_endian_ply()),
        ("a.obj", PAINTED_OBJ.into()),
        ("b.obj", written(&roof(), "obj")),
        ("a.stl", written(&roof(), "stl")),
        ("b.stl", stl.into()),
        ("a.off", off.into()),
        ("b.off", written(&roof(), "off")),
        ("a.glb", written(&roof(), "glb")),
        ("b.glb", packed_glb("EXT_meshopt_compression")),
        ("a.gltf", sparse_gltf().into()),
    ]
}

pub fn big_endian_ply() -> Vec<u8> {
    let mut ply = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\n\
        property short z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
        property list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for (x, y, z) in [(0f32, 0f64, 0i16), (1.5, 0.0, -7), (0.0, 2.25, 300)] {
        ply.extend(x.to_be_bytes());
        ply.extend(y.to_be_bytes());
        ply.extend(z.to_be_bytes());
        ply.extend([1, 2, z as u8]);
    }
    for t in [[0u32, 1, 2], [2, 1, 0]] {
        ply.push(3);
        ply.extend(t.iter().flat_map(|i| i.to_be_bytes()));
    }
    ply
}
