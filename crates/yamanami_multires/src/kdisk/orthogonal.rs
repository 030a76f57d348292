//! The least-squares approximation of a level by the level below: what disks of all vertices would give.
//!
//! Based on: Hestenes, Stiefel, "Methods of conjugate gradients for solving linear systems", 1952. The hats' inner products are well
//! conditioned whatever the size of the mesh, so some tens of steps do, and the cost is linear.

use super::cells::Cells;
use rayon::prelude::*;
use yamanami_core::SemiRegular;

/// Steps enough for rounding level on any mesh; usually some forty are taken.
const MOST_STEPS: usize = 300;
/// The residual's share at which no step can better the result.
const ENOUGH: f64 = 1e-16;

/// The approximation's system at one level.
#[derive(Debug)]
pub(super) struct Projection {
    /// Cells at the corners of the level's triangles.
    triangles: Vec<[u32; 3]>,
    /// The details on each triangle's sides, of corners 0–1, 1–2, 2–0.
    midpoints: Vec<[u32; 3]>,
    diagonal: Vec<f64>,
}

impl Projection {
    pub(super) fn new(mesh: &SemiRegular, level: u32) -> Self {
        let cells = Cells::new(mesh.base(), level);
        let size = cells.size;
        let (mut triangles, mut midpoints) = (Vec::new(), Vec::new());
        for face in 0..mesh.base().triangles().len() {
            let at = |a: usize, b: usize| cells.cell(face, [a, b]) as u32;
            let new = |a: usize, b: usize| cells.detail(face, [a, b]) as u32;
            for b in 0..size {
                for a in 0..size - b {
                    triangles.push([at(a, b), at(a + 1, b), at(a, b + 1)]);
                    let (x, y) = (2 * a, 2 * b);
                    midpoints.push([new(x + 1, y), new(x + 1, y + 1), new(x, y + 1)]);
                    if a + b + 2 <= size {
                        triangles.push([at(a + 1, b), at(a + 1, b + 1), at(a, b + 1)]);
                        midpoints.push([new(x + 2, y + 1), new(x + 1, y + 2), new(x + 1, y + 1)]);
                    }
                }
            }
        }
        let mut diagonal = vec![0.0; cells.count()];
        for &v in triangles.iter().flatten() {
            diagonal[v as usize] += 8.0;
        }
        Self { triangles, midpoints, diagonal }
    }

    pub(super) fn bytes(&self) -> usize {
        12 * (self.triangles.len() + self.midpoints.len()) + 8 * self.diagonal.len()
    }

    /// Adds, or takes away, the approximation of the details from the cells.
    pub(super) fn add<const D: usize>(&self, cells: &mut [[f64; D]], details: &[[f64; D]], sign: f64) {
        let of_coordinates: Vec<Vec<f64>> = (0..D).into_par_iter().map(|k| self.approximation(details, k)).collect();
        for (k, x) in of_coordinates.iter().enumerate() {
            for (cell, x) in cells.iter_mut().zip(x) {
                cell[k] += sign * x;
            }
        }
    }

    /// One coordinate of the coarse function that is nearest to the details.
    fn approximation<const D: usize>(&self, details: &[[f64; D]], coordinate: usize) -> Vec<f64> {
        let mut right = vec![0.0; self.diagonal.len()];
        for (corners, middles) in self.triangles.iter().zip(&self.midpoints) {
            let d = middles.map(|m| details[m as usize][coordinate]);
            for k in 0..3 {
                right[corners[k] as usize] += 5.0 * (d[k] + d[(k + 2) % 3]) + 2.0 * d[(k + 1) % 3];
            }
        }
        self.solve(right)
    }

    fn solve(&self, right: Vec<f64>) -> Vec<f64> {
        let n = right.len();
        let (mut x, mut residual) = (vec![0.0; n], right);
        let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(&self.diagonal).map(|(r, d)| r / d).collect() };
        let mut z = scaled(&residual);
        let mut along = z.clone();
        let mut size = dot(&residual, &z);
        let enough = size * ENOUGH * ENOUGH;
        let mut image = vec![0.0; n];
        for _ in 0..MOST_STEPS {
            if size <= enough {
                break;
            }
            self.apply(&along, &mut image);
            let step = size / dot(&along, &image);
            for k in 0..n {
                x[k] += step * along[k];
                residual[k] -= step * image[k];
            }
            z = scaled(&residual);
            let next = dot(&residual, &z);
            let turn = next / size;
            size = next;
            for (a, z) in along.iter_mut().zip(&z) {
                *a = z + turn * *a;
            }
        }
        x
    }

    /// The hats' inner products times a vector.
    fn apply(&self, x: &[f64], image: &mut [f64]) {
        image.fill(0.0);
        for corners in &self.triangles {
            let v = corners.map(|c| x[c as usize]);
            let sum = 4.0 * (v[0] + v[1] + v[2]);
            for k in 0..3 {
                image[corners[k] as usize] += sum + 4.0 * v[k];
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
