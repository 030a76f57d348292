//! Where a page's vertices lie, how they are turned and coloured, as small differences from what was placed before.
//!
//! Based on: Touma, Gotsman, "Triangle mesh compression", 1998 (the parallelogram); Meyer, Süßmuth, Sußner, Stamminger,
//! Greiner, "On floating-point normal vectors", 2010 (normals on an octahedron); Ganovelli, Ponchio's corto (normals as
//! differences from those of the triangles).

use super::triangles::{NONE, Placing};
use yamanami_core::ClusterVertex;

/// A vertex as whole numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Packed {
    /// Multiples of the quantum.
    pub(super) place: [i32; 3],
    /// Where the normal meets the unfolded octahedron, each 0 to [`OCT_STEPS`].
    pub(super) normal: [i32; 2],
    pub(super) colour: [i32; 3],
}

/// Steps along a side of the unfolded octahedron: a normal is at most 1.1° off.
const OCT_STEPS: f64 = 254.0;

/// Contexts of the residuals; those of one kind share a distribution.
const COLOUR: u8 = 8;
const NORMAL: u8 = 11;
pub(super) const OTHERS: u8 = 15;
pub(super) const REMOVED: u8 = 16;
const PLACE: u8 = 17;
pub(super) const RANK: u8 = 23;

impl Packed {
    /// A vertex at a place.
    pub(super) fn of(vertex: &ClusterVertex, place: [i32; 3]) -> Self {
        Self { place, normal: to_octahedron(vertex.normal.map(f64::from)), colour: vertex.colour.map(i32::from) }
    }

    /// The vertex it stands for, its place being `position_m`; `None` when it stands for none.
    pub(super) fn vertex(&self, position_m: [f64; 3]) -> Option<ClusterVertex> {
        let [r, g, b] = self.colour.map(u8::try_from);
        let within = self.place.iter().all(|p| p.abs() < 1 << 30)
            && self.normal.iter().all(|&n| (0..=OCT_STEPS as i32).contains(&n));
        within.then_some(())?;
        Some(ClusterVertex { position_m, normal: from_octahedron(self.normal), colour: [r.ok()?, g.ok()?, b.ok()?] })
    }
}

/// Contexts of a page's residuals, vertex by vertex: three of the place, two of the normal, three of the colour.
pub(super) fn contexts(placings: &[Placing], is_flat: &[bool], has_colours: bool, out: &mut Vec<u8>) {
    for placing in placings {
        let first = PLACE + if placing.across == NONE { 3 } else { 0 };
        out.extend([first, first + 1, first + 2]);
    }
    for placing in placings {
        let first = NORMAL + if is_flat[placing.vertex as usize] { 2 } else { 0 };
        out.extend([first, first + 1]);
    }
    if has_colours {
        out.extend(placings.iter().flat_map(|_| [COLOUR, COLOUR + 1, COLOUR + 2]));
    }
}

/// By vertex of the page: whether no triangle of the page's own vertices alone tells how it is turned.
pub(super) fn without_own_triangle(own: usize, triangles: &[[u32; 3]]) -> Vec<bool> {
    let mut without = vec![true; own];
    for triangle in own_triangles(own, triangles) {
        triangle.iter().for_each(|&v| without[v as usize] = false);
    }
    without
}

fn own_triangles(own: usize, triangles: &[[u32; 3]]) -> impl Iterator<Item = &[u32; 3]> {
    triangles.iter().filter(move |t| t.iter().all(|&v| (v as usize) < own))
}

/// What is foretold of a vertex from those placed before it.
#[derive(Debug, Clone, Copy)]
struct Near {
    beside: [u32; 2],
    across: u32,
    /// The vertex placed last, for want of a nearer one.
    last: u32,
}

impl Near {
    /// Every vertex with what is near it.
    fn all(placings: &[Placing]) -> impl Iterator<Item = (usize, Self)> {
        let lasts = std::iter::once(NONE).chain(placings.iter().map(|p| p.vertex));
        placings
            .iter()
            .zip(lasts)
            .map(|(p, last)| (p.vertex as usize, Self { beside: p.beside, across: p.across, last }))
    }

    fn foretell(&self, value: impl Fn(u32) -> i32) -> i32 {
        match self.beside {
            [a, b] if a != NONE && b != NONE => {
                let sum = value(a).wrapping_add(value(b));
                if self.across != NONE { sum.wrapping_sub(value(self.across)) } else { self.middle(value) }
            }
            _ => self.middle(value),
        }
    }

    fn middle(&self, value: impl Fn(u32) -> i32) -> i32 {
        match self.beside {
            [NONE, NONE] if self.last == NONE => 0,
            [NONE, NONE] => value(self.last),
            [a, NONE] | [NONE, a] => value(a),
            [a, b] => ((i64::from(value(a)) + i64::from(value(b))) >> 1) as i32,
        }
    }
}

/// Residuals in the order of [`contexts`].
pub(super) fn residuals(
    vertices: &[Packed],
    placings: &[Placing],
    triangles: &[[u32; 3]],
    is_flat: &[bool],
    has_colours: bool,
    out: &mut Vec<i32>,
) {
    for (v, near) in Near::all(placings) {
        for axis in 0..3 {
            let foretold = near.foretell(|v| vertices[v as usize].place[axis]);
            out.push(vertices[v].place[axis].wrapping_sub(foretold));
        }
    }
    let turned = normals_of_triangles(vertices, triangles);
    for (v, near) in Near::all(placings) {
        for axis in 0..2 {
            let foretold = foretell_normal(&turned, is_flat, vertices, v, near, axis);
            out.push(vertices[v].normal[axis] - foretold);
        }
    }
    if has_colours {
        for (v, near) in Near::all(placings) {
            let [r, g, b] =
                std::array::from_fn(|c| vertices[v].colour[c] - near.middle(|v| vertices[v as usize].colour[c]));
            out.extend([g, r - g, b - g]);
        }
    }
}

