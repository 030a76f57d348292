//! What is asked of a front: terrain tolerance, view and triangle budget, each on its own or together.
//!
//! Based on: Hashida, Kanai, Kishinami (the three controls at once). The view control here is the continuous
//! screen-space error; the paper's staircase is in `paper`.

use yamanami_core::{Frustum, Hierarchy, MapView, NodeId, Sphere, View};

/// The view control: errors count by what they look like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewCriterion {
    /// The camera.
    pub view: View,
    /// Largest error wanted on the screen, pixels.
    pub tolerance_px: f32,
    /// Whether what lies outside the view is left coarse.
    pub cull: bool,
}

/// The view control of a deformed map: errors count by how far they move the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapCriterion {
    /// The map.
    pub view: MapView,
    /// Largest error wanted in the picture, pixels.
    pub tolerance_px: f32,
}

/// All controls. Switched off: tolerances of 0, no view, no budget.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Criteria {
    /// Errors up to this many metres are good enough wherever they are (τ* of the paper).
    pub terrain_tolerance_m: f32,
    /// The view control.
    pub view: Option<ViewCriterion>,
    /// The view control of a deformed map; it takes the place of `view` and of the terrain tolerance.
    pub map: Option<MapCriterion>,
    /// Most triangles allowed.
    pub budget_triangles: Option<u32>,
    /// How much worse, relatively, a node must get than it had to be to be shown before it is taken away: 0 is exact,
    /// 0.1 avoids flicker.
    pub hysteresis: f32,
    /// Most steps an update may take, so that a frame has an upper cost; steps that restore the budget are not counted.
    pub max_steps: Option<usize>,
}

/// Criteria with what follows from them, ready for the inner loop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    terrain_tolerance_m: f32,
    map: Option<MapView>,
    pub(crate) view: Option<Eye>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Eye {
    pub(crate) view: View,
    pub(crate) pixels_per_radian: f64,
    pub(crate) frustum: Option<Frustum>,
}

impl Criteria {
    /// The error beyond which nodes are wanted: pixels with a view, metres without.
    pub fn threshold(&self) -> f32 {
        let in_view = self.map.map(|m| m.tolerance_px).or(self.view.map(|v| v.tolerance_px));
        in_view.unwrap_or(self.terrain_tolerance_m).max(f32::MIN_POSITIVE)
    }

    pub(crate) fn scale(&self) -> Scale {
        Scale {
            terrain_tolerance_m: self.terrain_tolerance_m,
            map: self.map.map(|m| m.view),
            view: self.view.filter(|_| self.map.is_none()).map(|v| Eye {
                view: v.view,
                pixels_per_radian: v.view.pixels_per_radian(),
                frustum: v.cull.then(|| v.view.frustum()),
            }),
        }
    }
}

/// A node as seen in a frame: its priority and how far it is from changing sides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
    /// Error in pixels (metres without any view), 0 when the node need not be shown.
    pub(crate) priority: f32,
    pub(crate) error_m: f32,
    /// Distance of the eye from the bound's centre and from its surface (negative inside), metres.
    pub(crate) centre_m: f64,
    pub(crate) surface_m: f64,
    /// Signed distance to the side of the view: below 0 outside, infinite without culling.
    pub(crate) side_m: f64,
}

impl Scale {
    /// Weighs a node. The priority never rises from a parent to its child.
    #[inline]
    pub(crate) fn weigh<H: Hierarchy>(&self, hierarchy: &H, node: NodeId) -> Seen {
        if let Some(map) = &self.map {
            let priority = hierarchy.map_error_px(node, map);
            return Seen { priority, error_m: 0.0, centre_m: 0.0, surface_m: 0.0, side_m: f64::INFINITY };
        }
        let (error_m, bound) = hierarchy.error_and_bound(node);
        self.weigh_in_view(error_m, bound)
    }

    #[inline]
    fn weigh_in_view(&self, error_m: f32, bound: Sphere) -> Seen {
        let mut seen = Seen { priority: 0.0, error_m, centre_m: 0.0, surface_m: 0.0, side_m: f64::INFINITY };
        let Some(eye) = &self.view else {
            seen.priority = error_m;
            return seen;
        };
        if error_m <= self.terrain_tolerance_m {
            // never wanted, wherever the eye is
            seen.error_m = 0.0;
            return seen;
        }
        seen.centre_m = (bound.centre - eye.view.eye).length();
        seen.surface_m = seen.centre_m - bound.radius_m;
        if let Some(frustum) = &eye.frustum {
            seen.side_m = frustum.margin_m(bound);
            if seen.side_m < 0.0 {
                return seen;
            }
        }
        seen.priority = if seen.surface_m <= 0.0 {
            f32::INFINITY
        } else {
            (f64::from(error_m) * eye.pixels_per_radian / seen.surface_m) as f32
        };
        seen
    }
}
