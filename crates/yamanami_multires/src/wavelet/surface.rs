//! The terrain surface: hierarchy and mesh of every front, over heights in memory or by pages.

use super::data::{GridData, TerrainData};
use super::nodes::NodeNumbers;
use super::template::{ALL, Config, TEMPLATES};
use super::triangle::{Triangle, adjacent, doubled_area, edge_ends};
use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::{
    ActiveSet, GeoReference, Hierarchy, Lattice, LatticeNode, NodeId, Sink, Surface, SurfaceVertex, TriangleKey,
    TriangleMesh, VertexId,
};

/// A terrain as a multiresolution surface.
#[derive(Debug, Clone)]
pub struct TerrainSurface<D> {
    pub(super) numbers: NodeNumbers,
    pub(super) data: D,
    geo: GeoReference,
    /// By level, 0 = finest.
    pub(super) bound_radius_m: Vec<f64>,
    /// Offset of each level's triangles in the triangle keys, by level.
    first_triangle: Vec<u64>,
}

/// Directions, in lattice steps, of the six edges that meet at a vertex.
const STAR: [(i64, i64); 6] = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1)];

impl<D: TerrainData> TerrainSurface<D> {
    /// Puts a surface together; `bound_radius_m` has one radius a level below the base, finest first.
    pub fn new(numbers: NodeNumbers, data: D, geo: GeoReference, bound_radius_m: Vec<f64>) -> Self {
        let lattice = numbers.lattice();
        let mut next = 0u64;
        let first_triangle = (0..=lattice.levels())
            .map(|level| {
                let [nx, ny] = lattice.squares(level).map(u64::from);
                let first = next;
                next += 2 * nx * ny;
                first
            })
            .collect();
        Self { numbers, data, geo, bound_radius_m, first_triangle }
    }

    /// Heights and errors.
    pub fn data(&self) -> &D {
        &self.data
    }

    /// Heights and errors, to load or drop pages.
    pub fn data_mut(&mut self) -> &mut D {
        &mut self.data
    }

    /// The same surface over other data.
    pub fn map_data<E: TerrainData>(self, map: impl FnOnce(D) -> E) -> TerrainSurface<E> {
        let Self { numbers, data, geo, bound_radius_m, first_triangle } = self;
        TerrainSurface { numbers, data: map(data), geo, bound_radius_m, first_triangle }
    }

    /// Node numbers and lattice.
    pub fn numbers(&self) -> &NodeNumbers {
        &self.numbers
    }

    /// Where the grid lies.
    pub fn geo(&self) -> &GeoReference {
        &self.geo
    }

    /// Radius of the bounds of each level's nodes, finest first, metres.
    pub fn bound_radius_m(&self) -> &[f64] {
        &self.bound_radius_m
    }

    pub(super) fn lattice(&self) -> &Lattice {
        self.numbers.lattice()
    }

    pub(super) fn position(&self, node: LatticeNode) -> DVec3 {
        let [column, row] = self.lattice().sample(node.level, node.x, node.y);
        let [x, y] = self.geo.local_from_grid(f64::from(column), f64::from(row));
        DVec3::new(x, y, f64::from(self.data.height_m(node)))
    }

    fn vertex_id(&self, sample: [u32; 2]) -> VertexId {
        sample[1] * self.lattice().width() + sample[0]
    }

    pub(super) fn shown(&self, t: Triangle) -> bool {
        self.data.shown(t.level, t.x, t.y, t.half)
    }

    /// The active midpoints of a triangle; [`ALL`] when all that exist are.
    pub(super) fn config(&self, t: Triangle, active: &dyn ActiveSet) -> Config {
        if t.level == 0 {
            return 0;
        }
        let (mut config, mut missing) = (0, false);
        for (bit, m) in t.midpoints().into_iter().enumerate() {
            if self.numbers.exists(m) {
                if active.is_active(self.numbers.number(m)) {
                    config |= 1 << bit;
                } else {
                    missing = true;
                }
            }
        }
        if missing { config } else { ALL }
    }

