//! A tree of boxes over the triangles of a mesh, for the triangle nearest to a point.
//!
//! Split at the median of the longest side of the centroids' box, so its shape depends on the mesh only. A node holds the
//! boxes of both children, in single precision and rounded outwards, in one line of the cache.

use super::frame::Frame;
use super::triangle;
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// Triangles of a leaf.
const LEAF: usize = 2;

/// Marks a child that is a leaf: first triangle times four, plus the number of triangles less one.
const LEAF_MARK: u32 = 1 << 31;

/// Most triangles that leaves can name.
const MOST_TRIANGLES: usize = 1 << 29;

/// Triangles from which on halves are built side by side.
const SIDE_BY_SIDE: usize = 1 << 14;

/// Depth of the walk: a median split of [`MOST_TRIANGLES`] is not deeper.
const DEPTH: usize = 32;

#[derive(Debug, Clone, Copy)]
struct Box32 {
    min: [f32; 3],
    max: [f32; 3],
}

impl Box32 {
    const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    fn around(min: DVec3, max: DVec3) -> Self {
        let down = |v: f64| if f64::from(v as f32) > v { (v as f32).next_down() } else { v as f32 };
        let up = |v: f64| if f64::from(v as f32) < v { (v as f32).next_up() } else { v as f32 };
        Self { min: min.to_array().map(down), max: max.to_array().map(up) }
    }

    fn join(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| self.min[k].min(other.min[k])),
            max: std::array::from_fn(|k| self.max[k].max(other.max[k])),
        }
    }

    /// Square of the distance to a point, 0 inside.
    #[inline]
    fn distance2(&self, p: DVec3) -> f64 {
        let side = |min: f32, max: f32, at: f64| (f64::from(min) - at).max(at - f64::from(max)).max(0.0);
        let (x, y, z) = (
            side(self.min[0], self.max[0], p.x),
            side(self.min[1], self.max[1], p.y),
            side(self.min[2], self.max[2], p.z),
        );
        x * x + y * y + z * z
    }
}

#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Node {
    boxes: [Box32; 2],
    children: [u32; 2],
}

/// The triangles of a mesh in a frame.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// Corners, in the order of the leaves: neighbours in space are mostly neighbours here.
    pub(super) triangles: Vec<[DVec3; 3]>,
    /// The mesh's number of each of them.
    pub(super) numbers: Vec<u32>,
    /// Across each of its edges, the one from the first to the second corner first, another triangle's place in this order.
    pub(super) across: Vec<[u32; 3]>,
}

/// Across a border.
pub(super) const NONE: u32 = u32::MAX;

/// A triangle near a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    /// Square of its distance, units.
    pub(super) distance2: f64,
    /// Its place in the tree's order.
    pub(super) slot: u32,
}

impl Near {
    /// Nothing yet.
    pub(super) const NOTHING: Self = Self { distance2: f64::INFINITY, slot: 0 };
}

impl Tree {
    /// Builds the tree.
    ///
    /// # Panics
    /// When a triangle names a vertex that the mesh does not have, or the mesh has more than 2^29 triangles.
    pub(super) fn new(mesh: &TriangleMesh, frame: &Frame) -> Self {
        let count = mesh.triangles.len();
        assert!(count <= MOST_TRIANGLES, "{count} triangles, expected at most {MOST_TRIANGLES}");
        let centre = |t: u32| {
            let [a, b, c] = mesh.corners(t as usize);
            let third = (frame.unit(a) + frame.unit(b) + frame.unit(c)) / 3.0;
            (third.to_array().map(|v| v as f32), t)
        };
        let mut items: Vec<([f32; 3], u32)> = (0..count as u32).map(centre).collect();
        let empty = Node { boxes: [Box32::EMPTY; 2], children: [LEAF_MARK; 2] };
        let mut nodes = vec![empty; count.div_ceil(LEAF).max(2) - 1];
        let corners = |t: u32| mesh.corners(t as usize).map(|p| frame.unit(p));
        if count > LEAF {
            split(&mut items, &mut nodes, 0, 0, &corners);
        } else if count > 0 {
            nodes[0].boxes[0] = around(&items, &corners);
            nodes[0].children = [leaf(0, count); 2];
        }
        let numbers: Vec<u32> = items.iter().map(|&(_, t)| t).collect();
        let across = across(numbers.iter().map(|&t| mesh.triangles[t as usize]));
        Self { nodes, triangles: numbers.iter().map(|&t| corners(t)).collect(), numbers, across }
    }

    /// Whether there is no triangle.
    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// One triangle as near to `p`.
    #[inline]
    pub(super) fn near(&self, p: DVec3, slot: u32) -> Near {
        Near { distance2: triangle::distance2(p, &self.triangles[slot as usize]), slot }
    }

    /// The triangle nearest to `p`, or `best` when none is nearer.
    pub(super) fn nearest(&self, p: DVec3, mut best: Near) -> Near {
        self.walk(p, &mut best, |_, _| {});
        best
    }

