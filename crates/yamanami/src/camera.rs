//! Cameras over a terrain and around a model.

use crate::{Subject, model_views};
use glam::DVec3;
use yamanami_core::{Perspective, Projection, View};

/// Vertical field of view where none is given, radians (40°).
pub(crate) const FOV_Y_RAD: f64 = 0.698_131_700_797_731_8;

/// A view of the whole, as near as it fits the picture: of a terrain or TIN from the south-west and above, of a model as
/// [`model_views`] has its first.
pub fn overview(subject: &impl Subject, viewport_px: [u32; 2]) -> View {
    let bounds = subject.bounds();
    if !subject.is_ground() {
        return model_views(&bounds.corners(), 1, viewport_px)[0];
    }
    let (min, max) = (bounds.min, bounds.max);
    let [east_m, north_m] = (max - min).truncate().to_array();
    let [low, high] = [bounds.min.z, bounds.max.z];
    let centre = bounds.centre();
    // the border's corners low and half high, and a summit in the middle
    let mut points = vec![DVec3::new(centre.x, centre.y, high)];
    for (x, y) in [(min.x, min.y), (max.x, min.y), (min.x, max.y), (max.x, max.y)] {
        points.extend([low, 0.5 * (low + high)].map(|z| DVec3::new(x, y, z)));
    }
    let direction = DVec3::new(-0.45, -0.95, 0.62).normalize();
    let half_height = (0.5 * FOV_Y_RAD).tan();
    let mut distance_m = 0.1 * east_m.hypot(north_m).max(high - low).max(1.0);
    loop {
        let eye = centre + distance_m * direction;
        let mut view = View { eye, target: centre, fov_y_rad: FOV_Y_RAD, viewport_px };
        let mut reach = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        // looking a little higher or lower centres the terrain in the picture
        for _ in 0..4 {
            reach = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
            let projection = Perspective::new(view, 1.0, 1e9);
            for &point in &points {
                let clip = projection.clip_from_world(point);
                let [x, y] = if clip.w > 0.0 { [clip.x / clip.w, clip.y / clip.w] } else { [9.0; 2] };
                reach = [[reach[0][0].min(x), reach[0][1].min(y)], [reach[1][0].max(x), reach[1][1].max(y)]];
            }
            view.target.z += 0.5 * (reach[0][1] + reach[1][1]) * half_height * distance_m;
        }
        let [[left, bottom], [right, top]] = reach;
        if left > -0.96 && right < 0.96 && top - bottom < 1.84 {
            return view;
        }
        distance_m *= 1.02;
    }
}

/// A view from a place to a place, both in the source CRS, heights in metres.
pub fn view_between(
    subject: &impl Subject,
    eye: [f64; 3],
    target: [f64; 3],
    fov_y_rad: f64,
    viewport_px: [u32; 2],
) -> View {
    let local = |p: [f64; 3]| subject.local_from_source(DVec3::from_array(p));
    View { eye: local(eye), target: local(target), fov_y_rad, viewport_px }
}
