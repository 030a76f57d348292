//! Mesh files: round trips, real files, and bad input.

use glam::DVec3;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use yamanami_core::TriangleMesh;
use yamanami_io::IoError;
use yamanami_io::mesh_file::{MeshMeta, read_mesh, read_mesh_from_bytes, write_mesh};

const FORMATS: [&str; 5] = ["ply", "obj", "stl", "glb", "off"];

fn meta() -> MeshMeta {
    MeshMeta {
        title: "Fuji\nfrom the south".into(),
        crs: "EPSG:32654 WGS 84 / UTM zone 54N".into(),
        note: "富士山".into(),
    }
}

/// A pyramid far from zero, as projected coordinates are.
fn pyramid() -> TriangleMesh {
    let at = DVec3::new(293_000.25, 3_915_000.5, 3_700.125);
    let corners = [
        [0.0, 0.0, 0.0],
        [500.0, 0.0, 1.0],
        [500.0, 500.0, 2.0],
        [0.0, 500.0, 3.0],
        [250.0, 250.0, 76.0],
    ];
    TriangleMesh {
        positions: corners.map(|c| at + DVec3::from(c)).to_vec(),
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        normals: vec![[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]],
        ..TriangleMesh::default()
    }
}

fn written(mesh: &TriangleMesh, format: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("mesh.{format}"));
    write_mesh(&path, mesh, &meta()).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "only the file itself is left");
    std::fs::read(&path).unwrap()
}

fn through(mesh: &TriangleMesh, format: &str) -> TriangleMesh {
    read_mesh_from_bytes(format!("mesh.{format}"), &written(mesh, format)).unwrap()
}

fn line(name: &str, bytes: &[u8]) -> String {
    let line = read_mesh_from_bytes(name, bytes).unwrap_err().to_string();
    assert!(!line.contains('\n'), "{line}");
    line
}

#[test]
fn double_precision_formats_keep_every_bit() {
    assert_eq!(through(&pyramid(), "ply"), pyramid());
    assert_eq!(through(&pyramid(), "obj"), pyramid());
    assert_eq!(through(&pyramid(), "off"), pyramid());
}

#[test]
fn single_precision_formats_keep_a_tenth_of_a_millimetre_far_from_zero() {
    for format in ["stl", "glb"] {
        let (mesh, back) = (pyramid(), through(&pyramid(), format));
        assert_eq!(back.triangles.len(), mesh.triangles.len());
        for t in 0..mesh.triangles.len() {
            for (p, q) in mesh.corners(t).into_iter().zip(back.corners(t)) {
                assert!(p.distance(q) < 1e-4, "{format}: {p} {q}");
            }
        }
    }
    assert_eq!(through(&pyramid(), "glb").normals, pyramid().normals);
}

#[test]
fn every_format_leaves_the_old_file_when_it_cannot_write() {
    let folder = tempfile::tempdir().unwrap();
    for format in FORMATS {
        let path = folder.path().join(format!("mesh.{format}"));
        std::fs::write(&path, "old").unwrap();
        let mut broken = pyramid();
        broken.triangles[2][1] = 99;
        assert!(matches!(write_mesh(&path, &broken, &meta()), Err(IoError::BadRequest { .. })));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }
    let nowhere = folder.path().join("absent").join("mesh.ply");
    assert!(matches!(write_mesh(nowhere, &pyramid(), &meta()), Err(IoError::Io { .. })));
    let line = write_mesh("mesh.fbx", &pyramid(), &meta()).unwrap_err().to_string();
    assert_eq!(line, "mesh.fbx: 'fbx' is not a mesh format known here; use .ply, .obj, .stl, .off, .glb or .gltf");
}

#[test]
fn glb_says_where_it_lies_and_is_what_the_specification_asks_for() {
    let bytes = written(&pyramid(), "glb");
    let json = &bytes[20..20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize];
    let document: serde_json::Value = serde_json::from_slice(json).unwrap();
    assert_eq!(bytes.len(), u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize);
    assert_eq!(document["nodes"][0]["translation"], serde_json::json!([293_250.0, 3_738.0, -3_915_251.0]));
    assert_eq!(document["nodes"][0]["name"], "Fuji from the south");
    assert_eq!(document["nodes"][0]["extras"]["crs"], "EPSG:32654 WGS 84 / UTM zone 54N");
    for accessor in document["accessors"].as_array().unwrap() {
        let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        assert_eq!(view["byteOffset"].as_u64().unwrap() % 4, 0);
    }
}

