//! One tile of a terrain.

use super::apron::{RIM, Spot, outside};
use super::border::Side;
use super::clip::{Corner, Place, area, clip, ears};
use super::fill::{fill, open_edges};
use super::measure;
use super::piece::{GRID, Tile, TilePiece};
use super::placement::Placement;
use super::plan::{CutOptions, Plan, ZoomPlan};
use super::sheet::{Plane, Sheet};
use super::table::Table;
use super::walk::{Ground, Item, Lines};
use crate::wavelet::{TerrainData, TerrainSurface};
use yamanami_core::{Lattice, LatticeNode};

/// Cuts any tile out of a terrain, on demand and by itself: what a tile is depends on the terrain and the options alone.
#[derive(Debug)]
pub struct Cutter<'a, D> {
    data: &'a D,
    lattice: &'a Lattice,
    placement: &'a Placement,
    plan: Plan,
}

/// Midpoints, some of each page, that a tile needs and that are not in memory: load their pages and cut again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Absent(pub Vec<LatticeNode>);

/// Memory that cutting can use again.
#[derive(Debug, Default)]
pub struct CutScratch {
    vertices: Table,
    flags: Table,
    items: Vec<Item>,
    absent: Vec<LatticeNode>,
    sheet: Sheet,
    polygon: Vec<Corner>,
}

impl<'a, D: TerrainData> Cutter<'a, D> {
    /// Prepares to cut a terrain that lies in tile space as `placement` says.
    pub fn new(surface: &'a TerrainSurface<D>, placement: &'a Placement, options: &CutOptions) -> Self {
        Self::over(surface.data(), surface.numbers().lattice(), surface.geo().step_m, placement, options)
    }

    /// The same for the parts of a surface: its data, lattice, and metres between samples.
    pub fn over(
        data: &'a D,
        lattice: &'a Lattice,
        step_m: [f64; 2],
        placement: &'a Placement,
        options: &CutOptions,
    ) -> Self {
        let plan = Plan::new(options, lattice.levels(), step_m, placement.spacing());
        Self { data, lattice, placement, plan }
    }

    /// The tiles of a zoom that the terrain's bounds reach into, row by row from the south-west.
    pub fn tiles(&self, zoom: u32) -> impl Iterator<Item = Tile> + use<D> {
        let scale = f64::from(1u32 << zoom);
        let [x, y] = self.placement.bounds().map(|[low, high]| {
            let first = (low * scale).floor().max(0.0) as u32;
            (first, ((high * scale).ceil() as u32).max(first + 1))
        });
        (y.0..y.1).flat_map(move |y| (x.0..x.1).map(move |x| Tile { zoom, x, y }))
    }

    /// From this zoom on, borders are the same lines in all zooms; between coarser ones they may gape by an eighth of the
    /// coarser tile's error.
    pub fn closed_from(&self) -> u32 {
        self.plan.closed
    }

    /// Coarsest and finest zoom.
    pub fn zooms(&self) -> [u32; 2] {
        [self.plan.first, self.plan.last]
    }

