//! Semi-regular meshes as integers, level by level, and back: what a progressive file codes.
//!
//! A new vertex is foretold from the coarser mesh; what is left, the detail, is told in the frame of that mesh at the split edge,
//! since most of it lies along the normal, and what lies along the surface hardly moves it. The frames are those of
//! the mesh that a decoder has when it has every bit; with fewer, details are turned a little, by an angle as small as
//! the error of the coarser mesh.
//!
//! Based on: Khodakovsky, Schröder, Sweldens, "Progressive geometry compression", 2000; Khodakovsky, Guskov, "Normal mesh
//! compression", 2002.

mod predict;
mod rings;

use glam::DVec3;
use predict::Prediction;
use rayon::prelude::*;
use rings::{Rings, ends};
use yamanami_core::{DetailScheme, SemiRegular};

/// Vertices that a thread takes at a time, at least.
const RUN: usize = 2048;

/// Largest integer.
const MOST: f64 = (1 << 29) as f64;

/// Integers of a mesh's vertices, and the vertices that they are read as, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Details {
    /// By vertex.
    pub coefficients: Vec<[i32; 3]>,
    /// By vertex.
    pub positions_m: Vec<DVec3>,
}

/// Tells vertices as integers. Coordinates must be finite; those too far for 30 bits come out too near.
pub fn details(mesh: &SemiRegular, positions_m: &[DVec3], scheme: &DetailScheme) -> Details {
    let fine = analysed(mesh, positions_m, scheme);
    let base_steps = scheme.steps_m(0);
    let mut coefficients: Vec<[i32; 3]> =
        fine[..mesh.vertex_count(0) as usize].iter().map(|&x| whole(x - scheme.origin_m, base_steps)).collect();
    let mut read: Vec<DVec3> = coefficients.iter().map(|&c| base_vertex(scheme, c.map(f64::from))).collect();
    for level in 1..=mesh.levels() {
        let step = Step::new(mesh, level, scheme, &read);
        let range = mesh.new_vertices(level);
        let first = range.start;
        let new: Vec<[i32; 3]> = range
            .into_par_iter()
            .with_min_len(RUN)
            .map(|v| {
                let ends = step.ends[(v - first) as usize];
                // without update the coarser mesh is known as it will be read, and its error is made good
                let detail = match scheme.update {
                    0.0 => positions_m[v as usize] - step.foretold(&read, ends),
                    _ => fine[v as usize],
                };
                let frame = step.frame(&read, ends);
                whole(DVec3::from(frame.map(|axis| axis.dot(detail))), step.steps_m)
            })
            .collect();
        step.apply(&mut read, |v| new[(v - first) as usize].map(f64::from));
        coefficients.extend(new);
    }
    Details { coefficients, positions_m: read }
}

/// Vertices of integers, or of estimates of these, metres.
pub fn positions(mesh: &SemiRegular, coefficients: &[[f64; 3]], scheme: &DetailScheme) -> Vec<DVec3> {
    let base = &coefficients[..mesh.vertex_count(0) as usize];
    let mut read: Vec<DVec3> = base.iter().map(|&c| base_vertex(scheme, c)).collect();
    read.reserve_exact(coefficients.len() - read.len());
    for level in 1..=mesh.levels() {
        Step::new(mesh, level, scheme, &read).apply(&mut read, |v| coefficients[v as usize]);
    }
    read
}

fn whole(x: DVec3, steps_m: [f64; 3]) -> [i32; 3] {
    std::array::from_fn(|k| (x[k] / steps_m[k]).round().clamp(-MOST, MOST) as i32)
}

fn base_vertex(scheme: &DetailScheme, c: [f64; 3]) -> DVec3 {
    scheme.origin_m + DVec3::from(c) * scheme.base_step_m
}

