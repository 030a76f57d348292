//! Even triangles over parametric forms: a cube's surface, a torus and a sheet of columns, each counted before it is made.

use glam::DVec3;

/// What a part is before it is bent into shape.
pub(super) enum Form {
    /// The surface of the unit cube, so long along each axis once placed, with at least so many cells along each.
    Cube { size_m: [f64; 3], least: [usize; 3] },
    /// A torus: the way round and the way round the tube, both in turns.
    Torus { round_m: f64, tube_m: f64 },
    /// Columns side by side, each of its own length: see [`Sheet`].
    Sheet(Sheet),
}

/// A surface with a border, made of columns across `u` = 0…1. A column runs up along an under side (`v` = -1…0), over an
/// edge (0…1) and along a top side (1…2), and says how long each is. Cells are counted from the edge, so that those of
/// neighbours stand side by side although columns end where they like.
pub(super) struct Sheet {
    pub(super) across_m: f64,
    pub(super) column_m: Box<dyn Fn(f64) -> [f64; 3] + Send + Sync>,
}

/// Vertices and triangles of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) vertices: usize,
    pub(super) triangles: usize,
}

/// How many cells of `step_m` a length takes.
fn cells(length_m: f64, step_m: f64) -> usize {
    (length_m / step_m).round().max(1.0) as usize
}

/// Cells of one column: under side, edge, top side.
type Column = [usize; 3];

impl Sheet {
    fn columns(&self, step_m: f64) -> impl Iterator<Item = (f64, Column)> {
        let across = cells(self.across_m, step_m).max(2);
        (0..=across).map(move |i| {
            let u = i as f64 / across as f64;
            let [under, _, top] = (self.column_m)(u);
            // one count for all edges: they hardly differ, and what differs stands at the ends
            let edge = (self.column_m)(0.5)[1];
            (u, [cells(under, step_m), cells(edge, step_m), cells(top, step_m)])
        })
    }

    /// Where a column's vertices lie along it, from the under side's end.
    fn stations(&self, u: f64, [under, edge, top]: Column, step_m: f64) -> impl Iterator<Item = f64> {
        let [under_m, _, top_m] = (self.column_m)(u);
        // cells are counted from the edge; the last one takes what is left
        let along = move |k: usize, n: usize, length_m: f64| {
            if k >= n { 1.0 } else { k as f64 * step_m / length_m }
        };
        let below = (0..under).map(move |k| -along(under - k, under, under_m));
        let over = (0..edge).map(move |k| k as f64 / edge as f64);
        below.chain(over).chain((0..=top).map(move |k| 1.0 + along(k, top, top_m)))
    }
}

impl Form {
    fn cube_cells(size_m: [f64; 3], least: [usize; 3], step_m: f64) -> [usize; 3] {
        std::array::from_fn(|i| cells(size_m[i], step_m).max(least[i]))
    }

    fn torus_cells(round_m: f64, tube_m: f64, step_m: f64) -> [usize; 2] {
        [cells(round_m, step_m).max(6), cells(tube_m, step_m).max(3)]
    }

    pub(super) fn counts(&self, step_m: f64) -> Counts {
        match self {
            Self::Cube { size_m, least } => {
                let [x, y, z] = Self::cube_cells(*size_m, *least, step_m);
                let quads = 2 * (x * y + y * z + x * z);
                Counts { vertices: quads + 2, triangles: 2 * quads }
            }
            Self::Torus { round_m, tube_m } => {
                let [u, v] = Self::torus_cells(*round_m, *tube_m, step_m);
                Counts { vertices: u * v, triangles: 2 * u * v }
            }
            Self::Sheet(sheet) => {
                let mut counts = Counts { vertices: 0, triangles: 0 };
                let mut last: Option<Column> = None;
                for (_, column) in sheet.columns(step_m) {
                    counts.vertices += column.iter().sum::<usize>() + 1;
                    if let Some(last) = last {
                        // each cell of each side is one triangle's edge
                        counts.triangles += column.iter().sum::<usize>() + last.iter().sum::<usize>();
                    }
                    last = Some(column);
                }
                counts
            }
        }
    }

