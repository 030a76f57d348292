//! Cutting a hierarchy of clusters into the cells of an implicit tileset, without cracks at any mix of levels.
//!
//! A tile of level z shows, in its cell, the front whose nodes have an error above that of the level, or above that of the
//! leaves where their bound reaches a wall of the cell: errors and bounds nest, so this is a front, and the triangles that
//! touch a wall are the same at every level that has the wall. Each triangle belongs to the cell of its middle. So whatever
//! levels two neighbours have, the triangles along both sides of their common border are the same, and so are their
//! vertices; none is cut or added. Tiles state their own bounds, as triangles reach over the walls.
//!
//! Idea of fronts: De Floriani, Puppo, Magillo, "A formal approach to multiresolution hypersurface modeling", 1997; of
//! borders that stay fine while the inside is coarsened: Cignoni, Ganovelli, Gobbetti, Marton, Ponchio, Scopigno, "Adaptive
//! TetraPuzzles", 2004. The rule by bounds is ours.

use super::placement::Placement;
use super::tileset_files::TilePlace;
use crate::{Error, Model, Subject};
use glam::DVec3;
use yamanami_core::{Aabb, Hierarchy, NodeId, Surface};
use yamanami_io::tiles::glb::{LatticeMesh, step_below_m};
use yamanami_io::tiles::tileset::Subdivision;

/// Levels below the root: walls lie on whole steps.
const MOST_LEVELS: u32 = 12;
/// Steps in an edge of the source, at least.
const STEPS_AN_EDGE: f64 = 128.0;

/// How far the middle of a line on the ground is from the chord, per square of its length: 1 / 8 R, and a quarter more for
/// lines that are straight on the map and not on the ground.
const SAG_PER_M: f64 = 1.25 / (8.0 * 6.35e6);

/// The lattice of all tiles and the cells on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells {
    pub step_m: f64,
    pub subdivision: Subdivision,
    /// Least corner of the root, in steps.
    low: [i64; 3],
    /// Sides of the root, in steps; a multiple of 2^[`MOST_LEVELS`].
    side: [i64; 3],
}

/// A node as cutting sees it: in steps, in the tileset's frame.
#[derive(Debug, Clone, Copy)]
struct Bound {
    centre: DVec3,
    radius: f64,
    error_m: f64,
}

/// How a model becomes tiles.
#[derive(Debug)]
pub(super) struct Plan {
    pub cells: Cells,
    pub placement: Option<Placement>,
    nodes: Vec<Bound>,
    /// Errors of the levels, coarse first, metres.
    level_error_m: Vec<f64>,
    leaf_error_m: f64,
    /// Beside the hierarchy's errors: places on the lattice, and storing.
    fixed_error_m: f64,
    /// The tiles that may have something, parents first, and whether nothing is below them.
    pub tiles: Vec<(TilePlace, bool)>,
}

impl Cells {
    /// The cell of a lattice place times three.
    fn holds(&self, (level, place): TilePlace, tripled: [i64; 3]) -> bool {
        (0..self.subdivision.axes() as usize).all(|axis| {
            let [low, high] = self.walls(axis, level, place[axis]);
            low.is_none_or(|low| tripled[axis] >= 3 * low) && high.is_none_or(|high| tripled[axis] < 3 * high)
        })
    }

    /// The walls of a cell along an axis, in steps; there is none where the root ends.
    fn walls(&self, axis: usize, level: u32, place: u32) -> [Option<i64>; 2] {
        let wall = |k: u32| self.low[axis] + (self.side[axis] >> level) * i64::from(k);
        [(place > 0).then(|| wall(place)), (place + 1 < 1 << level).then(|| wall(place + 1))]
    }

    /// The root, metres.
    pub(super) fn root(&self) -> Aabb {
        let min = DVec3::from_array(self.low.map(|c| c as f64)) * self.step_m;
        Aabb { min, max: min + DVec3::from_array(self.side.map(|c| c as f64)) * self.step_m }
    }
}