#[test]
fn text_files_of_other_programs_are_read() {
    let square = "ply\r\nformat ascii 1.0\r\ncomment x\r\nelement vertex 4\r\nproperty uchar red\r\nproperty float z\r\n\
        property float y\r\nproperty float x\r\nelement face 1\r\nproperty float quality\r\n\
        property list uchar uint vertex_index\r\nelement edge 1\r\nproperty int vertex1\r\nend_header\r\n\
        1 0 0 0\r\n2 0 0 1\r\n3 0 1 1\r\n4 0 1 0\r\n0.5 4 0 1 2 3\r\n7";
    let mesh = read_mesh_from_bytes("a.PLY", square.as_bytes()).unwrap();
    assert_eq!(mesh.positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(DVec3::from));
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);

    let strips = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n";
    let mesh = read_mesh_from_bytes("a.ply", strips.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [0, 1, 3]]);

    let obj = "mtllib a.mtl\no square\nv 0 0 0 1.0\nv 1 0 0\nv 1 1 \\\n 0\nv 0 1 0\nvt 0 0\nvn 0 0 2\n\
        usemtl m\nf 1/1/1 2/1/1 3/1/1 4/1/1 # all\nf -4//1 -3//1 -2//1\n";
    let mesh = read_mesh_from_bytes("a.obj", obj.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 4]);

    let stl = "solid a\n FACET normal 0 0 1\n  outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1e0 0\n endloop\n\
        endfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex -0 1 0\nendloop\nendfacet\nendsolid";
    let mesh = read_mesh_from_bytes("a.stl", stl.as_bytes()).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles), (4, vec![[0, 1, 2], [1, 3, 2]]));
}

#[test]
fn big_endian_ply_is_read() {
    let mut ply = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\n\
        property short z\nelement face 1\nproperty list uchar ushort vertex_indices\nend_header\n"
        .to_vec();
    for (x, y, z) in [(0f32, 0f64, 0i16), (1.5, 0.0, -7), (0.0, 2.25, 300)] {
        ply.extend(x.to_be_bytes());
        ply.extend(y.to_be_bytes());
        ply.extend(z.to_be_bytes());
    }
    ply.extend([3, 0, 0, 0, 1, 0, 2]);
    let mesh = read_mesh_from_bytes("a.ply", &ply).unwrap();
    assert_eq!(mesh.corners(0), [[0.0, 0.0, 0.0], [1.5, 0.0, -7.0], [0.0, 2.25, 300.0]].map(DVec3::from));
}

