//! The mesh while it is being collapsed: places in a box, triangles, stars, and the tests that keep it a mesh.
//!
//! Based on: Dey, Edelsbrunner, Guha, Nekhayev, "Topology preserving edge contraction", 1999 (the link condition).

use super::appearance::Appearance;
use super::stars::{Corner, Stars};
use glam::DVec3;

/// A corner of a removed triangle.
pub(super) const GONE: u32 = u32::MAX;

/// Cosine of the largest turn of a triangle's normal in one collapse.
const LEAST_TURN_COSINE: f64 = 0.2;

/// What holds a vertex.
pub(super) mod hold {
    /// It stays as it is, by request or because its surroundings are no surface.
    pub(crate) const LOCKED: u8 = 1;
    /// Parts of different appearance meet at it.
    pub(crate) const CREASE: u8 = 2;
}

/// What a collapse would do to the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Topology {
    /// It stays what it is.
    Kept,
    /// A component of a few triangles goes as a whole.
    Vanishes,
    /// It would no longer be a surface, or another one.
    Broken,
}

/// Which ends of an edge must stay where they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    Neither,
    First,
    Second,
    Both,
}

/// A mesh to collapse.
#[derive(Debug, Default)]
pub(super) struct Work {
    /// Places, scaled into about a box.
    pub(super) positions: Vec<DVec3>,
    /// Corners; removed triangles have [`GONE`] in all three.
    pub(super) triangles: Vec<[u32; 3]>,
    /// What holds each vertex: bits of [`hold`].
    pub(super) holds: Vec<u8>,
    /// What the mesh looks like beside its shape.
    pub(super) appearance: Appearance,
    stars: Stars,
    faces: usize,
    /// Scratch.
    marks: Vec<u32>,
    mark: u32,
    star: Vec<Corner>,
    just_gone: Vec<u32>,
}