    /// Calls `f` with key and corners of each triangle that draws `t` in a configuration short of [`ALL`].
    fn for_template(&self, t: Triangle, config: Config, mut f: impl FnMut(TriangleKey, [[u32; 2]; 3])) {
        let lattice = self.lattice();
        let [nx, _] = lattice.squares(t.level).map(u64::from);
        let index =
            self.first_triangle[t.level as usize] + 2 * (u64::from(t.y) * nx + u64::from(t.x)) + u64::from(t.half);
        if config == 0 {
            // an existing triangle is never degenerate as a whole
            f(index * 4, t.corner_samples(lattice));
            return;
        }
        let points = t.points().map(|n| lattice.sample(n.level, n.x, n.y));
        let clamped = t.is_clamped(lattice);
        for (slot, roles) in (0u64..).zip(TEMPLATES[config]) {
            let corners = roles.map(|role| points[role]);
            if !clamped || doubled_area(corners) != 0 {
                f(index * 4 + slot, corners);
            }
        }
    }

    pub(super) fn template_len(&self, t: Triangle, config: Config) -> i32 {
        let mut n = 0;
        self.for_template(t, config, |_, _| n += 1);
        n
    }

    pub(super) fn existing_children(&self, t: Triangle) -> impl Iterator<Item = Triangle> {
        t.children().into_iter().filter(|c| c.exists(self.lattice()) && self.shown(*c))
    }

    /// Whether a midpoint is a vertex of its own; clamped, it may coincide with an end of its edge.
    fn has_vertex(&self, node: LatticeNode) -> bool {
        let at = |n: LatticeNode| self.lattice().sample(n.level, n.x, n.y);
        edge_ends(node).into_iter().all(|end| at(end) != at(node))
    }

    /// Unit normal at a lattice point from its neighbours on that level.
    fn normal(&self, node: LatticeNode) -> [f32; 3] {
        let [gx, gy] = self.data.gradient(node);
        let spacing = f64::from(1u32 << node.level);
        let n = DVec3::new(-gx / (spacing * self.geo.step_m[0]), gy / (spacing * self.geo.step_m[1]), 1.0).normalize();
        n.as_vec3().to_array()
    }

    /// A midpoint's vertex, shaded at the finest level `shade_level` of the front around it.
    fn midpoint_vertex(&self, node: LatticeNode, shade_level: u32) -> SurfaceVertex {
        let ends = edge_ends(node).map(|end| self.data.height_m(end));
        let z = self.data.height_m(node);
        SurfaceVertex {
            position: self.position(node),
            normal: self.normal(refine_place(node, shade_level)),
            detail_m: 0.5 * ((z - ends[0]) + (z - ends[1])),
            error_m: self.data.error(node).to_m(),
            bound_radius_m: self.bound_radius_m[node.level as usize] as f32,
            level: self.lattice().levels() - node.level,
            colour: [255; 3],
        }
    }

    fn base_vertex(&self, node: LatticeNode, shade_level: u32) -> SurfaceVertex {
        SurfaceVertex {
            position: self.position(node),
            normal: self.normal(refine_place(node, shade_level)),
            detail_m: 0.0,
            error_m: f32::INFINITY,
            bound_radius_m: f32::INFINITY,
            level: 0,
            colour: [255; 3],
        }
    }

    fn vertex(&self, node: LatticeNode, shade_level: u32) -> SurfaceVertex {
        if node.level == self.lattice().levels() {
            self.base_vertex(node, shade_level)
        } else {
            self.midpoint_vertex(node, shade_level)
        }
    }

