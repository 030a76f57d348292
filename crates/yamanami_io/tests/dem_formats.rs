//! Every format of elevation grids, on small files: values, places, traps and clear errors.

mod dem_samples;

use dem_samples::{asc, dted, fg_gml, fixture, full_fg_gml, gzip, height, hgt, png, terrarium, zip};
use std::path::Path;
use yamanami_core::{Crs, HeightField, HeightSource, Window};
use yamanami_io::dem::{self, DemFile, OpenOptions, TileEncoding};
use yamanami_io::{IoError, crs};

fn from(name: &str, bytes: impl Into<Vec<u8>>) -> Result<DemFile, IoError> {
    dem::from_bytes(name, bytes.into(), &OpenOptions::default())
}

fn field(name: &str, bytes: impl Into<Vec<u8>>) -> HeightField {
    from(name, bytes).unwrap_or_else(|e| panic!("{e}")).read_all().unwrap_or_else(|e| panic!("{e}"))
}

/// The error of opening or reading.
fn error(name: &str, bytes: impl Into<Vec<u8>>) -> String {
    match from(name, bytes).and_then(|mut dem| dem.read_all()) {
        Ok(field) => panic!("{name} was read as {}x{}", field.width(), field.height()),
        Err(e) => {
            let message = e.to_string();
            assert!(!message.contains('\n'), "one line: {message}");
            println!("{message}");
            message
        }
    }
}

#[track_caller]
fn says(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "'{message}' does not say '{word}'");
    }
}

/// Every GeoTIFF fixture holds the same grid, whatever its type and compression.
#[test]
fn geotiffs_of_all_kinds_hold_the_same_heights() {
    let mut seen = 0;
    for entry in std::fs::read_dir(fixture("")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if path.extension().unwrap() != "tif" || ["lzma", "feet"].iter().any(|word| name.contains(word)) {
            continue;
        }
        seen += 1;
        let mut dem = dem::open(&[path], &OpenOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        let info = dem.info().clone();
        println!("{name}: {} {} {}", info.format, info.sample_type, info.compression);
        for word in ["lzw", "deflate", "zstd", "packbits"] {
            assert_eq!(name.contains(word), info.compression.to_lowercase().contains(word), "{name}");
        }
        assert_eq!(name.contains("predictor2"), info.compression.contains("horizontal"));
        assert_eq!(name.contains("predictor3"), info.compression.contains("floating"));
        assert_eq!(name.contains("bigtiff"), info.format.contains("BigTIFF"));
        assert_eq!(name.contains("overviews"), info.overviews == [[19, 15], [10, 8]]);
        assert_eq!((info.size, info.geo.origin), ([37, 29], [300_000.0, 4_000_000.0]), "{name}");
        assert_eq!((info.geo.step, info.geo.step_m), ([50.0, -50.0], [50.0, 50.0]));
        let epsg = if name.contains("other") { 3035 } else { 32654 };
        assert_eq!(info.geo.crs.epsg, Some(epsg));
        let field = dem.read_all().unwrap_or_else(|e| panic!("{e}"));
        for row in 0..29 {
            for column in 0..37 {
                let is_void = info.no_data.is_some() && (column, row) == (5, 3)
                    || name.contains("sparse") && column < 16 && row < 16;
                let stored = height(column, row);
                let expected = if name.contains("scaled") { 0.5 * stored + 100.0 } else { stored };
                let z = field.at(column, row);
                assert!(if is_void { z.is_nan() } else { z == expected }, "{name}: {z} at {column}, {row}");
            }
        }
    }
    assert_eq!(seen, 18);
}

#[test]
fn geotiffs_that_cannot_be_read_say_why() {
    let read = |name: &str| std::fs::read(fixture(name)).unwrap();
    says(&error("a.tif", read("f32_lzma_strips.tif")), &["a.tif", "LZMA", "gdal_translate"]);
    says(&error("a.tif", read("f32_feet.tif")), &["a.tif", "unit 9003", "metres"]);

    // A code that is not in the list and does not say that it is in metres.
    let mut unknown = read("f32_deflate_other_epsg.tif");
    let key = [3072u16, 0, 1, 3035, 3076, 0, 1, 9001].map(u16::to_le_bytes).concat();
    let at = unknown.windows(key.len()).position(|w| w == key).unwrap();
    unknown[at + 14..at + 16].copy_from_slice(&32767u16.to_le_bytes());
    says(&error("a.tif", unknown.clone()), &["EPSG:3035 is not known", "metre"]);
    let options = OpenOptions { crs: crs::from_epsg(32654), ..OpenOptions::default() };
    assert!(dem::from_bytes("a.tif", unknown, &options).is_ok(), "a stated CRS stands over the file's");

    let whole = read("f32_zstd_predictor3_strips.tif");
    says(&error("a.tif", &whole[..whole.len() - 50]), &["a.tif", "strip 0", "745 bytes"]);
    says(&error("a.tif", &whole[..100]), &["a.tif", "byte 100", "118 more bytes"]);
    says(&error("a.tif", &whole[..6]), &["a.tif"]);

    // A picture.
    let mut picture = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut picture).unwrap();
    encoder.write_image::<tiff::encoder::colortype::RGB8>(4, 4, &[0; 48]).unwrap();
    says(&error("a.tif", picture.into_inner()), &["3 bands", "-b"]);
}

