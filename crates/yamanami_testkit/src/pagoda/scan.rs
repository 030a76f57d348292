//! From pieces to a scan: a triangle size that gives the number wanted, every piece cut to that size, noise along the normals,
//! colours.

use super::part::{Part, Parts};
use super::tessellate::Counts;
use super::{Pagoda, defects};
use crate::rng::{scramble, unit_from_bits};
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// Noise as a share of the triangles' size.
const NOISE_SHARE: f64 = 0.15;
/// Noise goes no further than this share of a piece's thickness, so that none is turned inside out.
const NOISE_OF_THICKNESS: f64 = 0.2;
/// Pieces thinner than about this share of the triangles' size are not seen.
const SEEN_SHARE: f64 = 0.2;
/// The coarsest triangles tried.
const COARSEST_M: f64 = 2.0;

/// One piece's share of the mesh.
struct Job<'a> {
    part: &'a Part,
    key: u64,
    first: u32,
    step_m: f64,
    positions: &'a mut [DVec3],
    colours: &'a mut [[u8; 4]],
    triangles: &'a mut [[u32; 3]],
}

pub(super) fn scan(order: &Pagoda, parts: &Parts) -> TriangleMesh {
    let wanted = order.faces.clamp(Pagoda::FEWEST_FACES, Pagoda::MOST_FACES);
    if !order.holes {
        return clean(order, parts, wanted);
    }
    // what is left of a coarse scan tells how much finer this one has to be
    let trial = clean(order, parts, wanted.min(TRIAL_FACES));
    let whole = trial.triangles.len();
    let left = defects::spoil(trial, order.seed).triangles.len();
    let finer = (wanted as f64 * whole as f64 / left.max(1) as f64) as usize;
    defects::spoil(clean(order, parts, finer), order.seed)
}

/// Triangles of the scan on which the share of the holes is measured.
const TRIAL_FACES: usize = 1_000_000;

fn clean(order: &Pagoda, parts: &Parts, wanted: usize) -> TriangleMesh {
    let step_m = step_for(parts, wanted);
    let counts: Vec<Counts> = parts.list.iter().enumerate().map(|(i, p)| counts_of(p, i, step_m)).collect();
    let vertices = counts.iter().map(|c| c.vertices).sum();
    let mut positions = vec![DVec3::ZERO; vertices];
    let mut colours = vec![[0; 4]; vertices];
    let mut triangles = vec![[0; 3]; counts.iter().map(|c| c.triangles).sum()];
    let (mut p, mut c, mut t) = (&mut positions[..], &mut colours[..], &mut triangles[..]);
    let mut jobs = Vec::new();
    let mut first = 0;
    for (i, (part, counts)) in parts.list.iter().zip(&counts).enumerate() {
        let (own_p, own_c, own_t);
        (own_p, p) = p.split_at_mut(counts.vertices);
        (own_c, c) = c.split_at_mut(counts.vertices);
        (own_t, t) = t.split_at_mut(counts.triangles);
        if counts.triangles > 0 {
            let (key, step_m) = (scramble(order.seed ^ scramble(i as u64 + 1)), own_step_m(i, step_m));
            jobs.push(Job { part, key, first, step_m, positions: own_p, colours: own_c, triangles: own_t });
        }
        first += counts.vertices as u32;
    }
    let noise_m = order.noise_m.unwrap_or(NOISE_SHARE * step_m);
    jobs.into_par_iter().for_each(|job| make(job, noise_m));
    TriangleMesh { colours, ..TriangleMesh::new(positions, triangles) }
}

/// Equal pieces are cut a little differently: else all would gain a row of triangles at once, and most numbers were out of
/// reach.
fn own_step_m(index: usize, step_m: f64) -> f64 {
    step_m * (0.93 + 0.14 * unit_from_bits(scramble(2 * index as u64 + 1)))
}

fn counts_of(part: &Part, index: usize, step_m: f64) -> Counts {
    let seen_m = SEEN_SHARE * step_m * (0.75 + 0.5 * unit_from_bits(scramble(2 * index as u64)));
    if part.thickness_m < seen_m {
        return Counts { vertices: 0, triangles: 0 };
    }
    part.form.counts(own_step_m(index, step_m))
}

