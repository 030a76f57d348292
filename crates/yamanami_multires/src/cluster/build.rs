//! Building: rounds of grouping and simplifying, from the source to a mesh of a few clusters.

use super::ground::Ground;
use super::group::group;
use super::number::{Numbered, number};
use super::patch::{Live, NEW, Outcome, Reduced, reduce};
use super::sphere::enclose;
use super::split::{Item, split};
use super::weld::{Vertices, weld};
use super::{ClusterBuild, ClusterOptions};
use crate::MultiresError;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use yamanami_core::{Snap, Sphere, Tin, TriangleMesh};

/// Rounds in which next to nothing goes before building gives up: groups change from round to round.
const IDLE_ROUNDS: usize = 3;

/// Share of the triangles that must go in a round that is not idle.
const LEAST_GONE: f64 = 0.005;

/// Times that a group is tried again with more locks before it is left for the next round.
const RETRIES: usize = 4;

/// In no group, or in more than one.
const NO_GROUP: u32 = u32::MAX;
const SHARED: u32 = u32::MAX - 1;

/// A group that was simplified.
#[derive(Debug)]
pub(super) struct Record {
    /// The finer clusters.
    pub(super) members: Vec<Live>,
    /// How many coarser clusters replace them.
    pub(super) coarser: usize,
    /// Vertices that only the coarser patch has.
    pub(super) made: std::ops::Range<u32>,
    /// Bound on the coarser patch's distance from the source, metres.
    pub(super) error_m: f64,
    pub(super) bound: Sphere,
}

/// How a build went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BuildSummary {
    /// Triangles of the source after cleaning.
    pub source_triangles: usize,
    /// Rounds of grouping.
    pub rounds: usize,
    /// Groups, over all rounds, that could not be simplified and were put in another group in the next round.
    pub stuck_groups: usize,
    /// Groups tried again with more locks, because two patches would have met along an edge.
    pub retried_groups: usize,
}

/// Builds the hierarchy of a mesh. Vertices at one place become one, with their colours averaged; texture coordinates and
/// materials are left behind. The result depends on mesh and options only, never on the number of threads.
pub fn build(mesh: &TriangleMesh, options: &ClusterOptions<'_>) -> Result<ClusterBuild, MultiresError> {
    let (vertices, triangles) = weld(mesh)?;
    let mut rounds = Rounds::new(vertices, None, options);
    let leaves = rounds.leaves(triangles);
    let live = rounds.run(leaves, 0)?;
    Ok(rounds.finish(live)?.build)
}

/// Builds the hierarchy of a TIN, its hidden faces left out: errors are vertical, nothing turns over in plan, breaklines
/// and borders stay lines that stray no further than the error says. Vertices that are made lie where `snap` says.
///
/// Expects a mesh without overlap in plan, as [`crate::tin`] makes and mends them.
pub fn build_tin(tin: &Tin, snap: Option<Snap>, options: &ClusterOptions<'_>) -> Result<ClusterBuild, MultiresError> {
    let (vertices, triangles) = weld(&tin.mesh)?;
    let ground = Ground::new(tin, snap, &vertices, &triangles);
    let mut rounds = Rounds::new(vertices, Some(ground), options);
    let leaves = rounds.leaves(triangles);
    let live = rounds.run(leaves, 0)?;
    Ok(rounds.finish(live)?.build)
}

/// What goes from round to round.
pub(super) struct Rounds<'a> {
    cluster_triangles: usize,
    group_triangles: usize,
    pub(super) vertices: Vertices,
    /// What is known of the ground, where it is one.
    pub(super) ground: Option<Ground>,
    /// Vertices that stay, of those there are at the start; none where empty.
    pub(super) is_fixed: Vec<bool>,
    /// Clusters of each of the hierarchies that go on below this one; their numbers go before those of the records.
    pub(super) below: Vec<usize>,
    records: Vec<Record>,
    /// For each vertex the group that has it in this round, [`SHARED`] where several do.
    group_of: Vec<u32>,
    summary: BuildSummary,
    /// Triangles simplified so far, over all rounds.
    done: AtomicUsize,
    progress: Option<&'a (dyn Fn(f32) + Sync)>,
}

impl<'a> Rounds<'a> {
    pub(super) fn new(vertices: Vertices, ground: Option<Ground>, options: &ClusterOptions<'a>) -> Self {
        let cluster_triangles = options.cluster_triangles.clamp(16, 1 << 14);
        Self {
            cluster_triangles,
            group_triangles: cluster_triangles * options.group_clusters.clamp(2, 16),
            vertices,
            ground,
            is_fixed: Vec::new(),
            below: Vec::new(),
            records: Vec::new(),
            group_of: Vec::new(),
            summary: BuildSummary::default(),
            done: AtomicUsize::new(0),
            progress: options.progress,
        }
    }

