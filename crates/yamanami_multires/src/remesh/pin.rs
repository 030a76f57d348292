//! Pins at tips: where a mesh ends in a point, a vertex of the net is held there, or the net would slip off what stands out. Our
//! own.

use super::net::Net;
use super::source::Place;

/// A vertex at which the angles of the triangles around add up to less is a tip: half a turn less a bit.
const TIP_ANGLE: f64 = 0.95 * std::f64::consts::PI;

/// Moves to each tip of the mesh that the net lies on the nearest of its vertices, and holds it there.
pub(super) fn pin(net: &mut Net<'_>) {
    let source = net.source;
    let vertices = source.positions.len();
    let mut angles = vec![0.0; vertices];
    for (t, corners) in source.triangles().iter().enumerate() {
        let at = source.corners(t as u32);
        for k in 0..3 {
            angles[corners[k] as usize] += (at[(k + 1) % 3] - at[k]).angle_between(at[(k + 2) % 3] - at[k]);
        }
    }
    // for each tip the nearest vertex of the net in the triangles around
    let mut nearest = vec![(f64::INFINITY, u32::MAX); vertices];
    for v in 0..net.places.len() as u32 {
        for &tip in &source.triangles()[net.places[v as usize].triangle as usize] {
            let is_tip = angles[tip as usize] < TIP_ANGLE && !source.surface.is_on_border(tip);
            let distance = source.positions[tip as usize].distance_squared(net.positions[v as usize]);
            if is_tip && distance < nearest[tip as usize].0 {
                nearest[tip as usize] = (distance, v);
            }
        }
    }
    for (tip, &(_, v)) in nearest.iter().enumerate() {
        if v != u32::MAX && !net.is_pinned[v as usize] && !net.is_border(v) {
            let (triangle, corner) = source.surface.fan(tip as u32)[0];
            net.put(v, Place::corner(triangle, usize::from(corner)));
            net.is_pinned[v as usize] = true;
        }
    }
}
