//! Maps' ground from made files, of which every height is known, and from the shared data where they are at hand.

use super::*;
use crate::{StoreOptions, Terrain};
use glam::DVec2;
use std::path::Path;
use yamanami_core::{GeoReference, HeightField};
use yamanami_io::crs;

/// Rolling hills of a longitude and latitude, metres.
fn hills(lon: f64, lat: f64) -> f64 {
    500.0 + 300.0 * (lon * 90.0).sin() * (lat * 110.0).cos()
}

/// A file of heights of longitudes and latitudes: `size` samples around a place of a CRS.
fn file(
    path: &Path,
    epsg: u32,
    centre: [f64; 2],
    step: f64,
    size: [usize; 2],
    height: impl Fn(f64, f64) -> f64,
) -> PathBuf {
    let field = made(epsg, centre, step, size, height);
    dem::write_geotiff(path, &field).unwrap();
    path.to_owned()
}

fn made(epsg: u32, centre: [f64; 2], step: f64, size: [usize; 2], height: impl Fn(f64, f64) -> f64) -> HeightField {
    let crs = crs::from_epsg(epsg).unwrap();
    let [x, y] = crs::from_lon_lat(&crs, centre[0], centre[1]).unwrap();
    let origin = [x - step * (size[0] / 2) as f64, y + step * (size[1] / 2) as f64];
    let geo = GeoReference::new(crs.clone(), origin, [step, -step], size);
    let z = |k: usize| {
        let [x, y] = geo.source_from_grid((k % size[0]) as f64, (k / size[0]) as f64);
        let [lon, lat] = crs::to_lon_lat(&crs, x, y).unwrap();
        height(lon, lat) as f32
    };
    let heights_m = (0..size[0] * size[1]).map(z).collect();
    HeightField::new(size[0], size[1], heights_m, geo)
}

fn read(paths: &[PathBuf], options: &MapGroundOptions) -> Result<MapGround, Error> {
    MapSources::open(paths, &dem::OpenOptions::default())?.read(options)
}

/// 8 km around a place with 100 m between samples.
fn small(centre_lon_lat: [f64; 2]) -> MapGroundOptions {
    let (radius_m, spacing_m, finest_spacing_m) = (8e3, 100.0, 100.0);
    MapGroundOptions { radius_m, spacing_m, finest_spacing_m, ..MapGroundOptions::around(centre_lon_lat) }
}

/// Largest difference of a level's known heights from those of a function.
fn worst(ground: &MapGround, level: usize, height: impl Fn(f64, f64) -> f64) -> f64 {
    let level = &ground.field.levels()[level];
    let width = level.width();
    let error = |k: usize| {
        let [lon, lat] = ground.plane.to_lon_lat(level.plane_from_grid(k % width, k / width));
        (f64::from(level.heights_m()[k]) - height(lon, lat)).abs()
    };
    (0..width * width).filter(|&k| level.known()[k]).map(error).fold(0.0, f64::max)
}

const FUJI: [f64; 2] = [138.7274, 35.3606];
const SECOND: f64 = 1.0 / 3600.0;

#[test]
fn heights_lie_where_they_belong_whatever_the_system() {
    let folder = tempfile::tempdir().unwrap();
    for (epsg, step) in [(4326, 3.0 * SECOND), (32654, 80.0), (3857, 100.0), (6676, 80.0)] {
        let path = file(&folder.path().join(format!("{epsg}.tif")), epsg, FUJI, step, [281, 281], hills);
        let ground = read(&[path], &small(FUJI)).unwrap();
        let off = worst(&ground, 0, hills);
        assert!(off < 0.4, "EPSG:{epsg} is {off} m off");
        assert_eq!((ground.known_share, ground.sources.len(), ground.field.levels().len()), (1.0, 1, 1));
    }
}

#[test]
fn finer_grids_go_as_far_as_the_data() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder.path().join("a.tif"), 32654, FUJI, 60.0, [401, 401], hills);
    let options = MapGroundOptions { spacing_m: 200.0, finest_spacing_m: 10.0, ..small(FUJI) };
    let ground = read(&[path], &options).unwrap();
    let spacings: Vec<f64> = ground.field.levels().iter().map(|l| l.spacing_m()).collect();
    assert_eq!(spacings, [200.0, 100.0, 50.0]);
    assert!((0..3).all(|level| worst(&ground, level, hills) < 0.2));
    let [coarse, fine] = [&ground.field.levels()[1], &ground.field.levels()[2]];
    assert_eq!(coarse.height_m(DVec2::new(700.0, -300.0)), fine.height_m(DVec2::new(700.0, -300.0)));
}

