//! Which triangles meet in a vertex, so that a visible vertex draws them all.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS", APA, 2005, figure 3.

use crate::collapse::stars::Stars;

/// The links of a level's vertices to its triangles.
#[derive(Debug)]
pub(super) struct Links(Stars);

impl Links {
    /// Of triangles whose corners are below `vertices`.
    pub(super) fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        Self(Stars::new(triangles, vertices))
    }

    /// The triangles that share a vertex, in their order.
    pub(super) fn of(&self, vertex: u32) -> impl Iterator<Item = usize> + '_ {
        self.0.of(vertex).iter().map(|corner| corner.triangle())
    }
}
