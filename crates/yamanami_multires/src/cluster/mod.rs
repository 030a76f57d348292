//! The multiresolution of scans and TINs: a hierarchy of clusters of triangles, and the surface that emits any of its fronts.
//!
//! Based on: De Floriani, Puppo, Magillo, "A formal approach to multiresolution hypersurface modeling", 1997; Cignoni,
//! Ganovelli, Gobbetti, Marton, Ponchio, Scopigno, "Adaptive TetraPuzzles", 2004; Karis, Stubbe, Wihlidal, "A Deep Dive
//! into Nanite", 2021. Where we differ: the groups are the nodes of a multi-triangulation, so that a front is any
//! parent-closed set and the controller of the terrain moves it; errors are bounds on two-sided distance.

mod attributes;
mod build;
mod glue;
mod ground;
mod group;
mod number;
mod patch;
mod sphere;
mod split;
mod surface;
mod table;
mod weld;

pub use build::{BuildSummary, build, build_tin};
pub use glue::{Glued, Seam, Tile, TileTop, build_tile, join_tiles};
pub use surface::ClusterSurface;

use crate::MultiresError;
use yamanami_core::{ClusterNode, ClusterPage};

/// How to build.
pub struct ClusterOptions<'a> {
    /// Most triangles in a cluster.
    pub cluster_triangles: usize,
    /// Clusters that are simplified together.
    pub group_clusters: usize,
    /// Hears of the share done, 0 to 1.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
}

impl Default for ClusterOptions<'_> {
    fn default() -> Self {
        Self { cluster_triangles: 128, group_clusters: 8, progress: None }
    }
}

impl std::fmt::Debug for ClusterOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ClusterOptions")
            .field("cluster_triangles", &self.cluster_triangles)
            .field("group_clusters", &self.group_clusters)
            .finish_non_exhaustive()
    }
}

/// A hierarchy of clusters.
#[derive(Debug, Clone)]
pub struct ClusterBuild {
    /// The nodes, parents first.
    pub nodes: Vec<ClusterNode>,
    /// Triangles in each cluster of the base mesh.
    pub base_clusters: Vec<u16>,
    /// The base mesh.
    pub base: ClusterPage,
    /// A page a node, in order.
    pub pages: Vec<ClusterPage>,
    /// How it went.
    pub summary: BuildSummary,
}

impl ClusterBuild {
    /// The surface with all pages in memory.
    pub fn into_surface(self) -> Result<ClusterSurface, MultiresError> {
        let mut surface = ClusterSurface::new(&self.nodes, &self.base_clusters, self.base)?;
        for page in self.pages {
            surface.insert(page)?;
        }
        Ok(surface)
    }
}
