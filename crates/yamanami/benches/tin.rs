//! Speed of TINs: the hierarchy of clusters, on one core and on all, and a chain of levels with their exact vertical errors.
//! `cargo bench -p yamanami --bench tin`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use yamanami::core::{Snap, Tin, TriangleMesh};
use yamanami::multires::cluster::{ClusterBuild, ClusterOptions, build_tin};
use yamanami::multires::tin::{LevelOptions, collapse_levels};
use yamanami_testkit::Rng;

const SNAP: Snap = Snap { unit_m: 1.0, per_unit: 1000.0 };

/// A shaken grid of 2 n² triangles over hills of eight octaves and some noise, to the millimetre, far from zero.
fn hills(n: usize) -> Tin {
    let mut rng = Rng::new(1);
    let mut positions = Vec::with_capacity((n + 1) * (n + 1));
    for k in 0..(n + 1) * (n + 1) {
        let (x, y) = ((k % (n + 1)) as f64, (k / (n + 1)) as f64);
        let octave = |o: i32| {
            let (f, phase) = (0.01 * 2f64.powi(o), f64::from(o));
            20.0 / 2f64.powi(o) * (f * x + phase).sin() * (1.1 * f * y + 2.0 * phase).cos()
        };
        let z = (0..8).map(octave).sum::<f64>() + 0.05 * rng.unit();
        let [dx, dy] = [0, 1].map(|_| 0.4 * rng.unit() - 0.2);
        positions.push(SNAP.place(DVec3::new(3e5 + x + dx, 4e6 + y + dy, z)));
    }
    let mut triangles = Vec::with_capacity(2 * n * n);
    for k in 0..n * n {
        let a = (k / n * (n + 1) + k % n) as u32;
        let [b, d] = [a + 1, a + n as u32 + 1];
        triangles.extend([[a, b, d + 1], [a, d + 1, d]]);
    }
    Tin::of_mesh("hills", TriangleMesh::new(positions, triangles))
}

/// How many nodes each level of a hierarchy has, with their mean and their greatest error, metres.
fn print_errors(built: &ClusterBuild) {
    let deepest = built.nodes.iter().map(|n| n.level).max().unwrap_or(0);
    for level in (0..=deepest).rev() {
        let errors: Vec<f32> = built.nodes.iter().filter(|n| n.level == level).map(|n| n.error_m).collect();
        let (sum, worst) = (errors.iter().sum::<f32>(), errors.iter().copied().fold(0.0, f32::max));
        println!(
            "level {level}: {} nodes, errors {:.3} m, at most {worst:.3} m",
            errors.len(),
            sum / errors.len() as f32
        );
    }
}

fn build(c: &mut Criterion) {
    let tin = hills(300);
    let options = ClusterOptions::default();
    let build = || build_tin(&tin, Some(SNAP), &options).unwrap();
    print_errors(&build());
    let mut group = c.benchmark_group("hierarchy of a TIN");
    group.throughput(Throughput::Elements(tin.mesh.triangles.len() as u64));
    group.sample_size(10);
    for (name, threads) in [("one core", 1), ("all cores", 0)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        group.bench_function(BenchmarkId::from_parameter(name), |b| b.iter(|| pool.install(build)));
    }
}

fn levels(c: &mut Criterion) {
    let tin = hills(150);
    let count = tin.mesh.triangles.len();
    let mut group = c.benchmark_group("levels of a TIN, with vertical errors");
    group.throughput(Throughput::Elements(count as u64));
    group.sample_size(10);
    for share in [2, 8] {
        group.bench_function(BenchmarkId::from_parameter(format!("1/{share}")), |b| {
            b.iter(|| collapse_levels(&tin, &[count / share], &LevelOptions::default()));
        });
    }
}

criterion_group!(benches, build, levels);
criterion_main!(benches);
