//! Places and lines for maps in every format: what is kept, what it is taken for, and what is told of the rest.

use glam::DVec2;
use rusqlite::{Connection, params};
use std::path::{Path, PathBuf};
use yamanami_core::{LineKind, MapLine, NamedPlace, PlaceKind};
use yamanami_io::IoError;
use yamanami_io::crs::{from_epsg, from_lon_lat};
use yamanami_io::geodata::{
    LineReadOptions, PlaceReadOptions, ReadLines, ReadPlaces, read_lines, read_lines_from_bytes, read_places,
    read_places_from_bytes,
};

fn places(name: &str, text: impl AsRef<[u8]>) -> ReadPlaces {
    read_places_from_bytes(name, text.as_ref(), &PlaceReadOptions::default()).unwrap()
}

fn lines(name: &str, text: impl AsRef<[u8]>) -> ReadLines {
    read_lines_from_bytes(name, text.as_ref(), &LineReadOptions::default()).unwrap()
}

fn fuji() -> NamedPlace {
    NamedPlace {
        name: "富士山".to_owned(),
        reading: Some("ふじさん".to_owned()),
        position: DVec2::new(138.7275, 35.36),
        height_m: Some(3776.0),
        kind: PlaceKind::Summit,
        ..NamedPlace::default()
    }
}

#[test]
fn tables_in_both_languages_and_encodings() {
    let text = "名称,かな,緯度,経度,標高(m)\n富士山,ふじさん,35.36,138.7275,3776\n";
    assert_eq!(places("a.csv", text).places, [fuji()]);
    assert_eq!(places("a.csv", format!("\u{feff}# 出典\n{text}")).places, [fuji()]);
    assert_eq!(places("a.csv", encoding_rs::SHIFT_JIS.encode(text).0).places, [fuji()]);
    assert_eq!(places("a.csv", text.replace(',', ";").replace('\n', "\r\n")).places, [fuji()]);
    let english = "lon\tlat\tname\treading\televation\n138°43'39\"E\t35°21'36\"N\t富士山\tふじさん\t\"3,776 m\"\n";
    assert_eq!(places("a.tsv", english).places, [fuji()]);
}

#[test]
fn labels_without_coordinates_are_counted_and_told() {
    let text = "name,lat,lon\nA,35,138\nB,,138\nC,unknown,138\nD,95,138\n,35,138\n";
    let read = places("a.csv", text);
    assert_eq!(read.places.len(), 1);
    assert_eq!(
        read.notes,
        [
            "1 without a name skipped",
            "3 without usable coordinates skipped, the first at line 3: no latitude"
        ]
    );
}

#[test]
fn what_is_no_table_of_places_is_refused_in_a_line() {
    for (name, text, part) in [
        ("a.csv", "a,b\n1,2\n", "line 1: expected a header with name, lat, lon"),
        ("a.csv", "", "header"),
        ("a.csv", "name,lat,lon\nA,north,east\n", "line 2"),
        ("a.csv", "name,x,y\nA,293517,3915404\n", "no coordinate system is stated"),
        ("a.geojson", "{\"type\":", "line 1"),
        ("a.geojson", "{}", "1 without a name skipped"),
        ("a.gpx", "<kml></kml>", "<gpx>"),
        ("a.gpx", "<gpx><wpt lat=\"1\"", "line 1"),
        ("a.shp", "no shape", "9994"),
        ("a.kml", "", "ending"),
    ] {
        let error = read_places_from_bytes(name, text.as_bytes(), &PlaceReadOptions::default()).unwrap_err();
        let message = error.to_string();
        assert!(message.contains(part) && message.contains(name) && !message.contains('\n'), "{message}");
    }
}

#[test]
fn coordinates_of_other_systems_are_converted() {
    let utm = from_epsg(32654).unwrap();
    let [x, y] = from_lon_lat(&utm, 138.7275, 35.36).unwrap();
    let options = PlaceReadOptions { crs: Some(utm), kind: Some(PlaceKind::Other) };
    let read = read_places_from_bytes("a.csv", format!("name,x,y\nF,{x},{y}\n").as_bytes(), &options).unwrap();
    assert!((read.places[0].position - DVec2::new(138.7275, 35.36)).length() < 1e-9);
    assert_eq!(read.places[0].kind, PlaceKind::Other);
    let stated = format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::32654"}}}},
        "features":[{{"type":"Feature","properties":{{"name":"F","natural":"peak"}},"geometry":{{"type":"Point","coordinates":[{x},{y},3776]}}}}]}}"#
    );
    let read = places("a.geojson", &stated);
    assert!((read.places[0].position - DVec2::new(138.7275, 35.36)).length() < 1e-9);
    assert_eq!((read.places[0].height_m, read.places[0].kind), (Some(3776.0), PlaceKind::Summit));
    let strange = stated.replace("EPSG::32654", "EPSG::2285");
    let error = read_places_from_bytes("a.geojson", strange.as_bytes(), &PlaceReadOptions::default()).unwrap_err();
    assert!(matches!(error, IoError::Unsupported { .. }) && error.to_string().contains("EPSG::2285"), "{error}");
}