/// A TIFF by hand: little-endian, one strip of 16-bit samples.
fn tiff_header(width: u32, height: u32, rows_per_strip: u32, compression: u16) -> Vec<u8> {
    let long = |tag: u16, value: u32| [&tag.to_le_bytes()[..], &[4, 0, 1, 0, 0, 0], &value.to_le_bytes()[..]].concat();
    let short = |tag: u16, value: u16| {
        [&tag.to_le_bytes()[..], &[3, 0, 1, 0, 0, 0], &value.to_le_bytes()[..], &[0, 0]].concat()
    };
    let entries = [
        long(256, width),
        long(257, height),
        short(258, 16),
        short(259, compression),
        short(262, 1),
        long(273, 8),
        short(277, 1),
        long(278, rows_per_strip),
        long(279, 16),
        short(339, 2),
    ];
    let mut bytes = b"II*\0\x08\0\0\0".to_vec();
    bytes.extend((entries.len() as u16).to_le_bytes());
    bytes.extend(entries.concat());
    bytes.extend([0; 64]);
    bytes
}

#[test]
fn a_header_that_promises_too_much_is_refused_at_once() {
    // 2^40 samples.
    says(&error("a.tif", tiff_header(1 << 20, 1 << 20, 1 << 20, 1)), &["a.tif", "1099511627776", "limit"]);
    // 2^32 compressed samples in a strip.
    says(&error("a.tif", tiff_header(1 << 16, 1 << 16, 1 << 16, 8)), &["strip", "8589934592", "limit"]);
    // 2^26 samples that are not in the file.
    says(&error("a.tif", tiff_header(1 << 13, 1 << 13, 1 << 13, 1)), &["strip 0", "16"]);
    let header = "ncols 1000000000\nnrows 1000000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3";
    says(&error("a.asc", header), &["a.asc", "limit"]);
    let header = "ncols 100000\nnrows 10000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3";
    says(&error("a.asc", header), &["a.asc", "1999999999 bytes"]);
    let options = OpenOptions { max_samples: 40, ..OpenOptions::default() };
    let mut dem = dem::from_bytes("a.asc", asc(7, 6).into_bytes(), &options).unwrap();
    says(&dem.read_all().unwrap_err().to_string(), &["a.asc", "7x6", "42", "40"]);
}

#[test]
fn large_uncompressed_strips_are_read_by_rows() {
    let (width, rows) = (1000usize, 900usize);
    let mut bytes = tiff_header(width as u32, rows as u32, rows as u32, 1);
    let start = bytes.len() as u32;
    let at =
        |tag: u16| 10 + 12 * [256, 257, 258, 259, 262, 273, 277, 278, 279, 339].iter().position(|t| *t == tag).unwrap();
    bytes[at(273) + 8..at(273) + 12].copy_from_slice(&start.to_le_bytes());
    bytes[at(279) + 8..at(279) + 12].copy_from_slice(&((width * rows * 2) as u32).to_le_bytes());
    for i in 0..width * rows {
        bytes.extend((height(i % width, i / width) as i16 - 30).to_le_bytes());
    }
    let mut dem = from("a.tif", bytes).unwrap();
    assert!(dem.info().chunk[1] < rows, "{:?}", dem.info().chunk);
    assert!(dem.info().notes[0].contains("no geo-reference"));
    let window = Window { column: 100, row: 500, width: 50, height: 60 };
    let mut out = vec![0.0; 3000];
    dem.read_window(window, &mut out).unwrap();
    assert!((0..3000).all(|i| out[i] == height(100 + i % 50, 500 + i / 50) - 30.0));
}

