use glam::DVec3;
use yamanami_core::{Snap, Tin, TriangleMesh};
use yamanami_multires::cluster::{ClusterOptions, build_tin};
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let mut s = 1u64;
    let mut r = move || {
        s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (s >> 40) as f64 / (1u64 << 24) as f64
    };
    let mut p = vec![];
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (i as f64, j as f64);
            let mut z = 0.0;
            for o in 0..8 {
                let f = 0.01 * 2f64.powi(o);
                z += 20.0 / 2f64.powi(o) * (f * x + o as f64).sin() * (f * y * 1.1 + 2.0 * o as f64).cos();
            }
            z += 0.05 * r();
            let snap = Snap { unit_m: 1.0, per_unit: 1000.0 };
            p.push(snap.place(DVec3::new(x + 0.4 * r() - 0.2 + 3e5, y + 0.4 * r() - 0.2 + 4e6, z)));
        }
    }
    let mut t = vec![];
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            t.extend([[a, b, c], [a, c, d]]);
        }
    }
    let count = t.len();
    let tin = Tin::of_mesh("", TriangleMesh::new(p, t));
    let start = std::time::Instant::now();
    let b = build_tin(&tin, Some(Snap { unit_m: 1.0, per_unit: 1000.0 }), &ClusterOptions::default()).unwrap();
    let e = start.elapsed().as_secs_f64();
    println!(
        "{count} triangles {e:.2} s {:.3} Mtri/s {:?} nodes {} base {}",
        count as f64 / e / 1e6,
        b.summary,
        b.nodes.len(),
        b.base.triangles.len()
    );
    let mut by: std::collections::BTreeMap<u32, (usize, f32)> = Default::default();
    for n in &b.nodes {
        let e = by.entry(n.level).or_default();
        e.0 += 1;
        e.1 = e.1.max(n.error_m);
    }
    println!("{by:?}");
}
