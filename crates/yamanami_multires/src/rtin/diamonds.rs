//! Where nodes are and how they are numbered; it never sees a height.
//!
//! Places are whole numbers of half the finest spacing from the centre, x east and y north, so that the middles of the
//! finest edges are places too. A place whose coordinates are both divisible by `2^k` but not by `2^(k+1)` belongs to the
//! lattice of spacing `2^k`; nodes of a lattice with both coordinates odd (in its steps) are cell centres, the others
//! middles of sides. Numbers run lattice by lattice from the coarsest, cell centres first, row by row.

use yamanami_core::{NestedField, NodeId, NodeList};

/// A place in half finest spacings from the centre: east, north.
pub(super) type Place = [i32; 2];

/// The square of a lattice in which its nodes exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Window {
    /// Number of its first node.
    first: NodeId,
    /// Greatest odd coordinate of a node, in steps of the lattice; -1 without nodes.
    odd: i32,
    /// Greatest even coordinate of a node; -1 without nodes.
    even: i32,
}

/// A run of nodes that are rows of one kind.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    /// Number of its first node.
    pub(super) first: NodeId,
    /// Nodes in a row.
    pub(super) columns: usize,
    /// Rows.
    pub(super) rows: usize,
    /// Place of its first node.
    pub(super) place: Place,
    /// Step from a node to the next, east or north.
    pub(super) step: i32,
}

/// A longest edge and the right-angled corners of the triangles at it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Diamond {
    pub(super) ends: [Place; 2],
    /// One of them may lie off the base square.
    pub(super) apexes: [Place; 2],
}

/// All nodes over a nested field.
#[derive(Debug, Clone)]
pub(super) struct Diamonds {
    /// log₂ of half a base square's side.
    base: u32,
    /// By log₂ of the lattice's spacing; no nodes at 0.
    windows: Vec<Window>,
    /// How far from the centre samples are vertices, in steps of their grid; by log₂ of the spacing.
    reach: Vec<i32>,
    bound: NodeId,
}

impl Diamonds {
    /// Lays the nodes over a field; `None` when their numbers do not fit in 32 bits.
    pub(super) fn new(field: &NestedField) -> Option<Self> {
        let grids = u32::try_from(field.levels().len()).ok()?;
        let half = |grid: u32| field.levels()[grid as usize].half();
        let base = half(0).next_power_of_two().trailing_zeros() + grids;
        if base > 28 {
            return None;
        }
        // greatest odd coordinate of the lattices; without it the lattice fills the base square
        let mut odd = vec![None; base as usize];
        if !half(0).is_power_of_two() {
            odd[grids as usize] = Some(half(0) as i32 + 1);
        }
        for k in grids + 1..base {
            let needed = odd[k as usize - 1].map(|finer: i32| ((finer + 1) / 2) | 1);
            odd[k as usize] = needed.filter(|&c| c < 1 << (base - k));
        }
        for grid in 1..grids {
            let k = grids - grid;
            let coarser = odd.get(k as usize + 1).copied().flatten();
            if coarser.is_some() || half(grid) < 1 << (base - k) {
                let inside = coarser.map_or(i32::MAX, |c| 2 * c - 1);
                odd[k as usize] = Some(inside.min(half(grid) as i32 - 1));
            }
        }
        let mut windows = vec![Window { first: 0, odd: -1, even: -1 }; base as usize];
        let mut next = 0u64;
        for k in (1..base).rev() {
            let first = u32::try_from(next).ok()?;
            let full = 1 << (base - k);
            let [odd, even] = odd[k as usize].map_or([full - 1, full], |c| [c, c - 1]);
            windows[k as usize] = Window { first, odd, even };
            next += windows[k as usize].node_count();
        }
        let reach = (0..=grids).map(|k| match k {
            0 => 0,
            k => (half(grids - k) as i32).min(windows[k as usize].odd.max(windows[k as usize].even)),
        });
        Some(Self { base, reach: reach.collect(), windows, bound: u32::try_from(next).ok()? })
    }

