//! A TIN as files and surveyors leave it, made safe: seen from above no face covers another, all are counter-clockwise, and
//! an edge has a face on each side at most. Nothing is moved or invented, and no face is dropped without a word.

mod edges;
mod overlap;
mod tree;

pub use edges::t_junctions;

use crate::clean::{CleanOptions, clean, keep_faces, keep_vertices};
use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord, orient2d};
use std::fmt;
use yamanami_core::{Tin, TriangleMesh};

/// What may be wrong with a TIN, in the order in which it is mended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Fault {
    /// Vertices with a coordinate that is not finite: dropped.
    NowhereVertex,
    /// Faces with a corner that is not there: dropped, hidden ones too.
    MissingCorner,
    /// Vertices where another is, to the last bit: they become one, unless a colour or texture seam parts them.
    DuplicatePoint,
    /// Faces with two corners that are one, or three in a line: dropped.
    Sliver,
    /// Faces that stand upright: dropped.
    Wall,
    /// Faces that were clockwise seen from above: turned.
    Turned,
    /// Faces with the corners of an earlier one: dropped.
    DuplicateFace,
    /// Faces at a side of an edge where an earlier one is: dropped.
    CrowdedEdge,
    /// Faces that cover a part of an earlier one in plan, by more than a millimetre: dropped.
    Overlap,
    /// Vertices within a millimetre of an edge of the border in plan, without being a corner there: found only. The surface is sound, but
    /// may be open by a hair along that edge.
    TJunction,
}

impl Fault {
    /// Whether something was changed because of it.
    pub fn is_change(self) -> bool {
        self != Self::TJunction
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NowhereVertex => "vertices that are nowhere dropped",
            Self::MissingCorner => "faces with a corner that is not there dropped",
            Self::DuplicatePoint => "vertices at the place of another made one with it",
            Self::Sliver => "faces without area dropped",
            Self::Wall => "vertical faces dropped",
            Self::Turned => "clockwise faces turned",
            Self::DuplicateFace => "faces that were there twice dropped",
            Self::CrowdedEdge => "faces at an edge that has its two dropped",
            Self::Overlap => "faces that cover an earlier one in plan dropped",
            Self::TJunction => "vertices inside an edge of the border",
        })
    }
}

/// A fault that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mended {
    /// What it is.
    pub fault: Fault,
    /// How often it was found.
    pub count: usize,
    /// Where it was found first: `face 17 at 5.000 2.000 1.500`, counted from 1 as given, in metres.
    pub first: String,
}

impl fmt::Display for Mended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, the first: {}", self.count, self.fault, self.first)
    }
}

/// A TIN that is safe, and what was not.
#[derive(Debug, Clone, PartialEq)]
pub struct MendedTin {
    /// The TIN. Faces keep their order; vertices without a face stay.
    pub tin: Tin,
    /// The faults, each kind once.
    pub faults: Vec<Mended>,
}

/// Mends a TIN. What comes out has no fault but [`Fault::TJunction`] and would come out again as it is.
///
/// # Panics
/// When an attribute of the mesh is neither empty nor one a vertex.
pub fn mend(mut tin: Tin) -> MendedTin {
    let mut faults = Faults::default();
    drop_nowhere(&mut tin, &mut faults);
    weld(&mut tin, &mut faults);
    let mut faces = Faces { alive: vec![true; tin.mesh.triangles.len()], mesh: &mut tin.mesh, faults };
    faces.settle_shapes();
    faces.drop_repeated();
    overlap::drop_overlaps(&mut faces);
    let Faces { alive, mut faults, .. } = faces;
    if alive.contains(&false) {
        keep_faces(&mut tin.mesh, &alive);
    }
    edges::tell_t_junctions(&tin.mesh, &mut faults);
    MendedTin { tin, faults: faults.0 }
}

/// What was found so far.
#[derive(Default)]
struct Faults(Vec<Mended>);

impl Faults {
    /// Counts a fault at some of the things that are marked; `place` tells where the first is.
    fn add(&mut self, fault: Fault, count: usize, first: impl FnOnce() -> String) {
        if count > 0 {
            self.0.push(Mended { fault, count, first: first() });
        }
    }
}

fn vertex_place(number: usize, p: DVec3) -> String {
    format!("vertex {} at {:.3} {:.3} {:.3}", number + 1, p.x, p.y, p.z)
}

/// The faces being mended: dead ones keep their number.
struct Faces<'a> {
    mesh: &'a mut TriangleMesh,
    alive: Vec<bool>,
    faults: Faults,
}

