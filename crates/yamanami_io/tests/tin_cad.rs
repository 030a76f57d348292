//! TINs of CAD drawings, hydraulic models and globes: what their files say is what is read, and what is written is read
//! again bit for bit.

mod tin_samples;

use glam::DVec3;
use proptest::prelude::*;
use std::path::PathBuf;
use tin_samples::{DRAWING, HYDRAULIC_MESH, grid_tile};
use yamanami_core::{Breakline, BreaklineKind, FOOT_M, Tin, US_SURVEY_FOOT_M};
use yamanami_io::IoError;
use yamanami_io::tin_file::{ReadTin, TinReadOptions, read_tin, read_tin_from_bytes, write_tin};

fn data(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/tin").join(name);
    if !path.exists() {
        println!("skipped: {name} is not here");
        return None;
    }
    Some(path)
}

fn read(name: &str, content: &str) -> Result<ReadTin, IoError> {
    read_tin_from_bytes(name, content.as_bytes(), &TinReadOptions::default())
}

/// Written to a file and read again.
fn again(tin: &Tin, extension: &str) -> ReadTin {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("a.{extension}"));
    write_tin(&path, tin).unwrap();
    read_tin(&path, &TinReadOptions::default()).unwrap()
}

/// Corners, name, kind and points: what of a TIN no format may lose.
fn essence(tin: &Tin) -> (Vec<[DVec3; 3]>, Vec<[DVec3; 3]>, Vec<Breakline>) {
    let corners = |t: &[u32; 3]| t.map(|i| tin.mesh.positions[i as usize]);
    (tin.mesh.triangles.iter().map(corners).collect(), tin.hidden.iter().map(corners).collect(), tin.breaklines.clone())
}

fn near(a: DVec3, b: DVec3, tolerance_m: f64) {
    assert!(a.distance(b) < tolerance_m, "{a} is not {b}");
}

#[test]
fn the_bridgeton_drawing() {
    let Some(path) = data("dxf_3dface_bridgeton_topo_3199f.dxf.gz") else { return };
    let options = TinReadOptions { unit_m: Some(US_SURVEY_FOOT_M), epsg: Some(6596), ..TinReadOptions::default() };
    let ReadTin { tin, notes, .. } = read_tin(&path, &options).unwrap();
    println!("{notes:#?}");
    assert_eq!((tin.mesh.triangles.len(), tin.hidden.len(), tin.name.as_str()), (3199, 0, "TOPO"));
    assert_eq!((tin.unit_m, tin.crs.epsg), (US_SURVEY_FOOT_M, Some(6596)));
    // the file has four digits of a foot
    let bounds = tin.mesh.bounds();
    println!("{} vertices, {bounds:?}", tin.mesh.positions.len());
    if let Some(sibling) = data("landxml12_bridgeton_topo_3199f.xml") {
        let sibling = read_tin(sibling, &TinReadOptions::default()).unwrap().tin;
        assert_eq!(sibling.mesh.positions.len(), tin.mesh.positions.len());
        assert_eq!(sibling.mesh.triangles.len(), tin.mesh.triangles.len());
        let sibling = sibling.mesh.bounds();
        near(bounds.min, sibling.min, 1e-4 * FOOT_M);
        near(bounds.max, sibling.max, 1e-4 * FOOT_M);
    }
    let read_again = again(&tin, "dxf.gz");
    assert_eq!(read_again.tin.mesh, tin.mesh);
}

