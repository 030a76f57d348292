//! Splits a TIN's triangles along the lines between blocks.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS", APA, 2005, section 3.1: a
//! triangle that a line crosses becomes a triangle and a quadrilateral, and that two triangles. A vertex on a line is worked
//! out once, from places alone, so that both sides of an edge, and all levels that have it, get the same bits.

use super::BlockGrid;
use crate::MultiresError;
use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::TriangleMesh;

/// Vertices nearer to a line than this share of a block's side are put on it: what would be cut off is nothing but rounding.
const ON_LINE_SHARE: f64 = 1e-9;

/// Most triangles after the cut.
const MOST_PIECES: usize = 1 << 30;

/// A TIN whose triangles each lie in one block.
#[derive(Debug, Clone, PartialEq)]
pub struct CutTin {
    /// Places and triangles, block by block.
    pub mesh: TriangleMesh,
    /// Where each block's triangles begin, and the end.
    pub starts: Vec<u32>,
}

impl CutTin {
    /// Numbers of a block's triangles.
    pub fn range(&self, block: usize) -> std::ops::Range<usize> {
        self.starts[block] as usize..self.starts[block + 1] as usize
    }
}

/// Cuts a TIN, a mesh without overlap in plan, along the lines of a grid. The source's vertices keep their numbers; those
/// within a billionth of a block's side of a line are put on it.
pub fn cut(mesh: &TriangleMesh, grid: &BlockGrid) -> Result<CutTin, MultiresError> {
    let mut cutter = Cutter { positions: mesh.positions.clone(), on_edge: HashMap::new(), at_place: HashMap::new() };
    let near_m = ON_LINE_SHARE * grid.least_side_m();
    for p in &mut cutter.positions {
        // no zero below zero: equal places must have equal bits
        *p += DVec3::ZERO;
        for axis in 0..2 {
            p[axis] = onto_line(p[axis], grid.inner(axis), near_m);
        }
    }
    let mut pieces: Vec<(usize, [u32; 3])> = Vec::with_capacity(mesh.triangles.len());
    let (mut by_columns, mut by_rows) = (Vec::new(), Vec::new());
    for &triangle in &mesh.triangles {
        by_columns.clear();
        cutter.split(triangle, 0, grid.inner(0), &mut by_columns);
        for &column in &by_columns {
            by_rows.clear();
            cutter.split(column, 1, grid.inner(1), &mut by_rows);
            for &piece in &by_rows {
                let [a, b, c] = piece.map(|v| cutter.positions[v as usize]);
                pieces.push((grid.block_at((a + b + c) / 3.0), piece));
            }
        }
        if pieces.len() > MOST_PIECES {
            return Err(MultiresError::TooManyBlocks {
                what: "triangles after the cut",
                count: pieces.len() as u64,
                most: MOST_PIECES as u64,
            });
        }
    }
    let mut starts = vec![0u32; grid.len() + 1];
    for (block, _) in &pieces {
        starts[block + 1] += 1;
    }
    for block in 0..grid.len() {
        starts[block + 1] += starts[block];
    }
    // equal blocks keep their order
    pieces.sort_by_key(|&(block, _)| block);
    let triangles = pieces.into_iter().map(|(_, piece)| piece).collect();
    Ok(CutTin { mesh: TriangleMesh::new(cutter.positions, triangles), starts })
}

fn onto_line(v: f64, lines_m: &[f64], near_m: f64) -> f64 {
    let i = lines_m.partition_point(|&line| line < v);
    let near = |line: &&f64| (**line - v).abs() <= near_m;
    let below = i.checked_sub(1).and_then(|i| lines_m.get(i)).filter(near);
    lines_m.get(i).filter(near).or(below).copied().unwrap_or(v)
}

struct Cutter {
    positions: Vec<DVec3>,
    /// The vertex that a line makes on an edge, which it then is no more: one line cuts it first, whichever side looks.
    on_edge: HashMap<[u32; 2], u32>,
    /// New vertices by place: two that fall together are one.
    at_place: HashMap<[u64; 3], u32>,
}

impl Cutter {
    /// Splits a triangle along the lines across an axis that cross it, in their order.
    fn split(&mut self, triangle: [u32; 3], axis: usize, lines_m: &[f64], out: &mut Vec<[u32; 3]>) {
        let mut rest = vec![triangle];
        while let Some(triangle) = rest.pop() {
            let along = triangle.map(|v| self.positions[v as usize][axis]);
            let (least, most) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
            let i = lines_m.partition_point(|&line| line <= least);
            match lines_m.get(i).filter(|&&line| line < most) {
                None => out.push(triangle),
                Some(&line_m) => self.split_once(triangle, along, axis, line_m, &mut rest),
            }
        }
    }

