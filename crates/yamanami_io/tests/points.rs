//! Points and lines of every format: what is kept, in which axes and units, and what the notes say.

use glam::DVec3;
use proptest::prelude::*;
use std::io::Write;
use std::path::PathBuf;
use yamanami_core::{BreaklineKind, Crs, FOOT_M};
use yamanami_io::crs::from_epsg;
use yamanami_io::points::{
    ColumnOrder, LineReadOptions, PointReadOptions, ReadPoints, is_points_name, read_lines_from_bytes, read_points,
    read_points_from_bytes,
};

fn read(name: &str, bytes: &[u8], options: &PointReadOptions) -> Result<ReadPoints, String> {
    read_points_from_bytes(name, bytes, options).map_err(|e| e.to_string())
}

fn points(name: &str, text: &str) -> Vec<[f64; 3]> {
    let read = read(name, text.as_bytes(), &PointReadOptions::default()).unwrap();
    read.points_m.iter().map(DVec3::to_array).collect()
}

#[test]
fn tables_of_any_layout() {
    let expected = [[10.5, 20.25, 3.0], [11.5, 21.25, -4e-1]];
    for text in [
        "x,y,z\n10.5,20.25,3\n11.5,21.25,-0.4\n",
        "\u{feff}# made by hand\r\nX;Y;Z\r\n10.5;20.25;3\r\n\r\n11.5;21.25;-0.4\r\n",
        "10.5 20.25 3\n11.5   21.25\t-0.4",
        "10.5\t20.25\t3\t255\t0\n11.5\t21.25\t-.4\t255\t0\n",
        "//X Y Z Intensity\n10.5 20.25 3 7\n11.5 21.25 -0.4 7\n",
        "1,10.5,20.25,3,peg\n2,11.5,21.25,-0.4,peg\n",
        "A1 10.5 20.25 3\nA2 11.5 21.25 -0.4\n",
        "Point,Northing,Easting,Elevation,Code\n1,20.25,10.5,3,GR\n2,21.25,11.5,-0.4,GR\n",
        "点番,点名,X座標,Y座標,標高\n1,T1,20.25,10.5,3\n2,T2,21.25,11.5,-0.4\n",
        "点名,北,東,標高\nT1,20.25,10.5,3\nT2,21.25,11.5,-0.4\n",
        "\"z\",\"x\",\"y\"\n\"3\",\"10.5\",\"20.25\"\n-0.4,11.5,21.25\n",
    ] {
        assert_eq!(points("a.csv", text), expected, "{text}");
    }
}

#[test]
fn names_in_shift_jis() {
    for header in [
        &b"\x93_\x96\xbc,\x96\x6b,\x93\x8c,\x95\x57\x8d\x82"[..],
        b"No,X\x8d\xc0\x95\x57,Y\x8d\xc0\x95\x57,Z\x8d\xc0\x95\x57",
    ] {
        let bytes = [header, b"\nT1,20,10,3\n"].concat();
        let read = read("a.csv", &bytes, &PointReadOptions::default()).unwrap();
        assert_eq!(read.points_m, [DVec3::new(10.0, 20.0, 3.0)]);
    }
}

#[test]
fn the_first_coordinate_may_be_north() {
    let options =
        PointReadOptions { order: ColumnOrder::NorthEast, unit_m: Some(FOOT_M), ..PointReadOptions::default() };
    for text in ["1,200.5,100.5,10\n", "P,X,Y,Z\n1,200.5,100.5,10\n"] {
        let read = read("a.txt", text.as_bytes(), &options).unwrap();
        assert_eq!(read.points_m, [DVec3::new(100.5, 200.5, 10.0) * FOOT_M], "{text}");
        assert_eq!(read.unit_m, FOOT_M);
    }
    let read = read("a.csv", b"N,E,Z\n1,2,3", &options).unwrap();
    assert_eq!(read.points_m[0].x, 2.0 * FOOT_M, "a header that says it stands");
}

