//! A Delaunay triangulation of places with whole coordinates: all decisions are exact.
//!
//! Based on: Lawson, "Software for C1 Surface Interpolation", 1977 (insertion and flips); Guibas, Stolfi, "Primitives for
//! the Manipulation of General Subdivisions", 1985 (half-edges and predicates).

/// Most columns or rows, so that no product of the predicates overflows.
pub(super) const MOST_SIDE: usize = 1 << 28;
/// Samples, triangles and half-edges have numbers of 32 bits: 6 half-edges a sample.
pub(super) const MOST_SAMPLES: u64 = 1 << 29;

const NONE: u32 = u32::MAX;

/// Column and row.
pub(super) type Place = [i32; 2];

/// Triangles, clockwise from above (columns go east, rows south). Half-edge `3 t + k` goes from corner `k` of triangle `t`
/// to the next.
#[derive(Debug)]
pub(super) struct Net {
    places: Vec<Place>,
    /// The vertex that a half-edge starts at.
    starts: Vec<u32>,
    /// The half-edge the other way.
    twins: Vec<u32>,
    /// Triangles that the last insertion made or changed, each once.
    pub(super) changed: Vec<u32>,
    stack: Vec<u32>,
}

/// Twice the area of a triangle, positive when it turns as the net's do.
fn area(a: Place, b: Place, c: Place) -> i64 {
    let d = |p: Place, axis: usize| i64::from(p[axis]) - i64::from(a[axis]);
    d(b, 0) * d(c, 1) - d(b, 1) * d(c, 0)
}

/// Whether `p` lies inside the circle through the triangle's corners, not on it.
fn is_in_circle([a, b, c]: [Place; 3], p: Place) -> bool {
    let from_p = |q: Place| [i64::from(q[0]) - i64::from(p[0]), i64::from(q[1]) - i64::from(p[1])];
    let [a, b, c] = [a, b, c].map(from_p);
    let lift = |q: [i64; 2]| i128::from(q[0] * q[0] + q[1] * q[1]);
    let cross = |q: [i64; 2], r: [i64; 2]| i128::from(q[0] * r[1] - q[1] * r[0]);
    lift(a) * cross(b, c) + lift(b) * cross(c, a) + lift(c) * cross(a, b) > 0
}

fn next(e: u32) -> u32 {
    if e % 3 == 2 { e - 2 } else { e + 1 }
}

fn previous(e: u32) -> u32 {
    if e.is_multiple_of(3) { e + 2 } else { e - 1 }
}

impl Net {
    /// The two triangles between the corners of a grid.
    pub(super) fn of_grid(width: i32, height: i32) -> Self {
        let (right, bottom) = (width - 1, height - 1);
        Self {
            places: vec![[0, 0], [right, 0], [right, bottom], [0, bottom]],
            starts: vec![0, 1, 2, 0, 2, 3],
            twins: vec![NONE, NONE, 3, 2, NONE, NONE],
            changed: Vec::new(),
            stack: Vec::new(),
        }
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.places.len()
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.starts.len() / 3
    }

    pub(super) fn place(&self, vertex: u32) -> Place {
        self.places[vertex as usize]
    }

    pub(super) fn corners(&self, t: usize) -> [u32; 3] {
        [self.starts[3 * t], self.starts[3 * t + 1], self.starts[3 * t + 2]]
    }

    pub(super) fn places_of(&self, t: usize) -> [Place; 3] {
        self.corners(t).map(|v| self.place(v))
    }