    /// Whether any midpoint on the six edges of a level that meet at a point is active.
    fn star_is_refined(&self, point: LatticeNode, active: &dyn ActiveSet, except: NodeId) -> bool {
        STAR.into_iter().any(|(dx, dy)| {
            let (x, y) = (i64::from(point.x) + dx, i64::from(point.y) + dy);
            let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return false };
            let m = LatticeNode { x, y, ..point };
            self.numbers.exists(m) && {
                let number = self.numbers.number(m);
                number != except && active.is_active(number)
            }
        })
    }

    /// Shades the ends of a midpoint's edge anew when it is the first, or was the last, of its level around them.
    fn reshade_ends(&self, node: LatticeNode, active: &dyn ActiveSet, applied: bool, sink: &mut dyn Sink) {
        let number = self.numbers.number(node);
        for end in edge_ends(node) {
            if self.is_folded(end) || self.star_is_refined(end, active, number) {
                continue;
            }
            let own = own_place(end, self.lattice().levels());
            let mut shade_level = node.level;
            if !applied {
                shade_level += 1;
                while shade_level < own.level
                    && !self.star_is_refined(refine_place(own, shade_level), active, NodeId::MAX)
                {
                    shade_level += 1;
                }
            }
            let sample = self.lattice().sample(end.level, end.x, end.y);
            sink.update_vertex(self.vertex_id(sample), self.vertex(own, shade_level));
        }
    }

    /// Whether a point lies on a last column or row that base squares reach past: lattice points of several levels share
    /// such a place, and its vertex keeps the shading of the level that brought it.
    fn is_folded(&self, point: LatticeNode) -> bool {
        let lattice = self.lattice();
        let folded = |k: u32, size: u32| {
            u64::from(k) << point.level >= u64::from(size - 1) && !(size - 1).is_multiple_of(1 << lattice.levels())
        };
        folded(point.x, lattice.width()) || folded(point.y, lattice.height())
    }

    pub(super) fn is_clamped(&self, point: LatticeNode) -> bool {
        u64::from(point.x) << point.level > u64::from(self.lattice().width() - 1)
            || u64::from(point.y) << point.level > u64::from(self.lattice().height() - 1)
    }

    pub(super) fn base_triangles(&self) -> impl Iterator<Item = Triangle> {
        let level = self.lattice().levels();
        let [nx, ny] = self.lattice().squares(level);
        (0..ny).flat_map(move |y| (0..nx).flat_map(move |x| (0..2).map(move |half| Triangle { level, x, y, half })))
    }

    /// Emits what changes around a midpoint between configurations without and with it.
    fn replace(&self, node: LatticeNode, active: &dyn ActiveSet, apply: bool, sink: &mut dyn Sink) {
        let without = Without { set: active, node: self.numbers.number(node) };
        let with = With { set: active, node: self.numbers.number(node) };
        for &t in adjacent(node, self.lattice()).iter() {
            if !self.shown(t) {
                continue;
            }
            let coarse = self.config(t, &without);
            let fine = self.config(t, &with);
            let emit_coarse = |sink: &mut dyn Sink, add: bool| {
                self.for_template(t, coarse, |key, corners| self.put(key, corners, add, sink));
            };
            let emit_fine = |sink: &mut dyn Sink, add: bool| {
                if fine == ALL {
                    for child in self.existing_children(t) {
                        self.for_template(child, 0, |key, corners| self.put(key, corners, add, sink));
                    }
                } else {
                    self.for_template(t, fine, |key, corners| self.put(key, corners, add, sink));
                }
            };
            if apply {
                emit_coarse(sink, false);
                emit_fine(sink, true);
            } else {
                emit_fine(sink, false);
                emit_coarse(sink, true);
            }
        }
    }

    /// A vertex of a front with the shading that the steps to it would have left.
    fn shaded_vertex(&self, node: LatticeNode, active: &dyn ActiveSet) -> SurfaceVertex {
        let mut shade_level = node.level;
        if !self.is_folded(node) {
            while shade_level > 0 && self.star_is_refined(refine_place(node, shade_level - 1), active, NodeId::MAX) {
                shade_level -= 1;
            }
        }
        self.vertex(node, shade_level)
    }

    fn put(&self, key: TriangleKey, corners: [[u32; 2]; 3], add: bool, sink: &mut dyn Sink) {
        if add {
            sink.add_triangle(key, corners.map(|s| self.vertex_id(s)));
        } else {
            sink.remove_triangle(key);
        }
    }

    fn walk(&self, t: Triangle, active: &dyn ActiveSet, out: &mut dyn FnMut([[u32; 2]; 3])) {
        if !self.shown(t) {
            return;
        }
        let config = self.config(t, active);
        if config == ALL {
            for child in t.children() {
                if child.exists(self.lattice()) {
                    self.walk(child, active, out);
                }
            }
        } else {
            self.for_template(t, config, |_, corners| out(corners));
        }
    }
}

pub(super) struct Without<'a> {
    pub(super) set: &'a dyn ActiveSet,
    pub(super) node: NodeId,
}

impl ActiveSet for Without<'_> {
    fn is_active(&self, node: NodeId) -> bool {
        node != self.node && self.set.is_active(node)
    }
}

