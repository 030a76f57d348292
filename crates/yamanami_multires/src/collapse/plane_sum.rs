//! What a vertex knows of the surface around it: the planes of its triangles, summed; and where an edge should go.
//!
//! All planes of a star pass through its vertex, so the sum of squared distances to them, weighted by area, is a plain
//! quadratic form about the vertex: six numbers. An edge's cost is the sum of its ends' two forms (its own triangles count
//! twice, which measures better than once), its place the least of that among the places that keep the volume (in which they
//! count twice too, so it is kept but for a little).
//!
//! Based on: Lindstrom and Turk, "Fast and Memory Efficient Polygonal Simplification", 1998 (memoryless, volume kept,
//! borders by the area they sweep); Garland and Heckbert 1997. Weighting by area instead of its square is ours.

use super::lanes::Lanes;
use glam::{DVec3, Vec3};

/// Share of the trace added to the diagonal: where planes leave a place open, it stays near the middle of the edge.
const FIRMNESS: f64 = 1e-6;

/// A place further from the edge's middle than so many lengths of the edge is noise.
const FARTHEST: f64 = 2.0;

/// Triangles summed side by side.
pub(super) const ABREAST: usize = 8;

/// Edges weighed side by side.
pub(super) const EDGES_ABREAST: usize = 4;

/// Planes about a vertex. Single precision suffices: all is relative to the vertex.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct PlaneSum {
    /// Sum of area × normal ⊗ normal: xx, yy, zz, yz, xz, xy.
    form: [f32; 6],
    /// Sum of area × normal.
    area: [f32; 3],
}

impl PlaneSum {
    /// Adds the planes of triangles at the vertex, each by its two other corners relative to it: x, y, z of one, then of the
    /// other. Triangles without area add nothing.
    #[inline]
    pub(super) fn add_triangles(&mut self, corners: &[[f32; ABREAST]; 6]) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2, as just asked.
            return unsafe { self.add_abreast_avx2(corners) };
        }
        self.add_abreast_body(corners);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn add_abreast_avx2(&mut self, corners: &[[f32; ABREAST]; 6]) {
        self.add_abreast_body(corners);
    }

    #[inline(always)]
    fn add_abreast_body(&mut self, corners: &[[f32; ABREAST]; 6]) {
        let [bx, by, bz, cx, cy, cz] = corners.map(Lanes);
        let n = [by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx];
        let squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        let half = Lanes(squared.0.map(|s| if s > 0.0 { 0.5 / s.sqrt() } else { 0.0 }));
        let w = n.map(|v| v * half);
        let form = [w[0] * n[0], w[1] * n[1], w[2] * n[2], w[1] * n[2], w[0] * n[2], w[0] * n[1]];
        for (sum, lanes) in self.form.iter_mut().zip(form) {
            *sum += lanes.sum();
        }
        for (sum, lanes) in self.area.iter_mut().zip(n) {
            *sum += 0.5 * lanes.sum();
        }
    }

    /// Adds an edge at the vertex that is to keep its line, as much as a surface that stands on it; `along` is the edge.
    pub(super) fn add_line(&mut self, along: Vec3, weight: f32) {
        let l = along.length_squared();
        let (x, y, z) = (along.x, along.y, along.z);
        let form = [l - x * x, l - y * y, l - z * z, -y * z, -x * z, -x * y];
        for (sum, v) in self.form.iter_mut().zip(form) {
            *sum += weight * v;
        }
    }

    /// Adds the squared distance to the vertex itself, with this share of the planes' weight.
    pub(super) fn add_point(&mut self, share: f32) {
        let weight = share * (self.form[0] + self.form[1] + self.form[2]);
        for diagonal in &mut self.form[..3] {
            *diagonal += weight;
        }
    }

    /// How far the star's triangles face the same way: 1 for a flat one, 0 for one that is folded shut.
    #[inline]
    pub(super) fn evenness(&self) -> f32 {
        let [x, y, z] = self.area;
        let area = self.form[0] + self.form[1] + self.form[2];
        if area > 0.0 { (x * x + y * y + z * z).sqrt() / area } else { 1.0 }
    }
    /// Area of the star's triangles.
    #[inline]
    pub(super) fn total_area(&self) -> f64 {
        f64::from(self.form[0]) + f64::from(self.form[1]) + f64::from(self.form[2])
    }

    /// The form's value at `p` relative to the vertex.
    #[inline]
    pub(super) fn at(&self, p: DVec3) -> f64 {
        value(&self.form.map(|v| Lanes([f64::from(v)])), p.to_array().map(|v| Lanes([v]))).0[0].max(0.0)
    }
}

