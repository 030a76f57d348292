//! Meshes by stretches: the same as whole files in every form of PLY, and one line for what is damaged.

use glam::DVec3;
use proptest::prelude::*;
use std::io::Write;
use std::path::Path;
use yamanami_core::TriangleMesh;
use yamanami_io::IoError;
use yamanami_io::mesh_file::{MeshMeta, MeshStream, read_mesh, write_mesh};

fn streamed(path: &Path) -> Result<TriangleMesh, IoError> {
    let mut stream = MeshStream::open(path, path.parent().unwrap())?;
    let mut mesh = TriangleMesh::default();
    // faces first: a stream finds them without having passed the vertices
    stream.each_triangle_run(&mut |triangles| {
        mesh.triangles.extend_from_slice(triangles);
        Ok(())
    })?;
    for _ in 0..2 {
        mesh.positions.clear();
        mesh.colours.clear();
        stream.each_vertex_run(&mut |run| {
            assert_eq!(run.first as usize, mesh.positions.len());
            mesh.positions.extend_from_slice(run.positions);
            mesh.colours.extend_from_slice(run.colours);
            Ok(())
        })?;
    }
    assert_eq!(stream.vertices(), mesh.positions.len() as u64);
    assert!(!stream.has_colours() || mesh.colours.len() == mesh.positions.len());
    let mut again = 0;
    stream.each_triangle_run(&mut |triangles| {
        again += triangles.len();
        Ok(())
    })?;
    assert_eq!(again, mesh.triangles.len());
    Ok(mesh)
}

fn of_bytes(name: &str, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let found = streamed(&path);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no scratch file is left");
    found
}

fn line(name: &str, bytes: &[u8]) -> String {
    let line = of_bytes(name, bytes).unwrap_err().to_string();
    assert!(!line.contains('\n'), "{line}");
    line
}

/// More vertices and faces than a run or a window has.
fn large() -> TriangleMesh {
    let n = 250u32;
    let at = |i: u32| f64::from(i % n) * 0.1 + 1e6;
    let positions = (0..n * n).map(|i| DVec3::new(at(i), f64::from(i / n), f64::from(i * 37 % 101))).collect();
    let square = |i: u32| [[i, i + 1, i + n], [i + 1, i + n + 1, i + n]];
    let triangles = (0..n * (n - 1)).filter(|i| i % n != n - 1).flat_map(square).collect();
    TriangleMesh::new(positions, triangles)
}

/// A square in two halves and a triangle, as text after `header`, in one byte order.
fn binary(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement note 2\nproperty list uchar short words\nelement vertex 5\n\
         property uchar red\nproperty double z\nproperty float y\nproperty uchar green\nproperty uchar blue\n\
         property double x\nproperty uchar alpha\nelement face 3\nproperty uchar flags\n\
         property list ushort uint vertex_index\nproperty float quality\nend_header\n"
    )
    .into_bytes();
    let mut put = |raw: &[u8]| {
        let mut raw = raw.to_vec();
        if big {
            raw.reverse();
        }
        bytes.extend(raw);
    };
    for words in [0u8, 2] {
        put(&[words]);
        (0..words).for_each(|w| put(&i16::from(w).to_le_bytes()));
    }
    for v in 0..5u8 {
        put(&[v]);
        put(&(f64::from(v) + 0.1).to_le_bytes());
        put(&(f32::from(v) * 2.0).to_le_bytes());
        put(&[10 + v]);
        put(&[20 + v]);
        put(&(f64::from(v) * -3.0).to_le_bytes());
        put(&[250 + v]);
    }
    for corners in [&[0u32, 1, 2][..], &[0, 2, 3, 4], &[4, 1, 0]] {
        put(&[9]);
        put(&(corners.len() as u16).to_le_bytes());
        corners.iter().for_each(|c| put(&c.to_le_bytes()));
        put(&1f32.to_le_bytes());
    }
    bytes
}

#[test]
fn unusual_layouts_are_read() {
    for big in [false, true] {
        let mesh = of_bytes("a.ply", &binary(big)).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [4, 1, 0]]);
        let expected: Vec<DVec3> = (0..5).map(f64::from).map(|v| DVec3::new(v * -3.0, v * 2.0, v + 0.1)).collect();
        assert_eq!(mesh.positions, expected);
        assert_eq!(mesh.colours[3], [3, 13, 23, 253]);
    }
}

#[test]
fn a_large_mesh_streams_as_it_is_read_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let mesh = large();
    write_mesh(&path, &mesh, &MeshMeta::default()).unwrap();
    assert_eq!(streamed(&path).unwrap(), mesh);
    let packed = folder.path().join("b.ply.gz");
    let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    out.write_all(&std::fs::read(&path).unwrap()).unwrap();
    std::fs::write(&packed, out.finish().unwrap()).unwrap();
    assert_eq!(streamed(&packed).unwrap(), mesh);
    let packed = folder.path().join("c.ply.zst");
    write_mesh(&packed, &mesh, &MeshMeta::default()).unwrap();
    assert_eq!(streamed(&packed).unwrap(), mesh);
}

