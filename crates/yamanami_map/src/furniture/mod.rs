//! What stands on and around a map besides names: bearings, distances, scale, legend, title, credits.

mod bearing;
mod corners;
mod distance;

use crate::boxes::Taken;
use crate::scene::{Outline, Scene, Stroke};
use crate::sheet::{BearingRing, INK, Sheet, Style};
use glam::DVec2;
use yamanami_core::LineKind;

/// What lies on the ground.
pub(crate) fn draw_over_map(scene: &mut Scene, style: &Style<'_>, sheet: &Sheet<'_>, taken: &mut Taken) {
    distance::draw_plain_ring(scene, style, sheet);
    if sheet.options.has_distance_rings {
        distance::draw(scene, style, sheet, taken);
    }
    if sheet.options.bearing == BearingRing::PlainMap {
        bearing::draw(scene, style, sheet, sheet.view.ring_px, taken);
    }
}

/// What stands around it.
pub(crate) fn draw_around_map(
    scene: &mut Scene,
    style: &Style<'_>,
    sheet: &Sheet<'_>,
    kinds: &[LineKind],
    taken: &mut Taken,
) {
    if sheet.options.has_frame {
        draw_frame(scene, style, sheet);
    }
    if sheet.options.bearing == BearingRing::Outside {
        bearing::draw(scene, style, sheet, sheet.outer_px(style), taken);
    }
    corners::draw(scene, style, sheet, kinds, taken);
}

/// A heavy and a fine line.
fn draw_frame(scene: &mut Scene, style: &Style<'_>, sheet: &Sheet<'_>) {
    let size = DVec2::new(f64::from(sheet.view.size_px[0]), f64::from(sheet.view.size_px[1]));
    for (inset_pt, width_pt) in [(8.0, 0.8), (10.4, 0.3)] {
        let low = DVec2::splat(style.pt(inset_pt));
        let high = size - low;
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        scene.stroke(vec![Outline::closed(corners)], Stroke::new(INK, style.pt(width_pt)));
    }
}
