//! One level more: each new vertex is predicted from the level below and put where a line through the prediction, along its
//! normal, pierces the source. What then is to be coded is one number, the height above the prediction.
//!
//! Based on: Guskov, Vidimče, Sweldens, Schröder, "Normal Meshes", 2000.

use super::net::Net;
use super::predict::Rings;
use super::source::{Place, vertex_normals};
use super::walk;
use glam::DVec3;
use rayon::prelude::*;

/// How far the piercing point may be from the point nearest to the prediction, in lengths of the edge that is split.
const FARTHEST: f64 = 0.5;

/// The least cosine between the line and the source's normal where it pierces.
const LEAST_COSINE: f64 = 0.35;

/// Adds a level. `fine` is the net that the parametrisation made, of the same level or finer where there is one. Gives for each new vertex whether it is
/// displaced along its normal alone.
pub(super) fn refine(net: &mut Net<'_>, fine: &Net<'_>) -> Vec<bool> {
    let (topology, level) = (net.topology, net.level);
    let facets = vertex_normals(&net.positions, &topology.triangles(level));
    let below: &Net<'_> = net;
    let new: Vec<(Place, bool)> = topology
        .new_vertices(level + 1)
        .into_par_iter()
        .map_init(Rings::default, |rings, v| match topology.parents(v) {
            Some(ends) => place(below, fine, rings, v, ends, &facets),
            None => (below.places[v as usize], false),
        })
        .collect();
    let (places, is_normal): (Vec<Place>, Vec<bool>) = new.into_iter().unzip();
    net.add_level(&places);
    is_normal
}

/// Adds a level whose vertices lie half way between their neighbours, going over the surface.
pub(super) fn halve(net: &mut Net<'_>) {
    let (topology, source) = (net.topology, net.source);
    let half_way = |v: u32| {
        let ends = topology.parents(v).unwrap_or([v, v]);
        let at = ends.map(|e| net.positions[e as usize]);
        let from = ends.map(|e| net.places[e as usize]);
        if net.is_border(v) {
            let found = from.map(|from| walk::descend_border(source, from, (at[0] + at[1]) * 0.5));
            let nearest = found.into_iter().flatten().min_by(|p, q| p.distance2.total_cmp(&q.distance2));
            return nearest.map_or(from[0], |found| found.place);
        }
        let gone = [0, 1].map(|k| {
            let (chord, normal) = (at[1 - k] - at[k], net.normals[ends[k] as usize]);
            let along = (chord - normal * normal.dot(chord)).normalize_or_zero();
            walk::trace(source, from[k], along * (0.5 * chord.length()))
        });
        let middle = (source.position(gone[0]) + source.position(gone[1])) * 0.5;
        let [p, q] = gone.map(|from| walk::descend(source, from, middle));
        if p.distance2 <= q.distance2 { p.place } else { q.place }
    };
    let places: Vec<Place> = topology.new_vertices(net.level + 1).into_par_iter().map(half_way).collect();
    net.add_level(&places);
}

fn place(
    net: &Net<'_>,
    fine: &Net<'_>,
    rings: &mut Rings,
    vertex: u32,
    ends: [u32; 2],
    facets: &[DVec3],
) -> (Place, bool) {
    let source = net.source;
    let predicted = rings.predict(net.topology, net.level, ends, &net.positions);
    let [p, q] = ends.map(|v| net.positions[v as usize]);
    // where the parametrisation would have it, seen from where its parents have come to lie
    let (from, expected) = match fine.places.get(vertex as usize) {
        Some(&place) => {
            let [a, b] = ends.map(|v| net.positions[v as usize] - fine.positions[v as usize]);
            (place, fine.positions[vertex as usize] + (a + b) * 0.5)
        }
        None => (net.places[ends[0] as usize], (p + q) * 0.5),
    };
    if net.is_border(vertex) {
        let found = walk::descend_border(source, from, predicted);
        return (found.map_or(from, |f| f.place), false);
    }
    let expected = walk::descend(source, from, expected);
    let near = walk::descend(source, expected.place, predicted);
    let normal = ends.iter().map(|&v| facets[v as usize]).sum::<DVec3>().normalize_or_zero();
    let farthest2 = FARTHEST * FARTHEST * p.distance_squared(q);
    let pierced = walk::pierce(source, near.place.triangle, predicted, normal).filter(|found| {
        found.position.distance_squared(expected.position) <= farthest2
            && source.normal(found.place).dot(normal) >= LEAST_COSINE
    });
    match pierced {
        Some(found) => (found.place, true),
        None => (expected.place, false),
    }
}
