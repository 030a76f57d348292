//! Normals and colours for the vertices that a collapse makes: those of the finer patch at the nearest place.

use super::weld::unit_normal;
use glam::DVec3;
use std::cell::OnceCell;

/// A vertex that a collapse made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Made {
    pub(super) position: DVec3,
    pub(super) normal: [f32; 3],
    pub(super) colour: [u8; 3],
}

/// A finer patch with its attributes, ready to be asked.
pub(super) struct Finer<'a> {
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    normals: &'a [[f32; 3]],
    colours: &'a [[u8; 3]],
    stars: OnceCell<Stars>,
}

/// The triangles at each vertex.
struct Stars {
    /// Where those of each vertex begin in `at`.
    start: Vec<u32>,
    at: Vec<u32>,
}

impl<'a> Finer<'a> {
    pub(super) fn new(
        positions: &'a [DVec3],
        triangles: &'a [[u32; 3]],
        normals: &'a [[f32; 3]],
        colours: &'a [[u8; 3]],
    ) -> Self {
        Self { positions, triangles, normals, colours, stars: OnceCell::new() }
    }

    fn stars(&self) -> Stars {
        let (positions, triangles) = (self.positions, self.triangles);
        let mut start = vec![0u32; positions.len() + 1];
        for &v in triangles.as_flattened() {
            start[v as usize + 1] += 1;
        }
        for v in 0..positions.len() {
            start[v + 1] += start[v];
        }
        let mut next = start.clone();
        let mut at = vec![0; 3 * triangles.len()];
        for (t, corners) in triangles.iter().enumerate() {
            for &v in corners {
                at[next[v as usize] as usize] = t as u32;
                next[v as usize] += 1;
            }
        }
        Stars { start, at }
    }

    /// The vertex at a place, with the attributes of the surface near it: those of the triangle nearest to it among the ones
    /// at the nearest vertex.
    pub(super) fn vertex_at(&self, position: DVec3) -> Made {
        let mut nearest = (f64::INFINITY, 0);
        for (v, p) in self.positions.iter().enumerate() {
            let off = (*p - position).length_squared();
            if off < nearest.0 {
                nearest = (off, v);
            }
        }
        let mut best = (f64::INFINITY, [0; 3], [0.0; 3]);
        let Stars { start, at } = self.stars.get_or_init(|| self.stars());
        for &t in &at[start[nearest.1] as usize..start[nearest.1 + 1] as usize] {
            let corners = self.triangles[t as usize];
            let [a, b, c] = corners.map(|v| self.positions[v as usize]);
            let shares = shares_near([a, b, c], position);
            let off = (a * shares[0] + b * shares[1] + c * shares[2] - position).length_squared();
            if off < best.0 {
                best = (off, corners, shares);
            }
        }
        self.blend(best.1, best.2, position)
    }

    /// The vertex at a place, with the attributes of the surface in one triangle near it.
    pub(super) fn vertex_in(&self, triangle: u32, position: DVec3) -> Made {
        let corners = self.triangles[triangle as usize];
        self.blend(corners, shares_near(corners.map(|v| self.positions[v as usize]), position), position)
    }

    fn blend(&self, corners: [u32; 3], shares: [f64; 3], position: DVec3) -> Made {
        let (mut normal, mut colour) = (DVec3::ZERO, DVec3::ZERO);
        for (v, share) in corners.into_iter().zip(shares) {
            normal += share * DVec3::from_array(self.normals[v as usize].map(f64::from));
            colour += share * DVec3::from_array(self.colours[v as usize].map(f64::from));
        }
        let colour = colour.round().to_array().map(|c| c.clamp(0.0, 255.0) as u8);
        Made { position, normal: unit_normal(normal), colour }
    }
}

/// What share each corner has in the point of a triangle near `p`: where the perpendicular falls outside it, in the point
/// that cutting off negative shares leaves.
fn shares_near([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let (u, v, w) = (b - a, c - a, p - a);
    let (uu, uv, vv) = (u.length_squared(), u.dot(v), v.length_squared());
    let determinant = uu * vv - uv * uv;
    let (wu, wv) = (w.dot(u), w.dot(v));
    if determinant <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let of_b = (vv * wu - uv * wv) / determinant;
    let of_c = (uu * wv - uv * wu) / determinant;
    let shares = [1.0 - of_b - of_c, of_b, of_c].map(|s| s.max(0.0));
    let sum: f64 = shares.iter().sum();
    if sum > 0.0 && sum.is_finite() { shares.map(|s| s / sum) } else { [1.0, 0.0, 0.0] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_colours_lies_their_mean() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let normals = [[0.0, 0.0, 1.0]; 3];
        let colours = [[0, 0, 0], [100, 0, 0], [0, 0, 0]];
        let finer = Finer::new(&positions, &[[0, 1, 2]], &normals, &colours);
        let made = finer.vertex_at(DVec3::new(0.5, 0.0, 0.2));
        assert_eq!((made.colour, made.normal), ([50, 0, 0], [0.0, 0.0, 1.0]));
        assert_eq!(finer.vertex_at(DVec3::new(3.0, -1.0, 0.0)).colour, [100, 0, 0]);
    }
}
