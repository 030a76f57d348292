//! The hierarchy's order and bounds, and the mesh of every front.

use super::build::{NodeData, Rtin, level_kind};
use super::diamonds::{Place, diamond};
use super::triangle::Triangle;
use std::collections::HashMap;
use yamanami_core::{
    ActiveSet, Hierarchy, MapView, NodeId, NodeList, Patch, Sink, Sphere, Surface, SurfaceVertex, TriangleMesh,
    VertexId,
};

/// Vertices of the base mesh come first; a node's vertex is this many after its number.
const BASE_VERTICES: u32 = 9;

impl Rtin {
    #[inline]
    fn node(&self, node: NodeId) -> (Place, &NodeData) {
        (self.diamonds.place(node), &self.data[node as usize])
    }

    /// The piece of ground that a node and its descendants change, and the longest edge in it in metres.
    #[inline]
    fn patch(&self, place: Place, data: &NodeData) -> (Patch, f64) {
        let k = (place[0] | place[1]).trailing_zeros();
        let shape = self.shapes[k as usize][level_kind(place, k)];
        let centre = self.ground.point_at(place, 0.0).truncate();
        let [low_m, high_m] = [data.low_m, data.high_m].map(f64::from);
        (Patch { centre, radius_m: shape.radius_m, low_m, high_m }, shape.edge_m)
    }

    fn vertex_id(&self, place: Place) -> VertexId {
        match self.diamonds.number(place) {
            Some(node) => BASE_VERTICES + node,
            None => {
                let [column, row] = place.map(|v| (v.signum() + 1) as u32);
                3 * row + column
            }
        }
    }

    fn node_vertex(&self, node: NodeId, place: Place) -> SurfaceVertex {
        let [a, b] = diamond(place).ends.map(|p| self.ground.height_m(p));
        let position = self.ground.point(place);
        SurfaceVertex {
            position,
            normal: self.ground.normal(place),
            detail_m: (position.z - 0.5 * (f64::from(a) + f64::from(b))) as f32,
            error_m: self.data[node as usize].error_m,
            bound_radius_m: self.bound(node).radius_m as f32,
            level: 1 + self.diamonds.depth(place),
            colour: [255; 3],
        }
    }

    fn base_vertex(&self, place: Place) -> SurfaceVertex {
        SurfaceVertex {
            position: self.ground.point(place),
            normal: self.ground.normal(place),
            detail_m: 0.0,
            error_m: f32::INFINITY,
            bound_radius_m: f32::INFINITY,
            level: 0,
            colour: [255; 3],
        }
    }

    fn base_places(&self) -> impl Iterator<Item = Place> {
        let h = self.diamonds.half_side();
        [-h, 0, h].into_iter().flat_map(move |y| [-h, 0, h].map(|x| [x, y]))
    }

    /// Goes through the triangles of a front; `split` hears of each applied node with its triangle, `shown` of each
    /// triangle that is shown.
    pub(super) fn walk<A: ActiveSet + ?Sized>(
        &self,
        start: &[Triangle],
        active: &A,
        mut split: impl FnMut(NodeId, &Triangle),
        mut shown: impl FnMut(&Triangle),
    ) {
        let mut open = start.to_vec();
        while let Some(t) = open.pop() {
            match self.diamonds.number(t.middle()).filter(|&n| active.is_active(n)) {
                Some(node) => {
                    split(node, &t);
                    open.extend(t.split());
                }
                None => shown(&t),
            }
        }
    }

    /// Takes away the whole or the split triangles of a diamond and puts the others in their place.
    fn replace(&self, place: Place, apply: bool, sink: &mut dyn Sink) {
        let d = diamond(place);
        let key = |middle: Place, apex: Place| Triangle::key(middle, apex);
        for apex in self.diamonds.apexes(&d) {
            let whole = upward([d.ends[0], d.ends[1], apex]);
            let halves = [upward([apex, d.ends[0], place]), upward([d.ends[1], apex, place])];
            let middle = |[a, b, _]: [Place; 3]| [(a[0] + b[0]) >> 1, (a[1] + b[1]) >> 1];
            if apply {
                sink.remove_triangle(key(place, apex));
                for half in halves {
                    sink.add_triangle(key(middle(half), place), half.map(|p| self.vertex_id(p)));
                }
            } else {
                for half in halves {
                    sink.remove_triangle(key(middle(half), place));
                }
                sink.add_triangle(key(place, apex), whole.map(|p| self.vertex_id(p)));
            }
        }
    }
}

