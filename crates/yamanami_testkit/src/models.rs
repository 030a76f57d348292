//! Small made models of known shape: what a reducer of meshes is tried on.

use crate::Rng;
use glam::DVec3;
use yamanami_core::TriangleMesh;

/// A grid of `columns` × `rows` squares, each cut in two, its points placed by a function of two shares from 0 to 1.
///
/// Where `wraps` says so, the last column or row is the first one.
pub fn sheet(
    [columns, rows]: [u32; 2],
    [wraps_u, wraps_v]: [bool; 2],
    place: impl Fn(f64, f64) -> DVec3,
) -> TriangleMesh {
    let [nu, nv] = [columns + u32::from(!wraps_u), rows + u32::from(!wraps_v)];
    let positions = (0..nv)
        .flat_map(|j| (0..nu).map(move |i| (i, j)))
        .map(|(i, j)| place(f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows)))
        .collect();
    let at = |i: u32, j: u32| (j % nv) * nu + i % nu;
    let triangles = (0..rows)
        .flat_map(|j| (0..columns).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriangleMesh::new(positions, triangles)
}

/// A torus with radii 1 and 0.4, bumpy where `bump` is not zero: a closed surface with a hole through it.
pub fn torus(columns: u32, rows: u32, bump: f64) -> TriangleMesh {
    let turn = std::f64::consts::TAU;
    sheet([columns, rows], [true, true], |u, v| {
        let r = 0.4 + bump * ((5.0 * turn * u).sin() * (3.0 * turn * v).cos());
        let (ring, tube) = (turn * u, turn * v);
        let out = 1.0 + r * tube.cos();
        DVec3::new(out * ring.cos(), out * ring.sin(), r * tube.sin())
    })
}

/// A unit sphere: an octahedron whose triangles are split in four so often.
pub fn sphere(splits: u32) -> TriangleMesh {
    let n = 1u32 << splits;
    // each side as a triangular grid over the octahedron; equal places are joined
    let mut numbers = std::collections::BTreeMap::new();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for side in 0..8u32 {
        let sign = |axis: u32| if side >> axis & 1 == 0 { 1i64 } else { -1 };
        let mut number = |i: u32, j: u32| {
            let k = n - i - j;
            let key = [sign(0) * i64::from(i), sign(1) * i64::from(j), sign(2) * i64::from(k)];
            *numbers.entry(key).or_insert_with(|| {
                positions.push(DVec3::from(key.map(|c| c as f64)).normalize());
                positions.len() as u32 - 1
            })
        };
        let mirrored = side.count_ones() % 2 == 1;
        let mut add = |t: [u32; 3]| triangles.push(if mirrored { [t[0], t[2], t[1]] } else { t });
        for i in 0..n {
            for j in 0..n - i {
                add([number(i, j), number(i + 1, j), number(i, j + 1)]);
                if i + j + 2 <= n {
                    add([number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
                }
            }
        }
    }
    TriangleMesh::new(positions, triangles)
}

/// Moves every vertex by up to so much to all sides.
pub fn shake(mesh: &mut TriangleMesh, by: f64, seed: u64) {
    let mut random = Rng::new(seed);
    for p in &mut mesh.positions {
        *p += by * DVec3::from(std::array::from_fn(|_| 2.0 * random.unit() - 1.0));
    }
}

/// A model's edges, by how many triangles have them: one, two, more; and how many are run along twice the same way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EdgeCount {
    /// With one triangle.
    pub open: usize,
    /// With two.
    pub inner: usize,
    /// With more.
    pub crowded: usize,
    /// Run along twice the same way.
    pub turned: usize,
}

/// Counts the edges of a mesh, vertices at one place taken as one.
pub fn edges(mesh: &TriangleMesh) -> EdgeCount {
    let place = |v: u32| mesh.positions[v as usize].to_array().map(|c| (c + 0.0).to_bits());
    let mut uses: std::collections::BTreeMap<_, [usize; 2]> = std::collections::BTreeMap::new();
    for t in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = (place(t[k]), place(t[(k + 1) % 3]));
            uses.entry((a.min(b), a.max(b))).or_default()[usize::from(a > b)] += 1;
        }
    }
    let mut count = EdgeCount::default();
    for [along, against] in uses.into_values() {
        match along + against {
            1 => count.open += 1,
            2 => count.inner += 1,
            _ => count.crowded += 1,
        }
        count.turned += usize::from(along > 1 || against > 1);
    }
    count
}
