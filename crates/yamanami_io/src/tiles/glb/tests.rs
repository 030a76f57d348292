//! What is written comes back, whatever the packing; and the document is as the extensions want it.

use super::*;
use crate::mesh_file::read_mesh_from_bytes;

const CLAIM: TileClaim = TileClaim { error_m: 0.5, height_range_m: Some([-3.0, 9.5]) };

/// A hill on a square of `side` samples, so many steps apart, with its low corner at `corner`.
fn hill(side: u32, spacing: i64, corner: [i64; 3]) -> LatticeMesh {
    let mut mesh = LatticeMesh { step_m: 0.125, ..LatticeMesh::default() };
    for y in 0..side {
        for x in 0..side {
            let height = i64::from((x * (side - 1 - x) + y * (side - 1 - y)) * 3);
            mesh.places.push([
                corner[0] + i64::from(x) * spacing,
                corner[1] + i64::from(y) * spacing,
                corner[2] + height,
            ]);
            let normal = DVec3::new(0.1 * f64::from(x % 3), -0.05, 1.0).normalize().as_vec3();
            mesh.normals.push(normal.to_array());
            mesh.colours.push([(x * 7 % 256) as u8, (y * 5 % 256) as u8, 30, 255]);
        }
    }
    for y in 0..side - 1 {
        for x in 0..side - 1 {
            let a = y * side + x;
            mesh.triangles.push([a, a + 1, a + side]);
            mesh.triangles.push([a + 1, a + side + 1, a + side]);
        }
    }
    mesh
}

/// Corners of all triangles as sorted numbers: what must come back whatever the order.
fn corners(places: impl Fn(u32) -> DVec3, triangles: &[[u32; 3]]) -> Vec<[[u64; 3]; 3]> {
    let bits = |i: u32| places(i).to_array().map(|c| (c + 0.0).to_bits());
    let mut all: Vec<[[u64; 3]; 3]> = triangles
        .iter()
        .map(|t| {
            let mut t = t.map(bits);
            let least = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
            t.rotate_left(least);
            t
        })
        .collect();
    all.sort_unstable();
    all
}

#[test]
fn every_packing_comes_back_to_the_last_bit() {
    // small, and too wide for sixteen bits; far from the origin
    for (spacing, corner) in [(40, [8_000_001, -77, 5]), (9_000, [-5, 123_456_789, -9_999_999])] {
        let mesh = hill(24, spacing, corner);
        let place = |i: u32| DVec3::from_array(mesh.places[i as usize].map(|c| c as f64 * mesh.step_m));
        let mut sizes = Vec::new();
        for packing in [GlbPacking::Plain, GlbPacking::Quantised, GlbPacking::Meshopt] {
            let file =
                encode_glb(&mesh, packing, &MeshMeta { title: "hill".to_owned(), ..MeshMeta::default() }, &CLAIM);
            let read = read_mesh_from_bytes("hill.glb", &file).unwrap();
            let found = corners(|i| read.positions[i as usize], &read.triangles);
            assert_eq!(found, corners(place, &mesh.triangles), "{packing:?} {spacing}");
            assert_eq!((read.normals.len(), read.colours.len()), (mesh.places.len(), mesh.places.len()));
            for (p, n) in read.positions.iter().zip(&read.normals) {
                let source = (0..mesh.places.len()).find(|&i| place(i as u32) == *p).unwrap();
                let dot: f32 = n.iter().zip(mesh.normals[source]).map(|(a, b)| a * b).sum();
                assert!(dot > 0.9995, "{packing:?} {dot}");
            }
            let facts = GlbFacts::of(&file).unwrap();
            assert_eq!((facts.triangles, facts.claim), (mesh.triangles.len() as u64, CLAIM));
            assert_eq!(facts.bounds, read.bounds());
            sizes.push(file.len());
        }
        assert!(sizes[0] > sizes[1] && sizes[1] > 2 * sizes[2], "{sizes:?}");
    }
}

#[test]
fn the_document_is_as_the_extensions_want() {
    let file = encode_glb(&hill(5, 40, [0; 3]), GlbPacking::Meshopt, &MeshMeta::default(), &CLAIM);
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let document: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
    assert_eq!(file.len(), u32::from_le_bytes(file[8..12].try_into().unwrap()) as usize);
    let required = json!(["KHR_mesh_quantization", "EXT_meshopt_compression"]);
    assert_eq!(document["extensionsRequired"], required);
    assert_eq!(document["buffers"][1]["extensions"]["EXT_meshopt_compression"], json!({"fallback": true}));
    // 25 places of 8 bytes, normals of 4, colours of 8, 96 corners of 2
    assert_eq!(document["buffers"][1]["byteLength"], json!(25 * 20 + 96 * 2));
    let view = &document["bufferViews"][1];
    assert_eq!((&view["buffer"], &view["byteOffset"], &view["byteStride"]), (&json!(1), &json!(200), &json!(4)));
    assert_eq!(view["extensions"]["EXT_meshopt_compression"]["filter"], json!("OCTAHEDRAL"));
    assert_eq!(document["accessors"][0]["max"][0], json!(160.0));
    assert_eq!(document["nodes"][0]["matrix"][6], json!(-0.125), "north is -z of glTF");
}

#[test]
fn nothing_is_a_scene_without_a_mesh() {
    let mut mesh = hill(2, 1, [0; 3]);
    mesh.places.iter_mut().for_each(|p| *p = [3, 3, 3]);
    let file = encode_glb(&mesh, GlbPacking::Meshopt, &MeshMeta::default(), &CLAIM);
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let document: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
    assert!(document.get("meshes").is_none() && document.get("buffers").is_none());
}
