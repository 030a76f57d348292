//! How a picture is to look.

use crate::{Drape, Morph};
use std::f32::consts::{FRAC_PI_3, FRAC_PI_4, PI};
use std::sync::Arc;

/// Style of a picture. The default is a hill-shaded hypsometric relief under a sky.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderOptions {
    /// What gives the surface its colour.
    pub colour: ColourBy,
    /// Heights in metres (local metric frame) at the two ends of the tint. `None`: those of the mesh drawn; a flight
    /// should give its source's range, so that colours keep still.
    pub tint_range_m: Option<[f64; 2]>,
    /// Level at the light end of the ramp of [`ColourBy::Level`].
    pub deepest_level: u32,
    /// Image that [`ColourBy::Drape`] lays over the surface.
    pub drape: Option<Arc<Drape>>,
    /// How light falls.
    pub shading: Shading,
    /// One normal a triangle instead of one a vertex: the triangles show.
    pub flat: bool,
    /// Light of [`Shading::Relief`].
    pub light: Light,
    /// Geomorphing; `None` draws every vertex at its place.
    pub morph: Option<Morph>,
    /// Edges drawn over the surface.
    pub wireframe: Option<Wireframe>,
    /// Height of a water surface in metres (local metric frame): what lies below is tinted blue, darker with depth.
    pub water_level_m: Option<f64>,
    /// Aerial haze.
    pub haze: Haze,
    /// What is seen beside the surface.
    pub background: Background,
    /// Distances of the near and far plane, metres; `None`: what the mesh's box asks for.
    pub depth_planes_m: Option<[f64; 2]>,
    /// Four samples a pixel instead of one.
    pub antialias: bool,
}

/// What gives the surface its colour before light falls on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColourBy {
    /// Height: the hypsometric tint.
    #[default]
    Height,
    /// The level of the vertices: dark is coarse, light is fine.
    Level,
    /// An image; height where the image ends or is transparent.
    Drape,
    /// One colour, sRGB.
    Plain([u8; 3]),
    /// The colours of the vertices.
    Vertex,
    /// Angle to the horizontal, by the normals that light falls on ([`RenderOptions::flat`]: the triangles' own): level is
    /// light, [`STEEP_RAD`] and more is dark.
    Slope,
    /// Direction in which water runs off: a circle of hues, north is red, level ground grey.
    Aspect,
}

/// Slope at the dark end of the ramp of [`ColourBy::Slope`], radians.
pub const STEEP_RAD: f32 = FRAC_PI_3;

/// How light falls on the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// From a fixed place in the sky, as on maps: for terrain, seen from above.
    #[default]
    Relief,
    /// From over the viewer's shoulders and from the eye: for closed models. Both sides are lit, the inner one far less,
    /// so that holes show and tell themselves.
    Model,
}

/// Light on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where the light comes from, radians clockwise from north. Relief is read right when it comes from the north-west.
    pub sun_azimuth_rad: f32,
    /// Height of the light above the horizon, radians.
    pub sun_altitude_rad: f32,
    /// Contrast of the shading: 0 is none, 1 as the slopes give it, more for gentle land.
    pub strength: f32,
    /// Softer lights from both sides, so that ridges that run towards the light show too.
    pub multi_directional: bool,
}

/// How edges are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wireframe {
    /// Line colour, sRGB.
    pub colour: [u8; 3],
    /// Opacity, 0 to 1. Where triangles become smaller than a few pixels, lines fade out.
    pub opacity: f32,
    /// Line width in pixels.
    pub width_px: f32,
}

/// Aerial haze: with distance, colours go over to that of the horizon.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Haze {
    /// None.
    None,
    /// As suits the size of the mesh's box.
    #[default]
    Auto,
    /// Two thirds haze at this distance, metres.
    Distance(f64),
}

/// What is seen beside the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Background {
    /// A sky that is light at the horizon.
    #[default]
    Sky,
    /// One colour, sRGB; also the colour of the haze.
    Plain([u8; 3]),
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            colour: ColourBy::default(),
            tint_range_m: None,
            deepest_level: 12,
            drape: None,
            shading: Shading::default(),
            flat: false,
            light: Light::default(),
            morph: None,
            wireframe: None,
            water_level_m: None,
            haze: Haze::default(),
            background: Background::default(),
            depth_planes_m: None,
            antialias: true,
        }
    }
}

impl Default for Light {
    fn default() -> Self {
        Self { sun_azimuth_rad: 1.75 * PI, sun_altitude_rad: FRAC_PI_4, strength: 1.5, multi_directional: true }
    }
}

impl Default for Wireframe {
    fn default() -> Self {
        Self { colour: [24, 30, 38], opacity: 0.55, width_px: 1.0 }
    }
}
