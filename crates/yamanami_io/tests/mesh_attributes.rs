//! Colours, texture coordinates and materials: what each format carries comes back, here and through other formats.

mod mesh_samples;

use glam::DVec3;
use mesh_samples::*;
use yamanami_core::{Material, TriangleMesh};
use yamanami_io::mesh_file::{MeshMeta, read_mesh, read_mesh_from_bytes, read_mesh_with_notes, write_mesh};

/// Writes in a folder and reads again, files beside it included.
fn through(mesh: &TriangleMesh, format: &str) -> TriangleMesh {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("roof.{format}"));
    write_mesh(&path, mesh, &MeshMeta::default()).unwrap();
    let read = read_mesh_with_notes(&path).unwrap();
    assert_eq!(read.notes, [""; 0], "{format}");
    read.mesh
}

#[test]
fn every_format_keeps_what_it_can() {
    let roof = roof();
    assert_eq!(through(&roof, "glb"), roof);
    for packed in ["obj", "obj.gz", "obj.zst"] {
        let obj = through(&roof, packed);
        let mut expected = roof.clone();
        expected.materials[1].texture.as_mut().unwrap().name = "green_copper.jpg".into();
        assert_eq!(obj, expected);
    }
    for packed in ["ply", "ply.gz", "ply.zst"] {
        let ply = through(&roof, packed);
        let pictures = |mesh: &TriangleMesh| -> Vec<_> {
            mesh.materials.iter().map(|m| m.texture.as_ref().unwrap().bytes.clone()).collect()
        };
        assert_eq!(pictures(&ply), pictures(&roof));
        assert_eq!(TriangleMesh { materials: roof.materials.clone(), ..ply }, roof);
    }
    let off = through(&roof, "off");
    assert_eq!(TriangleMesh { materials: roof.materials.clone(), material_of: roof.material_of.clone(), ..off }, roof);
}

#[test]
fn pictures_beside_a_mesh_never_replace_others() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("tiles.png"), "mine").unwrap();
    let mut mesh = roof();
    // an evil name, and the same picture under two names
    mesh.materials[1].texture.as_mut().unwrap().name = "../../evil.jpg".into();
    mesh.materials.push(Material { name: "tiles".into(), ..mesh.materials[0].clone() });
    mesh.material_of[1] = 2;
    write_mesh(at("small roof.obj"), &mesh, &MeshMeta::default()).unwrap();
    let mut names: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["evil.jpg", "small roof.mtl", "small roof.obj", "small_roof_tiles.png", "tiles.png"]);
    assert_eq!(std::fs::read(at("tiles.png")).unwrap(), b"mine");
    let back = read_mesh(at("small roof.obj")).unwrap();
    let names: Vec<&str> = back.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["tiles", "tiles_2", "copper"]);
    assert_eq!(back.materials[1].texture.as_ref().unwrap().bytes, picture("png", 1));
}

#[test]
fn corners_with_other_texture_coordinates_become_vertices() {
    let mesh = read_mesh_from_bytes("b.ply", CORNER_PLY.as_bytes()).unwrap();
    // corner 1 is at (1, 0) of one picture and at (0, 0) of the other; corner 2 is at (1, 1) of both
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [5, 4, 2], [4, 2, 1]]);
    assert_eq!(mesh.positions[5], mesh.positions[1]);
    assert_eq!(mesh.texcoords[1], [1.0, 1.0]);
    assert_eq!(mesh.texcoords[5], [0.0, 1.0]);
    assert_eq!(mesh.texcoords[2], [1.0, 0.0], "v runs down here");
    assert_eq!(mesh.colours[1], [0, 128, 0, 255]);
    assert_eq!(mesh.colours.len(), 6);
    let names: Vec<&str> = mesh.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!((names, mesh.material_of), (vec!["a.png", "b b.png", ""], vec![0, 0, 1, 2]));

    let mesh = read_mesh_from_bytes("a.obj", PAINTED_OBJ.as_bytes()).unwrap();
    assert_eq!(mesh.positions.len(), 7);
    assert_eq!(mesh.triangles[..3], [[0, 1, 2], [0, 2, 3], [5, 4, 6]]);
    assert_eq!((mesh.texcoords[2], mesh.texcoords[5]), ([1.0, 0.0], [0.0, 1.0]));
    assert_eq!(mesh.colours[..4], [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]]);
    assert_eq!((mesh.materials.len(), &mesh.material_of[..3]), (2, &[0, 0, 1][..]));
    assert!(mesh.normals.is_empty(), "the fifth corner has none");
}