    /// Makes a part whose first vertex is number `first`; the slices have the length that [`Form::counts`] says.
    pub(super) fn fill(
        &self,
        step_m: f64,
        place: impl Fn(DVec3) -> DVec3,
        first: u32,
        vertices: &mut [DVec3],
        triangles: &mut [[u32; 3]],
    ) {
        let mut out = Output { first, vertices: vertices.iter_mut(), triangles: triangles.iter_mut() };
        match self {
            Self::Cube { size_m, least } => cube(Self::cube_cells(*size_m, *least, step_m), place, &mut out),
            Self::Torus { round_m, tube_m } => torus(Self::torus_cells(*round_m, *tube_m, step_m), place, &mut out),
            Self::Sheet(sheet) => fill_sheet(sheet, step_m, place, &mut out),
        }
        debug_assert!(out.vertices.len() == 0 && out.triangles.len() == 0, "counted and made agree");
    }
}

struct Output<'a> {
    first: u32,
    vertices: std::slice::IterMut<'a, DVec3>,
    triangles: std::slice::IterMut<'a, [u32; 3]>,
}

impl Output<'_> {
    fn vertex(&mut self, p: DVec3) {
        if let Some(v) = self.vertices.next() {
            *v = p;
        }
    }

    fn triangle(&mut self, corners: [usize; 3]) {
        if let Some(t) = self.triangles.next() {
            *t = corners.map(|c| self.first + c as u32);
        }
    }

    /// A square `a b c d`, counter-clockwise, cut from `a` to `c`, or from `b` to `d`.
    fn square(&mut self, [a, b, c, d]: [usize; 4], from_b: bool) {
        if from_b {
            self.triangle([a, b, d]);
            self.triangle([b, c, d]);
        } else {
            self.triangle([a, b, c]);
            self.triangle([a, c, d]);
        }
    }
}

/// The cube's surface in layers: the full bottom, the rings between, the full top.
fn cube([nx, ny, nz]: [usize; 3], place: impl Fn(DVec3) -> DVec3, out: &mut Output<'_>) {
    let round = 2 * (nx + ny);
    let on_ring = |k: usize| match k % round {
        k if k < nx => [k, 0],
        k if k < nx + ny => [nx, k - nx],
        k if k < 2 * nx + ny => [2 * nx + ny - k, ny],
        k => [0, round - k],
    };
    let in_grid = |[i, j]: [usize; 2]| j * (nx + 1) + i;
    let at = |[i, j]: [usize; 2], l: usize| {
        place(DVec3::new(i as f64 / nx as f64, j as f64 / ny as f64, l as f64 / nz as f64))
    };
    let full = (nx + 1) * (ny + 1);
    for l in 0..=nz {
        if l == 0 || l == nz {
            (0..=ny).for_each(|j| (0..=nx).for_each(|i| out.vertex(at([i, j], l))));
        } else {
            (0..round).for_each(|k| out.vertex(at(on_ring(k), l)));
        }
    }
    let top = full + (nz - 1) * round;
    let number = |k: usize, l: usize| match l {
        0 => in_grid(on_ring(k)),
        l if l == nz => top + in_grid(on_ring(k)),
        l => full + (l - 1) * round + k % round,
    };
    for j in 0..ny {
        for i in 0..nx {
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            // cut every square towards the middle, so that the corner of a rounded face is not cut off
            let from_b = (2 * i + 1 < nx) != (2 * j + 1 < ny);
            let [a, b, c, d] = corners.map(in_grid);
            out.square([top + a, top + b, top + c, top + d], from_b);
            out.square([d, c, b, a], !from_b);
        }
    }
    for l in 0..nz {
        for k in 0..round {
            out.square([number(k, l), number(k + 1, l), number(k + 1, l + 1), number(k, l + 1)], false);
        }
    }
}

fn torus([nu, nv]: [usize; 2], place: impl Fn(DVec3) -> DVec3, out: &mut Output<'_>) {
    for i in 0..nu {
        for j in 0..nv {
            out.vertex(place(DVec3::new(i as f64 / nu as f64, j as f64 / nv as f64, 0.0)));
        }
    }
    let number = |i: usize, j: usize| (i % nu) * nv + j % nv;
    for i in 0..nu {
        for j in 0..nv {
            out.square([number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)], false);
        }
    }
}

