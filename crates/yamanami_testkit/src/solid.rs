//! Closed meshes of any size, smooth with bumps, as a scan might be.

use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::TriangleMesh;

/// A closed grid of `n` by `m` squares that runs around in both directions, placed by `at` of two turns.
pub fn torus(n: u32, m: u32, at: impl Fn(f64, f64) -> DVec3) -> TriangleMesh {
    let turn = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let positions = (0..n * m).map(|i| at(turn(i % n, n), turn(i / n, m))).collect();
    let number = |x: u32, y: u32| (y % m) * n + x % n;
    let triangles = (0..n * m)
        .flat_map(|i| {
            let (x, y) = (i % n, i / n);
            let [a, b, c, d] = [number(x, y), number(x + 1, y), number(x + 1, y + 1), number(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriangleMesh::new(positions, triangles)
}

/// A ring with bumps, closed and of one piece.
pub fn ring(n: u32, m: u32) -> TriangleMesh {
    torus(n, m, |u, v| {
        let r = 1.0 + 0.04 * (7.0 * u).sin() * (5.0 * v).cos() + 0.01 * (23.0 * u + 11.0 * v).sin();
        DVec3::new((3.0 + r * v.cos()) * u.cos(), (3.0 + r * v.cos()) * u.sin(), r * v.sin())
    })
}

/// A closed ball: a cube's six faces of `n` by `n` squares, blown up, with bumps.
pub fn ball(n: u32) -> TriangleMesh {
    let mut number = HashMap::new();
    let mut mesh = TriangleMesh::default();
    for face in 0..6 {
        for i in 0..n * n {
            let mut vertex = |x: u32, y: u32| {
                let side = if face % 2 == 0 { 0 } else { n };
                let (x, y) = if face % 2 == 0 { (y, x) } else { (x, y) };
                let mut cell = [x, y, side];
                cell.rotate_right(face / 2);
                *number.entry(cell).or_insert_with(|| {
                    let p = DVec3::from_array(cell.map(|c| 2.0 * f64::from(c) / f64::from(n) - 1.0)).normalize();
                    let bump = 0.05 * (9.0 * p.x).sin() * (8.0 * p.y).cos() + 0.02 * (31.0 * p.z + 5.0 * p.x).sin();
                    mesh.positions.push(p * (1.0 + bump));
                    mesh.positions.len() as u32 - 1
                })
            };
            let (x, y) = (i % n, i / n);
            let [a, b, c, d] = [vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}
