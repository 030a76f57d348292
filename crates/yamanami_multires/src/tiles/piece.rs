//! A tile's place and what is in it.

/// Steps of a tile's lattice along its sides, as quantized-mesh has them.
pub const GRID: u32 = 32767;

/// A tile: a square of the quadtree; y from the south.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tile {
    /// Depth: a tile's side is 2⁻ᶻ.
    pub zoom: u32,
    /// Column, eastwards.
    pub x: u32,
    /// Row, northwards.
    pub y: u32,
}

impl Tile {
    /// Tile space of a place of the tile's lattice.
    pub fn place(self, [u, v]: [u16; 2]) -> [f64; 2] {
        let side = 1.0 / f64::from(1u32 << self.zoom);
        let along = |tile: u32, k: u16| (f64::from(tile) + f64::from(k) / f64::from(GRID)) * side;
        [along(self.x, u), along(self.y, v)]
    }

    /// The four tiles of the next zoom in it.
    pub fn children(self) -> [Tile; 4] {
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| Tile {
            zoom: self.zoom + 1,
            x: 2 * self.x + x,
            y: 2 * self.y + y,
        })
    }
}

/// The mesh of a tile.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TilePiece {
    /// Places of the vertices on the tile's lattice: 0 to [`GRID`] eastwards and northwards. No two are the same.
    pub places: Vec<[u16; 2]>,
    /// Their heights, metres: multiples of [`Self::quantum_m`].
    pub heights_m: Vec<f64>,
    /// Corners, counter-clockwise from above, in an order in which neighbours follow one another; vertices are numbered as
    /// they first appear.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices on the west side from south to north, on the south side from west to east, on the east side from south to
    /// north, on the north side from west to east.
    pub sides: [Vec<u32>; 4],
    /// No sample in or on the tile is further from the mesh vertically, metres.
    pub error_m: f64,
    /// Power of two of which all heights are multiples.
    pub quantum_m: f64,
}

impl TilePiece {
    /// Whether there is nothing in the tile.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Lowest and highest height, metres.
    pub fn height_range_m(&self) -> [f64; 2] {
        self.heights_m.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &z| [low.min(z), high.max(z)])
    }

    /// Numbers vertices as they first appear and drops those that do not.
    pub(super) fn renumber(&mut self) {
        let mut number = vec![u32::MAX; self.places.len()];
        let (mut places, mut heights_m) = (Vec::with_capacity(number.len()), Vec::with_capacity(number.len()));
        for corner in self.triangles.iter_mut().flatten() {
            let old = *corner as usize;
            if number[old] == u32::MAX {
                number[old] = places.len() as u32;
                places.push(self.places[old]);
                heights_m.push(self.heights_m[old]);
            }
            *corner = number[old];
        }
        (self.places, self.heights_m) = (places, heights_m);
    }

    /// Lists the vertices on the sides.
    pub(super) fn find_sides(&mut self) {
        for (side, (axis, at)) in [(0, 0), (1, 0), (0, GRID), (1, GRID)].into_iter().enumerate() {
            let on_side = self.places.iter().enumerate().filter(|(_, p)| u32::from(p[axis]) == at);
            let mut list: Vec<u32> = on_side.map(|(i, _)| i as u32).collect();
            list.sort_unstable_by_key(|&i| self.places[i as usize][1 - axis]);
            self.sides[side] = list;
        }
    }
}