impl Plan {
    /// Plans the tiles of a model whose leaves are within `leaf_error_m` of the source and have about so many triangles.
    pub(super) fn of(model: &Model, placement: Option<Placement>, leaf_error_m: f64, leaf_triangles: i64) -> Self {
        let stretch = placement.as_ref().map_or(1.0, |p| p.stretch);
        let local = |p: DVec3| placement.as_ref().map_or(p, |place| place.local(p));
        let source = model.bounds();
        let mut bounds = Aabb::EMPTY;
        source.corners().into_iter().chain([source.centre()]).for_each(|p| bounds.include(local(p)));
        let surface = model.surface();
        let edge_m = source.diagonal() / (model.full_triangles().max(1) as f64).sqrt();
        let step_m = step_below_m(edge_m / STEPS_AN_EDGE, &bounds);
        let cells = Cells::around(&bounds, step_m, model.is_ground());
        let nodes: Vec<Bound> = (0..surface.node_bound())
            .map(|node| {
                let (error_m, bound) = surface.error_and_bound(node);
                // a vertex goes to the nearest step
                let radius = bound.radius_m * stretch / step_m + 2.0;
                Bound { centre: local(bound.centre) / step_m, radius, error_m: f64::from(error_m) * stretch }
            })
            .collect();
        let stored_m = model.store().map_or(0.0, |store| store.meta().max_error_m);
        let mut plan = Self {
            cells,
            placement,
            nodes,
            level_error_m: Vec::new(),
            leaf_error_m,
            fixed_error_m: 0.5 * 3f64.sqrt() * step_m + stored_m,
            tiles: Vec::new(),
        };
        plan.choose_levels(surface, leaf_triangles);
        plan
    }

    /// Errors of the levels, so that a tile of each has as many triangles as a leaf; and the tree of the tiles.
    fn choose_levels(&mut self, surface: &impl Hierarchy, leaf_triangles: i64) {
        let added = |node: NodeId| i64::from(surface.triangles_added(node, &|_| false));
        let mut applied: Vec<NodeId> =
            (0..surface.node_bound()).filter(|&n| self.nodes[n as usize].error_m > self.leaf_error_m).collect();
        applied.sort_by(|&a, &b| self.nodes[b as usize].error_m.total_cmp(&self.nodes[a as usize].error_m));
        let mut triangles = surface.base_triangle_count() as i64;
        for &node in &applied {
            triangles += added(node);
            while triangles > leaf_triangles << (2 * self.level_error_m.len()) {
                self.level_error_m.push(self.nodes[node as usize].error_m);
            }
        }
        let weighed = applied.iter().map(|&node| (self.nodes[node as usize].centre, added(node))).collect();
        self.divide((0, [0; 3]), weighed, leaf_triangles);
    }

    fn divide(&mut self, tile: TilePlace, nodes: Vec<(DVec3, i64)>, leaf_triangles: i64) {
        let (level, place) = tile;
        let triangles: i64 = nodes.iter().map(|(_, added)| added).sum();
        let is_leaf = triangles <= leaf_triangles || level == MOST_LEVELS;
        self.tiles.push((tile, is_leaf));
        if is_leaf {
            return;
        }
        let axes = self.cells.subdivision.axes();
        let mut parts = vec![Vec::new(); 1 << axes];
        let middle: [f64; 3] = std::array::from_fn(|axis| {
            (self.cells.low[axis] + (self.cells.side[axis] >> (level + 1)) * i64::from(2 * place[axis] + 1)) as f64
        });
        for (centre, added) in nodes {
            let part = (0..axes as usize).map(|axis| usize::from(centre[axis] >= middle[axis]) << axis).sum::<usize>();
            parts[part].push((centre, added));
        }
        for (part, nodes) in parts.into_iter().enumerate() {
            let child = std::array::from_fn(|axis| match axis < axes as usize {
                true => 2 * place[axis] + (part >> axis & 1) as u32,
                false => 0,
            });
            self.divide((level + 1, child), nodes, leaf_triangles);
        }
    }

