//! A model behaves the same from memory and from its database, and as terrain does: budgets, differences, little memory.

use glam::DVec3;
use yamanami::core::{Hierarchy, Surface, TriangleMesh, View};
use yamanami::measure::{conformity, surface_distance};
use yamanami::{
    Canvas, Controller, Criteria, DrawWith, Error, Model, ModelBuild, ModelStoreOptions, OpenOptions, Scene, Subject,
    Terrain, ViewCriterion, extract, fly, orbit, overview,
};

/// A bumpy ring in colours, closed.
fn ring(n: u32, m: u32) -> TriangleMesh {
    let turn = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let place = |i: u32| {
        let (u, v) = (turn(i % n, n), turn(i / n, m));
        let r = 1.0 + 0.05 * (9.0 * u).sin() * (5.0 * v).cos() + 0.01 * (31.0 * u + 17.0 * v).sin();
        DVec3::new((3.0 + r * v.cos()) * u.cos(), (3.0 + r * v.cos()) * u.sin(), r * v.sin())
    };
    let number = |x: u32, y: u32| (y % m) * n + x % n;
    let square = |i: u32| {
        let (x, y) = (i % n, i / n);
        let [a, b, c, d] = [number(x, y), number(x + 1, y), number(x + 1, y + 1), number(x, y + 1)];
        [[a, b, c], [a, c, d]]
    };
    let mut mesh = TriangleMesh::new((0..n * m).map(place).collect(), (0..n * m).flat_map(square).collect());
    mesh.colours =
        mesh.positions.iter().map(|p| [(p.x * 30.0 + 128.0) as u8, (p.z * 90.0 + 128.0) as u8, 70, 255]).collect();
    mesh
}

/// The same model in memory and in a database.
fn both(mesh: &TriangleMesh) -> (Model, Model, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.yama");
    let build = || ModelBuild::of_mesh(mesh, "ring".to_owned(), &|_| ()).unwrap();
    let stored = build().store_as(&path, &ModelStoreOptions::default(), &|_| ()).unwrap();
    assert!(stored.page_bytes < 12 * mesh.triangles.len() as u64, "{stored:?}");
    let paged = Model::open(&path, &|_| ()).unwrap();
    paged.store().unwrap().verify().unwrap();
    (build().into_model().unwrap(), paged, folder)
}

fn viewed(subject: &impl Subject, i: usize, tolerance_px: f32, budget: Option<u32>) -> Criteria {
    let whole = overview(subject, [640, 360]);
    let angle = 0.12 * i as f64;
    let eye = glam::DQuat::from_rotation_z(angle) * whole.eye * (0.45 + 0.2 * (0.5 * i as f64).sin());
    let view = View { eye, target: DVec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.0), ..whole };
    Criteria {
        view: Some(ViewCriterion { view, tolerance_px, cull: true }),
        budget_triangles: budget,
        ..Criteria::default()
    }
}

fn canvas() -> Canvas {
    Canvas::new(DVec3::ZERO, DrawWith::Software).unwrap()
}

#[test]
fn what_is_extracted_is_closed_coloured_and_within_the_tolerance() {
    let mesh = ring(120, 80);
    let (mut whole, mut paged, _folder) = both(&mesh);
    assert!(whole.has_colours() && paged.has_colours());
    for tolerance_m in [0.0f32, 0.01, 0.05, 0.2] {
        let criteria = Criteria { terrain_tolerance_m: tolerance_m, ..Criteria::default() };
        let triangles =
            [extract(&mut whole, &criteria).unwrap(), extract(&mut paged, &criteria).unwrap()].map(|found| {
                let report = conformity(&found.mesh);
                assert_eq!([report.open_edges, report.non_manifold_edges, report.inconsistent_edges], [0; 3]);
                assert_eq!(found.mesh.colours.len(), found.mesh.positions.len());
                let stored_m = paged.store().unwrap().meta().max_error_m;
                let distance = surface_distance(&found.mesh, &mesh, 200_000, 1);
                assert!(
                    distance.hausdorff_m <= f64::from(tolerance_m).max(stored_m),
                    "{distance:?} at {tolerance_m} m"
                );
                found.mesh.triangles.len()
            });
        assert!(triangles[1] >= triangles[0], "stored errors are a little larger");
        assert!(tolerance_m < 0.04 || triangles[1] < mesh.triangles.len(), "{triangles:?}");
    }
}

#[test]
fn a_budget_follows_the_oracle_and_is_never_exceeded() {
    let (whole, _, _folder) = both(&ring(160, 100));
    let mut controller = Controller::new(whole.surface());
    for i in 0..60 {
        let criteria = viewed(&whole, i, 0.2, Some(2000 + 700 * (i as u32 % 9)));
        let report = controller.update(whole.surface(), &criteria, |_, _| ());
        let expected = yamanami_lod::extract(whole.surface(), &criteria);
        assert!(report.triangles <= criteria.budget_triangles.unwrap() as usize);
        assert!(controller.front().nodes() == expected.nodes(), "frame {i}: {report:?}");
    }
}