#[test]
fn srtm_plain_zipped_and_gzipped() {
    let bytes = hgt(1201);
    let zipped = zip(&[("readme.txt", b"hello"), ("N35E138.hgt", &bytes)]);
    for (name, bytes) in [("N35E138.hgt", bytes.clone()), ("a.zip", zipped), ("N35E138.hgt.gz", gzip(&bytes))] {
        let field = field(name, bytes);
        assert_eq!((field.width(), field.height(), field.no_data_count()), (1201, 1201, 1));
        assert_eq!(field.geo().origin, [138.0, 36.0]);
        assert!(field.at(0, 0).is_nan() && field.at(1200, 1200) == height(1200, 1200));
    }
    says(&error("N35E138.hgt", &bytes[..100_000]), &["N35E138.hgt", "2884802", "100000"]);
    says(&error("alps.hgt", bytes.clone()), &["alps.hgt", "N42E001"]);
    let mut broken = gzip(&bytes);
    let middle = broken.len() / 2;
    broken[middle..middle + 40].fill(0x55);
    says(&error("N35E138.hgt.gz", broken), &["N35E138.hgt"]);
    let mut cut = zip(&[("N35E138.hgt", &bytes)]);
    cut.truncate(cut.len() - 30);
    says(&error("a.zip", cut), &["a.zip", "zip"]);
}

#[test]
fn dted_profiles_run_north() {
    let mut dem = from("a.dt0", dted(5, 4)).unwrap();
    assert_eq!((dem.info().format.as_str(), dem.info().size), ("DTED level 0", [5, 4]));
    assert_eq!(dem.geo().origin, [11.0, 49.0 + 3.0 * 3.0 / 3600.0]);
    let field = dem.read_all().unwrap();
    assert!(field.at(0, 0).is_nan());
    assert!((1..20).all(|i| field.at(i % 5, i / 5) == height(i % 5, i / 5) - 40.0));
    // With a tape label before it.
    let labelled = [&b"VOL1"[..], &[b' '; 76], &dted(5, 4)].concat();
    assert_eq!(from("a.dt1", labelled).unwrap().read_all().unwrap().at(4, 3), field.at(4, 3));
    let zipped = zip(&[("e011/n49.dt0", &dted(5, 4))]);
    assert_eq!(from("a.zip", zipped).unwrap().read_all().unwrap().at(4, 3), field.at(4, 3));

    says(&error("a.dt0", &dted(5, 4)[..3500]), &["a.dt0", "3528 bytes", "3500 bytes"]);
    let mut broken = dted(5, 4);
    broken[3428 + 20] = 7;
    says(&error("a.dt0", broken), &["profile 1", "0xaa", "0x07"]);
    let mut broken = dted(5, 4);
    broken[4] = b'x';
    says(&error("a.dt0", broken), &["UHL", "longitude", "x110000E"]);
    says(&error("a.dt0", dted(1, 4)), &["at least 2x2", "1x4"]);
}

