//! A ring of bearings: ticks, numbers every 30°, the four winds.

use crate::boxes::{OrientedBox, Taken};
use crate::scene::{Anchor, Fill, Outline, Scene, Shape, Stroke};
use crate::sheet::{BearingRing, HALO, INK, RUST, SOFT_INK, Sheet, Style};
use glam::DVec2;
use std::f64::consts::PI;

/// Draws the ring: outside, ticks and numbers stand outwards; around the plain map they are light and stand inwards.
pub(super) fn draw(scene: &mut Scene, style: &Style<'_>, sheet: &Sheet<'_>, radius_px: f64, taken: &mut Taken) {
    let is_outside = sheet.options.bearing == BearingRing::Outside;
    let way = if is_outside { 1.0 } else { -1.0 };
    let centre = sheet.view.centre_px;
    let out = |bearing_deg: f64| {
        let turned = bearing_deg.to_radians() - sheet.view.up_azimuth_rad;
        DVec2::new(turned.sin(), -turned.cos())
    };
    let ticks = |step: usize, not: usize, points: f64| -> Vec<Outline> {
        let bearings = (0..360).step_by(step).filter(|b| b % not != 0);
        bearings
            .map(|b| {
                let along = out(b as f64);
                Outline::open([centre + along * radius_px, centre + along * (radius_px + way * style.pt(points))])
            })
            .collect()
    };
    let line = |width_pt: f64| Stroke::new(INK, style.pt(width_pt));
    if is_outside {
        scene.circle(centre, radius_px, line(0.5));
        scene.circle(centre, radius_px + style.pt(3.0), line(0.25));
        scene.stroke(ticks(1, 5, 1.4), line(0.2));
    }
    scene.stroke(ticks(5, 10, if is_outside { 3.0 } else { 1.6 }), line(0.3));
    scene.stroke(ticks(10, 30, if is_outside { 3.0 } else { 2.6 }), line(0.5));
    scene.stroke(ticks(30, 360, if is_outside { 4.6 } else { 3.6 }), line(0.6));
    if is_outside {
        draw_north(scene, style, centre, out(0.0), radius_px);
    }
    for number in (0..360).step_by(30) {
        let cardinal = (number % 90 == 0).then(|| style.strings().cardinals[number / 90]);
        let run = match cardinal {
            Some(letter) => style.run(letter, 9.4, if number == 0 { RUST } else { INK }),
            None => style.run(format!("{number}°"), 6.2, SOFT_INK),
        };
        let along = out(number as f64);
        let at = centre + along * (radius_px + way * style.pt(if is_outside { 9.6 } else { 8.0 }));
        let upright = along.x.atan2(-along.y);
        let angle = if upright.abs() > 0.5 * PI + 1e-9 { upright - PI } else { upright };
        let half = 0.5 * DVec2::new(style.width_px(std::slice::from_ref(&run)), run.size_px);
        let mut text = style.centred(at, angle, Anchor::Middle, vec![run]);
        if !is_outside {
            text.halo = Some(Stroke::new(HALO, style.pt(1.6)).at_opacity(0.7));
        }
        scene.text(text);
        taken.take(OrientedBox { centre: at, half, angle_rad: angle });
    }
}

/// A small triangle at the ring that points north.
fn draw_north(scene: &mut Scene, style: &Style<'_>, centre: DVec2, north: DVec2, radius_px: f64) {
    let foot = centre + north * radius_px;
    let side = north.perp() * style.pt(2.2);
    let outlines = vec![Outline::closed([foot + side, foot - side, foot + north * style.pt(4.6)])];
    scene.shapes.push(Shape::Outlines { outlines, fill: Some(Fill { colour: RUST, opacity: 1.0 }), stroke: None });
}
