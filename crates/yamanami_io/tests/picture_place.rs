//! Where pictures lie: by the keys of a GeoTIFF, by a tile's name, or nowhere.

use std::io::Cursor;
use std::path::PathBuf;
use tiff::encoder::{TiffEncoder, colortype::RGB8};
use tiff::tags::Tag;
use yamanami_core::GeoReference;
use yamanami_io::crs::from_epsg;
use yamanami_io::dem::picture_place;

const SIZE: [usize; 2] = [7, 5];
const SCALE: u16 = 33_550;
const TIE_POINT: u16 = 33_922;
const TRANSFORMATION: u16 = 34_264;
const KEYS: u16 = 34_735;

/// A picture in colours with these tags of doubles, and these geo-keys if any.
fn tiff(folder: &tempfile::TempDir, doubles: &[(u16, &[f64])], keys: &[u16]) -> PathBuf {
    let mut bytes = Vec::new();
    let mut encoder = TiffEncoder::new(Cursor::new(&mut bytes)).unwrap();
    let mut image = encoder.new_image::<RGB8>(SIZE[0] as u32, SIZE[1] as u32).unwrap();
    for (tag, values) in doubles {
        image.encoder().write_tag(Tag::Unknown(*tag), *values).unwrap();
    }
    if !keys.is_empty() {
        image.encoder().write_tag(Tag::Unknown(KEYS), keys).unwrap();
    }
    image.write_data(&vec![128; 3 * SIZE[0] * SIZE[1]]).unwrap();
    let path = folder.path().join("picture.tif");
    std::fs::write(&path, bytes).unwrap();
    path
}

/// A header of geo-keys: projected or geographic, pixels are areas or points, the code.
fn keys(is_point: bool, key: u16, code: u16) -> [u16; 16] {
    let model = if key == 3072 { 1 } else { 2 };
    [1, 1, 0, 3, 1024, 0, 1, model, 1025, 0, 1, 1 + u16::from(is_point), key, 0, 1, code]
}

fn close(place: &GeoReference, origin: [f64; 2], step: [f64; 2]) {
    for (found, expected) in place.origin.iter().chain(&place.step).zip(origin.iter().chain(&step)) {
        assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{place:?}");
    }
}

#[test]
fn a_geotiff_lies_where_its_keys_say() {
    let folder = tempfile::tempdir().unwrap();
    let scale: &[f64] = &[0.01, 0.02, 0.0];
    let tie: &[f64] = &[0.0, 0.0, 0.0, 138.0, 36.0, 0.0];
    for (is_point, half) in [(false, 0.5), (true, 0.0)] {
        let path = tiff(&folder, &[(SCALE, scale), (TIE_POINT, tie)], &keys(is_point, 2048, 4326));
        let place = picture_place(&path, SIZE, None).unwrap().unwrap();
        close(&place, [138.0 + half * 0.01, 36.0 - half * 0.02], [0.01, -0.02]);
        assert_eq!((place.crs.epsg, place.crs.geographic), (Some(4326), true));
    }
    let web = [(SCALE, &[150.0, 150.0, 0.0][..]), (TIE_POINT, &[0.0, 0.0, 0.0, 15.42e6, 4.22e6, 0.0][..])];
    let path = tiff(&folder, &web, &keys(false, 3072, 3857));
    let place = picture_place(&path, SIZE, None).unwrap().unwrap();
    close(&place, [15.42e6 + 75.0, 4.22e6 - 75.0], [150.0, -150.0]);
    assert!(place.crs.web_mercator);
    // a CRS that is given stands over the file's
    let given = from_epsg(32654).unwrap();
    assert_eq!(picture_place(&path, SIZE, Some(&given)).unwrap().unwrap().crs, given);
}

#[test]
fn a_turned_geotiff_is_refused_and_one_without_keys_lies_nowhere() {
    let folder = tempfile::tempdir().unwrap();
    let mut turned = [0.0; 16];
    turned[..8].copy_from_slice(&[10.0, 2.0, 0.0, 5e5, 2.0, -10.0, 0.0, 4e6]);
    let path = tiff(&folder, &[(TRANSFORMATION, &turned)], &keys(false, 3072, 32654));
    let error = picture_place(&path, SIZE, None).unwrap_err().to_string();
    assert!(error.contains("rotated"), "{error}");
    let plain = tiff(&folder, &[], &[]);
    assert_eq!(picture_place(&plain, SIZE, None).unwrap(), None);
}

#[test]
fn a_tile_lies_by_its_name_and_other_numbers_name_none() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, b"\x89PNG\r\n").unwrap();
        picture_place(&path, [256, 256], None).unwrap()
    };
    let tile_m = 2.0 * std::f64::consts::PI * 6_378_137.0 / 8.0;
    let found = place("3/5/2.png").unwrap();
    close(&found, [tile_m * (1.0 + 0.5 / 256.0), tile_m * (2.0 - 0.5 / 256.0)], [tile_m / 256.0, -tile_m / 256.0]);
    assert_eq!(place("a_z3_x5_y2.png").unwrap(), found);
    for none in [
        "holiday.png",
        "2024/11/3.png",
        "4/16/2.png",
        "3-2-8.png",
        "31_1_1.png",
        "4294967295_0_0.png",
    ] {
        assert_eq!(place(none), None, "{none}");
    }
    assert!(picture_place(&folder.path().join("absent.png"), SIZE, None).is_err());
}
