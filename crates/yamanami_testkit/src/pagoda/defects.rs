//! What is wrong with real scans: places that no ray reached are open, some triangles are there twice, some stand out from an
//! edge that two others share.

use super::plan::{Storey, storeys};
use crate::rng::Rng;
use crate::rng::scramble;
use glam::DVec3;
use yamanami_core::TriangleMesh;

/// One doubled and one stray triangle in so many, and at least a few.
const CLEAN_RUN: usize = 40_000;
const FEWEST_DEFECTS: usize = 5;

/// Opens the hidden places and adds what should not be there.
pub(super) fn spoil(mut mesh: TriangleMesh, seed: u64) -> TriangleMesh {
    let storeys = storeys();
    let shift = DVec3::new(1.0, 2.0, 3.0) * (seed % 1000) as f64;
    let mut triangles = std::mem::take(&mut mesh.triangles);
    triangles.retain(|t| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        !is_hidden(&storeys, (a + b + c) / 3.0, normal, shift)
    });
    mesh.triangles = triangles;
    add_defects(&mut mesh, seed);
    drop_unused(&mut mesh);
    mesh
}

/// Behind the brackets, under the inner eaves and behind the walls the scanner saw little.
fn is_hidden(storeys: &[Storey], p: DVec3, normal: DVec3, shift: DVec3) -> bool {
    let from_axis = p.x.abs().max(p.y.abs());
    let outward = if p.x.abs() > p.y.abs() { normal.x * p.x.signum() } else { normal.y * p.y.signum() };
    // blotches a few centimetres wide
    let blotch = super::paint::smooth_noise(p / 0.035 + shift);
    storeys.iter().any(|s| {
        let out_m = from_axis - s.half_m;
        let in_walls = p.z > s.floor_z && p.z < s.head_z && out_m < -0.01;
        let in_brackets = p.z > s.head_z && p.z < s.roof.under_z(0.0, s.half_m) + 0.02;
        let behind = out_m < 0.02 && (outward < -0.3 || normal.z > 0.7);
        let deep = out_m < 0.11 && blotch > 0.42;
        in_walls || (in_brackets && (out_m < -0.012 || behind || deep))
    })
}

fn add_defects(mesh: &mut TriangleMesh, seed: u64) {
    let count = mesh.triangles.len();
    let mut rng = Rng::new(scramble(seed ^ 0x5CA9));
    for _ in 0..(count / CLEAN_RUN).max(FEWEST_DEFECTS) {
        let doubled = mesh.triangles[rng.below(count)];
        mesh.triangles.push(doubled);
        // a third triangle on an edge, to a corner of another near by
        let at = rng.below(count);
        let [a, b, c] = mesh.triangles[at];
        let near = mesh.triangles[(at + 5) % count];
        if let Some(&d) = near.iter().find(|&d| ![a, b, c].contains(d)) {
            mesh.triangles.push([a, b, d]);
        }
    }
}

fn drop_unused(mesh: &mut TriangleMesh) {
    const UNUSED: u32 = u32::MAX;
    let mut number = vec![UNUSED; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&i| number[i as usize] = 0);
    let mut next = 0;
    for old in 0..number.len() {
        if number[old] != UNUSED {
            number[old] = next;
            mesh.positions[next as usize] = mesh.positions[old];
            mesh.colours[next as usize] = mesh.colours[old];
            next += 1;
        }
    }
    mesh.positions.truncate(next as usize);
    mesh.colours.truncate(next as usize);
    mesh.triangles.iter_mut().flatten().for_each(|i| *i = number[*i as usize]);
}
