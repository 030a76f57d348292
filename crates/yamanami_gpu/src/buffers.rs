//! The resident mesh without a GPU: vertex and index data in slots, and which slots changed.
//!
//! Triangles stay packed so that one indexed draw shows all: a triangle that goes leaves a hole, the next one that
//! comes fills it, and what holes are left at an upload are filled from the end. Vertices keep their slot for life;
//! free slots are used again. So what is written is proportional to what changed, whatever the size of the mesh.

use crate::dirty::DirtySlots;
use crate::normals::vertex_normals;
use crate::vertex::{GpuVertex, TRIANGLE_BYTES, VERTEX_BYTES};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;
use std::ops::Range;
use yamanami_core::{Aabb, MeshMirror, Sink, SurfaceVertex, TriangleKey, TriangleMesh, VertexId};

/// The indices of a hole: a triangle without area.
const HOLE: [u32; 3] = [0; 3];

/// A front's vertices and triangles as the GPU holds them, kept in memory with the ranges still to be uploaded.
#[derive(Debug, Clone)]
pub struct ResidentBuffers {
    origin: DVec3,
    vertices: Vec<GpuVertex>,
    vertex_slots: FxHashMap<VertexId, u32>,
    free_vertices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    keys: Vec<TriangleKey>,
    triangle_slots: FxHashMap<TriangleKey, u32>,
    /// Ids and keys are slot numbers, and the maps and keys are empty: a whole mesh that has not changed yet.
    is_whole: bool,
    holes: Vec<u32>,
    dirty_vertices: DirtySlots,
    dirty_triangles: DirtySlots,
    bounds: Aabb,
}

/// What changed since the last upload, as slot ranges in ascending order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DirtyRanges {
    /// Ranges of vertex slots.
    pub vertices: Vec<Range<u32>>,
    /// Ranges of triangle slots (three indices each).
    pub triangles: Vec<Range<u32>>,
}

/// A mesh by content, whatever its slots: for comparing a resident mesh with the reference mirror.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshContents {
    /// Vertices by id.
    pub vertices: BTreeMap<VertexId, GpuVertex>,
    /// Corners by key.
    pub triangles: BTreeMap<TriangleKey, [VertexId; 3]>,
}

impl DirtyRanges {
    /// Bytes of the vertex ranges.
    pub fn vertex_bytes(&self) -> u64 {
        self.vertices.iter().map(|r| u64::from(r.end - r.start) * VERTEX_BYTES).sum()
    }

    /// Bytes of the triangle ranges.
    pub fn index_bytes(&self) -> u64 {
        self.triangles.iter().map(|r| u64::from(r.end - r.start) * TRIANGLE_BYTES).sum()
    }
}

impl MeshContents {
    /// What a resident mesh with this origin holds when it equals the mirror.
    pub fn of_mirror(mirror: &MeshMirror, origin: DVec3) -> Self {
        Self {
            vertices: mirror.vertices.iter().map(|(&id, v)| (id, GpuVertex::pack(v, origin))).collect(),
            triangles: mirror.triangles.clone(),
        }
    }
}

impl ResidentBuffers {
    /// An empty mesh whose positions are kept relative to `origin` (metres, in the local metric frame).
    pub fn new(origin: DVec3) -> Self {
        Self {
            origin,
            vertices: Vec::new(),
            vertex_slots: FxHashMap::default(),
            free_vertices: Vec::new(),
            triangles: Vec::new(),
            keys: Vec::new(),
            triangle_slots: FxHashMap::default(),
            is_whole: false,
            holes: Vec::new(),
            dirty_vertices: DirtySlots::default(),
            dirty_triangles: DirtySlots::default(),
            bounds: Aabb::EMPTY,
        }
    }

