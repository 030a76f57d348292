//! How the triangles of a tile lie in plan: flipped, empty, apart inside, and whether they fill the tile.
//!
//! On the lattice of a quantised tile all of it is exact.

use std::collections::HashMap;

/// What is wrong with a tile's triangles in plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct PlanFaults {
    /// Triangles without an area.
    pub degenerate: usize,
    /// Triangles that turn clockwise seen from above.
    pub flipped: usize,
    /// The first of either.
    pub first: Option<usize>,
    /// Sides of triangles inside the tile that no other shares: slits, T-vertices, holes.
    pub open_edges: usize,
    /// Twice the area of all triangles that are not flipped, in squares of the lattice.
    pub twice_area: i64,
}

/// Judges triangles on a lattice with `side` steps from border to border.
pub fn plan_faults(vertices: &[[u16; 3]], triangles: &[[u32; 3]], side: u16) -> PlanFaults {
    let mut found = PlanFaults::default();
    let place = |corner: u32| {
        let [u, v, _] = vertices[corner as usize];
        [u, v]
    };
    // edges by place, so that seams of normals or textures are none here
    let mut edges: HashMap<[[u16; 2]; 2], i32> = HashMap::with_capacity(2 * triangles.len());
    for (number, corners) in triangles.iter().enumerate() {
        let [a, b, c] = corners.map(place);
        let d = |p: [u16; 2]| [i64::from(p[0]) - i64::from(a[0]), i64::from(p[1]) - i64::from(a[1])];
        let ([bx, by], [cx, cy]) = (d(b), d(c));
        let turn = bx * cy - by * cx;
        if turn <= 0 {
            found.first = found.first.or(Some(number));
        }
        match turn.signum() {
            0 => {
                // its sides may still close a slit
                found.degenerate += 1;
            }
            -1 => found.flipped += 1,
            _ => found.twice_area += turn,
        }
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (key, way) = if p < q { ([p, q], 1) } else { ([q, p], -1) };
            if p != q {
                *edges.entry(key).or_default() += way;
            }
        }
    }
    let on_border = |[p, q]: [[u16; 2]; 2]| (0..2).any(|k| p[k] == q[k] && (p[k] == 0 || p[k] == side));
    found.open_edges = edges.iter().filter(|&(&edge, &ways)| ways != 0 && !on_border(edge)).count();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[u16; 3]; 5] = [[0, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [4, 4, 0]];

    #[test]
    fn a_fan_fills_its_square() {
        let fan = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let sound = plan_faults(&SQUARE, &fan, 8);
        assert_eq!(sound, PlanFaults { twice_area: 128, ..PlanFaults::default() });
        let holed = plan_faults(&SQUARE, &fan[..3], 8);
        assert_eq!((holed.open_edges, holed.twice_area), (2, 96));
        let mut flipped = fan;
        flipped[1].swap(0, 1);
        let flipped = plan_faults(&SQUARE, &flipped, 8);
        assert_eq!((flipped.flipped, flipped.first), (1, Some(1)));
        // a corner on the diagonal of a neighbour
        let t_vertex = plan_faults(&SQUARE, &[[0, 1, 2], [0, 4, 3], [4, 2, 3]], 8);
        assert_eq!((t_vertex.open_edges, t_vertex.twice_area), (3, 128));
        assert_eq!(plan_faults(&SQUARE, &[[0, 4, 2]], 8).degenerate, 1);
    }
}