#[test]
fn lines_of_geojson_tell_what_they_are() {
    let text = r#"{"type":"FeatureCollection","features":[
      {"type":"Feature","properties":{"natural":"coastline","name":"駿河湾"},"geometry":{"type":"LineString","coordinates":[[138,35],[139,35]]}},
      {"type":"Feature","properties":{"natural":"water"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[0,1],[0,0]],[[0.1,0.1],[0.2,0.1],[0.1,0.2],[0.1,0.1]]]}},
      {"type":"Feature","properties":{"highway":"primary"},"geometry":{"type":"MultiLineString","coordinates":[[[0,0],[1,1]],[[5,5]]]}},
      {"type":"Feature","properties":{},"geometry":null},
      {"type":"Feature","properties":{"waterway":"river"},"geometry":{"type":"LineString","coordinates":[[138,"x"],[139,35]]}}]}"#;
    let read = lines("a.geojson", text);
    let found: Vec<(LineKind, usize, bool)> = read.lines.iter().map(|l| (l.kind, l.points.len(), l.is_area)).collect();
    let lake = (LineKind::Lake, 3, true);
    assert_eq!(found, [(LineKind::Coast, 2, false), lake, lake, (LineKind::Road, 2, false)]);
    assert_eq!(read.lines[0].name, "駿河湾");
    assert_eq!(read.notes.len(), 2);
    assert!(
        read.notes[1].starts_with("2 without usable coordinates skipped, the first at feature 4"),
        "{:?}",
        read.notes
    );
    let options = LineReadOptions { kind: Some(LineKind::Border), ..LineReadOptions::default() };
    let read = read_lines_from_bytes("a.geojson", text.as_bytes(), &options).unwrap();
    assert!(read.lines.iter().all(|line| line.kind == LineKind::Border));
}

const GPX: &str = r#"<?xml version="1.0"?><gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">
<metadata><name>of the file</name></metadata>
<wpt lat="35.36" lon="138.73"><ele>3776</ele><name>山頂</name><sym>Summit</sym></wpt>
<trk><name>吉田口</name><trkseg><trkpt lat="35.4" lon="138.73"><ele>2300</ele></trkpt><trkpt lat="35.36" lon="138.73"/></trkseg>
<trkseg><trkpt lat="35.36" lon="138.73"><name>of a point</name></trkpt><trkpt lat="35.37" lon="138.74"/></trkseg></trk>
<rte><name>R</name><rtept lat="1" lon="2"/><rtept lat="3" lon="4"/></rte></gpx>"#;

#[test]
fn tracks_routes_and_waypoints() {
    let read = lines("a.gpx", GPX);
    let found: Vec<(&str, usize)> = read.lines.iter().map(|l| (l.name.as_str(), l.points.len())).collect();
    assert_eq!(found, [("吉田口", 2), ("吉田口", 2), ("R", 2)]);
    assert!(read.lines.iter().all(|line| line.kind == LineKind::Track && !line.is_area));
    assert_eq!(read.lines[0].points[1], DVec2::new(138.73, 35.36));
    let [place] = &places("a.gpx", GPX).places[..] else { panic!("one place") };
    assert_eq!((place.name.as_str(), place.height_m, place.kind), ("山頂", Some(3776.0), PlaceKind::Summit));
}

#[test]
fn well_known_text_in_tables() {
    let text = "featurecla,name,WKT\nRailroad,A,\"LINESTRING (139 36,139.5 36.5)\"\nRailroad,B,LINESTRING\n";
    let read = lines("a.csv", text);
    assert_eq!((read.lines.len(), read.lines[0].kind, read.notes.len()), (1, LineKind::Railway, 1));
    assert_eq!(places("a.csv", "name,geom\nA,POINT Z(139 36 12)\n").places[0].height_m, Some(12.0));
}