#[test]
fn glb_nodes_place_turn_and_mirror_their_meshes() {
    let json = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],
        "nodes":[{"children":[1,2],"translation":[10,0,0]},{"mesh":0,"scale":[1,1,-1]},{"mesh":0,"translation":[0,5,0]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],
        "accessors":[{"bufferView":0,"componentType":5122,"count":4,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":32,"byteStride":8}],"buffers":[{"byteLength":32}]}"#;
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    let padded = format!("{json}{}", " ".repeat(json.len().next_multiple_of(4) - json.len()));
    bytes.extend((padded.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(padded.as_bytes());
    bytes.extend(32u32.to_le_bytes());
    bytes.extend(b"BIN\0");
    for v in [[0i16, 0, 0, 0], [1, 0, 0, 0], [0, 0, -1, 0], [1, 0, -1, 0]] {
        bytes.extend(v.iter().flat_map(|c| c.to_le_bytes()));
    }
    let mesh = read_mesh_from_bytes("a.glb", &bytes).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 4));
    // y up to z up: the mirrored strip runs south, the lifted one north at 5 m
    assert_eq!(mesh.positions[3], DVec3::new(11.0, -1.0, 0.0));
    assert_eq!(mesh.positions[7], DVec3::new(11.0, 1.0, 5.0));
    for t in 0..4 {
        let [a, b, c] = mesh.corners(t);
        assert!((b - a).cross(c - a).z > 0.0, "all face up");
    }
}

#[test]
fn bad_files_get_one_clear_line() {
    let ply =
        |body: &str| format!("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n{body}");
    let body = "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let cases: [(&str, String, &str); 14] = [
        ("a.ply", "plx\n".into(), "a.ply: header line 1: expected 'ply', found 'plx\\n'"),
        (
            "a.ply",
            ply("element face 1\nend_header\n0 0 0 0 0 0"),
            "a.ply: element 'vertex': expected properties x, y and z, found 'x y'",
        ),
        ("a.ply", ply(body) + "0 0 0 1 0 0 1 1 0 3 0 1 7", "a.ply: face 0: expected corners below 3, found 7"),
        ("a.ply", ply(body) + "0 0 0 1 0 0 1 1 0 2 0 1", "a.ply: face 0: expected at least 3 corners, found 2"),
        ("a.ply", ply(body) + "0 0 0 1 0 0 1 x 0 3 0 1 2", "a.ply: vertex 2, 'y': expected a number, found none"),
        (
            "a.ply",
            ply(body) + "0 0 0 1 0 0 nan 0 0 3 0 1 2",
            "a.ply: vertex 2: expected three finite numbers, found [NaN, 0, 0]",
        ),
        (
            "a.ply",
            ply(body).replace("vertex 3", "vertex 4000000000") + "0 0 0",
            "a.ply: element 'vertex': expected at least 23999999999 bytes for 4000000000 records, found 5",
        ),
        (
            "a.ply",
            ply("propertie z\n"),
            "a.ply: header line 6: expected 'format', 'element', 'property', 'comment' or 'end_header', found 'propertie z'",
        ),
        ("a.obj", "v 0 0 0\nv 1 0\n".into(), "a.obj: line 2: expected three numbers, found 'v 1 0'"),
        (
            "a.obj",
            "v 0 0 0\nf 1 1 2\n".into(),
            "a.obj: line 2: expected corners among the 1 vertices so far, found 'f 1 1 2'",
        ),
        ("a.obj", "v 0 0 0\n".into(), "a.obj: faces: expected at least one triangle, found 1 vertices, no face"),
        (
            "a.stl",
            "solid\nvertex 0 0 0\nendloop\n".into(),
            "a.stl: line 3: expected the end of 3 corners after 1 of them, found 'endloop'",
        ),
        (
            "a.stl",
            "short".into(),
            "a.stl: facets: expected a header of 84 bytes, or 'solid', found 0 bytes after the header",
        ),
        ("a.glb", "glTF\u{1}\0\0\0".into(), "a.glb: header: expected glTF version 2, found 1"),
    ];
    for (name, content, expected) in cases {
        assert_eq!(line(name, content.as_bytes()), expected);
    }
    let mut stl = written(&pyramid(), "stl");
    stl.truncate(stl.len() - 1);
    assert!(line("a.stl", &stl).contains("expected 4 facets of 50 bytes, found 199 bytes"), "{}", line("a.stl", &stl));
    assert!(line("a.ply.gz", b"not packed").contains("a whole gzip stream"));
    assert!(matches!(read_mesh("absent.ply"), Err(IoError::Io { .. })));
}

/// The folder of larger test data beside the checkout, where there is one.
fn shared_data() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if !folder.is_dir() {
        println!("skipped: no test data beside the checkout");
        return None;
    }
    Some(folder)
}