    /// A distance that no triangle is nearer to `p` than, units; but for rounding the distance itself.
    pub(super) fn at_least(&self, p: DVec3) -> f64 {
        let mut best = Near::NOTHING;
        let mut least = f64::INFINITY;
        self.walk(p, &mut best, |q, triangle| least = least.min(triangle::at_least(p, q, triangle)));
        // what was passed over lies no nearer than the best
        least.min(best.distance2.sqrt())
    }

    /// Visits, nearest boxes first, all leaves whose box is nearer than the best so far.
    #[inline]
    fn walk(&self, p: DVec3, best: &mut Near, mut visit: impl FnMut(DVec3, &[DVec3; 3])) {
        if self.is_empty() {
            return;
        }
        let mut stack = [(0u32, 0.0f64); DEPTH];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (mut node, distance2) = stack[height];
            if distance2 >= best.distance2 {
                continue;
            }
            loop {
                if node & LEAF_MARK != 0 {
                    let first = (node & !LEAF_MARK) >> 2;
                    for slot in first..=first + (node & 3) {
                        let triangle = &self.triangles[slot as usize];
                        let q = triangle::nearest(p, triangle);
                        visit(q, triangle);
                        let distance2 = (p - q).length_squared();
                        if distance2 < best.distance2 {
                            *best = Near { distance2, slot };
                        }
                    }
                    break;
                }
                let Node { boxes, children } = &self.nodes[node as usize];
                let distances = [boxes[0].distance2(p), boxes[1].distance2(p)];
                let near = usize::from(distances[1] < distances[0]);
                let far = 1 - near;
                if distances[near] >= best.distance2 {
                    break;
                }
                if distances[far] < best.distance2 {
                    stack[height] = (children[far], distances[far]);
                    height += 1;
                }
                node = children[near];
            }
        }
    }
}

/// Pairs triangles that share an edge.
fn across(triangles: impl ExactSizeIterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let mut across = vec![[NONE; 3]; triangles.len()];
    let mut edges: Vec<(u64, u32)> = Vec::with_capacity(3 * across.len());
    for (slot, corners) in triangles.enumerate() {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            edges.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), (3 * slot + k) as u32));
        }
    }
    if edges.len() < SIDE_BY_SIDE {
        edges.sort_unstable()
    } else {
        edges.par_sort_unstable()
    }
    for pair in edges.windows(2) {
        let [(edge, one), (same, other)] = [pair[0], pair[1]];
        if edge == same {
            across[one as usize / 3][one as usize % 3] = other / 3;
            across[other as usize / 3][other as usize % 3] = one / 3;
        }
    }
    across
}

fn leaf(first: usize, count: usize) -> u32 {
    LEAF_MARK | (first as u32) << 2 | (count - 1) as u32
}

/// The box of some triangles.
fn around(items: &[([f32; 3], u32)], corners: &impl Fn(u32) -> [DVec3; 3]) -> Box32 {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &(_, t) in items {
        for p in corners(t) {
            (min, max) = (min.min(p), max.max(p));
        }
    }
    Box32::around(min, max)
}

/// Sorts more than [`LEAF`] items into two halves, whole leaves to the left, and so on downwards. `nodes` has one for each
/// leaf but one and begins at number `base`; `first` is the first item's place. Returns the box of all.
fn split(
    items: &mut [([f32; 3], u32)],
    nodes: &mut [Node],
    base: usize,
    first: usize,
    corners: &(impl Fn(u32) -> [DVec3; 3] + Sync),
) -> Box32 {
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for (c, _) in items.iter() {
        for k in 0..3 {
            (min[k], max[k]) = (min[k].min(c[k]), max[k].max(c[k]));
        }
    }
    let size: [f32; 3] = std::array::from_fn(|k| max[k] - min[k]);
    let axis = if size[0] >= size[1] && size[0] >= size[2] { 0 } else { 1 + usize::from(size[2] > size[1]) };
    let leaves_left = items.len().div_ceil(LEAF) / 2;
    let middle = leaves_left * LEAF;
    items.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    let (left, right) = items.split_at_mut(middle);
    let side_by_side = left.len() >= SIDE_BY_SIDE;
    let (this, below) = nodes.split_at_mut(1);
    let (nodes_left, nodes_right) = below.split_at_mut(leaves_left - 1);
    let base_left = base + 1;
    let base_right = base_left + nodes_left.len();
    let child = |items: &mut [([f32; 3], u32)], nodes: &mut [Node], base: usize, first: usize| {
        if items.len() <= LEAF {
            (around(items, corners), leaf(first, items.len()))
        } else {
            (split(items, nodes, base, first, corners), base as u32)
        }
    };
    let ((box_left, child_left), (box_right, child_right)) = if side_by_side {
        rayon::join(
            || child(left, nodes_left, base_left, first),
            || child(right, nodes_right, base_right, first + middle),
        )
    } else {
        (child(left, nodes_left, base_left, first), child(right, nodes_right, base_right, first + middle))
    };
    this[0] = Node { boxes: [box_left, box_right], children: [child_left, child_right] };
    box_left.join(&box_right)
}
