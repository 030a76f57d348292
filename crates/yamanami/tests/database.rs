//! A terrain from its database behaves as the one it was stored from: same heights, same fronts, errors no smaller.

use yamanami::core::{Hierarchy, View};
use yamanami::{Canvas, Criteria, Data, DrawWith, OpenOptions, Scene, StoreOptions, Terrain, ViewCriterion, extract};
use yamanami_testkit::{Holes, SyntheticTerrain};

fn stored(terrain: &SyntheticTerrain, options: &StoreOptions) -> (Terrain, Terrain, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.yama");
    let grid = Terrain::build(terrain.to_field(), "t".to_owned(), &|_| ()).unwrap();
    grid.store_as(&path, options, &|_| ()).unwrap();
    let paged = Terrain::open(&[path], &OpenOptions::default(), &|_| ()).unwrap();
    (grid, paged, folder)
}

fn exact() -> StoreOptions {
    StoreOptions { error_steps_per_octave: 2048, ..StoreOptions::default() }
}

fn terrains() -> Vec<SyntheticTerrain> {
    vec![
        SyntheticTerrain::mountains(257, 257, 1),
        SyntheticTerrain::mountains(700, 300, 2).rounded_to(1.0),
        SyntheticTerrain::mountains(530, 401, 3).rounded_to(0.1).with_holes(Holes::Discs { count: 9, seed: 4 }),
        SyntheticTerrain::mountains(2, 2, 4),
    ]
}

#[test]
fn heights_come_back_to_the_bit() {
    for t in terrains() {
        let (grid, paged, _folder) = stored(&t, &exact());
        assert_eq!(grid.full_heights_m().unwrap(), paged.full_heights_m().unwrap());
        paged.store().unwrap().verify().unwrap();
    }
}

#[test]
fn the_same_mesh_is_extracted_from_a_database_with_exact_errors() {
    for t in terrains() {
        let (mut grid, mut paged, _folder) = stored(&t, &exact());
        for tolerance_m in [2.0, 25.0] {
            let criteria = Criteria { terrain_tolerance_m: tolerance_m, ..Criteria::default() };
            let (a, b) = (extract(&mut grid, &criteria).unwrap(), extract(&mut paged, &criteria).unwrap());
            assert_eq!(a.mesh, b.mesh, "{:?} at {tolerance_m} m", grid.size());
        }
    }
}

#[test]
fn errors_rounded_up_are_still_a_hierarchy() {
    for t in terrains() {
        let (grid, paged, _folder) = stored(&t, &StoreOptions::default());
        for level in 0..=paged.surface().numbers().lattice().levels() {
            paged.load_level(level).unwrap();
        }
        for node in (0..grid.surface().node_bound()).filter(|&n| grid.surface().exists(n)) {
            assert!(paged.surface().error_m(node) >= grid.surface().error_m(node));
            for &p in paged.surface().parents(node).iter() {
                assert!(paged.surface().error_m(p) >= paged.surface().error_m(node));
            }
        }
    }
}

#[test]
fn only_the_pages_that_a_view_needs_are_read_and_a_small_memory_suffices() {
    let t = SyntheticTerrain::mountains(2010, 1777, 7).rounded_to(1.0);
    let (_, mut paged, _folder) = stored(&t, &StoreOptions::default());
    let mut scene = Scene::new(&paged, Canvas::new(glam::DVec3::ZERO, DrawWith::Software).unwrap());
    scene.memory_bytes = 6 << 20;
    let [east_m, _] = paged.extent_m();
    for i in 0..40 {
        let eye = glam::DVec3::new(0.1 * east_m + 0.02 * f64::from(i) * east_m, -0.3 * east_m, 3500.0);
        let view =
            View { eye, target: eye + glam::DVec3::new(1.0, 0.2, -0.6), fov_y_rad: 0.7, viewport_px: [640, 360] };
        let criteria = Criteria {
            view: Some(ViewCriterion { view, tolerance_px: 2.0, cull: true }),
            budget_triangles: Some(20_000),
            ..Criteria::default()
        };
        let update = scene.update(&mut paged, &criteria).unwrap();
        assert!(update.report.triangles <= 20_000);
    }
    let Data::Paged(data) = paged.surface().data() else { panic!("a database is paged") };
    let all = 2010 * 1777 * 6;
    assert!(data.resident_bytes() < all / 2, "{} of {all} bytes are resident", data.resident_bytes());
}

#[test]
fn a_flight_over_a_database_is_the_flight_over_the_grid() {
    for t in terrains() {
        let (grid, mut paged, _folder) = stored(&t, &exact());
        let mut grid = grid;
        for level in 0..=paged.surface().numbers().lattice().levels() {
            paged.load_level(level).unwrap();
        }
        let canvas = || Canvas::new(glam::DVec3::ZERO, DrawWith::Software).unwrap();
        let (mut a, mut b) = (Scene::new(&grid, canvas()), Scene::new(&paged, canvas()));
        let [east_m, north_m] = grid.extent_m();
        for i in 0..12 {
            let eye = glam::DVec3::new(east_m * 0.08 * f64::from(i), -0.6 * north_m, 2500.0);
            let view =
                View { eye, target: eye + glam::DVec3::new(0.4, 1.0, -1.0), fov_y_rad: 0.9, viewport_px: [640, 360] };
            let view = Some(ViewCriterion { view, tolerance_px: 1.0, cull: true });
            let criteria = Criteria { view, budget_triangles: Some(3000), ..Criteria::default() };
            let (of_grid, of_pages) =
                (a.update(&mut grid, &criteria).unwrap(), b.update(&mut paged, &criteria).unwrap());
            assert_eq!(of_grid.report.triangles, of_pages.report.triangles);
            assert_eq!(a.canvas().buffers().contents().triangles, b.canvas().buffers().contents().triangles);
        }
    }
}

#[test]
fn a_lossy_database_is_within_its_error_of_the_source() {
    let source = SyntheticTerrain::mountains(300, 211, 9).to_field();
    let (rounded, quantum) = yamanami::quantise(source.clone(), 0.5);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rough.yama");
    let options = StoreOptions { rounded: Some((0.5, quantum)), ..StoreOptions::default() };
    Terrain::build(rounded, String::new(), &|_| ()).unwrap().store_as(&path, &options, &|_| ()).unwrap();
    let back = Terrain::open(&[path], &OpenOptions::default(), &|_| ()).unwrap().full_heights_m().unwrap();
    let worst = source.heights_m().iter().zip(&*back).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst <= 0.5 && worst > 0.1, "{worst}");
}
