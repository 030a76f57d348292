//! What the pieces are made of, and how sun and rain have coloured it.

use crate::rng::{scramble, unit_from_bits};
use glam::DVec3;

/// What a piece is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Material {
    Wood,
    /// End grain and edges with what is left of the white paint.
    PaleWood,
    Plaster,
    Tile,
    Stone,
    Bronze,
}

impl Material {
    /// The colour itself (sRGB), how far it varies from piece to piece, and how far within a piece.
    fn recipe(self) -> ([f64; 3], f64, f64) {
        match self {
            Self::Wood => ([124.0, 88.0, 66.0], 0.10, 0.16),
            Self::PaleWood => ([168.0, 142.0, 112.0], 0.08, 0.14),
            Self::Plaster => ([226.0, 220.0, 206.0], 0.02, 0.07),
            Self::Tile => ([108.0, 111.0, 116.0], 0.06, 0.22),
            Self::Stone => ([158.0, 152.0, 140.0], 0.06, 0.14),
            Self::Bronze => ([92.0, 112.0, 94.0], 0.05, 0.20),
        }
    }

    /// Metres over which stains and grain change, along x, y and z.
    fn grain_m(self) -> DVec3 {
        match self {
            Self::Wood | Self::PaleWood => DVec3::new(0.02, 0.02, 0.011),
            Self::Tile => DVec3::splat(0.03),
            _ => DVec3::splat(0.05),
        }
    }

    /// The colour of a place on a piece.
    pub(super) fn colour(self, p: DVec3, piece: u64) -> [u8; 4] {
        let (base, between, within) = self.recipe();
        let own = between * (2.0 * unit_from_bits(scramble(piece)) - 1.0);
        let stain =
            within * (0.65 * smooth_noise(p / self.grain_m()) + 0.35 * smooth_noise(p / (0.3 * self.grain_m())));
        let light = 1.0 + own + stain;
        // stains of lichen and damp are greener than what they lie on
        let [r, g, b] = base;
        let [r, g, b] = [r * (light + 0.25 * stain), g * light, b * (light - 0.15 * stain)];
        [r as u8, g as u8, b as u8, 255]
    }
}

/// Noise from -1 to 1 that changes over a unit of length.
pub(super) fn smooth_noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let t = p - cell;
    let t = t * t * (3.0 - 2.0 * t);
    let [x, y, z] = cell.to_array().map(|c| c as i64 as u64);
    let corner = |dx: u64, dy: u64, dz: u64| {
        let key = x.wrapping_add(dx).wrapping_mul(0x8DA6_B343)
            ^ y.wrapping_add(dy).wrapping_mul(0xD816_3841_0000)
            ^ z.wrapping_add(dz).wrapping_mul(0xCB1A_B31F_0000_0000);
        unit_from_bits(scramble(key))
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let along_x = |dy: u64, dz: u64| mix(corner(0, dy, dz), corner(1, dy, dz), t.x);
    let along_y = |dz: u64| mix(along_x(0, dz), along_x(1, dz), t.y);
    2.0 * mix(along_y(0), along_y(1), t.z) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_and_colours_keep_their_character() {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for i in 0..2000 {
            let p = DVec3::new(0.037, -0.011, 0.023) * f64::from(i);
            let (here, near) = (smooth_noise(p), smooth_noise(p + 1e-4));
            assert!((here - near).abs() < 1e-3, "{p}");
            range = [range[0].min(here), range[1].max(here)];
            let [r, g, b, a] = Material::Plaster.colour(p, i as u64);
            assert!(r.min(g).min(b) > 160 && a == 255);
            let [r, _, b, _] = Material::Wood.colour(p, i as u64);
            assert!(r > b);
        }
        assert!(range[0] < -0.5 && range[1] > 0.5, "{range:?}");
    }
}