/// A `.shp` of one shape of a kind, whose content behind the kind is given.
fn shp(kind: u32, contents: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = vec![0; 100];
    bytes[..4].copy_from_slice(&9994u32.to_be_bytes());
    bytes[32..36].copy_from_slice(&kind.to_le_bytes());
    for (k, content) in (1u32..).zip(contents) {
        bytes.extend(k.to_be_bytes());
        bytes.extend((content.len() as u32 / 2 + 2).to_be_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(content);
    }
    bytes
}

fn parts(parts: &[&[[f64; 2]]]) -> Vec<u8> {
    let mut content = vec![0; 32];
    let count: usize = parts.iter().map(|part| part.len()).sum();
    content.extend((parts.len() as u32).to_le_bytes());
    content.extend((count as u32).to_le_bytes());
    let mut first = 0u32;
    for part in parts {
        content.extend(first.to_le_bytes());
        first += part.len() as u32;
    }
    parts.iter().copied().flatten().flatten().for_each(|v| content.extend(v.to_le_bytes()));
    content
}

/// A `.dbf` of one text column.
fn dbf(column: &str, values: &[&[u8]]) -> Vec<u8> {
    let mut bytes = vec![0; 65];
    bytes[0] = 3;
    bytes[4..8].copy_from_slice(&(values.len() as u32).to_le_bytes());
    bytes[8..10].copy_from_slice(&65u16.to_le_bytes());
    bytes[10..12].copy_from_slice(&21u16.to_le_bytes());
    bytes[32..32 + column.len()].copy_from_slice(column.as_bytes());
    (bytes[43], bytes[48], bytes[64]) = (b'C', 20, 0x0d);
    for value in values {
        let mut field = [b' '; 21];
        field[1..=value.len()].copy_from_slice(value);
        bytes.extend(field);
    }
    bytes
}

const UTM_54N: &str = r#"PROJCS["WGS 84 / UTM zone 54N",GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]],UNIT["metre",1],AUTHORITY["EPSG","32654"]]"#;

#[test]
fn shapefiles_with_words_and_system() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rivers.shp");
    let utm = from_epsg(32654).unwrap();
    let at = |lon, lat| from_lon_lat(&utm, lon, lat).unwrap();
    let line = [at(138.5, 35.2), at(138.6, 35.1)];
    std::fs::write(&path, shp(3, &[parts(&[&line, &line]), parts(&[&line])])).unwrap();
    std::fs::write(path.with_extension("prj"), UTM_54N).unwrap();
    let (river, _, _) = encoding_rs::SHIFT_JIS.encode("富士川");
    std::fs::write(path.with_extension("dbf"), dbf("NAME", &[&river, b"B"])).unwrap();
    let read = read_lines(&path, &LineReadOptions::default()).unwrap();
    let names: Vec<&str> = read.lines.iter().map(|line| line.name.as_str()).collect();
    assert_eq!((names, read.notes.len()), (vec!["富士川", "富士川", "B"], 0));
    assert!((read.lines[0].points[0] - DVec2::new(138.5, 35.2)).length() < 1e-9);
    assert!(read.lines.iter().all(|line| line.kind == LineKind::River), "by the file's name");

    std::fs::write(path.with_extension("prj"), "PROJCS[\"Elsewhere\",UNIT[\"Foot_US\",0.3]]").unwrap();
    let message = read_lines(&path, &LineReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("Elsewhere") && message.contains("rivers.shp"), "{message}");

    std::fs::remove_file(path.with_extension("prj")).unwrap();
    let point = [138.7275f64.to_le_bytes(), 35.36f64.to_le_bytes()].concat();
    std::fs::write(&path, shp(1, &[point, Vec::new()])).unwrap();
    let read = read_places(&path, &PlaceReadOptions::default()).unwrap();
    assert_eq!((read.places.len(), read.places[0].name.as_str(), read.notes.len()), (1, "富士川", 2));
}

fn geopackage(path: &Path) {
    let db = Connection::open(path).unwrap();
    db.execute_batch(
        "CREATE TABLE gpkg_spatial_ref_sys(srs_name TEXT, srs_id INTEGER, organization TEXT, organization_coordsys_id INTEGER, definition TEXT);
         INSERT INTO gpkg_spatial_ref_sys VALUES('WGS 84', 4326, 'EPSG', 4326, '');
         CREATE TABLE gpkg_geometry_columns(table_name TEXT, column_name TEXT, geometry_type_name TEXT, srs_id INTEGER);
         INSERT INTO gpkg_geometry_columns VALUES('peaks \"of\" Japan', 'geom', 'POINT', 4326), ('lakes', 'shape', 'POLYGON', 4326);
         CREATE TABLE \"peaks \"\"of\"\" Japan\"(fid INTEGER PRIMARY KEY, geom BLOB, \"名称\" TEXT, ele REAL);
         CREATE TABLE lakes(fid INTEGER PRIMARY KEY, shape BLOB, name TEXT)",
    )
    .unwrap();
    let header = |body: &[u8]| [b"GP\0\x01\xe6\x10\0\0", body].concat();
    let doubles = |v: &[f64]| v.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let point = header(&[&[1, 1, 0, 0, 0][..], &doubles(&[138.7275, 35.36])].concat());
    let ring = doubles(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let lake = header(&[&[1, 3, 0, 0, 0, 1, 0, 0, 0, 4, 0, 0, 0][..], &ring].concat());
    let peaks = "INSERT INTO \"peaks \"\"of\"\" Japan\"(geom, 名称, ele) VALUES(?1, ?2, ?3)";
    db.execute(peaks, params![point, "富士山", 3776.0]).unwrap();
    db.execute(peaks, params![None::<Vec<u8>>, "無い山", 1.0]).unwrap();
    db.execute("INSERT INTO lakes(shape, name) VALUES(?1, 'L')", params![lake]).unwrap();
}

#[test]
fn all_tables_of_a_geopackage() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gpkg");
    geopackage(&path);
    let read = read_places(&path, &PlaceReadOptions::default()).unwrap();
    assert_eq!(read.places, [NamedPlace { reading: None, ..fuji() }]);
    assert!(read.notes[0].contains("row 2 of peaks \"of\" Japan"), "{:?}", read.notes);
    let read = read_lines(&path, &LineReadOptions::default()).unwrap();
    let points = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
    let lake = MapLine { points, is_area: true, kind: LineKind::Lake, name: "L".to_owned() };
    assert_eq!(read.lines, [lake]);
    assert!(read_lines(folder.path().join("b.gpkg"), &LineReadOptions::default()).is_err());
}

