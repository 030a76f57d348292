//! One group simplified: its patch with about half the triangles and the same seams, cut into clusters again.

use super::attributes::{Finer, Made};
use super::ground::Ground;
use super::group::Member;
use super::slots::{self, Slots};
use super::sphere::enclose;
use super::split::{Item, edge_key, split};
use super::weld::{Vertices, unit_normal};
use crate::bound::{BoundOptions, distance_bound};
use crate::collapse::{CollapseOptions, collapse};
use glam::DVec3;
use yamanami_core::{Sphere, TriangleMesh};

/// Marks the number of a vertex that a patch makes, until all vertices of the round are counted.
pub(super) const NEW: u32 = 1 << 31;

/// A group with more triangles left than this share of what it had is not worth a node.
const MOST_LEFT: f64 = 0.85;

/// Gap of the bound on the distance of two patches. Bounds of several rounds add up and are then well above the true
/// distance, so a closer one is not worth its time.
const GAP: f64 = 0.1;

/// Steps of a microsecond or so that bounding may take for each triangle; where surfaces cross each other all over it is
/// cut short.
const BOUND_STEPS: u64 = 16;

/// A cluster of the round at hand.
#[derive(Debug, Clone)]
pub(super) struct Live {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) centre: DVec3,
    /// Bound on its distance from the source, metres.
    pub(super) error_m: f64,
    /// The group that made it and its place therein; none for clusters of the source.
    pub(super) made_by: Option<(u32, u16)>,
    /// Holds all that group and those below it.
    pub(super) bound: Option<Sphere>,
}

impl Member for Live {
    fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    fn centre(&self) -> DVec3 {
        self.centre
    }
}

/// A group, simplified.
#[derive(Debug)]
pub(super) struct Reduced {
    /// The coarser clusters. Corners with [`NEW`] are places in `made`.
    pub(super) clusters: Vec<Vec<[u32; 3]>>,
    pub(super) centres: Vec<DVec3>,
    pub(super) made: Vec<Made>,
    /// Bound on the two-sided distance between the finer and the coarser patch, metres.
    pub(super) distance_m: f64,
    /// Holds both patches and all below them.
    pub(super) bound: Sphere,
    /// Edges between two locked vertices that the finer patch does not have.
    pub(super) new_edges: Vec<u64>,
    /// Edges of the coarser patch along breaklines, numbered as `clusters`.
    pub(super) lines: Vec<[u32; 2]>,
}

/// What came of a group.
#[derive(Debug)]
pub(super) struct Outcome {
    /// Edges between two locked vertices in the finer patch, ascending.
    pub(super) locked_edges: Vec<u64>,
    /// None where too little could go.
    pub(super) reduced: Option<Reduced>,
}

/// A patch with numbers of its own.
pub(super) struct Patch {
    pub(super) mesh: TriangleMesh,
    /// The number in the hierarchy of each vertex, ascending.
    pub(super) ids: Vec<u32>,
    pub(super) locked: Vec<bool>,
}

/// A patch with fewer triangles, and numbers of its own.
#[derive(Debug, Default)]
pub(super) struct Coarser {
    pub(super) mesh: TriangleMesh,
    /// For each vertex the finer patch's that it is, untouched, or `u32::MAX`.
    pub(super) source: Vec<u32>,
    /// Edges along breaklines.
    pub(super) lines: Vec<[u32; 2]>,
    /// What is known of the distance already, metres.
    pub(super) stray_m: f64,
    /// For each vertex the finer patch's triangle that it lies in, or `u32::MAX`; empty where that is not known.
    pub(super) under: Vec<u32>,
}

impl Patch {
    fn new(members: &[&Live], vertices: &Vertices, is_locked: &dyn Fn(u32) -> bool) -> Self {
        let count = members.iter().map(|m| m.triangles.len()).sum();
        let mut triangles = Vec::with_capacity(count);
        for member in members {
            triangles.extend_from_slice(&member.triangles);
        }
        let ids = number_in_order(&mut triangles);
        let mut mesh = TriangleMesh::new(ids.iter().map(|&v| vertices.positions[v as usize]).collect(), triangles);
        if vertices.has_colours {
            let opaque = |&v: &u32| {
                let [r, g, b] = vertices.colours[v as usize];
                [r, g, b, 255]
            };
            mesh.colours = ids.iter().map(opaque).collect();
        }
        let locked = ids.iter().map(|&v| is_locked(v)).collect();
        Self { mesh, ids, locked }
    }
}

