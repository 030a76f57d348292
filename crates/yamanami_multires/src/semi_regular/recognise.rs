//! Finding the levels of a semi-regular mesh in a plain one, whatever the order of its vertices and triangles.
//!
//! Based on: Taubin, "Detecting and reconstructing subdivision connectivity", 2002.

use super::merge::{Chain, deepest};
use crate::MultiresError;
use yamanami_core::{BaseFault, BaseMesh, SemiRegular, TriangleMesh};

/// Most levels looked for: as many as [`SemiRegular`] can have.
const MOST_LEVELS: u32 = 15;

/// A plain mesh as a semi-regular one.
#[derive(Debug, Clone)]
pub struct Recognised {
    /// Base mesh and levels. Without subdivision connectivity it has no level below the base mesh, which is the mesh given: then
    /// it must be remeshed first.
    pub mesh: SemiRegular,
    /// For each vertex, in order of level, which of the given mesh's vertices it is. Those in no triangle are left out.
    pub source_vertex: Vec<u32>,
}

/// Undoes 4-to-1 splits as often as it can be done to all connected parts of a mesh alike. Where there are several ways, as on a
/// regular torus, one that leads deepest is taken. Only the connectivity is looked at, never a place.
///
/// Fails where the mesh is not a surface that faces one way, with or without border.
pub fn recognise(mesh: &TriangleMesh) -> Result<Recognised, MultiresError> {
    let (whole, used) = surface_of(mesh)?;
    let parts = parts_of(whole);
    let chains: Vec<(Chain, Vec<u32>)> =
        parts.into_iter().map(|part| (deepest(part.mesh, MOST_LEVELS), part.vertices)).collect();
    let levels = chains.iter().map(|(chain, _)| chain.merges.len()).min().unwrap_or(0);
    let base = joined(&chains, levels).map_err(|fault| not_a_surface(fault, mesh))?;
    let semi_regular = SemiRegular::new(base, levels as u32).map_err(|fault| not_a_surface(fault, mesh))?;
    let mut order = Order { source_vertex: vec![0; used.len()], mesh: semi_regular };
    let (mut first_face, mut first_vertex) = (0, 0);
    for (chain, vertices) in &chains {
        let vertices = vertices.iter().map(|&v| used[v as usize]).collect();
        let descent = Descent::new(chain, levels, vertices);
        order.source_vertex[first_vertex..first_vertex + descent.sources[0].len()].copy_from_slice(&descent.sources[0]);
        first_vertex += descent.sources[0].len();
        let faces = descent.mesh(0).triangles().len() as u32;
        if levels > 0 {
            for face in 0..faces {
                order.put_tile(&descent, first_face + face, 0, face, [[0, 0], [1, 0], [0, 1]]);
            }
        }
        first_face += faces;
    }
    Ok(Recognised { mesh: order.mesh, source_vertex: order.source_vertex })
}

/// The base meshes of all parts, `levels` above the finest, as one.
fn joined(parts: &[(Chain, Vec<u32>)], levels: usize) -> Result<BaseMesh, BaseFault> {
    let bases: Vec<&BaseMesh> = parts.iter().map(|(chain, _)| &chain.meshes[chain.merges.len() - levels]).collect();
    if let [only] = bases[..] {
        return Ok(only.clone());
    }
    let (mut vertices, mut triangles) = (0, Vec::new());
    for base in bases {
        triangles.extend(base.triangles().iter().map(|t| t.map(|v| v + vertices)));
        vertices += base.vertex_count();
    }
    BaseMesh::new(vertices, triangles)
}

/// A mesh as a surface, without the vertices that are in no triangle; and which vertices are left.
fn surface_of(mesh: &TriangleMesh) -> Result<(BaseMesh, Vec<u32>), MultiresError> {
    let vertices = mesh.positions.len();
    let mut number = vec![u32::MAX; vertices];
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        for &vertex in corners {
            let place = number.get_mut(vertex as usize);
            *place.ok_or(MultiresError::BadCorner { triangle, vertex, vertices })? = 0;
        }
    }
    let used: Vec<u32> = (0..vertices as u32).filter(|&v| number[v as usize] == 0).collect();
    if used.is_empty() {
        return Err(MultiresError::NoTriangles { triangles: 0 });
    }
    for (new, &old) in used.iter().enumerate() {
        number[old as usize] = new as u32;
    }
    let triangles = mesh.triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
    let whole = BaseMesh::new(used.len() as u32, triangles)
        .map_err(|fault| not_a_surface(renumbered(fault, |v| used[v as usize]), mesh))?;
    Ok((whole, used))
}

/// A fault in terms of other numbers of the vertices.
pub(crate) fn renumbered(fault: BaseFault, number: impl Fn(u32) -> u32) -> BaseFault {
    match fault {
        BaseFault::BadEdge { ends } => BaseFault::BadEdge { ends: ends.map(number) },
        BaseFault::PinchedVertex { vertex } => BaseFault::PinchedVertex { vertex: number(vertex) },
        BaseFault::UnusedVertex { vertex } => BaseFault::UnusedVertex { vertex: number(vertex) },
        other => other,
    }
}

