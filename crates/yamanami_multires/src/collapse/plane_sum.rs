//! What a vertex knows of the surface around it: the planes of its triangles, summed; and where an edge should go.
//!
//! All planes of a star pass through its vertex, so the sum of squared distances to them, weighted by area, is a plain
//! quadratic form about the vertex: six numbers. An edge's cost is the sum of its ends' two forms (its own triangles count
//! twice, which measures better than once), its place the least of that among the places that keep the volume.
//!
//! Based on: Lindstrom and Turk, "Fast and Memory Efficient Polygonal Simplification", 1998 (memoryless, volume kept,
//! borders by the area they sweep); Garland and Heckbert 1997. Weighting by area instead of its square is ours.

use glam::DVec3;

/// Share of the trace added to the diagonal: where planes leave a place open, it stays near the middle of the edge.
const FIRMNESS: f64 = 1e-6;

/// A place further from the edge's middle than so many lengths of the edge is noise.
const FARTHEST: f64 = 2.0;

/// Planes about a vertex. Single precision suffices: all is relative to the vertex.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PlaneSum {
    /// Sum of area × normal ⊗ normal: xx, yy, zz, yz, xz, xy.
    form: [f32; 6],
    /// Sum of area × normal.
    area: [f32; 3],
}

/// The same in double precision, while it is summed.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PlaneSummer {
    diagonal: DVec3,
    mixed: DVec3,
    area: DVec3,
}

impl PlaneSummer {
    /// Adds a triangle at the vertex, whose other corners are at `b` and `c` relative to it.
    #[inline]
    pub(super) fn add_triangle(&mut self, b: DVec3, c: DVec3) {
        let n = b.cross(c);
        let length = n.length();
        if length > 0.0 {
            self.add(n * (0.5 / length), n);
            self.area += 0.5 * n;
        }
    }

    /// Adds an edge at the vertex that is to keep its line, as much as a surface that stands on it; `along` is the edge.
    #[inline]
    pub(super) fn add_line(&mut self, along: DVec3, weight: f64) {
        self.diagonal += DVec3::splat(weight * along.length_squared());
        self.add(along * -weight, along);
    }

    #[inline]
    fn add(&mut self, u: DVec3, v: DVec3) {
        self.diagonal += u * v;
        self.mixed += DVec3::new(u.y * v.z, u.x * v.z, u.x * v.y);
    }

    #[inline]
    pub(super) fn finish(&self) -> PlaneSum {
        let (d, m, a) = (self.diagonal, self.mixed, self.area);
        PlaneSum { form: [d.x, d.y, d.z, m.x, m.y, m.z].map(|v| v as f32), area: a.to_array().map(|v| v as f32) }
    }
}

impl PlaneSum {
    #[inline]
    fn form(&self) -> [f64; 6] {
        self.form.map(f64::from)
    }

    /// Area of the star's triangles.
    #[inline]
    pub(super) fn total_area(&self) -> f64 {
        f64::from(self.form[0]) + f64::from(self.form[1]) + f64::from(self.form[2])
    }

    /// The form's value at `p` relative to the vertex.
    #[inline]
    pub(super) fn at(&self, p: DVec3) -> f64 {
        value(&self.form(), p)
    }
}

#[inline]
fn times(f: &[f64; 6], p: DVec3) -> DVec3 {
    DVec3::new(
        f[0] * p.x + f[5] * p.y + f[4] * p.z,
        f[5] * p.x + f[1] * p.y + f[3] * p.z,
        f[4] * p.x + f[3] * p.y + f[2] * p.z,
    )
}

#[inline]
fn value(f: &[f64; 6], p: DVec3) -> f64 {
    f[0] * p.x * p.x
        + f[1] * p.y * p.y
        + f[2] * p.z * p.z
        + 2.0 * (f[3] * p.y * p.z + f[4] * p.x * p.z + f[5] * p.x * p.y)
}

/// Where to put an edge, relative to its first end, and what that costs. `edge` leads from the first end to the second.
#[inline]
pub(super) fn best_place(first: &PlaneSum, second: &PlaneSum, edge: DVec3) -> (DVec3, f64) {
    let (fa, fb) = (first.form(), second.form());
    let half = 0.5 * edge;
    // about the middle m: minimise (x + h)ᵀA(x + h) + (x − h)ᵀB(x − h), with h half the edge
    let mut s: [f64; 6] = std::array::from_fn(|k| fa[k] + fb[k]);
    let right = times(&fb, half) - times(&fa, half);
    let firm = FIRMNESS * (s[0] + s[1] + s[2]) + f64::MIN_POSITIVE;
    for d in &mut s[..3] {
        *d += firm;
    }
    // inverse by cofactors
    let (xx, yy, zz, yz, xz, xy) = (s[0], s[1], s[2], s[3], s[4], s[5]);
    let (cx, cy, cz) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let determinant = xx * cx + xy * cy + xz * cz;
    let mut x = DVec3::ZERO;
    if determinant > 0.0 {
        let inverse = [cx, xx * zz - xz * xz, xx * yy - xy * xy, xy * xz - xx * yz, cz, cy].map(|c| c / determinant);
        x = times(&inverse, right);
        let (ga, gb) = (DVec3::from(first.area.map(f64::from)), DVec3::from(second.area.map(f64::from)));
        let gradient = ga + gb;
        let toward = times(&inverse, gradient);
        let slope = gradient.dot(toward);
        // closed by folding, a star has no side to move to
        if slope > 0.0 && slope.is_finite() && gradient.length_squared() > 1e-6 * (xx + yy + zz) * (xx + yy + zz) {
            x -= toward * ((gradient.dot(x) - (gb - ga).dot(half)) / slope);
        }
    }
    if !(x.length_squared() <= FARTHEST * FARTHEST * edge.length_squared()) {
        x = DVec3::ZERO;
    }
    let cost = value(&fa, x + half) + value(&fb, x - half);
    (x + half, cost.max(0.0))
}
