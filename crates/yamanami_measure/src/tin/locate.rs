//! Which triangle of a terrain surface lies under a point: a packed tree of boxes in plan.
//!
//! Based on: Kamel, Faloutsos, "On packing R-trees", 1993, with the Morton order in place of Hilbert's. The shape of the
//! tree depends on the mesh only, and it takes about nine bytes a triangle, however the triangles are spread. Sides of
//! edges are told exactly (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
//! predicates", 1997), so no point falls between two triangles that share an edge.

use super::overlay::overlap_m2;
use glam::DVec2;
use rayon::prelude::*;
use robust::{Coord, orient2d};
use yamanami_core::TriangleMesh;

/// Share of the area that shows its lower side from which on a mesh is taken for a solid.
const SOLID_SHARE: f64 = 0.1;
/// Share of the area that may be covered twice: surveys have slips of a few centimetres.
const TWICE_SHARE: f64 = 1e-6;
/// Triangles of a leaf, and children of a node.
const FAN: usize = 8;

/// An axis-aligned box in plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlanBox {
    pub(super) min: DVec2,
    pub(super) max: DVec2,
}

impl PlanBox {
    const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    pub(super) fn of(points: impl IntoIterator<Item = DVec2>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    fn join(self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether two boxes touch.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}

/// A terrain surface prepared for questions by place in plan.
#[derive(Debug, Clone)]
pub struct PlanIndex<'m> {
    mesh: &'m TriangleMesh,
    /// Triangles with an area in plan, in Morton order.
    order: Vec<u32>,
    /// Boxes of the leaves, then of each level above; the last is the root.
    boxes: Vec<PlanBox>,
    /// Where each level starts in `boxes`.
    levels: Vec<usize>,
}

impl<'m> PlanIndex<'m> {
    /// Sorts the triangles of a mesh by place.
    ///
    /// # Panics
    /// When a triangle names a vertex that the mesh does not have.
    pub fn new(mesh: &'m TriangleMesh) -> Self {
        let bounds = mesh
            .triangles
            .par_iter()
            .map(|t| {
                PlanBox::of(t.map(|i| mesh.positions[i as usize].truncate()).into_iter().filter(|p| p.is_finite()))
            })
            .reduce(|| PlanBox::EMPTY, |a, b| a.join(&b));
        let scale = f64::from(u32::MAX) / (bounds.max - bounds.min).max(DVec2::splat(f64::MIN_POSITIVE));
        let mut keyed: Vec<(u64, u32)> = (0..mesh.triangles.len() as u32)
            .into_par_iter()
            .filter(|&t| plan_turn(mesh, t) != 0.0)
            .map(|t| {
                let middle = mesh.corners(t as usize).iter().map(|p| (p.truncate() - bounds.min) / 3.0).sum::<DVec2>();
                let cell = middle * scale;
                (spread(cell.x as u32) | spread(cell.y as u32) << 1, t)
            })
            .collect();
        keyed.par_sort_unstable();
        let order: Vec<u32> = keyed.into_iter().map(|(_, t)| t).collect();

        let leaf = |run: &[u32]| PlanBox::of(run.iter().flat_map(|&t| plan_corners(mesh, t)));
        let mut boxes: Vec<PlanBox> = order.par_chunks(FAN).map(leaf).collect();
        let mut levels = vec![0];
        let mut start = 0;
        while boxes.len() - start > 1 {
            let above: Vec<PlanBox> =
                boxes[start..].chunks(FAN).map(|run| run.iter().fold(PlanBox::EMPTY, PlanBox::join)).collect();
            start = boxes.len();
            levels.push(start);
            boxes.extend(above);
        }
        Self { mesh, order, boxes, levels }
    }

    /// The mesh that was sorted.
    pub fn mesh(&self) -> &'m TriangleMesh {
        self.mesh
    }

    /// A triangle that holds a point of the plan, its border included; of several the one with the least number. `None`
    /// outside the surface, in its holes, and for a point that is not finite.
    pub fn triangle_at(&self, place: DVec2) -> Option<u32> {
        let mut found = None;
        let here = PlanBox { min: place, max: place };
        self.visit(
            |b| b.meets(&here),
            |t| {
                if found.is_none_or(|f| t < f) && holds(self.mesh, t, place) {
                    found = Some(t);
                }
            },
        );
        found
    }

    /// Whether the surface is 2.5D: nothing but a trace of its area is covered twice, seen from above.
    pub fn is_terrain(&self) -> bool {
        let areas = |up: bool| -> f64 {
            self.order.iter().map(|&t| plan_turn(self.mesh, t)).filter(|turn| (*turn > 0.0) == up).map(f64::abs).sum()
        };
        let (up, down) = (areas(true), areas(false));
        // a solid has as much of its area below as above: no need to look closer
        let (less, all) = (up.min(down), up + down);
        all > 0.0 && less < SOLID_SHARE * all && overlap_m2(self) <= TWICE_SHARE * all / 2.0
    }

