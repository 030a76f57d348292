//! Circles of equal distance at sea level, and the edge of the plain map.

use crate::boxes::{OrientedBox, Taken};
use crate::scene::{Anchor, Scene, Stroke};
use crate::sheet::{HALO, INK, Sheet, Style, short};
use glam::DVec2;

/// Distances that get a circle, kilometres.
const CIRCLES_KM: [f64; 12] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 150.0, 200.0, 300.0, 500.0, 1000.0];
/// Nearest two circles stand, points.
const APART_PT: f64 = 13.0;
/// Bearings, on the picture, at which a label may stand; degrees.
const LABELS_AT_DEG: [f64; 6] = [135.0, 225.0, 45.0, 315.0, 100.0, 260.0];

/// Draws the circles and their labels.
pub(super) fn draw(scene: &mut Scene, style: &Style<'_>, sheet: &Sheet<'_>, taken: &mut Taken) {
    let view = sheet.view;
    let ring = view.ring_px;
    let mut last_px = 0.0;
    for km in CIRCLES_KM.into_iter().filter(|km| km * 1000.0 <= view.rim_m) {
        let radius_px = ring * view.map.rho(km * 1000.0, 0.0);
        let is_plain_ring = km * 1000.0 == view.map.ring_m;
        let is_apart = radius_px - last_px >= style.pt(APART_PT)
            && (is_plain_ring || (radius_px - ring).abs() >= style.pt(APART_PT))
            && (radius_px > style.pt(2.0 * APART_PT));
        if !(is_apart && radius_px.is_finite()) {
            continue;
        }
        last_px = radius_px;
        if !is_plain_ring {
            scene.circle(view.centre_px, radius_px, Stroke::new(HALO, style.pt(1.0)).at_opacity(0.45));
            let dashes = Stroke::new(INK, style.pt(0.35)).at_opacity(0.75).dashed(style.pt(2.4), style.pt(1.8));
            scene.circle(view.centre_px, radius_px, dashes);
        }
        label(scene, style, sheet, km, radius_px, taken);
    }
}

fn label(scene: &mut Scene, style: &Style<'_>, sheet: &Sheet<'_>, km: f64, radius_px: f64, taken: &mut Taken) {
    let run = style.run(format!("{km} km"), 5.8, INK);
    let half = 0.5 * DVec2::new(style.width_px(std::slice::from_ref(&run)), run.size_px);
    for degrees in LABELS_AT_DEG {
        let along = DVec2::from_angle((degrees - 90.0_f64).to_radians());
        let at = sheet.view.centre_px + along * radius_px;
        // along the circle, never upside down
        let tangent = along.perp();
        let tangent = if tangent.x < 0.0 { -tangent } else { tangent };
        let angle_rad = tangent.y.atan2(tangent.x);
        let outline = OrientedBox { centre: at, half, angle_rad }.grown(style.pt(1.0));
        if taken.is_free(&outline) {
            taken.take(outline);
            let mut text = style.centred(at, angle_rad, Anchor::Middle, vec![run]);
            text.halo = Some(Stroke::new(HALO, style.pt(2.4)).at_opacity(0.8));
            return scene.text(text);
        }
    }
}

/// The edge of the plain map: a line of its own, for scale ends there.
pub(super) fn draw_plain_ring(scene: &mut Scene, style: &Style<'_>, sheet: &Sheet<'_>) {
    let (centre, radius) = (sheet.view.centre_px, sheet.view.ring_px);
    scene.circle(centre, radius, Stroke::new(HALO, style.pt(1.5)).at_opacity(0.55));
    scene.circle(centre, radius, Stroke::new(INK, style.pt(0.55)).at_opacity(0.9));
}

/// A round length that a scale bar of up to `most_m` metres may have.
pub(super) fn round_length_m(most_m: f64) -> f64 {
    let decade = 10f64.powf(most_m.max(1e-9).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|n| n * decade).find(|&length| length <= most_m).unwrap_or(decade)
}

/// Numbers under a scale bar: its start, middle and end, with the unit at the end.
pub(super) fn bar_numbers(length_m: f64) -> [String; 3] {
    let (scale, unit) = if length_m < 1000.0 { (1.0, "m") } else { (1000.0, "km") };
    let number = |m: f64| short(m / scale);
    ["0".into(), number(0.5 * length_m), format!("{} {unit}", number(length_m))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_are_round() {
        assert_eq!([999.0, 4900.0, 5000.0, 23_000.0].map(round_length_m), [500.0, 2000.0, 5000.0, 20_000.0]);
        assert_eq!(bar_numbers(5000.0), ["0", "2.5", "5 km"]);
        assert_eq!(bar_numbers(500.0), ["0", "250", "500 m"]);
    }
}
