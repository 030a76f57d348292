//! The law of the partial order.

use yamanami_core::{Hierarchy, NodeId};

/// Relative slack of nested bounds, which are computed in floating point.
const NESTING_SLACK: f64 = 1e-9;

/// The order is acyclic, its two directions agree, errors are monotone along it and bounds nested.
///
/// # Panics
/// With the node and what was expected, when it does not hold.
pub fn hierarchy_law<H: Hierarchy + ?Sized>(hierarchy: &H) {
    let mut roots = Vec::new();
    for node in (0..hierarchy.node_bound()).filter(|&n| hierarchy.exists(n)) {
        let (parents, children) = (hierarchy.parents(node), hierarchy.children(node));
        assert_eq!(
            hierarchy.parent_count(node),
            parents.len(),
            "node {node}: parent_count against parents {parents:?}"
        );
        assert_distinct(node, "parents", &parents);
        assert_distinct(node, "children", &children);
        if parents.is_empty() {
            roots.push(node);
        }
        // numbers that grow along the order leave no room for a cycle
        for &parent in parents.iter() {
            assert!(parent < node, "node {node} has the parent {parent}, which should have a lower number");
            assert!(hierarchy.exists(parent), "node {node} has the parent {parent}, which does not exist");
            assert!(
                hierarchy.children(parent).contains(&node),
                "node {node} has the parent {parent}, whose children are {:?}",
                &*hierarchy.children(parent)
            );
            pair_law(hierarchy, parent, node);
        }
        for &child in children.iter() {
            assert!(
                child < hierarchy.node_bound() && hierarchy.exists(child),
                "node {node} has the child {child}, which does not exist"
            );
            assert!(
                hierarchy.parents(child).contains(&node),
                "node {node} has the child {child}, whose parents are {:?}",
                &*hierarchy.parents(child)
            );
        }
        single_law(hierarchy, node);
    }
    assert_eq!(hierarchy.roots(), roots, "roots() against the nodes without parents, in order");
}

fn assert_distinct(node: NodeId, what: &str, list: &[NodeId]) {
    for (i, a) in list.iter().enumerate() {
        assert!(!list[..i].contains(a), "node {node} has {a} twice among its {what} {list:?}");
    }
}

fn single_law<H: Hierarchy + ?Sized>(hierarchy: &H, node: NodeId) {
    let (error_m, bound) = (hierarchy.error_m(node), hierarchy.bound(node));
    assert!(error_m >= 0.0, "node {node} has the error {error_m} m");
    assert!(
        bound.centre.is_finite() && bound.radius_m.is_finite() && bound.radius_m >= 0.0,
        "node {node} has the bound {bound:?}"
    );
}

fn pair_law<H: Hierarchy + ?Sized>(hierarchy: &H, parent: NodeId, child: NodeId) {
    let (above_m, below_m) = (hierarchy.error_m(parent), hierarchy.error_m(child));
    assert!(above_m >= below_m, "error not monotone: parent {parent} has {above_m} m, its child {child} {below_m} m");
    let (outer, inner) = (hierarchy.bound(parent), hierarchy.bound(child));
    let reach_m = (inner.centre - outer.centre).length() + inner.radius_m;
    assert!(
        reach_m <= outer.radius_m + NESTING_SLACK * outer.radius_m.max(1.0),
        "bound not nested: child {child} reaches {reach_m} m from the centre of parent {parent}, whose radius is {} m",
        outer.radius_m
    );
    let (coarse, fine) = (hierarchy.level(parent), hierarchy.level(child));
    assert!(coarse <= fine, "parent {parent} is at level {coarse}, its child {child} at {fine}");
}
