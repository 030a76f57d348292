//! Builds the hierarchy: errors, heights and slopes of all nodes, from fine to coarse, on all cores.

use super::diamonds::{Block, Diamonds, Place, child_places, diamond, is_centre};
use super::errors::distance_m;
use super::ground::Ground;
use super::summits::summits;
use crate::MultiresError;
use rayon::prelude::*;
use yamanami_core::{NestedField, NodeId};

/// Heights beyond this are refused, metres either way.
const MAX_HEIGHT_M: f32 = 500_000.0;

/// Summits count by at most this many times their prominence: enough to keep all, and finite.
const MAX_FACTOR: f32 = 1000.0;

/// How to build.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BuildOptions {
    /// Keeps summits longer, if wanted.
    pub summits: Option<SummitRule>,
}

/// Summits and their key saddles count by their prominence: where one is no vertex, the surface counts as off by at least
/// so many times it. So they, and the triangles along the ridges to them, stay in coarser fronts than their error alone
/// would keep them in. Errors only grow, and stay bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SummitRule {
    /// Factor on the prominence, from 0 on: a summit is off by about its prominence where it is cut off, so that below 1
    /// few are kept longer.
    pub factor: f32,
    /// Summits of less prominence do not count, metres.
    pub min_prominence_m: f64,
}

/// What is kept of a node. Heights are of all vertices of its diamond and its descendants', slopes of their triangles.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct NodeData {
    /// Greatest distance of any sample from what is shown while the node is not applied, not below the children's.
    pub(super) error_m: f32,
    pub(super) low_m: f32,
    pub(super) high_m: f32,
    /// Greatest difference of a triangle's corners.
    pub(super) rise_m: f32,
}

/// What all nodes of a level share.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LevelShape {
    /// A circle of this radius holds the diamond and the circles of the children, metres.
    pub(super) radius_m: f64,
    /// Longest edge of the diamond's triangles, metres.
    pub(super) edge_m: f64,
}

/// A nested field as a hierarchy of right triangles.
#[derive(Debug, Clone)]
pub struct Rtin {
    pub(super) ground: Ground,
    pub(super) diamonds: Diamonds,
    pub(super) data: Vec<NodeData>,
    /// By log₂ of the spacing: of cell centres, and of the middles of sides.
    pub(super) shapes: Vec<[LevelShape; 2]>,
}

impl Rtin {
    /// Builds the hierarchy of a field.
    pub fn build(field: NestedField, options: &BuildOptions) -> Result<Self, MultiresError> {
        let width = field.widest().width();
        let diamonds = Diamonds::new(&field).ok_or(MultiresError::TooLarge { width, height: width })?;
        for grid in field.levels() {
            let width = grid.width();
            if let Some(i) = grid.heights_m().par_iter().position_any(|z| z.abs() > MAX_HEIGHT_M) {
                let (column, row) = (i % width, i / width);
                return Err(MultiresError::HeightOutOfRange { height_m: grid.heights_m()[i], column, row });
            }
        }
        let ground = Ground::new(field);
        let mut data = vec![NodeData::default(); diamonds.bound() as usize];
        if let Some(rule) = options.summits {
            raise_summits(&ground, &diamonds, rule, &mut data);
        }
        for k in 1..diamonds.base() {
            let [centres, across, upright] = diamonds.blocks(k);
            for block in [upright, across, centres] {
                fill_block(&ground, &diamonds, block, &mut data);
            }
        }
        let shapes = shapes(diamonds.base(), ground.unit_m());
        Ok(Self { ground, diamonds, data, shapes })
    }

    /// The field it was built of.
    pub fn field(&self) -> &NestedField {
        self.ground.field()
    }
}

