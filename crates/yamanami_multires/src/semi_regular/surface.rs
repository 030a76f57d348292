//! The surface that shows any front of a semi-regular mesh: a base mesh with 4-to-1 splits where they are wanted.
//!
//! Based on: Lounsbery, DeRose, Warren, "Multiresolution analysis for surfaces of arbitrary topological type", 1997; Bank, Sherman,
//! Weiser, "Refinement algorithms and data structures for regular local mesh refinement", 1983 (red–green closure).
//!
//! A node is a new vertex, and has its number. It may be applied when all midpoints of the parent triangles of the triangles at its edge
//! are, so that a triangle is drawn whole, or by a template of two or three triangles, or by its four children; the mesh is a function of
//! the applied set and has no T-vertex. A vertex has one place, that of the finest level: it never moves.

use super::errors::errors_and_radii;
use super::front::{check_count, check_places, config, for_drawn, for_front, front};
use super::normals::normals;
use super::triangle::{adjacent, children, parents};
use crate::MultiresError;
use glam::DVec3;
use yamanami_core::{
    ActiveSet, Hierarchy, NodeId, NodeList, Place, SemiRegular, Sink, Sphere, Surface, SurfaceVertex, TriangleMesh,
    VertexId,
};

/// A semi-regular mesh as a multiresolution surface.
#[derive(Debug, Clone)]
pub struct SemiRegularSurface {
    mesh: SemiRegular,
    positions: Vec<DVec3>,
    normals: Vec<[f32; 3]>,
    /// One a vertex, or none.
    colours: Vec<[u8; 4]>,
    errors_m: Vec<f32>,
    bound_radii_m: Vec<f32>,
}

impl SemiRegularSurface {
    /// A surface whose vertices lie at these places (metres) and have these colours (sRGB and alpha; empty for none), in order of level.
    pub fn new(mesh: SemiRegular, positions: Vec<DVec3>, colours: Vec<[u8; 4]>) -> Result<Self, MultiresError> {
        check_places(&mesh, &positions)?;
        if !colours.is_empty() {
            check_count(&mesh, "colours", colours.len())?;
        }
        let (normals, (errors_m, bound_radii_m)) =
            rayon::join(|| normals(&mesh, &positions), || errors_and_radii(&mesh, &positions));
        Ok(Self { mesh, positions, normals, colours, errors_m, bound_radii_m })
    }

    /// The topology.
    pub fn mesh(&self) -> &SemiRegular {
        &self.mesh
    }

    /// Places of the vertices in metres, in order of level.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    fn vertex(&self, id: VertexId) -> SurfaceVertex {
        let v = id as usize;
        let (detail_m, error_m, bound_radius_m) = match self.mesh.parents(id) {
            Some([p, q]) => {
                let detail = self.positions[v] - 0.5 * (self.positions[p as usize] + self.positions[q as usize]);
                let normal = DVec3::from_array(self.normals[v].map(f64::from));
                (detail.dot(normal) as f32, self.errors_m[v], self.bound_radii_m[v])
            }
            None => (0.0, f32::INFINITY, f32::INFINITY),
        };
        let colour = self.colours.get(v).map_or([255; 3], |&[r, g, b, _]| [r, g, b]);
        SurfaceVertex {
            position: self.positions[v],
            normal: self.normals[v],
            detail_m,
            error_m,
            bound_radius_m,
            level: self.mesh.level_of(id),
            colour,
        }
    }

    /// Exchanges what is drawn around a node without and with it.
    fn replace(&self, node: NodeId, active: &dyn ActiveSet, apply: bool, sink: &mut dyn Sink) {
        for (t, role) in adjacent(&self.mesh, node) {
            let vertices = t.vertices(&self.mesh);
            let [_, _, _, h, p, q] = vertices;
            let with = config([h, p, q], active) | 1 << role;
            let without = with & !(1 << role);
            let (old, new) = if apply { (without, with) } else { (with, without) };
            for_drawn(&self.mesh, t, old, &vertices, |key, _| sink.remove_triangle(key));
            for_drawn(&self.mesh, t, new, &vertices, |key, corners| sink.add_triangle(key, corners));
        }
    }
}

impl Hierarchy for SemiRegularSurface {
    fn node_bound(&self) -> NodeId {
        self.mesh.vertex_count(self.mesh.levels())
    }

    fn exists(&self, node: NodeId) -> bool {
        (self.mesh.vertex_count(0)..self.node_bound()).contains(&node)
    }

    fn roots(&self) -> Vec<NodeId> {
        if self.mesh.levels() == 0 { Vec::new() } else { self.mesh.new_vertices(1).collect() }
    }

    fn parents(&self, node: NodeId) -> NodeList {
        parents(&self.mesh, node)
    }

    fn children(&self, node: NodeId) -> NodeList {
        children(&self.mesh, node)
    }

    #[inline]
    fn parent_count(&self, node: NodeId) -> usize {
        let [x, y] = match self.mesh.place(node) {
            Place::Face { at, .. } => at,
            _ => return self.parents(node).len(),
        };
        // as on a terrain: an edge inside a parent triangle has its three midpoints for parents, one shared by two all five
        let shared = match (x & 1, y & 1) {
            (1, 0) => y & 3 == 0,
            (0, 1) => x & 3 == 0,
            _ => (x + y) & 3 == 0,
        };
        if shared { 5 } else { 3 }
    }

    fn error_m(&self, node: NodeId) -> f32 {
        self.errors_m[node as usize]
    }

    fn bound(&self, node: NodeId) -> Sphere {
        let v = node as usize;
        Sphere { centre: self.positions[v], radius_m: f64::from(self.bound_radii_m[v]) }
    }

    #[inline]
    fn error_and_bound(&self, node: NodeId) -> (f32, Sphere) {
        (self.error_m(node), self.bound(node))
    }

    fn triangles_added(&self, node: NodeId, _active: &dyn ActiveSet) -> i32 {
        // every triangle at the edge becomes one more, whatever its other midpoints
        adjacent(&self.mesh, node).count() as i32
    }

    fn base_triangle_count(&self) -> usize {
        self.mesh.base().triangles().len()
    }

    fn level(&self, node: NodeId) -> u32 {
        self.mesh.level_of(node).saturating_sub(1)
    }
}

impl Surface for SemiRegularSurface {
    fn emit_base(&self, sink: &mut dyn Sink) {
        self.emit_front(&|_: NodeId| false, sink);
    }

    fn refine(&self, node: NodeId, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        sink.add_vertex(node, self.vertex(node));
        self.replace(node, active, true, sink);
    }

    fn coarsen(&self, node: NodeId, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        self.replace(node, active, false, sink);
        sink.remove_vertex(node);
    }

    fn emit_front(&self, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let base = self.mesh.vertex_count(0);
        for id in (0..self.node_bound()).filter(|&v| v < base || active.is_active(v)) {
            sink.add_vertex(id, self.vertex(id));
        }
        for_front(&self.mesh, active, |key, corners| sink.add_triangle(key, corners));
    }

    fn mesh_of(&self, active: &dyn ActiveSet) -> TriangleMesh {
        let (vertices, triangles) = front(&self.mesh, active);
        let positions = vertices.iter().map(|&v| self.positions[v as usize]).collect();
        let normals = vertices.iter().map(|&v| self.normals[v as usize]).collect();
        let colours = vertices.iter().filter_map(|&v| self.colours.get(v as usize).copied()).collect();
        TriangleMesh { positions, triangles, normals, colours, ..TriangleMesh::default() }
    }
}