    /// Cuts a tile of one of the zooms.
    pub fn cut(&self, tile: Tile, scratch: &mut CutScratch) -> Result<TilePiece, Absent> {
        let CutScratch { vertices, flags, items, absent, sheet, polygon } = scratch;
        vertices.clear();
        flags.clear();
        items.clear();
        absent.clear();
        sheet.clear();
        let ground = Ground::new(self.data, self.lattice, self.placement, &self.plan);
        let limits = self.plan.zoom(tile.zoom);
        let scale = f64::from(1u32 << tile.zoom);
        let sides = Side::all(tile, &self.plan);
        let square = [[sides[0].at, sides[2].at], [sides[1].at, sides[3].at]];
        ground.items(limits, scale, &square, items, absent);
        let mut job = Job { ground: &ground, limits, tile, scale, sides: &sides, vertices, flags, sheet, polygon };
        job.flag(items);
        for item in items.iter() {
            match *item {
                Item::Whole(t, deep) => {
                    let lines = if deep { Lines::None } else { Lines::Scale(scale) };
                    ground.whole(t, limits, lines, absent, &mut |corners, level, error_m| {
                        job.whole(corners, self.plan.sagitta_m[level as usize] as f32 + error_m);
                    });
                }
                Item::Single(corners, level, error_m, false) => {
                    job.whole(corners, self.plan.sagitta_m[level as usize] as f32 + error_m);
                }
                Item::Single(corners, level, error_m, true) => {
                    let corners = corners.map(|c| c.map(i64::from));
                    job.clipped(corners, self.plan.sagitta_m[level as usize] as f32 + error_m, absent);
                }
                Item::Rim(corners, level, error_m) => {
                    job.clipped(corners, self.plan.sagitta_m[level as usize] as f32 + error_m, absent);
                }
            }
        }
        if self.plan.fill_m.is_some() && absent.is_empty() {
            job.fill(absent);
        }
        let error_m =
            if absent.is_empty() { measure::error_m(&ground, &self.plan, tile, job.sheet, absent) } else { 0.0 };
        if !absent.is_empty() {
            absent.sort_unstable();
            absent.dedup();
            return Err(Absent(std::mem::take(absent)));
        }
        let mut piece = TilePiece {
            error_m,
            places: std::mem::take(&mut sheet.places),
            heights_m: std::mem::take(&mut sheet.heights_m),
            triangles: std::mem::take(&mut sheet.triangles),
            quantum_m: limits.border_quantum_m,
            ..TilePiece::default()
        };
        piece.renumber();
        piece.find_sides();
        Ok(piece)
    }
}

/// One tile's work.
struct Job<'a, 'g, D> {
    ground: &'a Ground<'g, D>,
    limits: &'a ZoomPlan,
    tile: Tile,
    scale: f64,
    sides: &'a [Side; 4],
    vertices: &'a mut Table,
    /// By sample: the sides, as bits, that a triangle at it touches.
    flags: &'a mut Table,
    sheet: &'a mut Sheet,
    polygon: &'a mut Vec<Corner>,
}

const LAST: i64 = GRID as i64;

impl<D: TerrainData> Job<'_, '_, D> {
    fn number(&self, [column, row]: [u32; 2]) -> u64 {
        u64::from(row) * u64::from(self.ground.lattice.width()) + u64::from(column)
    }

    fn size(&self) -> [u32; 2] {
        [self.ground.lattice.width(), self.ground.lattice.height()]
    }

    /// A sample, unless a spot lies on the rim.
    fn inside(&self, spot: Spot) -> Option<[u32; 2]> {
        let size = self.size();
        (0..2).all(|k| (0..i64::from(size[k])).contains(&spot[k])).then(|| spot.map(|k| k as u32))
    }

    fn spot_number(&self, spot: Spot) -> u64 {
        self.inside(spot).map_or_else(
            || {
                let [column, row] = spot.map(|k| (k + RIM) as u64);
                1 << 34 | (row * (u64::from(self.size()[0]) + 2 * RIM as u64) + column)
            },
            |sample| self.number(sample),
        )
    }

    fn spot_place(&self, spot: Spot) -> [f64; 2] {
        match self.inside(spot) {
            Some(sample) => self.ground.placement.place(sample),
            None => self.ground.placement.beyond(spot),
        }
    }

    fn spot_height_m(&self, spot: Spot) -> f64 {
        let size = self.size();
        let near = [0, 1].map(|k| spot[k].clamp(0, i64::from(size[k]) - 1));
        let out = (0..2).map(|k| (spot[k] - near[k]).abs()).max().unwrap_or(0);
        match self.ground.plan.fill_m {
            Some(fill_m) if out == RIM => fill_m,
            _ => {
                let z = f64::from(self.ground.data.sample_height_m(near[0] as u32, near[1] as u32));
                z + self.ground.placement.lift_m(near.map(|k| k as f64))
            }
        }
    }

