//! Splitting triangles into compact parts of bounded size: recursive bisection across the longest direction, then
//! triangles exchanged over the cut where that shortens it.
//!
//! Based on: Simon, "Partitioning of unstructured problems for parallel processing", 1991 (inertial bisection); Kernighan
//! and Lin, "An efficient heuristic procedure for partitioning graphs", 1970 (exchange in pairs).

use super::slots::{NONE, Slots};
use glam::{DMat3, DVec3};

/// Sets up to this large are cut with their neighbourhood in view.
const SMALL: usize = 2048;

/// Rounds of exchange a cut.
const EXCHANGES: usize = 6;

/// A triangle to be put somewhere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item {
    /// Its middle.
    centre: [f32; 3],
    /// How far it lies along the direction of the cut at hand.
    along: f32,
    /// Its number.
    pub(super) triangle: u32,
}

impl Item {
    /// A triangle by its corners relative to an origin near by.
    pub(super) fn new(triangle: u32, corners: [DVec3; 3]) -> Self {
        let centre = ((corners[0] + corners[1] + corners[2]) / 3.0).as_vec3().to_array();
        Self { centre, along: 0.0, triangle }
    }

    fn place(&self) -> DVec3 {
        DVec3::from_array(self.centre.map(f64::from))
    }
}

/// How many parts of at most `most` a set is cut into. A little room is left in each for the exchange.
pub(super) fn parts(count: usize, most: usize) -> usize {
    count.div_ceil((most - most / 32).max(1))
}

/// Reorders `items` so that each part is in one piece and gives the parts' lengths in order. `triangles` has the corners by
/// number.
pub(super) fn split(items: &mut [Item], triangles: &[[u32; 3]], most: usize) -> Vec<usize> {
    split_into(items, triangles, most, parts(items.len(), most))
}

fn split_into(items: &mut [Item], triangles: &[[u32; 3]], most: usize, count: usize) -> Vec<usize> {
    if items.len() <= SMALL || count == 1 {
        return Small::new(items, triangles, most).split(items, count);
    }
    let first = items.len() * (count / 2) / count;
    measure(items);
    items.select_nth_unstable_by(first, order);
    let (near, far) = items.split_at_mut(first);
    let (mut lens, more) = rayon::join(
        || split_into(near, triangles, most, count / 2),
        || split_into(far, triangles, most, count - count / 2),
    );
    lens.extend(more);
    lens
}

fn order(a: &Item, b: &Item) -> std::cmp::Ordering {
    a.along.total_cmp(&b.along).then(a.triangle.cmp(&b.triangle))
}

/// Works out how far each item lies along the direction in which the set is longest.
fn measure(items: &mut [Item]) {
    let middle = items.iter().map(Item::place).sum::<DVec3>() / items.len().max(1) as f64;
    let mut spread = DMat3::ZERO;
    for item in items.iter() {
        let off = item.place() - middle;
        spread += DMat3::from_cols(off * off.x, off * off.y, off * off.z);
    }
    let diagonal = DVec3::new(spread.x_axis.x, spread.y_axis.y, spread.z_axis.z);
    let mut axis = match diagonal.to_array() {
        [x, y, z] if x >= y && x >= z => DVec3::X,
        [_, y, z] if y >= z => DVec3::Y,
        _ => DVec3::Z,
    };
    // a rough direction is enough for a cut
    for _ in 0..8 {
        axis = (spread * axis).normalize_or(axis);
    }
    for item in items {
        item.along = (item.place() - middle).dot(axis) as f32;
    }
}

/// A set small enough to keep its neighbourhood at hand. Places in it are those the items have at first.
struct Small {
    most: usize,
    neighbours: Vec<[u32; 3]>,
    /// The piece that each item is in while cuts are made.
    piece: Vec<u32>,
    pieces: u32,
    /// Room to sort in: items by their number, and which of the numbers are there.
    room: Vec<Item>,
    here: Vec<u64>,
}

impl Small {
    fn new(items: &[Item], triangles: &[[u32; 3]], most: usize) -> Self {
        // sides of one edge meet in pairs, in the order of the items
        let mut waiting = Slots::default();
        waiting.reset(3 * items.len());
        let mut neighbours = vec![[NONE; 3]; items.len()];
        for (i, item) in items.iter().enumerate() {
            let [a, b, c] = triangles[item.triangle as usize];
            for (k, (v, w)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
                let slot = waiting.slot_of(edge_key(v, w));
                let other = waiting.value(slot);
                if *other == NONE {
                    *other = (i << 2 | k) as u32;
                    continue;
                }
                neighbours[i][k] = *other >> 2;
                neighbours[(*other >> 2) as usize][(*other & 3) as usize] = i as u32;
                *other = NONE;
            }
        }
        Self { most, neighbours, piece: vec![0; items.len()], pieces: 1, room: items.to_vec(), here: Vec::new() }
    }

    fn split(mut self, items: &mut [Item], count: usize) -> Vec<usize> {
        let triangles: Vec<u32> = items.iter().map(|i| i.triangle).collect();
        // while cuts are made an item's number is its place at first
        for (i, item) in items.iter_mut().enumerate() {
            item.triangle = i as u32;
        }
        let mut lens = Vec::with_capacity(count);
        self.cut(items, count, &mut lens);
        for item in items {
            item.triangle = triangles[item.triangle as usize];
        }
        lens
    }