    /// One past the greatest number.
    #[inline]
    pub(super) fn bound(&self) -> NodeId {
        self.bound
    }

    /// Half a base square's side.
    #[inline]
    pub(super) fn half_side(&self) -> i32 {
        1 << self.base
    }

    /// log₂ of half a base square's side: all lattices with nodes have smaller spacings, from 1 on.
    pub(super) fn base(&self) -> u32 {
        self.base
    }

    /// How far from the centre samples of spacing `2^k` are vertices, in such steps.
    #[inline]
    pub(super) fn reach(&self, k: u32) -> i32 {
        self.reach[k as usize]
    }

    /// The nodes of a lattice: cell centres, middles of horizontal sides, of vertical sides.
    pub(super) fn blocks(&self, k: u32) -> [Block; 3] {
        let Window { first, odd, even } = self.windows[k as usize];
        let mut first = first;
        [[odd, odd], [odd, even], [even, odd]].map(|[x, y]| {
            let (columns, rows) = ((x + 1) as usize, (y + 1) as usize);
            let block = Block { first, columns, rows, place: [-x << k, -y << k], step: 2 << k };
            first += (columns * rows) as NodeId;
            block
        })
    }

    /// Number of the node at a place, if there is one.
    #[inline]
    pub(super) fn number(&self, [x, y]: Place) -> Option<NodeId> {
        let k = (x | y).trailing_zeros();
        let w = self.windows.get(k as usize)?;
        let (x, y) = (x >> k, y >> k);
        let [across, up] = [x, y].map(|v| if v & 1 == 1 { w.odd } else { w.even });
        if x.abs() > across || y.abs() > up {
            return None;
        }
        let index = ((y + up) >> 1) as u32 * (across + 1) as u32 + ((x + across) >> 1) as u32;
        let m = (w.odd + 1) as u32;
        let before = match (x & 1, y & 1) {
            (1, 1) => 0,
            (1, _) => m * m,
            _ => m * m + m * (w.even + 1) as u32,
        };
        Some(w.first + before + index)
    }

    /// Place of a node.
    #[inline]
    pub(super) fn place(&self, node: NodeId) -> Place {
        let mut k = 1;
        // finest first: most nodes are of the finest lattices
        while node < self.windows[k].first {
            k += 1;
        }
        let w = &self.windows[k];
        let (m, n) = ((w.odd + 1) as u32, (w.even + 1) as u32);
        let mut index = node - w.first;
        let (across, up) = if index < m * m {
            (w.odd, w.odd)
        } else if index < m * (m + n) {
            index -= m * m;
            (w.odd, w.even)
        } else {
            index -= m * (m + n);
            (w.even, w.odd)
        };
        let columns = (across + 1) as u32;
        let (row, column) = (index / columns, index % columns);
        [(2 * column as i32 - across) << k, (2 * row as i32 - up) << k]
    }

    /// Nodes that must be applied before the one at a place: the diamond's right-angled corners.
    pub(super) fn parents(&self, place: Place) -> NodeList {
        self.listed(diamond(place).apexes)
    }

    /// Nodes that have the one at a place as a parent.
    pub(super) fn children(&self, place: Place) -> NodeList {
        self.listed(child_places(place))
    }

    fn listed<const N: usize>(&self, places: [Place; N]) -> NodeList {
        let mut list = NodeList::new();
        for node in places.into_iter().filter_map(|p| self.number(p)) {
            list.insert(node);
        }
        list
    }

    /// The right-angled corners of a diamond that are on the base square.
    pub(super) fn apexes(&self, d: &Diamond) -> impl Iterator<Item = Place> {
        let most = self.half_side();
        d.apexes.into_iter().filter(move |p| p[0].abs() <= most && p[1].abs() <= most)
    }

    /// Depth of the node at a place: 0 for the roots.
    pub(super) fn depth(&self, [x, y]: Place) -> u32 {
        let k = (x | y).trailing_zeros();
        2 * (self.base - 1 - k) + u32::from(!is_centre([x, y], k))
    }
}

impl Window {
    fn node_count(&self) -> u64 {
        let (m, n) = ((self.odd + 1) as u64, (self.even + 1) as u64);
        m * m + 2 * m * n
    }
}