    /// Marks the corners of triangles at sides with a coarser lattice: they are put on its steps in the direction of the
    /// side. So what is parallel to it stays so, and no triangle turns over.
    fn flag(&mut self, items: &[Item]) {
        if self.sides.iter().all(|side| side.stride() == 1) {
            return;
        }
        for item in items {
            let corners = match *item {
                Item::Single(corners, _, _, true) => corners.map(|c| c.map(i64::from)),
                Item::Rim(corners, ..) => corners,
                _ => continue,
            };
            let at = corners.map(|spot| self.spot_place(spot));
            for (k, side) in self.sides.iter().enumerate().filter(|(_, side)| side.stride() > 1) {
                let touches = at.iter().any(|p| p[side.axis] <= side.at) && at.iter().any(|p| p[side.axis] >= side.at);
                if touches {
                    for number in corners.map(|spot| self.spot_number(spot)) {
                        *self.flags.entry(number, || 0) |= 1 << k;
                    }
                }
            }
        }
    }

    fn local(&self, place: [f64; 2]) -> [f64; 2] {
        [(place[0], self.tile.x), (place[1], self.tile.y)]
            .map(|(at, index)| (at * self.scale - f64::from(index)) * f64::from(GRID))
    }

    /// The vertex of a sample in the tile or on its sides.
    fn sample(&mut self, sample: [u32; 2], absent: &mut Vec<LatticeNode>) -> u32 {
        match self.vertices.get(self.number(sample)) {
            Some(vertex) => vertex,
            None => self.spot(sample.map(i64::from), absent),
        }
    }

    /// The vertex of a sample or a spot of the rim.
    fn spot(&mut self, spot: Spot, absent: &mut Vec<LatticeNode>) -> u32 {
        let number = self.spot_number(spot);
        if let Some(vertex) = self.vertices.get(number) {
            return vertex;
        }
        let at = self.spot_place(spot);
        let exact = self.local(at);
        if let Some(k) = (0..4).find(|&k| at[self.sides[k].axis] == self.sides[k].at) {
            let along = at[1 - self.sides[k].axis];
            let vertex = self.step(k, self.sides[k].snap(along), absent);
            return *self.vertices.entry(number, || vertex);
        }
        let flags = if self.flags.is_empty() { 0 } else { self.flags.get(number).unwrap_or(0) };
        let place = [0, 1].map(|axis| {
            // the sides that run along this axis
            let along = |k: usize| Some(&self.sides[k]).filter(|_| flags & 1 << k != 0);
            let [a, b] = if axis == 0 { [along(1), along(3)] } else { [along(0), along(2)] };
            let coarsest = a.into_iter().chain(b).max_by_key(|side| side.stride());
            let step = coarsest.map_or_else(|| exact[axis].round() as i64, |side| side.nearest(at[axis]));
            // what is inside stays strictly so: the vertices on the sides are for both tiles to agree on
            step.clamp(1, LAST - 1) as u16
        });
        let z = self.spot_height_m(spot);
        let quantum_m = self.limits.inner_quantum_m;
        let vertex = self.sheet.push(place, (z / quantum_m).round() * quantum_m, [exact[0], exact[1], z]);
        *self.vertices.entry(number, || vertex)
    }

    /// The vertex at a step of a side.
    fn step(&mut self, side: usize, step: u16, absent: &mut Vec<LatticeNode>) -> u32 {
        let far = if side < 2 { 0 } else { GRID as u16 };
        let place = if self.sides[side].axis == 0 { [far, step] } else { [step, far] };
        let key = 1 << 32 | u64::from(place[0]) << 15 | u64::from(place[1]);
        if let Some(vertex) = self.vertices.get(key) {
            return vertex;
        }
        let at = self.ground.placement.grid(self.sides[side].place(step));
        let z = self.ground.border_height_m(self.tile.zoom, at, absent);
        let quantum_m = self.limits.border_quantum_m;
        // what was put on this step came from no further along the side
        let mut exact = [f64::from(place[0]), f64::from(place[1]), z];
        exact[1 - self.sides[side].axis] += f64::from(self.sides[side].stride()) / 2.0;
        let vertex = self.sheet.push(place, (z / quantum_m).round() * quantum_m, exact);
        *self.vertices.entry(key, || vertex)
    }

