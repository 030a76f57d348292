//! Colours of surface and sky: the software twin of `shaders/frame.wgsl`, function by function.
//!
//! Relief shading with softer side lights follows: Robert Mark, "A multidirectional, oblique-weighted, shaded-relief image
//! of the Island of Hawaii", 1992; warm light and cool shade follow: Eduard Imhof, "Kartographische Geländedarstellung",
//! 1965.

use crate::frame::{COLOUR_ASPECT, COLOUR_SLOPE, Frame};
use glam::{Vec2, Vec3, Vec4};
use std::f32::consts::FRAC_1_SQRT_2;

/// Light of the sun and of the sky on level ground, linear.
const SUN_LIGHT: Vec3 = Vec3::new(0.74, 0.70, 0.62);
const SKY_LIGHT: Vec3 = Vec3::new(0.20, 0.24, 0.31);
/// Share of light on the underside of the surface.
const UNDERSIDE: f32 = 0.35;
/// Aspect colours are of full strength from 1 / this sine of the slope on.
const ASPECT_STRENGTH: f32 = 6.0;
/// Water a hand deep and deep, linear.
const SHALLOW_WATER: Vec3 = Vec3::new(0.22, 0.52, 0.75);
const DEEP_WATER: Vec3 = Vec3::new(0.008, 0.05, 0.19);

/// Colour of the ramp at `t`.
pub(crate) fn ramp_colour(frame: &Frame, t: f32) -> Vec3 {
    let mut colour = rgb(frame.ramp[0]);
    for i in 1..frame.ramp.len() {
        let (from, to) = (frame.ramp[i - 1][3], frame.ramp[i][3]);
        colour = colour.lerp(rgb(frame.ramp[i]), ((t - from) / (to - from)).clamp(0.0, 1.0));
    }
    colour
}

/// Colour of the direction in which ground with this normal falls: a circle of hues of equal strength, light to the
/// north-west and dark to the south-east as in relief shading, grey where level.
///
/// Hues after: Björn Ottosson, "A perceptual color space for image processing", 2020. Lightness by aspect and strength by
/// slope after: Moellering, Kimerling, "A new digital slope-aspect display process", 1990; Brewer, Marlow, "Color
/// representation of aspect and slope simultaneously", 1993.
pub(crate) fn aspect_colour(normal: Vec3) -> Vec3 {
    let across = normal.truncate();
    let steepness = across.length();
    let towards = if steepness > 1e-6 { across / steepness } else { Vec2::ZERO };
    let share = (steepness * ASPECT_STRENGTH).min(1.0);
    let lightness = 0.72 + share * 0.13 * FRAC_1_SQRT_2 * (towards.y - towards.x);
    // hue 0 is red: north; clockwise over yellow (east) and green (south) to blue (west)
    oklab_to_linear(lightness, share * 0.125 * towards.y, share * 0.125 * towards.x)
}

fn oklab_to_linear(lightness: f32, a: f32, b: f32) -> Vec3 {
    let l = lightness + 0.396_337_78 * a + 0.215_803_76 * b;
    let m = lightness - 0.105_561_346 * a - 0.063_854_17 * b;
    let s = lightness - 0.089_484_18 * a - 1.291_485_5 * b;
    let (l, m, s) = (l * l * l, m * m * m, s * s * s);
    let red = 4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s;
    let green = -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s;
    let blue = -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s;
    Vec3::new(red, green, blue).clamp(Vec3::ZERO, Vec3::ONE)
}

/// `albedo` under the frame's water, if it lies below: `height` is relative to the origin.
pub(crate) fn water_colour(frame: &Frame, albedo: Vec3, height: f32) -> Vec3 {
    let depth = frame.water[0] - height;
    if frame.water[2] == 0.0 || depth <= 0.0 {
        return albedo;
    }
    let clear = (-depth * frame.water[1]).exp();
    albedo.lerp(DEEP_WATER.lerp(SHALLOW_WATER, clear), 0.96 - 0.36 * clear)
}

/// Light that falls on a surface with this normal, linear.
pub(crate) fn light_on(frame: &Frame, normal: Vec3) -> Vec3 {
    let mut lit = 0.0;
    for light in frame.lights.map(Vec4::from_array) {
        lit += light.w * normal.dot(light.truncate()).max(0.0);
    }
    let sun = 1.0 + frame.strength * (lit - 1.0);
    let sky = 1.0 + frame.strength * (0.5 * normal.z - 0.5);
    SUN_LIGHT * sun.max(0.0) + SKY_LIGHT * sky
}

