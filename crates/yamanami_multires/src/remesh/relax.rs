//! Evens a net out vertex by vertex, each going along the source towards the middle of its neighbours unless that folds. Our own.

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
            if is_chosen(v) && !net.is_pinned[v as usize] {
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
    let way = way(net, v, ring);
    let before = net.least_facing([at, normal], ring, true);
    for step in STEPS {
        let place = walk::trace(net.source, net.places[v as usize], way * step);
        let after = net.least_facing([net.source.position(place), net.source.normal(place)], ring, true);
        if after >= GOOD_FACING || after >= before {
            net.put(v, place);
            return;
        }
    }
}

/// The way to the middle of the neighbours, along the surface; farther ones pull more.
fn way(net: &Net<'_>, v: u32, ring: &[u32]) -> DVec3 {
    let (at, normal) = (net.positions[v as usize], net.normals[v as usize]);
    let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
    for &n in ring {
        let chord = net.positions[n as usize] - at;
        let length = net.length(v, n);
        sum += (chord - normal * normal.dot(chord)).normalize_or_zero() * (length * length);
        weights += length;
    }
    let weights = weights * net.source.density(net.places[v as usize]);
    if weights > 0.0 { sum / weights } else { DVec3::ZERO }
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

/// Moves the corners of folded triangles so many times, and those of what then still is folded again.
pub(super) fn unfold(net: &mut Net<'_>, rounds: usize) {
    let count = net.topology.vertex_count(net.level) as usize;
    let triangles = net.topology.triangles(net.level);
    for _ in 0..rounds {
        let mut is_bad = vec![false; count];
        let mut any = false;
        for t in &triangles {
            let at = [net.positions[t[0] as usize], net.normals[t[0] as usize]];
            if net.facing(at, [t[1], t[2]]) < 0.1 {
                any = true;
                t.iter().for_each(|&v| is_bad[v as usize] = true);
            }
        }
        if !any {
            break;
        }
        relax(net, 2, |v| is_bad[v as usize]);
    }
}