pub(super) struct With<'a> {
    pub(super) set: &'a dyn ActiveSet,
    pub(super) node: NodeId,
}

impl ActiveSet for With<'_> {
    fn is_active(&self, node: NodeId) -> bool {
        node == self.node || self.set.is_active(node)
    }
}

/// The same point on a finer level's lattice.
fn refine_place(node: LatticeNode, level: u32) -> LatticeNode {
    let up = node.level - level.min(node.level);
    LatticeNode { level: node.level - up, x: node.x << up, y: node.y << up }
}

/// The coarsest level on which an unclamped point is a lattice point.
fn own_place(point: LatticeNode, levels: u32) -> LatticeNode {
    let up = (point.x | point.y).trailing_zeros().min(levels - point.level);
    LatticeNode { level: point.level + up, x: point.x >> up, y: point.y >> up }
}

impl<D: TerrainData> Surface for TerrainSurface<D> {
    fn emit_base(&self, sink: &mut dyn Sink) {
        self.emit_front(&|_| false, sink);
    }

    fn emit_front(&self, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let level = self.lattice().levels();
        let [nx, ny] = self.lattice().points(level);
        for (y, x) in (0..ny).flat_map(|y| (0..nx).map(move |x| (y, x))) {
            let node = LatticeNode { level, x, y };
            sink.add_vertex(self.vertex_id(self.lattice().sample(level, x, y)), self.shaded_vertex(node, active));
        }
        let mut open: Vec<Triangle> = self.base_triangles().collect();
        let mut drawn = Vec::new();
        while let Some(t) = open.pop() {
            let config = self.config(t, active);
            if t.level > 0 && config != 0 {
                for (bit, m) in t.midpoints().into_iter().enumerate() {
                    // a midpoint of two triangles comes with the first
                    let own = config & 1 << bit != 0 && self.numbers.exists(m) && adjacent(m, self.lattice())[0] == t;
                    if own && self.has_vertex(m) {
                        let id = self.vertex_id(self.lattice().sample(m.level, m.x, m.y));
                        sink.add_vertex(id, self.shaded_vertex(m, active));
                    }
                }
            }
            if config == ALL {
                open.extend(t.children().into_iter().filter(|c| c.exists(self.lattice())));
            } else if self.shown(t) {
                drawn.push((t, config));
            }
        }
        for (t, config) in drawn {
            self.for_template(t, config, |key, corners| self.put(key, corners, true, sink));
        }
    }

    fn refine(&self, node: NodeId, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let place = self.numbers.place(node);
        if self.has_vertex(place) {
            let sample = self.lattice().sample(place.level, place.x, place.y);
            sink.add_vertex(self.vertex_id(sample), self.midpoint_vertex(place, place.level));
        }
        self.replace(place, active, true, sink);
        self.reshade_ends(place, active, true, sink);
    }

    fn coarsen(&self, node: NodeId, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let place = self.numbers.place(node);
        self.replace(place, active, false, sink);
        self.reshade_ends(place, active, false, sink);
        if self.has_vertex(place) {
            let sample = self.lattice().sample(place.level, place.x, place.y);
            sink.remove_vertex(self.vertex_id(sample));
        }
    }

    fn mesh_of(&self, active: &dyn ActiveSet) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        let mut index: HashMap<[u32; 2], u32> = HashMap::new();
        let mut samples = Vec::new();
        for t in self.base_triangles() {
            self.walk(t, active, &mut |corners| {
                mesh.triangles.push(corners.map(|sample| {
                    *index.entry(sample).or_insert_with(|| {
                        samples.push(sample);
                        samples.len() as u32 - 1
                    })
                }));
            });
        }
        for [column, row] in samples {
            let [x, y] = self.geo.local_from_grid(f64::from(column), f64::from(row));
            let z = self.data.sample_height_m(column, row);
            mesh.positions.push(DVec3::new(x, y, f64::from(z)));
        }
        mesh
    }
}

impl TerrainSurface<GridData> {
    /// Mesh of all nodes with an error above the tolerance: the fewest triangles that this hierarchy promises it with.
    pub fn mesh_at_tolerance(&self, tolerance_m: f32) -> TriangleMesh {
        self.mesh_of(&|node| self.error_m(node) > tolerance_m)
    }
}
