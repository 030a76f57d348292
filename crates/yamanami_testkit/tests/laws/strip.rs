//! The smallest surface that has everything a law speaks of: two fans on either side of a line that is halved.
//!
//! A node halves an interval of the line; its parents are the interval above and that one's nearer neighbour, so that
//! neighbours differ by one level at most. Each fan has one triangle an interval. [`Fault`] breaks one contract at a time.

use glam::DVec3;
use yamanami_core::{
    ActiveSet, Hierarchy, MeshMirror, NodeId, NodeList, Sink, Sphere, Surface, SurfaceVertex, TriangleMesh, VertexId,
};

/// What is wrong with a strip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    None,
    /// One deep node has a larger error than its parents.
    Error,
    /// One deep node has a bound that sticks out.
    Bound,
    /// A node is left out of its second parent's children.
    Children,
    /// `parent_count` forgets the second parent.
    ParentCount,
    /// Applying a node halves one fan only.
    TVertex,
    /// One half of the lower fan is turned over.
    Flipped,
    /// `triangles_added` is one too many.
    Count,
    /// Undoing leaves the vertex.
    Leftover,
    /// Undoing takes the vertex before its triangles.
    EarlyRemoval,
    /// A vertex tells how many nodes were applied when it came.
    Order,
    /// `mesh_of` ignores the deepest level.
    MeshOf,
}

#[derive(Debug)]
pub(crate) struct Strip {
    levels: u32,
    fault: Fault,
    error_m: Vec<f32>,
    bound: Vec<Sphere>,
}

const ENDS: [VertexId; 2] = [0, 1];
const APEXES: [VertexId; 2] = [2, 3];

fn level_and_index(node: NodeId) -> (u32, u32) {
    let level = (node + 1).ilog2();
    (level, node + 1 - (1 << level))
}

fn number(level: u32, index: u32) -> NodeId {
    (1 << level) - 1 + index
}

impl Strip {
    pub(crate) fn new(levels: u32, fault: Fault) -> Self {
        let count = number(levels, 0) as usize;
        let zero = Sphere { centre: DVec3::ZERO, radius_m: 0.0 };
        let mut strip = Self { levels, fault, error_m: vec![0.0; count], bound: vec![zero; count] };
        for node in (0..count as NodeId).rev() {
            let centre = strip.position(4 + node);
            let [a, b] = strip.ends(node);
            let mut error_m = (centre.z - 0.5 * (strip.position(a).z + strip.position(b).z)).abs() as f32;
            let mut radius_m = 0.0f64;
            for id in [a, b, APEXES[0], APEXES[1]] {
                radius_m = radius_m.max((strip.position(id) - centre).length());
            }
            for &child in strip.all_children(node).iter() {
                let inner = strip.bound[child as usize];
                error_m = error_m.max(strip.error_m[child as usize]);
                radius_m = radius_m.max((inner.centre - centre).length() + inner.radius_m);
            }
            strip.error_m[node as usize] = error_m;
            strip.bound[node as usize] = Sphere { centre, radius_m };
        }
        match fault {
            Fault::Error => strip.error_m[count - 1] = 1e6,
            Fault::Bound => strip.bound[count - 1].radius_m *= 3.0,
            _ => {}
        }
        strip
    }

    /// Vertex numbers of the ends of the interval that a node halves.
    fn ends(&self, node: NodeId) -> [VertexId; 2] {
        let (level, index) = level_and_index(node);
        let at = |k: u32| {
            let zeros = k.trailing_zeros();
            match k {
                0 => ENDS[0],
                k if k == 1 << level => ENDS[1],
                k => 4 + number(level - 1 - zeros, k >> (zeros + 1)),
            }
        };
        [at(index), at(index + 1)]
    }

    fn position(&self, id: VertexId) -> DVec3 {
        let length = f64::from(1u32 << self.levels);
        let x = match id {
            0 => 0.0,
            1 => length,
            2 => return DVec3::new(0.5 * length, 3.0, 0.0),
            3 => return DVec3::new(0.5 * length, -3.0, 0.0),
            id => {
                let (level, index) = level_and_index(id - 4);
                f64::from(2 * index + 1) * length / f64::from(2u32 << level)
            }
        };
        DVec3::new(x, 0.0, (x * 1.7).sin() + 0.1 * x)
    }

    fn vertex(&self, id: VertexId, active: &dyn ActiveSet) -> SurfaceVertex {
        let node = id.checked_sub(4);
        let before = (0..self.node_bound()).filter(|&n| active.is_active(n)).count();
        SurfaceVertex {
            position: self.position(id),
            normal: [0.0, 0.0, 1.0],
            detail_m: if self.fault == Fault::Order { before as f32 } else { 0.0 },
            error_m: node.map_or(f32::INFINITY, |n| self.error_m[n as usize]),
            bound_radius_m: node.map_or(0.0, |n| self.bound[n as usize].radius_m as f32),
            level: node.map_or(0, |n| level_and_index(n).0),
            colour: [255; 3],
        }
    }