/// The triangle side at which the number of triangles comes nearest.
fn step_for(parts: &Parts, wanted: usize) -> f64 {
    let count = |step_m: f64| -> usize {
        parts.list.par_iter().enumerate().map(|(i, p)| counts_of(p, i, step_m).triangles).sum()
    };
    let mut coarse = COARSEST_M;
    while count(0.5 * coarse) < wanted {
        coarse *= 0.5;
    }
    let mut fine = 0.5 * coarse;
    let mut best = [fine, coarse].map(|s| (count(s).abs_diff(wanted), s));
    best.sort_by_key(|b| b.0);
    let mut best = best[0];
    for _ in 0..40 {
        let middle = 0.5 * (fine + coarse);
        let found = count(middle);
        if found.abs_diff(wanted) < best.0 {
            best = (found.abs_diff(wanted), middle);
        }
        if found == wanted {
            break;
        } else if found > wanted {
            fine = middle;
        } else {
            coarse = middle;
        }
    }
    best.1
}

fn make(job: Job<'_>, noise_m: f64) {
    let part = job.part;
    part.form.fill(job.step_m, &part.place, job.first, job.positions, job.triangles);
    for (p, c) in job.positions.iter().zip(job.colours) {
        *c = part.material.colour(*p, job.key);
    }
    let noise_m = noise_m.min(NOISE_OF_THICKNESS * part.thickness_m);
    if noise_m > 0.0 {
        let normals = normals(job.positions, job.triangles, job.first);
        for (i, (p, n)) in job.positions.iter_mut().zip(normals).enumerate() {
            let bits = scramble(job.key.wrapping_add(i as u64));
            // two throws: small errors are likelier than large ones
            let throws = unit_from_bits(bits) + unit_from_bits(scramble(bits ^ 1));
            *p += n.normalize_or_zero() * (throws - 1.0) * noise_m;
        }
    }
}

/// Vertex normals by area, not of unit length.
fn normals(positions: &[DVec3], triangles: &[[u32; 3]], first: u32) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; positions.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| (i - first) as usize);
        let across = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
        [a, b, c].into_iter().for_each(|i| normals[i] += across);
    }
    normals
}

#[cfg(test)]
mod tests {
    use super::super::{building, plan};
    use super::*;
    use std::collections::HashSet;

