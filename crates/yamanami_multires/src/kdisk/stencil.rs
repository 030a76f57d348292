//! The shares of a detail: what makes a wavelet orthogonal to the hat functions of its disk.
//!
//! Inner products are in units of 1/48 of a coarse triangle's area, where all of them are whole: two hats have 4 for each triangle that they
//! share, a hat with itself 8 for each of its triangles; the lazy wavelet has 5 with its parents' hats for each triangle at its edge, 2
//! with the opposite corner's, 6 with itself.

use super::disk::{Disk, OUTSIDE};
use std::collections::HashMap;

/// Shares of equal disks, worked out once.
#[derive(Debug, Default)]
pub(super) struct Stencils {
    known: HashMap<Box<[u16]>, u32>,
    begins: Vec<u32>,
    shares: Vec<f64>,
    square_norms: Vec<f64>,
}

impl Stencils {
    /// The number of a disk's stencil.
    pub(super) fn of(&mut self, disk: &Disk<'_>) -> u32 {
        if let Some(&number) = self.known.get(disk.signature) {
            return number;
        }
        let number = self.square_norms.len() as u32;
        let (gram, right) = system(disk);
        let shares = solve(gram, &right);
        let along: f64 = shares.iter().zip(&right).map(|(s, r)| s * r).sum();
        self.square_norms.push(6.0 * disk.edge_triangles() as f64 - along);
        self.begins.push(self.shares.len() as u32);
        self.shares.extend(shares);
        self.known.insert(disk.signature.into(), number);
        number
    }

    /// Shares of the disk's vertices, in its order.
    pub(super) fn shares(&self, number: u32) -> &[f64] {
        let to = self.begins.get(number as usize + 1).map_or(self.shares.len(), |&to| to as usize);
        &self.shares[self.begins[number as usize] as usize..to]
    }

    /// The wavelet's square norm in 1/48 of a coarse triangle's area.
    pub(super) fn square_norm(&self, number: u32) -> f64 {
        self.square_norms[number as usize]
    }

    /// Bytes that are held, roughly.
    pub(super) fn bytes(&self) -> usize {
        let known: usize = self.known.keys().map(|k| 2 * k.len() + 24).sum();
        known + 8 * (self.shares.len() + self.square_norms.len()) + 4 * self.begins.len()
    }

    /// How many different ones there are.
    pub(super) fn len(&self) -> usize {
        self.square_norms.len()
    }
}

/// The hats' inner products with each other, row by row, and with the lazy wavelet.
fn system(disk: &Disk<'_>) -> (Vec<f64>, Vec<f64>) {
    let n = disk.vertices.len();
    let mut gram = vec![0.0; n * n];
    for at in 0..n {
        let (ring, is_closed) = disk.ring(at);
        let triangles = if is_closed { ring.len() } else { ring.len() - 1 };
        gram[at * n + at] = 8.0 * triangles as f64;
        for k in 0..triangles {
            for v in [ring[k], ring[(k + 1) % ring.len()]] {
                if v != OUTSIDE {
                    gram[at * n + usize::from(v)] += 4.0;
                }
            }
        }
    }
    let mut right = vec![0.0; n];
    right[..2].fill(5.0 * disk.edge_triangles() as f64);
    for v in disk.opposite().filter(|&v| v != OUTSIDE) {
        right[usize::from(v)] += 2.0;
    }
    (gram, right)
}

/// Solves a symmetric positive system by Cholesky's method.
fn solve(mut matrix: Vec<f64>, right: &[f64]) -> Vec<f64> {
    let n = right.len();
    for i in 0..n {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| matrix[i * n + k] * matrix[j * n + k]).sum();
            let rest = matrix[i * n + j] - dot;
            matrix[i * n + j] = if i == j { rest.sqrt() } else { rest / matrix[j * n + j] };
        }
    }
    let mut x = right.to_vec();
    for i in 0..n {
        let dot: f64 = (0..i).map(|k| matrix[i * n + k] * x[k]).sum();
        x[i] = (x[i] - dot) / matrix[i * n + i];
    }
    for i in (0..n).rev() {
        let dot: f64 = (i + 1..n).map(|k| matrix[k * n + i] * x[k]).sum();
        x[i] = (x[i] - dot) / matrix[i * n + i];
    }
    x
}
