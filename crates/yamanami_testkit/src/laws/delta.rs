//! The law of differences: a way from one front to the next can be stopped anywhere, and walked back.

use super::surface::{assert_equal, sink_of, step};
use crate::front::Step;
use yamanami_core::{NodeId, Surface};

/// `steps` lead from the front `from` to the front `to`: every prefix is a legal front, the sink led along them equals
/// one built for `to` alone, and the inverse leads back to the start exactly.
///
/// # Panics
/// With the step and what differs, when it does not hold.
pub fn delta_law<S: Surface>(surface: &S, from: &[NodeId], to: &[NodeId], steps: &[Step]) {
    let (from, to) = (in_order(from), in_order(to));
    let (start, mut front) = sink_of(surface, &from);
    let (end, _) = sink_of(surface, &to);
    let mut sink = start.clone();
    for &next in steps {
        step(surface, &mut front, next, &mut sink);
    }
    assert_eq!(front.nodes(), to, "the front after {} steps", steps.len());
    assert_equal("the delta applied to the old mesh", &sink, &end);
    for &next in steps.iter().rev() {
        step(surface, &mut front, next.inverse(), &mut sink);
    }
    assert_eq!(front.nodes(), from, "the front after the inverse of {} steps", steps.len());
    assert_equal("the inverse delta", &sink, &start);
}

/// By number, which puts parents first.
fn in_order(nodes: &[NodeId]) -> Vec<NodeId> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}
