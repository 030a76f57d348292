//! Random legal fronts: what a controller could ever ask of a hierarchy, and much it would not.

use crate::rng::Rng;
use std::collections::BTreeSet;
use yamanami_core::{ActiveSet, Hierarchy, NodeId};

/// One step from a front to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Apply a node.
    Refine(NodeId),
    /// Undo a node.
    Coarsen(NodeId),
}

impl Step {
    /// The step that leads back.
    #[must_use]
    pub fn inverse(self) -> Self {
        match self {
            Self::Refine(node) => Self::Coarsen(node),
            Self::Coarsen(node) => Self::Refine(node),
        }
    }
}

/// A set whose members can be picked by chance.
#[derive(Debug, Clone, Default)]
struct Pool {
    members: Vec<NodeId>,
    /// Position in `members` + 1, or 0.
    place: Vec<u32>,
}

impl Pool {
    fn set(&mut self, node: NodeId, is_member: bool) {
        let place = self.place[node as usize] as usize;
        if is_member && place == 0 {
            self.members.push(node);
            self.place[node as usize] = self.members.len() as u32;
        } else if !is_member && place > 0 {
            self.members.swap_remove(place - 1);
            if let Some(&moved) = self.members.get(place - 1) {
                self.place[moved as usize] = place as u32;
            }
            self.place[node as usize] = 0;
        }
    }
}

/// A parent-closed set that takes random legal steps; knows which nodes may be applied and which undone.
#[derive(Debug)]
pub struct RandomFront<'a, H: ?Sized> {
    hierarchy: &'a H,
    rng: Rng,
    active: Vec<bool>,
    active_count: usize,
    refinable: Pool,
    coarsenable: Pool,
}

impl<'a, H: Hierarchy + ?Sized> RandomFront<'a, H> {
    /// The empty front.
    pub fn new(hierarchy: &'a H, seed: u64) -> Self {
        let bound = hierarchy.node_bound() as usize;
        let pool = || Pool { members: Vec::new(), place: vec![0; bound] };
        let mut front = Self {
            hierarchy,
            rng: Rng::new(seed),
            active: vec![false; bound],
            active_count: 0,
            refinable: pool(),
            coarsenable: pool(),
        };
        for root in hierarchy.roots() {
            front.refinable.set(root, true);
        }
        front
    }

    /// How many nodes are applied.
    pub fn len(&self) -> usize {
        self.active_count
    }

    /// Whether this is the base mesh.
    pub fn is_empty(&self) -> bool {
        self.active_count == 0
    }

    /// The applied nodes, parents before children.
    pub fn nodes(&self) -> Vec<NodeId> {
        (0..self.hierarchy.node_bound()).filter(|&n| self.active[n as usize]).collect()
    }

    /// The applied nodes in another order that also puts parents before children.
    pub fn nodes_shuffled(&mut self) -> Vec<NodeId> {
        let mut waiting = vec![0u32; self.active.len()];
        let mut ready = Vec::new();
        for node in self.nodes() {
            waiting[node as usize] = self.hierarchy.parents(node).len() as u32;
            if waiting[node as usize] == 0 {
                ready.push(node);
            }
        }
        let mut order = Vec::with_capacity(self.active_count);
        while !ready.is_empty() {
            let node = ready.swap_remove(self.rng.below(ready.len()));
            order.push(node);
            for &child in self.hierarchy.children(node).iter() {
                if self.active[child as usize] {
                    waiting[child as usize] -= 1;
                    if waiting[child as usize] == 0 {
                        ready.push(child);
                    }
                }
            }
        }
        order
    }

    /// Nodes that may be applied next.
    pub fn refinable(&self) -> &[NodeId] {
        &self.refinable.members
    }

    /// Nodes that may be undone next.
    pub fn coarsenable(&self) -> &[NodeId] {
        &self.coarsenable.members
    }

    /// Picks a node that may be applied: half the time the one that became possible last, which digs deep and narrow,
    /// otherwise any.
    pub fn pick_refine(&mut self) -> Option<NodeId> {
        let last = *self.refinable.members.last()?;
        let any = self.refinable.members[self.rng.below(self.refinable.members.len())];
        Some(if self.rng.chance(0.5) { last } else { any })
    }

    /// Picks a node that may be undone.
    pub fn pick_coarsen(&mut self) -> Option<NodeId> {
        let members = &self.coarsenable.members;
        members.get(self.rng.below(members.len())).copied()
    }

    /// Picks a legal step that applies with the given probability; `None` only when the hierarchy has no node.
    pub fn pick(&mut self, refine_probability: f64) -> Option<Step> {
        let refine = self.rng.chance(refine_probability);
        let (apply, undo) = (self.pick_refine().map(Step::Refine), self.pick_coarsen().map(Step::Coarsen));
        if refine { apply.or(undo) } else { undo.or(apply) }
    }

    /// The nodes not yet applied that must be, in order, for a random node of the whole hierarchy to be: the thinnest
    /// front that reaches it.
    pub fn pick_with_ancestors(&mut self) -> Vec<NodeId> {
        let bound = self.hierarchy.node_bound() as usize;
        let found = (0..64).map(|_| self.rng.below(bound) as NodeId).find(|&n| self.hierarchy.exists(n));
        let Some(start) = found else { return Vec::new() };
        let (mut open, mut needed) = (vec![start], BTreeSet::new());
        while let Some(node) = open.pop() {
            if !self.active[node as usize] && needed.insert(node) {
                open.extend_from_slice(&self.hierarchy.parents(node));
            }
        }
        needed.into_iter().collect()
    }

    /// Takes a step.
    ///
    /// # Panics
    /// When the step is not legal here: a test that asks for it is wrong.
    pub fn take(&mut self, step: Step) {
        let (node, apply) = match step {
            Step::Refine(node) => (node, true),
            Step::Coarsen(node) => (node, false),
        };
        let pool = if apply { &self.refinable } else { &self.coarsenable };
        assert!(pool.place[node as usize] > 0, "{step:?} is not legal on a front of {} nodes", self.active_count);
        self.active[node as usize] = apply;
        self.active_count = if apply { self.active_count + 1 } else { self.active_count - 1 };
        self.refinable.set(node, !apply);
        self.coarsenable.set(node, apply);
        for &child in self.hierarchy.children(node).iter() {
            let ready = self.hierarchy.parents(child).iter().all(|&p| self.active[p as usize]);
            self.refinable.set(child, ready && !self.active[child as usize]);
        }
        for &parent in self.hierarchy.parents(node).iter() {
            let free = !self.hierarchy.children(parent).iter().any(|&c| self.active[c as usize]);
            self.coarsenable.set(parent, free && self.active[parent as usize]);
        }
    }

    /// Grows (or shrinks, when there is nothing left to apply) by random steps until `nodes` are applied or `steps` taken.
    pub fn wander(&mut self, steps: usize, nodes: usize) {
        for _ in 0..steps {
            if self.active_count >= nodes {
                break;
            }
            let Some(step) = self.pick(0.8) else { break };
            self.take(step);
        }
    }
}

impl<H: Hierarchy + ?Sized> ActiveSet for RandomFront<'_, H> {
    fn is_active(&self, node: NodeId) -> bool {
        self.active.get(node as usize).copied().unwrap_or(false)
    }
}