    /// The nodes of a tile's front that matter in its cell, and its error.
    pub(super) fn front(&self, tile: TilePlace, is_leaf: bool, surface: &impl Hierarchy) -> (Vec<bool>, f64) {
        let (level, place) = tile;
        let level_error_m = match self.level_error_m.get(level as usize) {
            Some(&error_m) if !is_leaf => error_m,
            _ => self.leaf_error_m,
        };
        let axes = self.cells.subdivision.axes() as usize;
        let walls: Vec<[Option<i64>; 2]> = (0..axes).map(|axis| self.cells.walls(axis, level, place[axis])).collect();
        let mut applied = vec![false; self.nodes.len()];
        let mut left_m = 0.0f64;
        for (node, bound) in self.nodes.iter().enumerate() {
            let (mut touches, mut inside) = (true, true);
            for (axis, [low, high]) in walls.iter().enumerate() {
                let (from, to) = (bound.centre[axis] - bound.radius, bound.centre[axis] + bound.radius);
                touches &= low.is_none_or(|low| to >= low as f64) && high.is_none_or(|high| from <= high as f64);
                inside &= low.is_none_or(|low| from > low as f64) && high.is_none_or(|high| to < high as f64);
            }
            if touches {
                applied[node] = bound.error_m > level_error_m || (!inside && bound.error_m > self.leaf_error_m);
            }
        }
        // rounding may have parted a child from its parent
        for node in (0..applied.len()).rev().filter(|&n| applied[n]).collect::<Vec<_>>() {
            surface.parents(node as NodeId).iter().for_each(|&parent| applied[parent as usize] = true);
        }
        for (node, bound) in self.nodes.iter().enumerate().filter(|&(n, _)| !applied[n]) {
            if walls.iter().enumerate().all(|(axis, [low, high])| {
                low.is_none_or(|low| bound.centre[axis] + bound.radius >= low as f64)
                    && high.is_none_or(|high| bound.centre[axis] - bound.radius <= high as f64)
            }) {
                left_m = left_m.max(self.nodes[node].error_m);
            }
        }
        (applied, left_m + self.fixed_error_m)
    }

    /// The part of a front that belongs to a tile, and how far a straight edge in it is from what was straight on the map,
    /// metres. All the front's pages are in memory.
    pub(super) fn part(&self, tile: TilePlace, applied: &[bool], model: &Model) -> Result<(LatticeMesh, f64), Error> {
        let mesh = model.surface().mesh_of(&|node: NodeId| applied[node as usize]);
        let local = |p: DVec3| self.placement.as_ref().map_or(p, |place| place.local(p));
        let mut places = Vec::with_capacity(mesh.positions.len());
        for &p in &mesh.positions {
            let steps = (local(p) / self.cells.step_m).round();
            if !steps.is_finite() {
                return Err(Error::Request(format!("{p} has no place on the globe: CRS or geoid do not reach it")));
            }
            places.push(steps.to_array().map(|c| c as i64));
        }
        let middle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| places[v as usize]);
            std::array::from_fn(|k| a[k] + b[k] + c[k])
        };
        let mut part = LatticeMesh { step_m: self.cells.step_m, ..LatticeMesh::default() };
        let mut number = vec![u32::MAX; places.len()];
        let mut longest_m = 0.0f64;
        for triangle in mesh.triangles.iter().filter(|t| self.cells.holds(tile, middle(t))) {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            longest_m = longest_m.max(a.distance(b)).max(b.distance(c)).max(c.distance(a));
            part.triangles.push(triangle.map(|v| {
                let slot = &mut number[v as usize];
                if *slot == u32::MAX {
                    *slot = part.places.len() as u32;
                    part.places.push(places[v as usize]);
                    if let Some(&normal) = mesh.normals.get(v as usize) {
                        let p = mesh.positions[v as usize];
                        part.normals.push(self.placement.as_ref().map_or(normal, |place| place.turned(p, normal)));
                    }
                    part.colours.extend(mesh.colours.get(v as usize));
                }
                *slot
            }));
        }
        let sag_m = self.placement.as_ref().map_or(0.0, |_| longest_m * longest_m * SAG_PER_M);
        Ok((part, sag_m))
    }
}

impl Cells {
    /// A cube around a box, or a square upright block around ground.
    fn around(bounds: &Aabb, step_m: f64, is_ground: bool) -> Self {
        let middle = bounds.centre() / step_m;
        let size = (bounds.max - bounds.min) / step_m;
        // roundness of the Earth and places between those looked at
        let room = 1.02 * size + DVec3::splat(2.0 + if is_ground { 0.01 * size.max_element() } else { 0.0 });
        let whole = |steps: f64| ((steps as i64 >> MOST_LEVELS).max(0) + 1) << MOST_LEVELS;
        let (subdivision, wanted) = match is_ground {
            true => (Subdivision::Quadtree, DVec3::new(room.x.max(room.y), room.x.max(room.y), room.z)),
            false => (Subdivision::Octree, DVec3::splat(room.max_element())),
        };
        let side = wanted.to_array().map(whole);
        let low = std::array::from_fn(|axis| middle[axis].round() as i64 - side[axis] / 2);
        Self { step_m, subdivision, low, side }
    }
}