#[test]
fn normals_that_differ_at_a_vertex_do_not_tear_a_scan() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\nvn 0 0 1\nf 1//1 2//1 3//3\nf 1//2 4//2 3//3\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, obj).unwrap();
    let read = read_mesh_with_notes(&path).unwrap();
    assert_eq!((read.mesh.positions.len(), read.mesh.normals.len()), (4, 0));
    assert_eq!(read.notes, ["normals not read: they differ between the faces of a vertex"]);
}

#[test]
fn materials_of_other_programs_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("maps")).unwrap();
    std::fs::write(at("maps/a b.png"), picture("png", 7)).unwrap();
    let mtl = "newmtl wall\r\nKd 0 0 0\r\nTr 0.25\r\nmap_Kd -s 1 1 1 C:\\scans\\maps\\absent.png\r\n\
        newmtl roof\r\nKd 0.5\r\nd 0.5\r\nmap_Kd maps\\a b.png\r\nnewmtl door\r\nKd 0 0 0\r\nmap_Kd ../../secret.png\r\n";
    std::fs::write(at("my lib.mtl"), mtl).unwrap();
    let obj = "mtllib my lib.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl wall\nf 1 2 3\nusemtl roof\nf 1 2 3\n\
        usemtl door\nf 1 2 3\nusemtl none such\nf 1 2 3\n";
    std::fs::write(at("a.obj"), obj).unwrap();
    let read = read_mesh_with_notes(at("a.obj")).unwrap();
    let materials = &read.mesh.materials;
    assert_eq!(read.mesh.material_of, [0, 1, 2, 3, 4]);
    assert_eq!(materials[0], Material::default());
    assert_eq!(materials[1].base_colour, [0.0, 0.0, 0.0, 0.75]);
    assert_eq!(materials[2].base_colour, [0.5; 4]);
    assert_eq!(materials[2].texture.as_ref().unwrap().bytes, picture("png", 7));
    assert_eq!(materials[4].name, "none such");
    assert_eq!(read.notes.len(), 2, "{:?}", read.notes);
    assert!(read.notes[1].contains("texture '../../secret.png' not read: it lies outside"), "{:?}", read.notes);
    // from bytes alone the libraries are missing, and said to be
    assert_eq!(read_mesh_from_bytes("a.obj", obj.as_bytes()).unwrap().materials.len(), 5);
}

#[test]
fn off_files_of_all_keywords_are_read() {
    let plain = "OFF 4 1 0\n# a square\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    let mesh = read_mesh_from_bytes("a.off", plain.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    let bare = "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1 0 0\n";
    assert_eq!(read_mesh_from_bytes("a.off", bare.as_bytes()).unwrap().triangles, [[0, 1, 2]]);
    let real = "COFF\n3 1 0\n0 0 0 0.5 0 1\n1 0 0 0 0 0\n0 1 0 1.0 1 1\n3 0 1 2\n";
    let mesh = read_mesh_from_bytes("a.off", real.as_bytes()).unwrap();
    assert_eq!(mesh.colours, [[128, 0, 255, 255], [0, 0, 0, 255], [255; 4]]);
    let (_, all) = samples().into_iter().find(|(name, _)| *name == "a.off").unwrap();
    let mesh = read_mesh_from_bytes("a.off", &all).unwrap();
    assert_eq!((mesh.colours[1], mesh.texcoords[2], mesh.normals.len()), ([0, 255, 0, 9], [1.0, 0.0], 4));
}

#[test]
fn gltf_reads_text_sparse_and_packed_parts() {
    let mesh = read_mesh_from_bytes("a.gltf", sparse_gltf().as_bytes()).unwrap();
    // the sparse part's (0, 2, 0) is y up
    assert_eq!(mesh.corners(0), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]].map(DVec3::from));

    for extension in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let mesh = read_mesh_from_bytes("a.glb", &packed_glb(extension)).unwrap();
        let (_, vertices, count, stride) = stream("version 1, level 3");
        let (_, corners, corner_count, _) = stream("triangles in cache order");
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (count, corner_count / 3));
        let word = |v: usize, k: usize| {
            let at = v * stride + 8 + 2 * k;
            f64::from(u16::from_le_bytes([vertices[at], vertices[at + 1]]))
        };
        let expected = |v: usize| DVec3::new(word(v, 0), -word(v, 2), word(v, 1));
        assert!((0..count).all(|v| mesh.positions[v] == expected(v)));
        let index = |k: usize| u32::from_le_bytes([corners[4 * k], corners[4 * k + 1], corners[4 * k + 2], 0]);
        assert!(mesh.triangles.iter().flatten().enumerate().all(|(k, &i)| index(k) == i));
    }
}

