//! Undoing 4-to-1 splits: a mesh is tiled by fours of triangles, each a centre and its three neighbours, and each tile becomes
//! one triangle; again and again, as deep as it goes.
//!
//! Based on: Taubin, "Detecting and reconstructing subdivision connectivity", 2002. Where we differ: one triangle's role in the tiling
//! settles that of all others, so that at most four tilings are tried, and only one where some vertex is not regular.

use yamanami_core::BaseMesh;

/// How the triangles of a connected mesh are merged.
#[derive(Debug)]
pub(super) struct Merge {
    /// The triangle of the finer mesh in the middle of each triangle of the coarser one. Beyond its side k lies corner k.
    pub(super) centres: Vec<u32>,
    /// The vertex of the finer mesh that each vertex of the coarser one is.
    pub(super) vertices: Vec<u32>,
}

/// A connected mesh and the coarser ones that it comes from.
#[derive(Debug)]
pub(super) struct Chain {
    /// From the coarsest to the mesh itself.
    pub(super) meshes: Vec<BaseMesh>,
    /// Between each mesh and the next finer one.
    pub(super) merges: Vec<Merge>,
}

/// Merges a connected mesh so often as it can be, at most `most` times.
pub(super) fn deepest(fine: BaseMesh, most: u32) -> Chain {
    let mut best = Chain { meshes: Vec::new(), merges: Vec::new() };
    let possible = (fine.triangles().len().trailing_zeros() / 2).min(most) as usize;
    if possible > 0 {
        for centre in candidates(&fine) {
            let Some((coarse, merge)) = merge(&fine, centre) else { continue };
            let mut chain = deepest(coarse, most - 1);
            chain.merges.push(merge);
            if chain.merges.len() > best.merges.len() {
                best = chain;
            }
            if best.merges.len() == possible {
                break;
            }
        }
    }
    best.meshes.push(fine);
    best
}

/// Triangles of which one must be a centre if the mesh can be tiled.
fn candidates(mesh: &BaseMesh) -> Vec<u32> {
    let opposite = |(triangle, corner): (u32, u8)| mesh.beyond(triangle, (corner + 1) % 3).map(|(centre, _)| centre);
    // a vertex that cannot be a midpoint is the corner of a tile
    if let Some(vertex) = (0..mesh.vertex_count()).find(|&v| !may_be_midpoint(mesh, v)) {
        return opposite(mesh.fan(vertex)[0]).into_iter().collect();
    }
    (0..3).filter_map(|corner| opposite((0, corner))).chain([0]).collect()
}

fn may_be_midpoint(mesh: &BaseMesh, vertex: u32) -> bool {
    mesh.fan(vertex).len() == if mesh.is_on_border(vertex) { 3 } else { 6 }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Unknown,
    Centre,
    /// With the coarse vertex at this corner.
    Corner(u8),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Unknown,
    Coarse,
    Midpoint,
}

/// Sets what was not known; whether it now is as wanted.
fn settle<T: PartialEq + Copy>(place: &mut T, unknown: T, wanted: T) -> bool {
    if *place == unknown {
        *place = wanted;
    }
    *place == wanted
}

/// Merges by the tiling that has this triangle as a centre; none if there is no such tiling.
fn merge(fine: &BaseMesh, centre: u32) -> Option<(BaseMesh, Merge)> {
    let mut roles = vec![Role::Unknown; fine.triangles().len()];
    let mut kinds = vec![Kind::Unknown; fine.vertex_count() as usize];
    let mut centres = Vec::with_capacity(roles.len() / 4);
    let mut corners_of = Vec::with_capacity(roles.len() / 4);
    let mut halves_on_border = 0;
    roles[centre as usize] = Role::Centre;
    let mut open = vec![centre];
    while let Some(centre) = open.pop() {
        let mut corners = [0; 3];
        for k in 0..3u8 {
            let midpoint = fine.triangles()[centre as usize][usize::from(k)];
            let kind = &mut kinds[midpoint as usize];
            if *kind == Kind::Unknown && !may_be_midpoint(fine, midpoint)
                || !settle(kind, Kind::Unknown, Kind::Midpoint)
            {
                return None;
            }
            let (corner, side) = fine.beyond(centre, k)?;
            let apex = (side + 2) % 3;
            let vertex = fine.triangles()[corner as usize][usize::from(apex)];
            if !settle(&mut roles[corner as usize], Role::Unknown, Role::Corner(apex))
                || !settle(&mut kinds[vertex as usize], Kind::Unknown, Kind::Coarse)
            {
                return None;
            }
            corners[usize::from(k)] = vertex;
            // across both sides at the coarse vertex lie corners of the tiles beyond
            for (side, turn) in [(apex, 1), ((apex + 2) % 3, 0)] {
                let Some((beyond, side)) = fine.beyond(corner, side) else {
                    halves_on_border += 1;
                    continue;
                };
                let (next, _) = fine.beyond(beyond, (side + turn + 1) % 3)?;
                if roles[next as usize] == Role::Unknown {
                    open.push(next);
                }
                if !settle(&mut roles[next as usize], Role::Unknown, Role::Centre) {
                    return None;
                }
            }
        }
        centres.push(centre);
        corners_of.push(corners);
    }
    if 4 * centres.len() != roles.len() {
        return None;
    }
    let mut number = vec![0; kinds.len()];
    let mut vertices = Vec::new();
    for (vertex, _) in (0u32..).zip(&kinds).filter(|(_, kind)| **kind == Kind::Coarse) {
        number[vertex as usize] = vertices.len() as u32;
        vertices.push(vertex);
    }
    let triangles = corners_of.iter().map(|t| t.map(|v| number[v as usize])).collect();
    // two edges between the same ends, as on a small torus, are beyond a base mesh; on the border it would take them for one
    let coarse = BaseMesh::new(vertices.len() as u32, triangles).ok()?;
    let on_border = coarse.edges().iter().filter(|edge| edge.right.is_none()).count();
    (2 * on_border == halves_on_border).then_some((coarse, Merge { centres, vertices }))
}