    /// Splits a triangle along a line that crosses it, into two or three.
    fn split_once(&mut self, triangle: [u32; 3], along: [f64; 3], axis: usize, line_m: f64, out: &mut Vec<[u32; 3]>) {
        let turned = |k: usize| [triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]];
        let mut push = |piece: [u32; 3]| {
            // pieces whose corners fell together have no area
            if piece[0] != piece[1] && piece[1] != piece[2] && piece[2] != piece[0] {
                out.push(piece);
            }
        };
        if let Some(k) = (0..3).find(|&k| along[k] == line_m) {
            let [a, b, c] = turned(k);
            let p = self.on_edge([b, c], axis, line_m);
            push([a, b, p]);
            push([a, p, c]);
            return;
        }
        let is_below = along.map(|v| v < line_m);
        // the one corner that is alone on its side
        let k =
            (0..3).find(|&k| is_below[k] != is_below[(k + 1) % 3] && is_below[k] != is_below[(k + 2) % 3]).unwrap_or(0);
        let [a, b, c] = turned(k);
        let [p, q] = [[a, b], [a, c]].map(|edge| self.on_edge(edge, axis, line_m));
        push([a, p, q]);
        let length = |from: u32, to: u32| self.positions[from as usize].distance_squared(self.positions[to as usize]);
        if length(p, c) <= length(b, q) {
            push([p, b, c]);
            push([p, c, q]);
        } else {
            push([p, b, q]);
            push([b, c, q]);
        }
    }

    /// The vertex on an edge that a line crosses.
    fn on_edge(&mut self, [a, b]: [u32; 2], axis: usize, line_m: f64) -> u32 {
        let key = [a.min(b), a.max(b)];
        if let Some(&vertex) = self.on_edge.get(&key) {
            return vertex;
        }
        let [mut p, mut q] = key.map(|v| self.positions[v as usize]);
        // the order must not hang on numbers: other levels have others
        if q[axis] < p[axis] {
            std::mem::swap(&mut p, &mut q);
        }
        let t = (line_m - p[axis]) / (q[axis] - p[axis]);
        let mut place = p + t * (q - p);
        place[axis] = line_m;
        let positions = &mut self.positions;
        let vertex = *self.at_place.entry(place.to_array().map(f64::to_bits)).or_insert_with(|| {
            positions.push(place);
            positions.len() as u32 - 1
        });
        self.on_edge.insert(key, vertex);
        vertex
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin_block::centroid_chain;
    use crate::tin_block::tests::rough_tin;
    use glam::DVec2;
    use proptest::prelude::*;
    use yamanami_testkit::check_conforming;
    use yamanami_testkit::laws::Kind;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn each_triangle_lies_in_its_block_and_nothing_cracks(
            seed in any::<u64>(), side in 2u32..14, columns in 1usize..7, rows in 1usize..7,
            shift in prop::array::uniform2(-0.5f64..0.5), are_on_vertices in any::<bool>(),
        ) {
            let source = rough_tin(side, seed);
            let extent = 10.0 * f64::from(side);
            let size = DVec2::new(extent / columns as f64, extent / rows as f64);
            let origin = if are_on_vertices { DVec2::ZERO } else { DVec2::from(shift) * size };
            let grid = BlockGrid::new(origin, size, [columns, rows]).unwrap();
            for level in centroid_chain(&source, 3, Default::default()).unwrap() {
                let cut = cut(&level, &grid).unwrap();
                prop_assert_eq!(check_cut(&cut, &grid), Ok(()));
                prop_assert!(cut.mesh.positions[..level.positions.len()].iter().zip(&level.positions).all(|(a, b)| a.distance(*b) < 1e-6));
            }
        }
    }

    /// Every triangle in its block's rectangle, counter-clockwise, and the whole conforming.
    fn check_cut(cut: &CutTin, grid: &BlockGrid) -> Result<(), String> {
        let [columns, rows] = grid.count();
        for block in 0..grid.len() {
            let [mut low, mut high] = grid.corners_m(block);
            let at = [block % columns, block / columns];
            for axis in 0..2 {
                low[axis] = if at[axis] == 0 { f64::NEG_INFINITY } else { low[axis] };
                high[axis] = if at[axis] + 1 == [columns, rows][axis] { f64::INFINITY } else { high[axis] };
            }
            for t in cut.range(block) {
                if cut.mesh.corners(t).iter().any(|p| p.truncate().cmplt(low).any() || p.truncate().cmpgt(high).any()) {
                    return Err(format!("triangle {t} leaves block {block}"));
                }
            }
        }
        check_conforming(&cut.mesh, &cut.mesh, Kind::TerrainWithHoles)
    }

    #[test]
    fn a_triangle_over_many_blocks_and_a_vertex_beside_a_line() {
        let positions =
            vec![DVec3::new(0.0, 0.0, 1.0), DVec3::new(40.0, 3.0, 2.0), DVec3::new(20.0 + 1e-10, 31.0, 3.0)];
        let mesh = TriangleMesh::new(positions, vec![[0, 1, 2]]);
        let grid = BlockGrid::covering(&mesh.bounds(), 4.0).unwrap();
        let cut = cut(&mesh, &grid).unwrap();
        assert_eq!(check_cut(&cut, &grid), Ok(()));
        assert_eq!(cut.mesh.positions[2].x, 20.0);
        let area = |mesh: &TriangleMesh| {
            (0..mesh.triangles.len())
                .map(|t| {
                    let [a, b, c] = mesh.corners(t);
                    (b - a).cross(c - a).z
                })
                .sum::<f64>()
        };
        assert!((area(&cut.mesh) - area(&mesh)).abs() < 1e-6);
        assert!((0..grid.len()).any(|block| cut.range(block).is_empty()), "the corners of the box are empty");
        assert!(BlockGrid::covering(&mesh.bounds(), 1e-6).is_err());
        assert!(BlockGrid::new(DVec2::ZERO, DVec2::new(0.0, 1.0), [2, 2]).is_err());
        assert!(BlockGrid::new(DVec2::ZERO, DVec2::new(f64::NAN, 1.0), [2, 2]).is_err());
        assert!(BlockGrid::new(DVec2::splat(1e17), DVec2::ONE, [2, 2]).is_err());
    }
}
