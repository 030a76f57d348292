//! All that the side panel turns.

use super::Options;
use glam::DVec2;
use yamanami::core::{Curvature, DeformedMap, DropFrom};

/// Triangles allowed where the program was started without a budget and one is switched on.
const USUAL_BUDGET: u32 = 100_000;
/// Most names at first.
const USUAL_NAMES: usize = 120;
/// Bending of light where the program was started without curvature and it is switched on.
const USUAL_REFRACTION: f64 = 0.13;

/// The settings.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Settings {
    pub(super) alpha: f64,
    pub(super) alpha_fall: f64,
    pub(super) ring_km: f64,
    pub(super) eye_m: f64,
    pub(super) exaggeration: f64,
    /// The scale that joins the ring smoothly; else `scale`.
    pub(super) smooth: bool,
    pub(super) scale: f64,
    /// From where the Earth curves down; `None`: it is flat.
    pub(super) curvature: Option<DropFrom>,
    pub(super) refraction: f64,
    pub(super) tolerance_px: f32,
    pub(super) budget_on: bool,
    pub(super) budget_triangles: u32,
    pub(super) names: bool,
    pub(super) hidden: bool,
    pub(super) from_ground: bool,
    pub(super) most_names: usize,
    pub(super) lines: bool,
    /// Hidden ground that α brings forth is paler.
    pub(super) veil: bool,
    pub(super) rings: bool,
    pub(super) compass: bool,
    pub(super) wireframe: bool,
    pub(super) antialias: bool,
    /// α goes up and down by itself.
    pub(super) sweep: bool,
}

impl Settings {
    /// As the program was started.
    pub(super) fn new(options: &Options, antialias: bool) -> Self {
        let map = &options.map;
        let smooth_scale = DeformedMap::smooth_scale(map.ring_m, map.eye_m);
        let smooth = (map.scale - smooth_scale).abs() <= 1e-9 * smooth_scale;
        Self {
            alpha: map.alpha,
            alpha_fall: map.alpha_fall,
            ring_km: map.ring_m / 1e3,
            eye_m: map.eye_m,
            exaggeration: map.exaggeration,
            smooth,
            scale: if smooth { 1.0 } else { map.scale },
            curvature: map.curvature.map(|c| c.from),
            refraction: map.curvature.map_or(USUAL_REFRACTION, |c| c.refraction),
            tolerance_px: options.tolerance_px,
            budget_on: options.budget_triangles.is_some(),
            budget_triangles: options.budget_triangles.unwrap_or(USUAL_BUDGET),
            names: true,
            hidden: options.hidden,
            from_ground: options.from_ground,
            most_names: USUAL_NAMES,
            lines: true,
            veil: true,
            rings: true,
            compass: true,
            wireframe: false,
            antialias,
            sweep: false,
        }
    }

    /// The projection around a place of the plane, unchecked.
    pub(super) fn map(&self, centre: DVec2) -> DeformedMap {
        let (ring_m, eye_m) = (1e3 * self.ring_km, self.eye_m);
        DeformedMap {
            centre,
            ring_m,
            eye_m,
            alpha: self.alpha,
            alpha_fall: self.alpha_fall,
            scale: if self.smooth { DeformedMap::smooth_scale(ring_m, eye_m) } else { self.scale },
            exaggeration: self.exaggeration,
            curvature: self.curvature.map(|from| Curvature { refraction: self.refraction, from }),
        }
    }

    /// Most triangles, if there is a limit.
    pub(super) fn budget(&self) -> Option<u32> {
        self.budget_on.then_some(self.budget_triangles)
    }
}
