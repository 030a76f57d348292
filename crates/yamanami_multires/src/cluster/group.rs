//! Which clusters are simplified together: groups of neighbours with short seams between them.
//!
//! Seams of the round before are dense, for they were locked, so a group that grows over the longest shared seam first
//! puts them inside and lets them be simplified now.

use super::slots::Slots;
use super::split::edge_key;
use super::table::MOST_CLUSTERS;
use glam::DVec3;
use rayon::prelude::*;

/// No group yet.
const NONE: u32 = u32::MAX;

/// What grouping needs to know of a cluster.
pub(super) trait Member: Sync {
    /// Its triangles.
    fn triangles(&self) -> &[[u32; 3]];
    /// About its middle.
    fn centre(&self) -> DVec3;
}

/// For each cluster its neighbours and the edges shared with each, by number.
fn neighbours<M: Member>(members: &[M]) -> Vec<Vec<(u32, u32)>> {
    let mut edges: Vec<(u64, u32)> = (members.par_iter().zip(0u32..members.len() as u32))
        .map_init(Slots::default, |own, (member, number)| {
            own.reset(3 * member.triangles().len());
            for &[a, b, c] in member.triangles() {
                for edge in [edge_key(a, b), edge_key(b, c), edge_key(c, a)] {
                    let slot = own.slot_of(edge);
                    let count = own.value(slot);
                    *count = count.wrapping_add(1);
                }
            }
            // an edge with two triangles here has none elsewhere, unless it is not manifold; counts begin with -1
            own.iter().filter(|&(_, count)| count != 1).map(|(edge, _)| (edge, number)).collect::<Vec<_>>()
        })
        .flatten_iter()
        .collect();
    edges.par_sort_unstable();
    let mut pairs = Vec::new();
    for run in edges.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(_, a)) in run.iter().enumerate() {
            pairs.extend(run[i + 1..].iter().take(MOST_CLUSTERS).map(|&(_, b)| (a, b)));
        }
    }
    pairs.par_sort_unstable();
    let mut lists = vec![Vec::new(); members.len()];
    for run in pairs.chunk_by(|a, b| a == b) {
        let (a, b) = run[0];
        lists[a as usize].push((b, run.len() as u32));
        lists[b as usize].push((a, run.len() as u32));
    }
    lists
}

/// Interleaves the bits of a place within a box of 2¹⁰ cells a side, along a Morton curve.
fn morton(p: DVec3) -> u32 {
    let spread = |x: f64| {
        let x = (x.clamp(0.0, 1.0) * 1023.0) as u32;
        (0..10).fold(0, |sum, bit| sum | (x >> bit & 1) << (3 * bit))
    };
    spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
}

/// Groups under way.
struct Grouping<'a, M> {
    members: &'a [M],
    neighbours: Vec<Vec<(u32, u32)>>,
    group_of: Vec<u32>,
    groups: Vec<Vec<u32>>,
    /// Triangles in each group.
    sizes: Vec<usize>,
}

/// Puts every cluster into one group of at most [`MOST_CLUSTERS`]; most have about `wanted` triangles. `round` makes groups
/// start elsewhere each time.
pub(super) fn group<M: Member>(members: &[M], wanted: usize, round: usize) -> Vec<Vec<u32>> {
    if members.len() <= MOST_CLUSTERS && members.iter().map(|m| m.triangles().len()).sum::<usize>() <= 2 * wanted {
        return vec![(0..members.len() as u32).collect()];
    }
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for member in members {
        low = low.min(member.centre());
        high = high.max(member.centre());
    }
    let side = (high - low).max_element().max(f64::MIN_POSITIVE);
    let mut order: Vec<(u32, u32)> = (members.par_iter().zip(0u32..members.len() as u32))
        .map(|(m, i)| (morton((m.centre() - low) / side), i))
        .collect();
    order.par_sort_unstable();
    if round % 2 == 1 {
        order.reverse();
    }
    let mut grouping = Grouping {
        neighbours: neighbours(members),
        group_of: vec![NONE; members.len()],
        groups: Vec::new(),
        sizes: Vec::new(),
        members,
    };
    for &(_, seed) in &order {
        if grouping.group_of[seed as usize] == NONE {
            grouping.grow(seed, wanted);
        }
    }
    grouping.merge_small(wanted);
    grouping.join_lonely(wanted);
    grouping.groups.retain(|g| !g.is_empty());
    grouping.groups
}

