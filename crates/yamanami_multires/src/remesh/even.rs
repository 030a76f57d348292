//! Evens a net out over long ways: the vertices of a coarse level move towards the middle of their neighbours and take all finer
//! ones along. Lengths are measured along the net and moves go along the source, so that nothing cuts through a thin part or slips
//! off a thing that stands out.
//!
//! Idea: Guskov, Vidimče, Sweldens, Schröder, "Normal Meshes", 2000 (the parametrisation is smoothed before details are taken); the
//! coarse levels first, as multigrid methods have it.

use super::net::Net;
use super::source::Place;
use super::walk;
use glam::DVec3;
use rayon::prelude::*;

/// Share of the way that is gone at once.
const STEP: f64 = 0.6;

/// The longest move, in lengths of the shortest edge around.
const LONGEST: f64 = 0.35;

/// The same in lengths of the finest edges around: ways that begin side by side drift apart on a rough surface.
const LONGEST_FINE: f64 = 1.0;

/// Moves the whole net once so that the edges at a coarse level become more even.
pub(super) fn even(net: &mut Net<'_>, level: u32) {
    let moves = moves(net, level);
    let places: Vec<Place> = net
        .places
        .par_iter()
        .enumerate()
        .map(|(v, &at)| {
            if net.is_pinned[v] {
                at
            } else if net.is_border(v as u32) {
                walk::descend_border(net.source, at, net.positions[v] + moves[v]).map_or(at, |found| found.place)
            } else {
                walk::trace(net.source, at, moves[v])
            }
        })
        .collect();
    net.put_all(places);
}

/// How each vertex of the net moves.
fn moves(net: &Net<'_>, level: u32) -> Vec<DVec3> {
    let lengths = lengths(net, level);
    let topology = net.topology;
    let mut moves: Vec<DVec3> = (0..topology.vertex_count(level))
        .into_par_iter()
        .map_init(|| [Vec::new(), Vec::new()], |[near, between], v| own_move(net, level, v, &lengths, near, between))
        .collect();
    for finer in level + 1..=net.level {
        let new: Vec<DVec3> = topology
            .new_vertices(finer)
            .into_par_iter()
            .map(|v| {
                let [p, q] = topology
                    .parents(v)
                    .unwrap_or([v, v])
                    .map(|p| turned(moves[p as usize], net.normals[p as usize], net.normals[v as usize]));
                (p + q) * 0.5
            })
            .collect();
        moves.extend(new);
    }
    moves
}

/// The move of a vertex of the coarse level: towards the middle of its neighbours there, longer edges pulling more.
fn own_move(net: &Net<'_>, level: u32, v: u32, lengths: &[f64], near: &mut Vec<u32>, between: &mut Vec<u32>) -> DVec3 {
    let is_closed = net.topology.ring(net.level, v, near);
    if net.is_pinned[v as usize] || !is_closed && v < net.topology.vertex_count(0) {
        return DVec3::ZERO;
    }
    if level < net.level {
        net.topology.ring(level + 1, v, between);
    }
    let (at, normal) = (net.positions[v as usize], net.normals[v as usize]);
    let density = net.source.density(net.places[v as usize]);
    let (mut sum, mut weights, mut longest) = (DVec3::ZERO, 0.0, f64::INFINITY);
    let last = near.len() - 1;
    for k in 0..near.len() {
        if !is_closed && k != 0 && k != last {
            continue;
        }
        let chord = net.positions[near[k] as usize] - at;
        let along = (chord - normal * normal.dot(chord)).normalize_or_zero();
        let length = if level < net.level { lengths[between[k] as usize] } else { net.length(v, near[k]) };
        sum += along * (length * length);
        weights += length;
        longest = longest.min(LONGEST * length / density).min(LONGEST_FINE * chord.length());
    }
    let wanted = if weights > 0.0 { sum * (STEP / weights / density) } else { DVec3::ZERO };
    wanted.clamp_length_max(longest)
}

/// The length of each edge of the levels from `level` up to the last but one, measured along the net; at the number of its
/// midpoint.
fn lengths(net: &Net<'_>, level: u32) -> Vec<f64> {
    let topology = net.topology;
    let mut lengths = vec![0.0; net.positions.len()];
    for of in (level..net.level).rev() {
        let own: Vec<f64> = topology
            .new_vertices(of + 1)
            .into_par_iter()
            .map_init(
                || [Vec::new(), Vec::new()],
                |[ring, between], v| {
                    let Some(ends) = topology.parents(v) else { return 0.0 };
                    if of + 1 == net.level {
                        return ends.iter().map(|&e| net.length(e, v)).sum();
                    }
                    topology.ring(of + 1, v, ring);
                    topology.ring(of + 2, v, between);
                    let halves = ends.iter().filter_map(|&e| ring.iter().position(|&n| n == e));
                    halves.map(|k| lengths[between[k] as usize]).sum()
                },
            )
            .collect();
        let new = topology.new_vertices(of + 1);
        lengths[new.start as usize..new.end as usize].copy_from_slice(&own);
    }
    lengths
}

/// A vector across one normal, turned as the normal has to be to become the other one.
pub(super) fn turned(vector: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let cosine = from.dot(to);
    if cosine < -0.99 { DVec3::ZERO } else { vector - (from + to) * (vector.dot(to) / (1.0 + cosine)) }
}
