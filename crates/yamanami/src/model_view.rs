//! Cameras around a model.

use crate::camera::FOV_Y_RAD;
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::{Aabb, TriangleMesh, View};

/// Share of the picture that a model may fill, from border to border.
const FILL: f64 = 0.94;

/// Height of the cameras above the horizon, radians (20°); from five views on, every second stands at 45°.
const ALTITUDES_RAD: [f64; 2] = [0.349_065_850_398_865_9, std::f64::consts::FRAC_PI_4];

/// Cameras on a ring around a model, z up, each as near as all points fit the picture. The first looks from the
/// south-east, as in Mizuno et al.; the ring is 20° above the horizon, and from five views on every second is 45° up.
pub fn model_views(points: &[DVec3], views: usize, viewport_px: [u32; 2]) -> Vec<View> {
    let mut bounds = Aabb::EMPTY;
    points.iter().for_each(|&p| bounds.include(p));
    let centre = if bounds.min.is_finite() && bounds.max.is_finite() { bounds.centre() } else { DVec3::ZERO };
    (0..views.max(1))
        .map(|i| {
            let azimuth = std::f64::consts::TAU * i as f64 / views.max(1) as f64 - std::f64::consts::FRAC_PI_4;
            let altitude = ALTITUDES_RAD[if views > 4 { i % 2 } else { 0 }];
            let towards_eye =
                DVec3::new(azimuth.cos() * altitude.cos(), azimuth.sin() * altitude.cos(), altitude.sin());
            fitted(points, centre, -towards_eye, viewport_px)
        })
        .collect()
}

/// A camera that looks along `forward` (unit, not upright) and holds the points as tightly as [`FILL`] allows.
fn fitted(points: &[DVec3], centre: DVec3, forward: DVec3, viewport_px: [u32; 2]) -> View {
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let tan_y = FILL * (0.5 * FOV_Y_RAD).tan();
    let tan_x = tan_y * f64::from(viewport_px[0]) / f64::from(viewport_px[1].max(1));
    // a point at (x, y, z) along right, up and forward is in the picture of an eye at (cx, cy, -d) when
    // |x - cx| <= tan_x (z + d): the extremes of x - tan_x z and of -x - tan_x z give cx and the least d
    let reach = |p: &DVec3| {
        let p = *p - centre;
        let (x, y, z) = (p.dot(right), p.dot(up), p.dot(forward));
        [x - tan_x * z, -x - tan_x * z, y - tan_y * z, -y - tan_y * z]
    };
    let most = |a: [f64; 4], b: [f64; 4]| [0, 1, 2, 3].map(|i| a[i].max(b[i]));
    let least = || [f64::NEG_INFINITY; 4];
    let mut extremes = points.par_iter().map(reach).reduce(least, most);
    if !extremes.iter().all(|v| v.is_finite()) {
        extremes = [0.0; 4];
    }
    let [left, other_left, low, high] = extremes;
    let needed_m = ((left + other_left) / (2.0 * tan_x)).max((low + high) / (2.0 * tan_y));
    let distance_m = if needed_m > 0.0 { needed_m } else { 1.0 };
    let eye = centre + right * (0.5 * (left - other_left)) + up * (0.5 * (low - high)) - forward * distance_m;
    View { eye, target: eye + forward * distance_m, fov_y_rad: FOV_Y_RAD, viewport_px }
}

/// Turns a model whose up is y so that z is; lengths and everything else stay bit for bit.
pub fn turn_y_up(mesh: &mut TriangleMesh) {
    mesh.positions.iter_mut().for_each(|p| *p = DVec3::new(p.x, -p.z, p.y));
    mesh.normals.iter_mut().for_each(|n| *n = [n[0], -n[2], n[1]]);
}

/// Undoes [`turn_y_up`].
pub fn turn_back_y_up(mesh: &mut TriangleMesh) {
    mesh.positions.iter_mut().for_each(|p| *p = DVec3::new(p.x, p.z, -p.y));
    mesh.normals.iter_mut().for_each(|n| *n = [n[0], n[2], -n[1]]);
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
    fn the_points_fill_the_picture_and_stay_in_it() {
        let origin = DVec3::new(4e5, -2e6, 30.0);
        for size in [DVec3::new(2.0, 3.0, 9.0), DVec3::new(2e-4, 1e-4, 1e-5), DVec3::new(500.0, 400.0, 1.0)] {
            let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2 & 1));
            let points: Vec<DVec3> = (0..8).map(|k| origin + size * corner(k)).collect();
            for viewport_px in [[1920, 1080], [300, 900]] {
                let views = model_views(&points, 7, viewport_px);
                let south_east = views[0].eye - (origin + 0.5 * size);
                assert!(south_east.x > 0.0 && south_east.y < 0.0 && south_east.z > 0.0);
                for view in views {
                    let projection = Perspective::new(view, 1e-9, 1e9);
                    let mut reach = [0f64; 2];
                    for &point in &points {
                        let clip = projection.clip_from_world(point);
                        assert!(clip.w > 0.0);
                        reach = [reach[0].max((clip.x / clip.w).abs()), reach[1].max((clip.y / clip.w).abs())];
                    }
                    let most = reach[0].max(reach[1]);
                    assert!((most - FILL).abs() < 1e-4, "{reach:?}");
                }
            }
        }
    }

    #[test]
    fn a_turned_model_turns_back() {
        let mut mesh = TriangleMesh::new(vec![DVec3::new(1.0, 2.0, 3.0)], vec![]);
        mesh.normals = vec![[0.0, 1.0, 0.0]];
        let before = mesh.clone();
        turn_y_up(&mut mesh);
        assert_eq!((mesh.positions[0], mesh.normals[0]), (DVec3::new(1.0, -3.0, 2.0), [0.0, 0.0, 1.0]));
        turn_back_y_up(&mut mesh);
        assert_eq!(mesh, before);
    }

    #[test]
    fn odd_points_have_a_camera_all_the_same() {
        for points in [vec![], vec![DVec3::ONE; 3], vec![DVec3::NAN]] {
            let view = model_views(&points, 0, [64, 64])[0];
            assert!(view.eye.is_finite() && (view.target - view.eye).length() > 0.0);
        }
    }
}
