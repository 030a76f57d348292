//! What one picture needs to know, worked out once in `f64` and handed to the shaders and to their software twin alike.

use crate::palette::{LEVELS, Ramp, SLOPES, STOPS, TINT, linear};
use crate::{Background, ColourBy, GpuError, Haze, RenderOptions, STEEP_RAD, Shading};
use glam::{DVec3, Mat4, Vec3, Vec4};
use yamanami_core::{Aabb, Perspective, View};

/// The uniform block of `shaders/frame.wgsl`, field by field.
///
/// Points are taken relative to the eye before anything else, so that `f32` is fine near the eye wherever it is.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Frame {
    /// Clip space from eye-relative metres; depth is reversed, 1 near to 0 far.
    pub(crate) clip_from_eye: [[f32; 4]; 4],
    /// Eye relative to the mesh's origin; pixels per radian.
    pub(crate) eye: [f32; 4],
    /// Ray through the middle of the picture; near plane in metres.
    pub(crate) ray_forward: [f32; 4],
    /// What the ray gains to the right border, and to the upper border.
    pub(crate) ray_right: [f32; 4],
    pub(crate) ray_up: [f32; 4],
    /// Directions to the three lights, and what a surface that faces one gets of it.
    pub(crate) lights: [[f32; 4]; 3],
    /// Lower end and 1 / length of the ramp, strength of the shading, morphing tau and width.
    pub(crate) ramp_start: f32,
    pub(crate) ramp_scale: f32,
    pub(crate) strength: f32,
    pub(crate) tau_px: f32,
    pub(crate) morph_width: f32,
    /// 1 / haze distance.
    pub(crate) haze_per_m: f32,
    /// Deepest level's share of the ramp.
    pub(crate) ramp_per_level: f32,
    /// Width of the wireframe's lines.
    pub(crate) wire_width_px: f32,
    /// Linear colour and opacity of the wireframe.
    pub(crate) wire: [f32; 4],
    /// Linear colours of the plain surface, sky, horizon and ground.
    pub(crate) plain: [f32; 4],
    pub(crate) zenith: [f32; 4],
    pub(crate) horizon: [f32; 4],
    pub(crate) ground: [f32; 4],
    /// Image coordinates from metres relative to the origin.
    pub(crate) drape_u: [f32; 4],
    pub(crate) drape_v: [f32; 4],
    /// Height of the water relative to the origin, 1 / depth at which it is two thirds dark, 1 where there is water.
    pub(crate) water: [f32; 4],
    /// Linear colour and place of each stop.
    pub(crate) ramp: [[f32; 4]; STOPS],
    /// One of the `COLOUR_*` numbers.
    pub(crate) colour: u32,
    /// 1 when the target takes bytes as they are, so that the shader must encode sRGB itself.
    pub(crate) encode_srgb: u32,
    /// Width and height in pixels.
    pub(crate) size_px: [f32; 2],
    /// 1 when the side turned away is lit by its own normal.
    pub(crate) two_sided: u32,
    /// 1 when each triangle has one normal.
    pub(crate) flat: u32,
    /// To a whole number of 16 bytes.
    pub(crate) rest: [u32; 2],
}

/// [`Frame::colour`]: one colour.
pub(crate) const COLOUR_PLAIN: u32 = 0;
/// [`Frame::colour`]: the ramp by height.
pub(crate) const COLOUR_HEIGHT: u32 = 1;
/// [`Frame::colour`]: the ramp by level.
pub(crate) const COLOUR_LEVEL: u32 = 2;
/// [`Frame::colour`]: the image over the ramp by height.
pub(crate) const COLOUR_DRAPE: u32 = 3;
/// [`Frame::colour`]: the vertices' colours.
pub(crate) const COLOUR_VERTEX: u32 = 4;

/// [`Frame::colour`]: the ramp by slope.
pub(crate) const COLOUR_SLOPE: u32 = 5;
/// [`Frame::colour`]: the circle of hues by aspect.
pub(crate) const COLOUR_ASPECT: u32 = 6;

/// Azimuth of the side lights from the main light, radians.
const SIDE_AZIMUTH_RAD: f32 = 1.3;
/// Shares of the main light and of each side light.
const LIGHT_SHARES: [f32; 3] = [0.70, 0.15, 0.15];
/// Lights on models: right, up and towards the eye, and share.
const MODEL_LIGHTS: [([f64; 3], f32); 3] =
    [([-0.55, 0.65, 0.60], 0.62), ([0.80, 0.05, 0.60], 0.16), ([0.0, 0.0, 1.0], 0.30)];
/// Water is two thirds dark at this share of the range of heights.
const WATER_RANGE_SHARE: f64 = 0.12;
/// Haze is two thirds at this many diagonals of the mesh's box.
const HAZE_DIAGONALS: f64 = 3.0;

