//! The smallest mesh whose certified distance from the source, both ways, is within a limit.
//!
//! A collapse estimates what its steps do; only the result can be measured. So it is let run too far, what came out is held
//! against the source, and where a face of either is not certain to be within the limit the last good mesh is pinned: the
//! triangle of it that lies there may not change any more, and the same step is made again. A pin costs a few triangles of a
//! mesh that is already coarse, not of the source. So every part of the surface goes on by itself until it meets the limit.
//!
//! Based on: Cohen et al., "Simplification Envelopes", 1996 (every part goes as far as the limit lets it); Klein, Liebich,
//! Strasser, "Mesh Reduction with Error Control", 1996 (the two-sided distance to the source decides).

use super::{CollapseOptions, Collapsed, StoppedBy, collapse};
use crate::bound::{Beyond, BoundOptions, Judge, distance_bound};
use glam::DVec3;
use std::collections::HashSet;
use yamanami_core::TriangleMesh;

/// Tries of a step, each with more pins.
const TRIES: usize = 7;

/// Tries in which only the worst place of a face is pinned.
const SPARING_TRIES: usize = 3;

/// A step that leaves more than this share of its faces beyond the limit went too far to be mended: the first step, whose pins
/// are as fine as the source, and later ones.
const MOST_BEYOND_FIRST: f64 = 0.002;
const MOST_BEYOND: f64 = 0.25;

/// The first step's largest estimate, by the limit, and how often it may be halved.
const FIRST_ESTIMATE: f64 = 1.0;
const HALVINGS: usize = 12;

/// Share of the free faces that later steps try to take away, the first time in each pass.
const FIRST_SHARES: [f64; 3] = [0.4, 0.2, 0.1];

/// A pass ends when it tries for less than this share, or gets half of that.
const LEAST_SHARE: f64 = 0.02;

/// A mesh that is certain to be within a limit of its source.
#[derive(Debug, Clone)]
pub struct CollapsedWithin {
    /// The mesh.
    pub collapsed: Collapsed,
    /// The two-sided distance to the source is not larger, metres: the limit, or less where the search for a smaller mesh ended early.
    pub certified_m: f64,
}

/// Collapses as far as the two-sided distance to the source is certain to stay within `limit_m`. `options` may hold more
/// back: its largest estimate, its number of faces, its locked vertices. Where nothing can be taken away, the source comes
/// back.
///
/// # Panics
/// As [`collapse`] does.
pub fn collapse_within(mesh: &TriangleMesh, limit_m: f64, options: &CollapseOptions<'_>) -> CollapsedWithin {
    let best = Held::source(mesh, options.locked);
    let kept = places(&mesh.positions, &best.locked);
    let mut search = Search { judge: Judge::new(mesh), limit_m, options, best, kept, tries: 0 };
    if limit_m > 0.0 {
        search.run();
    }
    search.finish(mesh)
}

/// A mesh on the way.
struct Held {
    collapsed: Collapsed,
    /// Vertices that may not change any more.
    locked: Vec<bool>,
}

impl Held {
    fn source(mesh: &TriangleMesh, locked: Option<&[bool]>) -> Self {
        let vertices = mesh.positions.len();
        let collapsed = Collapsed {
            mesh: mesh.clone(),
            source_vertex: (0..vertices as u32).collect(),
            stopped_by: StoppedBy::Error,
            estimate_m: 0.0,
        };
        Self { collapsed, locked: locked.map_or_else(|| vec![false; vertices], <[bool]>::to_vec) }
    }

    /// What a step made of this one, the same places locked.
    fn after(&self, step: Collapsed) -> Self {
        let locked = at_places(&step, &places(&self.collapsed.mesh.positions, &self.locked));
        let source = |&v: &u32| if v == u32::MAX { v } else { self.collapsed.source_vertex[v as usize] };
        let source_vertex = step.source_vertex.iter().map(source).collect();
        let estimate_m = step.estimate_m.max(self.collapsed.estimate_m);
        Self { collapsed: Collapsed { source_vertex, estimate_m, ..step }, locked }
    }
}

/// The places of some vertices, bit for bit.
fn places(positions: &[DVec3], which: &[bool]) -> HashSet<[u64; 3]> {
    positions.iter().zip(which).filter(|(_, which)| **which).map(|(&place, _)| bits(place)).collect()
}

/// Which vertices of a result are untouched and at one of the places: of several at one place the collapse may keep any.
fn at_places(found: &Collapsed, places: &HashSet<[u64; 3]>) -> Vec<bool> {
    let is_at = |(&place, &source): (&DVec3, &u32)| source != u32::MAX && places.contains(&bits(place));
    found.mesh.positions.iter().zip(&found.source_vertex).map(is_at).collect()
}

fn bits(place: DVec3) -> [u64; 3] {
    // both zeros are one place
    place.to_array().map(|v| (v + 0.0).to_bits())
}

struct Search<'a> {
    judge: Judge<'a>,
    limit_m: f64,
    options: &'a CollapseOptions<'a>,
    /// The smallest mesh that is certain to be within the limit.
    best: Held,
    /// Places locked in the source.
    kept: HashSet<[u64; 3]>,
    tries: u32,
}

