//! Where the mesh is not regular: disks one by one, at coarse levels and along borders, and by their kind around inner base vertices.

use super::cells::Cells;
use super::disk::DiskFinder;
use super::stencil::Stencils;
use super::wheel::{Corner, around};
use rayon::prelude::*;
use yamanami_core::SemiRegular;

/// Corners that are worked on at a time.
const ABREAST: usize = 256;

/// Details with disks of their own.
#[derive(Debug, Default)]
pub(super) struct Singles {
    details: Vec<u32>,
    stencils: Vec<u32>,
    /// Where each one's cells begin.
    begins: Vec<u32>,
    cells: Vec<u32>,
}

impl Singles {
    /// Finds the disks of details.
    pub(super) fn new(mesh: &SemiRegular, level: u32, rings: u32, details: Vec<u32>, stencils: &mut Stencils) -> Self {
        let mut found = Self { begins: vec![0], ..Self::default() };
        if details.is_empty() {
            return found;
        }
        let at = Cells::new(mesh.base(), level);
        let coarse = mesh.vertex_count(level);
        let mut finder = DiskFinder::new(mesh, level, rings);
        // vertices are in many disks
        let mut cell_of = vec![u32::MAX; coarse as usize];
        for &detail in &details {
            let Some(parents) = mesh.parents(coarse + detail) else { continue };
            let disk = finder.find(parents);
            found.stencils.push(stencils.of(&disk));
            for &v in disk.vertices {
                let cell = &mut cell_of[v as usize];
                if *cell == u32::MAX {
                    *cell = at.of_vertex(mesh, v) as u32;
                }
                found.cells.push(*cell);
            }
            found.begins.push(found.cells.len() as u32);
        }
        Self { details, ..found }
    }

    pub(super) fn update<const D: usize>(
        &self,
        stencils: &Stencils,
        cells: &mut [[f64; D]],
        details: &[[f64; D]],
        sign: f64,
    ) {
        for (nth, (&detail, &stencil)) in self.details.iter().zip(&self.stencils).enumerate() {
            let own = &self.cells[self.begins[nth] as usize..self.begins[nth + 1] as usize];
            let detail = details[detail as usize].map(|d| sign * d);
            for (&cell, share) in own.iter().zip(stencils.shares(stencil)) {
                let value = &mut cells[cell as usize];
                for k in 0..D {
                    value[k] += share * detail[k];
                }
            }
        }
    }

    /// Details and their stencils.
    pub(super) fn stencils(&self) -> impl Iterator<Item = (u32, u32)> {
        self.details.iter().copied().zip(self.stencils.iter().copied())
    }

    pub(super) fn bytes(&self) -> usize {
        4 * (self.details.len() + self.stencils.len() + self.begins.len() + self.cells.len())
    }
}

/// The surroundings of inner base vertices.
#[derive(Debug, Default)]
pub(super) struct Corners {
    /// The kind of each vertex's surroundings, and where its cells and its details begin in `places`.
    vertices: Vec<(u32, u32, u32)>,
    places: Vec<u32>,
}

impl Corners {
    /// `kind_of` says for each base vertex which kind it is of; none at borders.
    pub(super) fn new(mesh: &SemiRegular, level: u32, kinds: &[Corner], kind_of: &[Option<u32>]) -> Self {
        let at = Cells::new(mesh.base(), level);
        let mut found = Self::default();
        for (vertex, kind) in (0u32..).zip(kind_of) {
            let Some(kind) = *kind else { continue };
            let fan = mesh.base().fan(vertex);
            let corner = &kinds[kind as usize];
            let cells = found.places.len() as u32;
            found.places.push(vertex);
            found.places.extend(around(fan.len(), corner.radius).map(|(triangle, local)| {
                let (face, corner) = fan[triangle];
                at.cell(face as usize, turned(at.size, corner, local)) as u32
            }));
            found.vertices.push((kind, cells, found.places.len() as u32));
            found.places.extend(corner.details.iter().map(|&(triangle, local)| {
                let (face, corner) = fan[triangle];
                at.detail(face as usize, turned(2 * at.size, corner, local)) as u32
            }));
        }
        found
    }

    pub(super) fn update<const D: usize>(
        &self,
        kinds: &[Corner],
        cells: &mut [[f64; D]],
        details: &[[f64; D]],
        sign: f64,
    ) {
        for vertices in self.vertices.chunks(ABREAST) {
            let sums: Vec<Vec<[f64; D]>> = vertices
                .par_iter()
                .with_min_len(8)
                .map(|&(kind, _, begin)| sums(&kinds[kind as usize], &self.places[begin as usize..], details))
                .collect();
            // surroundings overlap
            for (&(_, begin, _), sums) in vertices.iter().zip(sums) {
                for (&cell, sum) in self.places[begin as usize..].iter().zip(sums) {
                    let value = &mut cells[cell as usize];
                    for k in 0..D {
                        value[k] += sign * sum[k];
                    }
                }
            }
        }
    }

    /// Details and their wavelets' square norms.
    pub(super) fn square_norms(&self, kinds: &[Corner]) -> impl Iterator<Item = (u32, f64)> {
        self.vertices.iter().flat_map(move |&(kind, _, begin)| {
            self.places[begin as usize..].iter().copied().zip(kinds[kind as usize].square_norms.iter().copied())
        })
    }

    pub(super) fn bytes(&self) -> usize {
        4 * (3 * self.vertices.len() + self.places.len())
    }
}

/// What each cell of a vertex's surroundings gets.
fn sums<const D: usize>(corner: &Corner, places: &[u32], details: &[[f64; D]]) -> Vec<[f64; D]> {
    let near: Vec<[f64; D]> = places[..corner.details.len()].iter().map(|&p| details[p as usize]).collect();
    let sum = |range: &[u32]| {
        let mut sum = [0.0; D];
        for &(nth, share) in &corner.shares[range[0] as usize..range[1] as usize] {
            let detail = near[nth as usize];
            for k in 0..D {
                sum[k] += share * detail[k];
            }
        }
        sum
    };
    corner.begins.windows(2).map(sum).collect()
}

/// Lattice coordinates of a point that is a, b from a corner towards the next ones.
pub(super) fn turned(size: usize, corner: u8, [a, b]: [usize; 2]) -> [usize; 2] {
    let rest = size - a - b;
    match corner {
        0 => [a, b],
        1 => [rest, a],
        _ => [b, rest],
    }
}
