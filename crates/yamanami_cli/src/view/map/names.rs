//! Names of summits over the picture: the most important first, each where it fits, none over another.

use super::overlay::{self, Screen, letters};
use super::settings::Settings;
use super::stage::{Stage, sight};
use eframe::egui::{Align2, Color32, Painter, Pos2, Rect, Stroke, Vec2, pos2, vec2};
use glam::{DVec2, DVec3};
use std::collections::{HashMap, HashSet};
use yamanami::core::{DeformedMap, MapView, NamedPlace, PlaceKind};
use yamanami::map::{SeenFrom, Sightline, parted_name};

/// Eyes of somebody who stands there, metres above the ground.
const EYES_M: f64 = 1.7;
/// Size of letters and marks, points.
const SIZE: f32 = 13.0;
const MARK: f32 = 3.2;
/// Room around a name, points.
const ROOM: Vec2 = vec2(3.0, 1.0);
/// A name that was shown counts so much more, so that names do not flicker.
const STAYS: f64 = 1.3;
/// No more names are tried, as a multiple of the most shown.
const TRIED: usize = 12;
/// One name is not shown twice within this distance, points.
const APART: f32 = 120.0;
const INK: Color32 = Color32::from_rgb(24, 30, 44);
const GREY: Color32 = Color32::from_rgb(120, 124, 134);
/// From a mark to its name: the corner of the name held there, and how far away, points.
const PLACES: [(Align2, Vec2); 7] = [
    (Align2::CENTER_BOTTOM, vec2(0.0, -5.0)),
    (Align2::LEFT_CENTER, vec2(6.0, 0.0)),
    (Align2::RIGHT_CENTER, vec2(-6.0, 0.0)),
    (Align2::CENTER_TOP, vec2(0.0, 5.0)),
    (Align2::CENTER_BOTTOM, vec2(0.0, -22.0)),
    (Align2::LEFT_BOTTOM, vec2(14.0, -18.0)),
    (Align2::RIGHT_BOTTOM, vec2(-14.0, -18.0)),
];

/// What is taken up by names and marks.
#[derive(Debug)]
struct Boxes {
    area: Rect,
    taken: Vec<Rect>,
}

impl Boxes {
    /// A picture where some places are taken.
    fn new(area: Rect, taken: Vec<Rect>) -> Self {
        Self { area, taken }
    }

    /// Room for a name of this size beside its mark, if there is any.
    fn find(&self, mark: Pos2, size: Vec2) -> Option<Rect> {
        let is_free = |rect: Rect| !self.taken.iter().any(|taken| taken.intersects(rect));
        let fits = |rect: &Rect| self.area.contains_rect(rect.expand2(ROOM)) && is_free(rect.expand2(ROOM));
        let places = PLACES.iter().filter(|_| is_free(around(mark)));
        places.map(|(anchor, away)| anchor.anchor_size(mark + *away, size)).find(fits)
    }

    /// Takes the room of a mark and its name.
    fn take(&mut self, mark: Pos2, name: Rect) {
        self.taken.extend([around(mark), name]);
    }
}

/// What a mark takes up.
fn around(mark: Pos2) -> Rect {
    Rect::from_center_size(mark, Vec2::splat(2.0 * MARK))
}

/// The names, from frame to frame.
#[derive(Debug, Default)]
pub(super) struct Names {
    /// Whether a place is seen, as far as it has been asked.
    seen: HashMap<usize, bool>,
    /// For which map and from where.
    asked_for: Option<(DeformedMap, bool, u32)>,
    /// Those shown last.
    shown: HashSet<usize>,
}

impl Names {
    /// Draws the names that fit beside what is taken already.
    pub(super) fn draw(
        &mut self,
        painter: &Painter,
        screen: Screen,
        stage: &Stage,
        view: &MapView,
        settings: &Settings,
        taken: Vec<Rect>,
    ) {
        self.forget_if_other(stage, view, settings);
        let mut boxes = Boxes::new(screen.rect, taken);
        let weight = |k: usize| stage.names[k].rank.unwrap_or(0.0) * if self.shown.contains(&k) { STAYS } else { 1.0 };
        let mut order: Vec<usize> =
            (0..stage.names.len()).filter(|&k| screen.rect.contains(mark(screen, stage, view, k))).collect();
        order.sort_by(|&a, &b| weight(b).total_cmp(&weight(a)).then(a.cmp(&b)));
        let mut shown = HashSet::new();
        for k in order.into_iter().take(TRIED * settings.most_names) {
            if shown.len() == settings.most_names {
                break;
            }
            let at = mark(screen, stage, view, k);
            let place = &stage.names[k];
            // first what costs least
            let galley = painter.layout_no_wrap(short(place).to_owned(), letters(SIZE), INK);
            let Some(rect) = boxes.find(at, galley.size()) else { continue };
            // several summits of one mountain
            let is_same = |&other: &usize| short(&stage.names[other]) == short(place);
            if shown.iter().filter(|k| is_same(k)).any(|&k| (mark(screen, stage, view, k) - at).length() < APART) {
                continue;
            }
            let is_seen = self.sees(stage, view, settings, k);
            if !is_seen && !settings.hidden {
                continue;
            }
            boxes.take(at, rect);
            shown.insert(k);
            draw_one(painter, at, rect, place, if is_seen { INK } else { GREY });
        }
        self.shown = shown;
    }