fn shared(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/vector").join(name);
    path.exists().then_some(path)
}

#[test]
fn the_shared_data_are_all_there() {
    if let Some(path) = shared("japan_mountains_1059_gsi.csv") {
        let read = read_places(path, &PlaceReadOptions::default()).unwrap();
        assert_eq!((read.places.len(), read.notes.len()), (1059, 0));
        let highest = read.places.iter().max_by(|a, b| a.height_m.unwrap().total_cmp(&b.height_m.unwrap())).unwrap();
        assert!(highest.name.starts_with("富士山") && highest.reading.is_some(), "{highest:?}");
    }
    if let Some(path) = shared("central_japan_coast_rivers_gshhg_full.geojson") {
        let read = read_lines(path, &LineReadOptions::default()).unwrap();
        let count = |kind: LineKind| read.lines.iter().filter(|line| line.kind == kind).count();
        assert_eq!((read.lines.len(), count(LineKind::Lake)), (208, 6));
        assert_eq!(count(LineKind::Coast) + count(LineKind::River), 202);
    }
    if let Some(path) = shared("central_japan_railroads_ne10m_wkt.csv") {
        let read = read_lines(path, &LineReadOptions::default()).unwrap();
        assert!(read.lines.len() >= 88 && read.lines.iter().all(|line| line.kind == LineKind::Railway));
    }
}

#[test]
fn damaged_files_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gpkg");
    geopackage(&path);
    let table =
        "名称,かな,緯度,経度,標高,WKT\n富士山,ふじさん,35°21'36\",138.7275,\"3,776\",\"POINT Z (138 35 3776)\"\n";
    let json = r#"{"type":"Feature","properties":{"name":"F","kind":"coast"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[0,1],[0,0]]]}}"#;
    let samples: Vec<(&str, Vec<u8>)> = vec![
        ("a.csv", table.into()),
        ("a.geojson", json.into()),
        ("a.gpx", GPX.into()),
        ("a.shp", shp(5, &[parts(&[&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]), parts(&[])])),
        ("a.gpkg", std::fs::read(&path).unwrap()),
        ("a.dbf", dbf("NAME", &[b"A", b"B"])),
    ];
    let mut seed = 1u64;
    let mut below = |limit: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % limit.max(1)
    };
    let shapes = folder.path().join("b.shp");
    std::fs::write(&shapes, &samples[3].1).unwrap();
    for round in 0..1200 {
        let (name, mut bytes) = samples[round % samples.len()].clone();
        for _ in 0..=below(4) {
            let at = below(bytes.len());
            match below(4) {
                0 => bytes.truncate(at),
                1 => bytes.extend_from_within(at..),
                _ if at < bytes.len() => bytes[at] = below(256) as u8,
                _ => {}
            }
        }
        // either something or an error of one line: never a panic
        let results = match name {
            "a.gpkg" => {
                std::fs::write(&path, bytes).unwrap();
                [
                    read_lines(&path, &LineReadOptions::default()).err(),
                    read_places(&path, &PlaceReadOptions::default()).err(),
                ]
            }
            "a.dbf" => {
                std::fs::write(shapes.with_extension("dbf"), bytes).unwrap();
                [read_lines(&shapes, &LineReadOptions::default()).err(), None]
            }
            name => [
                read_lines_from_bytes(name, &bytes, &LineReadOptions::default()).err(),
                read_places_from_bytes(name, &bytes, &PlaceReadOptions::default()).err(),
            ],
        };
        for error in results.into_iter().flatten() {
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
}
