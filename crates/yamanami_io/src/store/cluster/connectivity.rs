//! A whole mesh's triangles to bytes and back, by the means of a page.

use super::order::walk;
use super::triangles::{self, Border};

/// Triangles in an order in which each is glued to those before it where it can be.
#[derive(Debug)]
pub(crate) struct Ordered {
    /// Old number of each triangle, and its corners with old numbers, turned to begin with the edge where it is glued.
    pub(crate) triangles: Vec<(u32, [u32; 3])>,
    /// Old numbers of the vertices, in the order in which the triangles use them.
    pub(crate) vertices: Vec<u32>,
}

/// Puts triangles in an order in which they take few bytes.
pub(crate) fn in_order(vertices: u32, all: &[[u32; 3]]) -> Ordered {
    let mut border = Border::new(vertices);
    let mut triangles = Vec::with_capacity(all.len());
    walk(all, &mut border, |nth, corners| triangles.push((nth as u32, corners)));
    border.place_rest();
    Ordered { triangles, vertices: border.placings.iter().map(|p| p.vertex).collect() }
}

/// The bytes of triangles.
pub(crate) fn encode(vertices: u32, triangles: &[[u32; 3]]) -> Vec<u8> {
    triangles::encode(vertices, triangles).0
}

/// Undoes [`encode`] for `count` triangles; `None` when the bytes are no such triangles.
pub(crate) fn decode(vertices: u32, count: usize, bytes: &[u8]) -> Option<Vec<[u32; 3]>> {
    triangles::decode(vertices, 0, count, bytes).map(|(triangles, _)| triangles)
}
