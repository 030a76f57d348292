//! A packed surface streamed by ranges comes to the same front as the database it was made of.

use crate::session::{Content, Session, Start};
use std::path::Path;
use yamanami::core::{GeoReference, HeightField, TriangleMesh};
use yamanami::io::pack::PackSource;
use yamanami::{Canvas, Criteria, DrawWith, ModelBuild, ModelStoreOptions, Scene, StoreOptions, Subject, Terrain};

const SIZE_PX: [u32; 2] = [320, 200];

/// A hilly terrain of several pages on its finest levels.
fn field(columns: usize, rows: usize) -> HeightField {
    let crs = yamanami::io::crs::from_epsg(32654).unwrap_or_default();
    let geo = GeoReference::new(crs, [300_000.0, 3_900_000.0], [30.0, -30.0], [columns, rows]);
    let height = |x: usize, y: usize| {
        let (x, y) = (x as f32, y as f32);
        400.0
            + 300.0 * (0.021 * x).sin() * (0.017 * y).cos()
            + 40.0 * (0.13 * x + 0.09 * y).sin()
            + 5.0 * (0.9 * x).sin() * (1.1 * y).cos()
    };
    let heights_m = (0..rows).flat_map(|y| (0..columns).map(move |x| height(x, y).round())).collect();
    HeightField::new(columns, rows, heights_m, geo)
}

fn terrain_yama(folder: &Path) -> std::path::PathBuf {
    let path = folder.join("hills.yama");
    let terrain = Terrain::build(field(700, 600), "hills".to_owned(), &|_| ()).unwrap();
    terrain.store_as(&path, &StoreOptions::default(), &|_| ()).unwrap();
    path
}

fn open(source: &PackSource, first_bytes: u64) -> Session {
    let mut bytes = first_bytes;
    loop {
        match Session::open(source.read(0..bytes.min(source.bytes())).unwrap(), SIZE_PX, None).unwrap() {
            Start::Needs(needed) => bytes = needed as u64,
            Start::Opened(session) => return *session,
        }
    }
}

/// Fetches and updates until nothing is missing; `spoil` may change what comes. How many requests it took.
fn run(session: &mut Session, source: &PackSource, mut spoil: impl FnMut(u64, &mut Vec<u8>)) -> usize {
    let mut requests = 0;
    for _ in 0..2000 {
        let wanted = session.requests(6).unwrap_or_default();
        requests += wanted.len();
        for request in &wanted {
            let mut bytes = source.read(request.offset..request.offset + request.length).unwrap();
            spoil(request.offset, &mut bytes);
            let _ = session.receive(request.id, &bytes);
        }
        let changed = session.update(0.02).unwrap();
        if !changed && wanted.is_empty() && session.is_complete() {
            return requests;
        }
    }
    panic!("it does not come to rest");
}

fn shown(session: &Session) -> TriangleMesh {
    let contents = crate::session::with_stage!(&session.content, stage => stage.scene().canvas().buffers().contents(), else panic!("nothing is shown"));
    let triangles = contents.triangles.into_values().collect();
    TriangleMesh::new(contents.vertices.values().map(|v| v.local().as_dvec3()).collect(), triangles)
}

/// The same front from the database itself.
fn native(path: &Path, session: &Session) -> TriangleMesh {
    let Content::Terrain(stage) = &session.content else { panic!("no terrain") };
    let criteria: Criteria = session.settings.criteria(stage.rig.view(SIZE_PX));
    let mut terrain = Terrain::open(&[path.to_owned()], &Default::default(), &|_| ()).unwrap();
    let canvas = Canvas::new(terrain.bounds().centre(), DrawWith::Software).unwrap();
    let mut scene = Scene::new(&terrain, canvas);
    while scene.update(&mut terrain, &criteria).unwrap().report.refined > 0 {}
    let contents = scene.canvas().buffers().contents();
    TriangleMesh::new(
        contents.vertices.values().map(|v| v.local().as_dvec3()).collect(),
        contents.triangles.into_values().collect(),
    )
}

#[test]
fn a_streamed_terrain_comes_to_the_front_of_its_database() {
    let folder = tempfile::tempdir().unwrap();
    let path = terrain_yama(folder.path());
    let source = PackSource::open(&path).unwrap();
    for first_bytes in [16, 4 << 10, 256 << 10, 64 << 20] {
        let mut session = open(&source, first_bytes);
        let requests = run(&mut session, &source, |_, _| ());
        assert_eq!(shown(&session), native(&path, &session), "{first_bytes} bytes at first");
        assert!(session.stream.received_bytes() <= source.bytes() + first_bytes, "{requests} requests");
    }
}

