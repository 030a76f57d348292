//! What lies over the picture: the frustum of a held front, compass, places, messages and help.

use eframe::egui::{self, Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Vec2, pos2, vec2};
use glam::{DVec2, DVec3, DVec4};
use yamanami::Subject;
use yamanami::core::{Perspective, Projection, View};
use yamanami::steer::{Ground, ray_through};

/// Colour of the held view's lines.
const HELD: Color32 = Color32::from_rgb(255, 196, 64);
/// Background of text over the picture.
const SHADE: Color32 = Color32::from_black_alpha(190);

/// Keys and mouse, for the help.
pub(super) const HELP: [(&str, &str); 18] = [
    ("drag left", "orbit; in flight look around"),
    ("drag right or middle", "move along the land"),
    ("wheel, pinch", "nearer to the cursor's point; in flight the pace"),
    ("double click", "fly to a point"),
    ("W A S D", "move"),
    ("Q E", "turn; in flight down and up"),
    ("shift", "faster"),
    ("F", "flight or orbit"),
    ("R", "back to the start"),
    ("C", "next colour"),
    ("L", "edges of the triangles"),
    ("G", "geomorphing"),
    ("Z", "hold the front and look at it from outside"),
    ("T", "record a path, and stop"),
    ("Y", "replay the path, and stop"),
    ("P", "picture as a PNG file"),
    ("M", "side panel"),
    ("H or F1", "this help"),
];

/// And the line under them.
pub(super) const HELP_LINE: &str = "Drop an image on the window to lay it over the land, a path (.json) to fly it.";

/// Draws the edges of a held view and where its corners meet the land.
pub(super) fn held_view(painter: &Painter, rect: Rect, view: &View, held: &View, ground: &Ground<'_>) {
    let [width, height] = held.viewport_px.map(f64::from);
    let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(|pixel| {
        let direction = ray_through(held, pixel);
        ground.hit(held.eye, direction).unwrap_or(held.eye + direction * 0.6 * ground.diagonal_m())
    });
    let line = |from: DVec3, to: DVec3, width: f32| {
        if let Some(points) = projected(view, rect, from, to) {
            painter.line_segment(points, Stroke::new(width, HELD));
        }
    };
    for (i, &corner) in corners.iter().enumerate() {
        line(held.eye, corner, 1.2);
        line(corner, corners[(i + 1) % 4], 1.8);
    }
    if let Some([eye, _]) = projected(view, rect, held.eye, held.eye + DVec3::Z * 1e-3) {
        painter.circle_filled(eye, 4.0, HELD);
    }
}

/// A line of the world on the picture, cut where it passes behind the eye.
fn projected(view: &View, rect: Rect, from: DVec3, to: DVec3) -> Option<[Pos2; 2]> {
    const NEAREST_M: f64 = 0.05;
    let projection = Perspective::new(*view, NEAREST_M, 1e7);
    let (from, to) = (projection.clip_from_world(from), projection.clip_from_world(to));
    let cut = |inside: DVec4, outside: DVec4| {
        let share = (inside.w - NEAREST_M) / (inside.w - outside.w);
        inside + (outside - inside) * share
    };
    let (from, to) = match (from.w >= NEAREST_M, to.w >= NEAREST_M) {
        (true, true) => (from, to),
        (true, false) => (from, cut(from, to)),
        (false, true) => (cut(to, from), to),
        (false, false) => return None,
    };
    let place = |clip: DVec4| {
        let ndc = DVec2::new(clip.x, clip.y) / clip.w;
        pos2(
            rect.left() + (0.5 + 0.5 * ndc.x) as f32 * rect.width(),
            rect.top() + (0.5 - 0.5 * ndc.y) as f32 * rect.height(),
        )
    };
    Some([place(from), place(to)])
}

/// A needle to the north in the upper right corner; the azimuth that points up in radians clockwise from north.
/// Gives its place.
pub(super) fn compass(painter: &Painter, rect: Rect, heading_rad: f32) -> Rect {
    let (centre, radius) = (rect.right_top() + vec2(-38.0, 38.0), 15.0);
    let north = vec2(-heading_rad.sin(), -heading_rad.cos());
    let side = vec2(-north.y, north.x) * 4.5;
    painter.circle_filled(centre, radius + 14.0, SHADE);
    let triangle = |tip: egui::Vec2, colour| {
        let points = vec![centre + tip * radius, centre + side, centre - side];
        painter.add(egui::Shape::convex_polygon(points, colour, Stroke::NONE));
    };
    triangle(north, Color32::from_rgb(226, 92, 76));
    triangle(-north, Color32::from_gray(220));
    painter.text(
        centre + north * (radius + 7.0),
        Align2::CENTER_CENTER,
        "N",
        FontId::proportional(12.0),
        Color32::WHITE,
    );
    Rect::from_center_size(centre, Vec2::splat(2.0 * (radius + 14.0)))
}

/// A line of text over the picture.
pub(super) fn line(painter: &Painter, at: Pos2, anchor: Align2, text: &str) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.5), Color32::WHITE);
    let rect = anchor.anchor_size(at, galley.size() + vec2(12.0, 6.0));
    painter.rect_filled(rect, 4.0, SHADE);
    painter.galley(rect.min + vec2(6.0, 3.0), galley, Color32::WHITE);
}

/// A place in the source's coordinates.
pub(super) fn place(subject: &impl Subject, point: DVec3) -> String {
    let DVec3 { x, y, .. } = subject.source_from_local(point);
    let Some(terrain) = subject.as_terrain() else {
        let [x, y, z] = point.to_array().map(crate::text::number);
        return format!("{x}, {y}, {z}");
    };
    if terrain.geo().crs.geographic {
        format!("{x:.5}, {y:.5}, {:.0} m", point.z)
    } else {
        format!("{x:.0}, {y:.0}, {:.0} m", point.z)
    }
}

/// The window with keys and mouse, and a line under it.
pub(super) fn help(ui: &egui::Ui, open: &mut bool, keys: &[(&str, &str)], line: &str) {
    egui::Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .show(ui, |ui| {
            egui::Grid::new("help").num_columns(2).spacing([24.0, 4.0]).show(ui, |ui| {
                for (keys, what) in keys {
                    ui.strong(*keys);
                    ui.label(*what);
                    ui.end_row();
                }
            });
            ui.separator();
            ui.label(line);
        });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_behind_the_eye() {
        let view = View { eye: DVec3::ZERO, target: DVec3::Y, fov_y_rad: 1.0, viewport_px: [200, 100] };
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(200.0, 100.0));
        let at = |from, to| projected(&view, rect, from, to);
        let [middle, _] = at(DVec3::Y * 5.0, DVec3::new(1.0, 9.0, 0.0)).unwrap();
        assert!((middle - pos2(100.0, 50.0)).length() < 1e-3);
        let [_, end] = at(DVec3::Y * 5.0, DVec3::new(0.0, -5.0, 1.0)).unwrap();
        assert!(end.y < 50.0 && end.x.is_finite(), "upwards, and cut: {end}");
        assert!(at(-DVec3::Y, -2.0 * DVec3::Y).is_none());
    }
}