#[test]
fn ascii_grids_in_all_dress() {
    let field = field("a.asc", asc(300, 250));
    assert_eq!(field.geo().origin, [201.0, 100.0 + 2.0 * 249.5]);
    assert_eq!(field.geo().step, [2.0, -2.0]);
    assert!((0..300 * 250).all(|i| field.heights_m()[i] == height(i % 300, i / 300)));

    let mut dem =
        from("a.asc", "cellsize 0.5 xllcenter 10 nodata_value -1 yllcenter 20 nrows 2 ncols 3 1 -1 3 nan 1e40 6")
            .unwrap();
    assert_eq!(dem.geo().origin, [10.0, 20.5]);
    let z = dem.read_all().unwrap().into_heights_m();
    assert_eq!((z[0], z[2], z[5]), (1.0, 3.0, 6.0));
    assert!(z[1].is_nan() && z[3].is_nan() && z[4].is_nan());

    let head = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
    let dressed = format!("\u{feff}{head}1 2 3\n4 1.#QNAN -9999");
    assert_eq!(from("a.asc", dressed).unwrap().read_all().unwrap().no_data_count(), 2);
    says(&error("a.asc", format!("{head}1 2 3\n4 5 ")), &["row 2, column 3", "3x2"]);
    says(&error("a.asc", format!("{head}1 2 3\n4 five 6")), &["row 2, column 2", "five"]);
    says(&error("a.asc", format!("{head}1 2 3\n4 5 6 7")), &["after row 2", "7"]);
    says(&error("a.asc", head.replace("cellsize 1", "cellsize 0") + "1 2 3 4 5 6"), &["cellsize", "above 0", "'0'"]);
    says(&error("a.asc", head.replace("nrows 2", "nrows two") + "1 2 3 4 5 6"), &["nrows", "two"]);
    says(&error("a.asc", head.replace("nrows 2\n", "") + "1 2 3 4 5 6"), &["nrows"]);
    says(&error("a.asc", head), &["heights"]);
    says(&error("a.asc", format!("ncols {}", "9".repeat(2000))), &["very long"]);
    says(
        &error("a.asc", "ncols 1\nnrows 9\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4 5 6 7 8 9"),
        &["at least 2x2"],
    );
}

#[test]
fn a_prj_file_beside_a_grid_names_its_crs() {
    let folder = tempfile::tempdir().unwrap();
    let grid = folder.path().join("a.asc");
    std::fs::write(&grid, asc(4, 4)).unwrap();
    let wkt = r#"PROJCS["JGD2011 / Japan Plane Rectangular CS IX",GEOGCS["JGD2011",UNIT["degree",0.0174532925199433]],UNIT["metre",1],AUTHORITY["EPSG","6677"]]"#;
    std::fs::write(grid.with_extension("prj"), wkt).unwrap();
    let dem = dem::open(std::slice::from_ref(&grid), &OpenOptions::default()).unwrap();
    assert_eq!(dem.geo().crs.epsg, Some(6677));
    std::fs::write(grid.with_extension("prj"), wkt.replace("\"metre\"", "\"foot\"").replace("6677", "9999")).unwrap();
    says(&dem::open(&[grid], &OpenOptions::default()).unwrap_err().to_string(), &["a.prj", "metres"]);
}

#[test]
fn fg_gml_traps() {
    let whole = field("a.xml", full_fg_gml());
    assert_eq!((whole.width(), whole.height(), whole.at(7, 5)), (8, 6, height(7, 5)));
    let [x, y] = whole.geo().origin;
    assert!((x - (138.5 + 0.01 / 8.0)).abs() < 1e-12 && (y - (35.26 - 0.005 / 6.0)).abs() < 1e-12);

    // The list begins after the first cell and ends before the last; -9999 is no-data.
    let part = field("a.xml", fg_gml(8, 6, [3, 1], &[1.5, -9999.0, 3.5]));
    assert_eq!(part.no_data_count(), 48 - 2);
    assert_eq!((part.at(3, 1), part.at(5, 1)), (1.5, 3.5));
    assert_eq!(field("a.xml", fg_gml(8, 6, [0, 0], &[-9999.0; 48])).range_m(), None);
    assert_eq!(field("a.xml", fg_gml(8, 6, [0, 0], &[])).range_m(), None);

    says(&error("a.xml", fg_gml(8, 6, [0, 0], &[1.0; 49])), &["tupleList", "48", "49"]);
    says(&error("a.xml", fg_gml(8, 6, [8, 0], &[1.0])), &["startPoint", "8 0"]);
    let text = full_fg_gml();
    says(&error("a.xml", &text[..text.len() / 2]), &["a.xml", "byte"]);
    says(&error("a.xml", text.replace("fguuid:jgd2011.bl", "urn:x")), &["srsName", "urn:x"]);
    says(&error("a.xml", text.replace("地表面,7.00", "地表面,seven")), &["tupleList, line 2", "seven"]);
    says(&error("a.xml", text.replace("+x-y", "+y-x")), &["order"]);
    says(&error("a.xml", text.replace("<gml:high>7 5", "<gml:high>70000000 5")), &["GridEnvelope"]);
    says(&error("a.xml", text.replace("138.52", "138.5x")), &["two numbers"]);
    says(&error("meta.xml", "<?xml version=\"1.0\"?><MD_Metadata/>"), &["meta.xml", "XML"]);

    // Shift_JIS, as old files are.
    let old: Vec<u8> = text
        .replace("UTF-8", "Shift_JIS")
        .bytes()
        .filter(|b| b.is_ascii())
        .collect::<Vec<u8>>()
        .split(|b| *b == b'\n')
        .flat_map(|line| {
            if line.starts_with(b",") {
                [b"\x92n\x95\x5c\x96\xca", line, b"\n"].concat()
            } else {
                [line, b"\n"].concat()
            }
        })
        .collect();
    assert_eq!(field("a.xml", old).heights_m(), whole.heights_m());
}

