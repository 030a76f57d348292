//! The colours of the ground: hypsometric tints under a light from several sides, the sea with a pale shore.
//!
//! Based on: Imhof, "Cartographic relief presentation", 1965 (tints, cool shadows, contrast that grows with height,
//! aerial perspective); Mark, "A multidirectional, oblique-weighted, shaded-relief image", 1992 (lights weighted by
//! aspect).

use glam::{DVec2, Vec3};
use image::RgbaImage;
use rayon::prelude::*;
use yamanami_core::{FieldLevel, NestedField};

/// A colour (sRGB) from a height on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TintStop {
    /// Height above sea, metres.
    pub height_m: f32,
    /// The colour there.
    pub colour: [u8; 3],
}

/// How the ground is coloured.
#[derive(Debug, Clone, PartialEq)]
pub struct ReliefStyle {
    /// Colours by height, growing; between them they are mixed.
    pub tints: Vec<TintStop>,
    /// Where the main light stands, radians clockwise from north.
    pub sun_azimuth_rad: f32,
    /// How high it stands, radians.
    pub sun_altitude_rad: f32,
    /// Whether lights from other sides help where the main one only grazes.
    pub is_multi_directional: bool,
    /// Factor on slopes before they are lit.
    pub steepen: f32,
    /// Strength of light and shadow, 0 to 1.
    pub strength: f32,
    /// Colour of open water.
    pub water: [u8; 3],
    /// Colour of water at the shore.
    pub shore: [u8; 3],
    /// Ground up to this height is water, metres; `None` draws no water.
    pub sea_level_m: Option<f32>,
    /// Colour that far ground fades into.
    pub haze: [u8; 3],
    /// Distance at which ground has faded by two thirds, metres; infinite for clear air.
    pub haze_m: f64,
}

/// Tints for heights from the sea to Mt Fuji.
const TINTS: [(f32, [u8; 3]); 9] = [
    (0.0, [161, 192, 150]),
    (150.0, [178, 204, 158]),
    (450.0, [205, 216, 170]),
    (900.0, [228, 223, 182]),
    (1400.0, [226, 206, 163]),
    (2000.0, [207, 180, 143]),
    (2600.0, [183, 163, 142]),
    (3100.0, [205, 199, 194]),
    (3700.0, [250, 250, 250]),
];

impl Default for ReliefStyle {
    fn default() -> Self {
        Self {
            tints: TINTS.map(|(height_m, colour)| TintStop { height_m, colour }).to_vec(),
            sun_azimuth_rad: 315f32.to_radians(),
            sun_altitude_rad: 45f32.to_radians(),
            is_multi_directional: true,
            steepen: 2.0,
            strength: 1.0,
            water: [150, 186, 208],
            shore: [205, 224, 232],
            sea_level_m: Some(0.4),
            haze: [213, 224, 233],
            haze_m: f64::INFINITY,
        }
    }
}

impl ReliefStyle {
    /// The same colours for ground whose highest place is another.
    pub fn stretched_to(mut self, top_m: f32) -> Self {
        let last = self.tints.last().map_or(1.0, |stop| stop.height_m);
        for stop in &mut self.tints {
            stop.height_m *= (top_m / last).max(1e-3);
        }
        self
    }

    /// Colour by height alone.
    pub fn tint(&self, height_m: f32) -> [u8; 3] {
        (self.tint_of(height_m) * 255.0).to_array().map(|v| v.round() as u8)
    }

    fn tint_of(&self, height_m: f32) -> Vec3 {
        let above = self.tints.partition_point(|stop| stop.height_m <= height_m);
        match (above.checked_sub(1).map(|i| self.tints[i]), self.tints.get(above)) {
            (Some(low), Some(high)) => {
                let share = (height_m - low.height_m) / (high.height_m - low.height_m);
                unit(low.colour).lerp(unit(high.colour), share)
            }
            (Some(only), None) => unit(only.colour),
            (None, Some(first)) => unit(first.colour),
            (None, None) => Vec3::ONE,
        }
    }
}

/// Colours of the ground in a square around the plane's origin, north up, a pixel a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundPicture {
    /// Metres from the centre to the middle of the outermost pixels.
    pub reach_m: f64,
    /// `2·half + 1` pixels a side; transparent where there are neither data nor water.
    pub rgba: RgbaImage,
}

/// Lights besides the main one: azimuth from it in radians.
const SIDE_LIGHTS: [f32; 3] = [-1.57, -0.79, 0.79];
/// What the main light counts; another counts up to 1, where it comes from across the slope.
const MAIN_WEIGHT: f32 = 2.2;
/// What a slope towards the main light gains of white, and what a slope away loses to the shadow's colour.
const SUNLIT: Vec3 = Vec3::new(1.0, 0.985, 0.93);
const SHADOW: Vec3 = Vec3::new(0.30, 0.34, 0.50);
/// Water is as pale as at the shore up to a few samples from it.
const SHORE_SAMPLES: f32 = 7.0;

