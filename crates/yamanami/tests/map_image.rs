//! A picture laid over a map: lands where its place says, fades out, and is refused without one.

use glam::DVec2;
use image::{Rgba, RgbaImage};
use std::path::{Path, PathBuf};
use yamanami::MapImage;
use yamanami::core::Crs;
use yamanami::io::crs::{AzimuthalPlane, from_epsg, to_lon_lat};
use yamanami::map::GroundPicture;

const SIZE: [u32; 2] = [6, 4];

fn colour(column: u32, row: u32) -> Rgba<u8> {
    Rgba([40 * column as u8, 60 * row as u8, 200, 255])
}

/// A picture whose colours tell column and row, with a world file if there is one.
fn picture(folder: &Path, name: &str, world: Option<&str>) -> PathBuf {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    RgbaImage::from_fn(SIZE[0], SIZE[1], colour).save(&path).unwrap();
    if let Some(world) = world {
        std::fs::write(path.with_extension("wld"), world).unwrap();
    }
    path
}

fn white(reach_m: f64) -> Vec<GroundPicture> {
    vec![GroundPicture { reach_m, rgba: RgbaImage::from_pixel(11, 11, Rgba([255; 4])) }]
}

/// What a picture shows at a longitude and latitude: its colour, or none where it does not reach.
fn shown(image: &MapImage, [lon, lat]: [f64; 2]) -> Option<Rgba<u8>> {
    let plane = AzimuthalPlane::new(lon, lat).unwrap();
    let mut ground = white(0.5);
    image.lay_over(&mut ground, &plane, DVec2::ZERO, 0.4, 1.0);
    let found = *ground[0].rgba.get_pixel(5, 5);
    (found != Rgba([255; 4])).then_some(found)
}

/// Each pixel shows at its own place, and there is nothing a pixel beyond the border.
fn lands(image: &MapImage, lon_lat: impl Fn(f64, f64) -> [f64; 2]) {
    for (column, row) in (0..SIZE[0]).flat_map(|column| (0..SIZE[1]).map(move |row| (column, row))) {
        let found = shown(image, lon_lat(f64::from(column), f64::from(row)));
        let is_close = |found: Rgba<u8>| (0..4).all(|k| found.0[k].abs_diff(colour(column, row).0[k]) <= 1);
        assert!(found.is_some_and(is_close), "column {column}, row {row}: {found:?}");
    }
    let [right, below] = SIZE.map(|side| f64::from(side) - 0.4);
    for (column, row) in [(-0.6, 1.0), (right, 1.0), (2.0, -0.6), (2.0, below)] {
        assert_eq!(shown(image, lon_lat(column, row)), None, "column {column}, row {row}");
    }
}

#[test]
fn a_world_file_in_degrees_lands() {
    let folder = tempfile::tempdir().unwrap();
    let path = picture(folder.path(), "a.png", Some("0.01\n0\n0\n-0.02\n138.5\n35.5\n"));
    let image = MapImage::read(&path, None).unwrap();
    lands(&image, |column, row| [138.5 + 0.01 * column, 35.5 - 0.02 * row]);
    // between two pixels their colours are mixed
    let between = shown(&image, [138.505, 35.5]).unwrap();
    assert_eq!(between.0[0], 20);
}

#[test]
fn a_world_file_in_metres_lands_in_its_crs() {
    let folder = tempfile::tempdir().unwrap();
    for (epsg, origin, step_m) in [
        (3857, [15_420_000.0, 4_220_000.0], 150.0),
        (6676, [-20_000.0, -60_000.0], 25.0),
        (32654, [290_000.0, 3_915_000.0], 30.0),
    ] {
        let crs = from_epsg(epsg).unwrap();
        let world = format!("{step_m}\n0\n0\n-{step_m}\n{}\n{}\n", origin[0], origin[1]);
        let path = picture(folder.path(), &format!("{epsg}.jpg.png"), Some(&world));
        let image = MapImage::read(&path, Some(&crs)).unwrap();
        lands(&image, |column, row| to_lon_lat(&crs, origin[0] + step_m * column, origin[1] - step_m * row).unwrap());
    }
}

