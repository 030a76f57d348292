//! The paper's mesh of a deformed map: blocks of right isosceles triangles, each of one size, chosen by distance alone.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (sections 3.3 and 5; figures
//! 4 to 7); Lindstrom, Koller, Ribarsky, Hodges, Faust, Turner, "Real-time continuous level of detail rendering of height
//! fields", 1996 (triangles halved at the middle of the hypotenuse). A block of level L is halved L times into 2^(L+1)
//! triangles. Two triangles that share a hypotenuse make a square; its diagonal is laid along the radius where it can be,
//! since the projection squeezes radially. Odd levels have hypotenuses along the axes, even ones along the diagonals: the
//! paper's two patch shapes.
//!
//! The paper does not say how blocks of two levels meet: here a block is refined along its border until it fits, by the
//! closure of halving, so there is no crack and no T-vertex. What a kept vertex does for the summits it replaces is a
//! [`PeakRule`].

mod blocks;
mod emit;
mod peaks;
mod ridges;

pub use peaks::{PAPER_PEAK_M, PeakRule, SummitError};

use super::Summit;
use crate::MultiresError;
use blocks::Blocks;
use glam::DVec2;
use yamanami_core::{FieldLevel, TriangleMesh};

/// The paper's blocks: those whose centre lies within this distance, metres. 1,933 blocks of 6.4 km, 3,958,784 triangles
/// of 200 m.
pub const PAPER_REACH_M: f64 = 158_720.0;

/// What to build.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandMeshOptions {
    /// The eye in the plane, metres: it stands over the centre of a block, at the sample nearest to this.
    pub eye: DVec2,
    /// Side of a block, metres: a power of two of the grid's spacing.
    pub block_m: f64,
    /// Blocks whose centre lies within this distance of the eye are drawn, metres.
    pub reach_m: f64,
    /// What kept vertices do for the samples they stand for.
    pub peaks: PeakRule,
}

/// The mesh.
#[derive(Debug, Clone)]
pub struct BandMesh {
    /// Plane metres and heights, counter-clockwise from above.
    pub mesh: TriangleMesh,
    /// Level of each triangle: its hypotenuse is that of [`Self::hypotenuse_m`].
    pub levels: Vec<u8>,
    /// Column and row of the sample at each vertex.
    pub samples: Vec<[u32; 2]>,
    /// Blocks drawn.
    pub blocks: usize,
    /// Blocks within reach that lie, in part, beyond the grid, and are not drawn.
    pub missing_blocks: usize,
    layout: Blocks,
    /// Where each block's triangles begin, and the end.
    starts: Vec<u32>,
}

/// Builds the mesh over a grid. `level_at` gives the level of a block by the distance of its centre from the eye, metres;
/// it is kept between 1 and that of the full grid. `summits` are for [`PeakRule::Summits`].
pub fn band_mesh(
    grid: &FieldLevel,
    options: &BandMeshOptions,
    level_at: impl Fn(f64) -> u32,
    summits: &[Summit],
) -> Result<BandMesh, MultiresError> {
    let layout = Blocks::new(grid, options, level_at)?;
    let vertices = layout.vertices();
    let (triangles, levels, starts) = emit::triangles(&layout, &vertices);
    let samples = vertices.samples(&layout);
    let heights = peaks::heights(grid, &samples, &triangles, options.peaks, summits);
    let place = |(&[column, row], z): (&[u32; 2], f64)| grid.plane_from_grid(column as usize, row as usize).extend(z);
    let positions = samples.iter().zip(heights).map(place).collect();
    Ok(BandMesh {
        mesh: TriangleMesh::new(positions, triangles),
        levels,
        samples,
        blocks: layout.drawn(),
        missing_blocks: layout.missing,
        layout,
        starts,
    })
}

impl BandMesh {
    /// Longest side of a triangle of a level, metres.
    pub fn hypotenuse_m(&self, level: u8) -> f64 {
        self.layout.block_m * 0.5f64.powf(0.5 * (f64::from(level) - 1.0))
    }

    /// A triangle over a sample, if one is drawn there.
    pub fn triangle_over(&self, column: usize, row: usize) -> Option<usize> {
        let at = [column as i64, row as i64];
        // a square across the border of two blocks may be cut the other way round: look next door too
        self.layout.blocks_near(at).into_iter().flatten().find_map(|block| {
            let range = self.starts[block] as usize..self.starts[block + 1] as usize;
            range.into_iter().find(|&t| {
                let corners = self.mesh.triangles[t].map(|v| self.samples[v as usize].map(i64::from));
                peaks::holds(corners, at)
            })
        })
    }

    /// How each summit is drawn: by the kept vertex nearest to it. `None` where nothing is drawn.
    pub fn summit_errors(&self, grid: &FieldLevel, summits: &[Summit]) -> Vec<Option<SummitError>> {
        let one = |summit: &Summit| {
            let triangle = self.mesh.triangles[self.triangle_over(summit.column, summit.row)?];
            let vertex = peaks::nearest(triangle, &self.samples, [summit.column, summit.row].map(|at| at as i64)).1;
            let drawn = self.mesh.positions[vertex as usize];
            let top = grid.plane_from_grid(summit.column, summit.row);
            Some(SummitError {
                height_error_m: drawn.z - f64::from(summit.height_m),
                shift_m: drawn.truncate().distance(top),
            })
        };
        summits.iter().map(one).collect()
    }
}

#[cfg(test)]
mod tests;
