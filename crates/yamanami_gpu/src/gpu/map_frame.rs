//! What one picture of a deformed map needs to know, worked out in `f64`: the uniform block of `shaders/map.wgsl`.

use crate::map::premultiplied;
use crate::{Hidden, MAX_TEXTURES, MapOptions};
use glam::{DVec2, DVec3};
use yamanami_core::{DropFrom, EARTH_RADIUS_M, MapView};

/// [`MapFrame::hidden`]: all ground is seen.
const HIDDEN_SEEN: u32 = 0;
/// [`MapFrame::hidden`]: nothing is drawn where ground hides.
const HIDDEN_DROPPED: u32 = 1;
/// [`MapFrame::hidden`]: a colour takes its share.
const HIDDEN_VEILED: u32 = 2;

/// See the shader; lengths but the first are in radii of the ring.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct MapFrame {
    origin: [f32; 4],
    to_ring: [f32; 4],
    eye: [f32; 4],
    mix: [f32; 4],
    clip_x: [f32; 4],
    clip_y: [f32; 4],
    ground: [f32; 4],
    background: [f32; 4],
    wire: [f32; 4],
    veil: [f32; 4],
    horizon: [f32; 4],
    wire_width_px: f32,
    texture_count: u32,
    hidden: u32,
    encode_srgb: u32,
    antialias: [u32; 4],
    textures: [[f32; 4]; MAX_TEXTURES],
}

impl MapFrame {
    /// Sets up the picture of a mesh with this origin on a target that encodes sRGB itself, or not.
    pub(super) fn new(origin: DVec3, view: &MapView, options: &MapOptions, is_srgb: bool) -> Self {
        let map = &view.map;
        let from_centre = origin.truncate() - map.centre;
        let bend = map.curvature.map_or(0.0, |c| (1.0 - c.refraction) * map.ring_m / EARTH_RADIUS_M);
        let counts_from_centre = map.curvature.is_some_and(|c| c.from == DropFrom::Centre);
        let [width, height] = view.size_px.map(f64::from);
        let scale = 2.0 * view.ring_px / DVec2::new(width, height);
        let (sin, cos) = view.up_azimuth_rad.sin_cos();
        let clip_x = DVec3::new(scale.x * cos, -scale.x * sin, 2.0 * view.centre_px.x / width - 1.0);
        let clip_y = DVec3::new(scale.y * sin, scale.y * cos, 1.0 - 2.0 * view.centre_px.y / height);
        let with_share = |colour: [u8; 3], share: f32| {
            let [r, g, b] = colour.map(|v| f32::from(v) / 255.0);
            [r, g, b, share]
        };
        let wire = options.wireframe.unwrap_or_default();
        let mut frame = Self {
            origin: origin.as_vec3().extend(0.0).to_array(),
            to_ring: from_centre.extend(origin.z).as_vec3().extend((1.0 / map.ring_m) as f32).to_array(),
            eye: [
                map.eye_m / map.ring_m,
                map.exaggeration,
                0.5 * bend,
                f64::from(u8::from(counts_from_centre)),
            ]
            .map(|v| v as f32),
            mix: [map.alpha, map.alpha_fall, map.scale, view.rim_m / map.ring_m].map(|v| v as f32),
            clip_x: clip_x.as_vec3().extend(0.0).to_array(),
            clip_y: clip_y.as_vec3().extend(0.0).to_array(),
            ground: premultiplied(options.ground),
            background: premultiplied(options.background),
            wire: with_share(wire.colour, wire.opacity),
            veil: [0.0; 4],
            horizon: [1.0; 4],
            wire_width_px: wire.width_px,
            texture_count: options.textures.levels().len() as u32,
            hidden: HIDDEN_SEEN,
            encode_srgb: u32::from(!is_srgb),
            antialias: [u32::from(options.antialias), 0, 0, 0],
            textures: [[0.0; 4]; MAX_TEXTURES],
        };
        for (out, level) in frame.textures.iter_mut().zip(options.textures.levels()) {
            *out = [(1.0 / level.reach_m) as f32, ((level.side_px - 1) / 2) as f32, 0.0, 0.0];
        }
        if let Some(veil) = &options.veil {
            let horizon = &veil.horizon;
            let (azimuths, distances) = (horizon.azimuth_count() as f32, horizon.distance_count() as f32);
            let per_step = (map.ring_m / horizon.step_m()) as f32;
            frame.horizon = [azimuths, distances, per_step, 1.0 / veil.slack(view)];
            (frame.hidden, frame.veil) = match veil.hidden {
                Hidden::Dropped => (HIDDEN_DROPPED, [0.0; 4]),
                Hidden::Veiled(colour, share) => (HIDDEN_VEILED, with_share(colour, share)),
            };
        }
        frame
    }
}
