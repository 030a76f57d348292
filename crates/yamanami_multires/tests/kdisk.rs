//! k-disk wavelets: reconstruction, orthogonality, their filters, and the numbers that the paper and a reference give.

use proptest::prelude::*;
use yamanami_core::{BaseMesh, SemiRegular};
use yamanami_multires::kdisk::{Filters, Lifting, Sparse, Wavelet, filters, keep_largest, l2_norm, largest_cosine};

fn octahedron() -> Vec<[u32; 3]> {
    vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
}

/// A torus of 3 × 3 squares: the smallest that is a base mesh with all vertices alike.
fn torus() -> Vec<[u32; 3]> {
    let at = |x: u32, y: u32| x % 3 + 3 * (y % 3);
    let square = |x, y| [[at(x, y), at(x + 1, y), at(x, y + 1)], [at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]];
    (0..9).flat_map(|k| square(k % 3, k / 3)).collect()
}

fn mesh(triangles: Vec<[u32; 3]>, levels: u32) -> SemiRegular {
    let vertices = triangles.iter().flatten().max().unwrap() + 1;
    SemiRegular::new(BaseMesh::new(vertices, triangles).unwrap(), levels).unwrap()
}

/// Closed, with border, of higher genus, a lone triangle, a fan around an inner vertex of valence 3, and two parts.
fn meshes(levels: u32) -> Vec<SemiRegular> {
    let two_parts = vec![[0, 1, 2], [1, 3, 2], [4, 5, 6]];
    [
        octahedron(),
        torus(),
        vec![[0, 1, 2]],
        vec![[0, 1, 2], [1, 3, 2]],
        vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]],
        two_parts,
    ]
    .map(|triangles| mesh(triangles, levels))
    .into()
}

