//! The exact front from nothing: greedy refinement, largest error first.

use crate::{Criteria, Front};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use yamanami_core::{Hierarchy, NodeId};

/// A node in order of priority: greater error first, smaller number first among equals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ranked {
    pub(crate) priority: f32,
    pub(crate) node: NodeId,
}

impl Eq for Ranked {}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        self.priority.total_cmp(&other.priority).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The front that greedy refinement reaches from the base mesh: nodes above the threshold, largest error first, until the
/// next one does not fit the budget. Absent nodes are passed over. Hysteresis and step limit play no part.
pub fn extract(hierarchy: &impl Hierarchy, criteria: &Criteria) -> Front {
    let scale = criteria.scale();
    let rank = |node| Ranked { priority: scale.weigh(hierarchy, node).priority, node };
    let budget = criteria.budget_triangles.map_or(i64::MAX, i64::from);
    let mut front = Front::new(hierarchy);
    let mut open: BinaryHeap<Ranked> = hierarchy.roots().into_iter().map(rank).collect();
    while let Some(best) = open.pop() {
        if best.priority <= criteria.threshold() {
            break;
        }
        if !hierarchy.is_resident(best.node) {
            continue;
        }
        let added = hierarchy.triangles_added(best.node, &front);
        if front.triangle_count() as i64 + i64::from(added) > budget {
            break;
        }
        front.refine(hierarchy, best.node, added, |_, node| open.push(rank(node)));
    }
    front
}
