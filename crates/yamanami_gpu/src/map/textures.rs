//! Pictures of the ground around the plane's origin, the finer the nearer.
//!
//! Based on: Losasso, Hoppe, "Geometry clipmaps", 2004 (nested squares, each going over into the next near its border);
//! McCormack, Perry, Farkas, Jouppi, "Feline: fast elliptical lines for anisotropic texture mapping", 1999 (probes along
//! the longer side of a pixel's footprint, which far away is many times the other).

use crate::GpuError;
use glam::{Vec2, Vec4};

/// Most pictures of one map.
pub const MAX_TEXTURES: usize = 16;

/// Share of a square's reach over which it goes over into the next coarser one.
pub(crate) const BLEND_SHARE: f32 = 0.1;

/// Most probes along a pixel's footprint.
const MAX_PROBES: f32 = 8.0;

/// A square picture of the ground, its middle at the plane's origin.
#[derive(Debug, Clone, PartialEq)]
pub struct MapTexture {
    /// Metres from the origin to each side. The outermost samples lie on the sides.
    pub reach_m: f64,
    /// Samples a side, an odd number.
    pub side_px: u32,
    /// sRGB and straight alpha, row by row from the north-west; alpha 0: nothing is known there.
    pub rgba: Vec<u8>,
}

/// Pictures of the ground. A place has the colour of the finest that holds it, mixed from its four nearest samples; where
/// that is transparent, and more and more over its outer tenth, the next coarser one shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MapTextures {
    levels: Vec<MapTexture>,
}

impl MapTextures {
    /// Takes at most [`MAX_TEXTURES`] pictures in any order.
    pub fn new(mut levels: Vec<MapTexture>) -> Result<Self, GpuError> {
        let bytes = |side_px: u32| u64::from(side_px).pow(2).saturating_mul(4);
        for level in &levels {
            let is_odd = level.side_px >= 3 && level.side_px % 2 == 1;
            let has_reach = level.reach_m.is_finite() && level.reach_m > 0.0;
            if !is_odd || !has_reach || bytes(level.side_px) != level.rgba.len() as u64 {
                let (side_px, reach_m, bytes) = (level.side_px, level.reach_m, level.rgba.len());
                return Err(GpuError::MapTexture { side_px, reach_m, bytes });
            }
        }
        if levels.len() > MAX_TEXTURES {
            return Err(GpuError::MapTextureCount { count: levels.len(), limit: MAX_TEXTURES });
        }
        levels.sort_by(|a, b| a.reach_m.total_cmp(&b.reach_m));
        Ok(Self { levels })
    }

    /// The pictures, the one of least reach first.
    pub fn levels(&self) -> &[MapTexture] {
        &self.levels
    }

    /// The mean of [`Self::colour`] over a pixel whose neighbours lie `right` and `down` from it in the plane.
    pub(crate) fn mean_colour(&self, at: Vec2, right: Vec2, down: Vec2) -> Vec4 {
        let holds = |level: &&MapTexture| at.abs().max_element() <= level.reach_m as f32;
        let Some(level) = self.levels.iter().find(holds) else { return Vec4::ZERO };
        let spacing_m = level.reach_m as f32 / ((level.side_px - 1) / 2) as f32;
        let longer = if right.length_squared() > down.length_squared() { right } else { down };
        let probes = (longer.length() / spacing_m).round().clamp(1.0, MAX_PROBES);
        // no farther apart than the samples, so that what is seen edge-on is not mixed with what lies far behind
        let along = longer.clamp_length_max(probes * spacing_m);
        let probe = |i: u32| {
            let place = at + along * ((i as f32 + 0.5) / probes - 0.5);
            self.colour(place.x, place.y)
        };
        (0..probes as u32).map(probe).sum::<Vec4>() / probes
    }

    /// Colour times alpha, and alpha, at a place of the plane, 0 to 1.
    #[inline]
    pub(crate) fn colour(&self, x_m: f32, y_m: f32) -> Vec4 {
        let mut colour = Vec4::ZERO;
        let outermost = self.levels.len().wrapping_sub(1);
        for (i, level) in self.levels.iter().enumerate() {
            let per_reach = 1.0 / level.reach_m as f32;
            let (u, v) = (x_m * per_reach, -y_m * per_reach);
            let room = 1.0 - u.abs().max(v.abs());
            if room >= 0.0 {
                let share = if i == outermost { 1.0 } else { smooth(room * (1.0 / BLEND_SHARE)) };
                colour += level.sample(u, v) * (share * (1.0 - colour.w));
                if colour.w > 0.999 {
                    break;
                }
            }
        }
        colour
    }
}

impl MapTexture {
    /// Mix of the four samples around a place, -1 to 1 eastward and southward, each with its alpha.
    #[inline]
    fn sample(&self, u: f32, v: f32) -> Vec4 {
        let side = self.side_px as usize;
        let half = 0.5 * (side - 1) as f32;
        let (x, y) = (half + u * half, half + v * half);
        let (column, row) = ((x as usize).min(side - 2), (y as usize).min(side - 2));
        let (across, down) = (x - column as f32, y - row as f32);
        let upper = (row * side + column) * 4;
        let lower = upper + side * 4;
        let pair = |at: usize| {
            let texels = self.rgba[at..at + 8].as_chunks::<4>().0;
            let [left, right] = [texels[0], texels[1]].map(texel);
            left + (right - left) * across
        };
        let (top, bottom) = (pair(upper), pair(lower));
        (top + (bottom - top) * down) * (1.0 / 255.0)
    }
}

