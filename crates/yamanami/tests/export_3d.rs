//! Whole exports of 3D Tiles: what is written is what the description says, an archive holds the same, a stopped run goes on.

use std::path::Path;
use yamanami::{
    ExportJob, ExportKind, ExportOptions, ExportReport, ExportSubject, GlbPacking, ModelBuild, Terrain, export,
};
use yamanami_core::{GeoReference, HeightField};
use yamanami_io::crs::{from_epsg, geographic_from_ecef};
use yamanami_io::mesh_file::read_mesh;
use yamanami_io::tiles::subtree::{Subtree, TileBounds};
use yamanami_io::tiles::tileset::{Subdivision, Tileset};
use yamanami_io::tiles::{TileFolder, TileOutput, read_3tz};
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain, models};

fn hills() -> Terrain {
    let field = SyntheticTerrain::new(140, 120, Shape::mountains(7), Spacing::Metres(30.0)).to_field();
    let geo = GeoReference::new(from_epsg(32611).unwrap(), [380e3, 3_800e3], [30.0, -30.0], [140, 120]);
    let field = HeightField::new(140, 120, field.into_heights_m(), geo);
    Terrain::build(field, "hills".to_owned(), &|_| ()).unwrap()
}

fn write(kind: ExportKind, subject: ExportSubject<'_>, output: &Path, options: &ExportOptions) -> ExportReport {
    export(kind, subject, &ExportJob { sources: &[], output, options, progress: &|_| () }).unwrap()
}

fn options() -> ExportOptions {
    ExportOptions { tolerance_m: Some(3.0), zooms: Some([0, 2]), ..ExportOptions::default() }
}

#[test]
fn a_terrain_is_where_it_is_on_the_globe() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("hills");
    let report = write(ExportKind::Tiles3d, ExportSubject::Terrain(&mut hills()), &folder, &options());
    assert!(report.notes[0].contains("--heights orthometric"));
    let bytes = std::fs::read(folder.join("tileset.json")).unwrap();
    let tileset = Tileset::read(Path::new("tileset.json"), &bytes).unwrap();
    let implicit = tileset.root.implicit_tiling.clone().unwrap();
    assert_eq!((implicit.subdivision_scheme, implicit.available_levels), (Subdivision::Quadtree, 3));
    let bytes = std::fs::read(folder.join("subtrees/0/0/0.subtree")).unwrap();
    let subtree = Subtree::decode(Path::new("s"), &bytes, Subdivision::Quadtree, implicit.subtree_levels).unwrap();
    let tiles = subtree.contents.iter().filter(|&&there| there).count() as u64;
    assert_eq!(tiles, report.zooms.iter().map(|z| z.tiles).sum::<u64>());
    assert_eq!(subtree.facts.len() as u64, tiles);
    // errors nest, and who only halves the root's never understates
    for (k, facts) in subtree.facts.iter().enumerate() {
        let level = [0, 1, 1, 1, 1].get(k).copied().unwrap_or(2);
        assert!(facts.error_m <= subtree.facts[0].error_m);
        assert!(facts.error_m <= tileset.root.geometric_error / f64::from(1 << level) + 1e-9);
    }
    // vertices lie in their tile's region: glTF's y up became z up, and the root's transform leads to the globe
    let m = tileset.root.transform.unwrap();
    let mesh = read_mesh(folder.join("content/0/0/0.glb")).unwrap();
    let TileBounds::Region([west, south, east, north, low, high]) = subtree.facts[0].bounds else { unreachable!() };
    for p in &mesh.positions {
        let ecef = [0, 1, 2].map(|r| m[r] * p.x + m[4 + r] * p.y + m[8 + r] * p.z + m[12 + r]);
        let [lon, lat, height_m] = geographic_from_ecef(ecef.into());
        assert!((west..east).contains(&lon) && (south..north).contains(&lat) && (low..high).contains(&height_m));
    }
    assert!((mesh.bounds().max.z - mesh.bounds().min.z) < 0.5 * (mesh.bounds().max.x - mesh.bounds().min.x));
    assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 1);
}

#[test]
fn a_stopped_run_goes_on() {
    let root = tempfile::tempdir().unwrap();
    let (whole, resumed) = (root.path().join("whole"), root.path().join("resumed"));
    let first = write(ExportKind::Tiles3d, ExportSubject::Terrain(&mut hills()), &whole, &options());
    let options = options();
    let job = ExportJob { sources: &[], output: &resumed, options: &options, progress: &|_| () };
    let stopped = TileFolder::create(&resumed, &job.identity(ExportKind::Tiles3d)).unwrap();
    for path in ["content/0/0/0.glb", "content/1/1/0.glb", "content/2/1/2.glb"] {
        stopped.put(path, &std::fs::read(whole.join(path)).unwrap()).unwrap();
    }
    let second = export(ExportKind::Tiles3d, ExportSubject::Terrain(&mut hills()), &job).unwrap();
    assert_eq!((second.kept, second.zooms), (3, first.zooms));
    for path in ["tileset.json", "subtrees/0/0/0.subtree", "content/2/2/2.glb"] {
        assert!(std::fs::read(whole.join(path)).unwrap() == std::fs::read(resumed.join(path)).unwrap(), "{path}");
    }
}

#[test]
fn an_archive_holds_the_same_files() {
    let root = tempfile::tempdir().unwrap();
    let (folder, archive) = (root.path().join("hills"), root.path().join("hills.3tz"));
    write(ExportKind::Tiles3d, ExportSubject::Terrain(&mut hills()), &folder, &options());
    write(ExportKind::Tiles3tz, ExportSubject::Terrain(&mut hills()), &archive, &options());
    for path in ["tileset.json", "subtrees/0/0/0.subtree", "content/1/0/1.glb"] {
        assert_eq!(read_3tz(&archive, path).unwrap().unwrap(), std::fs::read(folder.join(path)).unwrap(), "{path}");
    }
    assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 2, "nothing is left beside the archive");
}

#[test]
fn one_file_has_the_front_that_was_asked_for() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("ring.glb");
    let mut mesh = models::torus(60, 40, 0.02);
    mesh.colours = (0..mesh.positions.len()).map(|i| [(i % 251) as u8, 90, 7, 255]).collect();
    let mut model = ModelBuild::of_mesh(&mesh, "ring".to_owned(), &|_| ()).unwrap().into_model().unwrap();
    let mut sizes = Vec::new();
    for packing in [GlbPacking::Plain, GlbPacking::Quantised, GlbPacking::Meshopt] {
        let options = ExportOptions { packing, budget_triangles: Some(3000), ..ExportOptions::default() };
        let report = write(ExportKind::Glb, ExportSubject::Model(&mut model), &path, &options);
        let read = read_mesh(&path).unwrap();
        assert!(read.triangles.len() <= 3000 && read.triangles.len() as u64 == report.zooms[0].triangles);
        assert!(!read.normals.is_empty() && read.colours.iter().all(|c| c[1] == 90 && c[3] == 255));
        sizes.push(report.zooms[0].bytes);
    }
    assert!(sizes[0] > sizes[1] && sizes[1] > 2 * sizes[2], "{sizes:?}");
}