/// Says what is wrong with a mesh, and where.
pub(crate) fn not_a_surface(fault: BaseFault, mesh: &TriangleMesh) -> MultiresError {
    let at = |vertex: u32| mesh.positions.get(vertex as usize).copied().unwrap_or_default();
    let (what, place_m) = match fault {
        BaseFault::BadEdge { ends: [a, b] } => (
            format!(
                "more than two triangles, or two that face different ways, meet at the edge of vertices {a} and {b}"
            ),
            0.5 * (at(a) + at(b)),
        ),
        BaseFault::PinchedVertex { vertex } => (format!("parts touch at vertex {vertex} alone"), at(vertex)),
        BaseFault::UnusedVertex { vertex } => (format!("vertex {vertex} is in no triangle"), at(vertex)),
        BaseFault::BadTriangle { triangle } => {
            let corners = mesh.triangles.get(triangle as usize).copied().unwrap_or_default();
            (format!("triangle {triangle} has the corners {corners:?}"), at(corners[0]))
        }
        BaseFault::TooLarge => return MultiresError::TooManyTriangles { triangles: mesh.triangles.len() },
    };
    MultiresError::NotASurface { what, place_m: place_m.to_array() }
}

/// A connected part of a mesh.
struct Part {
    mesh: BaseMesh,
    /// Which vertex of the whole each one is.
    vertices: Vec<u32>,
}

fn parts_of(whole: BaseMesh) -> Vec<Part> {
    let count = whole.triangles().len();
    let mut part_of = vec![u32::MAX; count];
    let mut parts = 0;
    let mut open = Vec::new();
    for first in 0..count as u32 {
        if part_of[first as usize] != u32::MAX {
            continue;
        }
        part_of[first as usize] = parts;
        open.push(first);
        while let Some(triangle) = open.pop() {
            for (next, _) in (0..3).filter_map(|side| whole.beyond(triangle, side)) {
                if part_of[next as usize] == u32::MAX {
                    part_of[next as usize] = parts;
                    open.push(next);
                }
            }
        }
        parts += 1;
    }
    if parts == 1 {
        let vertices = (0..whole.vertex_count()).collect();
        return vec![Part { mesh: whole, vertices }];
    }
    let mut found: Vec<(Vec<[u32; 3]>, Vec<u32>)> = vec![Default::default(); parts as usize];
    let mut number = vec![u32::MAX; whole.vertex_count() as usize];
    for (corners, &part) in whole.triangles().iter().zip(&part_of) {
        let (triangles, vertices) = &mut found[part as usize];
        triangles.push(corners.map(|v| {
            let number = &mut number[v as usize];
            if *number == u32::MAX {
                *number = vertices.len() as u32;
                vertices.push(v);
            }
            *number
        }));
    }
    let made = found.into_iter().map(|(triangles, vertices)| {
        // a part of a surface is one
        let mesh = BaseMesh::new(vertices.len() as u32, triangles).ok()?;
        Some(Part { mesh, vertices })
    });
    made.flatten().collect()
}

/// The way from a part's base mesh back to its vertices as given.
struct Descent<'a> {
    chain: &'a Chain,
    /// Meshes of the chain that are coarser than the base mesh.
    skipped: usize,
    levels: usize,
    /// By level: which of the given vertices each one is.
    sources: Vec<Vec<u32>>,
}

impl<'a> Descent<'a> {
    fn new(chain: &'a Chain, levels: usize, vertices: Vec<u32>) -> Self {
        let skipped = chain.merges.len() - levels;
        let mut sources = vec![vertices];
        for merge in chain.merges[skipped..].iter().rev() {
            let finer = &sources[sources.len() - 1];
            sources.push(merge.vertices.iter().map(|&v| finer[v as usize]).collect());
        }
        sources.reverse();
        Self { chain, skipped, levels, sources }
    }

    fn mesh(&self, level: usize) -> &BaseMesh {
        &self.chain.meshes[self.skipped + level]
    }
}

/// The order of vertices being made.
struct Order {
    mesh: SemiRegular,
    source_vertex: Vec<u32>,
}

impl Order {
    /// Puts the midpoints of a level's triangle, and all below, in their places. The corners are in lattice coordinates of the level in
    /// the base triangle `face`.
    fn put_tile(&mut self, way: &Descent<'_>, face: u32, level: usize, triangle: u32, corners: [[u32; 2]; 3]) {
        let finer = way.mesh(level + 1);
        let centre = way.chain.merges[way.skipped + level].centres[triangle as usize];
        let midpoint: [[u32; 2]; 3] = std::array::from_fn(|k| {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            [from[0] + to[0], from[1] + to[1]]
        });
        for k in 0..3 {
            let vertex = self.mesh.vertex(level as u32 + 1, face, midpoint[k]);
            let found = finer.triangles()[centre as usize][(k + 1) % 3];
            self.source_vertex[vertex as usize] = way.sources[level + 1][found as usize];
        }
        if level + 1 == way.levels {
            return;
        }
        self.put_tile(way, face, level + 1, centre, [midpoint[2], midpoint[0], midpoint[1]]);
        for k in 0..3 {
            let Some((corner, side)) = finer.beyond(centre, k as u8) else { continue };
            let mut at = [midpoint[k], midpoint[(k + 2) % 3], corners[k].map(|c| 2 * c)];
            at.rotate_right(usize::from(side));
            self.put_tile(way, face, level + 1, corner, at);
        }
    }
}
