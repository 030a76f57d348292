//! Which triangles touch a vertex: flat lists that grow at the end of one pool as stars merge.

/// A corner of a triangle: the triangle's number and which of its three corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Corner(u32);

impl Corner {
    pub(crate) fn new(triangle: usize, place: usize) -> Self {
        Self((triangle << 2 | place) as u32)
    }

    #[inline]
    pub(crate) fn triangle(self) -> usize {
        (self.0 >> 2) as usize
    }

    /// Which of the triangle's corners it is.
    #[inline]
    pub(crate) fn place(self) -> usize {
        (self.0 & 3) as usize
    }

    /// The triangle's corners in its turning order, this one first.
    #[inline]
    pub(crate) fn turned(self, triangles: &[[u32; 3]]) -> [u32; 3] {
        // by a table: which corner it is cannot be foretold, and a branch would often be guessed wrong
        const NEXT: [usize; 4] = [1, 2, 0, 0];
        const LAST: [usize; 4] = [2, 0, 1, 0];
        let (corners, place) = (&triangles[self.triangle()], (self.0 & 3) as usize);
        [corners[place], corners[NEXT[place]], corners[LAST[place]]]
    }

    /// Puts another vertex in this corner.
    #[inline]
    pub(crate) fn set(self, triangles: &mut [[u32; 3]], vertex: u32) {
        triangles[self.triangle()][(self.0 & 3) as usize] = vertex;
    }
}

/// The corners at each vertex.
#[derive(Debug, Default)]
pub(crate) struct Stars {
    start: Vec<u32>,
    len: Vec<u32>,
    pool: Vec<Corner>,
}

impl Stars {
    /// The stars of all vertices below `vertices`, triangles in order.
    pub(crate) fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let mut len = vec![0u32; vertices];
        for &v in triangles.as_flattened() {
            len[v as usize] += 1;
        }
        let mut start = Vec::with_capacity(vertices);
        let mut sum = 0;
        for &n in &len {
            start.push(sum);
            sum += n;
        }
        // room to grow until the mesh is compacted: memory that is not touched costs nothing, a move costs twice
        let mut pool = Vec::with_capacity(sum as usize + (sum as usize / 8) * 5);
        pool.resize(sum as usize, Corner(0));
        let mut next = start.clone();
        for (t, corners) in triangles.iter().enumerate() {
            for (k, &v) in corners.iter().enumerate() {
                pool[next[v as usize] as usize] = Corner::new(t, k);
                next[v as usize] += 1;
            }
        }
        Self { start, len, pool }
    }

    /// The corners at a vertex.
    #[inline]
    pub(crate) fn of(&self, vertex: u32) -> &[Corner] {
        let start = self.start[vertex as usize] as usize;
        &self.pool[start..start + self.len[vertex as usize] as usize]
    }

    /// Gives a vertex another star.
    pub(crate) fn set(&mut self, vertex: u32, corners: &[Corner]) {
        let v = vertex as usize;
        if corners.len() > self.len[v] as usize {
            self.start[v] = self.pool.len() as u32;
            self.pool.extend_from_slice(corners);
        } else {
            let start = self.start[v] as usize;
            self.pool[start..start + corners.len()].copy_from_slice(corners);
        }
        self.len[v] = corners.len() as u32;
    }

    /// Takes one triangle out of a vertex's star.
    pub(crate) fn remove(&mut self, vertex: u32, triangle: usize) {
        let v = vertex as usize;
        let start = self.start[v] as usize;
        let star = &mut self.pool[start..start + self.len[v] as usize];
        if let Some(k) = star.iter().position(|c| c.triangle() == triangle) {
            // the order of a star decides the order of sums: keep it
            star.copy_within(k + 1.., k);
            self.len[v] -= 1;
        }
    }
}