/// Paints all grids of a field, seen from `centre` of the plane (for the haze).
pub fn paint(field: &NestedField, style: &ReliefStyle, centre: DVec2) -> Vec<GroundPicture> {
    field.levels().iter().map(|level| paint_level(level, style, centre)).collect()
}

fn paint_level(level: &FieldLevel, style: &ReliefStyle, centre: DVec2) -> GroundPicture {
    let width = level.width();
    let shore = style.sea_level_m.map(|sea_m| steps_from_shore(level, sea_m));
    let lights = lights(style);
    let mut rgba = RgbaImage::new(width as u32, width as u32);
    rgba.as_flat_samples_mut().samples.par_chunks_mut(4 * width).enumerate().for_each(|(row, out)| {
        for (column, out) in out.chunks_exact_mut(4).enumerate() {
            let k = row * width + column;
            let z = level.heights_m()[k];
            let steps = shore.as_ref().map_or(0.0, |steps| steps[k]);
            if !level.known()[k] && steps == 0.0 {
                continue;
            }
            let mut colour = if steps > 0.0 {
                let open = 1.0 - (-(steps - 1.0) / SHORE_SAMPLES).exp();
                unit(style.shore).lerp(unit(style.water), open)
            } else {
                lit(style, &lights, z, slope(level, column, row))
            };
            if style.haze_m.is_finite() {
                let far = (level.plane_from_grid(column, row) - centre).length() / style.haze_m;
                colour = colour.lerp(unit(style.haze), 1.0 - (-far * far).exp() as f32);
            }
            let [r, g, b] = (colour.clamp(Vec3::ZERO, Vec3::ONE) * 255.0).to_array().map(|v| v.round() as u8);
            out.copy_from_slice(&[r, g, b, 255]);
        }
    });
    GroundPicture { reach_m: level.reach_m(), rgba }
}

/// Rise per metre to the east and to the north (Horn's weights), at the grid's border from one side.
fn slope(level: &FieldLevel, column: usize, row: usize) -> [f32; 2] {
    let width = level.width();
    let (west, east) = (column.saturating_sub(1), (column + 1).min(width - 1));
    let (north, south) = (row.saturating_sub(1), (row + 1).min(width - 1));
    let z = |c: usize, r: usize| level.heights_m()[r * width + c];
    let at_column = |c| z(c, north) + 2.0 * z(c, row) + z(c, south);
    let at_row = |r| z(west, r) + 2.0 * z(column, r) + z(east, r);
    let spacing_m = level.spacing_m() as f32;
    [
        (at_column(east) - at_column(west)) / (4.0 * spacing_m * (east - west) as f32),
        (at_row(north) - at_row(south)) / (4.0 * spacing_m * (south - north) as f32),
    ]
}

/// Directions to the lights, the main one first.
fn lights(style: &ReliefStyle) -> Vec<Vec3> {
    let (sin_alt, cos_alt) = style.sun_altitude_rad.sin_cos();
    let turns = std::iter::once(0.0).chain(SIDE_LIGHTS.into_iter().filter(|_| style.is_multi_directional));
    turns
        .map(|turn| {
            let (sin, cos) = (style.sun_azimuth_rad + turn).sin_cos();
            Vec3::new(sin * cos_alt, cos * cos_alt, sin_alt)
        })
        .collect()
}

/// Colour of a slope at a height.
fn lit(style: &ReliefStyle, lights: &[Vec3], height_m: f32, slope: [f32; 2]) -> Vec3 {
    let normal = Vec3::new(-style.steepen * slope[0], -style.steepen * slope[1], 1.0).normalize();
    // each light counts the more the more it comes from across the slope; the main one always counts
    let downhill = normal.truncate().normalize_or_zero();
    let (mut light, mut weights) = (0.0, 0.0);
    for (i, to_light) in lights.iter().enumerate() {
        let across = to_light.truncate().normalize_or_zero().perp_dot(downhill);
        let weight = if i == 0 { MAIN_WEIGHT } else { across * across };
        light += weight * normal.dot(*to_light).max(0.0) / to_light.z.max(0.05);
        weights += weight;
    }
    let light = light / weights - 1.0;
    // contrast grows with height, as far ranges stand out of the haze of the valleys
    let top_m = style.tints.last().map_or(1.0, |stop| stop.height_m).max(1.0);
    let strength = style.strength * (0.72 + 0.28 * (height_m / top_m).clamp(0.0, 1.0));
    let tint = style.tint_of(height_m);
    if light < 0.0 {
        let dark = 1.0 - (strength * 1.35 * light).exp();
        tint.lerp(tint * SHADOW * 1.5, dark)
    } else {
        tint.lerp(SUNLIT, 1.0 - (-strength * 0.9 * light).exp())
    }
}