    /// Calls `each` for the triangles of all leaves whose box passes `wanted`.
    pub(super) fn visit(&self, wanted: impl Fn(&PlanBox) -> bool, mut each: impl FnMut(u32)) {
        // eight children a level, eleven levels at most for triangles with 32-bit numbers
        let mut stack = [(0usize, 0usize); FAN * 12];
        let mut depth = 0;
        if !self.boxes.is_empty() {
            stack[0] = (self.levels.len() - 1, 0);
            depth = 1;
        }
        while depth > 0 {
            depth -= 1;
            let (level, number) = stack[depth];
            if !wanted(&self.boxes[self.levels[level] + number]) {
                continue;
            }
            let children = number * FAN..;
            if level == 0 {
                for &t in &self.order[children.start..self.order.len().min(children.start + FAN)] {
                    each(t);
                }
                continue;
            }
            let count = self.levels[level] - self.levels[level - 1];
            for child in (children.start..count.min(children.start + FAN)).rev() {
                stack[depth] = (level - 1, child);
                depth += 1;
            }
        }
    }
}

/// Every second bit.
fn spread(v: u32) -> u64 {
    let mut v = u64::from(v);
    v = (v | v << 16) & 0x0000_FFFF_0000_FFFF;
    v = (v | v << 8) & 0x00FF_00FF_00FF_00FF;
    v = (v | v << 4) & 0x0F0F_0F0F_0F0F_0F0F;
    v = (v | v << 2) & 0x3333_3333_3333_3333;
    (v | v << 1) & 0x5555_5555_5555_5555
}

/// On which side of the line from `a` to `b` the point `p` lies: positive on the left, the sign is exact.
pub(super) fn side(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(p))
}

/// Corners of a triangle in plan.
pub(super) fn plan_corners(mesh: &TriangleMesh, triangle: u32) -> [DVec2; 3] {
    mesh.corners(triangle as usize).map(|p| p.truncate())
}

/// Twice the plan area of a triangle, positive where it shows its upper side; 0 where a corner is not finite.
pub(super) fn plan_turn(mesh: &TriangleMesh, triangle: u32) -> f64 {
    let corners = mesh.corners(triangle as usize);
    if !corners.iter().all(|p| p.is_finite()) {
        return 0.0;
    }
    let [a, b, c] = corners.map(|p| p.truncate());
    side(a, b, c)
}

fn holds(mesh: &TriangleMesh, triangle: u32, p: DVec2) -> bool {
    let [a, b, c] = plan_corners(mesh, triangle);
    let sides = [side(a, b, p), side(b, c, p), side(c, a, p)];
    sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{rough, shifted};
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn the_tree_finds_what_a_search_of_all_triangles_finds(
            corners in prop::collection::vec((0.0..9.0f64, 0.0..9.0f64), 3..90),
            place in (-1.0..10.0f64, -1.0..10.0f64),
        ) {
            let positions: Vec<DVec3> = corners.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
            let triangles = (0..positions.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
            let mesh = TriangleMesh::new(positions, triangles);
            let place = DVec2::from(place);
            let slow = (0..mesh.triangles.len() as u32).find(|&t| holds(&mesh, t, place));
            prop_assert_eq!(PlanIndex::new(&mesh).triangle_at(place), slow);
        }

        #[test]
        fn no_point_falls_between_triangles(seed in any::<u64>(), t in 0.0..1.0f64) {
            for mesh in [rough(9, seed), shifted(rough(9, seed))] {
                let index = PlanIndex::new(&mesh);
                for k in 0..mesh.triangles.len() {
                    let [a, b, c] = mesh.corners(k).map(|p| p.truncate());
                    // rounded onto either side of an edge, or off the border of the whole
                    let inner = |p: DVec2| {
                        let [lo, hi] = [mesh.bounds().min.truncate(), mesh.bounds().max.truncate()];
                        p.cmpge(lo).all() && p.cmple(hi).all()
                    };
                    for p in [a, b, c, a.lerp(b, t), b.lerp(c, t), c.lerp(a, t)] {
                        prop_assert!(!inner(p) || index.triangle_at(p).is_some(), "{p}");
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_lies_outside_in_holes_or_on_upright_faces() {
        let positions = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 0.0, 9.0], [f64::NAN; 3]];
        let positions: Vec<DVec3> = positions.into_iter().map(DVec3::from).collect();
        let mesh = TriangleMesh::new(positions, vec![[0, 1, 3], [0, 1, 4], [0, 1, 2]]);
        let index = PlanIndex::new(&mesh);
        assert_eq!(index.triangle_at(DVec2::new(2.0, 0.0)), Some(2));
        assert_eq!(index.triangle_at(DVec2::new(2.0, 2.0)), Some(2));
        assert_eq!(index.triangle_at(DVec2::new(2.0, 2.1)), None);
        assert_eq!(index.triangle_at(DVec2::NAN), None);
        assert_eq!(PlanIndex::new(&TriangleMesh::default()).triangle_at(DVec2::ZERO), None);
    }

    #[test]
    fn surfaces_that_cover_a_place_twice_are_told() {
        let flat = rough(6, 1);
        assert!(PlanIndex::new(&flat).is_terrain());
        assert!(PlanIndex::new(&shifted(rough(12, 7))).is_terrain());
        let mut twice = flat.clone();
        twice.triangles.push(flat.triangles[3]);
        assert!(!PlanIndex::new(&twice).is_terrain());
        let mut solid = flat.clone();
        solid.triangles.extend(flat.triangles.iter().map(|&[a, b, c]| [a, c, b]));
        assert!(!PlanIndex::new(&solid).is_terrain() && !PlanIndex::new(&TriangleMesh::default()).is_terrain());
        let mut folded = flat;
        folded.triangles[0].swap(0, 1);
        assert!(PlanIndex::new(&folded).is_terrain(), "which side is up is another matter");
    }
}
