//! Tile trees of terrains: what is in them, resumed runs, databases, and clear refusals.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use yamanami::core::{HeightField, Tin};
use yamanami::io::tiles::{TileFolder, TileOutput};
use yamanami::io::tin_file::{TinReadOptions, read_tin};
use yamanami::{
    ExportJob, ExportKind, ExportOptions, ExportReport, ExportSubject, Fill, OpenOptions, StoreOptions, Terrain, export,
};
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

fn field() -> HeightField {
    SyntheticTerrain::new(140, 111, Shape::mountains(3), Spacing::ArcSeconds(3.0)).to_field()
}

fn terrain() -> Terrain {
    Terrain::build(field(), "hills".into(), &|_| ()).unwrap()
}

fn options() -> ExportOptions {
    ExportOptions { tolerance_m: Some(20.0), zooms: Some([0, 12]), ..ExportOptions::default() }
}

fn run(terrain: &mut Terrain, sources: &[PathBuf], output: &Path, options: &ExportOptions) -> ExportReport {
    let job = ExportJob { sources, output, options, progress: &|_| () };
    export(ExportKind::QuantizedMesh, ExportSubject::Terrain(terrain), &job).unwrap()
}

/// All files of a tree.
fn files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut out = BTreeMap::new();
    let mut open = vec![root.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
                out.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    out
}

fn read(path: &Path) -> Tin {
    read_tin(path, &TinReadOptions::default()).unwrap().tin
}

#[test]
fn a_pyramid_has_what_its_layer_says() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("tiles");
    let report = run(&mut terrain(), &[], &out, &options());
    let layer: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("layer.json")).unwrap()).unwrap();
    assert_eq!((&layer["scheme"], &layer["projection"]), (&"tms".into(), &"EPSG:4326".into()));
    let available = layer["available"].as_array().unwrap();
    assert_eq!(available.len(), 13);
    let mut count = 0;
    for (zoom, ranges) in available.iter().enumerate() {
        for range in ranges.as_array().unwrap() {
            let [x0, x1, y0, y1] = ["startX", "endX", "startY", "endY"].map(|k| range[k].as_u64().unwrap());
            for (x, y) in (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| (x, y))) {
                let tin = read(&out.join(format!("{zoom}/{x}/{y}.terrain")));
                assert!(!tin.mesh.triangles.is_empty());
                count += 1;
            }
        }
    }
    assert_eq!(count, report.zooms.iter().map(|z| z.tiles).sum::<u64>());
    assert_eq!((report.zooms[0].tiles, files(&out).len() as u64), (2, count + 2), "both roots, layer and mark");
    let errors: Vec<f64> = report.zooms.iter().map(|z| z.error_m).collect();
    assert!(errors[12] < 40.0 && errors[12] > 1.0, "{errors:?}");
}

#[test]
fn a_stopped_run_goes_on_and_ends_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, again) = (folder.path().join("whole"), folder.path().join("again"));
    let source = [folder.path().join("dem.tif")];
    run(&mut terrain(), &source, &whole, &options());
    let expected = files(&whole);
    let tiles: Vec<_> = expected.iter().filter(|(name, _)| name.ends_with(".terrain")).collect();
    let options = options();
    {
        let job = ExportJob { sources: &source, output: &again, options: &options, progress: &|_| () };
        let killed = TileFolder::create(&again, &job.identity(ExportKind::QuantizedMesh)).unwrap();
        tiles.iter().step_by(2).for_each(|(name, bytes)| killed.put(name, bytes).unwrap());
    }
    let report = run(&mut terrain(), &source, &again, &options);
    assert_eq!(report.kept as usize, tiles.len().div_ceil(2));
    assert!(files(&again) == expected, "the trees differ");
}

#[test]
fn a_database_gives_the_same_tiles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hills.yama");
    let options = options();
    let exact = StoreOptions { error_steps_per_octave: 2048, ..StoreOptions::default() };
    terrain().store_as(&path, &exact, &|_| ()).unwrap();
    let mut paged = Terrain::open(&[path], &OpenOptions::default(), &|_| ()).unwrap();
    let (a, b) = (folder.path().join("a"), folder.path().join("b"));
    run(&mut terrain(), &[], &a, &options);
    run(&mut paged, &[], &b, &options);
    assert!(files(&a) == files(&b), "the trees differ");
}

#[test]
fn without_fill_there_is_ground_only_where_there_is_data() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("tiles");
    let options = ExportOptions { fill: Fill::Nothing, zooms: Some([6, 12]), ..options() };
    let report = run(&mut terrain(), &[], &out, &options);
    assert_eq!(report.zooms.len(), 7);
    let layer = std::fs::read_to_string(out.join("layer.json")).unwrap();
    assert!(layer.contains("\"minzoom\": 6"), "{layer}");
}

#[test]
fn refusals_are_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let local = SyntheticTerrain::new(20, 20, Shape::mountains(3), Spacing::Metres(10.0)).to_field();
    let mut terrain = Terrain::build(local, "hills".into(), &|_| ()).unwrap();
    let out = folder.path().join("tiles");
    let options = options();
    let job = ExportJob { sources: &[], output: &out, options: &options, progress: &|_| () };
    let error = export(ExportKind::QuantizedMesh, ExportSubject::Terrain(&mut terrain), &job).unwrap_err().to_string();
    assert!(error.contains("--crs"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
}
