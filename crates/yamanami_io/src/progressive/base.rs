//! The base mesh of a progressive file: its triangles in an order in which each is glued to those before it.

use crate::store::connectivity;
use yamanami_core::{BaseMesh, SemiRegular};

/// A semi-regular mesh under the numbers that its file gives it.
#[derive(Debug, Clone)]
pub struct Renumbered {
    /// The mesh: the same surface.
    pub mesh: SemiRegular,
    /// By new vertex: its number in the old mesh.
    pub old_vertices: Vec<u32>,
}

/// Renumbers a mesh so that its base mesh takes few bytes; a mesh that has these numbers keeps them.
pub fn renumber(mesh: &SemiRegular) -> Renumbered {
    let order = connectivity::in_order(mesh.base().vertex_count(), mesh.base().triangles());
    let mut new_number = vec![0; order.vertices.len()];
    for (new, &old) in order.vertices.iter().enumerate() {
        new_number[old as usize] = new as u32;
    }
    let triangles = order.triangles.iter().map(|&(_, corners)| corners.map(|v| new_number[v as usize])).collect();
    let same = "the same triangles under other numbers are as much a surface";
    let base = BaseMesh::new(mesh.base().vertex_count(), triangles).expect(same);
    let new = SemiRegular::new(base, mesh.levels()).expect(same);
    let level = mesh.levels();
    let size = 1u32 << level;
    let mut old_vertices = vec![0; mesh.vertex_count(level) as usize];
    for (face, &(old_face, corners)) in order.triangles.iter().enumerate() {
        let old_corners = mesh.base().triangles()[old_face as usize];
        // the new first corner is the old one of this number
        let turn = (0..3).find(|&k| old_corners[k] == corners[0]).unwrap_or(0);
        for b in 0..=size {
            for a in 0..=size - b {
                // lattice coordinates are the weights of corners 1 and 2
                let weights = [size - a - b, a, b];
                let old = [1, 2].map(|k: usize| weights[(k + 3 - turn) % 3]);
                old_vertices[new.vertex(level, face as u32, [a, b]) as usize] = mesh.vertex(level, old_face, old);
            }
        }
    }
    Renumbered { mesh: new, old_vertices }
}
