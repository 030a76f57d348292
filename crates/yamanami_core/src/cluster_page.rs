//! What a hierarchy of triangle clusters keeps of each node, and what it reads when the node is shown.
//!
//! A *cluster* is up to 128 neighbouring triangles. A node is one step of refinement: it takes away a few coarse clusters
//! and puts the finer clusters of the same patch in their place; the patch's border is the same in both, so nodes may be
//! applied in any parent-closed combination. Idea: De Floriani, Puppo, Magillo, "A formal approach to multiresolution
//! hypersurface modeling", 1997; Cignoni, Ganovelli, Gobbetti, Marton, Ponchio, Scopigno, "Adaptive TetraPuzzles", 2004;
//! Karis, Stubbe, Wihlidal, "A Deep Dive into Nanite", 2021.

use crate::{NodeId, Sphere, VertexId};

/// Number of a group of clusters that come together: a node's number, or [`BASE_CLUSTERS`].
pub type GroupId = u32;

/// The group of the base mesh, which no node brings.
pub const BASE_CLUSTERS: GroupId = GroupId::MAX;

/// What is always in memory of a node.
#[derive(Debug, Clone, PartialEq)]
pub struct ClusterNode {
    /// Bound on the two-sided distance, metres, between the source and what is shown while the node is not applied.
    pub error_m: f32,
    /// Holds all that this node and its descendants change.
    pub bound: Sphere,
    /// Depth: 0 for nodes without parents.
    pub level: u32,
    /// The coarse clusters that applying this node takes away: each by its group and its place therein. At most 20.
    pub replaced: Vec<(GroupId, u16)>,
    /// Triangles in each of the finer clusters that it brings. At most 20 clusters.
    pub cluster_triangles: Vec<u16>,
    /// First number of the vertices that it brings; they are numbered on from there.
    pub first_vertex: VertexId,
    /// Vertices that it brings.
    pub vertex_count: u32,
}

/// A vertex of a page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusterVertex {
    /// Position in metres.
    pub position_m: [f64; 3],
    /// Unit normal.
    pub normal: [f32; 3],
    /// Colour (sRGB).
    pub colour: [u8; 3],
}

/// What is read when a node is to be shown (or the base mesh, [`BASE_CLUSTERS`]).
#[derive(Debug, Clone, PartialEq)]
pub struct ClusterPage {
    /// Whose page it is.
    pub group: GroupId,
    /// The vertices that the node brings, numbered from its `first_vertex` on.
    pub vertices: Vec<ClusterVertex>,
    /// The vertices that applying the node takes away, ascending; ancestors brought them.
    pub removed: Vec<VertexId>,
    /// All triangles of its clusters, cluster by cluster, by vertex number.
    pub triangles: Vec<[VertexId; 3]>,
}

impl ClusterNode {
    /// Triangles of all its clusters.
    pub fn triangle_count(&self) -> usize {
        self.cluster_triangles.iter().map(|&n| usize::from(n)).sum()
    }

    /// The groups that must have come before: its parents, without repetition, ascending.
    pub fn parents(&self) -> impl Iterator<Item = NodeId> {
        let mut groups: Vec<GroupId> =
            self.replaced.iter().map(|&(group, _)| group).filter(|&g| g != BASE_CLUSTERS).collect();
        groups.sort_unstable();
        groups.dedup();
        groups.into_iter()
    }
}