#[test]
fn a_finer_source_fades_into_a_coarser_one() {
    let folder = tempfile::tempdir().unwrap();
    let coarse = file(&folder.path().join("c.tif"), 4326, FUJI, 10.0 * SECOND, [101, 101], |_, _| 100.0);
    let fine = file(&folder.path().join("f.tif"), 32654, FUJI, 50.0, [161, 161], |_, _| 130.0);
    // the order in which they are given does not matter: the finer stands above
    let ground = read(&[coarse.clone(), fine.clone()], &small(FUJI)).unwrap();
    let turned = read(&[fine, coarse], &small(FUJI)).unwrap();
    assert_eq!((&ground.field, &ground.sources), (&turned.field, &turned.sources));
    let height = |x: f64| ground.field.height_m(DVec2::new(x, 0.0));
    assert_eq!([height(0.0), height(6000.0)], [130.0, 100.0]);
    let steps = (0..70).map(|k| height(100.0 * f64::from(k)) - height(100.0 * f64::from(k + 1)));
    assert!(steps.into_iter().all(|step| (-1e-3..6.0).contains(&step)), "no step is seen");
    let shares: Vec<f64> = ground.sources.iter().map(|s| s.share).collect();
    assert!(shares[0] > 0.2 && shares[1] > 0.6 && (shares[0] + shares[1] - 1.0).abs() < 1e-6, "{shares:?}");
    assert!(ground.sources[0].path.ends_with("f.tif") && ground.sources[0].spacing_m == 50.0);
}

#[test]
fn tiles_join_without_a_seam() {
    let folder = tempfile::tempdir().unwrap();
    let step = 3.0 * SECOND;
    let tile = |name: &str, turn: f64| {
        let centre = [FUJI[0] + turn * 150.0 * step, FUJI[1]];
        file(&folder.path().join(name), 4326, centre, step, [300, 301], hills)
    };
    let ground = read(&[tile("w.tif", -1.0), tile("e.tif", 1.0)], &small(FUJI)).unwrap();
    assert!(worst(&ground, 0, hills) < 0.4 && ground.known_share == 1.0);
    assert_eq!((ground.sources.len(), ground.sources[0].files), (1, 2));
}

#[test]
fn the_antimeridian_is_no_border() {
    let folder = tempfile::tempdir().unwrap();
    let step = 3.0 * SECOND;
    let near = |lon: f64, lat: f64| hills(lon.rem_euclid(360.0), lat);
    let east = file(&folder.path().join("e.tif"), 4326, [180.0 - 150.0 * step, 52.0], step, [300, 301], near);
    let west = file(&folder.path().join("w.tif"), 4326, [-180.0 + 150.0 * step, 52.0], step, [300, 301], near);
    let ground = read(&[east, west], &small([-179.999, 52.0])).unwrap();
    assert!(worst(&ground, 0, near) < 0.4 && ground.known_share == 1.0);
}

#[test]
fn what_is_not_covered_is_said_and_no_data_may_be_the_sea() {
    let folder = tempfile::tempdir().unwrap();
    let centre = [FUJI[0] - 140.0 * 3.0 * SECOND, FUJI[1]];
    let west = |lon: f64, _: f64| if lon < FUJI[0] - 0.05 { 0.0f64.ln().abs() } else { 7.0 };
    let path = file(&folder.path().join("a.tif"), 4326, centre, 3.0 * SECOND, [282, 301], west);
    let ground = read(std::slice::from_ref(&path), &small(FUJI)).unwrap();
    assert!(ground.known_share > 0.2 && ground.known_share < 0.4, "{}", ground.known_share);
    let ground = read(&[path], &MapGroundOptions { no_data: NoData::Sea, ..small(FUJI) }).unwrap();
    assert!(ground.known_share > 0.48 && ground.known_share < 0.53, "{}", ground.known_share);
    assert_eq!(ground.field.height_m(DVec2::new(-7000.0, 0.0)), 0.0);
}

#[test]
fn a_database_gives_the_same_ground_as_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder.path().join("a.tif"), 4326, FUJI, 2.0 * SECOND, [331, 401], hills);
    let terrain = Terrain::open(std::slice::from_ref(&path), &crate::OpenOptions::default(), &|_| ()).unwrap();
    let stored = folder.path().join("a.yama");
    terrain.store_as(&stored, &StoreOptions::default(), &|_| ()).unwrap();
    let options = MapGroundOptions { spacing_m: 50.0, finest_spacing_m: 50.0, radius_m: 4e3, ..small(FUJI) };
    let [a, b] = [&path, &stored].map(|p| read(std::slice::from_ref(p), &options).unwrap());
    assert_eq!(a.field, b.field);
    // of a coarser level, and up to the database's border, where the lattice ends between two points
    let ground = read(&[stored], &MapGroundOptions { spacing_m: 240.0, ..small(FUJI) }).unwrap();
    assert!(worst(&ground, 0, hills) < 8.0, "{}", worst(&ground, 0, hills));
}

