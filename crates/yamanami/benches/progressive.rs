//! Speed of progressive models: a carved ball of half a million triangles, decoded from prefixes of its file, and encoded.
//! `cargo bench -p yamanami --bench progressive`; the scan that the environment variable SCAN names is remeshed and timed, too.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::path::Path;
use yamanami::io::mesh_file::read_mesh;
use yamanami::io::progressive::ProgressiveLimits;
use yamanami::multires::clean::{CleanOptions, clean};
use yamanami::multires::remesh::RemeshOptions;
use yamanami::{ProgressiveOptions, SemiRegularModel, decode_progressive, encode_progressive};
use yamanami_testkit::{Relief, carved};

fn models() -> Vec<SemiRegularModel> {
    let ball = SemiRegularModel::recognised(&carved(8, Relief::Sharp), "ball".to_owned());
    let mut models: Vec<SemiRegularModel> = ball.expect("a ball is a surface").into_iter().collect();
    if let Ok(scan) = std::env::var("SCAN") {
        let mut mesh = read_mesh(&scan).expect("a mesh");
        clean(&mut mesh, &CleanOptions { weld_across_seams: true, orient: true, ..CleanOptions::safe() });
        models.push(SemiRegularModel::remeshed(&mesh, scan, &RemeshOptions::default()).expect("a surface").0);
    }
    models
}

fn progressive(c: &mut Criterion) {
    for model in models() {
        let options = ProgressiveOptions::default();
        let file = encode_progressive(&model.mesh, &model.positions, &options).expect("finite places").bytes;
        let triangles = u64::from(model.mesh.triangle_count(model.mesh.levels()));
        let mut group = c.benchmark_group(format!("{}, {triangles} triangles", model.title));
        group.throughput(Throughput::Elements(triangles)).sample_size(10);
        for bytes in [5_000, 14_000, 40_000, file.len()].into_iter().filter(|&b| b <= file.len()) {
            group.bench_function(BenchmarkId::new("decode", format!("{bytes} bytes")), |b| {
                b.iter(|| decode_progressive(Path::new("bench"), &file[..bytes], ProgressiveLimits::default()));
            });
        }
        group.bench_function("encode", |b| b.iter(|| encode_progressive(&model.mesh, &model.positions, &options)));
    }
}

criterion_group!(benches, progressive);
criterion_main!(benches);