impl Frame {
    /// Sets up the picture of a mesh with this origin and origin-relative box.
    pub(crate) fn new(origin: DVec3, bounds: Aabb, view: &View, options: &RenderOptions) -> Self {
        let [near_m, far_m] = options.depth_planes_m.unwrap_or_else(|| depth_planes_m(bounds, view.eye - origin));
        let (forward, tan_y) = (view.forward(), (view.fov_y_rad * 0.5).tan());
        let right = forward.cross(view.up()).normalize();
        let lights = match options.shading {
            Shading::Relief => relief_lights(options),
            Shading::Model => model_lights([right, right.cross(forward), -forward]),
        };
        let range_m = options.tint_range_m.unwrap_or([bounds.min.z + origin.z, bounds.max.z + origin.z]);
        let (ramp, ramp_start, ramp_end) = match options.colour {
            ColourBy::Level => (LEVELS, 0.0, 1.0),
            ColourBy::Slope => (SLOPES, 0.0, f64::from(STEEP_RAD)),
            _ => {
                let [low, high] = range_m.map(|z| z - origin.z);
                if low < high { (TINT, low, high) } else { (TINT, low.min(1e9), low.min(1e9) + 1.0) }
            }
        };
        let haze_per_m = match options.haze {
            Haze::None => 0.0,
            Haze::Auto if bounds.diagonal().is_finite() => 1.0 / (HAZE_DIAGONALS * bounds.diagonal()).max(1.0),
            Haze::Auto => 0.0,
            Haze::Distance(distance_m) => 1.0 / distance_m.max(1e-3),
        };
        let [zenith, horizon, ground] = match options.background {
            Background::Sky => [[92, 142, 200], [222, 231, 238], [192, 202, 210]],
            Background::Plain(colour) => [colour; 3],
        };
        let (colour, plain) = match options.colour {
            ColourBy::Plain(plain) => (COLOUR_PLAIN, plain),
            ColourBy::Height => (COLOUR_HEIGHT, [0; 3]),
            ColourBy::Level => (COLOUR_LEVEL, [0; 3]),
            ColourBy::Drape if options.drape.is_some() => (COLOUR_DRAPE, [0; 3]),
            ColourBy::Drape => (COLOUR_HEIGHT, [0; 3]),
            ColourBy::Vertex => (COLOUR_VERTEX, [0; 3]),
            ColourBy::Slope => (COLOUR_SLOPE, [0; 3]),
            ColourBy::Aspect => (COLOUR_ASPECT, [0; 3]),
        };
        let wire = options.wireframe.unwrap_or_default();
        let morph = options.morph.map_or([1.0, 0.0], |morph| [morph.tau_px.max(1e-6), morph.width.max(0.0)]);
        let drape = options.drape.as_ref().map_or([[0.0; 3]; 2], |drape| drape.uv_from_local());
        let local_drape =
            drape.map(|[a, b, c]| DVec3::new(a, b, c + a * origin.x + b * origin.y).as_vec3().extend(0.0));
        Self {
            clip_from_eye: reversed_clip_from_eye(view, near_m, far_m).to_cols_array_2d(),
            eye: (view.eye - origin).as_vec3().extend(view.pixels_per_radian() as f32).to_array(),
            ray_forward: forward.as_vec3().extend(near_m as f32).to_array(),
            ray_right: (right * tan_y * view.aspect()).as_vec3().extend(0.0).to_array(),
            ray_up: (right.cross(forward) * tan_y).as_vec3().extend(0.0).to_array(),
            lights: lights.map(|light| light.to_array()),
            ramp_start: ramp_start as f32,
            ramp_scale: (1.0 / (ramp_end - ramp_start)) as f32,
            strength: if options.shading == Shading::Model { 1.0 } else { options.light.strength },
            tau_px: morph[0],
            morph_width: morph[1],
            haze_per_m: haze_per_m as f32,
            ramp_per_level: 1.0 / options.deepest_level.max(1) as f32,
            wire_width_px: wire.width_px,
            wire: linear(wire.colour).extend(options.wireframe.map_or(0.0, |wire| wire.opacity)).to_array(),
            plain: linear(plain).extend(1.0).to_array(),
            zenith: linear(zenith).extend(1.0).to_array(),
            horizon: linear(horizon).extend(1.0).to_array(),
            ground: linear(ground).extend(1.0).to_array(),
            drape_u: local_drape[0].to_array(),
            drape_v: local_drape[1].to_array(),
            water: options.water_level_m.filter(|z| z.is_finite()).map_or([0.0; 4], |level_m| {
                let dark_m = (WATER_RANGE_SHARE * (range_m[1] - range_m[0])).clamp(0.01, 1e6);
                [(level_m - origin.z).clamp(-1e9, 1e9) as f32, (1.0 / dark_m) as f32, 1.0, 0.0]
            }),
            ramp: linear_ramp(ramp),
            colour,
            encode_srgb: 0,
            size_px: view.viewport_px.map(|side| side as f32),
            two_sided: u32::from(options.shading == Shading::Model),
            flat: u32::from(options.flat),
            rest: [0; 2],
        }
    }
}