#[test]
fn quantized_mesh_tiles() {
    for (name, vertices, triangles, heights, epsg, how) in [
        ("quantized_mesh_32bit_indices_131103f.terrain", 65_612, 131_103, [-32.7, 59.2], 32618, "by the centre"),
        ("quantized_mesh_z9_x759_y335_everest_4755f.terrain", 2460, 4755, [3727.5, 8777.1], 32645, "by its path"),
        ("quantized_mesh_octnormals_watermask_400f.terrain", 218, 400, [-311.3, 4352.2], 4087, "by the centre"),
    ] {
        let Some(path) = data(name) else { continue };
        let ReadTin { tin, notes, .. } = read_tin(&path, &TinReadOptions::default()).unwrap();
        println!("{notes:#?} {:?}", tin.mesh.bounds());
        assert_eq!(tin.mesh.positions.len(), vertices);
        assert_eq!(tin.mesh.triangles.len(), triangles);
        let bounds = tin.mesh.bounds();
        // the tile of half the globe has its extremes elsewhere
        if epsg != 4087 {
            assert!((bounds.min.z - heights[0]).abs() < 21.0 && (bounds.max.z - heights[1]).abs() < 0.2, "{bounds:?}");
        }
        assert!(bounds.min.z >= heights[0] - 0.1 && bounds.max.z <= heights[1] + 0.1, "{bounds:?}");
        assert_eq!(tin.crs.epsg, Some(epsg));
        assert!(notes[0].contains(how), "{notes:?}");
    }
}

#[test]
fn everything_in_a_drawing() {
    let ReadTin { tin, notes, .. } = read("kinds.dxf", DRAWING).unwrap();
    println!("{notes:#?}");
    assert_eq!(tin.unit_m, FOOT_M);
    // a quadrilateral and a triangle of a MESH, a 3DFACE of four corners, 2 x 3 quadrilaterals, a polyface's two
    assert_eq!(tin.mesh.triangles.len(), 2 + 1 + 2 + 12 + 3);
    assert_eq!(tin.hidden.len(), 1);
    let lines: Vec<_> = tin.breaklines.iter().map(|l| (l.name.as_str(), l.kind, l.points.len())).collect();
    assert_eq!(
        lines,
        [
            ("RIDGE", BreaklineKind::Hard, 2),
            ("border", BreaklineKind::Boundary, 4),
            ("soft", BreaklineKind::Soft, 3),
            ("0", BreaklineKind::Hard, 2),
        ]
    );
    assert_eq!(tin.breaklines[1].points[3], DVec3::new(0.0, 20.0, 7.5) * FOOT_M);
    assert!(notes.iter().any(|n| n == "1 block references (INSERT) not expanded"), "{notes:?}");
    assert!(notes.iter().any(|n| n.starts_with("faces of 3 layers joined: 0, MESH, 測量")), "{notes:?}");

    let options = TinReadOptions { surface: Some("測量".into()), unit_m: Some(1.0), ..TinReadOptions::default() };
    let one = read_tin_from_bytes("kinds.dxf", DRAWING.as_bytes(), &options).unwrap();
    assert_eq!((one.tin.mesh.triangles.len(), one.tin.name.as_str(), one.tin.unit_m), (2, "測量", 1.0));
    assert_eq!(one.other_surfaces, ["0", "MESH"]);
    let options = TinReadOptions { surface: Some("B".into()), ..TinReadOptions::default() };
    let error = read_tin_from_bytes("kinds.dxf", DRAWING.as_bytes(), &options).unwrap_err().to_string();
    assert_eq!(error, "kinds.dxf: layers: expected faces on layer 'B', found faces on 0, MESH, 測量");
}