    /// The named place shown nearest to a place of the window, within `reach` points.
    pub(super) fn nearest(
        &mut self,
        screen: Screen,
        stage: &Stage,
        view: &MapView,
        settings: &Settings,
        at: Pos2,
        reach: f32,
    ) -> Option<String> {
        self.forget_if_other(stage, view, settings);
        let mut near: Vec<(f32, usize)> = (0..stage.names.len())
            .map(|k| ((mark(screen, stage, view, k) - at).length(), k))
            .filter(|(away, _)| *away <= reach)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (_, k) = near.into_iter().find(|&(_, k)| settings.hidden || self.sees(stage, view, settings, k))?;
        let place = &stage.names[k];
        let height = place.height_m.map(|m| format!(" {m:.0} m")).unwrap_or_default();
        Some(format!("{}{height}", place.name))
    }

    /// What hides what hangs on neither α nor the picture.
    fn forget_if_other(&mut self, stage: &Stage, view: &MapView, settings: &Settings) {
        let asked_for = Some((sight(&view.map), settings.from_ground, stage.generation));
        if self.asked_for != asked_for {
            self.seen.clear();
            if self.asked_for.is_none_or(|(.., generation)| generation != stage.generation) {
                self.shown.clear();
            }
            self.asked_for = asked_for;
        }
    }

    fn sees(&mut self, stage: &Stage, view: &MapView, settings: &Settings, k: usize) -> bool {
        *self.seen.entry(k).or_insert_with(|| {
            let from = if settings.from_ground { SeenFrom::Ground { eye_above_m: EYES_M } } else { SeenFrom::Picture };
            Sightline::new(stage.field(), view.map, from).sees(summit(stage, k))
        })
    }
}

/// The true summit.
fn summit(stage: &Stage, k: usize) -> DVec3 {
    let place = &stage.names[k];
    place.position.extend(place.height_m.unwrap_or_else(|| stage.field().height_m(place.position)))
}

/// Where it is drawn; beyond the rim nowhere.
fn mark(screen: Screen, stage: &Stage, view: &MapView, k: usize) -> Pos2 {
    let place = summit(stage, k);
    let is_drawn = (place.truncate() - view.map.centre).length() <= view.rim_m;
    let px = if is_drawn { view.px_from_plane(place) } else { DVec2::NAN };
    screen.pos(px)
}

/// The mountain without which of its summits.
fn short(place: &NamedPlace) -> &str {
    parted_name(&place.name).0
}

fn draw_one(painter: &Painter, at: Pos2, rect: Rect, place: &NamedPlace, colour: Color32) {
    let nearest = pos2(at.x.clamp(rect.left(), rect.right()), at.y.clamp(rect.top(), rect.bottom()));
    if (nearest - at).length() > 10.0 {
        painter.line_segment([at, nearest], Stroke::new(0.8, colour.gamma_multiply(0.7)));
    }
    if place.kind == PlaceKind::Summit {
        let corners = [(0.0, -MARK), (MARK, 0.8 * MARK), (-MARK, 0.8 * MARK)].map(|(x, y)| at + vec2(x, y));
        let seam = Stroke::new(0.8, Color32::from_white_alpha(200));
        painter.add(eframe::egui::Shape::convex_polygon(corners.to_vec(), colour, seam));
    } else {
        painter.circle_filled(at, 0.7 * MARK, colour);
    }
    overlay::text(painter, rect.min, Align2::LEFT_TOP, short(place), letters(SIZE), colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lie_in_the_picture_and_never_over_each_other() {
        let area = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
        let mut boxes = Boxes::new(area, Vec::new());
        let mut put = Vec::new();
        for k in 0..400u32 {
            let at = pos2((k * 37 % 400) as f32, (k * 91 % 300) as f32);
            if let Some(name) = boxes.find(at, vec2(40.0 + (k % 5) as f32 * 8.0, 14.0)) {
                boxes.take(at, name);
                put.push(name);
            }
        }
        assert!(put.len() > 15, "{} names", put.len());
        for (i, a) in put.iter().enumerate() {
            assert!(area.contains_rect(*a));
            assert!(put[..i].iter().all(|b| !a.intersects(*b)));
        }
    }
}