#[test]
fn what_does_not_come_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let mut mesh = large();
    let left_out = |mesh: &TriangleMesh| {
        write_mesh(&path, mesh, &MeshMeta::default()).unwrap();
        let stream = MeshStream::open(&path, folder.path()).unwrap();
        assert_eq!(stream.bytes(), std::fs::metadata(&path).unwrap().len());
        stream.left_out()
    };
    assert!(left_out(&mesh).is_empty());
    mesh.normals = vec![[0.0, 0.0, 1.0]; mesh.positions.len()];
    mesh.texcoords = vec![[0.5; 2]; mesh.positions.len()];
    mesh.colours = vec![[9; 4]; mesh.positions.len()];
    assert_eq!(left_out(&mesh), ["normals", "texture coordinates"]);
    assert_eq!(streamed(&path).unwrap().colours, mesh.colours);
}

#[test]
fn text_streams_with_any_space_between() {
    let mut text = String::from(
        "ply\nformat ascii 1.0\nelement vertex 62500\nproperty float x\nproperty float y\nproperty float z\n\
         element face 124002\nproperty list uchar int vertex_indices\nend_header\n",
    );
    let mesh = large();
    for (k, p) in mesh.positions.iter().enumerate() {
        text += &format!("{}{}\t{} {}\n", " ".repeat(k % 300), p.x, p.y, p.z);
    }
    for t in &mesh.triangles {
        text += &format!("3 {} {} {}\r\n", t[0], t[1], t[2]);
    }
    assert_eq!(of_bytes("a.ply", text.trim_end().as_bytes()).unwrap(), mesh);
}

#[test]
fn damage_is_told_with_its_place() {
    let bytes = binary(false);
    let short = line("a.ply", &bytes[..bytes.len() - 3]);
    assert!(short.contains("face 2, 'quality'"), "{short}");
    assert!(line("a.ply", &bytes[..bytes.len() - 60]).contains("element 'face'"));
    let mut nan = bytes.clone();
    let first = bytes.len() - 3 * 7 - 40 - 5 * 24;
    nan[first + 1..first + 9].copy_from_slice(&f64::NAN.to_le_bytes());
    assert!(line("a.ply", &nan).contains("vertex 0: expected three finite numbers"), "{}", line("a.ply", &nan));
    let mut outside = bytes.clone();
    let last = bytes.len() - 8;
    outside[last..last + 4].copy_from_slice(&5u32.to_le_bytes());
    assert!(line("a.ply", &outside).contains("face 2: expected corners below 5, found 5"));
    let head = |elements: &str| format!("ply\nformat ascii 1.0\n{elements}end_header\n0 0 0\n").into_bytes();
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let list = "property list uchar int vertex_indices\n";
    let huge = head(&format!("element vertex 1099511627776\n{xyz}element face 1\n{list}"));
    assert!(line("a.ply", &huge).contains("above the limit"));
    let many = head(&format!("element vertex 1\n{xyz}element face 1099511627776\n{list}"));
    assert!(line("a.ply", &many).contains("element 'face': expected at least"));
    assert!(line("a.ply", &head(&format!("element vertex 1\n{xyz}"))).contains("an element 'face'"));
    let strips = head(&format!("element vertex 1\n{xyz}element face 0\n{list}element tristrips 0\n{list}"));
    assert!(line("a.ply", &strips).contains("strips"));
    assert!(line("a.ply.gz", b"not packed").contains("a whole stream"));
    assert!(line("a.obj", b"v 0 0 0\n").contains("only PLY files are read piece by piece"));
    assert!(MeshStream::knows("a.PLY.gz") && !MeshStream::knows("a.stl") && !MeshStream::knows("ply"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn damaged_files_never_panic(
        big in any::<bool>(),
        cut in any::<prop::sample::Index>(),
        hits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
    ) {
        let mut bytes = binary(big);
        for (place, value) in hits {
            let at = place.index(bytes.len());
            bytes[at] = value;
        }
        let _ = of_bytes("a.ply", &bytes);
        bytes.truncate(cut.index(bytes.len()));
        let _ = of_bytes("a.ply", &bytes);
    }
}

#[test]
fn real_files_stream_as_they_are_read_whole() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/mesh");
    if !folder.is_dir() {
        println!("skipped: no test data beside the checkout");
        return;
    }
    let scratch = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if !MeshStream::knows(&path) {
            continue;
        }
        let whole = read_mesh(&path).unwrap();
        let mut stream = MeshStream::open(&path, scratch.path()).unwrap();
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        stream
            .each_vertex_run(&mut |run| {
                positions.extend_from_slice(run.positions);
                Ok(())
            })
            .unwrap();
        stream
            .each_triangle_run(&mut |run| {
                triangles.extend_from_slice(run);
                Ok(())
            })
            .unwrap();
        assert!(positions == whole.positions && triangles == whole.triangles, "{}", path.display());
    }
}
