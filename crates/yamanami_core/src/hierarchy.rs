//! The hierarchy: a multi-triangulation, and the surface that can emit any of its fronts.
//!
//! Based on: De Floriani, Puppo, Magillo, "A formal approach to multiresolution hypersurface modeling", 1997 (the
//! partial order of local modifications); Hashida, Kanai, Kishinami (the front as what is shown).
//!
//! Laws (run by the test kit over every method): the order is acyclic with parents numbered before children; a
//! parent's error is not below its child's; a parent's bound contains its child's; every parent-closed set is a
//! conforming mesh; refine then coarsen restores the sink.

use crate::{MapView, Projection, Sink, TriangleMesh};
use glam::DVec3;

/// Number of a node; a parent's number is always below its children's.
pub type NodeId = u32;

/// A ball that holds everything a node and its descendants can change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Centre in metres.
    pub centre: DVec3,
    /// Radius in metres.
    pub radius_m: f64,
}

/// A short list of nodes without allocation.
#[derive(Debug, Clone, Copy)]
pub struct NodeList {
    len: u8,
    nodes: [NodeId; 20],
}

impl NodeList {
    /// The empty list.
    #[inline]
    pub fn new() -> Self {
        Self { len: 0, nodes: [0; 20] }
    }

    /// Adds a node unless it is there already.
    #[inline]
    pub fn insert(&mut self, node: NodeId) {
        if !self.contains(&node) {
            self.nodes[usize::from(self.len)] = node;
            self.len += 1;
        }
    }
}

impl Default for NodeList {
    fn default() -> Self {
        Self::new()
    }
}

impl std::ops::Deref for NodeList {
    type Target = [NodeId];
    #[inline]
    fn deref(&self) -> &[NodeId] {
        &self.nodes[..usize::from(self.len)]
    }
}

/// The partial order of refinement steps, with what a controller must know of each.
pub trait Hierarchy {
    /// One past the greatest node number. Not every number below it need be a node; see [`Self::exists`].
    fn node_bound(&self) -> NodeId;

    /// Whether this number is a node.
    fn exists(&self, node: NodeId) -> bool;

    /// Nodes without parents, in order.
    fn roots(&self) -> Vec<NodeId>;

    /// Nodes that must be applied before this one.
    fn parents(&self, node: NodeId) -> NodeList;

    /// Nodes that have this one as a parent.
    fn children(&self, node: NodeId) -> NodeList;

    /// How many parents a node has; equals `parents(node).len()`.
    #[inline]
    fn parent_count(&self, node: NodeId) -> usize {
        self.parents(node).len()
    }

    /// What may stay, in metres, while this node is not applied: a bound on true distance, not a coefficient.
    fn error_m(&self, node: NodeId) -> f32;

    /// Holds all that this node and its descendants change.
    fn bound(&self, node: NodeId) -> Sphere;

    /// Error and bound in one: what a controller asks most.
    #[inline]
    fn error_and_bound(&self, node: NodeId) -> (f32, Sphere) {
        (self.error_m(node), self.bound(node))
    }

    /// How far, in pixels, the picture of a deformed map may be off while this node is not applied. Like the error it
    /// never rises from a parent to its child. By default what a vertical error does anywhere in the bound; surfaces
    /// with coarse triangles must add what the projection bends ([`MapView::patch_error_px`]).
    fn map_error_px(&self, node: NodeId, view: &MapView) -> f32 {
        let (error_m, bound) = self.error_and_bound(node);
        view.error_px(f64::from(error_m), bound) as f32
    }

    /// Triangles that applying this node to the parent-closed set `active` (without it) adds, exactly. Where a hole
    /// becomes sharper this may be negative.
    fn triangles_added(&self, node: NodeId, active: &dyn ActiveSet) -> i32;

    /// Triangles of the base mesh.
    fn base_triangle_count(&self) -> usize;

    /// Depth: 0 for the roots' level, larger is finer.
    fn level(&self, node: NodeId) -> u32;

    /// Whether the node's data are in memory. A controller must not apply an absent node.
    #[inline]
    fn is_resident(&self, _node: NodeId) -> bool {
        true
    }
}

/// Which nodes are applied.
pub trait ActiveSet {
    /// Whether the node is applied.
    fn is_active(&self, node: NodeId) -> bool;
}

impl<F: Fn(NodeId) -> bool> ActiveSet for F {
    fn is_active(&self, node: NodeId) -> bool {
        self(node)
    }
}

/// A hierarchy that can show any of its fronts.
pub trait Surface: Hierarchy {
    /// Emits the base mesh (the empty front) into an empty sink.
    fn emit_base(&self, sink: &mut dyn Sink);

    /// Emits what changes when `node`, whose parents are all in `active` and which itself is not yet, is applied.
    fn refine(&self, node: NodeId, active: &dyn ActiveSet, sink: &mut dyn Sink);

    /// Emits what changes when `node`, in `active` without any active child, is undone. `active` still has `node`.
    fn coarsen(&self, node: NodeId, active: &dyn ActiveSet, sink: &mut dyn Sink);

    /// Emits a whole front into an empty sink, each vertex and triangle once: what the steps from the base lead to.
    fn emit_front(&self, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        self.emit_base(sink);
        for node in (0..self.node_bound()).filter(|&n| self.exists(n) && active.is_active(n)) {
            self.refine(node, &|n| n < node && active.is_active(n), sink);
        }
    }

    /// The mesh of a parent-closed set, built at once: the slow, short twin of the sink's way there.
    fn mesh_of(&self, active: &dyn ActiveSet) -> TriangleMesh;
}