    /// The triangle that holds a place of the grid, on the way from `t`.
    pub(super) fn locate(&self, mut t: u32, p: Place) -> u32 {
        'walk: loop {
            for e in 3 * t..3 * t + 3 {
                let [a, b] = [e, next(e)].map(|e| self.place(self.starts[e as usize]));
                let beyond = self.twins[e as usize];
                if beyond != NONE && area(a, b, p) < 0 {
                    t = beyond / 3;
                    continue 'walk;
                }
            }
            return t;
        }
    }

    /// Inserts a place that triangle `t` holds, inside or on an edge. Does nothing when a vertex is there.
    pub(super) fn insert(&mut self, t: u32, p: Place) {
        self.changed.clear();
        let places = self.places_of(t as usize);
        if places.contains(&p) {
            return;
        }
        let vertex = self.places.len() as u32;
        self.places.push(p);
        match (0..3).find(|&k| area(places[k], places[(k + 1) % 3], p) == 0) {
            None => self.split_triangle(t, vertex),
            Some(k) => self.split_edge(3 * t + k as u32, vertex),
        }
        self.legalise();
        self.changed.sort_unstable();
        self.changed.dedup();
    }

    /// Every triangle around a new vertex has it as its third corner: its first half-edge is the one to look at.
    fn put(&mut self, t: u32, corners: [u32; 3]) {
        let at = 3 * t as usize;
        if at == self.starts.len() {
            self.starts.extend(corners);
            self.twins.extend([NONE; 3]);
        } else {
            self.starts[at..at + 3].copy_from_slice(&corners);
        }
        self.changed.push(t);
        self.stack.push(3 * t);
    }

    fn link(&mut self, e: u32, twin: u32) {
        self.twins[e as usize] = twin;
        if twin != NONE {
            self.twins[twin as usize] = e;
        }
    }

    fn split_triangle(&mut self, t: u32, p: u32) {
        let [a, b, c] = self.corners(t as usize);
        let outside = [0, 1, 2].map(|k| self.twins[3 * t as usize + k]);
        let first_new = self.triangle_count() as u32;
        let made = [t, first_new, first_new + 1];
        for (t, [from, to]) in made.into_iter().zip([[a, b], [b, c], [c, a]]) {
            self.put(t, [from, to, p]);
        }
        for k in 0..3 {
            self.link(3 * made[k], outside[k]);
            self.link(3 * made[k] + 1, 3 * made[(k + 1) % 3] + 2);
        }
    }

    fn split_edge(&mut self, e: u32, p: u32) {
        let twin = self.twins[e as usize];
        let first_new = self.triangle_count() as u32;
        let [upper, lower] = self.split_side(e, first_new, p);
        if twin != NONE {
            let [twin_upper, twin_lower] = self.split_side(twin, first_new + 1, p);
            self.link(3 * upper + 1, 3 * twin_lower + 2);
            self.link(3 * twin_upper + 1, 3 * lower + 2);
        }
    }

    /// Splits the triangle of a half-edge from `a` to `b` into those at `a` and at `b`.
    fn split_side(&mut self, e: u32, at_b: u32, p: u32) -> [u32; 2] {
        let at_a = e / 3;
        let [b_to_c, c_to_a] = [next(e), previous(e)];
        let [a, b, c] = [e, b_to_c, c_to_a].map(|e| self.starts[e as usize]);
        let [beyond_b, beyond_a] = [b_to_c, c_to_a].map(|e| self.twins[e as usize]);
        self.put(at_a, [c, a, p]);
        self.put(at_b, [b, c, p]);
        self.link(3 * at_a, beyond_a);
        self.link(3 * at_b, beyond_b);
        self.link(3 * at_a + 2, 3 * at_b + 1);
        self.link(3 * at_a + 1, NONE);
        self.link(3 * at_b + 2, NONE);
        [at_a, at_b]
    }

    fn legalise(&mut self) {
        while let Some(e) = self.stack.pop() {
            let twin = self.twins[e as usize];
            if twin == NONE {
                continue;
            }
            let beyond = self.place(self.starts[previous(twin) as usize]);
            if is_in_circle(self.places_of(e as usize / 3), beyond) {
                self.flip(e);
            }
        }
    }

    /// Turns the edge opposite to the third corner of a triangle; it stays the third corner of both.
    fn flip(&mut self, e: u32) {
        let twin = self.twins[e as usize];
        let (t, u) = (e / 3, twin / 3);
        let [a, b, p] = self.corners(t as usize);
        let d = self.starts[previous(twin) as usize];
        let [beyond_pa, beyond_bp] = [3 * t + 2, 3 * t + 1].map(|e| self.twins[e as usize]);
        let [beyond_ad, beyond_db] = [next(twin), previous(twin)].map(|e| self.twins[e as usize]);
        self.put(t, [a, d, p]);
        self.put(u, [d, b, p]);
        self.link(3 * t, beyond_ad);
        self.link(3 * t + 2, beyond_pa);
        self.link(3 * u, beyond_db);
        self.link(3 * u + 1, beyond_bp);
        self.link(3 * t + 1, 3 * u + 2);
    }

    /// Turns the diagonal of a cell that triangle `t` has half of, so that it does not end at a vertex for which `avoid`
    /// holds. The cell's circle has no other sample inside, so both diagonals are Delaunay's.
    pub(super) fn turn_diagonal(&mut self, t: usize, avoid: impl Fn(Place) -> bool) {
        let places = self.places_of(t);
        let is_cell = |a: Place, b: Place| (a[0] - b[0]).abs() == 1 && (a[1] - b[1]).abs() == 1;
        let Some(k) = (0..3).find(|&k| is_cell(places[k], places[(k + 1) % 3])) else { return };
        let e = (3 * t + k) as u32;
        let twin = self.twins[e as usize];
        if area(places[0], places[1], places[2]) != 1 || twin == NONE {
            return;
        }
        let [a, b, c] = [k, (k + 1) % 3, (k + 2) % 3].map(|k| places[k]);
        let d = self.place(self.starts[previous(twin) as usize]);
        let across = [a[0] + b[0] - c[0], a[1] + b[1] - c[1]];
        if d != across || !(avoid(a) || avoid(b)) || avoid(c) || avoid(d) {
            return;
        }
        // the flip wants the edge first
        let mut corners = self.corners(t);
        let mut twins = [0, 1, 2].map(|k| self.twins[3 * t + k]);
        corners.rotate_left(k);
        twins.rotate_left(k);
        for k in 0..3 {
            self.starts[3 * t + k] = corners[k];
            self.link((3 * t + k) as u32, twins[k]);
        }
        self.flip(3 * t as u32);
        self.stack.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_order_of_insertion_gives_a_delaunay_triangulation(
            places in prop::collection::vec((0..9, 0..7), 0..40),
        ) {
            let mut net = Net::of_grid(9, 7);
            for &(x, y) in &places {
                let t = net.locate(0, [x, y]);
                net.insert(t, [x, y]);
            }
            let mut whole = 0;
            for t in 0..net.triangle_count() {
                let corners = net.places_of(t);
                let twice = area(corners[0], corners[1], corners[2]);
                prop_assert!(twice > 0);
                whole += twice;
                prop_assert!(net.places.iter().all(|&p| !is_in_circle(corners, p)));
                for e in 3 * t..3 * t + 3 {
                    let twin = net.twins[e];
                    if twin != NONE {
                        prop_assert_eq!(net.twins[twin as usize], e as u32);
                        prop_assert_eq!(net.starts[twin as usize], net.starts[next(e as u32) as usize]);
                    }
                }
            }
            prop_assert_eq!(whole, 2 * 8 * 6);
        }
    }
}