    fn plane(&self, corners: [Spot; 3]) -> Plane {
        Plane::through(corners.map(|spot| {
            let [u, v] = self.local(self.spot_place(spot));
            [u, v, self.spot_height_m(spot)]
        }))
    }

    /// A triangle strictly inside the tile.
    fn whole(&mut self, corners: [[u32; 2]; 3], error_m: f32) {
        // no vertex on a side, so nothing more has to be in memory
        let vertices = corners.map(|sample| self.sample(sample, &mut Vec::new()));
        let [a, b, c] = vertices.map(|v| self.sheet.ints(v));
        if area(a, b, c) > 0 {
            let plane = Plane::through(vertices.map(|v| self.sheet.exact[v as usize]));
            self.sheet.add(vertices, &plane, error_m);
        }
    }

    /// A triangle that a side crosses or touches.
    fn clipped(&mut self, corners: [Spot; 3], error_m: f32, absent: &mut Vec<LatticeNode>) {
        let triangle = corners.map(|spot| Place { at: self.spot_place(spot), number: self.spot_number(spot) });
        let mut polygon = std::mem::take(self.polygon);
        clip(&triangle, self.sides, &mut polygon);
        let mut ring: Vec<u32> = Vec::with_capacity(polygon.len());
        for corner in &polygon {
            let vertex = match *corner {
                Corner::Own(k) => self.spot(corners[k], absent),
                Corner::On(side, along) => self.step(side, self.sides[side].snap(along), absent),
                Corner::Tile(a, b) => {
                    let upright = if self.sides[a].axis == 0 { a } else { b };
                    let level = a + b - upright;
                    self.step(upright, if level == 1 { 0 } else { GRID as u16 }, absent)
                }
            };
            ring.push(vertex);
        }
        *self.polygon = polygon;
        ring.dedup();
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        if ring.len() < 3 {
            return;
        }
        let ring = self.with_forced(&ring, absent);
        let places: Vec<[i32; 2]> = ring.iter().map(|&v| self.sheet.ints(v)).collect();
        let is_far = corners.iter().any(|&spot| outside(spot.map(|k| k as f64), self.size()) > 1.0);
        let plane = self.plane(corners);
        let sheet = &mut *self.sheet;
        ears(&places, |t| {
            let corners = t.map(|k| ring[k]);
            if is_far { sheet.add_far(corners) } else { sheet.add(corners, &plane, error_m) }
        });
    }

    /// The ring with the vertices on the sides that must be there for the finer tiles beside it.
    fn with_forced(&mut self, ring: &[u32], absent: &mut Vec<LatticeNode>) -> Vec<u32> {
        let mut out = Vec::with_capacity(ring.len() + 4);
        for (k, &from) in ring.iter().enumerate() {
            out.push(from);
            let [a, b] = [from, ring[(k + 1) % ring.len()]].map(|v| self.sheet.places[v as usize]);
            let on = |side: usize| {
                let (axis, far) = (side % 2, if side < 2 { 0 } else { GRID as u16 });
                a[axis] == far && b[axis] == far
            };
            let Some(side) = (0..4).find(|&side| on(side)) else { continue };
            let (from, to) = (a[1 - side % 2], b[1 - side % 2]);
            let forced = &self.sides[side].forced;
            let between = forced.partition_point(|&s| s <= from.min(to))..forced.partition_point(|&s| s < from.max(to));
            let mut steps = forced[between].to_vec();
            if from > to {
                steps.reverse();
            }
            for step in steps {
                out.push(self.step(side, step, absent));
            }
        }
        out
    }