/// Steps from the nearest land of every water sample, 0 on land. Water is what lies no higher than the sea and hangs
/// together over more than a pond's worth of samples, or has no data beside such water.
fn steps_from_shore(level: &FieldLevel, sea_m: f32) -> Vec<f32> {
    let width = level.width();
    let far = f32::MAX;
    let mut steps: Vec<f32> = level.heights_m().iter().map(|&z| if z <= sea_m { far } else { 0.0 }).collect();
    // two passes of a chamfer: right to a few per cent
    let diagonal = std::f32::consts::SQRT_2;
    for pass in 0..2 {
        let order: Box<dyn Iterator<Item = usize>> =
            if pass == 0 { Box::new(0..width * width) } else { Box::new((0..width * width).rev()) };
        for k in order {
            let (column, row) = ((k % width) as i64, (k / width) as i64);
            let side = if pass == 0 { -1 } else { 1 };
            let mut least = steps[k];
            for (dx, dy, step) in [(side, 0, 1.0), (0, side, 1.0), (side, side, diagonal), (-side, side, diagonal)] {
                let (c, r) = (column + dx, row + dy);
                if (0..width as i64).contains(&c) && (0..width as i64).contains(&r) {
                    least = least.min(steps[r as usize * width + c as usize] + step);
                }
            }
            steps[k] = least;
        }
    }
    steps
}

fn unit(colour: [u8; 3]) -> Vec3 {
    Vec3::from_array(colour.map(|v| f32::from(v) / 255.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(height: impl Fn(DVec2) -> f64) -> NestedField {
        let empty = FieldLevel::new(100.0, 20, vec![0.0; 41 * 41]);
        let heights = (0..41 * 41).map(|k| height(empty.plane_from_grid(k % 41, k / 41)) as f32).collect();
        NestedField::new(vec![FieldLevel::new(100.0, 20, heights)])
    }

    fn brightness(picture: &GroundPicture, x: u32, y: u32) -> u32 {
        picture.rgba.get_pixel(x, y).0[..3].iter().map(|&v| u32::from(v)).sum()
    }

    #[test]
    fn slopes_to_the_light_are_bright_and_slopes_away_are_dark() {
        // a cone: its north-west side faces the light
        let cone = field(|p| 1500.0 - 0.5 * p.length());
        let [picture] = &paint(&cone, &ReliefStyle::default(), DVec2::ZERO)[..] else { panic!() };
        let (lit, dark) = (brightness(picture, 10, 10), brightness(picture, 30, 30));
        assert!(lit > dark + 100, "{lit} against {dark}");
        let flat = field(|_| 1500.0);
        let [picture] = &paint(&flat, &ReliefStyle::default(), DVec2::ZERO)[..] else { panic!() };
        let tint = ReliefStyle::default().tint(1500.0);
        let pixel = picture.rgba.get_pixel(20, 20).0;
        assert!((0..3).all(|i| pixel[i].abs_diff(tint[i]) <= 1), "level ground has its tint: {pixel:?} {tint:?}");
    }

    #[test]
    fn the_sea_is_pale_at_the_shore_and_no_data_is_transparent_without_a_sea() {
        let coast = field(|p| if p.x < 0.0 { 50.0 } else { f64::NAN });
        let style = ReliefStyle::default();
        let [picture] = &paint(&coast, &style, DVec2::ZERO)[..] else { panic!() };
        assert!(brightness(picture, 20, 20) > brightness(picture, 40, 20));
        assert_eq!(picture.rgba.get_pixel(40, 20).0[3], 255);
        let [dry] = &paint(&coast, &ReliefStyle { sea_level_m: None, ..style }, DVec2::ZERO)[..] else { panic!() };
        assert_eq!((dry.rgba.get_pixel(40, 20).0[3], dry.rgba.get_pixel(5, 20).0[3]), (0, 255));
    }

    #[test]
    fn tints_are_met_at_their_heights_and_stretched() {
        let style = ReliefStyle::default();
        assert_eq!(style.tint(450.0), [205, 216, 170]);
        assert_eq!(style.tint(-5.0), style.tint(0.0));
        assert_eq!(style.clone().stretched_to(370.0).tint(45.0), style.tint(450.0));
    }
}
