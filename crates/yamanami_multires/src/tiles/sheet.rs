//! A tile's mesh while it grows, and the bound on how far it is from the samples.

/// Vertices and triangles while they come.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    pub(super) places: Vec<[u16; 2]>,
    pub(super) heights_m: Vec<f64>,
    /// Where vertices are before they are put on the lattice (in its steps), and how high before they are rounded.
    pub(super) exact: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// By triangle: how far its heights are from those of the front at its corners, metres.
    off_m: Vec<f32>,
    /// By vertex, the greatest of its triangles: the front's error, and what the triangles' edges have moved, as a
    /// difference in height. Metres.
    error_m: Vec<f32>,
    moved_m: Vec<f32>,
}

impl Sheet {
    pub(super) fn clear(&mut self) {
        self.places.clear();
        self.heights_m.clear();
        self.exact.clear();
        self.triangles.clear();
        self.off_m.clear();
        self.error_m.clear();
        self.moved_m.clear();
    }

    pub(super) fn push(&mut self, place: [u16; 2], height_m: f64, exact: [f64; 3]) -> u32 {
        self.places.push(place);
        self.heights_m.push(height_m);
        self.exact.push(exact);
        self.error_m.push(0.0);
        self.moved_m.push(0.0);
        self.places.len() as u32 - 1
    }

    pub(super) fn ints(&self, vertex: u32) -> [i32; 2] {
        self.places[vertex as usize].map(i32::from)
    }

    /// Adds a triangle of the front's triangle with these `exact` corners.
    pub(super) fn add(&mut self, corners: [u32; 3], exact: &Plane, error_m: f32) {
        self.triangles.push(corners);
        let (mut off_m, mut moved) = (0f64, [0f64; 2]);
        for &v in &corners {
            let v = v as usize;
            let place = self.places[v].map(f64::from);
            off_m = off_m.max((self.heights_m[v] - exact.at(place)).abs());
            for axis in 0..2 {
                moved[axis] = moved[axis].max((place[axis] - self.exact[v][axis]).abs());
            }
        }
        let moved_m = (exact.slope[0].abs() * moved[0] + exact.slope[1].abs() * moved[1]) as f32;
        self.off_m.push(off_m as f32);
        self.count(&corners, error_m, moved_m);
    }

    /// Adds a triangle that no sample is near.
    pub(super) fn add_far(&mut self, corners: [u32; 3]) {
        self.triangles.push(corners);
        self.off_m.push(f32::NEG_INFINITY);
    }

    fn count(&mut self, corners: &[u32; 3], error_m: f32, moved_m: f32) {
        for &v in corners {
            let v = v as usize;
            self.error_m[v] = self.error_m[v].max(error_m);
            self.moved_m[v] = self.moved_m[v].max(moved_m);
        }
    }

    /// By triangle, how far the samples in it may be from the mesh. A sample in a triangle of the mesh lies in the triangle of
    /// the front that became it, or in a neighbour, beyond an edge that was moved.
    pub(super) fn bounds_m(&self) -> impl Iterator<Item = f64> {
        let worst = |corners: &[u32; 3], of: &[f32]| corners.iter().map(|&v| of[v as usize]).fold(0.0, f32::max);
        self.triangles.iter().zip(&self.off_m).map(move |(corners, off_m)| {
            let bound_m = worst(corners, &self.error_m) + off_m + 2.0 * worst(corners, &self.moved_m);
            // sums of three numbers in f32
            f64::from(bound_m) * (1.0 + 1e-6)
        })
    }
}

/// The plane through three points: steps of the tile's lattice, and metres.
pub(super) struct Plane {
    from: [f64; 3],
    slope: [f64; 2],
}

impl Plane {
    pub(super) fn through([a, b, c]: [[f64; 3]; 3]) -> Self {
        let (p, q) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let area = p[0] * q[1] - q[0] * p[1];
        let slope = if area == 0.0 {
            [0.0; 2]
        } else {
            [(p[2] * q[1] - q[2] * p[1]) / area, (q[2] * p[0] - p[2] * q[0]) / area]
        };
        Self { from: a, slope }
    }

    pub(super) fn at(&self, [u, v]: [f64; 2]) -> f64 {
        self.from[2] + self.slope[0] * (u - self.from[0]) + self.slope[1] * (v - self.from[1])
    }
}
