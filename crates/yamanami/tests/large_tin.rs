//! TINs built tile by tile on the disk are what they would be in memory: every vertex, every face, no crack, errors that hold.

use glam::DVec3;
use std::path::PathBuf;
use yamanami::core::{Breakline, BreaklineKind, Hierarchy, Surface, Tin, TriangleMesh};
use yamanami::io::{dem, tin_file};
use yamanami::measure::tin::{PlanIndex, vertical_difference};
use yamanami::{FileTiles, GridTiles, GroundOptions, Model, Subject, build_tiles};
use yamanami_testkit::SyntheticTerrain;
use yamanami_testkit::laws::hierarchy_law;

/// The faces of a mesh by the places of their corners.
fn faces(mesh: &TriangleMesh) -> Vec<[[u64; 3]; 3]> {
    let mut faces: Vec<[[u64; 3]; 3]> = (0..mesh.triangles.len())
        .map(|t| {
            let mut corners = mesh.corners(t).map(|p| (p + DVec3::ZERO).to_array().map(f64::to_bits));
            let least = (0..3).min_by_key(|&k| corners[k]).unwrap();
            corners.rotate_left(least);
            corners
        })
        .collect();
    faces.sort_unstable();
    faces
}

/// Loads everything and looks at fronts of several errors.
fn check(model: &mut Model, source: &TriangleMesh) {
    let all: Vec<u32> = (0..model.surface().node_bound()).collect();
    model.load(&all, usize::MAX).unwrap();
    hierarchy_law(model.surface());
    let index = PlanIndex::new(source);
    for tolerance_m in [0.5f32, 4.0, 40.0] {
        let surface = model.surface();
        let front = surface.mesh_of(&|n: u32| surface.error_m(n) > tolerance_m);
        let difference = vertical_difference(&front, &index);
        assert!(difference.max_m <= f64::from(tolerance_m) + 1e-6, "{} of {tolerance_m} m", difference.max_m);
        assert!(front.triangles.len() < source.triangles.len());
    }
}

#[test]
fn the_cells_of_a_grid_in_tiles_are_its_cells() {
    let folder = tempfile::tempdir().unwrap();
    let field = SyntheticTerrain::mountains(1100, 40, 3).to_field();
    dem::write_geotiff(&folder.path().join("a.tif"), &field).unwrap();
    let source = dem::open(&[folder.path().join("a.tif")], &dem::OpenOptions::default()).unwrap();
    let tiles = GridTiles::new(source, "a".into()).unwrap();
    let path = folder.path().join("a.yama");
    build_tiles(&tiles, &path, &|_| ()).unwrap();
    let mut model = Model::open(&path, &|_| ()).unwrap();
    model.store().unwrap().verify().unwrap();
    let meta = model.store().unwrap().meta().clone();
    assert_eq!((meta.source_faces, meta.source_vertices), (2 * 1099 * 39, 1100 * 40));
    let tin = model.whole_tin().unwrap();
    assert_eq!(tin.mesh.triangles.len(), 2 * 1099 * 39);
    let geo = field.geo();
    for p in tin.mesh.positions.iter().step_by(97) {
        let [column, row] = geo.grid_from_source(p.x, p.y);
        assert_eq!(p.z as f32, field.at(column.round() as usize, row.round() as usize));
    }
    check(&mut model, &tin.mesh);
}

/// Hills on a shaken grid, with a breakline along its edges.
fn hills() -> Tin {
    let n = 60;
    let place = |i: usize, j: usize| {
        let shake = |k: usize| ((k * 7919) % 101) as f64 / 404.0;
        let (x, y) = (i as f64 + shake(i * 31 + j), j as f64 + shake(i + j * 17));
        DVec3::new(5000.0 + 3.0 * x, -200.0 + 3.0 * y, 9.0 * (0.2 * x).sin() * (0.17 * y).cos())
    };
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| place(i, j))).collect();
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    let cells = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let triangles = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let points = (5..n).map(|i| place(i, i)).collect();
    let line = Breakline { name: "crest".into(), kind: BreaklineKind::Hard, points };
    Tin { breaklines: vec![line], ..Tin::of_mesh("hills", TriangleMesh::new(positions, triangles)) }
}

#[test]
fn sheets_beside_each_other_are_one_tin() {
    let folder = tempfile::tempdir().unwrap();
    let whole = hills();
    let middle = whole.mesh.bounds().centre();
    let files: Vec<PathBuf> = (0..4)
        .map(|sheet| {
            let is_here = |t: &&[u32; 3]| {
                let p = t.iter().map(|&v| whole.mesh.positions[v as usize]).sum::<DVec3>() / 3.0;
                usize::from(p.x > middle.x) + 2 * usize::from(p.y > middle.y) == sheet
            };
            let triangles = whole.mesh.triangles.iter().filter(is_here).copied().collect();
            let mesh = TriangleMesh::new(whole.mesh.positions.clone(), triangles);
            let breaklines = if sheet == 0 { whole.breaklines.clone() } else { Vec::new() };
            let path = folder.path().join(format!("{sheet}.xml"));
            tin_file::write_tin(&path, &Tin { mesh, breaklines, ..Tin::default() }).unwrap();
            path
        })
        .collect();
    let tiles = FileTiles::read(&files, &GroundOptions::default(), folder.path(), &|_| ()).unwrap();
    let path = folder.path().join("whole.yama");
    build_tiles(&tiles, &path, &|_| ()).unwrap();
    let mut model = Model::open(&path, &|_| ()).unwrap();
    let tin = model.whole_tin().unwrap();
    assert!(faces(&tin.mesh) == faces(&whole.mesh), "the sheets together are another TIN");
    assert_eq!(tin.breaklines, whole.breaklines);
    check(&mut model, &whole.mesh);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 5, "no scratch is left");
}
