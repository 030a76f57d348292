//! The vertices that are gone, kept by the triangle that now lies over them, to see how far below or above it they are.
//!
//! Idea: Ciampalini, Cignoni, Montani, Scopigno, "Multiresolution decimation based on global error", 1997.

use super::Way;
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
    pub(super) fn of_change(&self, net: &Net, way: &Way, mut visit: impl FnMut(u32, DVec3)) {
        let mut list = |corner: u32| {
            let mut p = self.head[corner as usize / 3];
            while p != NONE {
                visit(p, self.places[p as usize]);
                p = self.next[p as usize];
            }
        };
        net.corners(way.gone).for_each(&mut list);
        net.corners(way.kept).filter(|&c| !net.triangles[c as usize / 3].contains(&way.gone)).for_each(list);
        for v in [way.gone, way.kept] {
            if !self.is_listed[v as usize] {
                visit(v, self.places[v as usize]);
            }
        }
    }

    /// Puts points under triangles, of which these have others.
    pub(super) fn put(&mut self, triangles: impl Iterator<Item = u32>, points: &[(u32, u32)]) {
        for triangle in triangles {
            self.head[triangle as usize] = NONE;
        }
        for &(p, triangle) in points {
            self.is_listed[p as usize] = true;
            self.next[p as usize] = std::mem::replace(&mut self.head[triangle as usize], p);
        }
    }
}
