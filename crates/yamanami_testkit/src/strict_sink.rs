//! A mirror that holds the surface to every promise of [`Sink`].

use std::collections::BTreeMap;
use yamanami_core::{MeshMirror, Sink, SurfaceVertex, TriangleKey, VertexId};

/// [`MeshMirror`], and beside it the number of triangles at each vertex, so that a vertex taken from under a triangle is
/// caught at once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StrictSink {
    /// What was received.
    pub mirror: MeshMirror,
    uses: BTreeMap<VertexId, u32>,
}

impl StrictSink {
    /// An empty sink.
    pub fn new() -> Self {
        Self::default()
    }

    /// Panics unless every vertex has a triangle: a front leaves nothing behind.
    pub fn assert_no_stray_vertex(&self) {
        if let Some(id) = self.mirror.vertices.keys().find(|id| !self.uses.contains_key(id)) {
            panic!("vertex {id} is in no triangle");
        }
    }
}

fn assert_sound(id: VertexId, v: &SurfaceVertex) {
    let normal = glam::DVec3::from(v.normal.map(f64::from));
    assert!(v.position.is_finite(), "vertex {id} is at {}", v.position);
    assert!((normal.length() - 1.0).abs() < 1e-3, "vertex {id} has the normal {normal}, length {}", normal.length());
    assert!(v.detail_m.is_finite(), "vertex {id} has the detail {} m", v.detail_m);
    assert!(v.error_m >= 0.0 && v.bound_radius_m >= 0.0, "vertex {id}: error or radius is negative or NaN: {v:?}");
}

impl Sink for StrictSink {
    fn add_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        assert_sound(id, &vertex);
        self.mirror.add_vertex(id, vertex);
    }

    fn update_vertex(&mut self, id: VertexId, vertex: SurfaceVertex) {
        assert_sound(id, &vertex);
        self.mirror.update_vertex(id, vertex);
    }

    fn remove_vertex(&mut self, id: VertexId) {
        assert!(!self.uses.contains_key(&id), "vertex {id} removed while a triangle uses it");
        self.mirror.remove_vertex(id);
    }

    fn add_triangle(&mut self, key: TriangleKey, corners: [VertexId; 3]) {
        self.mirror.add_triangle(key, corners);
        for id in corners {
            *self.uses.entry(id).or_insert(0) += 1;
        }
    }

    fn remove_triangle(&mut self, key: TriangleKey) {
        let corners = self.mirror.triangles.get(&key).copied();
        self.mirror.remove_triangle(key);
        for id in corners.into_iter().flatten() {
            let left = self.uses.get_mut(&id).map_or(0, |n| {
                *n -= 1;
                *n
            });
            if left == 0 {
                self.uses.remove(&id);
            }
        }
    }
}
