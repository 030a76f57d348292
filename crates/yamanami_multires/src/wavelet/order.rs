//! The partial order of a terrain's midpoints: parents, children, errors and bounds.
//!
//! The parents of a midpoint are the midpoints of the parent triangles at its edge: three where the edge lies inside one
//! parent, five where it is half an edge that two share.

use super::data::TerrainData;
use super::surface::{TerrainSurface, With, Without};
use super::template::ALL;
use super::triangle::adjacent;
use yamanami_core::{ActiveSet, Hierarchy, LatticeNode, NodeId, NodeList, Sphere};

impl<D: TerrainData> Hierarchy for TerrainSurface<D> {
    fn node_bound(&self) -> NodeId {
        self.numbers.bound()
    }

    fn exists(&self, node: NodeId) -> bool {
        node < self.numbers.bound() && self.numbers.exists(self.numbers.place(node))
    }

    fn roots(&self) -> Vec<NodeId> {
        let Some(level) = self.lattice().levels().checked_sub(1) else { return Vec::new() };
        let [nx, ny] = self.lattice().points(level);
        (0..ny)
            .flat_map(|y| (0..nx).map(move |x| LatticeNode { level, x, y }))
            .filter(|&n| self.numbers.exists(n))
            .map(|n| self.numbers.number(n))
            .collect()
    }

    fn parents(&self, node: NodeId) -> NodeList {
        let mut out = NodeList::new();
        let place = self.numbers.place(node);
        if place.level + 1 == self.lattice().levels() {
            return out;
        }
        for t in adjacent(place, self.lattice()).iter() {
            for m in t.parent().midpoints() {
                if self.numbers.exists(m) {
                    out.insert(self.numbers.number(m));
                }
            }
        }
        out
    }

    #[inline]
    fn parent_count(&self, node: NodeId) -> usize {
        let LatticeNode { level, x, y } = self.numbers.place(node);
        let [nx, ny] = self.lattice().points(level);
        if level + 1 == self.lattice().levels() {
            return 0;
        }
        if x == 0 || y == 0 || x + 4 >= nx || y + 4 >= ny {
            return self.parents(node).len();
        }
        // an edge inside a parent triangle has its three midpoints for parents, one shared by two parents all five
        let shared = match (x & 1, y & 1) {
            (1, 0) => y & 3 == 0,
            (0, 1) => x & 3 == 0,
            _ => (x ^ y) & 2 == 0,
        };
        if shared { 5 } else { 3 }
    }

    fn children(&self, node: NodeId) -> NodeList {
        let mut out = NodeList::new();
        let place = self.numbers.place(node);
        if place.level == 0 {
            return out;
        }
        for t in adjacent(place, self.lattice()).iter() {
            for child in t.children() {
                if child.exists(self.lattice()) {
                    for m in child.midpoints() {
                        if self.numbers.exists(m) {
                            out.insert(self.numbers.number(m));
                        }
                    }
                }
            }
        }
        out
    }

    fn error_m(&self, node: NodeId) -> f32 {
        let place = self.numbers.place(node);
        if self.data.is_resident(place) {
            return self.data.error(place).to_m();
        }
        // not known yet, but not above any parent's
        self.parents(node).iter().map(|&p| self.error_m(p)).fold(f32::INFINITY, f32::min)
    }

    fn bound(&self, node: NodeId) -> Sphere {
        let place = self.numbers.place(node);
        if !self.data.is_resident(place)
            && let Some(&parent) = self.parents(node).first()
        {
            return self.bound(parent);
        }
        Sphere { centre: self.position(place), radius_m: self.bound_radius_m[place.level as usize] }
    }

    #[inline]
    fn error_and_bound(&self, node: NodeId) -> (f32, Sphere) {
        let place = self.numbers.place(node);
        if !self.data.is_resident(place) {
            return (self.error_m(node), self.bound(node));
        }
        let bound = Sphere { centre: self.position(place), radius_m: self.bound_radius_m[place.level as usize] };
        (self.data.error(place).to_m(), bound)
    }

    fn triangles_added(&self, node: NodeId, active: &dyn ActiveSet) -> i32 {
        let place = self.numbers.place(node);
        let interior =
            !self.data.has_holes() && !self.is_clamped(LatticeNode { x: place.x + 1, y: place.y + 1, ..place });
        let triangles = adjacent(place, self.lattice());
        if interior {
            return triangles.len() as i32;
        }
        let (without, with) = (Without { set: active, node }, With { set: active, node });
        triangles
            .iter()
            .filter(|&&t| self.shown(t))
            .map(|&t| {
                let fine = match self.config(t, &with) {
                    ALL => self.existing_children(t).count() as i32,
                    config => self.template_len(t, config),
                };
                fine - self.template_len(t, self.config(t, &without))
            })
            .sum()
    }

    fn base_triangle_count(&self) -> usize {
        self.base_triangles().filter(|&t| self.shown(t)).count()
    }

    fn level(&self, node: NodeId) -> u32 {
        self.lattice().levels() - 1 - self.numbers.level(node)
    }

    fn is_resident(&self, node: NodeId) -> bool {
        self.data.is_resident(self.numbers.place(node))
    }
}