    /// Rounds until no more than `enough` triangles are left (or a cluster or two), or next to nothing goes any more. Gives
    /// the clusters that are left.
    pub(super) fn run(&mut self, mut live: Vec<Live>, enough: usize) -> Result<Vec<Live>, MultiresError> {
        let count = |live: &[Live]| live.iter().map(|l| l.triangles.len()).sum::<usize>();
        self.summary.source_triangles = count(&live);
        let mut idle = 0;
        loop {
            let before = count(&live);
            if before <= enough.max(2 * self.cluster_triangles) || idle == IDLE_ROUNDS {
                return Ok(live);
            }
            live = self.round(live)?;
            idle = if (before - count(&live)) as f64 > LEAST_GONE * before as f64 { 0 } else { idle + 1 };
        }
    }

    /// Numbers everything, with `live` as the base mesh.
    pub(super) fn finish(self, live: Vec<Live>) -> Result<Numbered, MultiresError> {
        let numbered = number(self.records, live, &self.vertices, self.summary, &self.below)?;
        if let Some(progress) = self.progress {
            progress(1.0);
        }
        Ok(numbered)
    }

    /// The clusters of the source.
    pub(super) fn leaves(&self, triangles: Vec<[u32; 3]>) -> Vec<Live> {
        let positions = &self.vertices.positions;
        let origin = positions[triangles[0][0] as usize];
        let place = |v: u32| positions[v as usize] - origin;
        let mut items: Vec<Item> =
            (triangles.par_iter().enumerate()).map(|(t, corners)| Item::new(t as u32, corners.map(place))).collect();
        let lens = split(&mut items, &triangles, self.cluster_triangles);
        let (mut parts, mut rest) = (Vec::with_capacity(lens.len()), items.as_slice());
        for len in lens {
            let (part, more) = rest.split_at(len);
            parts.push(part);
            rest = more;
        }
        let leaf = |part: &[Item]| {
            let triangles: Vec<[u32; 3]> = part.iter().map(|i| triangles[i.triangle as usize]).collect();
            let sum: DVec3 = triangles.as_flattened().iter().map(|&v| place(v)).sum();
            let centre = origin + sum / (3 * part.len()) as f64;
            Live { triangles, centre, error_m: 0.0, made_by: None, bound: None }
        };
        parts.into_par_iter().map(leaf).collect()
    }

    /// Groups the clusters, simplifies each group, and gives the clusters that are then left.
    fn round(&mut self, live: Vec<Live>) -> Result<Vec<Live>, MultiresError> {
        let groups = group(&live, self.group_triangles, self.summary.rounds);
        self.summary.rounds += 1;
        self.group_of.clear();
        self.group_of.resize(self.vertices.positions.len(), NO_GROUP);
        for (number, members) in (0u32..).zip(&groups) {
            for &v in members.iter().flat_map(|&m| live[m as usize].triangles.as_flattened()) {
                let group = &mut self.group_of[v as usize];
                *group = if *group == NO_GROUP || *group == number { number } else { SHARED };
            }
        }
        let mut outcomes: Vec<Outcome> = groups.par_iter().map(|members| self.reduce(&live, members, &[])).collect();
        self.part_patches(&live, &groups, &mut outcomes);
        self.take_over(live, &groups, outcomes)
    }

    fn reduce(&self, live: &[Live], members: &[u32], more_locked: &[u32]) -> Outcome {
        let members: Vec<&Live> = members.iter().map(|&m| &live[m as usize]).collect();
        let is_fixed = |v: u32| self.is_fixed.get(v as usize).is_some_and(|&fixed| fixed);
        let is_locked =
            |v: u32| self.group_of[v as usize] == SHARED || is_fixed(v) || more_locked.binary_search(&v).is_ok();
        let outcome = reduce(&members, &self.vertices, &is_locked, self.cluster_triangles, self.ground.as_ref());
        if let Some(progress) = self.progress {
            let now = members.iter().map(|m| m.triangles.len()).sum::<usize>();
            let done = now + self.done.fetch_add(now, Ordering::Relaxed);
            // every round has half the triangles of the one before
            progress((done as f32 / (2 * self.summary.source_triangles) as f32).min(0.99));
        }
        outcome
    }

