//! Terrain as coloured tiles: each pixel is the surface at its middle, coarse pixels are means, neighbours are one surface,
//! and a folder and an archive hold the same.

use glam::DVec2;
use std::path::Path;
use yamanami::core::{Crs, GeoReference, HeightField};
use yamanami::io::crs;
use yamanami::io::dem::{self, TileEncoding};
use yamanami::{
    Error, ExportJob, ExportKind, ExportOptions, ExportReport, ExportSubject, HeightTiles, OpenOptions, StoreOptions,
    SurfaceHeights, Terrain, export,
};

/// A grid of 90 × 80 samples of 20 m in a CRS, by a height at column and row.
fn terrain(epsg: u32, height_m: impl Fn(usize, usize) -> f32) -> Terrain {
    let crs = crs::from_epsg(epsg).unwrap();
    let [x, y] = crs::from_lon_lat(&crs, 138.7, 35.4).unwrap();
    let step = if crs.geographic { 20.0 / 100_000.0 } else { 20.0 };
    let (width, height) = (90, 80);
    let geo = GeoReference::new(crs, [x, y], [step, -step], [width, height]);
    let heights_m = (0..width * height).map(|i| height_m(i % width, i / width)).collect();
    Terrain::build(HeightField::new(width, height, heights_m, geo), "t".to_owned(), &|_| ()).unwrap()
}

fn hills(x: usize, y: usize) -> f32 {
    900.0 + 80.0 * (x as f32 * 0.21).sin() + 60.0 * (y as f32 * 0.33).cos() + x as f32
}

fn write(terrain: &mut Terrain, output: &Path, options: &ExportOptions) -> Result<ExportReport, Error> {
    let job = ExportJob { sources: &[], output, options, progress: &|_| () };
    export(ExportKind::TerrainRgb, ExportSubject::Terrain(terrain), &job)
}

fn tile(folder: &Path, [zoom, x, y]: [u32; 3], encoding: TileEncoding) -> Option<Vec<f32>> {
    let picture = image::open(folder.join(format!("{zoom}/{x}/{y}.png"))).ok()?.to_rgba8();
    Some(
        picture
            .pixels()
            .map(|p| if p.0[3] == 0 { f32::NAN } else { encoding.height_m([p.0[0], p.0[1], p.0[2]]) })
            .collect(),
    )
}

/// Longitude and latitude of a pixel's middle.
fn middle([zoom, x, y]: [u32; 3], side: u32, i: u32, j: u32) -> [f64; 2] {
    let n = f64::from(1u32 << zoom) * f64::from(side);
    let [across, down] = [x * side + i, y * side + j].map(|pixel| (f64::from(pixel) + 0.5) / n);
    [
        360.0 * (across - 0.5),
        (std::f64::consts::PI * (1.0 - 2.0 * down)).sinh().atan().to_degrees(),
    ]
}

#[test]
fn the_finest_zoom_is_the_surface_in_any_crs_and_encoding() {
    let folder = tempfile::tempdir().unwrap();
    for (epsg, tile_encoding, tile_px) in [
        (4326, TileEncoding::TerrainRgb, 256),
        (32654, TileEncoding::Terrarium, 256),
        (6676, TileEncoding::Gsi, 512),
        (3857, TileEncoding::TerrainRgb, 512),
    ] {
        let mut made = terrain(epsg, hills);
        let options = ExportOptions { tile_encoding, tile_px, ..ExportOptions::default() };
        let report = write(&mut made, folder.path(), &options).unwrap();
        let heights = SurfaceHeights::of(&made).unwrap();
        let tiles = HeightTiles::new(&heights, tile_px).unwrap();
        let zoom = tiles.full_zoom();
        assert_eq!(report.zooms.last().unwrap().zoom, zoom);
        let [columns, rows] = tiles.tiles(zoom);
        let mut seen = 0;
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            let Some(found) = tile(folder.path(), [zoom, x, y], tile_encoding) else { continue };
            for (k, z) in (0..).zip(&found) {
                let [lon, lat] = middle([zoom, x, y], tile_px, k % tile_px, k / tile_px);
                let place = heights.grid_from_lon_lat(lon, lat).unwrap();
                let exact = heights.at(0, &[place]).unwrap()[0];
                if !exact.is_nan() && !z.is_nan() {
                    // half a step, and a thousandth of a sample on the steepest slope
                    let most_m = 0.5 * tile_encoding.quantum_m() + 0.06;
                    assert!(f64::from((z - exact).abs()) <= most_m, "EPSG:{epsg}: {z} {exact} at {place}");
                    seen += 1;
                } else {
                    let rim = place.min(DVec2::new(89.0, 79.0) - place).min_element().abs();
                    assert!(exact.is_nan() == z.is_nan() || rim < 0.01, "{place}");
                }
            }
        }
        let samples_seen = f64::from(seen) / (89.0 * 79.0);
        assert!((0.5..6.0).contains(&samples_seen), "EPSG:{epsg}: {samples_seen} pixels a sample");
    }
}