#[test]
fn real_files_have_the_faces_their_readme_states() {
    let Some(folder) = shared_data() else { return };
    let files = [
        ("mesh/stanford_bunny_69451f.obj", Some(34_834)),
        ("mesh/bunny_defective_99785f.ply", Some(50_000)),
        ("mesh/stanford_lucy_99970f.ply", Some(49_987)),
        ("mesh/stanford_armadillo_99976f.ply", Some(49_990)),
        ("mesh/laurana_bust_50000f_vertexcolour.ply", Some(25_160)),
        ("mesh/gargoyle_50000f_vertexcolour.ply", Some(25_002)),
        ("mesh/gargoyle_50000f_vertexcolour.glb", Some(25_002)),
        ("mesh/nefertiti_bust_70000f.obj", Some(35_002)),
        ("mesh/demosthenes_bust_16719f.obj", Some(8_394)),
        ("mesh/demosthenes_bust_16719f.stl", Some(8_394)),
        ("mesh/lion_statue_63338f.obj", Some(31_825)),
        ("mesh/pagoda_modelled_29696f.ply", Some(33_629)),
        ("mesh/stanford_dragon_871414f.ply.gz", Some(437_645)),
        ("tin/obj_olympus_terrain_24612f.obj.gz", None),
    ];
    for (name, vertices) in files {
        let faces: usize =
            name.split('_').find_map(|part| part.split_once('f')?.0.parse().ok()).expect("the name states the faces");
        let mesh = read_mesh(folder.join(name)).unwrap();
        assert_eq!(mesh.triangles.len(), faces, "{name}");
        if let Some(vertices) = vertices {
            // of those that faces use: the bunny has a thousand more
            let used: std::collections::HashSet<u32> = mesh.triangles.iter().flatten().copied().collect();
            assert_eq!(used.len(), vertices, "{name}");
        }
    }
}

#[test]
fn one_model_is_the_same_in_both_its_formats() {
    let Some(folder) = shared_data() else { return };
    let ply = read_mesh(folder.join("mesh/gargoyle_50000f_vertexcolour.ply")).unwrap();
    let glb = read_mesh(folder.join("mesh/gargoyle_50000f_vertexcolour.glb")).unwrap();
    assert_eq!(ply.triangles, glb.triangles);
    // the GLB is the PLY's coordinates taken as y up
    assert!(ply.positions.iter().zip(&glb.positions).all(|(p, q)| DVec3::new(p.x, -p.z, p.y) == *q));
}

fn meshes() -> impl Strategy<Value = TriangleMesh> {
    let vertex = prop::array::uniform3(prop_oneof![-1e3..1e3f64, 3.9e6..4e6f64, Just(0.0)]);
    (prop::collection::vec(vertex, 3..40), prop::collection::vec(prop::array::uniform3(0u32..1000), 1..60)).prop_map(
        |(positions, triangles)| {
            let count = positions.len() as u32;
            TriangleMesh {
                positions: positions.into_iter().map(DVec3::from).collect(),
                triangles: triangles.into_iter().map(|t| t.map(|i| i % count)).collect(),
                ..TriangleMesh::default()
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_mesh_comes_back(mesh in meshes()) {
        prop_assert_eq!(&through(&mesh, "ply"), &mesh);
        prop_assert_eq!(&through(&mesh, "obj"), &mesh);
        prop_assert_eq!(&through(&mesh, "off"), &mesh);
        let size = mesh.bounds().diagonal().max(1.0);
        for format in ["stl", "glb"] {
            let back = through(&mesh, format);
            prop_assert_eq!(back.triangles.len(), mesh.triangles.len());
            for t in 0..mesh.triangles.len() {
                for (p, q) in mesh.corners(t).into_iter().zip(back.corners(t)) {
                    prop_assert!(p.distance(q) < 4e-7 * size, "{} {} {}", format, p, q);
                }
            }
        }
    }

    #[test]
    fn damaged_files_never_panic(
        mesh in meshes(),
        format in 0..5usize,
        cut in any::<prop::sample::Index>(),
        hits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
    ) {
        let mut bytes = written(&mesh, FORMATS[format]);
        for (place, value) in hits {
            let at = place.index(bytes.len().min(1200));
            bytes[at] = value;
        }
        let _ = read_mesh_from_bytes(format!("a.{}", FORMATS[format]), &bytes);
        bytes.truncate(cut.index(bytes.len()));
        let _ = read_mesh_from_bytes(format!("a.{}", FORMATS[format]), &bytes);
    }

    #[test]
    fn noise_never_panics(noise in prop::collection::vec(any::<u8>(), 0..300), format in 0..5usize) {
        let starts: [&[u8]; 5] =
            [b"ply\nformat ascii 1.0\n", b"v 1 2 3\nf ", b"solid ", b"glTF\x02\0\0\0", b"COFF\n3 1 0\n"];
        let bytes = [starts[format], &noise].concat();
        let _ = read_mesh_from_bytes(format!("a.{}", FORMATS[format]), &bytes);
        let _ = read_mesh_from_bytes(format!("a.{}", FORMATS[format]), &noise);
    }
}
