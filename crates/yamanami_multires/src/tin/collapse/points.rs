//! The vertices that are gone, kept by the triangle that now lies over them, to see how far below or above it they are.
//!
//! Idea: Ciampalini, Cignoni, Montani, Scopigno, "Multiresolution decimation based on global error", 1997.

use super::area2;
use super::net::{NONE, Net};
use glam::DVec3;

/// Vertices gone, as lists by triangle.
#[derive(Debug)]
pub(super) struct Points {
    /// Where each vertex was at the start.
    places: Vec<DVec3>,
    head: Vec<u32>,
    next: Vec<u32>,
    is_listed: Vec<bool>,
}

/// A change of the net looked at before it is made: who goes, who stays, and where.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    pub(super) gone: u32,
    pub(super) kept: u32,
    pub(super) place: DVec3,
}

/// How well a point lies in a triangle: the least of its three coordinates there (at least 0 within), and the height there.
fn within(p: DVec3, [a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let (wa, wb, wc) = (area2(b, c, p), area2(c, a, p), area2(a, b, p));
    let sum = wa + wb + wc;
    (wa.min(wb).min(wc) / sum, (wa * a.z + wb * b.z + wc * c.z) / sum)
}

impl Points {
    pub(super) fn new(net: &Net) -> Self {
        let n = net.positions.len();
        Self {
            places: net.positions.clone(),
            head: vec![NONE; net.triangles.len()],
            next: vec![NONE; n],
            is_listed: vec![false; n],
        }
    }

    /// The points that a change concerns: those under the triangles around it, and its two vertices.
    pub(super) fn gather(&self, net: &Net, way: Way, out: &mut Vec<u32>) {
        out.clear();
        let mut list = |corner: u32| {
            let mut p = self.head[corner as usize / 3];
            while p != NONE {
                out.push(p);
                p = self.next[p as usize];
            }
        };
        net.corners(way.gone).for_each(&mut list);
        net.corners(way.kept).filter(|&c| !net.triangles[c as usize / 3].contains(&way.gone)).for_each(list);
        out.extend([way.gone, way.kept].into_iter().filter(|&v| !self.is_listed[v as usize]));
    }

    /// How far the points would be from the surface in height: the greatest square, and the area of the new triangles.
    pub(super) fn lift(&self, net: &Net, way: Way, points: &[u32], fan: &mut Vec<[DVec3; 3]>) -> (f64, f64) {
        let at = |v: u32| net.positions[v as usize];
        fan.clear();
        for (v, other) in [(way.gone, way.kept), (way.kept, way.gone)] {
            let stays = net.star(v).filter(|t| !t.contains(&other));
            fan.extend(stays.map(|[_, from, to]| [way.place, at(from), at(to)]));
        }
        let area = fan.iter().map(|&[a, b, c]| 0.5 * area2(a, b, c)).sum();
        let mut worst = 0.0f64;
        for &p in points {
            let p = self.places[p as usize];
            let (mut inside, mut height) = (f64::NEG_INFINITY, p.z);
            for &triangle in fan.iter() {
                let (w, z) = within(p, triangle);
                if w > inside {
                    (inside, height) = (w, z);
                    if w >= 0.0 {
                        break;
                    }
                }
            }
            // a point outside was on a line, which strays as far as that is allowed
            if inside >= -1e-9 {
                worst = worst.max((height - p.z) * (height - p.z));
            }
        }
        (worst, area)
    }

    /// Puts the gathered points under the triangles around `kept`, after the change.
    pub(super) fn put(&mut self, net: &Net, kept: u32, points: &[u32]) {
        for corner in net.corners(kept) {
            self.head[corner as usize / 3] = NONE;
        }
        for &p in points {
            let place = self.places[p as usize];
            self.is_listed[p as usize] = true;
            let (mut inside, mut best) = (f64::NEG_INFINITY, NONE);
            for corner in net.corners(kept) {
                let t = corner / 3;
                let (w, _) = within(place, net.triangles[t as usize].map(|v| net.positions[v as usize]));
                if w > inside {
                    (inside, best) = (w, t);
                    if w >= 0.0 {
                        break;
                    }
                }
            }
            if best != NONE {
                self.next[p as usize] = self.head[best as usize];
                self.head[best as usize] = p;
            }
        }
    }
}