    /// Two patches share a seam; each may get a new edge between the same two vertices of it, and then four triangles meet
    /// there. Groups with a new edge that another patch has too are done again with one end's surroundings locked.
    fn part_patches(&mut self, live: &[Live], groups: &[Vec<u32>], outcomes: &mut [Outcome]) {
        let mut more_locked: Vec<Vec<u32>> = vec![Vec::new(); groups.len()];
        for attempt in 0.. {
            let clashes = clashes(outcomes);
            if clashes.is_empty() {
                return;
            }
            for run in clashes.chunk_by(|a, b| a.0 == b.0) {
                let group = run[0].0 as usize;
                self.summary.retried_groups += 1;
                if attempt == RETRIES {
                    outcomes[group].reduced = None;
                    continue;
                }
                let members = &groups[group];
                for &(_, edge) in run {
                    let end = (edge >> 32) as u32;
                    let triangles = members.iter().flat_map(|&m| &live[m as usize].triangles);
                    more_locked[group].extend(triangles.filter(|t| t.contains(&end)).flatten());
                }
                more_locked[group].sort_unstable();
                more_locked[group].dedup();
                outcomes[group] = self.reduce(live, members, &more_locked[group]);
            }
        }
    }

    /// Numbers the vertices made, records the groups, and passes on the clusters.
    fn take_over(
        &mut self,
        live: Vec<Live>,
        groups: &[Vec<u32>],
        outcomes: Vec<Outcome>,
    ) -> Result<Vec<Live>, MultiresError> {
        let mut live: Vec<Option<Live>> = live.into_iter().map(Some).collect();
        let mut next = Vec::with_capacity(live.len() / 2 + 1);
        for (members, outcome) in groups.iter().zip(outcomes) {
            let members: Vec<Live> = members.iter().filter_map(|&m| live[m as usize].take()).collect();
            match outcome.reduced {
                Some(reduced) => self.record(members, reduced, &mut next)?,
                None => {
                    self.summary.stuck_groups += 1;
                    next.extend(members);
                }
            }
        }
        Ok(next)
    }

    fn record(&mut self, members: Vec<Live>, reduced: Reduced, next: &mut Vec<Live>) -> Result<(), MultiresError> {
        let first = self.vertices.positions.len();
        let end = first + reduced.made.len();
        if end >= NEW as usize {
            let (count, most) = (end as u64, u64::from(NEW));
            return Err(MultiresError::TooManyClusters { what: "vertices", count, most });
        }
        for made in &reduced.made {
            self.vertices.positions.push(made.position);
            self.vertices.normals.push(made.normal);
            self.vertices.colours.push(made.colour);
        }
        let mut points = reduced.positions;
        let mut balls = Vec::new();
        for member in &members {
            balls.extend(member.bound);
            if member.bound.is_none() {
                points.extend(member.triangles.as_flattened().iter().map(|&v| self.vertices.positions[v as usize]));
            }
        }
        balls.dedup();
        let bound = enclose(&points, &balls);
        let error_m = members.iter().map(|m| m.error_m).fold(0.0, f64::max) + reduced.distance_m;
        let group = (self.below.len() + self.records.len()) as u32;
        let coarser = reduced.clusters.len();
        let renumber = |corner: &mut u32| {
            if *corner & NEW != 0 {
                *corner = first as u32 + (*corner & !NEW);
            }
        };
        if let Some(ground) = &mut self.ground {
            let mut lines = reduced.lines;
            lines.as_flattened_mut().iter_mut().for_each(renumber);
            ground.add_lines(&lines);
        }
        for ((place, mut triangles), centre) in (0u16..).zip(reduced.clusters).zip(reduced.centres) {
            triangles.as_flattened_mut().iter_mut().for_each(renumber);
            next.push(Live { triangles, centre, error_m, made_by: Some((group, place)), bound: Some(bound) });
        }
        let made = first as u32..end as u32;
        self.records.push(Record { members, coarser, made, error_m, bound });
        Ok(())
    }
}

/// Groups that have a new edge which another group has too, with the edge, ascending. Of two groups with the same new edge
/// the first may keep it.
fn clashes(outcomes: &[Outcome]) -> Vec<(u32, u64)> {
    let mut new: Vec<(u64, u32)> = Vec::new();
    for (number, outcome) in (0u32..).zip(outcomes) {
        new.extend(outcome.reduced.iter().flat_map(|r| &r.new_edges).map(|&edge| (edge, number)));
    }
    new.sort_unstable();
    let sought: HashSet<u64> = new.iter().map(|&(edge, _)| edge).collect();
    let mut old: Vec<u64> = (outcomes.par_iter())
        .flat_map_iter(|outcome| outcome.locked_edges.iter().copied().filter(|edge| sought.contains(edge)))
        .collect();
    old.sort_unstable();
    let mut clashes = Vec::new();
    for run in new.chunk_by(|a, b| a.0 == b.0) {
        // a group's own finer patch does not have its new edges
        let allowed = usize::from(old.binary_search(&run[0].0).is_err());
        clashes.extend(run.iter().skip(allowed).map(|&(edge, group)| (group, edge)));
    }
    clashes.sort_unstable();
    clashes
}
