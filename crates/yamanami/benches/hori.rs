//! Speed of deformed maps over 160 km: hierarchy, first front at the paper's triangles, live changes, drawing in software.
//! `cargo bench -p yamanami --bench hori`.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec2;
use yamanami::core::{DeformedMap, MapView, NestedField};
use yamanami::map::{ReliefStyle, paint};
use yamanami::multires::rtin::{BuildOptions, Rtin};
use yamanami::{BaseOptions, Controller, Criteria, DeformedScene, DrawWith, MapCriterion, draw_base};
use yamanami_testkit::nested_ground;

/// The paper's triangles by its table.
const PAPER_TRIANGLES: u32 = 77_128;
const SIDE_PX: u32 = 1300;
/// Frames until a sweep comes round.
const SWEEP: u32 = 64;

/// 1,601² samples of 200 m.
fn field() -> NestedField {
    nested_ground(&[800], 200.0, 2500.0, 17)
}

fn view(map: DeformedMap, field: &NestedField) -> MapView {
    let [_, top_m] = field.range_m().map(f64::from);
    MapView::fitted(map, [SIDE_PX; 2], field.widest().reach_m(), top_m, 0.0)
}

/// A share that goes up and down.
fn swing(frame: u32) -> f64 {
    0.5 - 0.5 * (f64::from(frame % SWEEP) * std::f64::consts::TAU / f64::from(SWEEP)).cos()
}

/// The eye on a round walk of 2 km about the middle.
fn moved(frame: u32) -> DeformedMap {
    let centre = 2000.0 * DVec2::from_angle(f64::from(frame % SWEEP) * std::f64::consts::TAU / f64::from(SWEEP));
    DeformedMap { centre, ..DeformedMap::default() }
}

fn hierarchy(c: &mut Criterion) {
    let field = field();
    let mut group = c.benchmark_group("hori: hierarchy");
    let samples = field.widest().width().pow(2) as u64;
    group.sample_size(10).throughput(Throughput::Elements(samples));
    group.bench_function("build", |b| b.iter(|| Rtin::build(field.clone(), &BuildOptions::default()).unwrap()));
    group.finish();
}

fn fronts(c: &mut Criterion) {
    let field = field();
    let surface = Rtin::build(field.clone(), &BuildOptions::default()).unwrap();
    let criteria = |map| Criteria {
        map: Some(MapCriterion { view: view(map, &field), tolerance_px: 1.5 }),
        budget_triangles: Some(PAPER_TRIANGLES),
        ..Criteria::default()
    };
    let mut group = c.benchmark_group("hori: front of 77,128 triangles");
    group.sample_size(20).throughput(Throughput::Elements(u64::from(PAPER_TRIANGLES)));
    let first = criteria(DeformedMap::default());
    group.bench_function("first", |b| {
        b.iter(|| Controller::new(&surface).update(&surface, &first, |_, _| ()).triangles);
    });
    group.finish();
    let mut scene = DeformedScene::new(field.clone(), &BuildOptions::default(), DrawWith::Software).unwrap();
    let mut frame = 0;
    let mut group = c.benchmark_group("hori: live change");
    group.sample_size(20);
    group.bench_function("alpha", |b| {
        b.iter(|| {
            frame += 1;
            let map = DeformedMap { alpha: swing(frame), ..DeformedMap::default() };
            scene.update(&view(map, &field), 1.5, Some(PAPER_TRIANGLES)).unwrap().report.triangles
        });
    });
    group.finish();
}

fn drawing(c: &mut Criterion) {
    let field = field();
    let options = BaseOptions::painted(paint(&field, &ReliefStyle::default(), DVec2::ZERO)).unwrap();
    let mut scene = DeformedScene::new(field.clone(), &BuildOptions::default(), DrawWith::Software).unwrap();
    let still = view(DeformedMap::default(), &field);
    scene.update(&still, 1.5, Some(PAPER_TRIANGLES)).unwrap();
    let mut group = c.benchmark_group("hori: 1,300 px in software");
    group.sample_size(20);
    for (name, options) in [("without textures", &BaseOptions::default()), ("textured", &options)] {
        group.bench_function(name, |b| {
            b.iter(|| draw_base(scene.canvas().buffers(), &still, options, &|_| ()).unwrap());
        });
    }
    let mut frame = 0;
    group.bench_function("whole frame, eye moving", |b| {
        b.iter(|| {
            frame += 1;
            let view = view(moved(frame), &field);
            scene.update(&view, 1.5, Some(PAPER_TRIANGLES)).unwrap();
            draw_base(scene.canvas().buffers(), &view, &options, &|_| ()).unwrap()
        });
    });
    group.finish();
}

criterion_group!(benches, hierarchy, fronts, drawing);
criterion_main!(benches);
