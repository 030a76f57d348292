//! Faces that cover each other in plan.
//!
//! Two triangles have no area in common exactly when a side of one has the other beyond it or on it (the separating axis
//! theorem in the plane, after Gottschalk, Lin, Manocha, "OBBTree", 1996); which side a corner is on is exact, after
//! Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997.

use super::tree::{Rect, Tree};
use super::{Faces, Fault, plan, touch_m};
use glam::DVec3;
use rayon::prelude::*;
use robust::orient2d;

/// Drops each face that covers a part of an earlier one that stays.
pub(super) fn drop_overlaps(faces: &mut Faces<'_>) {
    let (positions, triangles) = (&faces.mesh.positions, &faces.mesh.triangles);
    let touch_m = touch_m(faces.mesh);
    let rect = |t: &[u32; 3]| Rect::around(&t.map(|v| positions[v as usize]));
    let alive: Vec<u32> = (0..triangles.len() as u32).filter(|&f| faces.alive[f as usize]).collect();
    let rects: Vec<Rect> = alive.par_iter().map(|&f| rect(&triangles[f as usize])).collect();
    let tree = Tree::new(rects);
    let covers = |place: u32, earlier: u32| {
        let [a, b] = [place, earlier].map(|place| triangles[alive[place as usize] as usize]);
        have_common_area(positions, a, b, touch_m)
    };
    // most faces cover none: those that do are looked at again, one after the other
    let mut suspects: Vec<u32> = tree
        .order()
        .par_iter()
        .filter(|&&face| tree.any(&tree.rect(face).shrunk(), |other| other < face && covers(face, other)))
        .copied()
        .collect();
    suspects.sort_unstable();
    let mut is_dropped = vec![false; alive.len()];
    let mut dropped = Vec::new();
    for face in suspects {
        if tree
            .any(&tree.rect(face).shrunk(), |other| other < face && !is_dropped[other as usize] && covers(face, other))
        {
            is_dropped[face as usize] = true;
            dropped.push(alive[face as usize]);
        }
    }
    faces.drop(Fault::Overlap, &dropped);
}

/// Whether two counter-clockwise triangles have an area in common in plan that reaches further than `touch_m` into both.
fn have_common_area(positions: &[DVec3], a: [u32; 3], b: [u32; 3], touch_m: f64) -> bool {
    let has_beyond = |a: [u32; 3], b: [u32; 3]| {
        (0..3).any(|k| {
            let [from, to] = [a[k], a[(k + 1) % 3]];
            // the neighbour at this side lies beyond it
            let is_neighbour = (0..3).any(|k| b[k] == to && b[(k + 1) % 3] == from);
            let side = (positions[to as usize] - positions[from as usize]).truncate();
            let hair = touch_m * side.length();
            is_neighbour
                || b.iter().all(|&v| {
                    let at = |v: u32| plan(positions[v as usize]);
                    v == from || v == to || orient2d(at(from), at(to), at(v)) <= hair
                })
        })
    };
    !has_beyond(a, b) && !has_beyond(b, a)
}
