//! A vertex's star laid flat, and what is left of it when the vertex moves onto a neighbour.
//!
//! Based on: Lee, Sweldens, Schröder, Cowsar, Dobkin, "MAPS: Multiresolution Adaptive Parameterization of Surfaces", 1998 (the map
//! z^a, which spreads the angles over the whole turn, or at a border over half of it).

use crate::collapse::stars::{Corner, Stars};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Neighbours that a vertex may have for its star to be laid flat.
pub(super) const MOST_NEIGHBOURS: usize = 40;

/// The widest angle of a flat triangle at the centre, as a share of half a turn.
const WIDEST: f64 = 0.97;

/// A vertex's neighbours counter-clockwise; at a border from one border edge to the other.
#[derive(Debug, Default)]
pub(super) struct Star {
    pub(super) ring: Vec<u32>,
    /// Triangle k has neighbours k and k + 1.
    pub(super) corners: Vec<Corner>,
    pub(super) is_closed: bool,
    /// The neighbours in the plane, the vertex at the origin; empty if they cannot be laid flat.
    pub(super) flat: Vec<[f64; 2]>,
    /// By how much angles grow when it is laid flat: above 1 where the surface ends in a point.
    pub(super) power: f64,
}

impl Star {
    /// Finds a vertex's neighbours in order.
    pub(super) fn find(&mut self, vertex: u32, stars: &Stars, triangles: &[[u32; 3]]) {
        self.ring.clear();
        self.corners.clear();
        self.flat.clear();
        let all = stars.of(vertex);
        let sides = |corner: &Corner| corner.turned(triangles);
        let begins = all.iter().find(|c| all.iter().all(|o| sides(o)[2] != sides(c)[1]));
        self.is_closed = begins.is_none();
        let Some(&begin) = begins.or(all.first()) else { return };
        let mut corner = begin;
        for _ in 0..all.len() {
            let [_, b, c] = sides(&corner);
            self.ring.push(b);
            self.corners.push(corner);
            match all.iter().find(|o| sides(o)[1] == c) {
                Some(&next) if next != begin => corner = next,
                Some(_) => break,
                None => {
                    self.ring.push(c);
                    break;
                }
            }
        }
    }

    /// Neighbour after neighbour k.
    pub(super) fn after(&self, k: usize) -> usize {
        (k + 1) % self.ring.len()
    }

    /// Lays the star flat; gives whether it can be.
    pub(super) fn flatten(&mut self, vertex: u32, positions: &[DVec3]) -> bool {
        self.flat.clear();
        let centre = positions[vertex as usize];
        let spokes: [DVec3; MOST_NEIGHBOURS] = std::array::from_fn(|k| match self.ring.get(k) {
            Some(&n) => positions[n as usize] - centre,
            None => DVec3::ZERO,
        });
        let spokes = &spokes[..self.ring.len()];
        let angle = |k: usize| spokes[k].angle_between(spokes[(k + 1) % spokes.len()]);
        let turn: f64 = (0..self.corners.len()).map(angle).sum();
        let mean: f64 = spokes.iter().map(|s| s.length()).sum::<f64>() / spokes.len() as f64;
        let power = if self.is_closed { TAU } else { PI } / turn;
        if !(power.is_finite() && mean > 0.0) {
            return false;
        }
        self.power = power;
        let mut at = 0.0;
        for k in 0..self.ring.len() {
            let radius = (spokes[k].length() / mean).powf(power);
            self.flat.push([radius * f64::cos(at), radius * f64::sin(at)]);
            if k < self.corners.len() {
                let wide = angle(k) * power;
                if !(wide > 1e-4 && wide < WIDEST * PI) {
                    self.flat.clear();
                    return false;
                }
                at += wide;
            }
        }
        self.flat.iter().all(|p| p[0].is_finite() && p[1].is_finite())
    }

    /// The triangles that stay when the vertex moves onto neighbour `k`: those that do not have it.
    pub(super) fn staying(&self, k: usize) -> impl Iterator<Item = usize> {
        let last = if self.is_closed { (k + self.ring.len() - 1) % self.ring.len() } else { k.wrapping_sub(1) };
        (0..self.corners.len()).filter(move |&t| t != k && t != last)
    }
}