#[test]
fn differences_lead_where_a_rebuild_does() {
    let (mut whole, mut paged, _folder) = both(&ring(120, 80));
    let (mut stepped, mut rebuilt) = (Scene::new(&whole, canvas()), Scene::new(&whole, canvas()));
    let mut of_pages = Scene::new(&paged, canvas());
    for i in 0..30 {
        let criteria = viewed(&whole, 2 * i, 1.0, Some(6000));
        let update = stepped.update(&mut whole, &criteria).unwrap();
        rebuilt.rebuild(&whole, &criteria).unwrap();
        assert_eq!(stepped.canvas().buffers().contents(), rebuilt.canvas().buffers().contents(), "frame {i}");
        assert_eq!(update.report.triangles, stepped.canvas().buffers().triangle_count());
        let update = of_pages.update(&mut paged, &criteria).unwrap();
        assert!(update.report.triangles <= 6000);
    }
    // the database's errors are larger by as much for every node, so the order of refinement is about the same
    let all = |node: u32| paged.surface().error_m(node) - whole.surface().error_m(node);
    let most = paged.store().unwrap().meta().max_error_m as f32 * 1.01 + 1e-6;
    assert!((0..whole.surface().node_bound()).all(|n| all(n) >= 0.0 && all(n) < most));
    let mesh = of_pages.front();
    assert_eq!(paged.surface().mesh_of(mesh).triangles.len(), of_pages.canvas().buffers().triangle_count());
}

#[test]
fn only_the_pages_of_a_view_are_read_and_a_small_memory_suffices() {
    let (_, mut paged, _folder) = both(&ring(240, 150));
    let mut scene = Scene::new(&paged, canvas());
    let bytes = paged.surface().resident_bytes();
    scene.memory_bytes = 1 << 20;
    let mut pages = 0;
    for i in 0..40 {
        let criteria = viewed(&paged, i, 1.0, Some(8000));
        let update = scene.update(&mut paged, &criteria).unwrap();
        assert!(update.report.triangles <= 8000);
        assert!(paged.surface().resident_bytes() <= (2 << 20), "{}", paged.surface().resident_bytes());
        pages += update.pages;
    }
    assert!(pages > 20 && paged.surface().resident_bytes() > bytes);
}

#[test]
fn a_model_flies_around_itself() {
    let (_, mut paged, _folder) = both(&ring(120, 80));
    let path = orbit(&paged, 12, [320, 240]);
    let options = yamanami::FlightOptions {
        criteria: Criteria { budget_triangles: Some(5000), ..Criteria::default() },
        lod: yamanami::Lod::Exact,
        mode: yamanami::FlightMode::Differences,
        draw: true,
        style: paged.usual_style(),
        morph: true,
    };
    let mut shades = 0;
    let frames = fly(&mut paged, canvas(), &path, &options, |_, _, picture| {
        let colours: std::collections::HashSet<_> = picture.unwrap().pixels().collect();
        shades = colours.len();
        Ok(())
    });
    assert!(frames.unwrap().iter().all(|f| f.triangles <= 5000));
    assert!(shades > 200, "{shades} shades");
}

#[test]
fn what_cannot_be_a_model_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let told = |result: Result<(), Error>| {
        let line = result.unwrap_err().to_string();
        assert!(!line.contains('\n'), "{line}");
        line
    };
    let empty = ModelBuild::of_mesh(&TriangleMesh::default(), "none.ply".to_owned(), &|_| ());
    assert!(told(empty.map(|_| ())).contains("none.ply: expected a mesh with triangles"));
    let build = ModelBuild::of_mesh(&ring(12, 8), "ring".to_owned(), &|_| ()).unwrap();
    let options = ModelStoreOptions { max_error_m: Some(1e-14), ..ModelStoreOptions::default() };
    let path = folder.path().join("a.yama");
    assert!(told(build.store_as(&path, &options, &|_| ()).map(|_| ())).contains("at best"));
    assert!(!path.exists());
    // one kind of database is not the other
    let build = ModelBuild::of_mesh(&ring(12, 8), "ring".to_owned(), &|_| ()).unwrap();
    build.store_as(&path, &ModelStoreOptions::default(), &|_| ()).unwrap();
    let terrain = Terrain::open(std::slice::from_ref(&path), &OpenOptions::default(), &|_| ());
    assert!(told(terrain.map(|_| ())).contains("expected a terrain, found a model"));
}
