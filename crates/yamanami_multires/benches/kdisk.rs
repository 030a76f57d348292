//! Speed of the k-disk wavelets: analysis and synthesis of the three coordinates, setting up, and the bytes that are held.
//! `cargo bench -p yamanami_multires`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use yamanami_core::{BaseMesh, SemiRegular};
use yamanami_multires::kdisk::{Lifting, Wavelet};

const OCTAHEDRON: [[u32; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

/// The octahedron, each triangle `rounds` times split at its centre: far from regular.
fn split_at_centres(rounds: u32) -> Vec<[u32; 3]> {
    let mut triangles = OCTAHEDRON.to_vec();
    let mut vertices = 6;
    for _ in 0..rounds {
        let split = |[a, b, c]: [u32; 3]| {
            let centre = vertices;
            vertices += 1;
            [[a, b, centre], [b, c, centre], [c, a, centre]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    triangles
}

fn mesh(triangles: Vec<[u32; 3]>, levels: u32) -> SemiRegular {
    let vertices = triangles.iter().flatten().max().unwrap() + 1;
    SemiRegular::new(BaseMesh::new(vertices, triangles).unwrap(), levels).unwrap()
}

/// Names and meshes: few base triangles split often, many split less, one with its border.
fn meshes() -> Vec<(&'static str, SemiRegular)> {
    vec![
        ("octahedron, 8 splits", mesh(OCTAHEDRON.to_vec(), 8)),
        ("octahedron, 9 splits", mesh(OCTAHEDRON.to_vec(), 9)),
        ("216 triangles, 5 splits", mesh(split_at_centres(3), 5)),
        ("216 triangles, 6 splits", mesh(split_at_centres(3), 6)),
        ("1 triangle, 9 splits", mesh(vec![[0, 1, 2]], 9)),
    ]
}

fn positions(mesh: &SemiRegular) -> Vec<[f64; 3]> {
    let n = mesh.vertex_count(mesh.levels());
    (0..n).map(|v| [1.0, 2.0, 3.0].map(|f| (f64::from(v) * f).sin())).collect()
}

fn transform(c: &mut Criterion) {
    for (name, mesh) in meshes() {
        let mut values = positions(&mesh);
        let mut group = c.benchmark_group(format!("analyse and synthesise xyz, {name}"));
        group.throughput(Throughput::Elements(values.len() as u64));
        group.sample_size(20);
        let kdisks = (0..5).map(Wavelet::KDisk);
        for wavelet in std::iter::once(Wavelet::Lazy).chain(kdisks) {
            let lifting = Lifting::new(&mesh, wavelet);
            let bytes = lifting.bytes() as f64 / values.len() as f64;
            println!("{name}, {wavelet}: {bytes:.2} bytes a vertex held, {} stencils", lifting.stencil_count());
            group.bench_function(BenchmarkId::from_parameter(wavelet), |b| {
                b.iter(|| {
                    lifting.analyse_vectors(&mut values);
                    lifting.synthesise_vectors(&mut values);
                });
            });
        }
    }
}

fn orthogonal(c: &mut Criterion) {
    let mesh = mesh(OCTAHEDRON.to_vec(), 7);
    let mut values = positions(&mesh);
    let lifting = Lifting::new(&mesh, Wavelet::Orthogonal);
    let mut group = c.benchmark_group("analyse and synthesise xyz, octahedron, 7 splits");
    group.throughput(Throughput::Elements(values.len() as u64));
    group.sample_size(10);
    group.bench_function(BenchmarkId::from_parameter(Wavelet::Orthogonal), |b| {
        b.iter(|| {
            lifting.analyse_vectors(&mut values);
            lifting.synthesise_vectors(&mut values);
        });
    });
}

fn set_up(c: &mut Criterion) {
    let mut group = c.benchmark_group("set-up, k = 2");
    group.sample_size(10);
    for (name, mesh) in meshes() {
        group.throughput(Throughput::Elements(u64::from(mesh.vertex_count(mesh.levels()))));
        group.bench_function(BenchmarkId::from_parameter(name), |b| {
            b.iter(|| Lifting::new(&mesh, Wavelet::KDisk(2)));
        });
    }
}

criterion_group!(benches, transform, orthogonal, set_up);
criterion_main!(benches);
