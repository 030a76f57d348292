//! Closest point of a surface: a tree of boxes over the triangles of a mesh.
//!
//! Based on: Ericson, "Real-Time Collision Detection", 2005 (closest point of a triangle by Voronoi regions). The tree
//! is split at the median of the longest side of the centroids' box, so its shape depends on the mesh only.

use glam::DVec3;
use yamanami_core::{Aabb, TriangleMesh};

/// Triangles of a leaf.
const LEAF: usize = 4;

/// A mesh prepared for closest-point queries.
#[derive(Debug, Clone)]
pub struct SurfaceIndex {
    nodes: Vec<Node>,
    /// Corners of the triangles, in leaf order.
    triangles: Vec<[DVec3; 3]>,
    /// The mesh's number of each of them.
    numbers: Vec<u32>,
}

/// The point of a surface nearest to a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// Distance in metres.
    pub distance_m: f64,
    /// The point itself.
    pub point: DVec3,
    /// Number of the triangle it lies on.
    pub triangle: u32,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Aabb,
    /// First triangle of a leaf, or the right child of an inner node, whose left child follows it.
    first_or_right: u32,
    /// Triangles of a leaf; 0 for an inner node.
    count: u32,
}

impl SurfaceIndex {
    /// Builds the tree. Triangles with a corner that is not finite are left out.
    ///
    /// # Panics
    /// When a triangle names a vertex that the mesh does not have.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let finite = |t: &u32| mesh.corners(*t as usize).iter().all(|p| p.is_finite());
        let mut items: Vec<(DVec3, u32)> = (0..mesh.triangles.len() as u32)
            .filter(finite)
            .map(|t| (mesh.corners(t as usize).iter().sum::<DVec3>() / 3.0, t))
            .collect();
        let mut index = Self { nodes: Vec::new(), triangles: Vec::new(), numbers: Vec::new() };
        if !items.is_empty() {
            index.nodes.reserve(items.len());
            index.split(mesh, &mut items);
        }
        index
    }

    fn split(&mut self, mesh: &TriangleMesh, items: &mut [(DVec3, u32)]) {
        let node = self.nodes.len();
        self.nodes.push(Node { bounds: Aabb::EMPTY, first_or_right: 0, count: 0 });
        if items.len() <= LEAF {
            let mut bounds = Aabb::EMPTY;
            let first = self.triangles.len() as u32;
            for &(_, t) in items.iter() {
                let corners = mesh.corners(t as usize);
                corners.iter().for_each(|&p| bounds.include(p));
                self.triangles.push(corners);
                self.numbers.push(t);
            }
            self.nodes[node] = Node { bounds, first_or_right: first, count: items.len() as u32 };
            return;
        }
        let mut centroids = Aabb::EMPTY;
        items.iter().for_each(|&(c, _)| centroids.include(c));
        let size = centroids.max - centroids.min;
        let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
        let (left, right) = items.split_at_mut(middle);
        self.split(mesh, left);
        let right_node = self.nodes.len();
        self.split(mesh, right);
        let (l, r) = (self.nodes[node + 1].bounds, self.nodes[right_node].bounds);
        let bounds = Aabb { min: l.min.min(r.min), max: l.max.max(r.max) };
        self.nodes[node] = Node { bounds, first_or_right: right_node as u32, count: 0 };
    }

    /// The nearest point of the surface; `None` when it has no triangles or the query is not finite.
    pub fn closest(&self, query: DVec3) -> Option<Closest> {
        if self.nodes.is_empty() || !query.is_finite() {
            return None;
        }
        let mut best = (f64::INFINITY, DVec3::ZERO, 0);
        // the tree halves its items at each level: 32 levels hold more triangles than 32 bits can name
        let mut stack = [(0u32, 0f64); 64];
        stack[0] = (0, distance_squared(&self.nodes[0].bounds, query));
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (number, box_distance) = stack[depth];
            if box_distance >= best.0 {
                continue;
            }
            let node = &self.nodes[number as usize];
            if node.count > 0 {
                let first = node.first_or_right as usize;
                for k in first..first + node.count as usize {
                    let point = closest_of_triangle(query, self.triangles[k]);
                    let distance = query.distance_squared(point);
                    if distance < best.0 {
                        best = (distance, point, self.numbers[k]);
                    }
                }
                continue;
            }
            let mut children = [number + 1, node.first_or_right]
                .map(|child| (child, distance_squared(&self.nodes[child as usize].bounds, query)));
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            for child in children {
                if child.1 < best.0 {
                    stack[depth] = child;
                    depth += 1;
                }
            }
        }
        best.0.is_finite().then(|| Closest { distance_m: best.0.sqrt(), point: best.1, triangle: best.2 })
    }
}

