//! The side of a model that no view sees: cut away, and the cut closed.
//!
//! Based on: Mizuno, Okumoto, Takata, Joe, who replace the back of a building by one polygon.

use crate::polygon::cut_into_triangles;
use crate::{Canvas, DrawWith, Error};
use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::{TriangleMesh, View};
use yamanami_gpu::{software, vertex_normals};

/// A closing polygon that shows at no more samples of a view than this (four a pixel) does not show.
const MOST_SAMPLES_SHOWN: u64 = 16;
/// Times that showing triangles of closing polygons are left out.
const TRIMMING_ROUNDS: usize = 4;

/// A model without the side that no view sees.
#[derive(Debug, Clone)]
pub struct SeenSide {
    /// What is left.
    pub mesh: TriangleMesh,
    /// Faces taken away.
    pub hidden_faces: usize,
}

/// Takes away what no view sees, but for one ring of triangles around what is seen. Of triangles smaller than a pixel those
/// stay that are not clearly behind others.
pub fn seen_side(mesh: &TriangleMesh, views: &[View]) -> Result<SeenSide, Error> {
    let canvas = Canvas::of_mesh(mesh, DrawWith::Software)?;
    let mut is_seen = vec![false; mesh.triangles.len()];
    for view in views {
        let seen = software::visibility(canvas.buffers(), view)?.may_be_seen;
        is_seen.iter_mut().zip(seen).for_each(|(all, one)| *all |= one);
    }
    let mut near = vec![false; mesh.positions.len()];
    for (corners, _) in mesh.triangles.iter().zip(&is_seen).filter(|&(_, &seen)| seen) {
        corners.iter().for_each(|&c| near[c as usize] = true);
    }
    let kept: Vec<bool> = mesh.triangles.iter().map(|corners| corners.iter().any(|&c| near[c as usize])).collect();
    let hidden_faces = kept.iter().filter(|&&kept| !kept).count();
    Ok(SeenSide { mesh: part_of(mesh, &kept), hidden_faces })
}

/// The triangles that are kept, with the vertices they use and all their attributes.
fn part_of(mesh: &TriangleMesh, kept: &[bool]) -> TriangleMesh {
    let mut number = vec![u32::MAX; mesh.positions.len()];
    let mut sources = Vec::new();
    let mut triangles = Vec::new();
    for (corners, _) in mesh.triangles.iter().zip(kept).filter(|&(_, &kept)| kept) {
        triangles.push(corners.map(|c| {
            let number = &mut number[c as usize];
            if *number == u32::MAX {
                *number = sources.len() as u32;
                sources.push(c as usize);
            }
            *number
        }));
    }
    fn picked<T: Copy>(all: &[T], sources: &[usize]) -> Vec<T> {
        sources.iter().filter_map(|&s| all.get(s).copied()).collect()
    }
    let material_of = mesh.material_of.iter().zip(kept).filter(|&(_, &kept)| kept).map(|(&m, _)| m).collect();
    TriangleMesh {
        positions: picked(&mesh.positions, &sources),
        triangles,
        normals: picked(&mesh.normals, &sources),
        colours: picked(&mesh.colours, &sources),
        texcoords: picked(&mesh.texcoords, &sources),
        materials: mesh.materials.clone(),
        material_of,
    }
}

/// How a cut was closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Closing {
    /// Polygons put in.
    pub polygons: usize,
    /// Corners of the largest.
    pub largest: usize,
    /// Triangles they were cut into.
    pub faces: usize,
    /// Borders of which a part is left open, because the polygon would show there.
    pub left_open: usize,
}

/// Closes every border of a mesh by one polygon. One that would show in the only view is moved along its rays to behind the
/// model, with walls that are seen edge-on. Triangles of it that show all the same are left out: where a border crosses
/// itself as seen, and over holes of the source. The mesh keeps the normals that it had open, so that the closing does
/// not bend the light on what is seen.
pub fn close(mesh: &TriangleMesh, views: &[View]) -> Result<(TriangleMesh, Closing), Error> {
    let borders = borders(mesh);
    // where one view is given, the polygon is laid out as that sees it: then it covers nothing beside the model
    let mut patches: Vec<Patch> = borders.iter().map(|border| Patch::flat(mesh, border, views)).collect();
    if let [view] = views {
        let shown = shown(mesh, &patches, views)?;
        for ((patch, border), shown) in patches.iter_mut().zip(&borders).zip(shown) {
            if shown.iter().sum::<u64>() > MOST_SAMPLES_SHOWN {
                *patch = Patch::behind(mesh, border, view);
            }
        }
    }
    let whole: Vec<usize> = patches.iter().map(|patch| patch.triangles.len()).collect();
    // what is left out may have hidden more of the same
    for _ in 0..TRIMMING_ROUNDS {
        let shown = shown(mesh, &patches, views)?;
        let mut trimmed = false;
        for (patch, shown) in patches.iter_mut().zip(shown) {
            if shown.iter().sum::<u64>() > MOST_SAMPLES_SHOWN {
                let mut samples = shown.into_iter();
                patch.triangles.retain(|_| samples.next() == Some(0));
                trimmed = true;
            }
        }
        if !trimmed {
            break;
        }
    }
    let mut closed = mesh.clone();
    if closed.normals.is_empty() {
        closed.normals = vertex_normals(mesh);
    }
    let mut closing = Closing::default();
    for ((patch, border), whole) in patches.iter().zip(&borders).zip(whole) {
        closing.left_open += usize::from(patch.triangles.len() < whole);
        if !patch.triangles.is_empty() {
            closing.polygons += 1;
            closing.largest = closing.largest.max(border.len());
            closing.faces += patch.triangles.len();
            patch.put_on(&mut closed);
        }
    }
    Ok((closed, closing))
}

