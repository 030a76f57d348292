//! A TIN in blocks and levels, of which any mix is drawn without a gap.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS", APA, 2005, section 3.1.

use super::links::Links;
use super::rim::{Joined, Rim};
use super::seams::Seams;
use super::{BlockGrid, cut};
use crate::MultiresError;
use crate::tin::vertical::{Ground, vertical_distance_m};
use glam::{DVec2, DVec3};
use yamanami_core::{Aabb, TriangleMesh};

/// Most levels: a level halves the triangles.
pub const MOST_LEVELS: usize = 24;

/// A TIN in blocks, each in all levels.
#[derive(Debug)]
pub struct TinBlocks {
    pub(super) grid: BlockGrid,
    /// Vertices of all levels, and of the seams.
    pub(super) positions: Vec<DVec3>,
    pub(super) levels: Vec<Level>,
    pub(super) seams: Seams,
    bounds: Vec<Option<Aabb>>,
    corners: Vec<[DVec3; 4]>,
}

/// A level, cut.
#[derive(Debug)]
pub(super) struct Level {
    /// Block by block: those that touch no line first, then the rim.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Where each block's triangles begin, and the end.
    pub(super) starts: Vec<u32>,
    /// Rim triangles, block by block, and where each block's begin.
    pub(super) rims: Vec<Rim>,
    pub(super) rim_starts: Vec<u32>,
    links: Links,
    /// First vertex of the level.
    base: u32,
    error_m: f64,
}

impl TinBlocks {
    /// Cuts levels, the finest first, into blocks. All levels cover the same ground and have the same border: as
    /// [`super::centroid_chain`] makes them.
    pub fn new(levels: &[TriangleMesh], grid: BlockGrid) -> Result<Self, MultiresError> {
        let Some(source) = levels.first() else { return Err(MultiresError::NoTriangles { triangles: 0 }) };
        if levels.len() > MOST_LEVELS {
            let count = levels.len() as u64;
            return Err(MultiresError::TooManyBlocks { what: "levels", count, most: MOST_LEVELS as u64 });
        }
        let errors_m: Vec<f64> =
            levels.iter().enumerate().map(|(l, mesh)| if l == 0 { 0.0 } else { apart_m(source, mesh) }).collect();
        let cuts = levels.iter().map(|mesh| cut(mesh, &grid)).collect::<Result<Vec<_>, _>>()?;
        let vertices: u64 = cuts.iter().map(|cut| cut.mesh.positions.len() as u64).sum();
        // the seams add less than twice as many again
        let most = u64::from(u32::MAX) / 4;
        if vertices > most {
            return Err(MultiresError::TooManyBlocks { what: "vertices in all levels", count: vertices, most });
        }
        let mut positions = Vec::with_capacity(vertices as usize);
        let mut bases = Vec::new();
        for cut in &cuts {
            bases.push(positions.len() as u32);
            positions.extend_from_slice(&cut.mesh.positions);
        }
        let seams = Seams::new(&grid, &cuts, &bases, &mut positions);
        let mut bounds = vec![None; grid.len()];
        let mut done = Vec::new();
        for (nth, cut) in cuts.into_iter().enumerate() {
            let links_of = cut.mesh.positions.len();
            let mut level = Level {
                triangles: Vec::with_capacity(cut.mesh.triangles.len()),
                rims: Vec::new(),
                rim_starts: vec![0],
                links: Links::new(&[], 0),
                base: bases[nth],
                error_m: errors_m[nth],
                starts: Vec::new(),
            };
            for block in 0..grid.len() {
                let mut rim_triangles = Vec::new();
                for t in cut.range(block) {
                    let places = cut.mesh.corners(t);
                    let triangle = cut.mesh.triangles[t].map(|v| bases[nth] + v);
                    for p in places {
                        bounds[block].get_or_insert(Aabb::EMPTY).include(p);
                    }
                    match Rim::of(triangle, places, block, nth, &grid, &seams, &positions) {
                        None => level.triangles.push(triangle),
                        Some(rim) => {
                            rim_triangles.push(triangle);
                            level.rims.push(rim);
                        }
                    }
                }
                level.triangles.append(&mut rim_triangles);
                level.rim_starts.push(level.rims.len() as u32);
            }
            level.starts = cut.starts;
            let local: Vec<[u32; 3]> = level.triangles.iter().map(|t| t.map(|v| v - level.base)).collect();
            level.links = Links::new(&local, links_of);
            done.push(level);
        }
        let mut blocks = Self { grid, positions, levels: done, seams, bounds, corners: Vec::new() };
        blocks.corners = (0..blocks.grid.len()).map(|block| blocks.find_corners(block)).collect();
        Ok(blocks)
    }

