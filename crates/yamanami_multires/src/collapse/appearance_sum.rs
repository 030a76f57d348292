//! What a vertex knows of how the appearance changes around it, so that an edge can be weighed by what its collapse would
//! change in colour and texture.
//!
//! On each triangle a value is a linear function of place. Around a vertex it is v + g·(p − vertex), with g the triangle's
//! gradient; the sums over the star, weighted by area, give the squared difference to any value at any place, and the value
//! for which it is least. After: Hoppe, "New Quadric Metric for Simplifying Meshes with Appearance Attributes", 1999, without
//! memory as the planes are.

use super::work::Work;
use glam::DVec3;

/// Values that can be weighed: red, green, blue, u, v, and a normal's x, y, z.
pub(super) const VALUES: usize = 8;

/// How much a unit of each value counts, as a distance in units of the work; 0 for those that do not count.
pub(super) type Scales = [f32; VALUES];

/// Gradients about a vertex, in units that count like distances.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct AppearanceSum {
    area: f32,
    /// Sum of area × gradient ⊗ gradient, over all values: xx, yy, zz, yz, xz, xy.
    form: [f32; 6],
    /// Sum of area × gradient, for each value.
    gradients: [[f32; 3]; VALUES],
}

/// The sum for a vertex that looks the same from all sides.
pub(super) fn appearance_sum(work: &Work, v: u32, scales: &Scales) -> AppearanceSum {
    let mut sum = AppearanceSum::default();
    let at = work.positions[v as usize];
    let own = scaled(work, work.wedge(v), scales);
    for corner in work.star(v) {
        let [_, b, c] = corner.turned(&work.triangles);
        let (b, c) = (work.positions[b as usize] - at, work.positions[c as usize] - at);
        let n = b.cross(c);
        let squared = n.length_squared();
        if squared == 0.0 {
            continue;
        }
        let area = 0.5 * squared.sqrt();
        let [_, wedge_b, wedge_c] = work.appearance.turned_wedges(*corner);
        let (of_b, of_c) = (scaled(work, wedge_b, scales), scaled(work, wedge_c, scales));
        sum.area += area as f32;
        for k in 0..VALUES {
            let (db, dc) = (f64::from(of_b[k] - own[k]), f64::from(of_c[k] - own[k]));
            if db == 0.0 && dc == 0.0 {
                continue;
            }
            let g = (db * c - dc * b).cross(n) / squared;
            let w = area * g;
            let form = [w.x * g.x, w.y * g.y, w.z * g.z, w.y * g.z, w.x * g.z, w.x * g.y];
            sum.form.iter_mut().zip(form).for_each(|(s, v)| *s += v as f32);
            sum.gradients[k].iter_mut().zip(w.to_array()).for_each(|(s, v)| *s += v as f32);
        }
    }
    sum
}

/// The values of a wedge, in units that count like distances.
#[inline]
pub(super) fn scaled(work: &Work, wedge: u32, scales: &Scales) -> [f32; VALUES] {
    let mut values = work.appearance.weighable(wedge);
    for (value, scale) in values.iter_mut().zip(scales) {
        *value *= scale;
    }
    values
}

/// The best values at a place, and the squared difference that they leave, times area. `ends` are the two ends of an edge: what
/// is known there, the values there (scaled), and the place relative to it.
pub(super) fn blend(ends: [(&AppearanceSum, [f32; VALUES], DVec3); 2]) -> ([f32; VALUES], f64) {
    let area: f64 = ends.iter().map(|(s, ..)| f64::from(s.area)).sum();
    let mut left = 0.0;
    for (sum, _, p) in &ends {
        let [xx, yy, zz, yz, xz, xy] = sum.form.map(f64::from);
        left += xx * p.x * p.x + yy * p.y * p.y + zz * p.z * p.z;
        left += 2.0 * (yz * p.y * p.z + xz * p.x * p.z + xy * p.x * p.y);
    }
    let mut best = ends[0].1;
    if area > 0.0 {
        for k in 0..VALUES {
            let along =
                |e: &(&AppearanceSum, [f32; VALUES], DVec3)| DVec3::from(e.0.gradients[k].map(f64::from)).dot(e.2);
            let goal: f64 = ends.iter().map(|e| f64::from(e.0.area) * f64::from(e.1[k]) + along(e)).sum();
            let value = goal / area;
            best[k] = value as f32;
            for e in &ends {
                let step = value - f64::from(e.1[k]);
                left += step * (f64::from(e.0.area) * step - 2.0 * along(e));
            }
        }
    }
    (best, left.max(0.0))
}