/// Numbers the vertices of a patch in the order of the numbers that they have, which it gives.
fn number_in_order(triangles: &mut [[u32; 3]]) -> Vec<u32> {
    let mut slots = Slots::default();
    slots.reset(3 * triangles.len());
    let mut found: Vec<u64> = Vec::with_capacity(triangles.len());
    for corner in triangles.as_flattened_mut() {
        let slot = slots.slot_of(u64::from(*corner));
        let value = slots.value(slot);
        if *value == slots::NONE {
            *value = 0;
            found.push(u64::from(*corner) << 32 | slot as u64);
        }
        *corner = slot as u32;
    }
    found.sort_unstable();
    for (number, &entry) in (0u32..).zip(&found) {
        *slots.value(entry as u32 as usize) = number;
    }
    for corner in triangles.as_flattened_mut() {
        *corner = *slots.value(*corner as usize);
    }
    found.into_iter().map(|entry| (entry >> 32) as u32).collect()
}

/// The directed edges between locked vertices, as undirected edges with the surplus of one direction.
fn locked_edges(triangles: &[[u32; 3]], locked: impl Fn(u32) -> Option<u32>) -> Vec<(u64, i32)> {
    let mut edges: Vec<(u64, i32)> = Vec::new();
    for &[a, b, c] in triangles {
        let [la, lb, lc] = [a, b, c].map(&locked);
        for (from, to) in [(la, lb), (lb, lc), (lc, la)] {
            if let (Some(from), Some(to)) = (from, to) {
                edges.push((edge_key(from, to), if from < to { 1 } else { -1 }));
            }
        }
    }
    edges.sort_unstable();
    let mut kept: Vec<(u64, i32)> = Vec::with_capacity(edges.len());
    for (edge, way) in edges {
        match kept.last_mut() {
            Some((last, sum)) if *last == edge => *sum += way,
            _ => kept.push((edge, way)),
        }
    }
    kept
}

/// Simplifies the clusters of a group together. `is_locked` tells the vertices that must stay: those other groups have too.
/// As a piece of ground where `ground` is given, as a scan else.
pub(super) fn reduce(
    members: &[&Live],
    vertices: &Vertices,
    is_locked: &dyn Fn(u32) -> bool,
    cluster_triangles: usize,
    ground: Option<&Ground>,
) -> Outcome {
    let patch = Patch::new(members, vertices, is_locked);
    let finer_edges = locked_edges(&patch.mesh.triangles, |v| patch.locked[v as usize].then(|| patch.ids[v as usize]));
    let target_faces = patch.mesh.triangles.len() / 2;
    let coarser = match ground {
        Some(ground) => ground.reduce(&patch, target_faces),
        None => {
            let options = CollapseOptions { target_faces, locked: Some(&patch.locked), ..CollapseOptions::default() };
            let collapsed = collapse(&patch.mesh, &options);
            Coarser { mesh: collapsed.mesh, source: collapsed.source_vertex, ..Coarser::default() }
        }
    };
    let reduced = keep(&patch, members, coarser, &finer_edges, vertices, cluster_triangles, ground);
    Outcome { locked_edges: finer_edges.into_iter().map(|(edge, _)| edge).collect(), reduced }
}

/// Bound on the distance between the finer and the coarser patch, metres: two-sided, or vertical and along lines on ground.
fn distance_m(patch: &Patch, coarser: &mut Coarser, ground: Option<&Ground>) -> f64 {
    if let Some(ground) = ground {
        return ground.distance_m(patch, coarser);
    }
    let most_steps = Some(BOUND_STEPS * patch.mesh.triangles.len() as u64);
    let bounding = BoundOptions { relative_gap: GAP, at_most_m: 0.0, most_steps };
    distance_bound(&patch.mesh, &coarser.mesh, &bounding).upper_m()
}

/// Whether the coarser patch has every seam of the finer one, once and the same way round, and no locked vertex is lost.
fn keeps_seams(patch: &Patch, finer: &[(u64, i32)], coarser: &[(u64, i32)], is_used: &[bool]) -> bool {
    let has = |edge: u64| coarser.binary_search_by_key(&edge, |e| e.0).map_or(0, |place| coarser[place].1);
    patch.locked.iter().zip(is_used).all(|(&locked, &used)| used || !locked)
        && finer.iter().all(|&(edge, surplus)| surplus == 0 || has(edge) == surplus)
}

