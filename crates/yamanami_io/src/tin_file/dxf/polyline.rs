//! `POLYLINE` and its vertices: a line in space or at one height, a mesh of M × N vertices, or a mesh of faces.
//!
//! Based on: Autodesk, "DXF reference", 2018.

use super::drawing::{Drawing, Entity};
use crate::IoError;
use glam::DVec3;

/// Flags of a polyline.
const CLOSED: i64 = 1;
const CURVE_FIT: i64 = 2;
const SPLINE_FIT: i64 = 4;
const IN_SPACE: i64 = 8;
const MESH: i64 = 16;
const CLOSED_IN_N: i64 = 32;
const POLYFACE: i64 = 64;

/// Flags of a vertex.
const FRAME: i64 = 16;
const MESH_VERTEX: i64 = 64;
const POLYFACE_PART: i64 = 128;

/// A polyline whose vertices are being read.
pub(super) struct Polyline {
    head: Entity,
    vertices: Vec<DVec3>,
    /// Faces of a polyface mesh: numbers of corners from 1, negative before a hidden edge, 0 for none.
    faces: Vec<[i64; 4]>,
}

impl Polyline {
    /// A polyline without vertices.
    pub(super) fn new(head: Entity) -> Self {
        Self { head, vertices: Vec::new(), faces: Vec::new() }
    }

    /// Takes a vertex.
    pub(super) fn vertex(&mut self, vertex: &Entity) {
        let fitted = self.head.flags & (CURVE_FIT | SPLINE_FIT) != 0;
        if self.head.flags & POLYFACE != 0 && vertex.flags & (POLYFACE_PART | MESH_VERTEX) == POLYFACE_PART {
            self.faces.push(vertex.counts);
        } else if !fitted || vertex.flags & FRAME == 0 {
            self.vertices.push(vertex.corners[0]);
            self.head.bulged |= vertex.bulged;
        }
    }

    /// Makes what it is of its vertices.
    pub(super) fn finish(self, drawing: &mut Drawing<'_>) -> Result<(), IoError> {
        match self.head.flags {
            flags if flags & POLYFACE != 0 => self.polyface(drawing),
            flags if flags & MESH != 0 => self.mesh(drawing),
            flags => {
                let closing = if flags & CLOSED != 0 { self.vertices.first() } else { None };
                let points = self.vertices.iter().chain(closing).copied();
                if flags & IN_SPACE != 0 {
                    drawing.line(points, &self.head);
                } else {
                    drawing.level_line(points, &self.head, self.head.corners[0].z);
                }
                Ok(())
            }
        }
    }

    fn polyface(&self, drawing: &mut Drawing<'_>) -> Result<(), IoError> {
        let mut corners = Vec::new();
        for face in &self.faces {
            let numbers = face.iter().filter(|&&number| number != 0);
            let expected = numbers.clone().count();
            let vertex = |number: &i64| self.vertices.get(usize::try_from(number.unsigned_abs()).ok()? - 1);
            corners.clear();
            corners.extend(numbers.filter_map(vertex).copied());
            if corners.len() < expected {
                drawing.count("faces with a corner that is no vertex dropped", self.head.line);
            } else {
                drawing.polygon(&corners, &self.head)?;
            }
        }
        Ok(())
    }

    fn mesh(&self, drawing: &mut Drawing<'_>) -> Result<(), IoError> {
        let [m, n, fitted_m, fitted_n] = self.head.counts.map(|count| usize::try_from(count).unwrap_or(0));
        let (m, n) = if self.head.flags & SPLINE_FIT != 0 { (fitted_m, fitted_n) } else { (m, n) };
        if m < 2 || n < 2 || m.checked_mul(n) != Some(self.vertices.len()) {
            drawing.count("polygon meshes with another number of vertices than they state dropped", self.head.line);
            return Ok(());
        }
        let rows = if self.head.flags & CLOSED != 0 { m } else { m - 1 };
        let columns = if self.head.flags & CLOSED_IN_N != 0 { n } else { n - 1 };
        let vertex = |i: usize, j: usize| self.vertices[i % m * n + j % n];
        for i in 0..rows {
            for j in 0..columns {
                let corners = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)];
                drawing.polygon(&corners, &self.head)?;
            }
        }
        Ok(())
    }
}
