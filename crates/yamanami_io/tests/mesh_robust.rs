//! Bad mesh files: one clear line each, no panic, and never much more memory than the file deserves.

mod damage;
mod mesh_samples;

use damage::{Noise, largest_piece};
use mesh_samples::{glb, samples};
use yamanami_io::mesh_file::{read_mesh_from_bytes, read_mesh_with_notes};

/// Most bytes at once for files of a few kilobytes; zstd's own window is 8 MiB at most there.
const MOST: usize = 32 << 20;

fn read(name: &str, bytes: &[u8]) -> Result<(), String> {
    let (read, largest) = largest_piece(|| read_mesh_from_bytes(name, bytes).map(|_| ()).map_err(|e| e.to_string()));
    assert!(largest < MOST, "{name}: {largest} bytes at once");
    if let Err(line) = &read {
        assert!(!line.contains('\n') && line.starts_with(name), "{line}");
    }
    read
}

#[test]
fn every_sample_is_read() {
    for (name, bytes) in samples() {
        assert_eq!(read(name, &bytes), Ok(()), "{name}");
    }
}

#[test]
fn bytes_flipped_cut_and_spliced_never_panic() {
    let samples = samples();
    let mut noise = Noise(0x5eed_5eed_5eed_5eed);
    for case in 0..30_000 {
        let name = samples[case % samples.len()].0;
        let bytes = noise.damaged(case % samples.len(), &samples);
        let _ = read(name, &bytes);
    }
}

/// A PLY of text: counts, then the values.
fn ply(vertices: &str, faces: &str, values: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
        element face {faces}\nproperty list uchar int vertex_indices\nend_header\n{values}"
    )
}

fn line(name: &str, bytes: &[u8]) -> String {
    read(name, bytes).unwrap_err()
}

