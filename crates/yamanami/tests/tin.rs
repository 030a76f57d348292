//! TINs from file to database and back: bit for bit at full level, within the stored errors at all others, and nothing
//! that is seen is lost by culling. Files of the shared data are skipped where these are absent.

use glam::{DVec2, DVec3};
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use yamanami::core::{BreaklineKind, Hierarchy, NodeId, Surface, Tin, TriangleMesh, US_SURVEY_FOOT_M, View};
use yamanami::io::tin_file::{TinReadOptions, read_tin, write_tin};
use yamanami::measure::tin::{PlanIndex, vertical_difference};
use yamanami::multires::cluster::{ClusterOptions, ClusterSurface, build_tin};
use yamanami::multires::tin::{DelaunayOptions, triangulate};
use yamanami::{
    Controller, Criteria, GroundOptions, Model, ModelBuild, ModelStoreOptions, ReadGround, Subject, ViewCriterion,
    extract, read_ground,
};
use yamanami_testkit::{Rng, Survey};

/// A made survey as a TIN: breaklines, two hidden faces, a vertex that no face uses; far from zero, in survey feet.
fn surveyed(size_m: [f64; 2], spacing_m: f64, seed: u64) -> Tin {
    let survey = Survey { size_m, spacing_m, seed };
    let made = triangulate(&survey.points(), &survey.breaklines(), &DelaunayOptions::default()).unwrap();
    let mut tin = Tin { name: "測量 <1>".to_owned(), unit_m: US_SURVEY_FOOT_M, ..made.tin };
    let moved = |p: &mut DVec3| {
        *p = DVec3::from_array(
            (*p + DVec3::new(2e5, 3e5, 0.0))
                .to_array()
                .map(|x| (x / US_SURVEY_FOOT_M * 1e4).round() / 1e4 * US_SURVEY_FOOT_M),
        );
    };
    tin.mesh.positions.iter_mut().for_each(moved);
    tin.breaklines.iter_mut().flat_map(|l| &mut l.points).for_each(moved);
    tin.breaklines[1].kind = BreaklineKind::Soft;
    tin.breaklines[2].kind = BreaklineKind::Boundary;
    let middle = tin.mesh.triangles.len() / 2;
    tin.hidden = tin.mesh.triangles.drain(middle..middle + 2).collect();
    tin.mesh.positions.push(DVec3::new(2e5 - 50.0, 3e5 - 50.0, 1.0));
    tin
}

fn ground(path: &Path) -> ReadGround {
    read_ground(&[path.to_owned()], &GroundOptions::default()).unwrap()
}

fn built(tin: &Tin) -> ModelBuild {
    ModelBuild::of_tin(tin, "t".to_owned(), &|_| ()).unwrap()
}

type Place = [u64; 3];

/// The surface knows no -0.
fn place(p: DVec3) -> Place {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Faces by the places of their corners, the least first, sorted.
fn faces(tin: &Tin, of: &[[u32; 3]]) -> Vec<[Place; 3]> {
    let mut all: Vec<_> = of
        .iter()
        .map(|t| {
            let mut corners = t.map(|v| place(tin.mesh.positions[v as usize]));
            let least = (0..3).min_by_key(|&k| corners[k]).unwrap();
            corners.rotate_left(least);
            corners
        })
        .collect();
    all.sort_unstable();
    all
}

fn vertices(tin: &Tin) -> Vec<Place> {
    let mut all: Vec<_> = tin.mesh.positions.iter().copied().map(place).collect();
    all.sort_unstable();
    all
}

fn assert_same(a: &Tin, b: &Tin, what: &str) {
    assert!(vertices(a) == vertices(b), "{what}: other vertices");
    assert!(faces(a, &a.mesh.triangles) == faces(b, &b.mesh.triangles), "{what}: other faces");
    assert!(faces(a, &a.hidden) == faces(b, &b.hidden), "{what}: other hidden faces");
    assert_eq!(a.breaklines, b.breaklines, "{what}");
    assert_eq!((&a.name, a.unit_m, a.crs.epsg), (&b.name, b.unit_m, b.crs.epsg), "{what}");
}

/// File, database, file: nothing is another.
fn goes_round(path: &Path, folder: &Path) -> Model {
    let what = path.display().to_string();
    let ReadGround { tin, .. } = ground(path);
    let stored = folder.join("round.yama");
    built(&tin).store_as(&stored, &ModelStoreOptions::default(), &|_| ()).unwrap();
    let mut model = Model::open(&stored, &|_| ()).unwrap();
    let whole = model.whole_tin().unwrap();
    assert_same(&tin, &whole, &what);
    let again = folder.join("again.xml");
    write_tin(&again, &whole).unwrap();
    let read = read_tin(&again, &TinReadOptions::default()).unwrap();
    let mut read_again = read.tin;
    // LandXML has no word for the CRS's registry but the code's own
    read_again.crs = tin.crs.clone();
    assert_same(&tin, &read_again, &what);
    let apart = vertical_difference(&tin.mesh, &PlanIndex::new(&read_again.mesh));
    assert_eq!((apart.max_m, apart.rms_m), (0.0, 0.0), "{what}");
    model
}

#[test]
fn made_files_go_round_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let tin = surveyed([300.0, 240.0], 12.0, 1);
    for name in ["a.xml", "a.xml.gz", "a.dxf"] {
        let path = folder.path().join(name);
        write_tin(&path, &tin).unwrap();
        if name != "a.dxf" {
            assert_same(&ground(&path).tin, &tin, name);
        }
        goes_round(&path, folder.path());
    }
    let path = folder.path().join("quads.2dm");
    let text = "MESH2D\nMESHNAME \"dam\"\nND 1 0 0 1.25\nND 2 10.5 0 2\nND 3 10.5 10 3\nND 4 0 10 4\nND 5 20 -0.5 0\nND 6 20 10 0\n\
                E4Q 1 1 2 3 4 1\nE3T 2 2 5 6 1\nE3T 3 2 6 3 1\nNS 1 2 -3\n";
    std::fs::write(&path, text).unwrap();
    assert_eq!(ground(&path).tin.mesh.triangles.len(), 4);
    goes_round(&path, folder.path());
}