#[test]
fn coarse_pixels_are_means_whatever_lies_between_samples() {
    let folder = tempfile::tempdir().unwrap();
    // every second sample a pit: all even samples are 0
    let mut made = terrain(3857, |x, y| if (x + y) % 2 == 0 { 0.0 } else { 100.0 });
    let options = ExportOptions { tile_encoding: TileEncoding::Terrarium, ..ExportOptions::default() };
    let report = write(&mut made, folder.path(), &options).unwrap();
    let heights = SurfaceHeights::of(&made).unwrap();
    let tiles = HeightTiles::new(&heights, 256).unwrap();
    for up in 3..6 {
        let zoom = tiles.full_zoom() - up;
        let [columns, rows] = tiles.tiles(zoom);
        let (mut sum, mut count) = (0.0, 0);
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            let found = tile(folder.path(), [zoom, x, y], TileEncoding::Terrarium).unwrap_or_default();
            for z in found.into_iter().filter(|z| !z.is_nan()) {
                assert!((40.0..60.0).contains(&z), "zoom {zoom}: {z}");
                (sum, count) = (sum + z, count + 1);
            }
        }
        assert!(count > 0 && (sum / count as f32 - 50.0).abs() < 2.0, "{}", sum / count as f32);
    }
    assert_eq!(report.zooms.last().unwrap().zoom, tiles.full_zoom());
    let facts: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("tiles.json")).unwrap()).unwrap();
    assert_eq!(facts["minzoom"], report.zooms[0].zoom);
}

#[test]
fn a_database_gives_the_same_tiles_as_the_grid_it_was_built_from() {
    let folder = tempfile::tempdir().unwrap();
    let [yama, a, b, archive] = ["t.yama", "a", "b", "c.pmtiles"].map(|name| folder.path().join(name));
    let holes = |x: usize, y: usize| if (20..30).contains(&x) && y > 40 { f32::NAN } else { hills(x, y) };
    let mut grid = terrain(32654, holes);
    grid.store_as(&yama, &StoreOptions::default(), &|_| ()).unwrap();
    let mut paged = Terrain::open(&[yama], &OpenOptions::default(), &|_| ()).unwrap();
    let options = ExportOptions::default();
    let report = write(&mut grid, &a, &options).unwrap();
    assert_eq!(write(&mut paged, &b, &options).unwrap(), report);
    let archived = write(&mut grid, &archive, &options).unwrap();
    assert_eq!(archived.zooms, report.zooms);
    for zoom in &report.zooms {
        for column in std::fs::read_dir(a.join(zoom.zoom.to_string())).unwrap() {
            let column = column.unwrap().path();
            for file in std::fs::read_dir(&column).unwrap() {
                let file = file.unwrap().path();
                let other = b.join(file.strip_prefix(&a).unwrap());
                assert_eq!(std::fs::read(&file).unwrap(), std::fs::read(other).unwrap());
            }
        }
    }
    // what is written is read as the same ground
    let options = dem::OpenOptions { tile_encoding: Some(TileEncoding::TerrainRgb), ..dem::OpenOptions::default() };
    let back = dem::open(&[a], &options).unwrap().read_all().unwrap();
    let [low, high] = back.range_m().unwrap();
    let [from, to] = grid.range_m();
    assert!((low - from).abs() < 8.0 && (high - to).abs() < 8.0, "{low} to {high}, {from} to {to}");
    assert!(back.no_data_count() > 0);
}

#[test]
fn a_terrain_on_the_date_line_has_tiles_on_both_sides() {
    let crs = Crs { epsg: Some(4326), geographic: true, name: "WGS 84".into(), ..Crs::default() };
    let geo = GeoReference::new(crs, [179.9, 10.0], [0.005, -0.005], [41, 41]);
    let field = HeightField::new(41, 41, vec![7.0; 41 * 41], geo);
    let mut made = Terrain::build(field, "t".to_owned(), &|_| ()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let options = ExportOptions { zooms: Some([4, 4]), ..ExportOptions::default() };
    write(&mut made, folder.path(), &options).unwrap();
    for x in [0, 15] {
        let found = tile(folder.path(), [4, x, 7], TileEncoding::TerrainRgb).unwrap();
        assert!(found.iter().any(|z| (z - 7.0).abs() < 0.06), "column {x}");
    }
}

#[test]
fn what_cannot_be_placed_is_refused_in_a_line() {
    let field = HeightField::new(9, 9, vec![1.0; 81], GeoReference::local([10.0; 2], 9));
    let mut made = Terrain::build(field, "t".to_owned(), &|_| ()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("tiles");
    let line = write(&mut made, &output, &ExportOptions::default()).unwrap_err().to_string();
    assert!(line.contains("--crs") && !line.contains('\n'), "{line}");
    assert!(!output.exists());
}