#[test]
fn a_zip_of_meshes_is_a_mosaic() {
    let west = full_fg_gml();
    let east = west.replace("138.52<", "138.54<").replace("35.25 138.5<", "35.25 138.52<");
    let pack = |east: &str| {
        let inner = zip(&[
            ("FG-GML-b.xml", east.as_bytes()),
            ("FG-GML-a.xml", west.as_bytes()),
            ("fmdid.xml", b"<a/>"),
        ]);
        zip(&[("PackDLMap/inner.zip", &inner)])
    };
    let mut dem = from("PackDLMap.zip", pack(&east)).unwrap();
    assert_eq!((dem.info().files, dem.size()), (2, [16, 6]));
    let field = dem.read_all().unwrap();
    assert_eq!((field.at(2, 3), field.at(10, 3)), (height(2, 3), height(2, 3)));

    let mixed = pack(&east.replace("jgd2011", "jgd2000"));
    says(&error("PackDLMap.zip", mixed.clone()), &["FG-GML-a.xml", "FG-GML-b.xml", "JGD2011", "JGD2000"]);
    let options = OpenOptions { crs: crs::from_epsg(6668), ..OpenOptions::default() };
    assert_eq!(dem::from_bytes("PackDLMap.zip", mixed, &options).unwrap().info().files, 2);
    says(&error("a.zip", zip(&[("a.doc", b"hello"), ("b.doc", b"hello")])), &["a.zip", "a.doc, b.doc"]);
    says(&error("a.zip", zip(&[])), &["a.zip", "nothing"]);
}

#[test]
fn tiles_of_all_encodings() {
    let slope = |x: u32, y: u32| 1000.0 + 2.0 * x as f32 + 3.0 * y as f32;
    let terrain_rgb = |x, y| {
        let code = ((slope(x, y) + 10_000.0) * 10.0).round() as u32;
        [(code >> 16) as u8, (code >> 8) as u8, code as u8]
    };
    let gsi = |x, y| match (x, y) {
        (3, 4) => [128, 0, 0],
        (4, 4) => [255, 255, 156],
        _ => {
            let code = (slope(x, y) * 100.0).round() as u32;
            [(code >> 16) as u8, (code >> 8) as u8, code as u8]
        }
    };
    for (encoding, bytes) in [
        (TileEncoding::TerrainRgb, png(256, 256, terrain_rgb)),
        (TileEncoding::Terrarium, png(256, 256, |x, y| terrarium(slope(x, y)))),
        (TileEncoding::Gsi, png(256, 256, gsi)),
    ] {
        let mut dem = from("12/3627/1616.png", bytes.clone()).unwrap();
        assert_eq!(dem.info().format, format!("{} tile", encoding.name()), "guessed");
        let field = dem.read_all().unwrap();
        assert!((field.at(100, 50) - 1350.0).abs() < 0.01);
        if encoding == TileEncoding::Gsi {
            assert!(field.at(3, 4).is_nan() && (field.at(4, 4) + 1.0).abs() < 1e-3);
        }
        let options =
            OpenOptions { tile: Some([12, 3627, 1616]), tile_encoding: Some(encoding), ..OpenOptions::default() };
        let given = dem::from_bytes("somewhere.png", bytes, &options).unwrap();
        assert_eq!(given.geo(), dem.geo());
    }
    let flat = png(256, 256, |_, _| [1, 134, 160]);
    says(&error("fuji.png", flat.clone()), &["fuji.png", "zoom"]);
    says(&error("1/2/0.png", flat.clone()), &["1/2/0", "2^zoom"]);
    says(&error("1/1/0.png", &flat[..flat.len() / 2]), &["1/1/0.png", "PNG"]);
    let noise = png(256, 256, |x, y| [(x * 91 + y * 57) as u8, (x * 13) as u8, y as u8]);
    says(&error("1/1/0.png", noise), &["colours", "no terrain"]);
}

