//! Cleaning a scan before it is reduced: each step is asked for by name and says what it changed. Nothing here guesses a
//! surface: holes stay holes.
//!
//! Vertices at one position are one place; faces are judged by their places, so that seams of texture hide no defect.

mod orient;
mod weld;

use glam::DVec3;
use yamanami_core::TriangleMesh;

/// A triangle whose height is below this part of its longest side has no area.
const FLAT_RELATIVE: f64 = 1e-12;

/// What is done, in the order of the fields. The default is nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CleanOptions {
    /// Vertices no farther apart than this, in metres, become one; 0 for those at equal positions.
    pub weld_m: Option<f64>,
    /// Welds vertices of different colours or texture coordinates too; the first one's stay.
    pub weld_across_seams: bool,
    /// Drops faces with two corners at one place.
    pub drop_repeated_corners: bool,
    /// Drops faces whose corners lie in a line. What lay on both sides of one is no longer joined.
    pub drop_zero_area: bool,
    /// Drops faces on the same three places as one before them, whichever way they face.
    pub drop_duplicates: bool,
    /// Drops the parts of a mesh that have fewer faces than this.
    pub min_component_faces: usize,
    /// Turns faces so that neighbours face the same way; in each part as few as possible.
    pub orient: bool,
    /// Drops vertices that no face uses.
    pub drop_isolated: bool,
}

impl CleanOptions {
    /// All that harms no sound mesh: equal positions welded within their seams, faces that are none and those that are
    /// twice dropped, unused vertices dropped.
    pub fn safe() -> Self {
        Self {
            weld_m: Some(0.0),
            drop_repeated_corners: true,
            drop_duplicates: true,
            drop_isolated: true,
            ..Self::default()
        }
    }
}

/// What was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct CleanReport {
    /// Vertices that became one with another.
    pub welded_vertices: usize,
    /// Faces dropped for a repeated corner.
    pub repeated_corner_faces: usize,
    /// Faces dropped for lack of area.
    pub zero_area_faces: usize,
    /// Faces dropped as duplicates.
    pub duplicate_faces: usize,
    /// Parts dropped as too small.
    pub small_components: usize,
    /// Faces of those parts.
    pub small_component_faces: usize,
    /// Faces turned over.
    pub turned_faces: usize,
    /// Edges whose faces cannot be brought to face the same way: the surface is one-sided there.
    pub one_sided_edges: usize,
    /// Vertices dropped as unused.
    pub isolated_vertices: usize,
}

impl CleanReport {
    /// The counts that are not zero, named.
    pub fn changes(&self) -> Vec<(&'static str, usize)> {
        let all = [
            ("vertices welded", self.welded_vertices),
            ("faces with a repeated corner dropped", self.repeated_corner_faces),
            ("faces without area dropped", self.zero_area_faces),
            ("duplicate faces dropped", self.duplicate_faces),
            ("small parts dropped", self.small_components),
            ("faces of small parts dropped", self.small_component_faces),
            ("faces turned over", self.turned_faces),
            ("edges of one-sided surfaces left", self.one_sided_edges),
            ("unused vertices dropped", self.isolated_vertices),
        ];
        all.into_iter().filter(|(_, n)| *n > 0).collect()
    }
}

/// Cleans a mesh in place.
///
/// # Panics
/// When a triangle names a vertex that the mesh does not have, or an attribute is neither empty nor one a vertex.
pub fn clean(mesh: &mut TriangleMesh, options: &CleanOptions) -> CleanReport {
    let mut report = CleanReport::default();
    if let Some(distance_m) = options.weld_m.filter(|d| *d >= 0.0) {
        report.welded_vertices = weld::weld(mesh, distance_m, options.weld_across_seams);
    }
    let by_places = options.drop_repeated_corners
        || options.drop_zero_area
        || options.drop_duplicates
        || options.min_component_faces > 1
        || options.orient;
    if by_places {
        let place = weld::places(mesh);
        drop_shapeless(mesh, &place, options, &mut report);
        if options.drop_duplicates {
            report.duplicate_faces = drop_duplicates(mesh, &place);
        }
        if options.min_component_faces > 1 {
            drop_small(mesh, &place, options.min_component_faces, &mut report);
        }
        if options.orient {
            (report.turned_faces, report.one_sided_edges) = orient::orient(mesh, &place);
        }
    }
    if options.drop_isolated {
        report.isolated_vertices = drop_isolated(mesh);
    }
    report
}

