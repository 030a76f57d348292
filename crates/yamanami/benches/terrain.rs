//! Speed of the terrain's parts: lazy analysis, building with guaranteed errors, a frame of the controller, a block from
//! the database. `cargo bench -p yamanami`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use yamanami::core::View;
use yamanami::multires::wavelet::{analyse, synthesise};
use yamanami::{Controller, Criteria, OpenOptions, StoreOptions, Terrain, ViewCriterion};
use yamanami_testkit::SyntheticTerrain;

fn lazy(c: &mut Criterion) {
    let mut group = c.benchmark_group("lazy wavelet, one core");
    for side in [1025usize, 4097] {
        let mut grid = SyntheticTerrain::mountains(side, side, 1).to_field().into_heights_m();
        group.throughput(Throughput::Elements((side * side) as u64));
        group.sample_size(10);
        group.bench_function(BenchmarkId::new("analyse and synthesise", side), |b| {
            b.iter(|| {
                analyse(&mut grid, side, side);
                synthesise(&mut grid, side, side);
            });
        });
    }
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build with guaranteed errors");
    let side = 2049;
    let field = SyntheticTerrain::mountains(side, side, 1).to_field();
    group.throughput(Throughput::Elements((side * side) as u64));
    group.sample_size(10);
    group.bench_function(BenchmarkId::from_parameter(side), |b| {
        b.iter(|| Terrain::build(field.clone(), String::new(), &|_| ()).unwrap());
    });
}

fn frame(c: &mut Criterion) {
    let side = 2049;
    let terrain =
        Terrain::build(SyntheticTerrain::mountains(side, side, 1).to_field(), String::new(), &|_| ()).unwrap();
    let [east_m, _] = terrain.extent_m();
    let mut group = c.benchmark_group("controller, a frame at 15 m");
    for budget in [5_000, 100_000, 1_000_000] {
        group.sample_size(50);
        group.bench_function(BenchmarkId::from_parameter(budget), |b| {
            let mut controller = Controller::new(terrain.surface());
            let mut i = 0u32;
            b.iter(|| {
                let along_m = 15.0 * f64::from(i % 2000);
                i += 1;
                let eye = DVec3::new(0.3 * east_m + 0.8 * along_m, -0.35 * east_m - 0.6 * along_m, 2500.0);
                let view =
                    View { eye, target: eye + DVec3::new(0.8, -0.6, -0.3), fov_y_rad: 0.8, viewport_px: [1280, 720] };
                let criteria = Criteria {
                    view: Some(ViewCriterion { view, tolerance_px: 1e-3, cull: false }),
                    budget_triangles: Some(budget),
                    ..Criteria::default()
                };
                controller.update(terrain.surface(), &criteria, |_, _| ())
            });
        });
    }
}

fn database(c: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.yama");
    let side = 2049;
    let field = SyntheticTerrain::mountains(side, side, 1).rounded_to(1.0).to_field();
    Terrain::build(field, String::new(), &|_| ()).unwrap().store_as(&path, &StoreOptions::default(), &|_| ()).unwrap();
    let mut group = c.benchmark_group("database");
    group.throughput(Throughput::Elements(257 * 257));
    group.bench_function("a 257x257 block, nothing cached", |b| {
        let terrain = Terrain::open(std::slice::from_ref(&path), &OpenOptions::default(), &|_| ()).unwrap();
        let store = terrain.store().unwrap();
        store.set_cache_bytes(0);
        let mut i = 0u32;
        b.iter(|| {
            i = (i + 1) % 49;
            store.read_height_block(0, 256 * (i % 7), 256 * (i / 7), 257, 257).unwrap()
        });
    });
}

criterion_group!(benches, lazy, build, frame, database);
criterion_main!(benches);
