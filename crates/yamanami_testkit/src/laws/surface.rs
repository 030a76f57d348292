//! The law of emitting: a sink led along any way to a front holds that front.

use crate::conforming::bits;
use crate::front::{RandomFront, Step};
use crate::strict_sink::StrictSink;
use std::collections::BTreeSet;
use yamanami_core::{ActiveSet, NodeId, Surface, TriangleMesh};

/// Refining and undoing restores the sink exactly; every order of refinement to the same front gives an equal sink; the
/// sink's mesh is that of [`Surface::mesh_of`]; the sink's own promises are never broken.
///
/// # Panics
/// With the node and what differs, when it does not hold.
pub fn surface_law<S: Surface>(surface: &S, seed: u64) {
    let mut base = StrictSink::new();
    surface.emit_base(&mut base);
    assert_same_mesh("the base mesh", &base, &surface.mesh_of(&|_: NodeId| false));

    let mut front = RandomFront::new(surface, seed);
    let mut sink = base.clone();
    let total = (0..surface.node_bound()).filter(|&n| surface.exists(n)).count();
    // snapshots cost the size of the front, so only some steps are undone and redone
    let rounds = 12;
    for round in 0..rounds {
        if round % 3 == 2 {
            for node in front.pick_with_ancestors() {
                step(surface, &mut front, Step::Refine(node), &mut sink);
            }
        }
        for _ in 0..(total / rounds).clamp(1, 400) {
            let Some(next) = front.pick(0.75) else { break };
            step(surface, &mut front, next, &mut sink);
        }
        if let Some(node) = front.pick_refine() {
            there_and_back(surface, &mut front, node, &mut sink);
        }
        let what = format!("a front of {} nodes (seed {seed}, round {round})", front.len());
        assert_same_mesh(&what, &sink, &surface.mesh_of(&front));
        if round % 4 == 3 {
            order_law(surface, &mut front, &sink);
        }
    }
    while let Some(node) = front.pick_coarsen() {
        step(surface, &mut front, Step::Coarsen(node), &mut sink);
    }
    assert_equal("undoing everything", &sink, &base);
}

/// Takes one step on the front and on the sink, and checks the count of triangles.
pub(super) fn step<S: Surface>(surface: &S, front: &mut RandomFront<'_, S>, step: Step, sink: &mut StrictSink) {
    let before = sink.mirror.triangles.len() as i64;
    let node = match step {
        Step::Refine(node) | Step::Coarsen(node) => node,
    };
    let without = |n: NodeId| n != node && front.is_active(n);
    let promised = i64::from(surface.triangles_added(node, &without));
    let expected = match step {
        Step::Refine(_) => {
            surface.refine(node, &*front, sink);
            promised
        }
        Step::Coarsen(_) => {
            surface.coarsen(node, &*front, sink);
            -promised
        }
    };
    let gained = sink.mirror.triangles.len() as i64 - before;
    assert_eq!(gained, expected, "{step:?}: triangles gained against triangles_added");
    front.take(step);
}

fn there_and_back<S: Surface>(surface: &S, front: &mut RandomFront<'_, S>, node: NodeId, sink: &mut StrictSink) {
    let before = sink.clone();
    step(surface, front, Step::Refine(node), sink);
    step(surface, front, Step::Coarsen(node), sink);
    assert_equal(&format!("applying and undoing node {node}"), sink, &before);
}

/// Other ways to the same front: by number, and in a random order.
fn order_law<S: Surface>(surface: &S, front: &mut RandomFront<'_, S>, sink: &StrictSink) {
    for (name, order) in [("by number", front.nodes()), ("in random order", front.nodes_shuffled())] {
        let (other, _) = sink_of(surface, &order);
        assert_equal(&format!("the same {} nodes applied {name}", front.len()), &other, sink);
    }
}

/// Panics with the first difference of content.
pub(super) fn assert_equal(what: &str, got: &StrictSink, expected: &StrictSink) {
    if got == expected {
        return;
    }
    let (got, expected) = (&got.mirror, &expected.mirror);
    for id in got.vertices.keys().chain(expected.vertices.keys()) {
        let (a, b) = (got.vertices.get(id), expected.vertices.get(id));
        assert!(a == b, "{what}: vertex {id} is {a:?}, expected {b:?}");
    }
    for key in got.triangles.keys().chain(expected.triangles.keys()) {
        let (a, b) = (got.triangles.get(key), expected.triangles.get(key));
        assert!(a == b, "{what}: triangle {key} is {a:?}, expected {b:?}");
    }
    panic!("{what}: the use counts differ");
}

/// A triangle as its corners' positions, the least first, in their turning order.
type Corners = [[u64; 3]; 3];

fn triangle_set(mesh: &TriangleMesh) -> BTreeSet<Corners> {
    (0..mesh.triangles.len())
        .map(|t| {
            let mut corners = mesh.corners(t).map(|p| p.to_array().map(bits));
            let least = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
            corners.rotate_left(least);
            corners
        })
        .collect()
}

/// Panics unless the sink's triangles are the mesh's, corner by corner.
pub(super) fn assert_same_mesh(what: &str, sink: &StrictSink, mesh: &TriangleMesh) {
    let mirrored = sink.mirror.to_mesh();
    assert_eq!(
        mirrored.triangles.len(),
        mesh.triangles.len(),
        "{what}: triangles in the sink against those of mesh_of"
    );
    let (got, expected) = (triangle_set(&mirrored), triangle_set(mesh));
    let readable = |t: &Corners| t.map(|p| p.map(f64::from_bits));
    if let Some(extra) = got.difference(&expected).next() {
        panic!("{what}: the sink has the triangle {:?}, mesh_of has not", readable(extra));
    }
    if let Some(missing) = expected.difference(&got).next() {
        panic!("{what}: mesh_of has the triangle {:?}, the sink has not", readable(missing));
    }
}

/// Puts a front, given as parents before children, into a fresh sink.
pub(super) fn sink_of<'s, S: Surface>(surface: &'s S, nodes: &[NodeId]) -> (StrictSink, RandomFront<'s, S>) {
    let mut front = RandomFront::new(surface, 0);
    let mut sink = StrictSink::new();
    surface.emit_base(&mut sink);
    for &node in nodes {
        step(surface, &mut front, Step::Refine(node), &mut sink);
    }
    (sink, front)
}
