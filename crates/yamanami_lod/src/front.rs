//! The front: which nodes are applied, with the bookkeeping that makes its border cheap to find.
//!
//! Nodes on the border are either *open* (not applied, all parents are: may be refined) or *leaves* (applied, no child
//! is: may be coarsened). State is kept in blocks that are allocated where the front has been.

use yamanami_core::{ActiveSet, Hierarchy, NodeId};

/// One step of a delta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Apply the node.
    Refine(NodeId),
    /// Undo the node.
    Coarsen(NodeId),
}

impl Step {
    /// The step that leads back.
    pub fn inverse(self) -> Self {
        match self {
            Self::Refine(n) => Self::Coarsen(n),
            Self::Coarsen(n) => Self::Refine(n),
        }
    }
}

const BLOCK_BITS: u32 = 10;
const BLOCK: usize = 1 << BLOCK_BITS;

/// What is known of a node near the front.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NodeState {
    active: bool,
    /// Not applied, and all parents are.
    open: bool,
    /// In this frame's queues.
    pub(crate) hot: bool,
    active_parents: u8,
    active_children: u8,
    /// Tick at which the node is to be looked at again.
    pub(crate) wake: u32,
}

/// A parent-closed set of applied nodes.
#[derive(Debug, Clone, Default)]
pub struct Front {
    blocks: Vec<Option<Box<[NodeState]>>>,
    triangles: i64,
    len: usize,
}

impl ActiveSet for Front {
    #[inline]
    fn is_active(&self, node: NodeId) -> bool {
        self.state(node).active
    }
}

impl Front {
    /// The empty front of a hierarchy: its base mesh.
    pub fn new(hierarchy: &impl Hierarchy) -> Self {
        let blocks = (hierarchy.node_bound() as usize).div_ceil(BLOCK);
        let mut front = Self { blocks: vec![None; blocks], triangles: hierarchy.base_triangle_count() as i64, len: 0 };
        for root in hierarchy.roots() {
            front.state_mut(root).open = true;
        }
        front
    }

    /// Triangles of the front's mesh.
    pub fn triangle_count(&self) -> usize {
        self.triangles.max(0) as usize
    }

    /// Applied nodes.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether nothing is applied.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// All applied nodes, in order.
    pub fn nodes(&self) -> Vec<NodeId> {
        let mut out = Vec::with_capacity(self.len);
        for (b, block) in self.blocks.iter().enumerate() {
            for (i, state) in block.iter().flat_map(|b| b.iter().enumerate()) {
                if state.active {
                    out.push((b * BLOCK + i) as NodeId);
                }
            }
        }
        out
    }

    #[inline]
    pub(crate) fn state(&self, node: NodeId) -> NodeState {
        match &self.blocks[(node >> BLOCK_BITS) as usize] {
            Some(block) => block[node as usize & (BLOCK - 1)],
            None => NodeState::default(),
        }
    }

    #[inline]
    pub(crate) fn state_mut(&mut self, node: NodeId) -> &mut NodeState {
        let block = self.blocks[(node >> BLOCK_BITS) as usize]
            .get_or_insert_with(|| vec![NodeState::default(); BLOCK].into_boxed_slice());
        &mut block[node as usize & (BLOCK - 1)]
    }

    /// Whether the node may be refined.
    #[inline]
    pub fn is_open(&self, node: NodeId) -> bool {
        self.state(node).open
    }

    /// Whether the node may be coarsened.
    #[inline]
    pub fn is_leaf(&self, node: NodeId) -> bool {
        let s = self.state(node);
        s.active && s.active_children == 0
    }

    /// Applies an open node that adds `added` triangles; `opened` hears of each node that may now be refined.
    pub(crate) fn refine(
        &mut self,
        hierarchy: &impl Hierarchy,
        node: NodeId,
        added: i32,
        mut opened: impl FnMut(&mut Self, NodeId),
    ) {
        let state = self.state_mut(node);
        debug_assert!(state.open);
        (state.active, state.open) = (true, false);
        self.len += 1;
        self.triangles += i64::from(added);
        for &p in hierarchy.parents(node).iter() {
            self.state_mut(p).active_children += 1;
        }
        for &c in hierarchy.children(node).iter() {
            let s = self.state_mut(c);
            s.active_parents += 1;
            if usize::from(s.active_parents) == hierarchy.parent_count(c) {
                s.open = true;
                opened(self, c);
            }
        }
    }

    /// Undoes a leaf that had added `added` triangles; `closed` hears of each parent that is a leaf now.
    pub(crate) fn coarsen(
        &mut self,
        hierarchy: &impl Hierarchy,
        node: NodeId,
        added: i32,
        mut closed: impl FnMut(&mut Self, NodeId),
    ) {
        debug_assert!(self.is_leaf(node));
        let state = self.state_mut(node);
        (state.active, state.open) = (false, true);
        self.len -= 1;
        self.triangles -= i64::from(added);
        for &c in hierarchy.children(node).iter() {
            let s = self.state_mut(c);
            s.active_parents -= 1;
            s.open = false;
        }
        for &p in hierarchy.parents(node).iter() {
            let s = self.state_mut(p);
            s.active_children -= 1;
            if s.active_children == 0 {
                closed(self, p);
            }
        }
    }

    /// Applies an open node outside a controller.
    pub fn apply(&mut self, hierarchy: &impl Hierarchy, node: NodeId) {
        let added = hierarchy.triangles_added(node, self);
        self.refine(hierarchy, node, added, |_, _| ());
    }

    /// Undoes a leaf outside a controller.
    pub fn undo(&mut self, hierarchy: &impl Hierarchy, node: NodeId) {
        let set = |n: NodeId| n != node && self.is_active(n);
        let added = hierarchy.triangles_added(node, &set);
        self.coarsen(hierarchy, node, added, |_, _| ());
    }
}