#[test]
fn real_files_go_round_bit_for_bit() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/tin");
    let Ok(entries) = std::fs::read_dir(shared) else { return };
    let folder = tempfile::tempdir().unwrap();
    // the largest is the same format as two others
    let mut files: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    files.retain(|p| yamanami::io::tin_file::is_tin_name(p) || yamanami::io::points::is_points_name(p));
    files.retain(|p| !p.to_string_lossy().contains("131103f"));
    files.sort();
    for path in files {
        let mut model = goes_round(&path, folder.path());
        // every level, and the stored errors hold
        let source = model.whole_tin().unwrap();
        let surface = model.surface();
        let index = PlanIndex::new(&source.mesh);
        let depth = model.deepest_level();
        for level in [0, depth / 2, depth] {
            holds(surface, &index, &|n: NodeId| surface.level(n) < level);
        }
    }
}

/// No place is further off than the errors of the nodes over it that are not shown, and no triangle is turned over.
fn holds(surface: &ClusterSurface, source: &PlanIndex<'_>, shown: &dyn Fn(NodeId) -> bool) {
    let mesh = surface.mesh_of(&shown);
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t).map(DVec3::truncate);
        assert!((b - a).perp_dot(c - a) > 0.0, "triangle {t} is turned over or flat in plan");
    }
    let apart = vertical_difference(&mesh, source);
    let Some(worst) = apart.worst else { return };
    let left = (0..surface.node_bound()).filter(|&n| surface.exists(n) && !shown(n));
    let over = left.filter(|&n| {
        let bound = surface.bound(n);
        bound.centre.truncate().distance(worst) <= bound.radius_m
    });
    let error_m = over.map(|n| surface.error_m(n)).fold(0.0, f32::max);
    assert!(
        apart.max_m <= f64::from(error_m) * (1.0 + 1e-6) + 1e-9,
        "{} m at {worst}, {error_m} m stored",
        apart.max_m
    );
}

fn random_view(rng: &mut Rng, mesh: &TriangleMesh, viewport_px: [u32; 2]) -> View {
    let bounds = mesh.bounds();
    let size = bounds.max - bounds.min;
    let reach = size.truncate().max_element();
    let mut anywhere = |margin: f64, above: f64| {
        let share = DVec2::new(rng.unit(), rng.unit()) * (1.0 + 2.0 * margin) - margin;
        let xy = bounds.min.truncate() + share * size.truncate();
        xy.extend(bounds.min.z + (rng.unit() - 0.3) * above)
    };
    let eye = anywhere(0.3, 0.3 * reach);
    let target = anywhere(0.5, 0.1 * reach);
    let fov_y_rad = 0.2 + 1.2 * rng.unit();
    View { eye, target, fov_y_rad, viewport_px }
}

