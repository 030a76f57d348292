//! What lies over the picture: distance rings, bearings, lines, pins.

use eframe::egui::{self, Align2, Color32, FontFamily, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};
use glam::{DVec2, DVec3};
use yamanami::core::{LineKind, MapLine, MapView, NestedField};
use yamanami::map::HorizonTable;

/// Rings nearer to each other than this are left out, points.
const RING_ROOM: f32 = 26.0;
/// Distances of rings: these and their tens.
const RING_STEPS: [f64; 3] = [1.0, 2.0, 5.0];
/// Rings and bearings, and what lifts letters off the ground.
const RING: Color32 = Color32::from_rgba_premultiplied(40, 44, 60, 90);
const INK: Color32 = Color32::from_rgb(24, 30, 44);
const HALO: Color32 = Color32::from_rgba_premultiplied(225, 228, 232, 225);
const PIN: Color32 = Color32::from_rgb(204, 42, 54);
/// Lines are drawn through places no nearer than this, points.
const LINE_STEP: f32 = 1.5;
/// Lines that lie this far below the horizon before them are still drawn, metres.
const LINE_SLACK_M: f64 = 60.0;

/// The font of names.
pub(super) fn letters(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name(LETTERS.into()))
}

/// Its family.
pub(super) const LETTERS: &str = "letters of the map";

/// Where the picture lies in the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screen {
    /// Its place, points.
    pub(super) rect: Rect,
    /// Points in a pixel.
    pub(super) per_px: f32,
}

impl Screen {
    /// A picture of this size shown here.
    pub(super) fn new(rect: Rect, size_px: [u32; 2]) -> Self {
        Self { rect, per_px: rect.width() / size_px[0].max(1) as f32 }
    }

    /// A place of the picture in the window.
    pub(super) fn pos(&self, px: DVec2) -> Pos2 {
        self.rect.min + self.per_px * vec2(px.x as f32, px.y as f32)
    }

    /// A place of the window in the picture.
    pub(super) fn px(&self, at: Pos2) -> DVec2 {
        self.px_of(at - self.rect.min)
    }

    /// A way in the window as pixels.
    pub(super) fn px_of(&self, way: egui::Vec2) -> DVec2 {
        DVec2::new(f64::from(way.x), f64::from(way.y)) / f64::from(self.per_px)
    }
}

/// Dark letters on a light seam; gives the place they take.
pub(super) fn text(painter: &Painter, at: Pos2, anchor: Align2, text: &str, font: FontId, colour: Color32) -> Rect {
    let galley = painter.layout_no_wrap(text.to_owned(), font, colour);
    let rect = anchor.anchor_size(at, galley.size());
    for (dx, dy) in [
        (-1.0, 0.0),
        (1.0, 0.0),
        (0.0, -1.0),
        (0.0, 1.0),
        (-0.8, -0.8),
        (0.8, -0.8),
        (-0.8, 0.8),
        (0.8, 0.8),
    ] {
        painter.galley_with_override_text_color(rect.min + 1.2 * vec2(dx, dy), galley.clone(), HALO);
    }
    painter.galley(rect.min, galley, colour);
    rect
}

/// Rings of equal distance at sea level; gives the places of their letters.
pub(super) fn rings(painter: &Painter, screen: Screen, view: &MapView) -> Vec<Rect> {
    let mut taken = Vec::new();
    let centre = screen.pos(view.centre_px);
    let radius = |r_m: f64| (view.ring_px * view.map.rho(r_m, 0.0)) as f32 * screen.per_px;
    let mut last = 0.0;
    for power in 2..7 {
        for step in RING_STEPS {
            let r_m = step * 10f64.powi(power);
            let here = radius(r_m);
            if r_m > view.rim_m || here - last < RING_ROOM {
                continue;
            }
            last = here;
            painter.circle_stroke(centre, here, Stroke::new(1.0, RING));
            let label = if r_m < 1000.0 { format!("{r_m:.0} m") } else { format!("{:.0} km", r_m / 1e3) };
            taken.push(text(painter, centre + vec2(0.0, here), Align2::CENTER_CENTER, &label, letters(11.0), INK));
        }
    }
    // the plain map's own border
    painter.circle_stroke(centre, radius(view.map.ring_m), Stroke::new(1.4, RING));
    taken
}