/// Whether a place of the lattice of spacing `2^k` is a cell centre.
#[inline]
pub(super) fn is_centre([x, y]: Place, k: u32) -> bool {
    (x >> k) & (y >> k) & 1 == 1
}

/// The diamond around a place.
#[inline]
pub(super) fn diamond([x, y]: Place) -> Diamond {
    let k = (x | y).trailing_zeros();
    let (i, j) = (x >> k, y >> k);
    let at = |dx: i32, dy: i32| [x + (dx << k), y + (dy << k)];
    if i & j & 1 == 1 {
        // diagonals alternate from cell to cell like the lines of a flag
        let s = if (((i - 1) >> 1) + ((j - 1) >> 1)) & 1 == 0 { 1 } else { -1 };
        Diamond { ends: [at(-1, -s), at(1, s)], apexes: [at(1, -s), at(-1, s)] }
    } else if i & 1 == 1 {
        Diamond { ends: [at(-1, 0), at(1, 0)], apexes: [at(0, -1), at(0, 1)] }
    } else {
        Diamond { ends: [at(0, -1), at(0, 1)], apexes: [at(-1, 0), at(1, 0)] }
    }
}

/// Places of the nodes that split the four triangles which applying a node makes.
#[inline]
pub(super) fn child_places([x, y]: Place) -> [Place; 4] {
    let k = (x | y).trailing_zeros();
    if is_centre([x, y], k) {
        let h = 1 << k;
        [[x - h, y], [x + h, y], [x, y - h], [x, y + h]]
    } else {
        let h = (1 << k) / 2;
        [[x - h, y - h], [x + h, y - h], [x - h, y + h], [x + h, y + h]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::FieldLevel;

    pub(super) fn flat(halves: &[u32]) -> NestedField {
        let level = |(i, &half): (usize, &u32)| {
            FieldLevel::new(8.0 / f64::from(1 << i), half, vec![0.0; ((2 * half + 1) as usize).pow(2)])
        };
        NestedField::new(halves.iter().enumerate().map(level).collect())
    }

    #[test]
    fn numbers_and_places_are_inverse_and_compact() {
        for halves in [&[2][..], &[8], &[6], &[90], &[10, 8], &[16, 32, 64], &[6, 12, 24], &[50, 20, 20, 18]] {
            let d = Diamonds::new(&flat(halves)).unwrap();
            for node in 0..d.bound() {
                let place = d.place(node);
                assert_eq!(d.number(place), Some(node), "{halves:?} {place:?}");
                let roots = d.parents(place).is_empty();
                assert_eq!(roots, node < 4, "{halves:?} {place:?}");
                let on_base = d.apexes(&diamond(place)).count();
                assert!(roots || d.parents(place).len() == on_base, "{halves:?} {place:?} lacks a parent");
            }
        }
    }

    #[test]
    fn every_sample_is_a_vertex_but_a_finer_grid_s_outermost_ring() {
        for halves in [&[8][..], &[6], &[90], &[10, 8], &[16, 32, 64], &[50, 20, 20, 18]] {
            let d = Diamonds::new(&flat(halves)).unwrap();
            let mut samples = 0;
            for (grid, &half) in halves.iter().enumerate() {
                let k = (halves.len() - grid) as u32;
                let ring = half as i32 - i32::from(grid > 0 && d.reach(k) < half as i32);
                assert_eq!(d.reach(k), ring, "{halves:?} grid {grid}");
                for (y, x) in (-ring..=ring).flat_map(|y| (-ring..=ring).map(move |x| (y, x))) {
                    let place = [x << k, y << k];
                    let is_base = place.iter().all(|v| v.abs() & (d.half_side() - 1) == 0);
                    assert!(is_base || d.number(place).is_some(), "{halves:?}: {place:?}");
                }
                samples += (2 * half as usize + 1).pow(2);
            }
            assert!((d.bound() as usize) < samples + 100 + 30 * halves[0] as usize, "{halves:?}: few are made up");
        }
    }
}
