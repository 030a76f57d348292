//! The mesh while it is being collapsed: places in a unit box, triangles, stars, and the tests that keep it a mesh.
//!
//! Based on: Dey, Edelsbrunner, Guha, Nekhayev, "Topology preserving edge contraction", 1999 (the link condition).

use super::stars::Stars;
use glam::DVec3;
use yamanami_core::TriangleMesh;

/// A corner of a removed triangle.
pub(super) const GONE: u32 = u32::MAX;

/// Cosine of the largest turn of a triangle's normal in one collapse.
const LEAST_TURN_COSINE: f64 = 0.2;

/// What a collapse took away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Removed {
    /// It would have done harm: nothing.
    Nothing,
    /// So many triangles.
    Triangles(usize),
}

/// A mesh to collapse.
#[derive(Debug)]
pub(super) struct Work {
    /// Places, scaled by a power of two into about a unit box around zero.
    pub(super) positions: Vec<DVec3>,
    /// Corners; removed triangles have [`GONE`] in all three.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) locked: Vec<bool>,
    stars: Stars,
    faces: usize,
    origin: DVec3,
    metres_a_unit: f64,
    /// Scratch.
    marks: Vec<u32>,
    mark: u32,
}

impl Work {
    /// Takes a mesh over. Triangles with a repeated corner are left out.
    pub(super) fn new(mesh: &TriangleMesh, locked: Option<&[bool]>) -> Self {
        let bounds = mesh.bounds();
        let diagonal = bounds.diagonal();
        let metres_a_unit = if diagonal > 0.0 && diagonal.is_finite() { diagonal.log2().ceil().exp2() } else { 1.0 };
        let origin = if mesh.positions.is_empty() { DVec3::ZERO } else { bounds.centre() };
        let positions: Vec<DVec3> = mesh.positions.iter().map(|&p| (p - origin) / metres_a_unit).collect();
        let triangles: Vec<[u32; 3]> =
            mesh.triangles.iter().copied().filter(|&[a, b, c]| a != b && b != c && c != a).collect();
        let vertices = positions.len();
        Self {
            stars: Stars::new(&triangles, vertices),
            faces: triangles.len(),
            locked: locked.map_or_else(|| vec![false; vertices], <[bool]>::to_vec),
            positions,
            triangles,
            origin,
            metres_a_unit,
            marks: vec![0; vertices],
            mark: 0,
        }
    }

    /// Metres in a unit of `positions`.
    pub(super) fn metres_a_unit(&self) -> f64 {
        self.metres_a_unit
    }