/// What closes a border.
#[derive(Debug, Clone, Default)]
struct Patch {
    /// Corners: below `first` the mesh's vertices, from there on those of `added`.
    triangles: Vec<[u32; 3]>,
    /// Vertices of the mesh that it was made for.
    first: u32,
    /// Vertices of its own, each a vertex of the mesh in another place.
    added: Vec<(u32, DVec3)>,
}

impl Patch {
    fn flat(mesh: &TriangleMesh, border: &[u32], views: &[View]) -> Self {
        let triangles = cut_into_triangles(&mesh.positions, border, views);
        Self { triangles, first: mesh.positions.len() as u32, added: Vec::new() }
    }

    /// The polygon on a plane behind the whole mesh.
    fn behind(mesh: &TriangleMesh, border: &[u32], view: &View) -> Self {
        let depth = |p: DVec3| (p - view.eye).dot(view.forward());
        let farthest = mesh.positions.iter().map(|&p| depth(p)).fold(0.0, f64::max);
        let first = mesh.positions.len() as u32;
        let pushed = |&v: &u32| {
            let place = mesh.positions[v as usize];
            (v, view.eye + (place - view.eye) * (farthest / depth(place)))
        };
        if border.iter().any(|&v| depth(mesh.positions[v as usize]) <= 0.0) {
            return Self::default();
        }
        let added: Vec<(u32, DVec3)> = border.iter().map(pushed).collect();
        let places: Vec<DVec3> = added.iter().map(|&(_, place)| place).collect();
        let ring: Vec<u32> = (0..border.len() as u32).collect();
        let mut triangles: Vec<[u32; 3]> = cut_into_triangles(&places, &ring, std::slice::from_ref(view))
            .into_iter()
            .map(|corners| corners.map(|c| c + first))
            .collect();
        for (k, &near) in border.iter().enumerate() {
            let next = (k + 1) % border.len();
            let (far, far_next) = (first + k as u32, first + next as u32);
            triangles.extend([[near, border[next], far_next], [near, far_next, far]]);
        }
        Self { triangles, first, added }
    }

    /// Adds the patch to the mesh, on which others may be already.
    fn put_on(&self, mesh: &mut TriangleMesh) {
        let now = mesh.positions.len() as u32;
        let place = |c: u32| if c >= self.first { c - self.first + now } else { c };
        mesh.triangles.extend(self.triangles.iter().map(|corners| corners.map(place)));
        for &(like, position) in &self.added {
            let like = like as usize;
            mesh.positions.push(position);
            again(&mut mesh.normals, like);
            again(&mut mesh.colours, like);
            again(&mut mesh.texcoords, like);
        }
        if !mesh.material_of.is_empty() {
            mesh.material_of.resize(mesh.triangles.len(), 0);
        }
    }
}

/// Appends an attribute once more, where the mesh has it.
fn again<T: Copy>(attributes: &mut Vec<T>, like: usize) {
    if let Some(&value) = attributes.get(like) {
        attributes.push(value);
    }
}

/// The most samples of any view at which each triangle of each patch shows, with all of them put on.
fn shown(mesh: &TriangleMesh, patches: &[Patch], views: &[View]) -> Result<Vec<Vec<u64>>, Error> {
    let mut patched = TriangleMesh::new(mesh.positions.clone(), mesh.triangles.clone());
    patches.iter().for_each(|patch| patch.put_on(&mut patched));
    // normals do not decide what shows, and need not be worked out
    patched.normals = vec![[0.0, 0.0, 1.0]; patched.positions.len()];
    let canvas = Canvas::of_mesh(&patched, DrawWith::Software)?;
    let mut shown: Vec<Vec<u64>> = patches.iter().map(|patch| vec![0; patch.triangles.len()]).collect();
    for view in views {
        let samples = software::visibility(canvas.buffers(), view)?.samples;
        let added = samples[mesh.triangles.len()..].iter();
        shown.iter_mut().flatten().zip(added).for_each(|(most, &one)| *most = (*most).max(u64::from(one)));
    }
    Ok(shown)
}