#[test]
fn a_folder_of_tiles_is_a_mosaic_of_its_deepest_zoom() {
    let folder = tempfile::tempdir().unwrap();
    let put = |zoom: u32, x: u32, y: u32| {
        let path = folder.path().join(format!("terrarium/{zoom}/{x}/{y}.png"));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, png(64, 64, |i, j| terrarium((zoom * 100 + x * 64 + i + y * 64 + j) as f32))).unwrap();
    };
    for (x, y) in [(4, 5), (5, 5), (4, 6)] {
        put(4, x, y);
    }
    put(3, 2, 2);
    std::fs::write(folder.path().join("notes.txt"), "tiles").unwrap();
    let open = |zoom| dem::open(&[folder.path().to_owned()], &OpenOptions { zoom, ..OpenOptions::default() });
    let mut dem = open(None).unwrap();
    assert_eq!((dem.info().files, dem.size()), (3, [128, 128]));
    let field = dem.read_all().unwrap();
    assert_eq!(field.no_data_count(), 64 * 64, "the tile that is not there");
    let (x0, y0) = (4 * 64, 5 * 64);
    assert_eq!(field.at(70, 10), (400 + x0 + 70 + y0 + 10) as f32);
    assert_eq!(field.at(10, 70), (400 + x0 + 10 + y0 + 70) as f32);
    assert_eq!(open(Some(3)).unwrap().info().files, 1);
    says(&open(Some(7)).unwrap_err().to_string(), &["zoom 7"]);
}

#[test]
fn mosaics_fill_holes_and_refuse_what_does_not_fit() {
    let grid = |west: f64, cell: f64, values: &str| {
        format!("ncols 3\nnrows 2\nxllcorner {west}\nyllcorner 500\ncellsize {cell}\nnodata_value -1\n{values}")
    };
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let a = write("a.asc", grid(1000.0, 10.0, "1 2 3 4 -1 6"));
    let b = write("b.asc", grid(1010.0, 10.0, "20 30 40 50 60 70"));
    let open = |paths: &[&std::path::PathBuf]| {
        dem::open(&paths.iter().map(|p| (*p).clone()).collect::<Vec<_>>(), &OpenOptions::default())
    };
    let heights = |paths: &[&std::path::PathBuf]| open(paths).unwrap().read_all().unwrap().into_heights_m();
    assert_eq!(heights(&[&a, &b]), [1.0, 2.0, 3.0, 40.0, 4.0, 50.0, 6.0, 70.0]);
    assert_eq!(heights(&[&b, &a]), [1.0, 20.0, 30.0, 40.0, 4.0, 50.0, 60.0, 70.0]);
    let folder_field = dem::open(&[folder.path().to_owned()], &OpenOptions::default()).unwrap().read_all().unwrap();
    assert_eq!(folder_field.heights_m(), heights(&[&a, &b]));

    let shifted = write("shifted.asc", grid(1013.0, 10.0, "1 2 3 4 5 6"));
    says(&open(&[&a, &shifted]).unwrap_err().to_string(), &["a.asc", "shifted.asc", "0.3"]);
    let coarse = write("coarse.asc", grid(1000.0, 20.0, "1 2 3 4 5 6"));
    says(&open(&[&a, &coarse]).unwrap_err().to_string(), &["a.asc", "coarse.asc", "10", "20"]);
    let far = write("far.asc", grid(1e9, 10.0, "1 2 3 4 5 6"));
    let far_high = write("far_high.asc", grid(1000.0, 10.0, "1 2 3 4 5 6").replace("yllcorner 500", "yllcorner 1e9"));
    says(&open(&[&a, &far, &far_high]).unwrap_err().to_string(), &["limit"]);
    says(&dem::open(&[], &OpenOptions::default()).unwrap_err().to_string(), &["at least one"]);
    says(&open(&[&folder.path().join("none.asc")]).unwrap_err().to_string(), &["none.asc"]);
}

