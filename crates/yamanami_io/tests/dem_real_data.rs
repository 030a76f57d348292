//! Every elevation file of the shared data set: size, range and voids as its table says. Skipped where it is absent.

use std::path::PathBuf;
use yamanami_core::{HeightField, HeightSource, Window};
use yamanami_io::dem::{self, DemFile, DemInfo, OpenOptions, SampleType};

fn data(name: &str) -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/dem");
    let path = folder.join(name);
    if !path.exists() {
        println!("skipped: {name} is not here");
        return None;
    }
    Some(path)
}

fn read(names: &[&str]) -> Option<(DemInfo, HeightField)> {
    let paths: Vec<PathBuf> = names.iter().map(|name| data(name)).collect::<Option<_>>()?;
    let mut dem = open(&paths);
    let field = dem.read_all().unwrap_or_else(|e| panic!("{e}"));
    Some((dem.info().clone(), field))
}

fn open(paths: &[PathBuf]) -> DemFile {
    dem::open(paths, &OpenOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[track_caller]
fn check(name: &str, size: [usize; 2], range: [f32; 2], voids: Option<usize>) -> Option<DemInfo> {
    let (info, field) = read(&[name])?;
    println!("{info:?}");
    assert_eq!(info.size, size);
    let [low, high] = field.range_m().unwrap();
    assert!((low - range[0]).abs() < 0.06 && (high - range[1]).abs() < 0.06, "{low}..{high}");
    if let Some(voids) = voids {
        assert_eq!(field.no_data_count(), voids);
    }
    Some(info)
}

#[track_caller]
fn near(a: [f64; 2], b: [f64; 2]) {
    let tolerance = 1e-9 * a[0].abs().max(a[1].abs()).max(1.0);
    assert!((a[0] - b[0]).abs() < tolerance && (a[1] - b[1]).abs() < tolerance, "{a:?} is not {b:?}");
}

#[test]
fn srtm() {
    if let Some(info) = check("N42E001.hgt.zip", [1201, 1201], [349.0, 3100.0], Some(7652)) {
        near(info.geo.origin, [1.0, 43.0]);
        near(info.geo.step, [1.0 / 1200.0, -1.0 / 1200.0]);
        assert_eq!((info.format.as_str(), info.compression.as_str()), ("SRTM3 hgt", "zip"));
        assert_eq!(info.geo.crs.epsg, Some(4326));
    }
    check("N41E001.hgt.zip", [1201, 1201], [-20.0, 1204.0], Some(134));
    check("N43E007.hgt.zip", [1201, 1201], [-11.0, 2064.0], Some(1595));
    if let Some(info) = check("N44W072.hgt", [1201, 1201], [115.0, 1908.0], Some(0)) {
        near(info.geo.origin, [-72.0, 45.0]);
    }
}

#[test]
fn srtm_one_second() {
    if let Some(info) = check("N48W125.hgt.zip", [3601, 3601], [-13.0, 1095.0], Some(6_483_876)) {
        near(info.geo.origin, [-125.0, 49.0]);
    }
}

#[test]
fn dted() {
    if let Some(info) = check("bavaria_n49_e011_dted1.zip", [1201, 1201], [234.0, 920.0], Some(20)) {
        near(info.geo.origin, [11.0, 50.0]);
        near(info.geo.step, [1.0 / 1200.0, -1.0 / 1200.0]);
        assert_eq!(info.format, "DTED level 1");
    }
}

#[test]
fn cloud_optimised_geotiff() {
    let Some(info) = check("pyrenees_N42E001_float32_cog.tif", [1201, 1201], [349.0, 3100.0], Some(7652)) else {
        return;
    };
    near(info.geo.origin, [1.0, 43.0]);
    assert_eq!(info.format, "cloud-optimised GeoTIFF");
    assert_eq!(info.overviews, [[600, 600], [300, 300], [150, 150]]);
    assert_eq!(info.sample_type, SampleType::F32);
    assert_eq!(info.no_data, Some(-9999.0));
    let (_, tif) = read(&["pyrenees_N42E001_float32_cog.tif"]).unwrap();
    let (_, hgt) = read(&["N42E001.hgt.zip"]).unwrap();
    assert!(tif.heights_m().iter().zip(hgt.heights_m()).all(|(a, b)| a == b || a.is_nan() && b.is_nan()));
}

#[test]
fn geotiffs() {
    if let Some(info) = check("bigtujunga_srtm1_utm11n_30m_int16_tiled.tif", [1197, 643], [315.0, 2295.0], None) {
        near(info.geo.origin, [376_313.655_454_263_5 + 15.0, 3_807_917.827_627_8 + 0.001 - 15.0 - 0.000_999_999_2]);
        assert_eq!(info.geo.crs.name, "WGS 84 / UTM zone 11N");
        assert_eq!(info.geo.step_m, [30.0, 30.0]);
    }
    if let Some(info) = check("zion_srtm3_465x457_uint16.tif", [465, 457], [1024.0, 2892.0], Some(0)) {
        assert_eq!(info.sample_type, SampleType::U16);
    }
    if let Some(info) = check("newzealand_1km_1115x1450_float32_nan.tif", [1115, 1450], [0.0, 4140.3], Some(1_348_639))
    {
        assert_eq!((info.geo.crs.epsg, info.geo.crs.geographic), (None, false));
        assert!(info.geo.crs.name.contains("transverse Mercator, central meridian 173"), "{}", info.geo.crs.name);
        assert_eq!(info.compression, "LZW");
    }
    if let Some(info) = check("japan_alps_fuji_30s_480x360_int16.tif", [480, 360], [1.0, 3571.0], None) {
        assert_eq!(info.compression, "deflate, horizontal predictor");
    }
    check("central_japan_srtm30_300x300_int16.tif", [300, 300], [0.0, 3664.0], None);
    if let Some(info) = check("fuji_utm54n_50m_257x257_float32.tif", [257, 257], [789.43, 3740.39], None) {
        assert_eq!(info.geo.crs.epsg, Some(32654));
        near(info.geo.origin, [287_100.0, 3_921_800.0]);
        assert_eq!(info.compression, "deflate, floating-point predictor");
    }
    check("mt_washington_utm19n_50m_257x257_float32.tif", [257, 257], [421.92, 1905.38], None);
}

#[test]
fn tiles() {
    let name = "fuji_terrainrgb_z10_x906_y404_512px.png";
    if let Some(info) = check(name, [512, 512], [13.7, 3751.0], None) {
        assert_eq!(info.geo.crs.epsg, Some(3857));
        assert!((info.geo.step_m[0] - 62.3).abs() < 0.5, "{:?}", info.geo.step_m);
    }
    let png = "gsi_dem_png_z8_x229_y94_hokkaido.png";
    let text = "gsi_dem_txt_z8_x229_y94_hokkaido.txt";
    if check(png, [256, 256], [0.01, 1944.25], Some(12_527)).is_some() {
        let (_, a) = read(&[png]).unwrap();
        let (_, b) = read(&[text]).unwrap();
        assert_eq!(a.geo(), b.geo());
        let worst_m = a.heights_m().iter().zip(b.heights_m()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst_m < 0.0101, "{worst_m}");
        assert!(a.heights_m().iter().zip(b.heights_m()).all(|(a, b)| a.is_nan() == b.is_nan()));
    }
}

#[test]
fn encodings_are_guessed_from_colours() {
    for (name, format, tile) in [
        ("fuji_terrainrgb_z10_x906_y404_512px.png", "Terrain-RGB tile", "10/906/404.png"),
        ("gsi_dem_png_z8_x229_y94_hokkaido.png", "GSI dem_png tile", "8/229/94.png"),
    ] {
        let Some(path) = data(name) else { return };
        let dem = dem::from_bytes(tile, std::fs::read(path).unwrap(), &OpenOptions::default()).unwrap();
        assert_eq!(dem.info().format, format);
        assert!(dem.info().notes[0].contains("guessed"));
    }
}

#[test]
fn fg_gml() {
    let name = "FG-GML-5238-74-00-DEM5A-20161001.xml";
    if let Some(info) = check(name, [225, 150], [120.0, 608.39], Some(302)) {
        assert_eq!(info.geo.crs.epsg, Some(6668));
        assert_eq!(info.format, "FG-GML DEM 5mメッシュ（標高）");
        let second = 1.0 / 3600.0;
        near(info.geo.step, [0.2 * second, -(35.258333333 - 35.25) / 150.0]);
    }
}

#[test]
fn ascii_grids() {
    let name = "colorado_front_range_srtm3_240x144.asc";
    if let Some(info) = check(name, [240, 144], [1943.0, 3286.0], Some(0)) {
        assert!(info.geo.crs.geographic, "guessed from place and cell size");
        assert!(info.notes[0].contains("longitude/latitude"));
    }
    if let Some(info) = check("bijou_gully_5m_105x77.asc", [105, 77], [1673.07, 1729.86], Some(0)) {
        assert_eq!(info.geo.crs, Default::default());
        assert!((info.geo.step_m[0] - 4.988744589).abs() < 1e-12);
    }
}

#[test]
fn neighbours_make_a_mosaic() {
    let names = ["N42E001.hgt.zip", "N41E001.hgt.zip"];
    let Some((info, both)) = read(&names) else { return };
    assert_eq!((info.size, info.files), ([1201, 2401], 2));
    near(info.geo.origin, [1.0, 43.0]);
    let (_, north) = read(&names[..1]).unwrap();
    let (_, south) = read(&names[1..]).unwrap();
    assert_eq!(both.at(600, 100), north.at(600, 100));
    assert_eq!(both.at(600, 1300), south.at(600, 100));
    let shared = (0..1201).filter(|&i| north.at(i, 1200) == south.at(i, 0)).count();
    assert!(shared > 1190, "both files agree on the row they share: {shared}");
    // The other order names the other file first, but places both alike.
    let (swapped, _) = read(&[names[1], names[0]]).unwrap();
    near(swapped.geo.origin, [1.0, 43.0]);
}

#[test]
fn different_systems_make_no_mosaic() {
    let names = ["N42E001.hgt.zip", "fuji_utm54n_50m_257x257_float32.tif"];
    let Some(paths) = names.iter().map(|name| data(name)).collect::<Option<Vec<_>>>() else { return };
    let message = dem::open(&paths, &OpenOptions::default()).unwrap_err().to_string();
    assert!(names.iter().all(|name| message.contains(name)) && message.contains("32654"), "{message}");
}

#[test]
fn windows_agree_with_the_whole() {
    for name in [
        "N48W125.hgt.zip",
        "pyrenees_N42E001_float32_cog.tif",
        "bijou_gully_5m_105x77.asc",
        "bavaria_n49_e011_dted1.zip",
    ] {
        let Some(path) = data(name) else { return };
        let mut dem = dem::open(&[path], &OpenOptions { cache_bytes: 1 << 20, ..OpenOptions::default() }).unwrap();
        let whole = dem.read_all().unwrap();
        let [width, height] = dem.size();
        for (i, j) in [(5, 7), (3, 2), (8, 1), (0, 9)] {
            let window =
                Window { column: i * width / 10, row: j * height / 10, width: width / 12, height: height / 11 };
            let mut out = vec![0.0; window.width * window.height];
            dem.read_window(window, &mut out).unwrap();
            for (k, z) in out.iter().enumerate() {
                let expected = whole.at(window.column + k % window.width, window.row + k / window.width);
                assert!(*z == expected || z.is_nan() && expected.is_nan());
            }
        }
    }
}