#[test]
fn sima_points() {
    let text = "G00,04,site,\nZ00,coordinates,\nA00,\nA01,1,T1,-35367.23,-5995.185,3.5,\nA01,2,T2,-35360,-5990,,\nA99,\nD00,1,lot,1,\n";
    let read =
        read("a.sim", text.as_bytes(), &PointReadOptions { epsg: Some(6677), ..PointReadOptions::default() }).unwrap();
    assert_eq!(read.points_m, [DVec3::new(-5995.185, -35367.23, 3.5)]);
    assert_eq!(read.crs.epsg, Some(6677));
    assert_eq!(read.notes, ["1 lines without three numbers skipped, the first line 5: 'A01,2,T2,-35360,-5990,,'"]);
}

#[test]
fn bad_rows_are_skipped_and_told() {
    let text = "x,y,z\n1,2,3\n1,2\n4,5,nan\n7,8,9\n";
    let read = read("a.csv", text.as_bytes(), &PointReadOptions::default()).unwrap();
    assert_eq!(read.points_m.len(), 2);
    assert_eq!(read.notes, ["2 lines without three numbers skipped, the first line 3: '1,2'"]);
}

#[test]
fn packed_text() {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(b"x,y,z\n1,2,3\n").unwrap();
    let read = read("a.xyz.gz", &packer.finish().unwrap(), &PointReadOptions::default()).unwrap();
    assert_eq!(read.points_m.len(), 1);
    assert!(is_points_name("b/A.XYZ.gz") && is_points_name("c.laz") && !is_points_name("c.xml"));
}

#[test]
fn errors_name_the_place() {
    let error = |name: &str, text: &str| read(name, text.as_bytes(), &PointReadOptions::default()).unwrap_err();
    assert!(error("a.csv", "").contains("a.csv: line 1: expected a header with x, y, z"));
    assert!(error("a.csv", "name,code\nfoo,bar\n").contains("found 'name,code'"));
    assert!(error("a.csv", "lat,lon,z\n35,139,3\n").contains("longitude and latitude"));
    assert!(error("a.csv", "x,y,z\n").contains("none that can be kept"));
    assert!(error("a.csv", &"9".repeat(70_000)).contains("64 KiB"));
    assert!(error("a.las", "LASF").contains("a LAS header"));
    let options = PointReadOptions { unit_m: Some(0.0), ..PointReadOptions::default() };
    assert!(read("a.csv", b"1,2,3", &options).unwrap_err().contains("metres in a unit"));
}

#[test]
fn lines_of_a_table() {
    let text = "line,x,y,z\nridge,0,0,1\nridge,1,0,2\nbank,5,5,5\nbank,6,5,5\nbank,7,5,5\nridge,9,9,9\n";
    let read = read_lines_from_bytes("a.csv", text.as_bytes(), &LineReadOptions::default()).unwrap();
    let names: Vec<_> = read.lines.iter().map(|l| (l.name.as_str(), l.points.len())).collect();
    assert_eq!(names, [("ridge", 2), ("bank", 3)]);
    assert_eq!(read.notes, ["1 lines of a single point dropped"]);
    let bare =
        read_lines_from_bytes("a.txt", b"7 0 0 1\n7 1 0 2\n8 0 1 2\n8 3 4 5\n", &LineReadOptions::default()).unwrap();
    assert_eq!(bare.lines.len(), 2);
    assert_eq!(bare.lines[1].points[1], DVec3::new(3.0, 4.0, 5.0));
}