impl Work {
    /// Takes arrays over; no triangle has a repeated corner. Vertices at edges of more than two triangles, or of two that
    /// face different ways, are locked.
    pub(super) fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>, holds: Vec<u8>, appearance: Appearance) -> Self {
        let vertices = positions.len();
        let mut work = Self {
            stars: Stars::new(&triangles, vertices),
            faces: triangles.iter().filter(|t| t[0] != GONE).count(),
            positions,
            triangles,
            holds,
            appearance,
            marks: vec![0; vertices],
            mark: 0,
            star: Vec::new(),
            just_gone: Vec::new(),
        };
        work.lock_what_is_no_surface();
        work.find_creases();
        work
    }

    /// Triangles left.
    pub(super) fn faces(&self) -> usize {
        self.faces
    }

    /// The corners at a vertex.
    #[inline]
    pub(super) fn star(&self, vertex: u32) -> &[Corner] {
        self.stars.of(vertex)
    }

    /// The wedge of a vertex that looks the same from all sides.
    pub(super) fn wedge(&self, vertex: u32) -> u32 {
        self.stars.of(vertex).first().map_or(0, |&corner| self.appearance.turned_wedges(corner)[0])
    }

    /// Whether no triangle touches the vertex any more.
    #[inline]
    pub(super) fn is_gone(&self, vertex: u32) -> bool {
        self.stars.of(vertex).is_empty()
    }

    /// The vertices that the last collapse took away.
    pub(super) fn just_gone(&self) -> &[u32] {
        &self.just_gone
    }

    /// How many triangles have both vertices.
    pub(super) fn edge_triangles(&self, a: u32, b: u32) -> usize {
        self.stars.of(a).iter().filter(|c| self.triangles[c.triangle()].contains(&b)).count()
    }

    /// Vertices that share an edge with this one, each once, in the order of the star.
    #[inline]
    pub(super) fn neighbours(&mut self, vertex: u32, found: &mut Vec<u32>) {
        found.clear();
        self.mark += 1;
        for corner in self.stars.of(vertex) {
            let [_, b, c] = corner.turned(&self.triangles);
            for n in [b, c] {
                if self.marks[n as usize] != self.mark {
                    self.marks[n as usize] = self.mark;
                    found.push(n);
                }
            }
        }
    }

    /// Merges `goes` into `stays` at `place` unless that folds, pinches or loses surface; gives whether it was done. Where
    /// the two belong to a tetrahedron that stands alone, or to a lone triangle, all of that goes, but never the last.
    /// `share` is where the place lies on the way from `stays` to `goes`, for what is blended.
    pub(super) fn collapse(&mut self, goes: u32, stays: u32, place: DVec3, share: f32) -> bool {
        match self.topology(goes, stays) {
            Topology::Broken => return false,
            Topology::Vanishes => return self.vanish(goes, stays),
            Topology::Kept => (),
        }
        if !self.keeps_turn(goes, stays, place) || !self.keeps_turn(stays, goes, place) {
            return false;
        }
        let mut star = std::mem::take(&mut self.star);
        star.clear();
        self.just_gone.clear();
        self.just_gone.push(goes);
        self.appearance.merge(self.stars.of(goes), &self.triangles, goes, stays, share);
        for k in 0..self.stars.of(goes).len() {
            let corner = self.stars.of(goes)[k];
            let t = corner.triangle();
            if let Some(third) = third(self.triangles[t], goes, stays) {
                self.stars.remove(third, t);
                self.stars.remove(stays, t);
                if self.stars.of(third).is_empty() {
                    self.just_gone.push(third);
                }
                self.triangles[t] = [GONE; 3];
                self.faces -= 1;
            } else {
                corner.set(&mut self.triangles, stays);
                star.push(corner);
            }
        }
        star.extend_from_slice(self.stars.of(stays));
        self.stars.set(goes, &[]);
        self.stars.set(stays, &star);
        self.star = star;
        self.positions[stays as usize] = place;
        self.holds[stays as usize] |= self.holds[goes as usize];
        true
    }

    /// Takes a whole small component away.
    fn vanish(&mut self, a: u32, b: u32) -> bool {
        let mut gone: Vec<usize> = [a, b].iter().flat_map(|&v| self.stars.of(v)).map(|c| c.triangle()).collect();
        gone.sort_unstable();
        gone.dedup();
        let is_locked = |v: u32| self.holds[v as usize] & hold::LOCKED != 0;
        if gone.len() >= self.faces || gone.iter().any(|&t| self.triangles[t].into_iter().any(is_locked)) {
            return false;
        }
        self.just_gone.clear();
        for t in gone {
            for v in self.triangles[t] {
                self.stars.remove(v, t);
                if self.stars.of(v).is_empty() {
                    self.just_gone.push(v);
                }
            }
            self.triangles[t] = [GONE; 3];
            self.faces -= 1;
        }
        true
    }

    /// The link condition: the two vertices share the neighbours that their common triangles name and no others, and two
    /// border vertices are joined by the border itself. And no edge comes to be between two locked vertices, which may have one
    /// already where another part of the mesh meets this one.
    fn topology(&mut self, goes: u32, stays: u32) -> Topology {
        let mut common = 0;
        self.mark += 2;
        let (of_goes, of_both) = (self.mark - 1, self.mark);
        let mut neighbours_goes = 0;
        for corner in self.stars.of(goes) {
            let [_, p, q] = corner.turned(&self.triangles);
            common += usize::from(p == stays || q == stays);
            for n in [p, q] {
                neighbours_goes += usize::from(self.marks[n as usize] != of_goes);
                self.marks[n as usize] = of_goes;
            }
        }
        if common == 0 || common > 2 {
            return Topology::Broken;
        }
        let (mut shared, mut others) = (0, 0);
        self.marks[goes as usize] = of_both;
        self.marks[stays as usize] = of_both;
        for corner in self.stars.of(stays) {
            let [_, p, q] = corner.turned(&self.triangles);
            for n in [p, q] {
                let mark = &mut self.marks[n as usize];
                shared += usize::from(*mark == of_goes);
                others += usize::from(*mark != of_goes && *mark != of_both);
                *mark = of_both;
            }
        }
        if shared != common {
            return Topology::Broken;
        }
        if self.holds[stays as usize] & hold::LOCKED != 0 {
            let meets = |n: u32| self.marks[n as usize] == of_goes && self.holds[n as usize] & hold::LOCKED != 0;
            let mut corners = self.stars.of(goes).iter().map(|c| c.turned(&self.triangles));
            if corners.any(|[_, p, q]| meets(p) || meets(q)) {
                return Topology::Broken;
            }
        }
        let (star_goes, star_stays) = (self.stars.of(goes).len(), self.stars.of(stays).len());
        // `goes` itself is a neighbour of `stays`
        let neighbours_stays = shared + others + 1;
        let both_on_border = neighbours_goes != star_goes && neighbours_stays != star_stays;
        let left = star_goes + star_stays - 2 * common;
        match (common, left) {
            (1, 0) => Topology::Vanishes,
            (2, 2) if star_goes == 3 && star_stays == 3 && self.is_tetrahedron(goes) => Topology::Vanishes,
            (2, 0..=2) => Topology::Broken,
            (2, _) if both_on_border => Topology::Broken,
            _ => Topology::Kept,
        }
    }

    /// Whether a vertex of three triangles and its neighbours are all of a component.
    fn is_tetrahedron(&self, vertex: u32) -> bool {
        self.stars
            .of(vertex)
            .iter()
            .all(|c| c.turned(&self.triangles)[1..].iter().all(|&n| self.stars.of(n).len() == 3))
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
            let along = before.dot(after);
            let least = LEAST_TURN_COSINE * LEAST_TURN_COSINE * before.length_squared() * after.length_squared();
            // what had no area may gain some, any way round
            (along > 0.0 && along * along > least) || before == DVec3::ZERO
        })
    }

    /// Tells of each edge at `v` that has one triangle, or at which parts of different appearance meet, by its other end.
    pub(super) fn for_lines(&self, v: u32, mut found: impl FnMut(u32)) {
        let star = self.stars.of(v);
        for corner in star {
            let [_, b, c] = corner.turned(&self.triangles);
            // each inner edge is seen from the triangle that it follows
            let other = star.iter().find(|o| o.turned(&self.triangles)[2] == b);
            if other.is_none_or(|o| self.is_crease(corner.triangle(), o.triangle(), v, b)) {
                found(b);
            }
            if !star.iter().any(|o| o.turned(&self.triangles)[1] == c) {
                found(c);
            }
        }
    }

    fn is_crease(&self, s: usize, t: usize, a: u32, b: u32) -> bool {
        self.appearance.has_creases() && self.appearance.differ(&self.triangles, s, t, a, b)
    }

    /// Which ends of an edge must stay: locked ones; and where appearances meet, all that would leave their line.
    pub(super) fn kept_end(&self, a: u32, b: u32) -> Kept {
        let [hold_a, hold_b] = [a, b].map(|v| self.holds[v as usize]);
        let mut kept = [hold_a & hold::LOCKED != 0, hold_b & hold::LOCKED != 0];
        match [hold_a & hold::CREASE != 0, hold_b & hold::CREASE != 0] {
            [false, false] => (),
            [true, false] => kept[0] = true,
            [false, true] => kept[1] = true,
            [true, true] => {
                let lines = |v: u32, other: u32| {
                    let (mut count, mut along) = (0, false);
                    self.for_lines(v, |n| {
                        count += 1;
                        along |= n == other;
                    });
                    (count, along)
                };
                let ((count_a, along), (count_b, _)) = (lines(a, b), lines(b, a));
                kept[0] |= count_a != 2 || !along;
                kept[1] |= count_b != 2 || !along;
            }
        }
        match kept {
            [false, false] => Kept::Neither,
            [true, false] => Kept::First,
            [false, true] => Kept::Second,
            [true, true] => Kept::Both,
        }
    }

    /// Marks the vertices at which parts of different appearance meet.
    fn find_creases(&mut self) {
        if !self.appearance.has_creases() {
            return;
        }
        for v in 0..self.positions.len() as u32 {
            let star = self.stars.of(v);
            let differs = star.iter().any(|corner| {
                let [_, b, _] = corner.turned(&self.triangles);
                let other = star.iter().find(|o| o.turned(&self.triangles)[2] == b);
                other.is_some_and(|o| self.is_crease(corner.triangle(), o.triangle(), v, b))
            });
            if differs {
                self.holds[v as usize] |= hold::CREASE;
            }
        }
    }

    /// Locks the vertices of edges that are no surface's.
    fn lock_what_is_no_surface(&mut self) {
        for v in 0..self.positions.len() as u32 {
            for side in [1, 2] {
                self.mark += 1;
                for corner in self.stars.of(v) {
                    // an edge that leaves the star, or comes back to it, twice
                    let n = corner.turned(&self.triangles)[side] as usize;
                    if self.marks[n] == self.mark {
                        self.holds[v as usize] |= hold::LOCKED;
                        self.holds[n] |= hold::LOCKED;
                    }
                    self.marks[n] = self.mark;
                }
            }
        }
    }

    /// Lets go of what can be worked out from the rest.
    pub(super) fn forget_stars(&mut self) {
        self.stars = Stars::default();
        self.marks = Vec::new();
    }

    /// Leaves out what is gone, keeping the order. `renumbered` hears of each vertex that stays, by its old number, in order.
    pub(super) fn compact(&mut self, mut renumbered: impl FnMut(u32)) {
        let mut number = vec![GONE; self.positions.len()];
        let mut kept = 0u32;
        for v in 0..self.positions.len() as u32 {
            if !self.is_gone(v) {
                number[v as usize] = kept;
                self.positions[kept as usize] = self.positions[v as usize];
                self.holds[kept as usize] = self.holds[v as usize];
                renumbered(v);
                kept += 1;
            }
        }
        self.positions.truncate(kept as usize);
        self.holds.truncate(kept as usize);
        self.marks.clear();
        self.marks.resize(kept as usize, 0);
        self.mark = 0;
        self.appearance.compact(&self.triangles);
        self.triangles.retain(|t| t[0] != GONE);
        for t in &mut self.triangles {
            *t = t.map(|v| number[v as usize]);
        }
        self.stars = Stars::new(&self.triangles, kept as usize);
    }
}

/// The third corner of a triangle that has both vertices.
#[inline]
pub(super) fn third(corners: [u32; 3], a: u32, b: u32) -> Option<u32> {
    if !corners.contains(&b) {
        return None;
    }
    corners.into_iter().find(|&v| v != a && v != b)
}
