//! The law of parent-closed sets: each is a mesh.

use super::Kind;
use crate::conforming::check_conforming;
use crate::front::{RandomFront, Step};
use yamanami_core::{ActiveSet, Hierarchy, NodeId, Surface};

/// [`closure_law_of`] a height field without holes.
///
/// # Panics
/// With the front and the defect, when it does not hold.
pub fn closure_law<S: Surface>(surface: &S, seed: u64) {
    closure_law_of(surface, seed, Kind::Terrain);
}

/// Every parent-closed set is a conforming mesh with as many triangles as the nodes say: tried on the empty set, the full
/// set, thin fronts that reach one deep node, and fronts grown and shrunk at random.
///
/// # Panics
/// With the front and the defect, when it does not hold.
pub fn closure_law_of<S: Surface>(surface: &S, seed: u64, kind: Kind) {
    let base = surface.mesh_of(&|_: NodeId| false);
    let base_count = surface.base_triangle_count();
    assert_eq!(base.triangles.len(), base_count, "triangles of the base mesh against base_triangle_count");
    let nodes: Vec<NodeId> = (0..surface.node_bound()).filter(|&n| surface.exists(n)).collect();
    let check = |what: &str, is_active: &dyn Fn(NodeId) -> bool| {
        let mesh = surface.mesh_of(&is_active);
        // each node counted on top of those before it: one legal order of many
        let added: i64 = (nodes.iter().filter(|&&n| is_active(n)))
            .map(|&n| i64::from(surface.triangles_added(n, &|m: NodeId| m < n && is_active(m))))
            .sum();
        let (count, expected) = (mesh.triangles.len() as i64, base_count as i64 + added);
        assert_eq!(count, expected, "{what}: triangles against {base_count} of the base + {added} added");
        if let Err(defect) = check_conforming(&mesh, &base, kind) {
            panic!("{what}: {defect}");
        }
    };
    check("the base mesh", &|_| false);
    check("the full mesh", &|n| surface.exists(n));

    // thin fronts: what one node needs and no more
    for trial in 0..6 {
        let mut front = RandomFront::new(surface, seed.wrapping_add(trial));
        for _ in 0..=trial {
            for node in front.pick_with_ancestors() {
                front.take(Step::Refine(node));
            }
        }
        check(&describe("a thin front", &front, seed), &|n| front.is_active(n));
    }
    // wandering fronts, from nearly nothing to a good part of everything
    let mut front = RandomFront::new(surface, seed ^ 0x5EED);
    for share in [0.002, 0.02, 0.1, 0.4, 0.8] {
        let wanted = ((nodes.len() as f64 * share) as usize).max(1);
        front.wander(8 * nodes.len().max(8), wanted);
        check(&describe("a random front", &front, seed), &|n| front.is_active(n));
    }
    for _ in 0..front.len() / 2 {
        if let Some(node) = front.pick_coarsen() {
            front.take(Step::Coarsen(node));
        }
    }
    check(&describe("a shrunk front", &front, seed), &|n| front.is_active(n));
}

fn describe<H: Hierarchy>(what: &str, front: &RandomFront<'_, H>, seed: u64) -> String {
    let nodes = front.nodes();
    let first = &nodes[..nodes.len().min(12)];
    format!("{what} of {} nodes (seed {seed}; first {first:?})", nodes.len())
}