/// Base vertices of 2, 3, 4, 5, 6, 7 and 9 triangles, inside and at borders, on few triangles: what is split often enough to be regular.
fn bases() -> Vec<Vec<[u32; 3]>> {
    let wheel = |n: u32| (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect::<Vec<_>>();
    let closed_wheel = |n: u32| {
        let below = (0..n).map(|k| [1 + n, 1 + (k + 1) % n, 1 + k]);
        wheel(n).into_iter().chain(below).collect::<Vec<_>>()
    };
    vec![
        vec![[0, 1, 2]],
        vec![[0, 1, 2], [1, 3, 2]],
        vec![[0, 1, 2], [0, 2, 1]],
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
        octahedron(),
        torus(),
        wheel(3),
        wheel(5),
        wheel(7),
        closed_wheel(3),
        closed_wheel(5),
        closed_wheel(9),
        // a vertex inside whose neighbours have two, three and four triangles at the border; turned triangles; two parts
        vec![[1, 2, 0], [0, 2, 3], [3, 4, 0], [4, 1, 0], [2, 1, 5], [6, 7, 8], [7, 6, 9]],
    ]
}

const WAVELETS: [Wavelet; 6] = [
    Wavelet::Lazy,
    Wavelet::KDisk(0),
    Wavelet::KDisk(1),
    Wavelet::KDisk(2),
    Wavelet::KDisk(3),
    Wavelet::Orthogonal,
];

fn noise(n: u32, seed: u64) -> Vec<f64> {
    let hash =
        |k: u64| (k ^ seed).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (0..u64::from(n)).map(|k| (hash(k + 1) >> 11) as f64 / (1u64 << 53) as f64 - 0.5).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn synthesis_undoes_analysis(seed: u64, levels in 0u32..6) {
        for mesh in meshes(levels) {
            let values = noise(mesh.vertex_count(levels), seed);
            for wavelet in WAVELETS {
                let lifting = Lifting::new(&mesh, wavelet);
                let mut x = values.clone();
                lifting.analyse(&mut x);
                lifting.synthesise(&mut x);
                let worst = x.iter().zip(&values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                prop_assert!(worst < 1e-14, "{wavelet}: {worst:e}");
            }
        }
    }

    #[test]
    fn lazy_is_exact_on_integers(seed: u64) {
        for mesh in meshes(4) {
            let values: Vec<f64> = noise(mesh.vertex_count(4), seed).iter().map(|v| (v * 1e9).round()).collect();
            let lifting = Lifting::new(&mesh, Wavelet::Lazy);
            let mut x = values.clone();
            lifting.analyse(&mut x);
            lifting.synthesise(&mut x);
            prop_assert_eq!(x, values);
        }
    }

    /// Leaving a whole level out: nothing beats the least-squares approximation, and wide disks beat no disk.
    #[test]
    fn wider_disks_come_closer(seed: u64) {
        for mesh in meshes(3) {
            let values = noise(mesh.vertex_count(3), seed);
            let errors = WAVELETS.map(|wavelet| {
                let lifting = Lifting::new(&mesh, wavelet);
                let mut x = values.clone();
                lifting.analyse(&mut x);
                x[mesh.vertex_count(2) as usize..].fill(0.0);
                lifting.synthesise(&mut x);
                let difference: Vec<f64> = x.iter().zip(&values).map(|(a, b)| a - b).collect();
                l2_norm(&mesh, 3, &difference)
            });
            let [lazy, rest @ .., orthogonal] = errors;
            for e in rest {
                prop_assert!(orthogonal <= e * (1.0 + 1e-12) && e <= lazy, "{errors:?}");
            }
        }
    }
}

/// Inner products of a level's hat functions with the function `x`, on triangles of area 1.
fn products(mesh: &SemiRegular, level: u32, x: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; mesh.vertex_count(level) as usize];
    for corners in mesh.triangles(level) {
        let total: f64 = corners.iter().map(|&c| x[c as usize]).sum();
        for c in corners {
            sums[c as usize] += (total + x[c as usize]) / 12.0;
        }
    }
    sums
}

fn square(mesh: &SemiRegular, level: u32, x: &[f64]) -> f64 {
    products(mesh, level, x).iter().zip(x).map(|(a, b)| a * b).sum()
}

fn column(matrix: &Sparse, column: u32) -> Vec<f64> {
    let value = |row: &Vec<(u32, f64)>| row.iter().find(|e| e.0 == column).map_or(0.0, |e| e.1);
    matrix.rows.iter().map(value).collect()
}

/// The inner products of a coarse level's hats with a fine function.
fn with_coarse(mesh: &SemiRegular, level: u32, p: &Sparse, fine: &[f64]) -> Vec<f64> {
    let products = products(mesh, level + 1, fine);
    let mut sums = vec![0.0; mesh.vertex_count(level) as usize];
    for (row, product) in p.rows.iter().zip(products) {
        for &(c, v) in row {
            sums[c as usize] += v * product;
        }
    }
    sums
}

/// Vertices within `k` edges of a vertex's parents.
fn disk(mesh: &SemiRegular, level: u32, vertex: u32, k: u32) -> Vec<u32> {
    let mut found = mesh.parents(vertex).unwrap().to_vec();
    let mut ring = Vec::new();
    for _ in 0..k {
        for v in found.clone() {
            mesh.ring(level, v, &mut ring);
            found.extend_from_slice(&ring);
        }
        found.sort_unstable();
        found.dedup();
    }
    found
}

#[test]
fn wavelets_are_orthogonal_to_the_hats_of_their_disks() {
    for mesh in meshes(3) {
        for k in 0..4 {
            let lifting = Lifting::new(&mesh, Wavelet::KDisk(k));
            for level in 0..3 {
                let Filters { p, q, .. } = filters(&mesh, &lifting, level).unwrap();
                for vertex in mesh.new_vertices(level + 1).step_by(7) {
                    let wavelet = column(&q, vertex - mesh.vertex_count(level));
                    let products = with_coarse(&mesh, level, &p, &wavelet);
                    for v in disk(&mesh, level, vertex, k) {
                        assert!(
                            products[v as usize].abs() < 1e-12,
                            "k {k}, {vertex} and {v}: {}",
                            products[v as usize]
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn norms_are_those_of_the_wavelets() {
    for mesh in meshes(2) {
        for wavelet in [Wavelet::Lazy, Wavelet::KDisk(1), Wavelet::KDisk(2)] {
            let lifting = Lifting::new(&mesh, wavelet);
            let norms = lifting.norms(&mesh);
            let q = filters(&mesh, &lifting, 1).unwrap().q;
            let area = f64::from(mesh.triangle_count(2));
            for vertex in mesh.new_vertices(2) {
                let own = column(&q, vertex - mesh.vertex_count(1));
                let norm = (square(&mesh, 2, &own) / area).sqrt();
                assert!((norms[vertex as usize] - norm).abs() < 1e-14, "{wavelet}: {} {norm}", norms[vertex as usize]);
            }
            let mut hat = vec![0.0; mesh.vertex_count(0) as usize];
            hat[0] = 1.0;
            let norm = (square(&mesh, 0, &hat) / f64::from(mesh.triangle_count(0))).sqrt();
            assert!((norms[0] - norm).abs() < 1e-14);
        }
    }
}

#[test]
fn the_filters_are_what_lifting_does_and_invert_each_other() {
    for mesh in meshes(3) {
        for wavelet in [Wavelet::Lazy, Wavelet::KDisk(1), Wavelet::KDisk(2)] {
            let lifting = Lifting::new(&mesh, wavelet);
            let fine = noise(mesh.vertex_count(3), 5);
            let mut lifted = fine.clone();
            lifting.analyse(&mut lifted);
            let mut x = fine.clone();
            for level in (0..3).rev() {
                let Filters { a, b, p, q } = filters(&mesh, &lifting, level).unwrap();
                let fine: Vec<f64> = x[..mesh.vertex_count(level + 1) as usize].to_vec();
                let (coarse, details) = (a.times(&fine), b.times(&fine));
                let back = p.times(&coarse).into_iter().zip(q.times(&details)).map(|(s, t)| s + t);
                assert!(back.zip(&fine).all(|(s, t)| (s - t).abs() < 1e-14), "{wavelet}");
                x[..coarse.len()].copy_from_slice(&coarse);
                x[coarse.len()..][..details.len()].copy_from_slice(&details);
            }
            assert!(x.iter().zip(&lifted).all(|(s, t)| (s - t).abs() < 1e-14), "{wavelet}");
        }
    }
}

/// One step of analysis, and back, against the filters.
fn lifting_is_what_the_filters_say(base: Vec<[u32; 3]>, k: u32, levels: u32) {
    let mesh = mesh(base, levels);
    let lifting = Lifting::new(&mesh, Wavelet::KDisk(k));
    let fine = noise(mesh.vertex_count(levels), u64::from(k));
    let mut lifted = fine.clone();
    lifting.analyse(&mut lifted);
    let Filters { a, b, .. } = filters(&mesh, &lifting, levels - 1).unwrap();
    let mut x = a.times(&fine);
    Lifting::new(&mesh.coarser(levels - 1), Wavelet::KDisk(k)).analyse(&mut x);
    x.extend(b.times(&fine));
    for (v, (s, t)) in (0..).zip(x.iter().zip(&lifted)) {
        let triangles = mesh.base().triangles();
        assert!((s - t).abs() < 1e-14, "k {k}, {triangles:?}: {s} {t} at {:?}", mesh.place(v));
    }
    lifting.synthesise(&mut lifted);
    assert!(lifted.iter().zip(&fine).all(|(s, t)| (s - t).abs() < 1e-14));
}

#[test]
fn narrow_disks_are_what_the_filters_say() {
    for base in bases() {
        // most details are regular from one level on, and none before
        for (k, levels) in [(0, 2), (0, 3), (0, 4), (1, 3), (1, 4)] {
            lifting_is_what_the_filters_say(base.clone(), k, levels);
        }
    }
}

#[test]
fn two_rings_are_what_the_filters_say() {
    for base in bases() {
        lifting_is_what_the_filters_say(base, 2, 4);
    }
}

#[test]
fn long_rows_are_what_the_filters_say() {
    lifting_is_what_the_filters_say(vec![[0, 1, 2]], 2, 7);
    lifting_is_what_the_filters_say(vec![[0, 1, 2], [0, 2, 1]], 2, 5);
    lifting_is_what_the_filters_say(octahedron(), 2, 5);
}

#[test]
fn wide_disks_are_what_the_filters_say() {
    for (base, k) in [
        (vec![[0, 1, 2], [0, 2, 1]], 3),
        (vec![[0, 1, 2]], 4),
        (vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]], 3),
    ] {
        lifting_is_what_the_filters_say(base, k, 5);
    }
}

/// Some triangles of a sphere of 24 that hang together, if they make a base mesh.
fn part_of_sphere(choices: &[u8]) -> Option<Vec<[u32; 3]>> {
    let mut sphere = Vec::new();
    for (k, [a, b, c]) in (6..).zip(octahedron()) {
        sphere.extend([[a, b, k], [b, c, k], [c, a, k]]);
    }
    let mut chosen = vec![sphere.swap_remove(0)];
    for &choice in choices {
        let touches = |t: &[u32; 3]| chosen.iter().any(|c| c.iter().filter(|v| t.contains(v)).count() == 2);
        let near: Vec<usize> = (0..sphere.len()).filter(|&n| touches(&sphere[n])).collect();
        let turns = choice % 3;
        let mut triangle = sphere.swap_remove(*near.get(usize::from(choice) % near.len().max(1))?);
        triangle.rotate_left(usize::from(turns));
        chosen.push(triangle);
    }
    let mut named: Vec<u32> = chosen.concat();
    named.sort_unstable();
    named.dedup();
    let chosen: Vec<[u32; 3]> = chosen.iter().map(|t| t.map(|v| named.binary_search(&v).unwrap() as u32)).collect();
    BaseMesh::new(named.len() as u32, chosen.clone()).is_ok().then_some(chosen)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn any_base_is_what_the_filters_say(choices in prop::collection::vec(any::<u8>(), 0..20), k in 0u32..3) {
        if let Some(base) = part_of_sphere(&choices) {
            lifting_is_what_the_filters_say(base, k, 3 + k.min(1));
        }
    }
}

#[test]
fn threads_and_coordinates_change_no_bit() {
    for (base, levels) in [(octahedron(), 6), (vec![[0, 1, 2]], 7), (torus(), 5)] {
        let mesh = mesh(base, levels);
        let n = mesh.vertex_count(levels);
        let planes = [1, 2, 3].map(|seed| noise(n, seed));
        for wavelet in [Wavelet::Lazy, Wavelet::KDisk(2)] {
            let run = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut vectors: Vec<[f64; 3]> =
                    (0..n as usize).map(|v| [0, 1, 2].map(|k: usize| planes[k][v])).collect();
                let analysed = pool.install(|| {
                    let lifting = Lifting::new(&mesh, wavelet);
                    lifting.analyse_vectors(&mut vectors);
                    let analysed = vectors.clone();
                    lifting.synthesise_vectors(&mut vectors);
                    analysed
                });
                (analysed, vectors)
            };
            let one = run(1);
            assert!(one == run(2) && one == run(5), "{wavelet}");
            let lifting = Lifting::new(&mesh, wavelet);
            for (k, plane) in planes.iter().enumerate() {
                let mut x = plane.clone();
                lifting.analyse(&mut x);
                assert!(x.iter().zip(&one.0).all(|(x, v)| *x == v[k]), "{wavelet}");
                lifting.synthesise(&mut x);
                assert!(x.iter().zip(&one.1).all(|(x, v)| *x == v[k]), "{wavelet}");
            }
        }
    }
}

/// Positions, what lifting holds, and the cells of a step, a third of the positions, stay within twice the positions.
#[test]
fn lifting_holds_little() {
    for (base, levels) in [(octahedron(), 5), (torus(), 5), (vec![[0, 1, 2]], 9)] {
        let mesh = mesh(base, levels);
        let bytes = Lifting::new(&mesh, Wavelet::KDisk(2)).bytes();
        assert!(bytes < 16 * mesh.vertex_count(levels) as usize, "{bytes}");
    }
}

/// The largest cosine of a wavelet with a coarse hat on the octahedron of 2,048 faces, as an independent reference gives it.
#[test]
fn cosines_fall_as_the_reference_says() {
    let mesh = mesh(octahedron(), 4);
    for (wavelet, expected) in [
        (Wavelet::Lazy, 0.510),
        (Wavelet::KDisk(0), 0.134),
        (Wavelet::KDisk(1), 0.034),
        (Wavelet::KDisk(2), 0.011),
    ] {
        let lifting = Lifting::new(&mesh, wavelet);
        let cosine = |level| largest_cosine(&mesh, &filters(&mesh, &lifting, level).unwrap(), level);
        let largest = (0..4).map(cosine).fold(0.0, f64::max);
        assert!((largest - expected).abs() < 0.0006, "{wavelet}: {largest}");
    }
}

/// Formula (13) of the paper: what is not zero in the rows of Q on regular surroundings.
#[test]
fn the_filters_are_as_full_as_the_paper_counts() {
    let mesh = mesh(torus(), 3);
    for k in 1..4 {
        let q = filters(&mesh, &Lifting::new(&mesh, Wavelet::KDisk(k)), 2).unwrap().q;
        let coarse = mesh.vertex_count(2) as usize;
        let count = |rows: &[Vec<(u32, f64)>]| {
            let counts: Vec<usize> = rows.iter().map(Vec::len).collect();
            assert!(counts.iter().all(|c| *c == counts[0]), "regular everywhere");
            counts[0]
        };
        let sum = |first: u32| (1..=k).map(|i| 6 * (first + 3 * i)).sum::<u32>() as usize;
        assert_eq!(count(&q.rows[..coarse]), 6 + sum(1), "n_I({k})");
        assert_eq!(count(&q.rows[coarse..]), 11 + sum(2), "n_N({k})");
    }
}

#[test]
fn the_norm_is_that_of_the_inner_products() {
    for mesh in meshes(2) {
        let x = noise(mesh.vertex_count(2), 9);
        let expected = (square(&mesh, 2, &x) / f64::from(mesh.triangle_count(2))).sqrt();
        assert!((l2_norm(&mesh, 2, &x) - expected).abs() < 1e-14);
    }
}

/// The norms given for the orthogonal wavelets are those of disks; what they are off by is as said.
#[test]
fn wide_disks_have_the_norms_of_the_limit() {
    for mesh in meshes(3) {
        let lifting = Lifting::new(&mesh, Wavelet::Orthogonal);
        let norms = lifting.norms(&mesh);
        for vertex in mesh.new_vertices(3).step_by(11) {
            let mut wavelet = vec![0.0; mesh.vertex_count(3) as usize];
            wavelet[vertex as usize] = 1.0;
            lifting.synthesise(&mut wavelet);
            let off = norms[vertex as usize] / l2_norm(&mesh, 3, &wavelet) - 1.0;
            assert!(off.abs() < 1e-6, "vertex {vertex}: {off:e}");
        }
    }
}

#[test]
fn the_largest_stay() {
    let mesh = mesh(vec![[0, 1, 2]], 1);
    let kept = keep_largest(&mesh, &[0.0, 0.0, 0.0, 2.0, 3.0, 2.0], 2);
    assert_eq!(kept, [true, true, true, true, true, false]);
}