#[test]
fn windows_outside_are_refused() {
    let mut dem = from("a.asc", asc(10, 8)).unwrap();
    let mut read = |column, row, width, height, length: usize| {
        dem.read_window(Window { column, row, width, height }, &mut vec![0.0; length])
    };
    assert!(read(0, 0, 10, 8, 80).is_ok());
    assert!(read(10, 8, 0, 0, 0).is_ok());
    says(&read(5, 0, 6, 8, 48).unwrap_err().to_string(), &["window", "10x8"]);
    assert!(read(0, 0, 10, 8, 79).is_err());
    assert!(read(usize::MAX, 0, 2, 2, 4).is_err());
}

#[test]
fn other_files_are_named_for_what_they_are() {
    says(&error("a.tif", b"\xff\xd8\xff\xe0...."), &["a.tif", "JPEG"]);
    says(&error("a.tif", ""), &["a.tif", "empty"]);
    says(&error("a.tif", "hello world"), &["a.tif", "hello wo"]);
    says(&error("a.nc", b"CDF\x01"), &["NetCDF"]);
    says(&error("a.las", b"LASF"), &["point cloud"]);
    // Mislabelled, but readable.
    let dem = from("a.tif", asc(4, 4)).unwrap();
    assert_eq!(dem.info().notes.last().unwrap(), "named .tif but is ESRI ASCII grid");
    let mut bomb = b"deep".to_vec();
    for _ in 0..6 {
        bomb = zip(&[("a.zip", &bomb)]);
    }
    says(&error("a.zip", bomb), &["deep"]);
}

#[test]
fn written_grids_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut heights: Vec<f32> = (0..70 * 50).map(|i| 0.1 * height(i % 70, i / 70)).collect();
    heights[77] = f32::NAN;
    let crs_list = [crs::from_epsg(6677).unwrap(), crs::from_epsg(6668).unwrap(), Crs::default()];
    for (i, crs) in crs_list.into_iter().enumerate() {
        let step = if crs.geographic { [0.001, -0.0005] } else { [0.5, -0.5] };
        let geo = yamanami_core::GeoReference::new(crs, [138.25, 35.75], step, [70, 50]);
        let field = HeightField::new(70, 50, heights.clone(), geo);
        for name in [format!("{i}.tif"), format!("{i}.asc")] {
            let path = folder.path().join(&name);
            if name.ends_with("tif") { dem::write_geotiff(&path, &field) } else { dem::write_asc(&path, &field) }
                .unwrap();
            let crs = Some(field.geo().crs.clone()).filter(|_| name.ends_with("asc"));
            let mut dem = dem::open(&[path], &OpenOptions { crs, ..OpenOptions::default() }).unwrap();
            let back = dem.read_all().unwrap();
            assert!(back.heights_m().iter().zip(&heights).all(|(a, b)| a == b || a.is_nan() && b.is_nan()));
            assert_eq!(back.geo().crs.epsg, field.geo().crs.epsg, "{name}: {:?}", dem.info());
            assert_eq!(back.geo().crs.geographic, field.geo().crs.geographic);
            assert!((back.geo().origin[1] - field.geo().origin[1]).abs() < 1e-9);
            assert_eq!(back.geo().step, field.geo().step);
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 6, "nothing else is left behind");
    let nowhere = Path::new("/nonexistent/a.tif");
    let geo = yamanami_core::GeoReference::local([1.0, 1.0], 2);
    let field = HeightField::new(2, 2, vec![0.0; 4], geo);
    says(&dem::write_geotiff(nowhere, &field).unwrap_err().to_string(), &["a.tif"]);
}

/// What is not read here is left to GDAL where a build has it.
#[cfg(feature = "gdal")]
#[test]
fn gdal_reads_all_else() {
    let mut dem = dem::open(&[fixture("f32_lzma_strips.tif")], &OpenOptions::default()).unwrap();
    assert_eq!(dem.info().format, "GeoTIFF (by GDAL)");
    assert_eq!((dem.geo().crs.epsg, dem.geo().origin), (Some(32654), [300_000.0, 4_000_000.0]));
    let field = dem.read_all().unwrap();
    assert!((0..37 * 29).all(|i| field.heights_m()[i] == height(i % 37, i / 37)));
    let message = dem::open(&[fixture("f32_feet.tif")], &OpenOptions::default()).unwrap_err().to_string();
    says(&message, &["0.3048", "metres"]);
    says(&dem::open(&[fixture("make.py")], &OpenOptions::default()).unwrap_err().to_string(), &["make.py", "content"]);
}