fn distance_squared(bounds: &Aabb, p: DVec3) -> f64 {
    p.distance_squared(p.clamp(bounds.min, bounds.max))
}

/// The point of a triangle nearest to `p`.
fn closest_of_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (to_b, to_c) = (ab.dot(p - a), ac.dot(p - a));
    if to_b <= 0.0 && to_c <= 0.0 {
        return a;
    }
    let (b_along, b_across) = (ab.dot(p - b), ac.dot(p - b));
    if b_along >= 0.0 && b_across <= b_along {
        return b;
    }
    let (c_across, c_along) = (ab.dot(p - c), ac.dot(p - c));
    if c_along >= 0.0 && c_across <= c_along {
        return c;
    }
    let on_ab = to_b * b_across - b_along * to_c;
    if on_ab <= 0.0 && to_b >= 0.0 && b_along <= 0.0 {
        return a + ab * ratio(to_b, to_b - b_along);
    }
    let on_ac = c_across * to_c - to_b * c_along;
    if on_ac <= 0.0 && to_c >= 0.0 && c_along <= 0.0 {
        return a + ac * ratio(to_c, to_c - c_along);
    }
    let on_bc = b_along * c_along - c_across * b_across;
    let (from_b, from_c) = (b_across - b_along, c_across - c_along);
    if on_bc <= 0.0 && from_b >= 0.0 && from_c >= 0.0 {
        return b + (c - b) * ratio(from_b, from_b + from_c);
    }
    let scale = 1.0 / (on_bc + on_ac + on_ab);
    a + ab * (on_ac * scale) + ac * (on_ab * scale)
}

/// `part / whole`, 0 for a side without length.
fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-10.0..10.0f64).prop_map(DVec3::from)
    }

    /// Nearest point by trying a dense set of barycentric coordinates.
    fn slow_distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
        let mut best = f64::INFINITY;
        for i in 0..=60 {
            for j in 0..=60 - i {
                let (u, v) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                best = best.min(p.distance(a * (1.0 - u - v) + b * u + c * v));
            }
        }
        best
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn the_triangle_s_nearest_point_is_on_it_and_nearest(p in point(), t in prop::array::uniform3(point())) {
            let [a, b, c] = t;
            let nearest = closest_of_triangle(p, t);
            let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).length();
            let parts = area(nearest, a, b) + area(nearest, b, c) + area(nearest, c, a);
            prop_assert!(parts <= area(a, b, c) * (1.0 + 1e-9) + 1e-9);
            let slow = slow_distance(p, t);
            prop_assert!(p.distance(nearest) <= slow + 1e-9 && p.distance(nearest) >= slow - 0.6);
        }

        #[test]
        fn the_tree_finds_what_a_search_of_all_triangles_finds(
            p in point(),
            corners in prop::collection::vec(point(), 3..120),
        ) {
            let count = corners.len() as u32 / 3;
            let mesh = TriangleMesh {
                positions: corners,
                triangles: (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
                ..TriangleMesh::default()
            };
            let slow = (0..count as usize)
                .map(|t| p.distance(closest_of_triangle(p, mesh.corners(t))))
                .fold(f64::INFINITY, f64::min);
            let found = SurfaceIndex::new(&mesh).closest(p).unwrap();
            prop_assert!((found.distance_m - slow).abs() < 1e-12);
        }
    }

    #[test]
    fn an_empty_mesh_has_no_closest_point() {
        assert_eq!(SurfaceIndex::new(&TriangleMesh::default()).closest(DVec3::ZERO), None);
    }

    #[test]
    fn a_triangle_without_area_is_a_segment_or_a_point() {
        let p = DVec3::new(3.0, 4.0, 0.0);
        assert_eq!(closest_of_triangle(p, [DVec3::ZERO; 3]), DVec3::ZERO);
        let segment = [DVec3::ZERO, DVec3::X * 10.0, DVec3::X * 5.0];
        assert_eq!(closest_of_triangle(p, segment), DVec3::X * 3.0);
    }
}
