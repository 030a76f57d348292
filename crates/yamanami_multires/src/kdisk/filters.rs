//! The filters as sparse matrices, in the words of the paper's Table 1: slow and plain, for checks and counts. They are found from
//! the disks alone, without what makes lifting fast.

use super::disk::DiskFinder;
use super::lifting::{Lifting, MOST_RINGS, Wavelet};
use super::stencil::Stencils;
use yamanami_core::SemiRegular;

/// A sparse matrix by rows: column and value of what is not zero, ascending by column.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sparse {
    /// The rows.
    pub rows: Vec<Vec<(u32, f64)>>,
}

impl Sparse {
    /// The matrix times a vector.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|row| row.iter().map(|&(c, v)| v * x[c as usize]).sum()).collect()
    }

    /// Row and value of what is not zero, by columns.
    pub(super) fn columns(&self, columns: u32) -> Vec<Vec<(u32, f64)>> {
        let mut found = vec![Vec::new(); columns as usize];
        for (row, entries) in (0..).zip(&self.rows) {
            entries.iter().for_each(|&(column, value)| found[column as usize].push((row, value)));
        }
        found
    }

    fn from_triplets(rows: u32, mut triplets: Vec<(u32, u32, f64)>) -> Self {
        triplets.sort_unstable_by_key(|t| (t.0, t.1));
        let mut matrix = Self { rows: vec![Vec::new(); rows as usize] };
        for (row, column, value) in triplets {
            match matrix.rows[row as usize].last_mut() {
                Some(last) if last.0 == column => last.1 += value,
                _ => matrix.rows[row as usize].push((column, value)),
            }
        }
        matrix
    }
}

/// Analysis filters A, B and synthesis filters P, Q of one level, for vectors of the coarse vertices followed by the new ones:
/// `coarse = A fine`, `details = B fine`, `fine = P coarse + Q details`.
#[derive(Debug, Clone, PartialEq)]
pub struct Filters {
    /// `A_lazy + S B_lazy`.
    pub a: Sparse,
    /// `B_lazy`: a new vertex less the middle of its parents.
    pub b: Sparse,
    /// `P_lazy`: coarse vertices, and middles.
    pub p: Sparse,
    /// `Q_lazy − P_lazy S`.
    pub q: Sparse,
}

/// The filters between `level` and the next finer one. None for [`Wavelet::Orthogonal`], whose filters are dense.
pub fn filters(mesh: &SemiRegular, lifting: &Lifting, level: u32) -> Option<Filters> {
    let rings = match lifting.wavelet() {
        Wavelet::Lazy => None,
        Wavelet::KDisk(k) => Some(k.min(MOST_RINGS)),
        Wavelet::Orthogonal => return None,
    };
    let mut finder = DiskFinder::new(mesh, level, rings.unwrap_or(0));
    let mut stencils = Stencils::default();
    let (coarse, fine) = (mesh.vertex_count(level), mesh.vertex_count(level + 1));
    let mut a: Vec<(u32, u32, f64)> = (0..coarse).map(|v| (v, v, 1.0)).collect();
    let mut p = a.clone();
    let (mut b, mut q) = (Vec::new(), Vec::new());
    let mut parents_of = vec![Vec::new(); coarse as usize];
    for vertex in coarse..fine {
        for parent in mesh.parents(vertex).into_iter().flatten() {
            parents_of[parent as usize].push(vertex);
        }
    }
    for vertex in coarse..fine {
        let nth = vertex - coarse;
        let parents = mesh.parents(vertex).unwrap_or_default();
        b.push((nth, vertex, 1.0));
        q.push((vertex, nth, 1.0));
        for parent in parents {
            b.push((nth, parent, -0.5));
            p.push((vertex, parent, 0.5));
        }
        if rings.is_none() {
            continue;
        }
        let disk = finder.find(parents);
        let stencil = stencils.of(&disk);
        for (&v, &share) in disk.vertices.iter().zip(stencils.shares(stencil)) {
            a.push((v, vertex, share));
            a.extend(parents.map(|parent| (v, parent, -0.5 * share)));
            q.push((v, nth, -share));
            q.extend(parents_of[v as usize].iter().map(|&middle| (middle, nth, -0.5 * share)));
        }
    }
    Some(Filters {
        a: Sparse::from_triplets(coarse, a),
        b: Sparse::from_triplets(fine - coarse, b),
        p: Sparse::from_triplets(fine, p),
        q: Sparse::from_triplets(fine, q),
    })
}