/// Weighs the nodes of a block, whose children come later in number and are done.
fn fill_block(ground: &Ground, diamonds: &Diamonds, block: Block, data: &mut [NodeData]) {
    let first = block.first as usize;
    let (own, finer) = data[first..].split_at_mut(block.columns * block.rows);
    let finer_first = first + own.len();
    let child = |node: NodeId| &finer[node as usize - finer_first];
    own.par_chunks_mut(block.columns.max(1)).enumerate().for_each(|(row, nodes)| {
        for (column, node) in nodes.iter_mut().enumerate() {
            let place = [block.place[0] + block.step * column as i32, block.place[1] + block.step * row as i32];
            weigh(ground, diamonds, place, node);
            for child in child_places(place).into_iter().filter_map(|p| diamonds.number(p)).map(child) {
                node.error_m = node.error_m.max(child.error_m);
                node.low_m = node.low_m.min(child.low_m);
                node.high_m = node.high_m.max(child.high_m);
                node.rise_m = node.rise_m.max(child.rise_m);
            }
        }
    });
}

/// What a node is by itself; its error is not lowered.
fn weigh(ground: &Ground, diamonds: &Diamonds, place: Place, node: &mut NodeData) {
    let (d, k) = (diamond(place), (place[0] | place[1]).trailing_zeros());
    let (z, farthest) = (ground.height_m(place), place[0].abs().max(place[1].abs()));
    let [a, b] = d.ends.map(|p| ground.height_m(p));
    (node.low_m, node.high_m) = (z.min(a).min(b), z.max(a).max(b));
    if k <= ground.grids() && farthest <= diamonds.reach(k) << k {
        // the samples of its own lattice are its vertex and its children's
        node.error_m =
            node.error_m.max(rounded_up(0.5 * ((f64::from(z) - f64::from(a)) + (f64::from(z) - f64::from(b)))));
    }
    for apex in diamonds.apexes(&d) {
        let c = ground.height_m(apex);
        (node.low_m, node.high_m) = (node.low_m.min(c), node.high_m.max(c));
        node.rise_m = node.rise_m.max(a.max(b).max(c) - a.min(b).min(c));
        // samples of wider grids are no finer than the triangle, those of narrower ones may be elsewhere
        for grid in 1..=(k - 1).min(ground.grids()) {
            let reach = diamonds.reach(grid);
            if farthest - (1 << k) <= reach << grid {
                node.error_m = node.error_m.max(rounded_up(distance_m(ground, d.ends, place, apex, grid, reach)));
            }
        }
    }
}

/// A distance in f32, never below the true one.
#[inline]
fn rounded_up(distance_m: f64) -> f32 {
    let (exact, short) = (distance_m.abs(), distance_m.abs() as f32);
    if f64::from(short) < exact { short.next_up() } else { short }
}

/// Nested circles: a child's centre is a step off, and its circle is inside.
fn shapes(base: u32, unit_m: f64) -> Vec<[LevelShape; 2]> {
    let mut out = vec![[LevelShape::default(); 2]];
    for k in 1..base {
        let step_m = unit_m * f64::from(1u32 << k);
        let finer = out[k as usize - 1][0].radius_m;
        let diagonal = std::f64::consts::SQRT_2 * step_m;
        let side_radius_m = step_m.max(0.5 * diagonal + finer);
        let sides = LevelShape { radius_m: side_radius_m, edge_m: 2.0 * step_m };
        let centres = LevelShape { radius_m: diagonal.max(step_m + side_radius_m), edge_m: 2.0 * diagonal };
        out.push([centres, sides]);
    }
    out
}

/// Starts the errors of summits and key saddles at a multiple of the prominence, grid by grid.
fn raise_summits(ground: &Ground, diamonds: &Diamonds, rule: SummitRule, data: &mut [NodeData]) {
    for k in 1..=ground.grids() {
        let half = ground.grid(k).half() as i32;
        for summit in summits(ground.grid(k), rule.min_prominence_m) {
            let places = [Some([summit.column, summit.row]), summit.saddle];
            for [column, row] in places.into_iter().flatten() {
                let place = [(column as i32 - half) << k, (half - row as i32) << k];
                if let Some(node) = diamonds.number(place) {
                    let error_m = &mut data[node as usize].error_m;
                    *error_m = error_m.max(rule.factor.clamp(0.0, MAX_FACTOR) * summit.prominence_m as f32);
                }
            }
        }
    }
}

/// Which of a lattice's two levels a place is of: 0 for cell centres.
#[inline]
pub(super) fn level_kind(place: Place, k: u32) -> usize {
    usize::from(!is_centre(place, k))
}