    /// The blocks' places.
    pub fn grid(&self) -> &BlockGrid {
        &self.grid
    }

    /// Number of levels; 0 is the finest.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Vertices that triangles name, metres.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Triangles of a level in all blocks together, after the cut and without seams.
    pub fn triangle_count(&self, level: usize) -> usize {
        self.levels[level].triangles.len()
    }

    /// The greatest vertical distance of a level from the finest, inside the blocks, metres. In the triangles at a seam the heights of the finer
    /// level beside it come in, which may be so far off again.
    pub fn error_m(&self, level: usize) -> f64 {
        self.levels[level].error_m
    }

    /// The box around all that a block may show; `None` for a block without triangles.
    pub fn bounds(&self, block: usize) -> Option<Aabb> {
        self.bounds[block]
    }

    /// A block's four corners on the ground of the finest level, metres; where it has no ground there, at the height of its
    /// nearest vertex.
    pub fn corners_m(&self, block: usize) -> [DVec3; 4] {
        self.corners[block]
    }

    fn find_corners(&self, block: usize) -> [DVec3; 4] {
        let [low, high] = self.grid.corners_m(block);
        [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)].map(|corner| {
            let vertices = self.triangles(block, 0).as_flattened().iter().map(|&v| self.positions[v as usize]);
            let off = |p: &DVec3| p.truncate().distance_squared(corner);
            let nearest = vertices.min_by(|a, b| off(a).total_cmp(&off(b)));
            corner.extend(nearest.map_or(0.0, |p| p.z))
        })
    }

    /// A block's own triangles in a level, without seams.
    pub fn triangles(&self, block: usize, level: usize) -> &[[u32; 3]] {
        let level = &self.levels[level];
        &level.triangles[level.starts[block] as usize..level.starts[block + 1] as usize]
    }

    /// The triangles of a block and level that share a vertex, by their places in [`Self::triangles`].
    pub fn linked(&self, block: usize, level: usize, vertex: u32) -> impl Iterator<Item = usize> + '_ {
        let level = &self.levels[level];
        let range = level.starts[block] as usize..level.starts[block + 1] as usize;
        let own = level.links.of(vertex - level.base).filter(move |t| range.contains(t));
        own.map(move |t| t - level.starts[block] as usize)
    }

    /// A block as it is drawn when every block is shown at its level, `shown[block]`, each below [`Self::levels`].
    pub fn joined<'a>(&'a self, block: usize, shown: &'a [u8]) -> Joined<'a> {
        Joined::new(self, block, shown)
    }

    /// All blocks joined, at these levels. With its own vertices only, each once.
    pub fn mesh(&self, shown: &[u8]) -> TriangleMesh {
        let mut triangles = Vec::new();
        for block in 0..self.grid.len() {
            self.joined(block, shown).all(&mut triangles);
        }
        self.compact(&triangles)
    }

    /// A mesh of some triangles and the vertices that they name.
    pub fn compact(&self, triangles: &[[u32; 3]]) -> TriangleMesh {
        let mut number = vec![u32::MAX; self.positions.len()];
        let mut positions = Vec::new();
        let triangles = triangles.iter().map(|corners| {
            corners.map(|v| {
                let slot = &mut number[v as usize];
                if *slot == u32::MAX {
                    *slot = positions.len() as u32;
                    positions.push(self.positions[v as usize]);
                }
                *slot
            })
        });
        let triangles = triangles.collect();
        TriangleMesh::new(positions, triangles)
    }
}

/// The greatest vertical distance of two levels, metres.
fn apart_m(fine: &TriangleMesh, coarse: &TriangleMesh) -> f64 {
    let near = fine.positions.first().copied().unwrap_or_default();
    let [of_fine, of_coarse] = [fine, coarse].map(|mesh| mesh.positions.iter().map(|&p| p - near).collect::<Vec<_>>());
    vertical_distance_m(
        Ground { positions: &of_fine, triangles: &fine.triangles },
        Ground { positions: &of_coarse, triangles: &coarse.triangles },
    )
}