/// Vertices of the coarsest mesh and details of the others; all as they are where nothing is updated.
fn analysed(mesh: &SemiRegular, positions_m: &[DVec3], scheme: &DetailScheme) -> Vec<DVec3> {
    let mut all = positions_m.to_vec();
    if scheme.update == 0.0 {
        return all;
    }
    for level in (1..=mesh.levels()).rev() {
        let rings = Rings::new(mesh, level - 1);
        let prediction = Prediction::new(scheme.predictor);
        let range = mesh.new_vertices(level);
        let ends = ends(mesh, level);
        let (coarse, new) = all.split_at_mut(range.start as usize);
        new[..range.len()].par_iter_mut().zip(&ends).for_each(|(x, &ends)| *x -= prediction.at(&rings, coarse, ends));
        for (&ends, &detail) in ends.iter().zip(&*new) {
            ends.into_iter().for_each(|end| coarse[end as usize] += f64::from(scheme.update) * detail);
        }
    }
    all
}

/// One level's step from the coarser mesh to the finer.
struct Step<'a> {
    mesh: &'a SemiRegular,
    level: u32,
    prediction: Prediction,
    rings: Rings,
    /// By new vertex.
    ends: Vec<[u32; 2]>,
    normals: Vec<DVec3>,
    steps_m: [f64; 3],
    update: f64,
}

impl<'a> Step<'a> {
    fn new(mesh: &'a SemiRegular, level: u32, scheme: &DetailScheme, coarse: &[DVec3]) -> Self {
        let rings = Rings::new(mesh, level - 1);
        let normals = rings.normals(coarse);
        let prediction = Prediction::new(scheme.predictor);
        let ends = ends(mesh, level);
        Self {
            mesh,
            level,
            prediction,
            rings,
            ends,
            normals,
            steps_m: scheme.steps_m(level),
            update: scheme.update.into(),
        }
    }

    fn foretold(&self, coarse: &[DVec3], ends: [u32; 2]) -> DVec3 {
        self.prediction.at(&self.rings, coarse, ends)
    }

    /// Normal, direction of the edge, and across both.
    fn frame(&self, coarse: &[DVec3], [p, q]: [u32; 2]) -> [DVec3; 3] {
        let normal = self.normals[p as usize].normalize_or_zero() + self.normals[q as usize].normalize_or_zero();
        let normal = normal.try_normalize().unwrap_or(DVec3::Z);
        let along = coarse[q as usize] - coarse[p as usize];
        let along = (along - normal * along.dot(normal)).try_normalize();
        let along = along.unwrap_or_else(|| normal.any_orthonormal_vector());
        [normal, along, normal.cross(along)]
    }

    /// Adds the level's vertices, given their numbers.
    fn apply(&self, read: &mut Vec<DVec3>, numbers: impl Fn(u32) -> [f64; 3] + Sync) {
        let range = self.mesh.new_vertices(self.level);
        let first = range.start;
        let coarse: &[DVec3] = read;
        let detail = |v: u32, ends: [u32; 2]| {
            let [a, b, c] = numbers(v);
            if a == 0.0 && b == 0.0 && c == 0.0 {
                return DVec3::ZERO;
            }
            let [normal, along, across] = self.frame(coarse, ends);
            normal * (a * self.steps_m[0]) + along * (b * self.steps_m[1]) + across * (c * self.steps_m[2])
        };
        let vertices = range.clone().into_par_iter().with_min_len(RUN);
        if self.update == 0.0 {
            let new: Vec<DVec3> = vertices
                .map(|v| {
                    let ends = self.ends[(v - first) as usize];
                    self.foretold(coarse, ends) + detail(v, ends)
                })
                .collect();
            read.extend(new);
            return;
        }
        let new: Vec<([u32; 2], DVec3)> = vertices
            .map(|v| {
                let ends = self.ends[(v - first) as usize];
                (ends, detail(v, ends))
            })
            .collect();
        for &(ends, detail) in &new {
            ends.into_iter().for_each(|end| read[end as usize] -= self.update * detail);
        }
        let coarse: &[DVec3] = read;
        let new: Vec<DVec3> =
            new.into_par_iter().with_min_len(RUN).map(|(ends, detail)| self.foretold(coarse, ends) + detail).collect();
        read.extend(new);
    }
}
