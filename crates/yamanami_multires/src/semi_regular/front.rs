//! Fronts of a semi-regular mesh: how triangles are drawn for a set of applied nodes, and the mesh of a set of kept details.

use super::triangle::{CHILD_CORNERS, Triangle, parents};
use crate::MultiresError;
use crate::wavelet::{ALL, Config, TEMPLATES};
use glam::DVec3;
use yamanami_core::{ActiveSet, SemiRegular, TriangleKey, TriangleMesh};

/// Largest coordinate of a place: with it, no distance is beyond `f32`.
const LARGEST_M: f64 = 1e30;

/// One place or so a vertex, all of them somewhere.
pub(super) fn check_places(mesh: &SemiRegular, places_m: &[DVec3]) -> Result<(), MultiresError> {
    check_count(mesh, "places", places_m.len())?;
    let somewhere = places_m.iter().filter(|p| p.abs().max_element() <= LARGEST_M && !p.is_nan()).count();
    check_count(mesh, "places within ±1e30 m", somewhere)
}

/// As many as vertices.
pub(super) fn check_count(mesh: &SemiRegular, what: &'static str, given: usize) -> Result<(), MultiresError> {
    let vertices = mesh.vertex_count(mesh.levels()) as usize;
    if given == vertices { Ok(()) } else { Err(MultiresError::BadVertices { what, vertices, given }) }
}

/// Which midpoints h, p, q of a triangle are applied; with all, it is drawn as its four children.
pub(super) fn config(midpoints: [u32; 3], active: &dyn ActiveSet) -> Config {
    let [h, p, q] = midpoints.map(|m| Config::from(active.is_active(m)));
    h | p << 1 | q << 2
}

/// Key of the first triangle that draws `t`; a template's others follow.
fn key(mesh: &SemiRegular, t: Triangle) -> TriangleKey {
    let faces = mesh.base().triangles().len() as u64;
    let coarser = faces * (((1u64 << (2 * t.level)) - 1) / 3);
    4 * (coarser + (u64::from(t.face) << (2 * t.level)) + u64::from(t.index()))
}

/// Key and corners of each triangle that draws `t` with the vertices R, P, Q, h, p, q.
pub(super) fn for_drawn(
    mesh: &SemiRegular,
    t: Triangle,
    config: Config,
    vertices: &[u32; 6],
    mut found: impl FnMut(TriangleKey, [u32; 3]),
) {
    let corners = |roles: [usize; 3]| roles.map(|role| vertices[role]);
    if config == ALL {
        for (child, roles) in t.children().into_iter().zip(CHILD_CORNERS[usize::from(t.half)]) {
            found(key(mesh, child), corners(roles));
        }
    } else {
        for (key, &roles) in (key(mesh, t)..).zip(TEMPLATES[config]) {
            found(key, corners(roles));
        }
    }
}

/// Key and corners of each triangle of a front, base triangle by base triangle.
pub(super) fn for_front(mesh: &SemiRegular, active: &dyn ActiveSet, mut found: impl FnMut(TriangleKey, [u32; 3])) {
    let mut open = Vec::new();
    for face in 0..mesh.base().triangles().len() as u32 {
        open.push(Triangle::base(face));
        while let Some(t) = open.pop() {
            let is_last = t.level == mesh.levels();
            match if is_last { 0 } else { config(t.midpoints(mesh), active) } {
                0 => found(key(mesh, t), t.corners(mesh)),
                ALL => open.extend(t.children()),
                config => for_drawn(mesh, t, config, &t.vertices(mesh), &mut found),
            }
        }
    }
}

/// The vertices of a front, in order, and its triangles by places in that order.
pub(super) fn front(mesh: &SemiRegular, active: &dyn ActiveSet) -> (Vec<u32>, Vec<[u32; 3]>) {
    let base = mesh.vertex_count(0);
    let vertices: Vec<u32> =
        (0..mesh.vertex_count(mesh.levels())).filter(|&v| v < base || active.is_active(v)).collect();
    let mut place = vec![0; mesh.vertex_count(mesh.levels()) as usize];
    for (new, &vertex) in (0..).zip(&vertices) {
        place[vertex as usize] = new;
    }
    let mut triangles = Vec::new();
    for_front(mesh, active, |_, corners| triangles.push(corners.map(|v| place[v as usize])));
    (vertices, triangles)
}

/// Adds to a set of kept details, by vertex, all that they need for a front: the midpoints of their parent triangles, those of these,
/// and so on. Vertices of the base mesh are always kept.
pub fn close(mesh: &SemiRegular, kept: &mut [bool]) -> Result<(), MultiresError> {
    check_count(mesh, "marks", kept.len())?;
    let base = mesh.vertex_count(0);
    for node in (base..mesh.vertex_count(mesh.levels())).rev() {
        if kept[node as usize] {
            parents(mesh, node).iter().for_each(|&parent| kept[parent as usize] = true);
        }
    }
    kept[..base as usize].fill(true);
    Ok(())
}

/// The mesh of a set of kept details.
#[derive(Debug, Clone, PartialEq)]
pub struct Thresholded {
    /// Places and triangles.
    pub mesh: TriangleMesh,
    /// Which vertex of the semi-regular mesh each one is, in order.
    pub vertices: Vec<u32>,
}

/// The mesh of the least front that has all kept details (by vertex; see [`close`]): no crack, no T-vertex, the base mesh's border.
/// Its vertices lie where `places_m` (by vertex, metres) says: as synthesised with the other details zero, or as they are.
pub fn thresholded(mesh: &SemiRegular, kept: &[bool], places_m: &[DVec3]) -> Result<Thresholded, MultiresError> {
    check_places(mesh, places_m)?;
    let mut closed = kept.to_vec();
    close(mesh, &mut closed)?;
    let (vertices, triangles) = front(mesh, &|node: u32| closed[node as usize]);
    let positions = vertices.iter().map(|&v| places_m[v as usize]).collect();
    Ok(Thresholded { mesh: TriangleMesh::new(positions, triangles), vertices })
}
