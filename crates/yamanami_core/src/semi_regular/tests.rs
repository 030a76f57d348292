//! Numbers, places, parents and rings agree with each other and with meshes split one triangle at a time.

use super::*;
use std::collections::{BTreeMap, BTreeSet};

fn octahedron() -> BaseMesh {
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    BaseMesh::new(6, faces.to_vec()).unwrap()
}

fn square() -> BaseMesh {
    BaseMesh::new(4, vec![[0, 1, 2], [1, 3, 2]]).unwrap()
}

fn strip_of_three() -> BaseMesh {
    // side 1 of the first meets side 2 of the second, turned; a lone triangle beside
    BaseMesh::new(8, vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [5, 6, 7]]).unwrap()
}

fn all() -> [SemiRegular; 3] {
    [octahedron(), square(), strip_of_three()].map(|base| SemiRegular::new(base, 4).unwrap())
}

#[test]
fn each_level_splits_the_one_below() {
    for mesh in all() {
        for level in 1..=mesh.levels() {
            let midpoint: BTreeMap<[u32; 2], u32> = mesh
                .new_vertices(level)
                .map(|v| {
                    let [p, q] = mesh.parents(v).unwrap();
                    ([p.min(q), p.max(q)], v)
                })
                .collect();
            assert_eq!(midpoint.len(), mesh.new_vertices(level).len());
            let mut split = BTreeSet::new();
            for [a, b, c] in mesh.triangles(level - 1) {
                let middle = |p: u32, q: u32| midpoint[&[p.min(q), p.max(q)]];
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                split.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(least_first));
            }
            let found: BTreeSet<[u32; 3]> = mesh.triangles(level).into_iter().map(least_first).collect();
            assert_eq!(found, split);
            assert_eq!(found.len(), mesh.triangle_count(level) as usize);
        }
    }
}

fn least_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[test]
fn places_lead_back_to_their_vertices() {
    for mesh in all() {
        for level in 0..=mesh.levels() {
            for v in mesh.new_vertices(level) {
                assert_eq!(mesh.level_of(v), level);
                match mesh.place(v) {
                    Place::Base => assert_eq!(level, 0),
                    Place::Edge { edge, at } => assert_eq!(mesh.edge_vertex(level, edge, at), v),
                    Place::Face { face, at } => assert_eq!(mesh.vertex(level, face, at), v),
                }
            }
        }
    }
}

#[test]
fn rings_are_those_of_the_triangles() {
    for mesh in all() {
        for level in 0..=mesh.levels() {
            let mut next: BTreeMap<(u32, u32), u32> = BTreeMap::new();
            for [a, b, c] in mesh.triangles(level) {
                next.extend([((a, b), c), ((b, c), a), ((c, a), b)]);
            }
            let mut ring = Vec::new();
            for v in 0..mesh.vertex_count(level) {
                let is_closed = mesh.ring(level, v, &mut ring);
                let steps = if is_closed { ring.len() } else { ring.len() - 1 };
                for k in 0..steps {
                    assert_eq!(
                        next.get(&(v, ring[k])),
                        Some(&ring[(k + 1) % ring.len()]),
                        "vertex {v} at level {level}"
                    );
                }
                assert_eq!(next.keys().filter(|key| key.0 == v).count(), steps);
            }
        }
    }
}

#[test]
fn what_is_no_surface_is_no_base_mesh() {
    let fault = |vertices: u32, triangles: &[[u32; 3]]| BaseMesh::new(vertices, triangles.to_vec()).unwrap_err();
    assert_eq!(fault(3, &[[0, 1, 3]]), BaseFault::BadTriangle { triangle: 0 });
    assert_eq!(fault(3, &[[0, 1, 1]]), BaseFault::BadTriangle { triangle: 0 });
    assert_eq!(fault(4, &[[0, 1, 2]]), BaseFault::UnusedVertex { vertex: 3 });
    assert_eq!(fault(4, &[[0, 1, 2], [0, 1, 3]]), BaseFault::BadEdge { ends: [0, 1] });
    assert_eq!(fault(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]), BaseFault::BadEdge { ends: [0, 1] });
    assert_eq!(fault(5, &[[0, 1, 2], [0, 3, 4]]), BaseFault::PinchedVertex { vertex: 0 });
    assert_eq!(SemiRegular::new(octahedron(), 16), Err(BaseFault::TooLarge));
    assert_eq!(SemiRegular::new(octahedron(), 15), Err(BaseFault::TooLarge));
    assert!(SemiRegular::new(octahedron(), 13).is_ok());
}
