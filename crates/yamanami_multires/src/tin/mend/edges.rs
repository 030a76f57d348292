//! Edges: which faces are there twice or crowd an edge, and which vertices of the border lie within its edges.

use super::tree::{Rect, Tree};
use super::{Fault, Faults, touch_m, vertex_place};
use crate::tin::mixed;
use glam::DVec2;
use rayon::prelude::*;
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

/// The edges with one face alone, ascending.
fn border(mesh: &TriangleMesh) -> Vec<[u32; 2]> {
    // what leaves a vertex for another less what comes from there: nothing is left inside
    let mut left = vec![0u64; mesh.positions.len()];
    for &[a, b, c] in &mesh.triangles {
        let [ma, mb, mc] = [a, b, c].map(mixed);
        for (v, out, back) in [(a, mb, mc), (b, mc, ma), (c, ma, mb)] {
            left[v as usize] = left[v as usize].wrapping_add(out).wrapping_sub(back);
        }
    }
    let at_border = |f: usize| mesh.triangles[f].iter().filter(|&&v| left[v as usize] != 0).count() > 1;
    let sides = sides(&mesh.triangles, at_border);
    let alone = sides.chunk_by(|a, b| a.0 == b.0).filter(|faces| faces.len() == 1);
    let edges = alone.map(|face| [(face[0].0 >> 32) as u32, face[0].0 as u32]);
    edges.filter(|edge| edge.iter().all(|&v| left[v as usize] != 0)).collect()
}

/// Tells of vertices of the border that lie within one of its edges in plan.
pub(super) fn tell_t_junctions(mesh: &TriangleMesh, faults: &mut Faults) {
    let found = t_junctions(mesh);
    faults.add(Fault::TJunction, found.len(), || {
        let vertex = found[0].0;
        vertex_place(vertex as usize, mesh.positions[vertex as usize])
    });
}

/// Vertices of the border that lie in one of its edges in plan, nearer than a millimetre and no end of it, ascending, each
/// with that edge: neighbours there share no edge, and would part if either moved.
pub fn t_junctions(mesh: &TriangleMesh) -> Vec<(u32, [u32; 2])> {
    let border = border(mesh);
    let mut vertices: Vec<u32> = border.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    if border.is_empty() {
        return Vec::new();
    }
    let touch_m = touch_m(mesh);
    let place = |v: u32| mesh.positions[v as usize];
    let tree = Tree::new(border.iter().map(|e| Rect::around(&e.map(place))).collect());
    let within = |v: u32| {
        let p = place(v).truncate();
        let found = std::cell::Cell::new(None);
        let around = [DVec2::splat(-touch_m), DVec2::splat(touch_m)].map(|d| (p + d).extend(0.0));
        tree.any(&Rect::around(&around), |e| {
            let [a, b] = border[e as usize].map(|end| place(end).truncate());
            let along = b - a;
            let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let is_in = p.distance(a) > touch_m && p.distance(b) > touch_m && p.distance(a + along * t) <= touch_m;
            if is_in {
                found.set(Some((v, border[e as usize])));
            }
            is_in
        });
        found.get()
    };
    vertices.into_par_iter().filter_map(within).collect()
}