#[test]
fn gltf_follows_files_beside_it_and_none_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("model");
    std::fs::create_dir(&inner).unwrap();
    let mut buffer = Vec::new();
    for c in [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        buffer.extend(c.to_le_bytes());
    }
    buffer.extend([0, 0, 128, 0, 255, 0]);
    std::fs::write(inner.join("my buffer.bin"), &buffer).unwrap();
    std::fs::write(folder.path().join("outside.bin"), &buffer).unwrap();
    std::fs::write(inner.join("skin.png"), picture("png", 3)).unwrap();
    let document = |uri: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"extensionsUsed":["KHR_texture_transform"],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_1":1}},"material":0}}]}}],
            "materials":[{{"name":"skin","pbrMetallicRoughness":{{"baseColorFactor":[0.5,0.25,1,1],"baseColorTexture":
            {{"index":0,"texCoord":1,"extensions":{{"KHR_texture_transform":{{"offset":[0.5,0],"scale":[2,4]}}}}}}}}}}],
            "textures":[{{"source":0}}],"images":[{{"uri":"skin.png"}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
            {{"bufferView":1,"componentType":5121,"normalized":true,"count":3,"type":"VEC2"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
            "buffers":[{{"uri":"{uri}","byteLength":42}}]}}"#
        )
    };
    let path = inner.join("a.gltf");
    std::fs::write(&path, document("my%20buffer.bin")).unwrap();
    let read = read_mesh_with_notes(&path).unwrap();
    assert_eq!(read.notes, [""; 0]);
    let mesh = read.mesh;
    assert_eq!(mesh.texcoords, [[0.5, 0.0], [0.5 + 2.0 * 128.0 / 255.0, 0.0], [2.5, 0.0]]);
    assert_eq!(mesh.materials[0].base_colour, [0.5, 0.25, 1.0, 1.0]);
    assert_eq!(mesh.materials[0].texture.as_ref().map(|t| t.name.as_str()), Some("skin.png"));
    assert_eq!(through(&mesh, "glb"), mesh);
    for outside in ["../outside.bin", "/etc/passwd", "a/../../outside.bin"] {
        std::fs::write(&path, document(outside)).unwrap();
        let line = read_mesh(&path).unwrap_err().to_string();
        assert!(line.contains("buffer 0 cannot be read: it lies outside the file's folder"), "{line}");
    }
    std::fs::write(&path, document("absent.bin")).unwrap();
    assert!(read_mesh(&path).unwrap_err().to_string().contains("buffer 0 cannot be read"));
    let line = read_mesh_from_bytes("a.gltf", document("my%20buffer.bin").as_bytes()).unwrap_err().to_string();
    assert!(line.contains("only the bytes of one file were given"), "{line}");
}

#[test]
fn real_scans_keep_colours_and_texture_through_every_format() {
    let Some(folder) = shared_data() else { return };
    for name in ["gargoyle_50000f_vertexcolour.ply", "pagoda_modelled_29696f.ply"] {
        let mesh = read_mesh(folder.join("mesh").join(name)).unwrap();
        assert!(mesh.colours.len() + mesh.texcoords.len() == mesh.positions.len());
        for format in ["ply", "obj", "off"] {
            assert!(through(&mesh, format) == mesh, "{name} {format}");
        }
        let glb = through(&mesh, "glb");
        assert!(glb.colours == mesh.colours && glb.texcoords == mesh.texcoords && glb.triangles == mesh.triangles);
        let far = |k: usize| glb.positions[k].distance(mesh.positions[k]);
        assert!((0..mesh.positions.len()).all(|k| far(k) < 1e-7 * mesh.bounds().diagonal()));
        let back = through(&glb, "ply");
        assert!(back.colours == mesh.colours && back.triangles == mesh.triangles);
        assert_eq!(through(&mesh, "stl").triangles.len(), mesh.triangles.len());
    }
}