fn keep(
    patch: &Patch,
    members: &[&Live],
    mut coarser: Coarser,
    finer_edges: &[(u64, i32)],
    vertices: &Vertices,
    cluster_triangles: usize,
    ground: Option<&Ground>,
) -> Option<Reduced> {
    let (mesh, sources) = (&coarser.mesh, &coarser.source);
    if mesh.triangles.is_empty() || mesh.triangles.len() as f64 > MOST_LEFT * patch.mesh.triangles.len() as f64 {
        return None;
    }
    let mut is_used = vec![false; patch.ids.len()];
    for &v in mesh.triangles.as_flattened() {
        if let Some(used) = is_used.get_mut(sources[v as usize] as usize) {
            *used = true;
        }
    }
    let locked_id = |v: u32| {
        let source = sources[v as usize] as usize;
        patch.locked.get(source).is_some_and(|&l| l).then(|| patch.ids[source])
    };
    let coarser_edges = locked_edges(&mesh.triangles, locked_id);
    if !keeps_seams(patch, finer_edges, &coarser_edges, &is_used) {
        return None;
    }
    let is_new = |edge: &u64| finer_edges.binary_search_by_key(edge, |e| e.0).is_err();
    let new_edges = coarser_edges.iter().map(|e| e.0).filter(is_new).collect();
    let distance_m = distance_m(patch, &mut coarser, ground);

    let mesh = &coarser.mesh;
    let (made, number) = number_vertices(patch, &coarser, vertices);
    let origin = mesh.positions[mesh.triangles[0][0] as usize];
    let mut items: Vec<Item> =
        (0..mesh.triangles.len()).map(|t| Item::new(t as u32, mesh.corners(t).map(|p| p - origin))).collect();
    let lens = split(&mut items, &mesh.triangles, cluster_triangles);
    let (mut clusters, mut centres, mut rest) = (Vec::new(), Vec::new(), items.as_slice());
    for len in lens {
        let (part, more) = rest.split_at(len);
        rest = more;
        let corners = |i: &Item| mesh.triangles[i.triangle as usize];
        clusters.push(part.iter().map(|i| corners(i).map(|v| number[v as usize])).collect::<Vec<_>>());
        let sum: DVec3 = part.iter().flat_map(corners).map(|v| mesh.positions[v as usize] - origin).sum();
        centres.push(origin + sum / (3 * len) as f64);
    }
    let lines = coarser.lines.iter().map(|edge| edge.map(|v| number[v as usize])).collect();
    let bound = bound_of(patch, members, coarser.mesh.positions);
    Some(Reduced { clusters, centres, made, distance_m, bound, new_edges, lines })
}

/// The ball around a patch, the coarser one's places and what is below the members.
fn bound_of(patch: &Patch, members: &[&Live], coarser: Vec<DVec3>) -> Sphere {
    let mut points = coarser;
    let mut balls = Vec::new();
    if members.iter().all(|m| m.bound.is_none()) {
        points.extend_from_slice(&patch.mesh.positions);
    } else {
        let place = |v: &u32| patch.ids.binary_search(v).map(|place| patch.mesh.positions[place]);
        let unbounded = members.iter().filter(|m| m.bound.is_none());
        points.extend(unbounded.flat_map(|m| m.triangles.as_flattened()).flat_map(place));
        balls.extend(members.iter().filter_map(|m| m.bound));
        balls.dedup();
    }
    enclose(&points, &balls)
}

/// The vertices that the collapse made, in the order of their use, and each vertex's number.
fn number_vertices(patch: &Patch, coarser: &Coarser, vertices: &Vertices) -> (Vec<Made>, Vec<u32>) {
    let Coarser { mesh, source: sources, under, .. } = coarser;
    let normals: Vec<[f32; 3]> = patch.ids.iter().map(|&v| vertices.normals[v as usize]).collect();
    let colours: Vec<[u8; 3]> = patch.ids.iter().map(|&v| vertices.colours[v as usize]).collect();
    let finer = Finer::new(&patch.mesh.positions, &patch.mesh.triangles, &normals, &colours);
    let mut made = Vec::new();
    let mut number: Vec<u32> =
        sources.iter().map(|&s| patch.ids.get(s as usize).copied().unwrap_or(u32::MAX)).collect();
    for &v in mesh.triangles.as_flattened() {
        let v = v as usize;
        if number[v] == u32::MAX {
            number[v] = NEW | made.len() as u32;
            let mut vertex = match under.get(v) {
                Some(&triangle) if triangle != u32::MAX => finer.vertex_in(triangle, mesh.positions[v]),
                _ => finer.vertex_at(mesh.positions[v]),
            };
            if let Some(&[r, g, b, _]) = mesh.colours.get(v) {
                vertex.colour = [r, g, b];
            }
            if let Some(&normal) = mesh.normals.get(v) {
                vertex.normal = unit_normal(DVec3::from_array(normal.map(f64::from)));
            }
            made.push(vertex);
        }
    }
    (made, number)
}