/// Colour of the sky, or of what lies below the horizon, in a unit direction.
pub(crate) fn sky_colour(frame: &Frame, direction: Vec3) -> Vec3 {
    if direction.z >= 0.0 {
        rgb(frame.horizon).lerp(rgb(frame.zenith), 1.0 - (-4.0 * direction.z).exp())
    } else {
        rgb(frame.horizon).lerp(rgb(frame.ground), 1.0 - (5.0 * direction.z).exp())
    }
}

/// Colour of a surface point: `albedo` lit and hazed. `from_eye` is the point relative to the eye, `normal` points
/// up or out, `underside` tells that the surface is seen from below or within.
pub(crate) fn surface_colour(frame: &Frame, albedo: Vec3, from_eye: Vec3, normal: Vec3, underside: bool) -> Vec3 {
    let normal = if underside && frame.two_sided != 0 { -normal } else { normal };
    // colours that measure the ground are not to be darkened by it
    let is_measure = matches!(frame.colour, COLOUR_SLOPE | COLOUR_ASPECT);
    let light = if is_measure { SUN_LIGHT + SKY_LIGHT } else { light_on(frame, normal) };
    let light = light * if underside { UNDERSIDE } else { 1.0 };
    let haze = from_eye.length() * frame.haze_per_m;
    (albedo * light).lerp(rgb(frame.horizon), 1.0 - (-haze * haze).exp())
}

/// Share of the wireframe's colour at perspective-correct barycentric coordinates `b`, whose length of gradient over the
/// screen is `slope` (per pixel).
pub(crate) fn wire_share(b: Vec3, slope: Vec3, width_px: f32, opacity: f32) -> f32 {
    let slope = slope.max(Vec3::splat(1e-9));
    let distance_px = (b / slope).min_element();
    let height_px = (1.0 / slope).min_element();
    let line = (0.5 + 0.5 * width_px - distance_px).clamp(0.0, 1.0);
    let room = ((height_px - 1.5) / 4.5).clamp(0.0, 1.0);
    opacity * line * room
}

/// The first three numbers.
#[inline]
pub(crate) fn rgb(v: [f32; 4]) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RenderOptions;
    use glam::DVec3;
    use yamanami_core::{Aabb, View};

    fn frame(options: &RenderOptions) -> Frame {
        let view = View { eye: DVec3::Z * 100.0, target: DVec3::Y, fov_y_rad: 1.0, viewport_px: [64, 64] };
        Frame::new(DVec3::ZERO, Aabb { min: DVec3::ZERO, max: DVec3::splat(10.0) }, &view, options)
    }

    #[test]
    fn slopes_towards_the_north_west_are_lighter() {
        let frame = frame(&RenderOptions::default());
        let light = |x: f32, y: f32| light_on(&frame, Vec3::new(x, y, 1.0).normalize()).element_sum();
        assert!(light(-0.5, 0.5) > light(0.0, 0.0));
        assert!(light(0.0, 0.0) > light(0.5, -0.5));
        assert!(light(0.5, -0.5) > 0.15, "shade is not black");
    }

    #[test]
    fn aspects_differ_in_hue_and_level_ground_is_grey() {
        let grey = aspect_colour(Vec3::Z);
        assert!((grey.max_element() - grey.min_element()) < 1e-3);
        let colours: Vec<Vec3> = (0..8)
            .map(|k| {
                let (east, north) = (k as f32 * std::f32::consts::FRAC_PI_4).sin_cos();
                aspect_colour(Vec3::new(east, north, 1.0).normalize())
            })
            .collect();
        for k in 0..8 {
            assert!((colours[k] - colours[(k + 1) % 8]).length() > 0.1, "neighbours are told apart: {colours:?}");
        }
        // north-west is lightest, south-east darkest
        let lightness = |c: &Vec3| c.dot(Vec3::new(0.2126, 0.7152, 0.0722));
        assert!(colours.iter().all(|c| (lightness(&colours[3])..=lightness(&colours[7])).contains(&lightness(c))));
    }

    #[test]
    fn water_is_darker_the_deeper_and_leaves_dry_land_alone() {
        let frame = frame(&RenderOptions { water_level_m: Some(6.0), ..RenderOptions::default() });
        let seen = |height| water_colour(&frame, Vec3::splat(0.5), height);
        assert_eq!(seen(6.0), Vec3::splat(0.5));
        assert!(seen(5.9).z > seen(5.9).x && seen(5.9).element_sum() > seen(1.0).element_sum());
    }

    #[test]
    fn the_ramp_meets_its_stops_and_stays_within() {
        let frame = frame(&RenderOptions::default());
        for stop in frame.ramp {
            assert!((ramp_colour(&frame, stop[3]) - rgb(stop)).length() < 1e-6);
        }
        assert_eq!(ramp_colour(&frame, -3.0), rgb(frame.ramp[0]));
        assert!((ramp_colour(&frame, 7.0) - rgb(frame.ramp[7])).length() < 1e-6);
    }
}
