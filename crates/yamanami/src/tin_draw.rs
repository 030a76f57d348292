//! The paper's drawing step for a TIN in blocks: levels by distance, and three ways to leave out what is not seen.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS" (三次元GISのためのTINの高速描画法),
//! APA, 2005, section 3.2. Its rule looks at corners only and so loses blocks and triangles whose corners are all outside the
//! view, often the block that the eye is in: [`Culling::Conservative`] does not.

use glam::DVec3;
use yamanami_core::{Frustum, Sight, View};
use yamanami_multires::tin_block::TinBlocks;

/// How what is not seen is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Culling {
    /// The paper's opponent: every triangle of the finest level, drawn as soon as a corner is in view.
    BruteForce,
    /// The paper's rule. Of a block with four corners in view everything is drawn, of one with none nothing, of others each
    /// triangle with a corner in view and all that share such a corner.
    Faithful,
    /// The same levels, but a block or triangle is left out only when it lies wholly beside or behind what is seen.
    #[default]
    Conservative,
}

/// What a drawing step did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DrawCounts {
    /// Blocks of which something was drawn.
    pub blocks: usize,
    /// Corners of blocks held against the view; boxes of blocks where those are tested.
    pub block_tests: usize,
    /// Corners of triangles held against the view; whole triangles where those are tested.
    pub triangle_tests: usize,
}

/// The drawing step, with its memory kept from one picture to the next.
#[derive(Debug, Clone, Default)]
pub struct TinDrawing {
    /// Distances from the eye to a block's middle, metres, beyond which the next coarser level is drawn.
    pub thresholds_m: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    /// Where each block's triangles end.
    ends: Vec<usize>,
    shown: Vec<u8>,
    is_drawn: Vec<bool>,
}

impl TinDrawing {
    /// With these distances, near to far.
    pub fn new(thresholds_m: Vec<f64>) -> Self {
        Self { thresholds_m, ..Self::default() }
    }

    /// What was drawn, by the vertices of the blocks.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// What was drawn of a block.
    pub fn triangles_of(&self, block: usize) -> &[[u32; 3]] {
        let from = block.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.triangles[from..self.ends[block]]
    }

    /// Level of each block.
    pub fn shown(&self) -> &[u8] {
        &self.shown
    }

    /// Chooses levels and collects what a view shows.
    pub fn draw(&mut self, blocks: &TinBlocks, view: &View, culling: Culling) -> DrawCounts {
        self.draw_seen(blocks, view.eye, &view.frustum(), culling)
    }

    /// The same for what is seen of any other shape.
    pub fn draw_seen(&mut self, blocks: &TinBlocks, eye: DVec3, frustum: &Frustum, culling: Culling) -> DrawCounts {
        self.triangles.clear();
        self.ends.clear();
        self.choose(blocks, eye, culling);
        let mut counts = DrawCounts::default();
        for block in 0..blocks.grid().len() {
            let before = self.triangles.len();
            match culling {
                Culling::BruteForce => self.each_corner(blocks, block, frustum, &mut counts),
                Culling::Faithful => self.faithful(blocks, block, frustum, &mut counts),
                Culling::Conservative => self.conservative(blocks, block, frustum, &mut counts),
            }
            self.ends.push(self.triangles.len());
            counts.blocks += usize::from(self.triangles.len() > before);
        }
        counts
    }

    fn choose(&mut self, blocks: &TinBlocks, eye: DVec3, culling: Culling) {
        let coarsest = blocks.levels() - 1;
        let level = |block: usize| {
            let [low, high] = blocks.grid().corners_m(block);
            let height_m = blocks.bounds(block).map_or(0.0, |b| b.centre().z);
            let distance_m = eye.distance(((low + high) * 0.5).extend(height_m));
            self.thresholds_m.iter().filter(|&&threshold_m| distance_m >= threshold_m).count().min(coarsest) as u8
        };
        let is_full = culling == Culling::BruteForce;
        self.shown = (0..blocks.grid().len()).map(|block| if is_full { 0 } else { level(block) }).collect();
    }