/// Keeps the triangles that are marked, with their materials.
pub(crate) fn keep_faces(mesh: &mut TriangleMesh, keep: &[bool]) {
    let mut kept = keep.iter();
    mesh.triangles.retain(|_| kept.next().is_some_and(|&k| k));
    let mut kept = keep.iter();
    mesh.material_of.retain(|_| kept.next().is_some_and(|&k| k));
}

fn drop_shapeless(mesh: &mut TriangleMesh, place: &[u32], options: &CleanOptions, report: &mut CleanReport) {
    if !options.drop_repeated_corners && !options.drop_zero_area {
        return;
    }
    let mut keep = vec![true; mesh.triangles.len()];
    for (keep, t) in keep.iter_mut().zip(&mesh.triangles) {
        let [a, b, c] = t.map(|i| place[i as usize]);
        let repeated = a == b || b == c || c == a;
        if repeated && options.drop_repeated_corners {
            report.repeated_corner_faces += 1;
            *keep = false;
        } else if !repeated && options.drop_zero_area && is_flat(t.map(|i| mesh.positions[i as usize])) {
            report.zero_area_faces += 1;
            *keep = false;
        }
    }
    keep_faces(mesh, &keep);
}

fn is_flat([p, q, r]: [DVec3; 3]) -> bool {
    let longest = (q - p).length_squared().max((r - q).length_squared()).max((p - r).length_squared());
    (q - p).cross(r - p).length() <= FLAT_RELATIVE * longest
}

fn drop_duplicates(mesh: &mut TriangleMesh, place: &[u32]) -> usize {
    let mut faces: Vec<([u32; 3], u32)> = mesh
        .triangles
        .iter()
        .zip(0..)
        .map(|(t, number)| {
            let mut places = t.map(|i| place[i as usize]);
            places.sort_unstable();
            (places, number)
        })
        .collect();
    rayon::slice::ParallelSliceMut::par_sort_unstable(&mut faces[..]);
    let mut keep = vec![true; faces.len()];
    for pair in faces.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        keep[pair[1].1 as usize] = false;
    }
    keep_faces(mesh, &keep);
    keep.iter().filter(|&&k| !k).count()
}

fn drop_small(mesh: &mut TriangleMesh, place: &[u32], least: usize, report: &mut CleanReport) {
    let mut parent: Vec<u32> = (0..place.len() as u32).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    for &[a, b, c] in &mesh.triangles {
        for other in [b, c] {
            let (p, q) = (root(&mut parent, place[a as usize]), root(&mut parent, place[other as usize]));
            parent[p.max(q) as usize] = p.min(q);
        }
    }
    let parts: Vec<u32> = mesh.triangles.iter().map(|t| root(&mut parent, place[t[0] as usize])).collect();
    let mut faces = vec![0usize; place.len()];
    for &part in &parts {
        faces[part as usize] += 1;
    }
    report.small_components = faces.iter().filter(|&&n| n > 0 && n < least).count();
    report.small_component_faces = faces.iter().filter(|&&n| n < least).sum();
    let keep: Vec<bool> = parts.iter().map(|&part| faces[part as usize] >= least).collect();
    keep_faces(mesh, &keep);
}

fn drop_isolated(mesh: &mut TriangleMesh) -> usize {
    let mut used = vec![false; mesh.positions.len()];
    for &i in mesh.triangles.iter().flatten() {
        used[i as usize] = true;
    }
    let before = mesh.positions.len();
    keep_vertices(mesh, &used);
    before - mesh.positions.len()
}

/// Keeps the vertices that are marked, which are all that faces use, and renumbers the faces.
pub(crate) fn keep_vertices(mesh: &mut TriangleMesh, keep: &[bool]) {
    let mut number_of = Vec::with_capacity(keep.len());
    let mut number = 0u32;
    for &keep in keep {
        number_of.push(number);
        number += u32::from(keep);
    }
    fn retain<T>(values: &mut Vec<T>, keep: &[bool]) {
        let mut kept = keep.iter();
        values.retain(|_| kept.next().is_some_and(|&k| k));
    }
    retain(&mut mesh.positions, keep);
    retain(&mut mesh.normals, keep);
    retain(&mut mesh.colours, keep);
    retain(&mut mesh.texcoords, keep);
    for i in mesh.triangles.iter_mut().flatten() {
        *i = number_of[*i as usize];
    }
}

#[cfg(test)]
mod tests;
