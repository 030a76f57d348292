//! Evens a net out: each vertex goes along the source towards the middle of its neighbours.
//!
//! Idea: Guskov, Vidimče, Sweldens, Schröder, "Normal Meshes", 2000 (the parametrisation is smoothed before details are taken);
//! Alliez, Colin de Verdière, Devillers, Isenburg, "Isotropic surface remeshing", 2003 (centroids weighted by area).

use super::net::Net;
use super::walk;
use glam::DVec3;

/// A triangle that faces as its surroundings to this cosine is no fold; below it a move must not make it worse.
const GOOD_FACING: f64 = 0.5;

/// A smaller part of the way, if the whole of it would fold.
const STEPS: [f64; 3] = [1.0, 0.5, 0.2];

/// Moves the vertices that are chosen, one after the other, so many times.
pub(super) fn relax(net: &mut Net<'_>, rounds: usize, is_chosen: impl Fn(u32) -> bool) {
    let count = net.topology.vertex_count(net.level);
    let mut ring = Vec::new();
    for round in 0..rounds {
        for k in 0..count {
            // to and fro, so that what is even spreads both ways
            let v = if round % 2 == 0 { k } else { count - 1 - k };
            if is_chosen(v) {
                let is_closed = net.topology.ring(net.level, v, &mut ring);
                if is_closed {
                    relax_inside(net, v, &ring);
                } else if v >= net.topology.vertex_count(0) {
                    relax_border(net, v, &ring);
                }
            }
        }
    }
}

fn relax_inside(net: &mut Net<'_>, v: u32, ring: &[u32]) {
    let (at, normal) = (net.positions[v as usize], net.normals[v as usize]);
    let towards = middle(net, at, ring) - at;
    let along = towards - normal * normal.dot(towards);
    let before = net.least_facing([at, normal], ring, true);
    for step in STEPS {
        let found = walk::descend(net.source, net.places[v as usize], at + along * step);
        let there = [found.position, net.source.normal(found.place)];
        let after = net.least_facing(there, ring, true);
        if after >= GOOD_FACING || after >= before {
            net.put(v, found.place);
            return;
        }
    }
}

/// The middle of the triangles around, weighted by area, half and half with that of the neighbours.
fn middle(net: &Net<'_>, at: DVec3, ring: &[u32]) -> DVec3 {
    let (mut sum, mut area, mut plain) = (DVec3::ZERO, 0.0, DVec3::ZERO);
    for k in 0..ring.len() {
        let [b, c] = [ring[k], ring[(k + 1) % ring.len()]].map(|n| net.positions[n as usize]);
        let weight = (b - at).cross(c - at).length();
        sum += (at + b + c) * (weight / 3.0);
        area += weight;
        plain += b;
    }
    let plain = plain / ring.len() as f64;
    if area > 0.0 { (sum / area + plain) * 0.5 } else { plain }
}

fn relax_border(net: &mut Net<'_>, v: u32, ring: &[u32]) {
    let [Some(&first), Some(&last)] = [ring.first(), ring.last()] else { return };
    let middle = (net.positions[first as usize] + net.positions[last as usize]) * 0.5;
    let Some(found) = walk::descend_border(net.source, net.places[v as usize], middle) else { return };
    let before = net.least_facing([net.positions[v as usize], net.normals[v as usize]], ring, false);
    let after = net.least_facing([found.position, net.source.normal(found.place)], ring, false);
    if after >= GOOD_FACING || after >= before {
        net.put(v, found.place);
    }
}