#[test]
fn drawings_that_are_none() {
    for (content, message) in [
        ("AutoCAD Binary DXF\r\n\x1a\0", "a.dxf: binary DXF; save it as text DXF"),
        ("AC1015\0\0", "a.dxf: DWG; save it as text DXF"),
        ("", "a.dxf: entities: expected a 3DFACE, a mesh, or a POLYLINE that is one, found 0 lines, 0 references"),
        ("0\nSECTION\nx\n", "a.dxf: line 3: expected a group code, found 'x'"),
        ("0\nSECTION\n2", "a.dxf: line 3: expected the value of a group, found the end of the file"),
        ("0\nSECTION\n2\nENTITIES\n0\n3DFACE\n10\n1,5\n", "a.dxf: line 8: expected a number, found '1,5'"),
    ] {
        let error = read("a.dxf", content).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn faces_that_a_tin_cannot_have() {
    let face = |corners: [[f64; 3]; 4]| {
        let groups = corners
            .iter()
            .enumerate()
            .map(|(k, [x, y, z])| format!("{}\n{x}\n{}\n{y}\n{}\n{z}\n", 10 + k, 20 + k, 30 + k));
        format!("0\n3DFACE\n8\nA\n{}", groups.collect::<String>())
    };
    let [a, b, c] = [[0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [0.0, 1.0, 3.0]];
    let faces = [
        face([a, b, c, c]),
        face([a, c, b, b]),
        face([a, b, [1.0, 0.0, 9.0], a]),
        face([a, b, b, a]),
        face([a, b, [f64::NAN, 0.0, 9.0], a]),
        // the fourth corner may be missing, the third not
        face([a, b, c, c]).lines().take(22).collect::<Vec<_>>().join("\n") + "\n",
        face([a, b, c, c]).lines().take(16).collect::<Vec<_>>().join("\n") + "\n",
    ];
    let start = "0\nSECTION\n2\nENTITIES\n";
    let ReadTin { tin, notes, .. } = read("a.dxf", &format!("{start}{}0\nENDSEC\n0\nEOF\n\n", faces.concat())).unwrap();
    assert_eq!(tin.mesh.triangles, [[0, 1, 2]; 3]);
    assert_eq!(tin.mesh.positions.len(), 3);
    assert_eq!(
        notes,
        [
            "no unit is stated: metres assumed",
            "faces that were clockwise from above turned over: 1, first at line 34",
            "faces that are vertical or without an area dropped: 2, first at line 62",
            "faces with a corner that is no finite number dropped: 1, first at line 118",
            "faces of fewer than three corners dropped: 1, first at line 168",
        ]
    );
    let cut = read("a.dxf", &format!("{start}{}", faces[..2].concat())).unwrap();
    assert_eq!(cut.tin.mesh.triangles.len(), 1);
    assert_eq!(cut.notes[0], "the file ends at line 60 without EOF: what was open there is left out");
}

#[test]
fn a_mesh_of_triangles_and_quadrilaterals() {
    let ReadTin { tin, notes, .. } = read("a.2dm", HYDRAULIC_MESH).unwrap();
    assert_eq!(tin.name, "river bed");
    assert_eq!(tin.mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 4, 2], [0, 1, 7], [0, 1, 2], [0, 2, 3]]);
    assert_eq!(tin.mesh.positions.len(), 11, "the vertex of a line alone is none");
    let lines: Vec<_> = tin.breaklines.iter().map(|l| (l.name.as_str(), l.points.len(), l.points[0])).collect();
    assert_eq!(lines, [("left bank", 5, DVec3::new(0.0, 0.0, 1.5)), ("1", 2, DVec3::new(0.0, 0.0, 1.5))]);
    assert_eq!(
        notes,
        [
            "no unit is stated: metres assumed",
            "2 elements with nodes amid their sides read by their corners, first at line 7",
            "elements that are lines left out: 1, first at line 9",
            "elements with a node that is not there dropped: 1, first at line 10",
            "strings of fewer than two nodes or with one that is not there dropped: 1, first at line 26",
        ]
    );
    for (content, message) in [
        ("", "a.2dm: line 1: expected 'MESH2D', found the end of the file"),
        ("ND 1 0 0 0", "a.2dm: line 1: expected 'MESH2D', found 'ND 1 0 0 0'"),
        ("MESH2D\nND 1 0 x 0", "a.2dm: line 2: expected a node's number and three coordinates, found 'ND 1 0 x 0'"),
        (
            "MESH2D\nE3T 1 1 2",
            "a.2dm: line 2: expected an element's number and those of its 3 nodes, found 'E3T 1 1 2'",
        ),
        ("MESH2D\nNS 1 b", "a.2dm: line 2: expected numbers of nodes, found 'NS 1 b'"),
    ] {
        assert_eq!(read("a.2dm", content).unwrap_err().to_string(), message);
    }
}

#[test]
fn tiles_of_either_width_packed_or_not() {
    let options = TinReadOptions::default();
    let read = |name: &str, bytes: &[u8]| read_tin_from_bytes(name, bytes, &options).unwrap();
    let plain = read("a.terrain", &grid_tile(9, false));
    assert_eq!((plain.tin.mesh.positions.len(), plain.tin.mesh.triangles.len()), (81, 128));
    assert_eq!((plain.tin.crs.epsg, plain.tin.name.as_str()), (Some(32645), "a"));
    assert_eq!(
        plain.notes,
        ["tile 8/376/144: 84.375 to 85.078125 degrees east, 11.25 to 11.953125 north, by the centre in its header",]
    );
    let bounds = plain.tin.mesh.bounds();
    assert!(bounds.min.z >= 100.0 && bounds.max.z <= 900.0 && bounds.max.z - bounds.min.z > 700.0);
    // the south-west corner by PROJ 9
    near(plain.tin.mesh.positions[0].with_z(0.0), DVec3::new(213_386.003_827, 1_244_903.828_198, 0.0), 1e-4);

    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packer, &grid_tile(9, false)).unwrap();
    assert_eq!(read("a.terrain", &packer.finish().unwrap()), plain);

    let wide = read("a.terrain", &grid_tile(9, true));
    assert_eq!(wide.tin.mesh, plain.tin.mesh);
    assert_eq!(wide.notes[0], "corners of four bytes, which 81 vertices need not have");

    // 65,536 vertices are the most for two bytes: the last differences do not fit, and start from nothing again
    let full = read("a_z8_x376_y144.terrain", &grid_tile(256, false));
    assert_eq!((full.tin.mesh.positions.len(), full.tin.mesh.triangles.len()), (65_536, 130_050));
    let more = read("8/376/144.terrain", &grid_tile(257, true));
    assert_eq!((more.tin.mesh.positions.len(), more.tin.mesh.triangles.len()), (66_049, 131_072));
}