/// Where to put an edge, relative to its first end, and what that costs. `edge` leads from the first end to the second.
pub(super) fn best_place(first: &PlaneSum, second: &PlaneSum, edge: DVec3) -> (DVec3, f64) {
    apart(weigh(first, [second], [edge]))[0]
}

/// [`best_place`] for several edges at one vertex, equal to it bit for bit.
#[inline]
pub(super) fn best_places(
    first: &PlaneSum,
    seconds: [&PlaneSum; EDGES_ABREAST],
    edges: [DVec3; EDGES_ABREAST],
) -> [(DVec3, f64); EDGES_ABREAST] {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2, as just asked.
        return apart(unsafe { weigh_avx2(first, seconds, edges) });
    }
    apart(weigh(first, seconds, edges))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn weigh_avx2<const L: usize>(first: &PlaneSum, seconds: [&PlaneSum; L], edges: [DVec3; L]) -> ([F<L>; 3], F<L>) {
    weigh(first, seconds, edges)
}

fn apart<const L: usize>(([x, y, z], cost): ([F<L>; 3], F<L>)) -> [(DVec3, f64); L] {
    std::array::from_fn(|l| (DVec3::new(x.0[l], y.0[l], z.0[l]), cost.0[l]))
}

type F<const L: usize> = Lanes<f64, L>;

#[inline(always)]
fn weigh<const L: usize>(first: &PlaneSum, seconds: [&PlaneSum; L], edges: [DVec3; L]) -> ([F<L>; 3], F<L>) {
    let fa: [F<L>; 6] = first.form.map(|v| Lanes([f64::from(v); L]));
    let ga: [F<L>; 3] = first.area.map(|v| Lanes([f64::from(v); L]));
    let fb: [F<L>; 6] = std::array::from_fn(|k| Lanes(seconds.map(|s| f64::from(s.form[k]))));
    let gb: [F<L>; 3] = std::array::from_fn(|k| Lanes(seconds.map(|s| f64::from(s.area[k]))));
    let half: [F<L>; 3] = std::array::from_fn(|k| Lanes(edges.map(|e| 0.5 * e[k])));
    // about the middle m: minimise (x + h)ᵀA(x + h) + (x − h)ᵀB(x − h), with h half the edge
    let mut s: [F<L>; 6] = std::array::from_fn(|k| fa[k] + fb[k]);
    let (ta, tb) = (times(&fa, half), times(&fb, half));
    let right: [F<L>; 3] = std::array::from_fn(|k| tb[k] - ta[k]);
    let trace = s[0] + s[1] + s[2];
    for d in &mut s[..3] {
        *d = *d + trace * Lanes([FIRMNESS; L]);
    }
    // inverse by cofactors
    let [xx, yy, zz, yz, xz, xy] = s;
    let (cx, cy, cz) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let determinant = xx * cx + xy * cy + xz * cz;
    let over = Lanes(determinant.0.map(|d| if d > 0.0 { 1.0 / d } else { 0.0 }));
    let inverse = [cx, xx * zz - xz * xz, xx * yy - xy * xy, xy * xz - xx * yz, cz, cy].map(|c| c * over);
    let x = times(&inverse, right);
    let gradient: [F<L>; 3] = std::array::from_fn(|k| ga[k] + gb[k]);
    let difference: [F<L>; 3] = std::array::from_fn(|k| gb[k] - ga[k]);
    let toward = times(&inverse, gradient);
    let slope = dot(gradient, toward);
    let excess = dot(gradient, x) - dot(difference, half);
    let (size, least) = (dot(gradient, gradient), trace * trace * Lanes([1e-6; L]));
    let step = Lanes(std::array::from_fn(|l| {
        // closed by folding, a star has no side to move to
        if slope.0[l] > 0.0 && size.0[l] > least.0[l] { excess.0[l] / slope.0[l] } else { 0.0 }
    }));
    let x: [F<L>; 3] = std::array::from_fn(|k| x[k] - toward[k] * step);
    let (far, farthest) = (dot(x, x), dot(half, half) * Lanes([4.0 * FARTHEST * FARTHEST; L]));
    let x: [F<L>; 3] = x.map(|v| Lanes(std::array::from_fn(|l| if far.0[l] <= farthest.0[l] { v.0[l] } else { 0.0 })));
    let plus: [F<L>; 3] = std::array::from_fn(|k| x[k] + half[k]);
    let minus: [F<L>; 3] = std::array::from_fn(|k| x[k] - half[k]);
    let cost = value(&fa, plus) + value(&fb, minus);
    (plus, Lanes(cost.0.map(|c| c.max(0.0))))
}