#[test]
fn lines_of_geojson() {
    let text = r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{"name":"dam","kind":"soft"},"geometry":{"type":"LineString","coordinates":[[1,2,3],[4,5,6]]}},
        {"type":"Feature","properties":null,"geometry":{"type":"Polygon","coordinates":[[[0,0],[9,0],[9,9],[0,0]]]}},
        {"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[0,0]}},
        {"type":"Feature","properties":{},"geometry":null}]}"#;
    let options = LineReadOptions { kind: BreaklineKind::Boundary, ..LineReadOptions::default() };
    let read = read_lines_from_bytes("a.geojson", text.as_bytes(), &options).unwrap();
    assert_eq!((read.lines[0].name.as_str(), read.lines[0].kind), ("dam", BreaklineKind::Soft));
    assert_eq!(read.lines[0].points, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]);
    assert_eq!((read.lines[1].kind, read.lines[1].points.len()), (BreaklineKind::Boundary, 4));
    assert!(read.lines[1].points[0].z.is_nan());
    assert_eq!(read.notes.len(), 1);
}

#[test]
fn degrees_are_projected_into_the_crs_of_the_points() {
    let text = r#"{"type":"LineString","coordinates":[[139.7671,35.6812,3.5],[139.77,35.69]]}"#;
    let crs = from_epsg(6677).unwrap();
    let options = LineReadOptions { crs, unit_m: Some(FOOT_M), ..LineReadOptions::default() };
    let line = &read_lines_from_bytes("a.json", text.as_bytes(), &options).unwrap().lines[0];
    assert!((line.points[0] - DVec3::new(-5995.18517, -35367.23013, 3.5)).length() < 1e-4, "{:?}", line.points[0]);
    let plain = read_lines_from_bytes("a.json", text.as_bytes(), &LineReadOptions::default()).unwrap();
    assert_eq!(plain.lines[0].points[0].x, 139.7671, "without a CRS there is nothing to project into");
}

/// A LAS 1.2 file of format 1: x, y, z in hundredths, class.
fn las(points: &[([i32; 3], u8)]) -> Vec<u8> {
    let mut file = vec![0; 227];
    file[..4].copy_from_slice(b"LASF");
    (file[24], file[25]) = (1, 2);
    file[94..96].copy_from_slice(&227u16.to_le_bytes());
    file[96..100].copy_from_slice(&227u32.to_le_bytes());
    file[104] = 1;
    file[105..107].copy_from_slice(&28u16.to_le_bytes());
    file[107..111].copy_from_slice(&(points.len() as u32).to_le_bytes());
    for (k, value) in [0.01, 0.01, 0.01, 1000.0, 2000.0, 0.0].into_iter().enumerate() {
        file[131 + 8 * k..139 + 8 * k].copy_from_slice(&f64::to_le_bytes(value));
    }
    for (place, class) in points {
        let mut record = [0; 28];
        for k in 0..3 {
            record[4 * k..4 * k + 4].copy_from_slice(&place[k].to_le_bytes());
        }
        record[15] = *class;
        file.extend(record);
    }
    file
}

#[test]
fn ground_of_a_cloud() {
    let cloud = las(&[
        ([0, 0, 900], 1),
        ([100, 200, 300], 2),
        ([5, 5, 5], 0x80 | 2),
        ([200, 200, 350], 2),
        ([1, 1, 1], 5),
    ]);
    let read_as = |options: &PointReadOptions, cloud: &[u8]| read("a.las", cloud, options).unwrap();
    let ground = read_as(&PointReadOptions::default(), &cloud);
    assert_eq!(ground.points_m, [DVec3::new(1001.0, 2002.0, 3.0), DVec3::new(1002.0, 2002.0, 3.5)]);
    let notes = [
        "the file does not say its unit: taken as metres",
        "ground: 2 points, 2 others left out",
        "1 withdrawn points left out",
    ];
    assert_eq!(ground.notes, notes);
    let classes = PointReadOptions { classes: Some(vec![1, 5]), ..PointReadOptions::default() };
    assert_eq!(read_as(&classes, &cloud).points_m.len(), 2);
    let unclassed = las(&[([0, 0, 900], 1), ([0, 0, -90_000], 7), ([100, 200, 300], 0)]);
    assert_eq!(read_as(&PointReadOptions::default(), &unclassed).points_m.len(), 2);
    let cut = read_as(&PointReadOptions::default(), &cloud[..cloud.len() - 20]);
    assert!(cut.notes.contains(&"the points end after 4 of 5".to_owned()), "{:?}", cut.notes);
}