    /// Fills what lies outside of the terrain and its rim.
    fn fill(&mut self, absent: &mut Vec<LatticeNode>) {
        let covered: i64 = self
            .sheet
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| self.sheet.ints(v));
                area(a, b, c)
            })
            .sum();
        if covered == 2 * i64::from(GRID) * i64::from(GRID) {
            return;
        }
        let size = self.size();
        let grid = |place: [f64; 2]| self.ground.placement.grid(place);
        let scale = self.scale;
        let tile = self.tile;
        let at = move |u: f64, v: f64| {
            [
                (u / f64::from(GRID) + f64::from(tile.x)) / scale,
                (v / f64::from(GRID) + f64::from(tile.y)) / scale,
            ]
        };
        let out = |u: f64, v: f64| {
            let place = grid(at(u, v));
            if place[0].is_nan() || place[1].is_nan() { f64::INFINITY } else { outside(place, size) }
        };
        let last = GRID as u16;
        let corners = [[0, 0], [last, 0], [0, last], [last, last]];
        let beyond = corners.map(|[u, v]| out(u.into(), v.into()) >= RIM as f64);
        let on_side = |a: [u16; 2], b: [u16; 2]| (0..2).any(|k| a[k] == b[k] && (a[k] == 0 || a[k] == last));
        let mut open = Vec::new();
        for [a, b] in open_edges(&self.sheet.triangles) {
            let [p, q] = [a, b].map(|v| self.sheet.places[v as usize]);
            if !on_side(p, q) {
                open.push([a, b]);
            }
        }
        let outer: Vec<bool> = open
            .iter()
            .map(|edge| {
                let [p, q] = edge.map(|v| self.sheet.places[v as usize].map(f64::from));
                out(0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])) > RIM as f64 - 0.5
            })
            .collect();
        if !outer.contains(&true) && !beyond.contains(&true) {
            return;
        }
        let parts = self.ground.plan.fill_parts(self.tile.zoom);
        let between: Vec<u16> = (1..1u32 << parts).map(|k| ((k * GRID) >> parts) as u16).collect();
        // on the sides, what the neighbours have, too
        let mut wanted: Vec<(usize, u16)> = Vec::new();
        for side in 0..4 {
            let forced = self.sides[side].forced.iter();
            let own = if self.tile.zoom < self.ground.plan.closed { &between[..] } else { &[] };
            for &step in forced.chain(own).chain(&[0, last]) {
                let far = if side < 2 { 0.0 } else { f64::from(GRID) };
                let (u, v) = if side % 2 == 0 { (far, f64::from(step)) } else { (f64::from(step), far) };
                if out(u, v) >= RIM as f64 {
                    wanted.push((side, step));
                }
            }
        }
        let fill_m = self.ground.plan.fill_m.unwrap_or(0.0);
        let quantum_m = self.limits.border_quantum_m;
        let height_m = (fill_m / quantum_m).round() * quantum_m;
        let inner: Vec<[u16; 2]> = between
            .iter()
            .flat_map(|&v| between.iter().map(move |&u| [u, v]))
            .filter(|&[u, v]| out(u.into(), v.into()) >= RIM as f64 + 1.0)
            .collect();
        let (mut free, mut seeds) = (Vec::new(), Vec::new());
        for (side, step) in wanted {
            let vertex = self.step(side, step, absent);
            free.push(vertex);
            if step == 0 || step == last {
                seeds.push(vertex);
            }
        }
        for place in inner {
            let [u, v] = place.map(f64::from);
            free.push(self.sheet.push(place, height_m, [u, v, height_m]));
        }
        let mut number = outer.iter();
        let is_outer: Vec<[u32; 2]> = open.iter().filter(|_| number.next() == Some(&true)).copied().collect();
        let filled = fill(&self.sheet.places, &open, |edge| is_outer.contains(&edge), &free, &seeds);
        filled.into_iter().for_each(|corners| self.sheet.add_far(corners));
    }
}