    fn each_corner(&mut self, blocks: &TinBlocks, block: usize, frustum: &Frustum, counts: &mut DrawCounts) {
        for triangle in blocks.triangles(block, 0) {
            let is_seen = triangle.iter().any(|&v| {
                counts.triangle_tests += 1;
                frustum.sees_point(blocks.positions()[v as usize])
            });
            if is_seen {
                self.triangles.push(*triangle);
            }
        }
    }

    fn faithful(&mut self, blocks: &TinBlocks, block: usize, frustum: &Frustum, counts: &mut DrawCounts) {
        let joined = blocks.joined(block, &self.shown);
        counts.block_tests += 4;
        match blocks.corners_m(block).iter().filter(|&&p| frustum.sees_point(p)).count() {
            0 => (),
            4 => joined.all(&mut self.triangles),
            _ => {
                let own = blocks.triangles(block, joined.level());
                self.is_drawn.clear();
                self.is_drawn.resize(own.len(), false);
                for (t, triangle) in own.iter().enumerate() {
                    if self.is_drawn[t] {
                        continue;
                    }
                    counts.triangle_tests += 3;
                    for &v in triangle.iter().filter(|&&v| frustum.sees_point(blocks.positions()[v as usize])) {
                        for linked in blocks.linked(block, joined.level(), v) {
                            if !std::mem::replace(&mut self.is_drawn[linked], true) {
                                joined.one(linked, &mut self.triangles);
                            }
                        }
                    }
                }
            }
        }
    }

    fn conservative(&mut self, blocks: &TinBlocks, block: usize, frustum: &Frustum, counts: &mut DrawCounts) {
        let Some(bounds) = blocks.bounds(block) else { return };
        let joined = blocks.joined(block, &self.shown);
        counts.block_tests += 1;
        match frustum.sight_of(&bounds) {
            Sight::Outside => (),
            Sight::Inside => joined.all(&mut self.triangles),
            Sight::Crosses => {
                let from = self.triangles.len();
                joined.all(&mut self.triangles);
                counts.triangle_tests += self.triangles.len() - from;
                let mut kept = from;
                for i in from..self.triangles.len() {
                    let triangle = self.triangles[i];
                    if !frustum.misses(triangle.map(|v| blocks.positions()[v as usize])) {
                        self.triangles[kept] = triangle;
                        kept += 1;
                    }
                }
                self.triangles.truncate(kept);
            }
        }
    }
}