fn data(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/tin").join(name);
    path.exists().then_some(path)
}

#[test]
fn real_clouds() {
    let Some(path) = data("autzen_trim_110000pts.laz") else { return };
    let read = read_points(path, &PointReadOptions::default()).unwrap();
    assert_eq!((read.points_m.len(), read.unit_m), (26_107, FOOT_M));
    assert_eq!(read.crs.name, "NAD_1983_HARN_Lambert_Conformal_Conic");
    let heights = read.points_m.iter().map(|p| p.z / FOOT_M);
    let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
    assert!(low > 405.0 && high < 522.0, "{low} to {high} ft");
    let Some(path) = data("autzen_thin_10653pts_full_image_extent.las") else { return };
    assert_eq!(read_points(&path, &PointReadOptions::default()).unwrap().points_m.len(), 2719);
    let all = PointReadOptions { classes: Some((0..32).collect()), ..PointReadOptions::default() };
    assert_eq!(read_points(&path, &all).unwrap().points_m.len(), 10_653);
}

#[test]
fn broken_clouds_are_errors_or_less() {
    for name in ["autzen_trim_110000pts.laz", "autzen_thin_10653pts_full_image_extent.las"] {
        let Some(whole) = data(name).map(|path| std::fs::read(path).unwrap()) else { return };
        for cut in [0, 3, 100, 226, 300, 1500, 2144, 2150, 2200, 20_000] {
            let _ = read(name, &whole[..cut], &PointReadOptions::default());
        }
        let mut broken = whole[..whole.len().min(30_000)].to_vec();
        for k in 0..120 {
            let at = (k * 7919) % if k % 2 == 0 { 2400 } else { broken.len() };
            let was = std::mem::replace(&mut broken[at], (k * 31) as u8 | 0x80);
            let _ = read(name, &broken, &PointReadOptions::default());
            broken[at] = was;
        }
    }
}

proptest! {
    #[test]
    fn any_bytes_are_points_or_one_line(bytes in prop::collection::vec(any::<u8>(), 0..400), kind in 0..6usize) {
        let name = ["a.csv", "a.sim", "a.las", "a.laz", "a.txt.gz", "a.xyz.zst"][kind];
        if let Err(message) = read(name, &bytes, &PointReadOptions::default()) {
            prop_assert!(!message.contains('\n') && message.contains(name));
        }
        let mut headed = las(&[([1, 2, 3], 2)]);
        for (at, &byte) in bytes.iter().enumerate().take(3) {
            headed[94 + at * 7 % 130] = byte;
        }
        let _ = read("a.las", &headed, &PointReadOptions::default());
        let _ = read("a.laz", &headed, &PointReadOptions::default());
        let options = LineReadOptions { crs: Crs { epsg: Some(6677), ..Crs::default() }, ..LineReadOptions::default() };
        let _ = read_lines_from_bytes(["a.csv", "a.geojson"][kind % 2], &bytes, &options);
    }

    #[test]
    fn written_rows_come_back(rows in prop::collection::vec((-1e7..1e7f64, -1e7..1e7f64, -1e3..9e3f64), 1..50), kind in 0..4usize) {
        let delimiter = [",", ";", "\t", " "][kind];
        let mut text = ["x", "y", "z"].join(delimiter) + "\n";
        for (x, y, z) in &rows {
            text += &format!("{x}{delimiter}{y}{delimiter}{z}\n");
        }
        let expected: Vec<[f64; 3]> = rows.iter().map(|&(x, y, z)| [x, y, z]).collect();
        prop_assert_eq!(points("a.csv", &text), expected);
    }
}