impl<M: Member> Grouping<'_, M> {
    fn size(&self, member: u32) -> usize {
        self.members[member as usize].triangles().len()
    }

    fn put(&mut self, member: u32, group: usize) {
        self.group_of[member as usize] = group as u32;
        self.groups[group].push(member);
        self.sizes[group] += self.size(member);
    }

    /// A group from a seed, always over the longest seam left with it; a tie goes to who has fewer neighbours still free,
    /// lest it be left alone.
    fn grow(&mut self, seed: u32, wanted: usize) {
        let group = self.groups.len();
        self.groups.push(Vec::new());
        self.sizes.push(0);
        self.put(seed, group);
        // free neighbours, with the edges they share with the group
        let mut fringe: Vec<(u32, u32)> = Vec::new();
        let mut last = seed;
        while self.groups[group].len() < MOST_CLUSTERS - 4 {
            for &(n, edges) in &self.neighbours[last as usize] {
                if self.group_of[n as usize] == NONE {
                    match fringe.iter_mut().find(|(m, _)| *m == n) {
                        Some((_, sum)) => *sum += edges,
                        None => fringe.push((n, edges)),
                    }
                }
            }
            let free = |n: u32| self.neighbours[n as usize].iter().filter(|(m, _)| self.group_of[*m as usize] == NONE);
            let best = fringe.iter().enumerate().max_by_key(|&(_, &(n, edges))| {
                // the share of its seams that lie towards the group, or towards nobody free
                let all: u32 = self.neighbours[n as usize].iter().map(|(_, e)| e).sum();
                let open: u32 = free(n).map(|(_, e)| e).sum();
                let share = (edges + all.saturating_sub(open)) * 1000 / all.max(1);
                (share + 4 * edges, std::cmp::Reverse(n))
            });
            let Some((place, &(next, _))) = best else { break };
            if self.sizes[group] + self.size(next) / 2 > wanted {
                break;
            }
            fringe.swap_remove(place);
            self.put(next, group);
            last = next;
        }
    }

    /// Dissolves groups of less than half the wanted size into the neighbour group with the longest seam that has room.
    fn merge_small(&mut self, wanted: usize) {
        let mut small: Vec<(usize, usize)> =
            self.sizes.iter().enumerate().filter(|&(_, &size)| 2 * size < wanted).map(|(g, &size)| (size, g)).collect();
        small.sort_unstable();
        for (_, group) in small {
            if 2 * self.sizes[group] >= wanted {
                continue;
            }
            let mut seams: Vec<(u32, u32)> = Vec::new();
            for &member in &self.groups[group] {
                for &(n, edges) in &self.neighbours[member as usize] {
                    let other = self.group_of[n as usize];
                    if other as usize != group {
                        match seams.iter_mut().find(|(g, _)| *g == other) {
                            Some((_, sum)) => *sum += edges,
                            None => seams.push((other, edges)),
                        }
                    }
                }
            }
            let fits = |other: u32| {
                self.groups[other as usize].len() + self.groups[group].len() <= MOST_CLUSTERS
                    && self.sizes[other as usize] + self.sizes[group] <= 2 * wanted
            };
            let best = seams.into_iter().filter(|&(g, _)| fits(g)).max_by_key(|&(g, e)| (e, std::cmp::Reverse(g)));
            if let Some((other, _)) = best {
                self.pour(group, other as usize);
            }
        }
    }

    fn pour(&mut self, from: usize, into: usize) {
        for member in std::mem::take(&mut self.groups[from]) {
            self.put(member, into);
        }
        self.sizes[from] = 0;
    }

    /// Small groups that found no neighbour with room are put together with the next such group along the curve.
    fn join_lonely(&mut self, wanted: usize) {
        let mut open: Option<usize> = None;
        for group in 0..self.groups.len() {
            if self.groups[group].is_empty() || 2 * self.sizes[group] >= wanted {
                continue;
            }
            match open {
                Some(into) if self.groups[into].len() + self.groups[group].len() <= MOST_CLUSTERS => {
                    self.pour(group, into);
                    open = (2 * self.sizes[into] < wanted).then_some(into);
                }
                _ => open = Some(group),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Strip(Vec<[u32; 3]>, DVec3);

    impl Member for Strip {
        fn triangles(&self) -> &[[u32; 3]] {
            &self.0
        }
        fn centre(&self) -> DVec3 {
            self.1
        }
    }

    #[test]
    fn every_cluster_is_in_one_group_of_neighbours() {
        // quads in a row, ten in each cluster, and three clusters far away
        let quad = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 1, 2 * i + 2, 2 * i + 3]];
        let strip = |c: u32| Strip((10 * c..10 * c + 10).flat_map(quad).collect(), DVec3::X * f64::from(c));
        let mut members: Vec<Strip> = (0..37).map(strip).collect();
        members.extend([100, 200, 300].map(strip));
        for round in 0..2 {
            let groups = group(&members, 160, round);
            let mut all: Vec<u32> = groups.concat();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..40));
            assert!(groups.iter().all(|g| g.len() <= MOST_CLUSTERS));
            assert!(groups.len() <= 7, "{groups:?}");
        }
    }
}
