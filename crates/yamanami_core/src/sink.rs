//! Where a front goes as it changes: the reference mirror here, the GPU's resident mesh elsewhere.

use crate::TriangleMesh;
use glam::DVec3;
use std::collections::BTreeMap;

/// Number of a vertex, chosen by the surface; stable for one position of one surface.
pub type VertexId = u32;

/// Number of a triangle, chosen by the surface; unique among the triangles of a front.
pub type TriangleKey = u64;

/// What is stored for a vertex of a front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceVertex {
    /// Position in metres, in the local metric frame.
    pub position: DVec3,
    /// Unit normal.
    pub normal: [f32; 3],
    /// How far this vertex lies above the place it would have were its node not applied: the lazy wavelet's detail
    /// coefficient. Zero for base vertices. Geomorphing fades it in.
    pub detail_m: f32,
    /// Error of the vertex's node ([`crate::Hierarchy::error_m`]); infinite for base vertices.
    pub error_m: f32,
    /// Radius of the node's bound in metres.
    pub bound_radius_m: f32,
    /// Depth of the node, 0 for base vertices.
    pub level: u32,
    /// Colour (sRGB); white where the source has none.
    pub colour: [u8; 3],
}

/// Receives the vertices and triangles of a front as they come and go.
///
/// The surface promises: a vertex is added before a triangle that uses it and removed after the last one; keys and
/// ids are added once and removed once.
pub trait Sink {
    /// A vertex appears.
    fn add_vertex(&mut self, id: VertexId, vertex: SurfaceVertex);
    /// A vertex changes its attributes (never its position).
    fn update_vertex(&mut self, id: VertexId, vertex: SurfaceVertex);
    /// A vertex disappears.
    fn remove_vertex(&mut self, id: VertexId);
    /// A triangle appears, counter-clockwise from outside.
    fn add_triangle(&mut self, key: TriangleKey, corners: [VertexId; 3]);
    /// A triangle disappears.
    fn remove_triangle(&mut self, key: TriangleKey);
}

/// The reference sink: plain ordered maps, compared by content.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshMirror {
    /// All vertices by id.
    pub vertices: BTreeMap<VertexId, SurfaceVertex>,
    /// All triangles by key.
    pub triangles: BTreeMap<TriangleKey, [VertexId; 3]>,
}

impl MeshMirror {
    /// The mirrored front as a mesh, vertices by id, triangles by key.
    pub fn to_mesh(&self) -> TriangleMesh {
        let index: BTreeMap<VertexId, u32> = (0u32..).zip(self.vertices.keys()).map(|(i, &id)| (id, i)).collect();
        TriangleMesh {
            positions: self.vertices.values().map(|v| v.position).collect(),
            triangles: self.triangles.values().map(|t| t.map(|id| index[&id])).collect(),
            normals: self.vertices.values().map(|v| v.normal).collect(),
            ..TriangleMesh::default()
        }
    }
}

impl Sink for MeshMirror {
    fn add_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        let old = self.vertices.insert(id, vertex);
        assert!(old.is_none(), "vertex {id} added twice");
    }

    fn update_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        let old = self.vertices.insert(id, vertex);
        assert!(old.is_some_and(|v| v.position == vertex.position), "vertex {id} updated while absent, or moved");
    }

    fn remove_vertex(&mut self, id: VertexId) {
        assert!(self.vertices.remove(&id).is_some(), "vertex {id} removed while absent");
    }

    fn add_triangle(&mut self, key: TriangleKey, corners: [VertexId; 3]) {
        for id in corners {
            assert!(self.vertices.contains_key(&id), "triangle {key} uses the absent vertex {id}");
        }
        assert!(self.triangles.insert(key, corners).is_none(), "triangle {key} added twice");
    }

    fn remove_triangle(&mut self, key: TriangleKey) {
        assert!(self.triangles.remove(&key).is_some(), "triangle {key} removed while absent");
    }
}
