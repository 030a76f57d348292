//! Topology of the triangles of a semi-regular mesh's levels: points, children, parents, and which nodes depend on which.
//! Knows no place.
//!
//! A triangle has the corners R, P, Q, counter-clockwise, and the midpoints h (of PQ), p (of RP) and q (of QR), which are vertices
//! of the next level; the names are those of the templates. Half 0 lies as its base triangle does, half 1 is turned by 180 degrees.
//!
//! A node is a new vertex. Its parents are the midpoints of the parent triangles of the triangles at its edge: three where the edge lies
//! inside one parent, five where it is half an edge that two share. Red–green closure after Bank, Sherman, Weiser, "Refinement
//! algorithms and data structures for regular local mesh refinement", 1983.

use yamanami_core::{NodeList, Place, SemiRegular};

/// A triangle of a level's mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Triangle {
    pub(super) face: u32,
    pub(super) level: u32,
    /// Lattice coordinates of its square's first corner.
    pub(super) at: [u32; 2],
    pub(super) half: u8,
}

/// Lattice offsets of R, P, Q, h, p, q on the next level, by half.
const ROLE_OFFSETS: [[[u32; 2]; 6]; 2] = [
    [[0, 0], [2, 0], [0, 2], [1, 1], [1, 0], [0, 1]],
    [[2, 0], [2, 2], [0, 2], [1, 2], [2, 1], [1, 1]],
];

/// Squares (on the next level) and halves of the children at R, P, Q and in the middle, by half.
const CHILDREN: [[([u32; 2], u8); 4]; 2] = [
    [([0, 0], 0), ([1, 0], 0), ([0, 1], 0), ([0, 0], 1)],
    [([1, 0], 1), ([1, 1], 1), ([0, 1], 1), ([1, 1], 0)],
];

/// Roles of the children's corners R, P, Q, by half.
pub(super) const CHILD_CORNERS: [[[usize; 3]; 4]; 2] =
    [[[0, 4, 5], [4, 1, 3], [5, 3, 2], [4, 3, 5]], [[0, 4, 5], [4, 1, 3], [5, 3, 2], [5, 4, 3]]];

impl Triangle {
    /// A base triangle.
    pub(super) fn base(face: u32) -> Self {
        Self { face, level: 0, at: [0, 0], half: 0 }
    }

    /// The triangle with an [`Self::index`].
    pub(super) fn from_index(face: u32, level: u32, index: u32) -> Self {
        let last = (1 << level) - 1;
        let [x, y] = [index & last, index >> level];
        if x + y <= last {
            Self { face, level, at: [x, y], half: 0 }
        } else {
            Self { face, level, at: [last - x, last - y], half: 1 }
        }
    }

    /// Number among the `4^level` triangles of its level in its base triangle: up in a square's lower half, down turned into the upper.
    pub(super) fn index(self) -> u32 {
        let last = (1 << self.level) - 1;
        let [x, y] = if self.half == 0 { self.at } else { self.at.map(|c| last - c) };
        y << self.level | x
    }

    /// Lattice coordinates on the next level of R, P, Q, h, p, q.
    pub(super) fn points(self) -> [[u32; 2]; 6] {
        ROLE_OFFSETS[usize::from(self.half)].map(|[x, y]| [2 * self.at[0] + x, 2 * self.at[1] + y])
    }

    /// The vertices R, P, Q.
    pub(super) fn corners(self, mesh: &SemiRegular) -> [u32; 3] {
        let [r, p, q, ..] = self.points().map(|at| at.map(|c| c / 2));
        [r, p, q].map(|at| mesh.vertex(self.level, self.face, at))
    }

    /// The vertices R, P, Q, h, p, q of a triangle that is not of the last level.
    pub(super) fn vertices(self, mesh: &SemiRegular) -> [u32; 6] {
        self.points().map(|at| mesh.vertex(self.level + 1, self.face, at))
    }

    /// The midpoints h, p, q of a triangle that is not of the last level.
    pub(super) fn midpoints(self, mesh: &SemiRegular) -> [u32; 3] {
        let [_, _, _, h, p, q] = self.points();
        [h, p, q].map(|at| mesh.vertex(self.level + 1, self.face, at))
    }

    /// The children at R, P, Q and in the middle.
    pub(super) fn children(self) -> [Self; 4] {
        CHILDREN[usize::from(self.half)].map(|([x, y], half)| Self {
            face: self.face,
            level: self.level + 1,
            at: [2 * self.at[0] + x, 2 * self.at[1] + y],
            half,
        })
    }

    /// The triangle that this one is a child of; none for a base triangle.
    pub(super) fn parent(self) -> Option<Self> {
        let [x, y] = self.at.map(|c| (c & 1) as u8);
        let half = if self.half == 0 { x & y } else { x | y };
        Some(Self { level: self.level.checked_sub(1)?, at: self.at.map(|c| c >> 1), half, ..self })
    }
}