/// Letters of the bearings around the map; gives their places.
pub(super) fn bearings(painter: &Painter, screen: Screen, view: &MapView, top_m: f64) -> Vec<Rect> {
    let centre = screen.pos(view.centre_px);
    let rho = view.map.rho(view.rim_m, top_m).max(view.map.rho(view.rim_m, 0.0));
    let radius = (view.ring_px * rho) as f32 * screen.per_px + 10.0;
    let room = screen.rect.shrink(14.0);
    let names = ["N", "NE", "E", "SE", "S", "SW", "W", "NW"].into_iter().enumerate();
    let put = names.filter(|_| room.contains(centre)).map(|(k, name)| {
        let azimuth = k as f64 * std::f64::consts::FRAC_PI_4 - view.up_azimuth_rad;
        let towards = vec2(azimuth.sin() as f32, -azimuth.cos() as f32);
        // where the rim lies outside of the window, at the window's border
        let way = |towards: f32, min: f32, max: f32, from: f32| {
            let end = if towards > 0.0 { max } else { min };
            if towards.abs() < 1e-6 { f32::INFINITY } else { (end - from) / towards }
        };
        let across = way(towards.x, room.left(), room.right(), centre.x);
        let at = centre + towards * radius.min(across).min(way(towards.y, room.top(), room.bottom(), centre.y));
        let size = if k % 2 == 0 { 15.0 } else { 11.0 };
        text(painter, at, Align2::CENTER_CENTER, name, letters(size), if k == 0 { PIN } else { INK })
    });
    put.collect()
}

/// A pinned place.
pub(super) fn pin(painter: &Painter, at: Pos2) {
    let head = at - vec2(0.0, 14.0);
    painter.line_segment([at, head], Stroke::new(2.0, PIN));
    painter.circle(head, 4.5, PIN, Stroke::new(1.2, Color32::WHITE));
    painter.circle_filled(at, 1.6, PIN);
}

/// Lines on the ground, where the picture shows the ground they lie on.
pub(super) fn lines(
    painter: &Painter,
    screen: Screen,
    view: &MapView,
    lines: &[MapLine],
    field: &NestedField,
    horizon: &HorizonTable,
) {
    for line in lines {
        let stroke = stroke(line.kind);
        let mut run: Vec<Pos2> = Vec::new();
        let closing = line.points.first().filter(|_| line.is_area);
        for &p in line.points.iter().chain(closing) {
            let place: DVec3 = p.extend(field.height_m(p));
            let is_shown = p.is_finite()
                && (p - view.map.centre).length() <= view.rim_m
                && horizon.sees(&view.map, place, LINE_SLACK_M);
            let at = screen.pos(view.px_from_plane(place));
            if !is_shown || !at.is_finite() {
                flush(painter, &mut run, stroke);
            } else if run.last().is_none_or(|last| (at - *last).length() >= LINE_STEP) {
                run.push(at);
            }
        }
        flush(painter, &mut run, stroke);
    }
}

fn flush(painter: &Painter, run: &mut Vec<Pos2>, stroke: Stroke) {
    let run = std::mem::take(run);
    if run.len() > 1 && Rect::from_points(&run).intersects(painter.clip_rect()) {
        painter.add(Shape::line(run, stroke));
    }
}

fn stroke(kind: LineKind) -> Stroke {
    let (width, [r, g, b]) = match kind {
        LineKind::Coast | LineKind::Lake => (1.0, [44, 96, 150]),
        LineKind::River => (1.1, [66, 128, 186]),
        LineKind::Road => (1.2, [176, 112, 56]),
        LineKind::Railway => (1.2, [70, 66, 78]),
        LineKind::Track => (2.4, [204, 42, 54]),
        LineKind::Border => (1.0, [130, 96, 140]),
        _ => (1.0, [90, 90, 90]),
    };
    Stroke::new(width, Color32::from_rgb(r, g, b))
}

/// A readout beside the cursor.
pub(super) fn readout(painter: &Painter, rect: Rect, text: &str) {
    super::super::overlay::line(painter, pos2(rect.left() + 8.0, rect.bottom() - 8.0), Align2::LEFT_BOTTOM, text);
}