    /// A place in metres.
    pub(super) fn place_m(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize] * self.metres_a_unit + self.origin
    }

    /// Whether a vertex is still where it was in the mesh.
    pub(super) fn is_unmoved(&self, vertex: u32, mesh: &TriangleMesh) -> bool {
        self.positions[vertex as usize] == (mesh.positions[vertex as usize] - self.origin) / self.metres_a_unit
    }

    /// Triangles left.
    pub(super) fn faces(&self) -> usize {
        self.faces
    }

    /// Whether no triangle touches the vertex any more.
    pub(super) fn is_gone(&self, vertex: u32) -> bool {
        self.stars.of(vertex).is_empty()
    }

    /// How many triangles have both vertices.
    pub(super) fn edge_triangles(&self, a: u32, b: u32) -> usize {
        self.stars.of(a).iter().filter(|c| self.triangles[c.triangle()].contains(&b)).count()
    }

    /// Vertices that share an edge with this one, each once, in the order of the star.
    pub(super) fn neighbours(&mut self, vertex: u32, found: &mut Vec<u32>) {
        found.clear();
        self.mark += 1;
        for &corner in self.stars.of(vertex) {
            let [_, b, c] = corner.turned(&self.triangles);
            for n in [b, c] {
                if self.marks[n as usize] != self.mark {
                    self.marks[n as usize] = self.mark;
                    found.push(n);
                }
            }
        }
    }

    /// Merges `goes` into `stays` at `place`, unless that folds, pinches or loses surface.
    pub(super) fn collapse(&mut self, goes: u32, stays: u32, place: DVec3) -> Removed {
        if !self.keeps_topology(goes, stays)
            || !self.keeps_turn(goes, stays, place)
            || !self.keeps_turn(stays, goes, place)
        {
            return Removed::Nothing;
        }
        let mut star = Vec::with_capacity(self.stars.of(goes).len() + self.stars.of(stays).len());
        let mut removed = 0;
        for k in 0..self.stars.of(goes).len() {
            let corner = self.stars.of(goes)[k];
            let t = corner.triangle();
            if let Some(third) = self.third(t, goes, stays) {
                self.stars.remove(third, t);
                self.stars.remove(stays, t);
                self.triangles[t] = [GONE; 3];
                removed += 1;
            } else {
                corner.set(&mut self.triangles, stays);
                star.push(corner);
            }
        }
        star.splice(0..0, self.stars.of(stays).iter().copied());
        self.stars.set(goes, &[]);
        self.stars.set(stays, &star);
        self.positions[stays as usize] = place;
        self.faces -= removed;
        Removed::Triangles(removed)
    }

    /// The third corner of a triangle that has both vertices.
    fn third(&self, triangle: usize, a: u32, b: u32) -> Option<u32> {
        let corners = self.triangles[triangle];
        if !corners.contains(&b) {
            return None;
        }
        corners.into_iter().find(|&v| v != a && v != b)
    }

    /// The link condition: the two vertices share the neighbours that their common triangles name and no others, an edge
    /// between two border vertices is a border itself, and the surface there does not consist of these triangles alone.
    fn keeps_topology(&mut self, a: u32, b: u32) -> bool {
        let thirds: Vec<u32> = self.stars.of(a).iter().filter_map(|c| self.third(c.triangle(), a, b)).collect();
        if thirds.is_empty() || thirds.len() > 2 || (thirds.len() == 2 && thirds[0] == thirds[1]) {
            return false;
        }
        let mut of_a = Vec::new();
        self.neighbours(a, &mut of_a);
        let of_a_mark = self.mark;
        let mut of_b = Vec::new();
        // neighbours() marks anew: ask for the shared ones by a list
        self.neighbours(b, &mut of_b);
        debug_assert_ne!(of_a_mark, self.mark);
        let shared = of_a.iter().filter(|v| of_b.contains(v)).count();
        if shared != thirds.len() {
            return false;
        }
        // a closed tetrahedron, or a lone triangle, would vanish
        let left = self.stars.of(a).len() + self.stars.of(b).len() - 2 * thirds.len();
        if left <= 2 && thirds.len() == 2 || left == 0 {
            return false;
        }
        let both_on_border = self.is_on_border(a, &of_a) && self.is_on_border(b, &of_b);
        !(both_on_border && thirds.len() == 2)
    }

    /// Whether any edge at the vertex has not two triangles.
    fn is_on_border(&self, vertex: u32, neighbours: &[u32]) -> bool {
        neighbours.iter().any(|&n| self.edge_triangles(vertex, n) != 2)
    }

    /// Whether no triangle of `moves` without `other` turns too far or loses its area when `moves` goes to `place`.
    fn keeps_turn(&self, moves: u32, other: u32, place: DVec3) -> bool {
        let from = self.positions[moves as usize];
        self.stars.of(moves).iter().all(|corner| {
            let [_, b, c] = corner.turned(&self.triangles);
            if b == other || c == other {
                return true;
            }
            let [pb, pc] = [b, c].map(|v| self.positions[v as usize]);
            let (before, after) = ((pb - from).cross(pc - from), (pb - place).cross(pc - place));
            before.dot(after) > LEAST_TURN_COSINE * before.length() * after.length()
        })
    }

    /// The mesh that is left, vertices in their order, and the number in the source of each.
    pub(super) fn finish(&self) -> (Vec<DVec3>, Vec<[u32; 3]>, Vec<u32>) {
        let mut number = vec![GONE; self.positions.len()];
        let mut sources = Vec::new();
        for v in 0..self.positions.len() as u32 {
            if !self.is_gone(v) {
                number[v as usize] = sources.len() as u32;
                sources.push(v);
            }
        }
        let positions = sources.iter().map(|&v| self.place_m(v)).collect();
        let triangles = self.triangles.iter().filter(|t| t[0] != GONE).map(|t| t.map(|v| number[v as usize])).collect();
        (positions, triangles, sources)
    }
}