fn fill_sheet(sheet: &Sheet, step_m: f64, place: impl Fn(DVec3) -> DVec3, out: &mut Output<'_>) {
    let mut start = 0;
    let mut last: Option<(usize, Column)> = None;
    for (u, column) in sheet.columns(step_m) {
        sheet.stations(u, column, step_m).for_each(|v| out.vertex(place(DVec3::new(u, v, 0.0))));
        if let Some((last_start, last_column)) = last {
            stitch((last_start, last_column), (start, column), out);
        }
        last = Some((start, column));
        start += column.iter().sum::<usize>() + 1;
    }
}

/// Joins two columns: squares as far as both go, then fans around the end of the shorter.
fn stitch((a0, a): (usize, Column), (b0, b): (usize, Column), out: &mut Output<'_>) {
    let (a_zero, b_zero) = (a0 + a[0], b0 + b[0]);
    let under = a[0].min(b[0]);
    (under..a[0]).rev().for_each(|k| out.triangle([a_zero - k - 1, a_zero - k, b_zero - under]));
    (under..b[0]).rev().for_each(|k| out.triangle([a_zero - under, b_zero - k, b_zero - k - 1]));
    let over = a[1] + a[2].min(b[2]);
    for k in 0..under + over {
        let (p, q) = (a_zero - under + k, b_zero - under + k);
        out.square([p, p + 1, q + 1, q], false);
    }
    (over..a[1] + a[2]).for_each(|k| out.triangle([a_zero + k, a_zero + k + 1, b_zero + over]));
    (over..b[1] + b[2]).for_each(|k| out.triangle([a_zero + over, b_zero + k + 1, b_zero + k]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check_conforming;
    use crate::laws::Kind;
    use yamanami_core::TriangleMesh;

    fn made(form: &Form, step_m: f64, place: impl Fn(DVec3) -> DVec3) -> TriangleMesh {
        let counts = form.counts(step_m);
        let mut mesh = TriangleMesh::new(vec![DVec3::NAN; counts.vertices], vec![[u32::MAX; 3]; counts.triangles]);
        form.fill(step_m, place, 0, &mut mesh.positions, &mut mesh.triangles);
        mesh
    }

    fn volume_m3(mesh: &TriangleMesh) -> f64 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn a_cube_is_closed_and_has_its_volume() {
        for size_m in [[1.0, 1.0, 1.0], [5.0, 1.0, 2.0], [1.0, 7.0, 4.0]] {
            let form = Form::Cube { size_m, least: [1; 3] };
            let mesh = made(&form, 1.0, |p| p * DVec3::from_array(size_m));
            check_conforming(&mesh, &TriangleMesh::default(), Kind::Solid).unwrap();
            assert!((volume_m3(&mesh) - size_m.iter().product::<f64>()).abs() < 1e-9);
        }
    }

    #[test]
    fn a_torus_is_closed_and_faces_outward() {
        let mesh = made(&Form::Torus { round_m: 30.0, tube_m: 6.0 }, 1.0, |p| {
            let ([round, tube], r) = ([p.x, p.y].map(|t| t * std::f64::consts::TAU), 5.0);
            let out = r + tube.cos();
            DVec3::new(out * round.cos(), out * round.sin(), tube.sin())
        });
        check_conforming(&mesh, &TriangleMesh::default(), Kind::Solid).unwrap();
        assert!(volume_m3(&mesh) > 0.9 * 2.0 * std::f64::consts::PI.powi(2) * 5.0 * 0.8);
    }

    #[test]
    fn columns_of_any_length_make_a_sheet() {
        let column_m = |u: f64| [1.0 + 9.0 * (u * 3.0).sin().abs(), 2.0, 3.0 + 20.0 * u * (1.0 - u)];
        let form = Form::Sheet(Sheet { across_m: 30.0, column_m: Box::new(column_m) });
        // laid out flat: the under side left of x = 0, the top side right of x = 2
        let flat = |p: DVec3| {
            let [under, _, top] = column_m(p.x);
            let along = if p.y < 0.0 { p.y * under } else { 2.0 * p.y.min(1.0) + (p.y - 1.0).max(0.0) * top };
            DVec3::new(along, 30.0 * p.x, 0.0)
        };
        let mesh = made(&form, 0.7, flat);
        check_conforming(&mesh, &mesh, Kind::Terrain).unwrap();
    }
}