/// The borders of a mesh as rings of vertices, turned so that a polygon on them faces out where the mesh does.
fn borders(mesh: &TriangleMesh) -> Vec<Vec<u32>> {
    let mut sides: HashMap<[u32; 2], u32> = HashMap::new();
    for corners in &mesh.triangles {
        for k in 0..3 {
            *sides.entry([corners[k], corners[(k + 1) % 3]]).or_default() += 1;
        }
    }
    // a border runs against the sides of its triangles
    let mut after: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut starts = Vec::new();
    for corners in &mesh.triangles {
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            if sides[&[from, to]] == 1 && !sides.contains_key(&[to, from]) {
                after.entry(to).or_default().push(from);
                starts.push(to);
            }
        }
    }
    let mut rings = Vec::new();
    for start in starts {
        // where borders touch in a vertex, each ring ends when it comes back to a vertex that it has
        let mut ring = vec![start];
        let mut place: HashMap<u32, usize> = HashMap::from([(start, 0)]);
        while let Some(next) = ring.last().and_then(|last| after.get_mut(last)).and_then(Vec::pop) {
            if let Some(&first) = place.get(&next) {
                let closed = ring.split_off(first);
                closed.iter().for_each(|v| _ = place.remove(v));
                if closed.len() > 2 {
                    rings.push(closed);
                }
            }
            place.insert(next, ring.len());
            ring.push(next);
        }
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_views;

    /// A ball of so many rings of twice as many squares.
    fn ball(rings: u32) -> TriangleMesh {
        let (mut mesh, across) = (TriangleMesh::default(), 2 * rings);
        let at = |ring: u32, k: u32| 2 + (ring - 1) * across + k % across;
        mesh.positions = vec![DVec3::Z, -DVec3::Z];
        for ring in 1..rings {
            let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            for k in 0..across {
                let azimuth = std::f64::consts::TAU * f64::from(k) / f64::from(across);
                mesh.positions.push(DVec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()));
            }
        }
        for k in 0..across {
            mesh.triangles.push([0, at(1, k), at(1, k + 1)]);
            mesh.triangles.push([1, at(rings - 1, k + 1), at(rings - 1, k)]);
            for ring in 1..rings - 1 {
                let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1)];
                mesh.triangles.extend([[a, c, d], [a, d, b]]);
            }
        }
        mesh
    }

    #[test]
    fn the_back_of_a_ball_becomes_one_polygon_that_does_not_show() {
        let ball = ball(24);
        assert!(borders(&ball).is_empty());
        let views = model_views(&ball.positions, 1, [160, 120]);
        let seen = seen_side(&ball, &views).unwrap();
        let share = seen.hidden_faces as f64 / ball.triangles.len() as f64;
        assert!(share > 0.35 && share < 0.6, "{share}");
        assert_eq!(borders(&seen.mesh).len(), 1);
        let before = Canvas::of_mesh(&seen.mesh, DrawWith::Software).unwrap();
        let (closed, closing) = close(&seen.mesh, &views).unwrap();
        assert_eq!((closing.polygons, closing.left_open), (1, 0));
        assert_eq!(closing.faces, closing.largest - 2);
        assert!(borders(&closed).is_empty(), "closed");
        let after = Canvas::of_mesh(&closed, DrawWith::Software).unwrap();
        let covered = |canvas: &Canvas| software::covered_pixels(canvas.buffers(), &views[0]).unwrap();
        assert_eq!(covered(&before), covered(&after));
    }

    /// A bowl seen from above its rim: a flat lid on the cut would lie over the hollow.
    #[test]
    fn a_polygon_that_would_show_goes_behind_the_model() {
        let mut bowl = ball(24);
        // the lower half, pressed flat where it was deep, with its rim bent down at one side
        bowl.triangles.retain(|t| t.iter().all(|&c| bowl.positions[c as usize].z < 0.1));
        let view =
            View { eye: DVec3::new(0.0, 0.0, 6.0), target: DVec3::ZERO, fov_y_rad: 0.5, viewport_px: [160, 160] };
        let border = borders(&bowl);
        assert_eq!(border.len(), 1);
        let (closed, closing) = close(&bowl, &[view]).unwrap();
        assert_eq!((closing.polygons, closing.left_open), (1, 0));
        assert_eq!(closing.faces, 3 * border[0].len() - 2);
        assert_eq!(closed.positions.len(), bowl.positions.len() + border[0].len());
        assert!(borders(&closed).is_empty(), "closed");
        assert_eq!(closed.normals.len(), closed.positions.len());
    }

    #[test]
    fn from_all_sides_nothing_is_hidden_and_a_hole_that_shows_stays() {
        let mut ball = ball(16);
        let views = model_views(&ball.positions, 8, [160, 120]);
        // from no view the south pole is seen
        assert!(seen_side(&ball, &views).unwrap().hidden_faces < ball.triangles.len() / 3);
        ball.triangles.retain(|corners| !corners.contains(&0));
        let (open, closing) = close(&ball, &views).unwrap();
        assert_eq!((closing.polygons, closing.left_open), (0, 1));
        assert_eq!(open.triangles, ball.triangles);
    }
}