/// The triangles of a block that are seen when blocks are shown at these levels, by clipping each: slow and exact.
pub fn seen_triangles(blocks: &TinBlocks, block: usize, shown: &[u8], frustum: &Frustum) -> Vec<[u32; 3]> {
    let mut all = Vec::new();
    blocks.joined(block, shown).all(&mut all);
    all.retain(|triangle| {
        let corners = triangle.map(|v| blocks.positions()[v as usize]);
        !frustum.misses(corners) && frustum.seen_part(corners).len() >= 3
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use std::collections::HashSet;
    use yamanami_core::TriangleMesh;
    use yamanami_multires::tin_block::{BlockGrid, CostReading, centroid_chain};
    use yamanami_testkit::{Rng, Shape, Spacing, SyntheticTerrain};

    /// The paper's blocks, 6 by 4 of 520 m, with ground every 65 m.
    fn paper_blocks(relief_m: f32) -> TinBlocks {
        let shape = Shape::Fractal { relief_m, roughness: 0.5, seed: 3 };
        let field = SyntheticTerrain::new(49, 33, shape, Spacing::Metres(65.0)).to_field();
        let place =
            |i: usize| DVec3::new((i % 49) as f64 * 65.0, (i / 49) as f64 * 65.0, f64::from(field.heights_m()[i]));
        let cell = |i: u32| [[i, i + 1, i + 50], [i, i + 50, i + 49]];
        let triangles = (0..32u32).flat_map(|y| (0..48).map(move |x| y * 49 + x)).flat_map(cell).collect();
        let mesh = TriangleMesh::new((0..49 * 33).map(place).collect(), triangles);
        let chain = centroid_chain(&mesh, 3, CostReading::Plain).unwrap();
        TinBlocks::new(&chain, BlockGrid::new(DVec2::ZERO, DVec2::splat(520.0), [6, 4]).unwrap()).unwrap()
    }

    fn random_view(rng: &mut Rng) -> View {
        let eye = DVec3::new(3120.0 * rng.unit(), 2080.0 * rng.unit(), 40.0 + 400.0 * rng.unit());
        let heading = std::f64::consts::TAU * rng.unit();
        let target = eye + DVec3::new(heading.sin(), heading.cos(), 0.6 * rng.unit() - 0.5);
        View { eye, target, fov_y_rad: 0.3 + rng.unit(), viewport_px: [640, 480] }
    }

    #[test]
    fn conservative_culling_loses_nothing_that_is_seen() {
        let blocks = paper_blocks(120.0);
        let mut drawing = TinDrawing::new(vec![1000.0, 2000.0]);
        let mut rng = Rng::new(1);
        let (mut losses, mut drawn) = (0, 0);
        for _ in 0..100 {
            let view = random_view(&mut rng);
            drawing.draw(&blocks, &view, Culling::Conservative);
            let found: HashSet<_> = drawing.triangles().iter().copied().collect();
            assert_eq!(found.len(), drawing.triangles().len(), "a triangle was drawn twice");
            let seen_in = |block| seen_triangles(&blocks, block, drawing.shown(), &view.frustum());
            let seen: Vec<_> = (0..blocks.grid().len()).flat_map(seen_in).collect();
            assert!(seen.iter().all(|triangle| found.contains(triangle)));
            drawn += found.len();
            drawing.draw(&blocks, &view, Culling::Faithful);
            let found: HashSet<_> = drawing.triangles().iter().copied().collect();
            assert_eq!(found.len(), drawing.triangles().len());
            losses += seen.iter().filter(|triangle| !found.contains(*triangle)).count();
        }
        assert!(losses > 0 && drawn > 0);
    }

    #[test]
    fn brute_force_tests_all_and_draws_the_finest_level() {
        let blocks = paper_blocks(120.0);
        let mut drawing = TinDrawing::new(vec![1000.0, 2000.0]);
        let view = random_view(&mut Rng::new(5));
        let counts = drawing.draw(&blocks, &view, Culling::BruteForce);
        let all = blocks.triangle_count(0);
        assert!(counts.triangle_tests > all && counts.triangle_tests <= 3 * all);
        assert!(!drawing.triangles().is_empty() && drawing.triangles().len() < all);
        assert!(drawing.shown().iter().all(|&level| level == 0));
        let counts = drawing.draw(&blocks, &view, Culling::Conservative);
        assert!(counts.triangle_tests < all && drawing.shown().iter().any(|&level| level > 0));
    }

    /// In plan: a view so tall that heights do not matter, 45° wide.
    #[test]
    fn the_corner_rule_loses_the_eyes_own_block_half_of_the_time() {
        let blocks = paper_blocks(1.0);
        let mut rng = Rng::new(2);
        let (mut without_own, mut seen_blocks, mut without_corner) = (0, 0, 0);
        const POSES: usize = 2000;
        for _ in 0..POSES {
            let eye = DVec3::new(3120.0 * rng.unit(), 2080.0 * rng.unit(), 0.5);
            let heading = std::f64::consts::TAU * rng.unit();
            let view = View {
                eye,
                target: eye + DVec3::new(heading.sin(), heading.cos(), 0.0),
                fov_y_rad: 2.0 * 1000f64.atan(),
                viewport_px: [4142, 10_000_000],
            };
            let frustum = view.frustum();
            for block in 0..blocks.grid().len() {
                let has_corner = blocks.corners_m(block).iter().any(|&p| frustum.sees_point(p));
                let [a, b, c, d] = blocks.corners_m(block);
                let is_seen = [[a, b, c], [a, c, d]].iter().any(|&t| frustum.seen_part(t).len() >= 3);
                seen_blocks += usize::from(is_seen);
                without_corner += usize::from(is_seen && !has_corner);
                without_own += usize::from(blocks.grid().block_at(eye) == block && !has_corner);
            }
        }
        let share = without_own as f64 / POSES as f64;
        assert!((0.45..0.55).contains(&share), "{share}");
        let share = without_corner as f64 / seen_blocks as f64;
        assert!((0.05..0.12).contains(&share), "{share}");
    }
}