    /// A whole mesh, its origin in the middle of its box. Absent normals are worked out from the triangles, absent colours
    /// are white; triangles with a corner that does not exist are left out. Until something changes, no tables of ids
    /// and keys are kept, so that meshes of millions of triangles are taken over quickly.
    pub fn from_mesh(mesh: &TriangleMesh) -> Self {
        let bounds = mesh.bounds();
        let origin = if bounds.min.is_finite() && bounds.max.is_finite() { bounds.centre() } else { DVec3::ZERO };
        let computed;
        let normals = if mesh.normals.len() == mesh.positions.len() {
            &mesh.normals
        } else {
            computed = vertex_normals(mesh);
            &computed
        };
        let pack = |(id, (&position, &normal)): (usize, (&DVec3, &[f32; 3]))| {
            let colour = mesh.colours.get(id).map_or([255; 3], |&[r, g, b, _]| [r, g, b]);
            let vertex = SurfaceVertex {
                position,
                normal,
                detail_m: 0.0,
                error_m: f32::INFINITY,
                bound_radius_m: 0.0,
                level: 0,
                colour,
            };
            GpuVertex::pack(&vertex, origin)
        };
        let has_corners = |corners: &&[u32; 3]| corners.iter().all(|&c| (c as usize) < mesh.positions.len());
        let mut buffers = Self {
            vertices: mesh.positions.par_iter().zip(normals).enumerate().map(pack).collect(),
            triangles: mesh.triangles.iter().filter(has_corners).copied().collect(),
            bounds: Aabb { min: bounds.min - origin, max: bounds.max - origin },
            is_whole: true,
            ..Self::new(origin)
        };
        buffers.mark_all();
        buffers
    }

    /// Builds the tables that changes need.
    fn part(&mut self) {
        if self.is_whole {
            self.is_whole = false;
            self.keys = (0..self.triangles.len() as u64).collect();
            self.vertex_slots = (0..self.vertices.len() as u32).map(|slot| (slot, slot)).collect();
            self.triangle_slots = self.keys.iter().map(|&key| (key, key as u32)).collect();
        }
    }

    /// The point that positions are relative to.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// A box around every vertex since the mesh was last empty, relative to the origin.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Number of triangles shown.
    pub fn triangle_count(&self) -> usize {
        if self.is_whole { self.triangles.len() } else { self.triangle_slots.len() }
    }

    /// Number of vertices held.
    pub fn vertex_count(&self) -> usize {
        if self.is_whole { self.vertices.len() } else { self.vertex_slots.len() }
    }

    /// Vertex slots. Those of no vertex hold old data and are used by no triangle.
    pub fn vertices(&self) -> &[GpuVertex] {
        &self.vertices
    }