#[test]
fn a_tile_lands_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let web = from_epsg(3857).unwrap();
    let half_world_m = std::f64::consts::PI * 6_378_137.0;
    let tile_m = 2.0 * half_world_m / 1024.0;
    for name in ["10/906/403.png", "z10_x906_y403.png", "10-906-403.png"] {
        let image = MapImage::read(&picture(folder.path(), name, None), None).unwrap();
        lands(&image, |column, row| {
            let x = -half_world_m + tile_m * (906.0 + (column + 0.5) / f64::from(SIZE[0]));
            let y = half_world_m - tile_m * (403.0 + (row + 0.5) / f64::from(SIZE[1]));
            to_lon_lat(&web, x, y).unwrap()
        });
    }
}

#[test]
fn a_picture_fades_out_at_its_reach() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("black.png");
    RgbaImage::from_pixel(8, 8, Rgba([0, 0, 0, 255])).save(&path).unwrap();
    std::fs::write(path.with_extension("pgw"), "0.1\n0\n0\n-0.1\n137.65\n35.85\n").unwrap();
    let image = MapImage::read(&path, None).unwrap();
    let plane = AzimuthalPlane::new(138.0, 35.5).unwrap();
    let mut ground =
        vec![GroundPicture { reach_m: 2000.0, rgba: RgbaImage::from_pixel(41, 41, Rgba([200, 200, 200, 255])) }];
    let centre = DVec2::new(100.0, -200.0);
    let covered = image.lay_over(&mut ground, &plane, centre, 1000.0, 100.0);
    assert_eq!((covered, ground[0].rgba.width()), (1.0, 41));
    for (column, row, pixel) in ground[0].rgba.enumerate_pixels() {
        let p = DVec2::new(f64::from(column) * 100.0 - 2000.0, 2000.0 - f64::from(row) * 100.0);
        let share = ((1.0 - (p - centre).length() / 1000.0) / 0.3).clamp(0.0, 1.0);
        let expected = 200.0 * (1.0 - share);
        assert!((f64::from(pixel.0[0]) - expected).abs() <= 1.0 && pixel.0[3] == 255, "{p}: {pixel:?}, {expected}");
    }
    // the picture's fineness is kept where the map shows it
    let mut finer = white(2000.0);
    image.lay_over(&mut finer, &plane, DVec2::ZERO, 1000.0, 50.0);
    assert_eq!(finer[0].rgba.width(), 81);
    // half the disc lies off the picture
    let east = AzimuthalPlane::new(138.4, 35.5).unwrap();
    let half = image.lay_over(&mut white(2000.0), &east, DVec2::ZERO, 1000.0, 100.0);
    assert!((half - 0.5).abs() < 0.1, "{half}");
    let far = AzimuthalPlane::new(-70.0, -30.0).unwrap();
    assert_eq!(image.lay_over(&mut white(2000.0), &far, DVec2::ZERO, 1000.0, 100.0), 0.0);
}

#[test]
fn pictures_without_a_usable_place_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refusal = |name: &str, world: Option<&str>, crs: Option<&Crs>| {
        MapImage::read(&picture(folder.path(), name, world), crs).unwrap_err().to_string()
    };
    let turned = refusal("turned.png", Some("0.01\n0.002\n0\n-0.01\n138\n35\n"), None);
    assert!(turned.contains("turned.png: expected a picture that is north up"), "{turned}");
    let placeless = refusal("holiday.png", None, None);
    assert!(placeless.contains("holiday.png: expected a place on Earth"), "{placeless}");
    let no_tile = refusal("3-9-2.png", None, None);
    assert!(no_tile.contains("expected a place on Earth"), "a tile of no zoom level: {no_tile}");
    let broken = refusal("broken.png", Some("1 2 3"), None);
    assert!(broken.contains("expected six numbers"), "{broken}");
    let plain = refusal("photo.tif", None, None);
    assert!(plain.contains("expected a place on Earth"), "a TIFF without keys: {plain}");
    std::fs::write(folder.path().join("no.png"), b"not a picture").unwrap();
    assert!(MapImage::read(&folder.path().join("no.png"), None).is_err());
    assert!(MapImage::read(&folder.path().join("absent.png"), None).is_err());
}