/// Undoes [`residuals`].
pub(super) fn restore(
    own: usize,
    placings: &[Placing],
    triangles: &[[u32; 3]],
    is_flat: &[bool],
    has_colours: bool,
    residuals: &[i32],
) -> Vec<Packed> {
    let mut vertices = vec![Packed { colour: [255; 3], ..Packed::default() }; own];
    let mut next = residuals.iter().copied();
    // there are as many residuals as the placings ask for
    let mut next = || next.next().unwrap_or(0);
    for (v, near) in Near::all(placings) {
        for axis in 0..3 {
            let foretold = near.foretell(|v| vertices[v as usize].place[axis]);
            vertices[v].place[axis] = foretold.wrapping_add(next());
        }
    }
    let turned = normals_of_triangles(&vertices, triangles);
    for (v, near) in Near::all(placings) {
        for axis in 0..2 {
            let foretold = foretell_normal(&turned, is_flat, &vertices, v, near, axis);
            vertices[v].normal[axis] = foretold.wrapping_add(next());
        }
    }
    if has_colours {
        for (v, near) in Near::all(placings) {
            let [g, r, b] = [next(), next(), next()];
            for (c, difference) in [r.wrapping_add(g), g, b.wrapping_add(g)].into_iter().enumerate() {
                let foretold = near.middle(|v| vertices[v as usize].colour[c]);
                vertices[v].colour[c] = foretold.wrapping_add(difference);
            }
        }
    }
    vertices
}

fn foretell_normal(
    turned: &[[i32; 2]],
    is_flat: &[bool],
    vertices: &[Packed],
    v: usize,
    near: Near,
    axis: usize,
) -> i32 {
    if is_flat[v] { near.middle(|v| vertices[v as usize].normal[axis]) } else { turned[v][axis] }
}

/// By vertex: the normal of the triangles around it, as far as they are of the page's own vertices alone.
fn normals_of_triangles(vertices: &[Packed], triangles: &[[u32; 3]]) -> Vec<[i32; 2]> {
    let mut sums = vec![[0f64; 3]; vertices.len()];
    for triangle in own_triangles(vertices.len(), triangles) {
        let [a, b, c] = triangle.map(|v| vertices[v as usize].place.map(f64::from));
        let (u, w) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let across = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
        for &v in triangle {
            sums[v as usize].iter_mut().zip(across).for_each(|(sum, part)| *sum += part);
        }
    }
    sums.into_iter().map(to_octahedron).collect()
}

/// Where a direction meets the octahedron, unfolded to a square. Only operations that are rounded alike everywhere.
fn to_octahedron([x, y, z]: [f64; 3]) -> [i32; 2] {
    let size = x.abs() + y.abs() + z.abs();
    if !(size > 0.0 && size.is_finite()) {
        return to_octahedron([0.0, 0.0, 1.0]);
    }
    let (u, v) = (x / size, y / size);
    let sign = |a: f64| if a < 0.0 { -1.0 } else { 1.0 };
    let (u, v) = if z < 0.0 { ((1.0 - v.abs()) * sign(u), (1.0 - u.abs()) * sign(v)) } else { (u, v) };
    let [mut u, mut v] = [u, v].map(|a| ((a + 1.0) * (OCT_STEPS / 2.0)).round() as i32);
    // each place on the square's border is there twice: one of them stands for both
    let last = OCT_STEPS as i32;
    if v == 0 || v == last {
        u = u.max(last - u);
    }
    if u == 0 || u == last {
        v = v.max(last - v);
    }
    [u, v]
}

/// Undoes [`to_octahedron`], up to its rounding.
fn from_octahedron(steps: [i32; 2]) -> [f32; 3] {
    let [u, v] = steps.map(|s| f64::from(s) / (OCT_STEPS / 2.0) - 1.0);
    let z = 1.0 - u.abs() - v.abs();
    let sign = |a: f64| if a < 0.0 { -1.0 } else { 1.0 };
    let (x, y) = if z < 0.0 { ((1.0 - v.abs()) * sign(u), (1.0 - u.abs()) * sign(v)) } else { (u, v) };
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|a| (a / length) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_come_back_nearly_and_stay() {
        for i in 0..20_000u32 {
            let (a, b) = (f64::from(i) * 0.618_034, f64::from(i) / 10_000.0 - 1.0);
            let flat = (1.0 - b * b).max(0.0).sqrt();
            let normal = [flat * (a * std::f64::consts::TAU).cos(), flat * (a * std::f64::consts::TAU).sin(), b];
            let steps = to_octahedron(normal);
            let back = from_octahedron(steps).map(f64::from);
            let cos: f64 = normal.iter().zip(back).map(|(a, b)| a * b).sum();
            assert!(cos > 1.1f64.to_radians().cos(), "{normal:?} {back:?}");
            assert_eq!(to_octahedron(back), steps, "{normal:?}");
        }
        assert_eq!(to_octahedron([f64::NAN; 3]), to_octahedron([0.0, 0.0, 2.0]));
    }
}
