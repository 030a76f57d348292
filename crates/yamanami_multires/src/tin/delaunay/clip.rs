//! The triangles that are kept: inside the boundaries, and not too long.

use super::Cdt;
use super::lines::Kept;
use glam::DVec3;
use spade::Triangulation;
use std::collections::HashMap;

/// Triangles of the triangulation, counter-clockwise, that lie in an odd number of boundaries, if there are any, and have
/// no edge longer than `longest_edge_m` in plan.
pub(super) fn triangles(
    cdt: &Cdt,
    positions: &[DVec3],
    edges: &HashMap<[u32; 2], Kept>,
    longest_edge_m: Option<f64>,
) -> Vec<[u32; 3]> {
    let has_boundary = edges.values().any(|kept| kept.is_border);
    let inside = if has_boundary { inside_faces(cdt, edges) } else { Vec::new() };
    let longest2 = longest_edge_m.map_or(f64::INFINITY, |m| m * m);
    cdt.inner_faces()
        .filter(|face| !has_boundary || inside[face.fix().index()])
        .map(|face| face.vertices().map(|v| v.fix().index() as u32))
        .filter(|corners| {
            let [a, b, c] = corners.map(|v| positions[v as usize].truncate());
            [a - b, b - c, c - a].iter().all(|edge| edge.length_squared() <= longest2)
        })
        .collect()
}

/// Whether a face lies in an odd number of boundaries: counted on the way from outside.
fn inside_faces(cdt: &Cdt, edges: &HashMap<[u32; 2], Kept>) -> Vec<bool> {
    let mut inside = vec![false; cdt.num_all_faces()];
    let mut seen = vec![false; cdt.num_all_faces()];
    let mut stack = vec![];
    let mut cross =
        |edge: spade::handles::DirectedEdgeHandle<'_, _, _, _, _>, from_inside: bool, stack: &mut Vec<_>| {
            let face = edge.face().fix();
            if std::mem::replace(&mut seen[face.index()], true) {
                return;
            }
            let [a, b] = edge.vertices().map(|v| v.fix().index() as u32);
            let is_border = edge.is_constraint_edge() && edges.get(&[a.min(b), a.max(b)]).is_some_and(|k| k.is_border);
            inside[face.index()] = from_inside ^ is_border;
            stack.push((face, from_inside ^ is_border));
        };
    let outer = cdt.outer_face().fix();
    // the outside is seen first, through no edge
    for edge in cdt.convex_hull() {
        let inner = if edge.face().fix() == outer { edge.rev() } else { edge };
        cross(inner, false, &mut stack);
    }
    while let Some((face, is_inside)) = stack.pop() {
        let Some(face) = cdt.face(face).as_inner() else { continue };
        for edge in face.adjacent_edges() {
            if !edge.rev().is_outer_edge() {
                cross(edge.rev(), is_inside, &mut stack);
            }
        }
    }
    inside
}
