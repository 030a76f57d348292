//! A large mesh on several processors: patches of it are collapsed side by side, their seams held, up to one common cost
//! after another; then they are joined, and the rest goes on over the whole, where the seams give way too.
//!
//! How a mesh is cut depends on the mesh alone, so the result is the same for any number of threads.

use super::StoppedBy;
use super::appearance::{Appearance, Part};
use super::appearance_sum::Scales;
use super::rounds::{Rounds, Stop};
use super::work::{Work, hold};
use rayon::prelude::*;

/// Triangles of a patch; a mesh of fewer than two patches is not cut.
const PATCH: usize = 150_000;

/// Patches stop this share above the target: the rest is chosen over the whole mesh.
const MARGIN: f64 = 0.15;

/// Collapses a mesh; `sources` are the vertices' numbers in the source, of which there are `source_vertices`.
pub(super) fn run(
    work: &mut Work,
    sources: &mut Vec<u32>,
    source_vertices: usize,
    scales: Option<Scales>,
    stop: Stop,
    progress: &(dyn Fn(usize) + Sync),
) -> (StoppedBy, f64) {
    let mut worst = 0.0;
    let least = stop.faces + (stop.faces as f64 * MARGIN) as usize;
    if work.faces() >= 2 * PATCH && least < work.faces() {
        let whole = std::mem::take(work);
        let was_locked = locked_sources(&whole, sources, source_vertices);
        let (mut appearance, mut patches, seam) = cut(whole, sources);
        // what the seams hold cannot go yet
        let goal = least + FACES_A_SEAM_VERTEX * seam;
        let patch_stop = Stop { faces: 0, error: stop.error };
        let mut all: Vec<Rounds<'_>> =
            patches.par_iter_mut().map(|p| Rounds::new(&mut p.work, &mut p.sources, scales)).collect();
        loop {
            let faces: usize = all.iter().map(Rounds::faces).sum();
            progress(faces);
            let Some(limit) = Rounds::limit_of_sweep(&all, faces, goal) else { break };
            all.par_iter_mut().for_each(|rounds| rounds.sweep(limit, patch_stop));
            if all.iter().map(Rounds::faces).sum::<usize>() == faces {
                break;
            }
        }
        worst = all.iter().map(|rounds| rounds.worst).fold(0.0, f64::max);
        drop(all);
        *work = join(patches, sources, &was_locked, &mut appearance);
    }
    let mut rounds = Rounds::new(work, sources, scales);
    let stopped_by = rounds.run(stop, progress);
    (stopped_by, rounds.worst.max(worst))
}

/// Faces that stay for a vertex of a seam, about.
const FACES_A_SEAM_VERTEX: usize = 4;

/// A part of a mesh.
#[derive(Debug)]
struct Patch {
    work: Work,
    sources: Vec<u32>,
    part: Part,
}

fn locked_sources(work: &Work, sources: &[u32], source_vertices: usize) -> Vec<bool> {
    let mut locked = vec![false; source_vertices];
    for (&source, holds) in sources.iter().zip(&work.holds) {
        locked[source as usize] = holds & hold::LOCKED != 0;
    }
    locked
}

/// Cuts the triangles, which lie along a curve, into runs of about equal length; vertices of several runs are locked.
/// Gives how many these are.
fn cut(mut whole: Work, sources: &[u32]) -> (Appearance, Vec<Patch>, usize) {
    whole.forget_stars();
    let count = whole.triangles.len() / PATCH;
    let size = whole.triangles.len().div_ceil(count);
    const NONE: u32 = u32::MAX;
    let (mut first, mut is_shared) = (vec![NONE; whole.positions.len()], vec![false; whole.positions.len()]);
    for (patch, run) in (0u32..).zip(whole.triangles.chunks(size)) {
        for &v in run.as_flattened() {
            let first = &mut first[v as usize];
            is_shared[v as usize] |= *first != NONE && *first != patch;
            *first = patch.min(*first);
        }
    }
    drop(first);
    let seam = is_shared.iter().filter(|s| **s).count();
    let appearance = std::mem::take(&mut whole.appearance);
    let patches = whole
        .triangles
        .par_chunks(size)
        .enumerate()
        .map(|(number, run)| {
            let mut vertices = run.as_flattened().to_vec();
            vertices.sort_unstable();
            vertices.dedup();
            // found by search: a table of all vertices for each patch would take as much as the mesh
            let local = |v: u32| vertices.binary_search(&v).unwrap_or(0) as u32;
            let triangles = run.iter().map(|t| t.map(local)).collect();
            let positions = vertices.iter().map(|&v| whole.positions[v as usize]).collect();
            let held = |&v: &u32| whole.holds[v as usize] | if is_shared[v as usize] { hold::LOCKED } else { 0 };
            let holds = vertices.iter().map(held).collect();
            let (own, part) = appearance.part(number * size..number * size + run.len());
            Patch {
                work: Work::new(positions, triangles, holds, own),
                sources: vertices.iter().map(|&v| sources[v as usize]).collect(),
                part,
            }
        })
        .collect();
    (appearance, patches, seam)
}

/// Joins patches at their common vertices. `sources` become those of the joined vertices.
fn join(patches: Vec<Patch>, sources: &mut Vec<u32>, was_locked: &[bool], appearance: &mut Appearance) -> Work {
    const NONE: u32 = u32::MAX;
    let mut number = vec![NONE; was_locked.len()];
    let (mut positions, mut holds, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    sources.clear();
    appearance.start_joining();
    for mut patch in patches {
        let mut kept = Vec::with_capacity(patch.sources.len());
        patch.work.compact(|v| kept.push(patch.sources[v as usize]));
        for (v, &source) in kept.iter().enumerate() {
            if number[source as usize] == NONE {
                number[source as usize] = positions.len() as u32;
                positions.push(patch.work.positions[v]);
                let lock = if was_locked[source as usize] { hold::LOCKED } else { 0 };
                holds.push(patch.work.holds[v] & !hold::LOCKED | lock);
                sources.push(source);
            }
        }
        triangles.extend(patch.work.triangles.iter().map(|t| t.map(|v| number[kept[v as usize] as usize])));
        appearance.join(patch.work.appearance, &patch.part);
    }
    Work::new(positions, triangles, holds, std::mem::take(appearance))
}