    /// Corner slots of the triangles. Until [`Self::compact`] some may be holes: triangles without area.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Removes everything but keeps the memory.
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.vertex_slots.clear();
        self.free_vertices.clear();
        self.triangles.clear();
        self.keys.clear();
        self.triangle_slots.clear();
        self.is_whole = false;
        self.holes.clear();
        self.dirty_vertices.clear();
        self.dirty_triangles.clear();
        self.bounds = Aabb::EMPTY;
    }

    /// Fills the holes with triangles from the end, so that all slots are triangles.
    pub fn compact(&mut self) {
        self.holes.sort_unstable_by(|a, b| b.cmp(a));
        // From the last hole to the first, so that the last slot is never a hole that is yet to be filled.
        for hole in self.holes.drain(..) {
            let slot = hole as usize;
            self.triangles.swap_remove(slot);
            self.keys.swap_remove(slot);
            if let Some(&key) = self.keys.get(slot) {
                self.triangle_slots.insert(key, hole);
                self.dirty_triangles.mark(hole);
            }
        }
    }

    /// Compacts, and takes the ranges that changed since this was last called. Ranges at most `gap_bytes` apart become
    /// one, where copying the gap costs less than another write.
    pub fn take_dirty(&mut self, gap_bytes: u64) -> DirtyRanges {
        self.compact();
        let (vertices, triangles) = (self.vertices.len() as u32, self.triangles.len() as u32);
        let gap = |slot_bytes: u64| u32::try_from(gap_bytes / slot_bytes).unwrap_or(u32::MAX);
        DirtyRanges {
            vertices: self.dirty_vertices.take_ranges(vertices, gap(VERTEX_BYTES)),
            triangles: self.dirty_triangles.take_ranges(triangles, gap(TRIANGLE_BYTES)),
        }
    }

    /// Marks every slot as changed, so that the next upload is a whole one.
    pub fn mark_all(&mut self) {
        self.dirty_vertices.mark_all(self.vertices.len() as u32);
        self.dirty_triangles.mark_all(self.triangles.len() as u32);
    }

    /// The mesh by content.
    pub fn contents(&self) -> MeshContents {
        self.contents_of(&self.vertices, &self.triangles)
    }

    /// The content that these slots hold when they are read by this mesh's slot numbers.
    pub(crate) fn contents_of(&self, vertices: &[GpuVertex], triangles: &[[u32; 3]]) -> MeshContents {
        if self.is_whole {
            let mut parted = self.clone();
            parted.part();
            return parted.contents_of(vertices, triangles);
        }
        let ids: FxHashMap<u32, VertexId> = self.vertex_slots.iter().map(|(&id, &slot)| (slot, id)).collect();
        let corners =
            |slot: u32| triangles.get(slot as usize)?.iter().map(|c| ids.get(c).copied()).collect::<Option<Vec<_>>>();
        MeshContents {
            vertices: self
                .vertex_slots
                .iter()
                .filter_map(|(&id, &slot)| Some((id, *vertices.get(slot as usize)?)))
                .collect(),
            triangles: self
                .triangle_slots
                .iter()
                .filter_map(|(&key, &slot)| Some((key, corners(slot)?.try_into().ok()?)))
                .collect(),
        }
    }

    fn store(&mut self, slot: u32, vertex: &SurfaceVertex) {
        let packed = GpuVertex::pack(vertex, self.origin);
        if self.vertices[slot as usize] != packed {
            self.vertices[slot as usize] = packed;
            self.dirty_vertices.mark(slot);
        }
    }
}

impl Sink for ResidentBuffers {
    fn add_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        self.part();
        let slot = self.free_vertices.pop().unwrap_or_else(|| {
            self.vertices.push(GpuVertex::default());
            let slot = self.vertices.len() as u32 - 1;
            self.dirty_vertices.mark(slot);
            slot
        });
        self.store(slot, &vertex);
        self.bounds.include(vertex.position - self.origin);
        let old = self.vertex_slots.insert(id, slot);
        debug_assert!(old.is_none(), "vertex {id} added twice");
    }

    fn update_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        self.part();
        let slot = self.vertex_slots.get(&id).copied();
        debug_assert!(slot.is_some(), "vertex {id} updated while absent");
        if let Some(slot) = slot {
            self.store(slot, &vertex);
        }
    }

    fn remove_vertex(&mut self, id: VertexId) {
        self.part();
        let slot = self.vertex_slots.remove(&id);
        debug_assert!(slot.is_some(), "vertex {id} removed while absent");
        self.free_vertices.extend(slot);
    }

    fn add_triangle(&mut self, key: TriangleKey, corners: [VertexId; 3]) {
        self.part();
        let slots = corners.map(|id| self.vertex_slots.get(&id).copied());
        let [Some(a), Some(b), Some(c)] = slots else {
            debug_assert!(false, "triangle {key} uses an absent vertex");
            return;
        };
        let slot = match self.holes.pop() {
            Some(hole) => {
                self.triangles[hole as usize] = [a, b, c];
                self.keys[hole as usize] = key;
                hole
            }
            None => {
                self.triangles.push([a, b, c]);
                self.keys.push(key);
                self.triangles.len() as u32 - 1
            }
        };
        self.dirty_triangles.mark(slot);
        let old = self.triangle_slots.insert(key, slot);
        debug_assert!(old.is_none(), "triangle {key} added twice");
    }

    fn remove_triangle(&mut self, key: TriangleKey) {
        self.part();
        let slot = self.triangle_slots.remove(&key);
        debug_assert!(slot.is_some(), "triangle {key} removed while absent");
        if let Some(slot) = slot {
            self.triangles[slot as usize] = HOLE;
            self.holes.push(slot);
        }
    }
}