/// The same triangle counter-clockwise, its longest edge first.
fn upward([a, b, c]: [Place; 3]) -> [Place; 3] {
    let side = |axis: usize, p: Place| (p[axis] - a[axis]).signum();
    // half of a square: the signs of its sides turn as the sides themselves do
    let [bx, by, cx, cy] = [side(0, b), side(1, b), c[0] - a[0], c[1] - a[1]];
    if i64::from(bx) * i64::from(cy) > i64::from(by) * i64::from(cx) { [a, b, c] } else { [b, a, c] }
}

impl Hierarchy for Rtin {
    fn node_bound(&self) -> NodeId {
        self.diamonds.bound()
    }

    fn exists(&self, node: NodeId) -> bool {
        node < self.diamonds.bound()
    }

    fn roots(&self) -> Vec<NodeId> {
        // the middles of the four diagonals
        (0..4).collect()
    }

    fn parents(&self, node: NodeId) -> NodeList {
        self.diamonds.parents(self.diamonds.place(node))
    }

    fn children(&self, node: NodeId) -> NodeList {
        self.diamonds.children(self.diamonds.place(node))
    }

    fn error_m(&self, node: NodeId) -> f32 {
        self.data[node as usize].error_m
    }

    fn bound(&self, node: NodeId) -> Sphere {
        let (place, data) = self.node(node);
        let (patch, _) = self.patch(place, data);
        // circles of the plane and ranges of height nest, and so do balls with both added
        let centre = patch.centre.extend(0.5 * (patch.low_m + patch.high_m));
        Sphere { centre, radius_m: patch.radius_m + 0.5 * (patch.high_m - patch.low_m) }
    }

    fn map_error_px(&self, node: NodeId, view: &MapView) -> f32 {
        let (place, data) = self.node(node);
        let (patch, edge_m) = self.patch(place, data);
        view.patch_error_px(&patch, f64::from(data.error_m), edge_m, f64::from(data.rise_m)) as f32
    }

    fn triangles_added(&self, node: NodeId, _active: &dyn ActiveSet) -> i32 {
        self.diamonds.apexes(&diamond(self.diamonds.place(node))).count() as i32
    }

    fn base_triangle_count(&self) -> usize {
        8
    }

    fn level(&self, node: NodeId) -> u32 {
        self.diamonds.depth(self.diamonds.place(node))
    }
}

impl Surface for Rtin {
    fn emit_base(&self, sink: &mut dyn Sink) {
        self.emit_front(&|_| false, sink);
    }

    fn refine(&self, node: NodeId, _active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let place = self.diamonds.place(node);
        sink.add_vertex(BASE_VERTICES + node, self.node_vertex(node, place));
        self.replace(place, true, sink);
    }

    fn coarsen(&self, node: NodeId, _active: &dyn ActiveSet, sink: &mut dyn Sink) {
        self.replace(self.diamonds.place(node), false, sink);
        sink.remove_vertex(BASE_VERTICES + node);
    }

    fn emit_front(&self, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        for place in self.base_places() {
            sink.add_vertex(self.vertex_id(place), self.base_vertex(place));
        }
        let mut shown = Vec::new();
        let base = Triangle::base(self.diamonds.half_side());
        let split = |node: NodeId, t: &Triangle| {
            // a vertex of two triangles comes with the one that owns it
            if t.owns_longest() {
                sink.add_vertex(BASE_VERTICES + node, self.node_vertex(node, t.middle()));
            }
        };
        self.walk(&base, active, split, |t| shown.push(t.corners));
        for corners in shown {
            let [a, b, apex] = corners;
            let middle = [(a[0] + b[0]) >> 1, (a[1] + b[1]) >> 1];
            sink.add_triangle(Triangle::key(middle, apex), corners.map(|p| self.vertex_id(p)));
        }
    }

    fn mesh_of(&self, active: &dyn ActiveSet) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        let mut index = HashMap::new();
        let mut open: Vec<[Place; 3]> = Triangle::base(self.diamonds.half_side()).map(|t| t.corners).to_vec();
        while let Some([a, b, c]) = open.pop() {
            let m = [0, 1].map(|axis| (a[axis] + b[axis]) / 2);
            if self.diamonds.number(m).is_some_and(|n| active.is_active(n)) {
                open.extend([[c, a, m], [b, c, m]]);
                continue;
            }
            mesh.triangles.push([a, b, c].map(|p| {
                *index.entry(p).or_insert_with(|| {
                    mesh.positions.push(self.ground.point(p));
                    mesh.normals.push(self.ground.normal(p));
                    mesh.positions.len() as u32 - 1
                })
            }));
        }
        mesh
    }
}
