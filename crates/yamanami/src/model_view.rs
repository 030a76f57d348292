//! Cameras around a model.

use crate::camera::FOV_Y_RAD;
use glam::DVec3;
use yamanami_core::{Aabb, View};

/// Share of the picture that a model's box may fill, from border to border.
const FILL: f64 = 0.94;

/// Height of the cameras above the horizon, radians (20°); from five views on, every second stands at 45°.
const ALTITUDES_RAD: [f64; 2] = [0.349_065_850_398_865_9, std::f64::consts::FRAC_PI_4];

/// Cameras on a ring around a model, z up, each as near as the model's box fits the picture. The first looks from the
/// south-east, as in Mizuno et al.; the ring is 20° above the horizon, and from five views on every second is 45° up.
pub fn model_views(bounds: Aabb, views: usize, viewport_px: [u32; 2]) -> Vec<View> {
    (0..views.max(1))
        .map(|i| {
            let azimuth = std::f64::consts::TAU * i as f64 / views.max(1) as f64 - std::f64::consts::FRAC_PI_4;
            let altitude = ALTITUDES_RAD[if views > 4 { i % 2 } else { 0 }];
            let towards_eye =
                DVec3::new(azimuth.cos() * altitude.cos(), azimuth.sin() * altitude.cos(), altitude.sin());
            fitted(bounds, -towards_eye, FOV_Y_RAD, viewport_px)
        })
        .collect()
}

/// A camera that looks along `forward` (unit, not upright) and holds the box as tightly as [`FILL`] allows.
fn fitted(bounds: Aabb, forward: DVec3, fov_y_rad: f64, viewport_px: [u32; 2]) -> View {
    let is_finite = bounds.min.is_finite() && bounds.max.is_finite();
    let (centre, half) =
        if is_finite { (bounds.centre(), 0.5 * (bounds.max - bounds.min)) } else { (DVec3::ZERO, DVec3::ONE) };
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let tan_y = FILL * (0.5 * fov_y_rad).tan();
    let tan_x = tan_y * f64::from(viewport_px[0]) / f64::from(viewport_px[1].max(1));
    // a point at (x, y, z) along right, up and forward is in the picture of an eye at (cx, cy, -d) when
    // |x - cx| <= tan_x (z + d): the extremes of x - tan_x z and of -x - tan_x z give cx and the least d
    let mut extremes = [f64::NEG_INFINITY; 4];
    for k in 0..8 {
        let sign = |axis: u32| if k >> axis & 1 == 0 { -1.0 } else { 1.0 };
        let corner = half * DVec3::new(sign(0), sign(1), sign(2));
        let (x, y, z) = (corner.dot(right), corner.dot(up), corner.dot(forward));
        let reach = [x - tan_x * z, -x - tan_x * z, y - tan_y * z, -y - tan_y * z];
        extremes = [0, 1, 2, 3].map(|i| extremes[i].max(reach[i]));
    }
    let [left, other_left, low, high] = extremes;
    let needed_m = ((left + other_left) / (2.0 * tan_x)).max((low + high) / (2.0 * tan_y));
    let distance_m = if needed_m > 0.0 { needed_m } else { 1.0 };
    let eye = centre + right * (0.5 * (left - other_left)) + up * (0.5 * (low - high)) - forward * distance_m;
    View { eye, target: eye + forward * distance_m, fov_y_rad, viewport_px }
}

/// A camera given by its places, in the model's own coordinates; `fov_y_rad` is 40° where none is given.
pub fn model_camera(eye: [f64; 3], target: [f64; 3], fov_y_rad: Option<f64>, viewport_px: [u32; 2]) -> View {
    let [eye, target] = [eye, target].map(DVec3::from_array);
    View { eye, target, fov_y_rad: fov_y_rad.unwrap_or(FOV_Y_RAD), viewport_px }
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::{Perspective, Projection};

    #[test]
    fn the_box_fills_the_picture_and_stays_in_it() {
        let origin = DVec3::new(4e5, -2e6, 30.0);
        for size in [DVec3::new(2.0, 3.0, 9.0), DVec3::new(2e-4, 1e-4, 1e-5), DVec3::new(500.0, 400.0, 1.0)] {
            let bounds = Aabb { min: origin, max: origin + size };
            for viewport_px in [[1920, 1080], [300, 900]] {
                let views = model_views(bounds, 7, viewport_px);
                let east_and_south = views[0].eye - bounds.centre();
                assert!(east_and_south.x > 0.0 && east_and_south.y < 0.0 && east_and_south.z > 0.0);
                for view in views {
                    let projection = Perspective::new(view, 1e-9, 1e9);
                    let mut reach = [0f64; 2];
                    for k in 0..8 {
                        let at = |axis: usize| if k >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
                        let clip = projection.clip_from_world(DVec3::new(at(0), at(1), at(2)));
                        assert!(clip.w > 0.0);
                        reach = [reach[0].max((clip.x / clip.w).abs()), reach[1].max((clip.y / clip.w).abs())];
                    }
                    assert!(reach[0] < 0.9401 && reach[1] < 0.9401 && reach[0].max(reach[1]) > 0.9399, "{reach:?}");
                }
            }
        }
    }

    #[test]
    fn odd_boxes_have_a_camera_all_the_same() {
        for bounds in [Aabb::EMPTY, Aabb { min: DVec3::ONE, max: DVec3::ONE }] {
            let view = model_views(bounds, 0, [64, 64])[0];
            assert!(view.eye.is_finite() && (view.target - view.eye).length() > 0.0);
        }
    }
}