/// Colour times alpha, and alpha, 0 to 255.
#[inline]
fn texel([r, g, b, a]: [u8; 4]) -> Vec4 {
    let colour = Vec4::new(f32::from(r), f32::from(g), f32::from(b), f32::from(a));
    if a == 255 {
        colour
    } else {
        {
            let share = f32::from(a) * (1.0 / 255.0);
            colour * Vec4::new(share, share, share, 1.0)
        }
    }
}

/// From 0 at 0 to 1 at 1, level at both.
#[inline]
fn smooth(t: f32) -> f32 {
    let t = t.min(1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(reach_m: f64, side_px: u32, colour: [u8; 4]) -> MapTexture {
        MapTexture { reach_m, side_px, rgba: colour.repeat((side_px * side_px) as usize) }
    }

    #[test]
    fn samples_lie_where_they_should() {
        let mut level = plain(100.0, 3, [0, 0, 0, 255]);
        level.rgba[..4].copy_from_slice(&[255, 0, 0, 255]); // north-west
        level.rgba[4 * 5..4 * 6].copy_from_slice(&[0, 255, 0, 255]); // east
        let textures = MapTextures::new(vec![level]).unwrap();
        assert_eq!(textures.colour(-100.0, 100.0), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(textures.colour(100.0, 0.0), Vec4::new(0.0, 1.0, 0.0, 1.0));
        assert_eq!(textures.colour(50.0, 0.0), Vec4::new(0.0, 0.5, 0.0, 1.0));
        assert_eq!(textures.colour(101.0, 0.0), Vec4::ZERO);
    }

    #[test]
    fn fine_goes_over_into_coarse_without_a_step() {
        let textures =
            MapTextures::new(vec![plain(1000.0, 5, [0, 0, 200, 255]), plain(100.0, 5, [200, 0, 0, 255])]).unwrap();
        let red = |x| textures.colour(x, 0.0).x * 255.0;
        assert_eq!([red(0.0), red(89.9), red(100.0), red(500.0)].map(f32::round), [200.0, 200.0, 0.0, 0.0]);
        let mut last = 200.0;
        for i in 0..=200 {
            let now = red(85.0 + 0.1 * i as f32);
            assert!(now <= last + 1e-3 && last - now < 4.0);
            last = now;
        }
        let x = textures.colour(95.0, 3.0);
        assert!((x.w - 1.0).abs() < 1e-6, "both are opaque");
    }

    #[test]
    fn where_the_fine_one_knows_nothing_the_coarse_one_shows() {
        let textures =
            MapTextures::new(vec![plain(100.0, 3, [9, 9, 9, 0]), plain(200.0, 3, [0, 255, 0, 255])]).unwrap();
        assert_eq!(textures.colour(3.0, 3.0), Vec4::new(0.0, 1.0, 0.0, 1.0));
        assert_eq!(MapTextures::default().colour(0.0, 0.0), Vec4::ZERO);
    }

    #[test]
    fn a_long_pixel_takes_the_mean_along_it() {
        // stripes from north to south
        let mut level = plain(100.0, 41, [0, 0, 0, 255]);
        for (i, texel) in level.rgba.chunks_exact_mut(4).enumerate() {
            texel[0] = if (i % 41) % 2 == 0 { 255 } else { 0 };
        }
        let textures = MapTextures::new(vec![level]).unwrap();
        let red = |right: f32, down: f32| {
            textures.mean_colour(Vec2::new(20.0, 20.0), Vec2::new(right, 0.0), Vec2::new(0.0, -down)).x
        };
        assert_eq!([red(1.0, 1.0), red(5.0, 5.0), red(1.0, 40.0)], [1.0, 1.0, 1.0], "short, or along the stripe");
        assert!((red(20.0, 1.0) - 0.5).abs() < 1e-5 && (red(900.0, 1.0) - 0.5).abs() < 1e-5, "across stripes");
        assert_eq!(textures.mean_colour(Vec2::splat(900.0), Vec2::X, Vec2::Y), Vec4::ZERO);
    }

    #[test]
    fn unfit_pictures_are_refused() {
        for level in [
            plain(1.0, 4, [0; 4]),
            plain(1.0, 1, [0; 4]),
            plain(0.0, 3, [0; 4]),
            plain(f64::NAN, 3, [0; 4]),
        ] {
            assert!(MapTextures::new(vec![level]).is_err());
        }
        let error = MapTextures::new(vec![MapTexture { reach_m: 1.0, side_px: u32::MAX, rgba: vec![1] }]).unwrap_err();
        let expected = "map texture: expected an odd number of samples a side, four bytes each, and a reach above 0 m, \
                        got 4294967295 a side in 1 bytes, reach 1 m";
        assert_eq!(error.to_string(), expected);
        let many = vec![plain(1.0, 3, [0; 4]); MAX_TEXTURES + 1];
        assert!(matches!(MapTextures::new(many), Err(GpuError::MapTextureCount { count: 17, .. })));
    }
}