#[test]
fn damaged_pages_leave_the_surface_coarser_there_and_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let source = PackSource::open(terrain_yama(folder.path())).unwrap();
    let mut session = open(&source, 4 << 10);
    run(&mut session, &source, |_, _| ());
    let coarse = shown(&session).triangles.len();
    session.change(r#"{"tolerance_px":0.1,"tolerance_m":0,"budget":null}"#).unwrap();
    let finest = session.stream.head().sections.iter().rev().nth(2).unwrap().clone();
    let data_at = finest.index_range(finest.entries, finest.entries).start;
    let mut spoiled = 0;
    let spoil = |offset: u64, bytes: &mut Vec<u8>| {
        if offset + bytes.len() as u64 > data_at {
            *bytes.last_mut().unwrap() ^= 0x40;
            spoiled += 1;
        }
    };
    run(&mut session, &source, spoil);
    assert!(spoiled > 0 && shown(&session).triangles.len() > coarse, "{spoiled}, {coarse}");
}

#[test]
fn a_lost_range_is_asked_for_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = terrain_yama(folder.path());
    let source = PackSource::open(&path).unwrap();
    let mut session = open(&source, 1 << 10);
    for _ in 0..3 {
        for request in session.requests(4).unwrap() {
            session.stream.failed(request.id);
        }
    }
    run(&mut session, &source, |_, _| ());
    assert_eq!(shown(&session), native(&path, &session));
}

#[test]
fn a_model_streams_its_nodes_and_pages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.yama");
    let mesh = ball(64);
    let build = ModelBuild::of_mesh(&mesh, "ball".to_owned(), &|_| ()).unwrap();
    build.store_as(&path, &ModelStoreOptions::default(), &|_| ()).unwrap();
    let source = PackSource::open(&path).unwrap();
    let mut session = open(&source, 16);
    run(&mut session, &source, |_, _| ());
    assert!(matches!(session.content, Content::Model(_)));
    let before = shown(&session).triangles.len();
    session.change(r#"{"tolerance_px":0.05,"budget":null}"#).unwrap();
    run(&mut session, &source, |_, _| ());
    assert!(shown(&session).triangles.len() > before, "{before}");
    assert!(session.change(r#"{"mode":"map"}"#).is_err());
}

/// A ball of 2 n² triangles.
fn ball(n: u32) -> TriangleMesh {
    let place = |i: u32, j: u32| {
        let (u, v) =
            (std::f64::consts::TAU * f64::from(i) / f64::from(n), std::f64::consts::PI * f64::from(j) / f64::from(n));
        glam::DVec3::new(u.cos() * v.sin(), u.sin() * v.sin(), v.cos())
    };
    let mut mesh = TriangleMesh::default();
    let number = |i: u32, j: u32| match j {
        0 => 0,
        _ if j == n => 1,
        _ => 2 + (j - 1) * n + i % n,
    };
    mesh.positions = vec![place(0, 0), place(0, n)];
    mesh.positions.extend((1..n).flat_map(|j| (0..n).map(move |i| place(i, j))));
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i, j + 1), number(i + 1, j + 1)];
            mesh.triangles
                .extend([[a, c, d], [a, d, b]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[0] != t[2]));
        }
    }
    mesh
}

#[test]
fn a_profile_and_a_map_bring_the_pages_they_need() {
    let folder = tempfile::tempdir().unwrap();
    let path = terrain_yama(folder.path());
    let source = PackSource::open(&path).unwrap();
    let mut session = open(&source, 4 << 10);
    run(&mut session, &source, |_, _| ());
    let line = [glam::DVec2::new(1000.0, -1000.0), glam::DVec2::new(19_000.0, -16_000.0)];
    session.profile(&line, 64);
    run(&mut session, &source, |_, _| ());
    let profile = session.profile(&line, 64);
    assert!(profile.exact, "{profile:?}");
    let field = field(700, 600);
    for (&distance_m, &height_m) in profile.distance_m.iter().zip(&profile.height_m) {
        let place = line[0] + (line[1] - line[0]).normalize() * distance_m;
        let [column, row] = [place.x / 30.0, -place.y / 30.0];
        let at = |c: f64, r: f64| f64::from(field.heights_m()[r as usize * 700 + c as usize]);
        let (u, v) = (column.fract(), row.fract());
        let [c, r] = [column.floor(), row.floor()];
        let expected = (at(c, r) * (1.0 - u) + at(c + 1.0, r) * u) * (1.0 - v)
            + (at(c, r + 1.0) * (1.0 - u) + at(c + 1.0, r + 1.0) * u) * v;
        assert!((height_m.unwrap() - expected).abs() < 0.02, "{distance_m}: {height_m:?} {expected}");
    }
    session.change(r#"{"mode":"map"}"#).unwrap();
    run(&mut session, &source, |_, _| ());
    assert_eq!(session.numbers().fault, None);
    assert!(session.numbers().triangles > 100, "{:?}", session.numbers());
    let [x, y] = SIZE_PX.map(|n| 0.5 * f64::from(n));
    assert!(session.pick(glam::DVec2::new(x, y)).is_some());
}