/// The one or two triangles whose edge a node bisects, each with the node's role there: 0 = h, 1 = p, 2 = q. None for a vertex of the
/// base mesh.
pub(super) fn adjacent(mesh: &SemiRegular, node: u32) -> impl Iterator<Item = (Triangle, usize)> {
    let level = mesh.level_of(node).wrapping_sub(1);
    let triangle = |face: u32, at: [u32; 2], half: u8| Triangle { face, level, at, half };
    let found = match mesh.place(node) {
        Place::Base => [None, None],
        Place::Edge { edge, at } => {
            let edge = mesh.base().edges()[edge as usize];
            let steps = 2 << level;
            let along = |(face, side): (u32, u8), at: u32| match side {
                0 => (triangle(face, [at / 2, 0], 0), 1),
                1 => (triangle(face, [(steps - at) / 2, at / 2], 0), 0),
                _ => (triangle(face, [0, (steps - at) / 2], 0), 2),
            };
            [Some(along(edge.left, at)), edge.right.map(|side| along(side, steps - at))]
        }
        Place::Face { face, at: [a, b] } => {
            let [x, y] = [a / 2, b / 2];
            let (up, turned, down) = match (a & 1, b & 1) {
                (1, 0) => (1, [x, y - 1], 0),
                (1, 1) => (0, [x, y], 2),
                _ => (2, [x - 1, y], 1),
            };
            [Some((triangle(face, [x, y], 0), up)), Some((triangle(face, turned, 1), down))]
        }
    };
    found.into_iter().flatten()
}

/// The nodes that must be applied before one.
pub(super) fn parents(mesh: &SemiRegular, node: u32) -> NodeList {
    let mut found = NodeList::new();
    let mut seen = None;
    for parent in adjacent(mesh, node).filter_map(|(t, _)| t.parent()) {
        if seen.replace(parent) != Some(parent) {
            parent.midpoints(mesh).into_iter().for_each(|m| found.insert(m));
        }
    }
    found
}

/// The nodes that have one as a parent.
pub(super) fn children(mesh: &SemiRegular, node: u32) -> NodeList {
    let mut found = NodeList::new();
    for (t, _) in adjacent(mesh, node).filter(|(t, _)| t.level + 2 <= mesh.levels()) {
        for child in t.children() {
            child.midpoints(mesh).into_iter().for_each(|m| found.insert(m));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::BaseMesh;

    fn tetrahedron() -> SemiRegular {
        let base = BaseMesh::new(4, vec![[0, 1, 2], [3, 1, 0], [2, 1, 3], [0, 2, 3]]).unwrap();
        SemiRegular::new(base, 4).unwrap()
    }

    #[test]
    fn the_triangles_of_a_level_are_those_of_the_mesh() {
        let mesh = tetrahedron();
        for level in 0..=4 {
            let all = |face| (0..1 << (2 * level)).map(move |index| Triangle::from_index(face, level, index));
            let mut found: Vec<_> = (0..4).flat_map(all).map(|t| t.corners(&mesh)).collect();
            let mut expected = mesh.triangles(level);
            let least_first = |t: &mut [u32; 3]| {
                let least = (0..3).min_by_key(|&k| t[k]).unwrap();
                t.rotate_left(least);
            };
            found.iter_mut().chain(&mut expected).for_each(least_first);
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected);
            assert!((0..1 << (2 * level)).all(|i| Triangle::from_index(1, level, i).index() == i));
        }
    }

    #[test]
    fn children_know_their_parent_and_have_its_points() {
        let mesh = tetrahedron();
        for t in (0..16).map(|index| Triangle::from_index(2, 2, index)) {
            let points = t.vertices(&mesh);
            assert_eq!(points[..3], t.corners(&mesh));
            for (child, corners) in t.children().into_iter().zip(CHILD_CORNERS[usize::from(t.half)]) {
                assert_eq!(child.parent(), Some(t));
                assert_eq!(child.corners(&mesh), corners.map(|role| points[role]));
            }
            for (ends, role) in [([1, 2], 3), ([0, 1], 4), ([2, 0], 5)] {
                let mut ends = ends.map(|k| points[k]);
                let mut parents = mesh.parents(points[role]).unwrap();
                ends.sort_unstable();
                parents.sort_unstable();
                assert_eq!(ends, parents);
            }
        }
    }

    #[test]
    fn a_node_is_where_its_triangles_say() {
        let mesh = tetrahedron();
        for node in mesh.vertex_count(0)..mesh.vertex_count(4) {
            let found: Vec<_> = adjacent(&mesh, node).collect();
            assert_eq!(found.len(), 2);
            assert!(found.iter().all(|(t, role)| t.midpoints(&mesh)[*role] == node));
        }
        assert_eq!(adjacent(&mesh, 3).count(), 0);
    }
}
