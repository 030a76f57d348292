//! Speed of the k-disk wavelets: analysis and synthesis of the three coordinates, setting up, and the bytes that are held.
//! `cargo bench -p yamanami --bench kdisk`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use yamanami::core::{BaseMesh, SemiRegular};
use yamanami::multires::kdisk::{Lifting, Wavelet};

const OCTAHEDRON: [[u32; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

/// A torus of 200 triangles with edges flipped here and there, as the collapse of a scan might leave it.
fn irregular() -> Vec<[u32; 3]> {
    let at = |x: u32, y: u32| x % 10 + 10 * (y % 10);
    let square = |x, y| [[at(x, y), at(x + 1, y), at(x, y + 1)], [at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]];
    let mut triangles: Vec<[u32; 3]> = (0..100).flat_map(|k| square(k % 10, k / 10)).collect();
    for first in (0..200).step_by(3) {
        let [a, b, c] = triangles[first];
        let Some(second) = triangles.iter().position(|t| (0..3).any(|k| t[k] == b && t[(k + 1) % 3] == a)) else {
            continue;
        };
        let Some(&d) = triangles[second].iter().find(|v| ![a, b].contains(v)) else { continue };
        if !triangles.iter().any(|t| t.contains(&c) && t.contains(&d)) {
            triangles[first] = [a, d, c];
            triangles[second] = [d, b, c];
        }
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
        ("200 triangles, 5 splits", mesh(irregular(), 5)),
        ("200 triangles, 6 splits", mesh(irregular(), 6)),
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
