//! What the tests share: a hilly surface, and a walk of changes that obeys the sink's promises.
#![allow(dead_code, unreachable_pub)]

pub mod maps;
#[cfg(feature = "wgpu")]
pub mod target;

use glam::DVec3;
use std::collections::BTreeSet;
use yamanami_core::{Sink, SurfaceVertex, TriangleKey, TriangleMesh, VertexId, View};

/// Heights of a hilly square of `side` metres, two triangles a cell, far from the frame's zero point.
pub fn hills(cells: u32, side_m: f64) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let step_m = side_m / f64::from(cells);
    for j in 0..=cells {
        for i in 0..=cells {
            let (x, y) = (f64::from(i) * step_m, f64::from(j) * step_m);
            let (u, v) = (x / side_m * 9.0, y / side_m * 7.0);
            let z = side_m * (0.06 * (u.sin() * v.cos()) + 0.02 * (2.3 * u + 1.0).cos() * (3.1 * v).sin());
            mesh.positions.push(DVec3::new(400_000.0 + x, -3_900_000.0 + y, 500.0 + z));
        }
    }
    let across = cells + 1;
    for j in 0..cells {
        for i in 0..cells {
            let [a, b, c, d] = [j * across + i, j * across + i + 1, (j + 1) * across + i, (j + 1) * across + i + 1];
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    mesh
}

/// A view over the middle of a mesh, from `from` sides of its box away.
pub fn view_of(mesh: &TriangleMesh, from: DVec3, viewport_px: [u32; 2]) -> View {
    let bounds = mesh.bounds();
    let side_m = bounds.max.x - bounds.min.x;
    View { eye: bounds.centre() + from * side_m, target: bounds.centre(), fov_y_rad: 0.9, viewport_px }
}

/// A vertex told apart from others by its number.
pub fn vertex(id: VertexId, version: u32) -> SurfaceVertex {
    let id_m = f64::from(id);
    SurfaceVertex {
        position: DVec3::new(id_m * 0.7, -id_m * 1.3, (id_m * 0.37).sin() * 40.0),
        normal: [0.0, (version as f32).sin(), (version as f32).cos()],
        detail_m: id as f32 * 0.01,
        error_m: if id < 3 { f32::INFINITY } else { version as f32 },
        bound_radius_m: version as f32 * 2.0,
        level: id % 13,
        colour: [255; 3],
    }
}

/// Replays coded changes on a sink, keeping to what a surface promises.
#[derive(Default)]
pub struct Walk {
    vertices: Vec<VertexId>,
    triangles: Vec<(TriangleKey, [VertexId; 3])>,
    used: BTreeSet<TriangleKey>,
    next_vertex: VertexId,
    version: u32,
}

impl Walk {
    /// One change, chosen by a number.
    pub fn step(&mut self, code: u32, sink: &mut dyn Sink) {
        let pick = (code / 8) as usize;
        match code % 8 {
            0..=2 => {
                sink.add_vertex(self.next_vertex, vertex(self.next_vertex, 0));
                self.vertices.push(self.next_vertex);
                self.next_vertex += 1 + code % 5;
            }
            3..=5 if self.vertices.len() >= 3 => {
                let n = self.vertices.len();
                let corners = [self.vertices[pick % n], self.vertices[(pick + 1) % n], self.vertices[(pick + 2) % n]];
                let key = u64::from(code) << 17 | u64::from(code % 8);
                if self.used.insert(key) {
                    sink.add_triangle(key, corners);
                    self.triangles.push((key, corners));
                }
            }
            6 if !self.triangles.is_empty() => {
                let (key, _) = self.triangles.swap_remove(pick % self.triangles.len());
                self.used.remove(&key);
                sink.remove_triangle(key);
            }
            _ if !self.vertices.is_empty() => {
                let slot = pick % self.vertices.len();
                let id = self.vertices[slot];
                if self.triangles.iter().any(|(_, corners)| corners.contains(&id)) {
                    self.version += 1;
                    sink.update_vertex(id, vertex(id, self.version));
                } else {
                    self.vertices.swap_remove(slot);
                    sink.remove_vertex(id);
                }
            }
            _ => {}
        }
    }
}