impl Faces<'_> {
    /// Drops faces, ascending numbers, for a fault.
    fn drop(&mut self, fault: Fault, faces: &[u32]) {
        for &f in faces {
            self.alive[f as usize] = false;
        }
        self.tell(fault, faces);
    }

    fn tell(&mut self, fault: Fault, faces: &[u32]) {
        let mesh = &*self.mesh;
        self.faults.add(fault, faces.len(), || {
            let [a, b, c] = mesh.corners(faces[0] as usize);
            let p = (a + b + c) / 3.0;
            format!("face {} at {:.3} {:.3} {:.3}", faces[0] + 1, p.x, p.y, p.z)
        });
    }

    /// Drops what has no area in plan and turns what is clockwise.
    fn settle_shapes(&mut self) {
        let mesh = &*self.mesh;
        let turns: Vec<f64> = mesh.triangles.par_iter().map(|&t| turn(&mesh.positions, t)).collect();
        let (mut slivers, mut walls, mut turned) = (Vec::new(), Vec::new(), Vec::new());
        for (f, &turn) in turns.iter().enumerate() {
            if turn == 0.0 {
                let [a, b, c] = mesh.corners(f);
                let is_wall = (b - a).cross(c - a).length_squared() > 0.0;
                (if is_wall { &mut walls } else { &mut slivers }).push(f as u32);
            } else if turn < 0.0 {
                turned.push(f as u32);
            }
        }
        for &f in &turned {
            self.mesh.triangles[f as usize].swap(1, 2);
        }
        self.drop(Fault::Sliver, &slivers);
        self.drop(Fault::Wall, &walls);
        self.tell(Fault::Turned, &turned);
    }

    /// Drops faces that are there twice, then those that crowd an edge.
    fn drop_repeated(&mut self) {
        let [twice, crowded] = edges::repeated(&self.mesh.triangles, &self.alive);
        self.drop(Fault::DuplicateFace, &twice);
        self.drop(Fault::CrowdedEdge, &crowded);
    }
}

/// Twice the area of a face in plan, its sign exact: positive when counter-clockwise.
fn turn(positions: &[DVec3], corners: [u32; 3]) -> f64 {
    let [a, b, c] = corners.map(|v| plan(positions[v as usize]));
    orient2d(a, b, c)
}

/// What is nearer than this in plan touches, metres: a millimetre, less where the whole TIN is smaller than a kilometre.
/// Surveys cut along a line and written with so many digits cover each other there by a hair.
fn touch_m(mesh: &TriangleMesh) -> f64 {
    let bounds = mesh.bounds();
    (1e-6 * (bounds.max - bounds.min).truncate().max_element()).clamp(0.0, 1e-3)
}

fn plan(p: DVec3) -> Coord<f64> {
    Coord { x: p.x, y: p.y }
}

/// Drops vertices that are nowhere, and faces that name them or none.
fn drop_nowhere(tin: &mut Tin, faults: &mut Faults) {
    let there: Vec<bool> = tin.mesh.positions.iter().map(|p| p.is_finite()).collect();
    let is_whole = |t: &[u32; 3]| t.iter().all(|&v| there.get(v as usize) == Some(&true));
    let whole: Vec<bool> = tin.mesh.triangles.iter().map(is_whole).collect();
    let hidden_before = tin.hidden.len();
    tin.hidden.retain(is_whole);
    let missing = whole.iter().filter(|&&w| !w).count();
    faults.add(Fault::NowhereVertex, there.iter().filter(|&&t| !t).count(), || {
        let first = there.iter().position(|&t| !t).unwrap_or_default();
        vertex_place(first, tin.mesh.positions[first])
    });
    faults.add(Fault::MissingCorner, missing + hidden_before - tin.hidden.len(), || {
        match whole.iter().position(|&w| !w) {
            Some(first) => format!("face {} of vertices {:?}", first + 1, tin.mesh.triangles[first]),
            None => "a hidden face".to_owned(),
        }
    });
    if missing > 0 {
        keep_faces(&mut tin.mesh, &whole);
    }
    if there.contains(&false) {
        with_hidden(tin, |mesh| keep_vertices(mesh, &there));
    }
}

fn weld(tin: &mut Tin, faults: &mut Faults) {
    let before = tin.mesh.positions.clone();
    let options = CleanOptions { weld_m: Some(0.0), ..CleanOptions::default() };
    let welded = with_hidden(tin, |mesh| clean(mesh, &options).welded_vertices);
    faults.add(Fault::DuplicatePoint, welded, || {
        let first = before.iter().zip(&tin.mesh.positions).position(|(a, b)| a != b);
        let first = first.unwrap_or(tin.mesh.positions.len());
        vertex_place(first, before[first])
    });
}

/// Changes the vertices of a TIN while the hidden faces stand behind the others.
fn with_hidden<R>(tin: &mut Tin, change: impl FnOnce(&mut TriangleMesh) -> R) -> R {
    let shown = tin.mesh.triangles.len();
    tin.mesh.triangles.append(&mut tin.hidden);
    let result = change(&mut tin.mesh);
    tin.hidden = tin.mesh.triangles.split_off(shown);
    result
}