/// Near and far distances that hold an origin-relative box seen from `eye` (relative to the same origin). Outside the
/// box the near plane is half way to it; inside it is as near as reversed depth in `f32` comfortably allows.
pub fn depth_planes_m(bounds: Aabb, eye: DVec3) -> [f64; 2] {
    if !(bounds.min.is_finite() && bounds.max.is_finite() && eye.is_finite()) {
        return [0.1, 1e5];
    }
    let nearest_m = (eye.clamp(bounds.min, bounds.max) - eye).length();
    let farthest_m = (bounds.max - eye).abs().max((bounds.min - eye).abs()).length();
    let far_m = (farthest_m * 1.01).max(1e-9);
    [(nearest_m * 0.5).max(far_m * 2e-6), far_m]
}

/// Checks a picture's size against the longest side that can be drawn.
pub(crate) fn check_size(size_px: [u32; 2], limit_px: u32) -> Result<(), GpuError> {
    let fits = size_px.iter().all(|side| (1..=limit_px).contains(side));
    if fits { Ok(()) } else { Err(GpuError::PictureSize { size_px, limit_px }) }
}

fn reversed_clip_from_eye(view: &View, near_m: f64, far_m: f64) -> Mat4 {
    let mut clip = Perspective::new(*view, near_m, far_m).clip_from_local(view.eye);
    for column in [&mut clip.x_axis, &mut clip.y_axis, &mut clip.z_axis, &mut clip.w_axis] {
        column.z = column.w - column.z;
    }
    clip.as_mat4()
}

/// Lights for models: from over the left shoulder, from the right, and from the eye. `axes`: right, up, towards the eye.
fn model_lights(axes: [DVec3; 3]) -> [Vec4; 3] {
    MODEL_LIGHTS.map(|([right, up, near], share)| {
        let direction = axes[0] * right + axes[1] * up + axes[2] * near;
        direction.normalize().as_vec3().extend(share)
    })
}

/// Lights for terrain. Each is stronger the lower it stands, so that level ground gets its share.
fn relief_lights(options: &RenderOptions) -> [Vec4; 3] {
    let light = options.light;
    let direction = |azimuth: f32| {
        let (sin_az, cos_az) = azimuth.sin_cos();
        let (sin_alt, cos_alt) = light.sun_altitude_rad.clamp(0.05, std::f32::consts::FRAC_PI_2).sin_cos();
        Vec3::new(sin_az * cos_alt, cos_az * cos_alt, sin_alt)
    };
    let shares = if light.multi_directional { LIGHT_SHARES } else { [1.0, 0.0, 0.0] };
    let azimuths = [0.0, -SIDE_AZIMUTH_RAD, SIDE_AZIMUTH_RAD].map(|turn| light.sun_azimuth_rad + turn);
    [0, 1, 2].map(|i| {
        let direction = direction(azimuths[i]);
        direction.extend(shares[i] / direction.z)
    })
}

fn linear_ramp(ramp: Ramp) -> [[f32; 4]; STOPS] {
    ramp.map(|(place, colour)| linear(colour).extend(place).to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_planes_hold_the_box() {
        let bounds = Aabb { min: DVec3::splat(-100.0), max: DVec3::splat(100.0) };
        for eye in [DVec3::new(500.0, 0.0, 0.0), DVec3::ZERO, DVec3::new(-2e6, 1e6, 3e5)] {
            let [near_m, far_m] = depth_planes_m(bounds, eye);
            let corner_m = (bounds.max - eye).length().max((bounds.min - eye).length());
            assert!(near_m > 0.0 && far_m > corner_m);
            assert!(near_m <= (eye.clamp(bounds.min, bounds.max) - eye).length().max(far_m * 2e-6));
        }
        let [near_m, far_m] = depth_planes_m(Aabb::EMPTY, DVec3::ZERO);
        assert!(near_m < far_m);
    }

    #[test]
    fn reversed_depth_runs_from_one_to_zero() {
        let view = View { eye: DVec3::ZERO, target: DVec3::X, fov_y_rad: 1.0, viewport_px: [64, 64] };
        let clip = reversed_clip_from_eye(&view, 2.0, 1000.0);
        let depth = |x: f32| {
            let p = clip * Vec4::new(x, 0.0, 0.0, 1.0);
            p.z / p.w
        };
        assert!((depth(2.0) - 1.0).abs() < 1e-6 && depth(1000.0).abs() < 1e-6 && depth(10.0) > depth(11.0));
    }

    #[test]
    fn sizes_out_of_range_are_refused_in_one_line() {
        assert!(check_size([1, 4096], 4096).is_ok());
        let error = check_size([0, 5], 4096).unwrap_err().to_string();
        assert_eq!(error, "picture size: expected 1 to 4096 pixels a side, got 0x5");
        assert!(check_size([4097, 5], 4096).is_err());
    }
}