#[test]
fn stored_errors_bound_every_level_and_view() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.yama");
    let tin = surveyed([900.0, 700.0], 10.0, 2);
    built(&tin).store_as(&path, &ModelStoreOptions::default(), &|_| ()).unwrap();
    let mut model = Model::open(&path, &|_| ()).unwrap();
    let index = PlanIndex::new(&tin.mesh);
    for tolerance_m in [0.01f32, 0.1, 0.5, 2.0, 10.0, 1e6] {
        let criteria = Criteria { terrain_tolerance_m: tolerance_m, ..Criteria::default() };
        let front = extract(&mut model, &criteria).unwrap();
        let apart = vertical_difference(&front.mesh, &index);
        assert!(apart.max_m <= f64::from(front.error_left.min(tolerance_m)), "{} m of {tolerance_m} m", apart.max_m);
        assert!((apart.overlap_m2 - vertical_difference(&tin.mesh, &index).overlap_m2).abs() < 1e-6 * apart.overlap_m2);
    }
    let surface = model.surface();
    for level in 0..=model.deepest_level() {
        holds(surface, &index, &|n: NodeId| surface.level(n) < level);
    }
    let mut rng = Rng::new(3);
    for (n, cull) in [false, true, true, false, true, true].into_iter().enumerate() {
        let view = random_view(&mut rng, &tin.mesh, [1280, 720]);
        let view = ViewCriterion { view, tolerance_px: [0.5, 2.0, 20.0][n % 3], cull };
        let budget_triangles = (n % 2 == 1).then_some(3000);
        let mut controller = Controller::new(surface);
        controller.update(surface, &Criteria { view: Some(view), budget_triangles, ..Criteria::default() }, |_, _| ());
        let front: HashSet<NodeId> = controller.front().nodes().into_iter().collect();
        holds(surface, &index, &|n: NodeId| front.contains(&n));
    }
}

/// Culled and unculled fronts of random poses, held against each other: how many triangles were seen, how many lost.
fn culling(poses: usize, seed: u64) -> [usize; 2] {
    let tin = surveyed([210.0, 150.0], 15.0, seed);
    let options = ClusterOptions { cluster_triangles: 12, group_clusters: 4, ..ClusterOptions::default() };
    let surface = build_tin(&tin, None, &options).unwrap().into_surface().unwrap();
    let (mut all, mut culled) = (Controller::new(&surface), Controller::new(&surface));
    let mut rng = Rng::new(seed);
    let (mut seen, mut lost) = (0, 0);
    for _ in 0..poses {
        let view = random_view(&mut rng, &tin.mesh, [800, 600]);
        let tolerance_px = [1.0, 8.0, 40.0][rng.below(3)];
        let mesh = |controller: &mut Controller, cull: bool| {
            let criteria = Criteria { view: Some(ViewCriterion { view, tolerance_px, cull }), ..Criteria::default() };
            controller.update(&surface, &criteria, |_, _| ());
            surface.mesh_of(controller.front())
        };
        let (whole, part) = (mesh(&mut all, false), mesh(&mut culled, true));
        let frustum = view.frustum();
        let corners = |mesh: &TriangleMesh| -> Vec<[DVec3; 3]> {
            let all = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
            all.filter(|&c| !frustum.misses(c) && frustum.seen_part(c).len() >= 3).collect()
        };
        let kept: HashSet<[Place; 3]> = corners(&part).iter().map(|c| c.map(place)).collect();
        for c in corners(&whole) {
            seen += 1;
            lost += usize::from(!kept.contains(&c.map(place)));
        }
    }
    [seen, lost]
}

#[test]
fn culling_loses_no_triangle_of_a_hundred_thousand_poses() {
    let [seen, lost] = culling(100_000, 6);
    assert!(seen > 1_000_000, "{seen}");
    assert_eq!(lost, 0, "of {seen}");
}

#[test]
fn a_store_that_fails_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.yama");
    let files = || std::fs::read_dir(folder.path()).unwrap().count();
    let tin = surveyed([200.0, 160.0], 10.0, 7);
    built(&tin).store_as(&path, &ModelStoreOptions::default(), &|_| ()).unwrap();
    let before = std::fs::read(&path).unwrap();
    let other = surveyed([300.0, 160.0], 10.0, 8);
    let store = |progress: &dyn Fn(f32)| built(&other).store_as(&path, &ModelStoreOptions::default(), progress);
    let killed = catch_unwind(AssertUnwindSafe(|| store(&|_| std::panic::panic_any("killed"))));
    assert!(killed.is_err());
    assert!(std::fs::read(&path).unwrap() == before, "the old file stays");
    assert_eq!(files(), 1, "nothing else is left");
    store(&|_| ()).unwrap();
    assert!(std::fs::read(&path).unwrap() != before);
    assert_eq!(files(), 1);
    assert_same(&Model::open(&path, &|_| ()).unwrap().whole_tin().unwrap(), &other, "stored anew");
}

#[test]
fn a_damaged_database_is_an_error_or_the_same_tin() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.yama");
    let tin = surveyed([150.0, 120.0], 15.0, 9);
    built(&tin).store_as(&path, &ModelStoreOptions::default(), &|_| ()).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let mut refused = 0;
    for at in (0..whole.len()).step_by(53) {
        let mut bytes = whole.clone();
        bytes[at] ^= [0xff, 0x01, 0x80][at % 3];
        std::fs::write(&path, &bytes).unwrap();
        let read = Model::open(&path, &|_| ()).and_then(|mut model| model.whole_tin());
        refused += usize::from(read.is_err());
    }
    assert!(refused > 20, "{refused} of {}", whole.len() / 53);
}
