//! The k-disk update of all levels: which details are regular, which lie near base vertices or borders, and what each kind needs.
//!
//! A level is *wide* when disks are small against its base triangles: then no disk holds two base vertices, and none meets itself but around
//! a base vertex. There nearly all details are regular. At the few coarser levels each detail has a disk of its own.

use super::cells::Cells;
use super::regular::Surroundings;
use super::rim::{Corners, Singles};
use super::stencil::Stencils;
use super::wheel::{Corner, Regular};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use yamanami_core::{BaseMesh, SemiRegular};

/// The update for a mesh.
#[derive(Debug, Default)]
pub(super) struct Update {
    rings: u32,
    stencils: Stencils,
    regular: Regular,
    /// Surroundings of inner base vertices, one for each number of triangles.
    corners: Vec<Corner>,
    /// For each base vertex how far off details are not regular.
    reaches: Vec<u32>,
    levels: Vec<Level>,
}

#[derive(Debug, Default)]
struct Level {
    is_wide: bool,
    corners: Corners,
    singles: Singles,
}

impl Update {
    pub(super) fn new(mesh: &SemiRegular, rings: u32) -> Self {
        let base = mesh.base();
        let mut stencils = Stencils::default();
        let regular = Regular::new(rings, &mut stencils);
        // a level of at least so many steps is wide: no closed way of twice a disk's size that is not around a single base vertex
        let least = 2 * rings + 3;
        let may_be_wide = mesh.levels() > 0 && 1 << (mesh.levels() - 1) >= least;
        let kinds = if may_be_wide { kinds(base, rings, &regular, &mut stencils) } else { None };
        let has_kinds = kinds.is_some();
        let (corners, kind_of) = kinds.unwrap_or_default();
        let reach = |kind: &Option<u32>| kind.map_or(rings, |kind| corners[kind as usize].reach as u32);
        let reaches: Vec<u32> = kind_of.iter().map(reach).collect();
        // nor a disk with two base vertices
        let wide = least.max(2 * reaches.iter().copied().max().unwrap_or(0) + 2);
        let mut levels = Vec::new();
        for level in 0..mesh.levels() {
            let is_wide = has_kinds && 1 << level >= wide;
            let singles = if is_wide { along_border(mesh, level, rings) } else { all(mesh, level) };
            let corners = if is_wide { Corners::new(mesh, level, &corners, &kind_of) } else { Corners::default() };
            levels.push(Level { is_wide, corners, singles: Singles::new(mesh, level, rings, singles, &mut stencils) });
        }
        Self { rings, stencils, regular, corners, reaches, levels }
    }

    /// Adds the details' shares to a level's cells, or takes them away.
    pub(super) fn apply<const D: usize>(
        &self,
        at: Cells<'_>,
        level: u32,
        cells: &mut [[f64; D]],
        details: &[[f64; D]],
        sign: f64,
    ) {
        let level = &self.levels[level as usize];
        if level.is_wide {
            let around = Surroundings { at, rings: self.rings as usize, reaches: &self.reaches };
            around.update(&self.regular.taps, cells, details, sign);
            level.corners.update(&self.corners, cells, details, sign);
        }
        level.singles.update(&self.stencils, cells, details, sign);
    }

    /// Square norms of the wavelets of the vertices that come with the level after `level`, in 1/48 of a triangle's area.
    pub(super) fn square_norms(&self, mesh: &SemiRegular, level: u32) -> Vec<f64> {
        let regular = self.stencils.square_norm(self.regular.stencil);
        let mut squares = vec![regular; mesh.new_vertices(level + 1).len()];
        let level = &self.levels[level as usize];
        for (detail, square) in level.corners.square_norms(&self.corners) {
            squares[detail as usize] = square;
        }
        for (detail, stencil) in level.singles.stencils() {
            squares[detail as usize] = self.stencils.square_norm(stencil);
        }
        squares
    }

    pub(super) fn stencil_count(&self) -> usize {
        self.stencils.len()
    }

    pub(super) fn bytes(&self) -> usize {
        let corners: usize = self.corners.iter().map(|c| 16 * c.shares.len() + 32 * c.details.len()).sum();
        let levels: usize = self.levels.iter().map(|l| l.corners.bytes() + l.singles.bytes()).sum();
        self.stencils.bytes() + corners + 4 * self.reaches.len() + levels
    }
}

type Kinds = (Vec<Corner>, Vec<Option<u32>>);

/// The kinds of inner base vertices, and of which kind each base vertex is; none where one has more triangles than a wheel can have.
fn kinds(base: &BaseMesh, rings: u32, regular: &Regular, stencils: &mut Stencils) -> Option<Kinds> {
    let mut of_valence = BTreeMap::new();
    let mut corners = Vec::new();
    let mut kind_of = Vec::with_capacity(base.vertex_count() as usize);
    for vertex in 0..base.vertex_count() {
        if base.is_on_border(vertex) {
            kind_of.push(None);
            continue;
        }
        let kind = match of_valence.entry(base.fan(vertex).len()) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                corners.push(Corner::new(*new.key(), rings, regular, stencils)?);
                *new.insert(corners.len() as u32 - 1)
            }
        };
        kind_of.push(Some(kind));
    }
    Some((corners, kind_of))
}

fn all(mesh: &SemiRegular, level: u32) -> Vec<u32> {
    (0..mesh.new_vertices(level + 1).len() as u32).collect()
}

/// The details whose disks have vertices of the border.
fn along_border(mesh: &SemiRegular, level: u32, rings: u32) -> Vec<u32> {
    let base = mesh.base();
    let at = Cells::new(base, level);
    let (size, near) = (2 * at.size, 2 * rings as usize + 1);
    let of_face = |face: usize| {
        let is_at_border = |corner: usize| base.is_on_border(base.triangles()[face][corner]);
        let corners = [0, 1, 2].map(is_at_border);
        let opposite = [0, 1, 2].map(|corner| base.beyond(face as u32, (corner + 1) % 3).is_none());
        let mut found = Vec::new();
        if corners.iter().chain(&opposite).all(|is| !is) {
            return found;
        }
        for b in 0..=size {
            for a in 0..=size - b {
                let steps = [size - a - b, a, b];
                let is_detail = a & 1 == 1 || b & 1 == 1;
                let is_near = (0..3).any(|k| corners[k] && steps[k] + near >= size || opposite[k] && steps[k] <= near);
                // one of the two triangles at an edge names its details
                let is_own = (0..3).all(|k| steps[(k + 2) % 3] > 0 || !base.sides()[face][k].is_reversed);
                if is_detail && is_near && is_own {
                    found.push(at.detail(face, [a, b]) as u32);
                }
            }
        }
        found
    };
    let by_face: Vec<Vec<u32>> = (0..base.triangles().len()).into_par_iter().map(of_face).collect();
    by_face.concat()
}