    fn cut(&mut self, items: &mut [Item], count: usize, lens: &mut Vec<usize>) {
        if count <= 1 {
            lens.push(items.len());
            return;
        }
        let mut first = items.len() * (count / 2) / count;
        measure(items);
        items.select_nth_unstable_by(first, order);
        let sides = [self.pieces, self.pieces + 1];
        self.pieces += 2;
        for (i, item) in items.iter().enumerate() {
            self.piece[item.triangle as usize] = sides[usize::from(i >= first)];
        }
        let most = [self.most * (count / 2), self.most * (count - count / 2)];
        if self.exchange(items, sides, most) {
            first = self.sort(items, sides);
        }
        let (near, far) = items.split_at_mut(first);
        self.cut(near, count / 2, lens);
        self.cut(far, count - count / 2, lens);
    }

    /// Sorts by side, and each side by number. How many are on the first side.
    fn sort(&mut self, items: &mut [Item], sides: [u32; 2]) -> usize {
        self.here.clear();
        self.here.resize(self.room.len().div_ceil(64), 0);
        let mut first = 0;
        for item in items.iter() {
            let number = item.triangle as usize;
            self.room[number] = *item;
            self.here[number / 64] |= 1 << (number % 64);
            first += usize::from(self.piece[number] == sides[0]);
        }
        let mut next = [0, first];
        for (word, &bits) in self.here.iter().enumerate() {
            let mut bits = bits;
            while bits != 0 {
                let number = 64 * word + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let place = &mut next[usize::from(self.piece[number] != sides[0])];
                items[*place] = self.room[number];
                *place += 1;
            }
        }
        first
    }

    /// How many edges the cut loses when an item changes sides.
    fn gain(&self, item: u32, sides: [u32; 2]) -> i32 {
        let own = self.piece[item as usize];
        let other = if own == sides[0] { sides[1] } else { sides[0] };
        let weigh = |&n: &u32| match self.piece.get(n as usize) {
            Some(&piece) if piece == other => 1,
            Some(&piece) if piece == own => -1,
            _ => 0,
        };
        self.neighbours[item as usize].iter().map(weigh).sum()
    }

    /// Moves items over the cut where that makes it shorter, alone while there is room and in pairs otherwise. Whether any
    /// was moved.
    fn exchange(&mut self, items: &[Item], sides: [u32; 2], most: [usize; 2]) -> bool {
        let mut sizes = [0, 0];
        for item in items {
            sizes[usize::from(self.piece[item.triangle as usize] == sides[1])] += 1;
        }
        let mut moved_any = false;
        for _ in 0..EXCHANGES {
            let mut wishes: [Vec<(i32, u32)>; 2] = [Vec::new(), Vec::new()];
            for item in items {
                let gain = self.gain(item.triangle, sides);
                if gain > 0 {
                    let side = usize::from(self.piece[item.triangle as usize] == sides[1]);
                    wishes[side].push((-gain, item.triangle));
                }
            }
            let mut moved = false;
            wishes.iter_mut().for_each(|w| w.sort_unstable());
            let mut next = [0, 0];
            loop {
                // from the larger side first: it makes room on it
                let from = usize::from(sizes[1] * most[0] > sizes[0] * most[1]);
                let turn = [from, 1 - from].into_iter().find(|&side| {
                    next[side] < wishes[side].len() && sizes[1 - side] < most[1 - side] && sizes[side] > 1
                });
                let Some(side) = turn else { break };
                let (_, item) = wishes[side][next[side]];
                next[side] += 1;
                if self.gain(item, sides) > 0 {
                    self.piece[item as usize] = sides[1 - side];
                    sizes[side] -= 1;
                    sizes[1 - side] += 1;
                    moved = true;
                }
            }
            moved_any |= moved;
            if !moved {
                break;
            }
        }
        moved_any
    }
}

/// An edge as one number, the same from both sides.
pub(super) fn edge_key(v: u32, w: u32) -> u64 {
    u64::from(v.min(w)) << 32 | u64::from(v.max(w))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangles of a grid of squares.
    fn grid(n: u32) -> (Vec<[u32; 3]>, Vec<Item>) {
        let mut triangles = Vec::new();
        for y in 0..n {
            for x in 0..n {
                let at = |dx: u32, dy: u32| (y + dy) * (n + 1) + x + dx;
                triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
                triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
        let place = |v: u32| DVec3::new(f64::from(v % (n + 1)), f64::from(v / (n + 1)), 0.0);
        let items = (0u32..).zip(&triangles).map(|(i, t)| Item::new(i, t.map(place))).collect();
        (triangles, items)
    }

    #[test]
    fn parts_are_small_full_and_compact() {
        for (n, most) in [(5, 128), (31, 128), (70, 128), (40, 7), (3, 1)] {
            let (triangles, mut items) = grid(n);
            let lens = split(&mut items, &triangles, most);
            assert_eq!(lens.iter().sum::<usize>(), triangles.len());
            assert!(lens.iter().all(|&len| len > 0 && len <= most), "{n}: {lens:?}");
            assert!(lens.len() <= parts(triangles.len(), most));
            let mut seen: Vec<u32> = items.iter().map(|i| i.triangle).collect();
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..triangles.len() as u32), "each triangle once");
        }
        let (triangles, mut items) = grid(70);
        let lens = split(&mut items, &triangles, 128);
        let mut rest = items.as_slice();
        let mut border = 0;
        for &len in &lens {
            let (part, more) = rest.split_at(len);
            rest = more;
            let mut edges: Vec<u64> = part
                .iter()
                .flat_map(|i| {
                    let [a, b, c] = triangles[i.triangle as usize];
                    [edge_key(a, b), edge_key(b, c), edge_key(c, a)]
                })
                .collect();
            edges.sort_unstable();
            border += edges.chunk_by(|a, b| a == b).filter(|run| run.len() == 1).count();
        }
        // an eight by eight square of 128 triangles has 32 border edges
        assert!(border < 42 * lens.len(), "{} border edges a cluster", border / lens.len());
    }
}