#[test]
fn a_geopackage_has_what_its_standard_asks() {
    let ReadTin { mut tin, .. } =
        read_tin_from_bytes("a.terrain", &grid_tile(5, false), &TinReadOptions::default()).unwrap();
    tin.hidden.extend(tin.mesh.triangles.pop());
    let points = tin.mesh.positions[..3].to_vec();
    tin.breaklines.push(Breakline { name: "尾根".into(), kind: BreaklineKind::Soft, points });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gpkg");
    std::fs::write(&path, "an old file").unwrap();
    write_tin(&path, &tin).unwrap();
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "nothing is left beside it");

    let db = rusqlite::Connection::open(&path).unwrap();
    let number = |query: &str| db.query_row(query, [], |row| row.get::<_, i64>(0)).unwrap();
    let text = |query: &str| db.query_row(query, [], |row| row.get::<_, String>(0)).unwrap();
    assert_eq!((number("PRAGMA application_id"), number("PRAGMA user_version")), (0x4750_4B47, 10_400));
    assert_eq!(text("PRAGMA integrity_check"), "ok");
    assert_eq!(number("SELECT count(*) FROM pragma_foreign_key_check"), 0);
    let definition = text("SELECT definition FROM gpkg_spatial_ref_sys WHERE srs_id = 32645");
    assert!(definition.starts_with("PROJCS[\"WGS 84 / UTM zone 45N\""), "{definition}");
    assert_eq!(number("SELECT count(*) FROM triangles"), 32);
    assert_eq!(number("SELECT count(*) FROM triangles WHERE hidden AND slope_deg BETWEEN 0 AND 90"), 1);
    assert_eq!(number("SELECT count(*) FROM rtree_triangles_geom"), 32);
    assert_eq!(number("SELECT count(*) FROM gpkg_geometry_columns WHERE srs_id = 32645 AND z = 1"), 2);
    assert_eq!(text("SELECT name || ' ' || kind FROM breaklines"), "尾根 soft");
    assert_eq!(text("SELECT identifier FROM gpkg_contents WHERE table_name = 'triangles'"), "a: triangles");
    let blob: Vec<u8> = db.query_row("SELECT geom FROM breaklines", [], |row| row.get(0)).unwrap();
    // magic, version, flags, CRS, box, byte order, type, count, points
    assert_eq!((&blob[..4], blob.len()), (b"GP\0\x03".as_slice(), 8 + 32 + 9 + 3 * 24));
    assert_eq!(blob[8 + 32 + 9..][16..24], tin.mesh.positions[0].z.to_le_bytes());

    let error = write_tin(folder.path().join("a.gpkg.gz"), &tin).unwrap_err().to_string();
    assert!(error.contains("a packed GeoPackage"), "{error}");
    let error = write_tin(folder.path().join("none/a.gpkg"), &tin).unwrap_err().to_string();
    assert!(!error.contains('\n') && error.contains("a.gpkg"), "{error}");
}