impl Search<'_> {
    /// One step as far as the estimate leads, then passes of smaller ones. What an early step of a pass has pinned may be free
    /// to go when all around it has changed: hence another pass.
    fn run(&mut self) {
        let options = self.options;
        let mut estimate_m = options.max_error_m.min(self.limit_m * FIRST_ESTIMATE);
        for _ in 0..HALVINGS {
            if self.step(options.target_faces, estimate_m, MOST_BEYOND_FIRST) {
                break;
            }
            estimate_m *= 0.5;
        }
        for share in FIRST_SHARES {
            // what was pinned is free again, but not what had been locked in the source
            self.best.locked = at_places(&self.best.collapsed, &self.kept);
            self.steps(share);
        }
    }

    /// Tries to take the best mesh further. Whether it did.
    fn step(&mut self, mut target_faces: usize, max_error_m: f64, most_beyond: f64) -> bool {
        let mut locked = self.best.locked.clone();
        let before = &self.best.collapsed.mesh;
        let mut here = None;
        let mut max_error_m = max_error_m;
        for attempt in 0..TRIES {
            let options = CollapseOptions {
                target_faces,
                max_error_m,
                locked: Some(&locked),
                method: self.options.method,
                weights: self.options.weights,
                progress: None,
            };
            let found = collapse(before, &options);
            self.tries += 1;
            if let Some(progress) = self.options.progress {
                // how many there will be is not known: a try does a tenth of what is left
                progress(1.0 - 0.9f32.powi(self.tries as i32));
            }
            if found.mesh.triangles.len() >= before.triangles.len() {
                return false;
            }
            max_error_m = max_error_m.min(found.estimate_m);
            let [of_source, of_found] = self.judge.faces_beyond(&found.mesh, self.limit_m);
            if of_source.is_empty() && of_found.is_empty() {
                self.best.locked = locked;
                self.best = self.best.after(found);
                return true;
            }
            let bad = places_by_face(&of_source, &of_found, attempt < SPARING_TRIES);
            if attempt == 0 && bad.len() as f64 > most_beyond * found.mesh.triangles.len() as f64 {
                return false;
            }
            let here = here.get_or_insert_with(|| Judge::new(before));
            let rings = attempt.saturating_sub(SPARING_TRIES);
            // what the pins hold must not be made up for elsewhere
            target_faces += pin(before, &here.nearest(&bad), rings, &mut locked);
        }
        false
    }

    /// Tries smaller and smaller steps until nothing is left to gain.
    fn steps(&mut self, mut share: f64) {
        let options = self.options;
        while share >= LEAST_SHARE {
            let faces = self.best.collapsed.mesh.triangles.len();
            let free = 2 * self.best.locked.iter().filter(|locked| !**locked).count();
            let target = faces - (faces.min(free) as f64 * share) as usize;
            if target.max(options.target_faces) >= faces {
                break;
            }
            if !self.step(target.max(options.target_faces), options.max_error_m, MOST_BEYOND) {
                share *= 0.5;
                continue;
            }
            let gained = faces - self.best.collapsed.mesh.triangles.len();
            if (gained as f64) < LEAST_SHARE * faces as f64 * 0.5 {
                break;
            }
        }
    }

    fn finish(self, mesh: &TriangleMesh) -> CollapsedWithin {
        let mut collapsed = self.best.collapsed;
        let is_at_target = collapsed.mesh.triangles.len() <= self.options.target_faces;
        collapsed.stopped_by = if is_at_target { StoppedBy::Target } else { StoppedBy::Error };
        let certified_m = if collapsed.mesh.triangles.len() == mesh.triangles.len() {
            0.0
        } else {
            distance_bound(mesh, &collapsed.mesh, &BoundOptions::default()).upper_m().min(self.limit_m)
        };
        CollapsedWithin { collapsed, certified_m }
    }
}

/// Places that are too far from the other surface: all, or the worst for each face of the reduced mesh.
fn places_by_face(of_source: &[Beyond], of_found: &[Beyond], worst_only: bool) -> Vec<DVec3> {
    let of_source = of_source.iter().map(|b| (b.nearest, b.distance_m, b.place));
    let of_found = of_found.iter().map(|b| (b.triangle, b.distance_m, b.place));
    let mut places: Vec<(u32, f64, DVec3)> = of_source.chain(of_found).collect();
    places.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    if worst_only {
        places.dedup_by_key(|place| place.0);
    }
    places.into_iter().map(|place| place.2).collect()
}

/// Locks the corners of some triangles and so many rings of neighbours. How many vertices that locked.
fn pin(mesh: &TriangleMesh, triangles: &[u32], rings: usize, locked: &mut [bool]) -> usize {
    let mut pinned = vec![false; locked.len()];
    for &t in triangles {
        mesh.triangles[t as usize].iter().for_each(|&v| pinned[v as usize] = true);
    }
    for _ in 0..rings {
        let inner = pinned.clone();
        for corners in &mesh.triangles {
            if corners.iter().any(|&v| inner[v as usize]) {
                corners.iter().for_each(|&v| pinned[v as usize] = true);
            }
        }
    }
    let mut count = 0;
    for (locked, pinned) in locked.iter_mut().zip(pinned) {
        count += usize::from(pinned && !*locked);
        *locked |= pinned;
    }
    count
}