    /// Both triangles of an interval, with keys.
    fn triangles(&self, interval: NodeId) -> [(u64, [VertexId; 3]); 2] {
        let [a, b] = self.ends(interval);
        let mut lower = [b, a, APEXES[1]];
        if self.fault == Fault::Flipped && interval == self.node_bound() {
            lower.swap(0, 1);
        }
        [(u64::from(2 * interval), [a, b, APEXES[0]]), (u64::from(2 * interval + 1), lower)]
    }

    /// The interval's triangles and those of its halves, on the fans that are halved.
    fn exchange(&self, node: NodeId) -> [Vec<(u64, [VertexId; 3])>; 2] {
        let (level, index) = level_and_index(node);
        let fans = if self.fault == Fault::TVertex { 1 } else { 2 };
        let pick = |interval: NodeId| self.triangles(interval).into_iter().take(fans).collect::<Vec<_>>();
        let mut halves = pick(number(level + 1, 2 * index));
        halves.extend(pick(number(level + 1, 2 * index + 1)));
        [pick(node), halves]
    }

    fn all_children(&self, node: NodeId) -> NodeList {
        let (level, index) = level_and_index(node);
        let mut list = NodeList::new();
        if level + 1 < self.levels {
            for child in [2 * index, 2 * index + 1, (2 * index).wrapping_sub(1), 2 * index + 2] {
                if child < 2 << level {
                    list.insert(number(level + 1, child));
                }
            }
        }
        list
    }
}

impl Hierarchy for Strip {
    fn node_bound(&self) -> NodeId {
        number(self.levels, 0)
    }

    fn exists(&self, node: NodeId) -> bool {
        node < self.node_bound()
    }

    fn roots(&self) -> Vec<NodeId> {
        vec![0]
    }

    fn parents(&self, node: NodeId) -> NodeList {
        let (level, index) = level_and_index(node);
        let mut list = NodeList::new();
        if level > 0 {
            list.insert(number(level - 1, index / 2));
            let neighbour = if index % 2 == 1 { index / 2 + 1 } else { (index / 2).wrapping_sub(1) };
            if neighbour < 1 << (level - 1) {
                list.insert(number(level - 1, neighbour));
            }
        }
        list
    }

    fn children(&self, node: NodeId) -> NodeList {
        let all = self.all_children(node);
        if self.fault != Fault::Children {
            return all;
        }
        let mut list = NodeList::new();
        for &child in all.iter().filter(|&&c| self.parents(c).first() == Some(&node)) {
            list.insert(child);
        }
        list
    }

    fn parent_count(&self, node: NodeId) -> usize {
        let count = self.parents(node).len();
        if self.fault == Fault::ParentCount { count.min(1) } else { count }
    }

    fn error_m(&self, node: NodeId) -> f32 {
        self.error_m[node as usize]
    }

    fn bound(&self, node: NodeId) -> Sphere {
        self.bound[node as usize]
    }

    fn triangles_added(&self, _node: NodeId, _active: &dyn ActiveSet) -> i32 {
        match self.fault {
            Fault::Count => 3,
            Fault::TVertex => 1,
            _ => 2,
        }
    }

    fn base_triangle_count(&self) -> usize {
        2
    }

    fn level(&self, node: NodeId) -> u32 {
        level_and_index(node).0
    }
}

impl Surface for Strip {
    fn emit_base(&self, sink: &mut dyn Sink) {
        for id in 0..4 {
            sink.add_vertex(id, self.vertex(id, &|_: NodeId| false));
        }
        for (key, corners) in self.triangles(0) {
            sink.add_triangle(key, corners);
        }
    }

    fn refine(&self, node: NodeId, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let [old, new] = self.exchange(node);
        sink.add_vertex(4 + node, self.vertex(4 + node, active));
        for (key, _) in old {
            sink.remove_triangle(key);
        }
        for (key, corners) in new {
            sink.add_triangle(key, corners);
        }
    }

    fn coarsen(&self, node: NodeId, _active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let [old, new] = self.exchange(node);
        if self.fault == Fault::EarlyRemoval {
            sink.remove_vertex(4 + node);
        }
        for (key, _) in new {
            sink.remove_triangle(key);
        }
        for (key, corners) in old {
            sink.add_triangle(key, corners);
        }
        if !matches!(self.fault, Fault::EarlyRemoval | Fault::Leftover) {
            sink.remove_vertex(4 + node);
        }
    }

    fn mesh_of(&self, active: &dyn ActiveSet) -> TriangleMesh {
        let mut mirror = MeshMirror::default();
        self.emit_base(&mut mirror);
        for node in (0..self.node_bound()).filter(|&n| active.is_active(n)) {
            let deepest = level_and_index(node).0 + 1 == self.levels;
            if !(self.fault == Fault::MeshOf && deepest) {
                self.refine(node, active, &mut mirror);
            }
        }
        mirror.to_mesh()
    }
}