/// A TIN over a jittered grid, by the numbers of its unit.
fn tins() -> impl Strategy<Value = Tin> {
    let unit = prop::sample::select(vec![1.0, FOOT_M, US_SURVEY_FOOT_M, 0.001, 0.37]);
    let sizes = (2usize..7, 2usize..7);
    let jitter = prop::collection::vec(prop::array::uniform3(-0.2..0.2f64), 36);
    let origin = prop::array::uniform2(-1e6..1e6f64);
    let line = (".{0,12}", 0usize..3, prop::collection::vec(prop::array::uniform3(-1e5..1e5f64), 2..25));
    let rest = (prop::collection::vec(line, 0..4), any::<u64>(), "[ -~測ソ]{0,20}");
    (unit, sizes, jitter, origin, rest).prop_map(|(unit_m, (columns, rows), jitter, origin, (lines, which, name))| {
        let mut tin = Tin { name: name.trim().replace(['\\', '"'], "'"), unit_m, ..Tin::default() };
        let metres = |p: [f64; 3]| DVec3::from(p) * unit_m;
        for (k, [x, y, z]) in jitter[..columns * rows].iter().enumerate() {
            let (column, row) = ((k % columns) as f64, (k / columns) as f64);
            tin.mesh.positions.push(metres([origin[0] + (column + x) * 9.7, origin[1] + (row + y) * 9.7, z * 100.0]));
        }
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let a = (row * columns + column) as u32;
                let (b, c, d) = (a + 1, a + columns as u32 + 1, a + columns as u32);
                for triangle in [[a, b, c], [a, c, d]] {
                    let shown = a == 0 || which >> (a % 64) & 3 != 0;
                    if shown { tin.mesh.triangles.push(triangle) } else { tin.hidden.push(triangle) }
                }
            }
        }
        let kinds = [BreaklineKind::Hard, BreaklineKind::Soft, BreaklineKind::Boundary];
        tin.breaklines.extend(lines.into_iter().map(|(name, kind, points)| {
            Breakline {
                name: name
                    .chars()
                    .filter(|c| !c.is_control() && *c < '\u{ffff}' && !"\\\"".contains(*c))
                    .collect::<String>()
                    .trim()
                    .into(),
                kind: kinds[kind],
                points: points.into_iter().map(metres).collect(),
            }
        }));
        tin
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn drawings_keep_every_bit(tin in tins()) {
        let read = again(&tin, "dxf").tin;
        prop_assert_eq!(&read.name, &tin.name);
        let exact = tin.unit_m != 0.37;
        prop_assert_eq!(read.unit_m, if exact { tin.unit_m } else { 1.0 });
        prop_assert_eq!(essence(&read), essence(&tin));
    }

    #[test]
    fn hydraulic_meshes_keep_every_bit(tin in tins()) {
        let read = again(&tin, "2dm").tin;
        prop_assert_eq!(&read.name, &tin.name);
        prop_assert_eq!(&read.mesh, &tin.mesh);
        prop_assert_eq!(read.breaklines.len(), tin.breaklines.len());
        for (line, original) in read.breaklines.iter().zip(&tin.breaklines) {
            prop_assert_eq!(&line.points, &original.points);
            prop_assert_eq!(&line.name, &original.name);
        }
    }
}
