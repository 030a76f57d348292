//! Speed of hiraoka's method on a TIN of the paper's size: levels, cut and seams, and the drawing step beside brute force.
//! `cargo bench -p yamanami --bench hiraoka`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use yamanami::core::{TriangleMesh, View};
use yamanami::multires::tin::{GreedyOptions, greedy};
use yamanami::multires::tin_block::{BlockGrid, CostReading, TinBlocks, centroid_chain};
use yamanami::{Culling, TinDrawing};
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

const PAPER_TRIANGLES: usize = 41_797;

/// 3,120 by 2,080 m of fractal hills.
fn tin() -> TriangleMesh {
    let shape = Shape::Fractal { relief_m: 70.0, roughness: 0.5, seed: 11 };
    let field = SyntheticTerrain::new(625, 417, shape, Spacing::Metres(5.0)).to_field();
    let options = GreedyOptions { max_error_m: 0.0, most_triangles: Some(PAPER_TRIANGLES) };
    let mut tin = greedy(&field, &options).unwrap().tin.mesh;
    let low = tin.bounds().min;
    tin.positions.iter_mut().for_each(|p| *p -= low.truncate().extend(0.0));
    tin
}

fn grid() -> BlockGrid {
    BlockGrid::new(DVec2::ZERO, DVec2::splat(520.0), [6, 4]).unwrap()
}

fn levels(c: &mut Criterion) {
    let tin = tin();
    let mut group = c.benchmark_group("hiraoka: levels to a quarter");
    group.sample_size(10).throughput(Throughput::Elements(tin.triangles.len() as u64));
    for reading in CostReading::ALL {
        group.bench_function(reading.name(), |b| b.iter(|| centroid_chain(&tin, 3, reading).unwrap()));
    }
    let chain = centroid_chain(&tin, 3, CostReading::OncePerPass).unwrap();
    group.bench_function("cut and seams", |b| b.iter(|| TinBlocks::new(&chain, grid()).unwrap()));
    group.finish();
}

fn drawing(c: &mut Criterion) {
    let chain = centroid_chain(&tin(), 3, CostReading::OncePerPass).unwrap();
    let blocks = TinBlocks::new(&chain, grid()).unwrap();
    let eye = DVec3::new(260.0, 260.0, 100.0);
    let target = DVec3::new(3120.0, 2080.0, 100.0);
    let view = View { eye, target, fov_y_rad: std::f64::consts::FRAC_PI_4, viewport_px: [1024, 768] };
    let mut drawing = TinDrawing::new(vec![1000.0, 2000.0]);
    let mut group = c.benchmark_group("hiraoka: drawing step");
    group.throughput(Throughput::Elements(blocks.triangle_count(0) as u64));
    for culling in [Culling::BruteForce, Culling::Faithful, Culling::Conservative] {
        group.bench_with_input(BenchmarkId::from_parameter(format!("{culling:?}")), &culling, |b, &culling| {
            b.iter(|| drawing.draw(&blocks, &view, culling));
        });
    }
    group.finish();
}

criterion_group!(benches, levels, drawing);
criterion_main!(benches);
