//! A k-d tree over a sample of vertices: blocks with about equally many.
//!
//! Based on: Bentley, "Multidimensional binary search trees used for associative searching", 1975.

use glam::DVec3;

#[derive(Debug, Clone, Copy)]
enum Node {
    /// Below the split on this axis: the node after this one, else the one named.
    Split {
        axis: u8,
        at: f64,
        right: u32,
    },
    Leaf(u16),
}

/// Which block a place belongs to.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    leaves: u16,
}

impl Tree {
    /// Cuts space into so many blocks. Trees of odd rounds cut elsewhere: seams of one lie within blocks of the next.
    pub(super) fn new(mut sample: Vec<DVec3>, leaves: usize, round: usize) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(2 * leaves), leaves: 0 };
        tree.grow(&mut sample, leaves, round);
        tree
    }

    /// Blocks; fewer than asked for where the sample cannot be split.
    pub(super) fn leaves(&self) -> usize {
        self.leaves.into()
    }

    fn grow(&mut self, sample: &mut [DVec3], leaves: usize, round: usize) {
        let split = (leaves > 1).then(|| split(sample, leaves, round)).flatten();
        let Some((axis, middle, left_leaves)) = split else {
            self.nodes.push(Node::Leaf(self.leaves));
            self.leaves += 1;
            return;
        };
        let at = sample[middle][axis];
        let here = self.nodes.len();
        self.nodes.push(Node::Leaf(0));
        let (left, right) = sample.split_at_mut(middle);
        self.grow(left, left_leaves, round);
        self.nodes[here] = Node::Split { axis: axis as u8, at, right: self.nodes.len() as u32 };
        self.grow(right, leaves - left_leaves, round);
    }

    /// The block of a place.
    #[inline]
    pub(super) fn block(&self, p: DVec3) -> u16 {
        let mut node = 0;
        loop {
            match self.nodes[node] {
                Node::Leaf(block) => return block,
                Node::Split { axis, at, right } => {
                    node = if p[usize::from(axis)] < at { node + 1 } else { right as usize };
                }
            }
        }
    }
}

/// The longest axis of the sample's box, where to cut the sample along it, and the blocks on the lower side. The part
/// below lies truly below: equal values go up together.
fn split(sample: &mut [DVec3], leaves: usize, round: usize) -> Option<(usize, usize, usize)> {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &p in &*sample {
        min = min.min(p);
        max = max.max(p);
    }
    let size = (max - min).to_array();
    // the first of equal ones, so that a cube is cut the same way everywhere
    let axis = if size[0] >= size[1] && size[0] >= size[2] { 0 } else { 1 + usize::from(size[2] > size[1]) };
    let left = (if round.is_multiple_of(2) { leaves / 2 } else { leaves / 3 }).max(1);
    let middle = (sample.len() as f64 * left as f64 / leaves as f64) as usize;
    if middle == 0 || middle >= sample.len() || min[axis] == max[axis] {
        return None;
    }
    sample.select_nth_unstable_by(middle, |a, b| a[axis].total_cmp(&b[axis]));
    let at = sample[middle][axis];
    // equal values may be on both sides: all of them go up, or all but the least where that leaves nothing
    let at = if at > min[axis] {
        at
    } else {
        sample.iter().map(|p| p[axis]).filter(|&c| c > at).fold(f64::INFINITY, f64::min)
    };
    let mut below = 0;
    for k in 0..sample.len() {
        if sample[k][axis] < at {
            sample.swap(below, k);
            below += 1;
        }
    }
    let least = (below..sample.len()).find(|&k| sample[k][axis] == at)?;
    sample.swap(below, least);
    Some((axis, below, left))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(points: &[DVec3], tree: &Tree) -> Vec<usize> {
        let mut counts = vec![0; tree.leaves()];
        for &p in points {
            counts[usize::from(tree.block(p))] += 1;
        }
        counts
    }

    #[test]
    fn blocks_are_about_equal() {
        let points: Vec<DVec3> = (0..30_000u64)
            .map(|k| {
                let noise = |a: u64| ((k * a) % 10_007) as f64;
                DVec3::new(noise(7919), noise(6007) * 0.3, noise(4001).sqrt())
            })
            .collect();
        for (leaves, round) in [(1, 0), (2, 0), (7, 0), (7, 1), (100, 0), (100, 1)] {
            let tree = Tree::new(points.clone(), leaves, round);
            assert_eq!(tree.leaves(), leaves);
            let counts = counts(&points, &tree);
            let even = points.len() / leaves;
            assert!(counts.iter().all(|&n| n.abs_diff(even) <= 2 + even / 5), "{counts:?}");
        }
    }

    #[test]
    fn equal_places_stay_together() {
        let mut points = vec![DVec3::ZERO; 1000];
        assert_eq!(Tree::new(points.clone(), 8, 0).leaves(), 1);
        assert_eq!(Tree::new(Vec::new(), 8, 0).leaves(), 1);
        points.extend([DVec3::X; 10]);
        let tree = Tree::new(points.clone(), 2, 0);
        assert_eq!(counts(&points, &tree), [1000, 10]);
    }
}