    /// Panics with what is wrong: edges run along twice the same way, or by more than two; no area; doubled triangles.
    fn assert_manifold(mesh: &TriangleMesh) {
        let mut edges = HashSet::new();
        let mut faces = HashSet::new();
        for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            for edge in [[a, b], [b, c], [c, a]] {
                assert!(edges.insert(edge), "triangle {t} runs along {edge:?} once more");
            }
            let mut corners = [a, b, c];
            corners.sort_unstable();
            assert!(faces.insert(corners), "triangle {t} is there twice");
            let [p, q, r] = mesh.corners(t);
            let longest = (q - p).length_squared().max((r - q).length_squared()).max((p - r).length_squared());
            let area = (q - p).cross(r - p).length();
            assert!(area > 1e-6 * longest, "triangle {t} has no area: {p} {q} {r}");
        }
    }

    /// The pieces of a mesh one by one: their volume, and whether they are closed.
    fn volumes(order: &Pagoda) -> Vec<(usize, f64, bool)> {
        let parts = building();
        let step_m = step_for(&parts, order.faces);
        let mesh = clean(order, &parts, order.faces);
        let mut start = 0;
        let mut found = Vec::new();
        for (i, part) in parts.list.iter().enumerate() {
            let n = counts_of(part, i, step_m).triangles;
            let triangles = &mesh.triangles[start..start + n];
            let edges: HashSet<[u32; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            let closed = edges.iter().all(|&[a, b]| edges.contains(&[b, a]));
            let origin = triangles.first().map_or(DVec3::ZERO, |t| mesh.positions[t[0] as usize]);
            let volume = (start..start + n)
                .map(|t| mesh.corners(t).map(|p| p - origin))
                .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
                .sum();
            if n > 0 {
                found.push((i, volume, closed));
            }
            start += n;
        }
        assert_eq!(start, mesh.triangles.len());
        found
    }

    #[test]
    fn the_number_of_faces_is_met() {
        for faces in [2_000, 9_000, 30_000, 100_000, 240_000] {
            let found = Pagoda::new(faces).to_mesh().triangles.len();
            assert!(found.abs_diff(faces) * 100 <= faces, "{found} for {faces}");
        }
    }

    #[test]
    fn every_number_up_to_the_most_is_within_reach() {
        let parts = building();
        for faces in [700_000, 1_560_719, 7_803_599, Pagoda::MOST_FACES] {
            let step_m = step_for(&parts, faces);
            let found: usize = parts.list.iter().enumerate().map(|(i, p)| counts_of(p, i, step_m).triangles).sum();
            assert!(found.abs_diff(faces) * 1000 <= faces, "{found} for {faces}");
        }
    }

    #[test]
    fn a_clean_scan_is_a_manifold_with_or_without_noise() {
        assert_manifold(&Pagoda::new(150_000).to_mesh());
        assert_manifold(&Pagoda { noise_m: Some(0.0), ..Pagoda::new(500_000) }.to_mesh());
    }

    #[test]
    fn closed_pieces_face_outward_and_only_roofs_and_rafters_have_borders() {
        // four slopes on five roofs, and two rows of rafters under each; the coarse scan misses the rafters
        let coarse = Pagoda { noise_m: Some(0.0), ..Pagoda::new(20_000) };
        for (order, borders) in [(Pagoda::new(400_000), 60), (coarse, 20)] {
            let pieces = volumes(&order);
            assert_eq!(pieces.iter().filter(|p| !p.2).count(), borders);
            for (piece, volume, closed) in pieces {
                assert!(!closed || volume > 0.0, "piece {piece} has the volume {volume}");
            }
        }
    }

    #[test]
    fn equal_orders_give_equal_scans_and_seeds_differ() {
        let order = Pagoda::new(20_000);
        assert_eq!(order.to_mesh(), order.to_mesh());
        let other = Pagoda { seed: 2, ..order }.to_mesh();
        assert_ne!(order.to_mesh().positions, other.positions);
        assert_eq!(order.to_mesh().triangles, other.triangles);
    }

    #[test]
    fn the_tower_stands_on_the_ground_and_its_regions_lie_in_it() {
        let mesh = Pagoda::new(100_000).to_mesh();
        assert_eq!(mesh.colours.len(), mesh.positions.len());
        let bounds = mesh.bounds();
        assert!(bounds.min.z.abs() < 0.03 && (bounds.max.z - plan::height_m()).abs() < 0.06, "{bounds:?}");
        assert!((bounds.max.x + bounds.min.x).abs() < 0.05, "{bounds:?}");
        for region in Pagoda::regions() {
            let c = region.centre_m;
            assert_eq!(c.clamp(bounds.min, bounds.max), c, "{}", region.name);
            let seen = mesh.positions.iter().filter(|p| p.distance(c) < region.radius_m).count();
            assert!(seen > 60, "{}: {seen} vertices", region.name);
        }
    }

    #[test]
    fn holes_take_away_and_add_but_keep_the_number() {
        let order = Pagoda { holes: true, ..Pagoda::new(200_000) };
        let mesh = order.to_mesh();
        assert!(mesh.triangles.len().abs_diff(200_000) <= 2_000, "{}", mesh.triangles.len());
        let mut used = vec![false; mesh.positions.len()];
        mesh.triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
        assert!(used.into_iter().all(|u| u), "no vertex is left over");
        let mut faces = HashSet::new();
        let doubled = mesh.triangles.iter().filter(|t| {
            let mut corners = **t;
            corners.sort_unstable();
            !faces.insert(corners)
        });
        assert!(doubled.count() >= 3);
    }
}