#[test]
fn holes_of_a_database_stay_holes() {
    let folder = tempfile::tempdir().unwrap();
    let west = |lon: f64, lat: f64| if lon < FUJI[0] { f64::NAN } else { hills(lon, lat) };
    let field = made(4326, FUJI, 3.0 * SECOND, [300, 300], west);
    let stored = folder.path().join("a.yama");
    let terrain = Terrain::build(field, "a".to_owned(), &|_| ()).unwrap();
    terrain.store_as(&stored, &StoreOptions::default(), &|_| ()).unwrap();
    let ground = read(&[stored], &small(FUJI)).unwrap();
    assert!((ground.known_share - 0.5).abs() < 0.01, "{}", ground.known_share);
    assert!(ground.field.is_known(DVec2::new(500.0, 0.0)) && !ground.field.is_known(DVec2::new(-500.0, 0.0)));
}

#[test]
fn the_same_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let coarse = file(&folder.path().join("c.tif"), 4326, FUJI, 10.0 * SECOND, [101, 101], hills);
    let fine = file(&folder.path().join("f.tif"), 32654, FUJI, 50.0, [161, 161], hills);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| read(&[coarse.clone(), fine.clone()], &small(FUJI)).unwrap())
    };
    let (one, three) = (on(1), on(3));
    assert_eq!((one.field, one.sources), (three.field, three.sources));
}

#[test]
fn bad_requests_are_refused_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder.path().join("a.tif"), 4326, FUJI, 3.0 * SECOND, [40, 40], |_, _| f64::NAN);
    let bare = folder.path().join("bare.asc");
    std::fs::write(&bare, "ncols 3\nnrows 3\nxllcenter 500000\nyllcenter 4000000\ncellsize 10\n1 2 3 4 5 6 7 8 9\n")
        .unwrap();
    let refused = |paths: &[&PathBuf], options: MapGroundOptions| {
        let paths: Vec<PathBuf> = paths.iter().map(|p| (*p).clone()).collect();
        let message = read(&paths, &options).unwrap_err().to_string();
        assert!(!message.contains('\n'), "{message}");
        message
    };
    let message = refused(&[&path], small([140.0, 36.0]));
    assert!(
        message.contains("latitude 36, longitude 140") && message.contains("latitudes 35.3448 to 35.3773"),
        "{message}"
    );
    assert!(refused(&[&path], small([FUJI[0], 95.0])).contains("95"));
    assert!(refused(&[&path], small(FUJI)).contains("no heights"));
    assert!(refused(&[&bare], small(FUJI)).contains("bare.asc"));
    assert!(refused(&[], small(FUJI)).contains("none given"));
    for (radius_m, spacing_m) in [(0.0, 10.0), (f64::NAN, 10.0), (1e9, 10.0), (1e6, 1.0), (100.0, 0.0), (100.0, 200.0)]
    {
        refused(&[&path], MapGroundOptions { radius_m, spacing_m, ..small(FUJI) });
    }
}

fn shared(names: &[&str]) -> Option<Vec<PathBuf>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/dem");
    let paths: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
    let is_here = paths.iter().all(|path| path.exists());
    is_here.then_some(paths)
}

#[test]
fn fuji_of_a_tile_in_the_grids_of_half_of_japan() {
    let names = [
        "fuji_terrainrgb_z10_x906_y404_512px.png",
        "central_japan_srtm30_300x300_int16.tif",
        "japan_alps_fuji_30s_480x360_int16.tif",
    ];
    let Some(paths) = shared(&names) else { return };
    let options = MapGroundOptions { radius_m: 80e3, spacing_m: 400.0, ..MapGroundOptions::around(FUJI) };
    let ground = read(&paths, &options).unwrap();
    let spacings: Vec<f64> = ground.field.levels().iter().map(|l| l.spacing_m()).collect();
    assert_eq!(spacings, [400.0, 200.0, 100.0, 50.0]);
    assert!(ground.sources.len() >= 2 && ground.sources[0].path.ends_with(names[0]), "{:?}", ground.sources);
    // the tile says 3751 m where the summit, of 3776 m, is
    let [_, highest] = ground.field.range_m();
    assert!((3735.0..3760.0).contains(&highest), "{highest}");
    assert!(ground.field.height_m(DVec2::ZERO) > 3500.0);
    assert!(ground.known_share > 0.8, "{}", ground.known_share);
}
