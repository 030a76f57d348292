//! From a mesh to what is collapsed, and back: scaled into a box, equal places joined, in the order of a curve.

use super::appearance::Appearance;
use super::order::along_curve;
use super::work::{Work, hold};
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// A mesh made ready, with the way back.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) work: Work,
    /// The source's number of each vertex of `work`.
    pub(super) sources: Vec<u32>,
    scale: Scale,
}

/// Width of the box that meshes are scaled into: wide enough that squares of the squares of short edges are no small numbers
/// for single precision.
pub(super) const BOX: f64 = (1 << 20) as f64;

/// To the box and back.
#[derive(Debug, Clone, Copy)]
struct Scale {
    origin: DVec3,
    metres_a_unit: f64,
}

impl Scale {
    /// By a power of two, which leaves floats as they are.
    fn of(mesh: &TriangleMesh) -> Self {
        let bounds = mesh.bounds();
        let diagonal = bounds.diagonal();
        if diagonal > 0.0 && diagonal.is_finite() {
            Self { origin: bounds.centre(), metres_a_unit: diagonal.log2().ceil().exp2() / BOX }
        } else {
            Self { origin: DVec3::ZERO, metres_a_unit: 1.0 }
        }
    }

    fn unit(&self, p: DVec3) -> DVec3 {
        // adding zero makes -0 and 0 equal
        (p - self.origin) / self.metres_a_unit + DVec3::ZERO
    }
}

impl Prepared {
    /// Triangles whose corners are not three places are left out; vertices at one place become one.
    pub(super) fn new(mesh: &TriangleMesh, locked: Option<&[bool]>) -> Self {
        let scale = Scale::of(mesh);
        let n = mesh.positions.len();
        let places: Vec<DVec3> = mesh.positions.par_iter().map(|&p| scale.unit(p)).collect();
        let mut is_used = vec![false; n];
        mesh.triangles.iter().flatten().for_each(|&v| is_used[v as usize] = true);
        let order = along_curve(&places, &is_used);
        drop(is_used);
        let mut number = vec![u32::MAX; n];
        // vertices at one place that look the same are one wedge: the first of them; where they are many, not all are compared
        let mut wedge_of: Vec<u32> = (0..n as u32).collect();
        let mut looks: Vec<u32> = Vec::new();
        let (mut positions, mut sources, mut holds) =
            (Vec::with_capacity(order.len()), Vec::with_capacity(order.len()), Vec::new());
        for v in order {
            let place = places[v as usize];
            if positions.last() != Some(&place) {
                positions.push(place);
                sources.push(v);
                holds.push(0);
                looks.clear();
            }
            match looks.iter().rev().take(8).find(|&&w| Appearance::look_alike(mesh, w, v)) {
                Some(&w) => wedge_of[v as usize] = w,
                None => looks.push(v),
            }
            number[v as usize] = positions.len() as u32 - 1;
            if locked.is_some_and(|l| l[v as usize])
                && let Some(holds) = holds.last_mut()
            {
                *holds |= hold::LOCKED;
            }
        }
        drop(places);
        // triangles in the order of their first vertices
        let renumbered = |t: &[u32; 3]| t.map(|v| number[v as usize]);
        let mut kept: Vec<u32> = (0..mesh.triangles.len() as u32)
            .filter(|&t| {
                let [a, b, c] = renumbered(&mesh.triangles[t as usize]);
                a != b && b != c && c != a
            })
            .collect();
        kept.par_sort_unstable_by_key(|&t| (renumbered(&mesh.triangles[t as usize]).into_iter().min(), t));
        let triangles: Vec<[u32; 3]> = kept.iter().map(|&t| renumbered(&mesh.triangles[t as usize])).collect();
        let appearance = Appearance::new(mesh, &kept, |v| wedge_of[v as usize]);
        drop((number, kept, wedge_of));
        Self { work: Work::new(positions, triangles, holds, appearance), sources, scale }
    }

    /// Metres in a unit of the work's places.
    pub(super) fn metres_a_unit(&self) -> f64 {
        self.scale.metres_a_unit
    }

    /// The mesh that is left, and of each vertex the source vertex that it is, untouched, or `u32::MAX` for a moved one.
    pub(super) fn finish(mut self, source: &TriangleMesh) -> (TriangleMesh, Vec<u32>) {
        let sources = std::mem::take(&mut self.sources);
        let mut kept = Vec::new();
        self.work.compact(|v| kept.push(sources[v as usize]));
        let positions = self
            .work
            .positions
            .iter()
            .zip(&kept)
            .map(|(&place, &v)| {
                let original = source.positions[v as usize];
                // one that never moved keeps its digits
                if self.scale.unit(original) == place {
                    original
                } else {
                    place * self.scale.metres_a_unit + self.scale.origin
                }
            })
            .collect();
        let mesh = TriangleMesh::new(positions, self.work.triangles);
        let (mesh, mut sources) = self.work.appearance.write(mesh, &kept, source);
        for (place, v) in mesh.positions.iter().zip(&mut sources) {
            if *place != source.positions[*v as usize] {
                *v = u32::MAX;
            }
        }
        (mesh, sources)
    }
}