#[inline(always)]
fn dot<const L: usize>(a: [F<L>; 3], b: [F<L>; 3]) -> F<L> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn times<const L: usize>(f: &[F<L>; 6], p: [F<L>; 3]) -> [F<L>; 3] {
    [dot([f[0], f[5], f[4]], p), dot([f[5], f[1], f[3]], p), dot([f[4], f[3], f[2]], p)]
}

#[inline(always)]
fn value<const L: usize>(f: &[F<L>; 6], p: [F<L>; 3]) -> F<L> {
    dot(times(f, p), p)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum_of(triangles: &[[Vec3; 2]]) -> PlaneSum {
        let mut corners = [[0.0; ABREAST]; 6];
        for (k, [b, c]) in triangles.iter().enumerate() {
            for (lane, v) in corners.iter_mut().zip([b.x, b.y, b.z, c.x, c.y, c.z]) {
                lane[k] = v;
            }
        }
        let mut sum = PlaneSum::default();
        sum.add_triangles(&corners);
        sum
    }

    fn sums() -> Vec<PlaneSum> {
        (1..6)
            .map(|seed| {
                let at = |k: u32| {
                    let angle = f64::from(k) * 1.1;
                    Vec3::new(angle.cos() as f32, angle.sin() as f32, 0.1 * (f64::from(k * seed) * 2.7).sin() as f32)
                };
                sum_of(&std::array::from_fn::<_, 6, _>(|k| [at(k as u32), at((k as u32 + 1) % 6)]))
            })
            .collect()
    }

    #[test]
    fn edges_abreast_cost_what_they_cost_alone() {
        let s = sums();
        let edges = [DVec3::X, DVec3::new(0.3, 0.8, 0.1), DVec3::new(0.0, -1.0, 0.2), DVec3::ZERO];
        let together = best_places(&s[0], [&s[1], &s[2], &s[3], &s[4]], edges);
        for k in 0..EDGES_ABREAST {
            assert_eq!(together[k], best_place(&s[0], &s[k + 1], edges[k]));
        }
    }

    #[test]
    fn a_flat_edge_costs_nothing_and_stays_in_its_plane() {
        let flat = sum_of(&[[Vec3::X, Vec3::Y], [Vec3::Y, -Vec3::X], [-Vec3::X, Vec3::X - Vec3::Y]]);
        let (place, cost) = best_place(&flat, &flat, DVec3::X);
        assert!(place.z == 0.0 && cost < 1e-12, "{place} {cost}");
        assert_eq!(flat.total_area(), 1.5);
        assert_eq!(flat.at(DVec3::Z), 1.5, "three halves a square unit away");
    }
}
