//! Edges: which faces are there twice or crowd an edge, and which vertices of the border lie within its edges.

use super::tree::{Rect, Tree};
use super::{Fault, Faults, plan, vertex_place};
use rayon::prelude::*;
use robust::orient2d;
use std::collections::HashSet;
use yamanami_core::TriangleMesh;

/// A face's side: the lesser vertex, the greater, whether it runs from the greater, the face.
type Side = (u64, bool, u32);

fn sides(triangles: &[[u32; 3]], alive: impl Fn(usize) -> bool) -> Vec<Side> {
    let mut sides: Vec<Side> = Vec::with_capacity(3 * triangles.len());
    for (f, t) in triangles.iter().enumerate().filter(|&(f, _)| alive(f)) {
        for k in 0..3 {
            let [a, b] = [t[k], t[(k + 1) % 3]];
            sides.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), a > b, f as u32));
        }
    }
    sides.par_sort_unstable();
    sides
}

/// Faces with the corners of an earlier one, and faces with a side that an earlier one has, both ascending. All faces are
/// counter-clockwise: two that have a side in common, in the same direction, lie on the same side of it.
pub(super) fn repeated(triangles: &[[u32; 3]], alive: &[bool]) -> [Vec<u32>; 2] {
    let sides = sides(triangles, |f| alive[f]);
    let mut contested: Vec<u32> = Vec::new();
    for same in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|same| same.len() > 1) {
        contested.extend(same.iter().map(|side| side.2));
    }
    contested.sort_unstable();
    contested.dedup();
    let (mut taken, mut seen) = (HashSet::new(), HashSet::new());
    let [mut twice, mut crowded] = [Vec::new(), Vec::new()];
    for f in contested {
        let t = triangles[f as usize];
        let mut corners = t;
        corners.sort_unstable();
        let its = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        if !seen.insert(corners) {
            twice.push(f);
        } else if its.iter().any(|side| taken.contains(side)) {
            crowded.push(f);
        } else {
            taken.extend(its);
        }
    }
    [twice, crowded]
}

/// Tells of vertices of the border that lie within one of its edges in plan.
pub(super) fn find_t_junctions(mesh: &TriangleMesh, faults: &mut Faults) {
    let sides = sides(&mesh.triangles, |_| true);
    let border: Vec<[u32; 2]> = sides
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|faces| faces.len() == 1)
        .map(|face| [(face[0].0 >> 32) as u32, face[0].0 as u32])
        .collect();
    let mut vertices: Vec<u32> = border.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let place = |v: u32| mesh.positions[v as usize];
    let tree = Tree::new(border.iter().map(|e| Rect::around(&e.map(place))).collect());
    let inside: Vec<u32> = vertices
        .into_par_iter()
        .filter(|&v| {
            let p = place(v);
            tree.any(&Rect::around(&[p]), |e| {
                let [a, b] = border[e as usize].map(place);
                let ends = [a, b].map(|end| end.truncate() == p.truncate());
                ends == [false, false] && orient2d(plan(a), plan(b), plan(p)) == 0.0
            })
        })
        .collect();
    faults.add(Fault::TJunction, inside.len(), || vertex_place(inside[0] as usize, place(inside[0])));
}