#[test]
fn headers_that_announce_too_much_are_refused_at_once() {
    let huge = "1099511627776";
    let corners = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert_eq!(
        line("a.ply", ply(huge, "1", corners).as_bytes()),
        "a.ply: vertices: 1099511627776 is above the limit of 4294967294"
    );
    let message = line("a.ply", ply("3", huge, corners).as_bytes());
    assert_eq!(
        message,
        "a.ply: element 'face': expected at least 2199023255551 bytes for 1099511627776 records, found 9"
    );
    let binary = ply("3000000000", "1", "").replace("ascii", "binary_little_endian");
    assert!(line("a.ply", binary.as_bytes()).contains("at least 36000000000 bytes for 3000000000 records, found 0"));
    let list = ply("3", "1", "0 0 0\n1 0 0\n0 1 0\n255 0 1 2\n").replace("uchar int", "uint int");
    assert!(line("a.ply", list.replace("255 0", "4294967295 0").as_bytes()).contains("a list that fits in the"));
    let off = format!("OFF\n{huge} 1 0\n0 0 0\n");
    assert!(line("a.off", off.as_bytes()).contains("for 1099511627776 vertices and 1 faces, found 6"));
    let mut stl = vec![b' '; 80];
    stl.extend(u32::MAX.to_le_bytes());
    assert!(line("a.stl", &stl).contains("expected 4294967295 facets of 50 bytes, found 0 bytes"));
    let accessor = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"buffers":[{"byteLength":12}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"bufferViews":[{"buffer":0,"byteLength":12}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":1099511627776,"type":"VEC3"}]}"#;
    assert!(line("a.glb", &glb(accessor, &[0; 12])).contains("1099511627776 is above the limit of 768"));
    let zeros = accessor.replace(r#""bufferView":0,"componentType""#, r#""componentType""#);
    assert!(line("a.glb", &glb(&zeros, &[0; 12])).contains("1099511627776 is above the limit"));
}

#[test]
fn cut_files_say_where_they_end() {
    let binary = samples().into_iter().find(|(name, _)| *name == "f.ply").unwrap().1;
    let message = line("f.ply", &binary[..binary.len() - 5]);
    assert_eq!(message, "f.ply: face 1, 'vertex_indices': expected a number, found none");
    for (name, bytes) in samples() {
        for length in 0..bytes.len() {
            let _ = read(name, &bytes[..length]);
        }
    }
}

#[test]
fn wrong_corners_are_named_and_repeated_ones_are_data() {
    let body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    let faces = |faces: &str| ply("4", "2", &format!("{body}{faces}"));
    assert_eq!(
        line("a.ply", faces("3 0 1 2\n3 0 1 4\n").as_bytes()),
        "a.ply: face 1: expected corners below 4, found 4"
    );
    assert_eq!(
        line("a.ply", faces("3 0 1 2\n3 0 -1 3\n").as_bytes()),
        "a.ply: face 1: expected corners below 4, found -1"
    );
    assert_eq!(
        line("a.off", b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
        "a.off: line 5: expected 3 corners below 3, found '3 0 1 3'"
    );
    assert!(line("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n").contains("line 4: expected corners among the 3"));
    // a corner twice, a face twice, three faces on an edge: the model's own affair
    assert_eq!(read("a.ply", faces("3 0 0 1\n3 0 1 2\n").as_bytes()), Ok(()));
    assert_eq!(read("a.ply", faces("3 0 1 2\n3 2 1 0\n").as_bytes()), Ok(()));
    assert_eq!(read("a.off", b"OFF 5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 -1 0\n3 0 1 2\n3 0 1 3\n3 0 1 4\n"), Ok(()));
    // one triangle, and all in a plane
    assert_eq!(read("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), Ok(()));
}

#[test]
fn lost_vertices_stop_reading_only_where_a_face_uses_them() {
    let used = ply("3", "1", "0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n");
    assert_eq!(line("a.ply", used.as_bytes()), "a.ply: vertex 1: expected three finite numbers, found [NaN, 0, 0]");
    let unused = ply("5", "1", "nan nan nan\n0 0 0\n1 0 0\ninf 0 0\n0 1 0\n3 1 2 4\n");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    std::fs::write(&path, unused).unwrap();
    let read = read_mesh_with_notes(&path).unwrap();
    assert_eq!((read.mesh.positions.len(), read.mesh.triangles), (3, vec![[0, 1, 2]]));
    assert_eq!(read.notes, ["2 vertices without a place left out: no face uses them"]);
}

#[test]
fn meshes_without_faces_are_told_apart_from_broken_files() {
    let none = "expected at least one triangle, found";
    assert_eq!(line("a.ply", ply("0", "0", "").as_bytes()), format!("a.ply: faces: {none} 0 vertices, no face"));
    assert_eq!(line("a.off", b"OFF\n0 0 0\n"), format!("a.off: faces: {none} 0 vertices, no face"));
    assert_eq!(line("a.obj", b""), format!("a.obj: faces: {none} 0 vertices, no face"));
    assert_eq!(line("a.gltf", br#"{"asset":{"version":"2.0"}}"#), format!("a.gltf: faces: {none} 0 vertices, no face"));
    assert_eq!(line("a.off", b""), "a.off: line 1: expected 'OFF', found ''");
}

#[test]
fn what_is_not_read_is_named() {
    let draco = r#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]}"#;
    assert_eq!(
        line("a.gltf", draco.as_bytes()),
        "a.gltf: the glTF extension KHR_draco_mesh_compression that this file requires; export it without that extension"
    );
    assert_eq!(
        line("a.off", b"4OFF\n1 0 0\n"),
        "a.off: vertices in other than three dimensions; export it with x, y and z"
    );
    assert_eq!(line("a.off", b"OFF BINARY\n\0\0"), "a.off: binary OFF; export it as text");
    let packed = mesh_samples::packed_glb("EXT_meshopt_compression");
    let text = String::from_utf8_lossy(&packed).into_owned();
    assert!(text.contains("ATTRIBUTES"));
    let at = packed.windows(10).position(|w| w == b"ATTRIBUTES").unwrap();
    let mut other = packed.clone();
    other[at..at + 10].copy_from_slice(b"ATTRIBUTEX");
    assert!(line("a.glb", &other).contains("a mode of meshopt compression, found ATTRIBUTEX"));
    let mut damaged = packed;
    let last = damaged.len() - 1;
    damaged[last] = 1;
    assert!(line("a.glb", &damaged).contains("packed by meshopt, found a wrong table of codes"));
}
