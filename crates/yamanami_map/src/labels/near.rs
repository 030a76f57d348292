//! Names beside their marks, in and around the plain map.
//!
//! Each name tries eight places around its mark, the best liked first; the more important name chooses first. Places
//! and order follow Imhof, "Positioning names on maps", 1975, and Christensen, Marks, Shieber, "An empirical study of
//! algorithms for point-feature label placement", 1995.

use super::{Candidate, Placed};
use crate::boxes::{OrientedBox, Taken};
use crate::scene::{Anchor, Fill, Outline, Scene, Stroke};
use crate::sheet::{GREY, HALO, INK, RUST, Style};
use glam::DVec2;
use yamanami_core::PlaceKind;

/// Half the size of a mark, points.
const MARK_PT: f64 = 2.6;

/// Where a name stands: right, left, up right, down right, up left, down left, above, below.
const PLACES: [(f64, f64); 8] = [
    (1.0, 0.0),
    (1.0, -0.8),
    (1.0, 0.8),
    (-1.0, 0.0),
    (-1.0, -0.8),
    (-1.0, 0.8),
    (0.0, -1.0),
    (0.0, 1.0),
];

/// Finds places for the candidates in order.
pub(super) fn place(style: &Style<'_>, candidates: &[Candidate], taken: &mut Taken) -> Vec<Placed> {
    let mut shown = Vec::new();
    for candidate in candidates {
        let mark = OrientedBox { centre: candidate.px, half: DVec2::splat(style.pt(MARK_PT + 0.8)), angle_rad: 0.0 };
        if !taken.is_free(&mark) {
            continue;
        }
        let found = (0..candidate.lettering.forms()).find_map(|form| beside(style, candidate, form, taken));
        if let Some(placed) = found {
            taken.take(mark);
            taken.take(placed.outline.grown(style.pt(1.5)));
            shown.push(placed);
        }
    }
    shown
}

fn beside(style: &Style<'_>, candidate: &Candidate, form: usize, taken: &Taken) -> Option<Placed> {
    let runs = candidate.lettering.runs(form);
    let tallest = runs.first()?.size_px;
    let size = DVec2::new(candidate.lettering.width_px(form), 1.08 * tallest);
    PLACES.iter().find_map(|&(side, down)| {
        let off = DVec2::new(side, down) * (style.pt(MARK_PT + 1.6));
        let middle = candidate.px + off + DVec2::new(side, if side == 0.0 { down } else { 0.35 * down }) * 0.5 * size;
        let outline = OrientedBox { centre: middle, half: 0.5 * size, angle_rad: 0.0 };
        if !taken.is_free(&outline) {
            return None;
        }
        let mut text = style.centred(middle, 0.0, Anchor::Middle, runs.to_vec());
        text.halo = Some(style.halo());
        Some(Placed { place: candidate.place, is_hidden: candidate.is_hidden, outline, leader: Vec::new(), text })
    })
}

/// Draws the marks of those that are shown.
pub(super) fn draw_marks(scene: &mut Scene, style: &Style<'_>, candidates: &[Candidate], shown: &[Placed]) {
    for candidate in candidates.iter().filter(|c| shown.iter().any(|placed| placed.place == c.place)) {
        let colour = match (candidate.is_hidden, candidate.kind) {
            (true, _) => GREY,
            (_, PlaceKind::Summit) => RUST,
            _ => INK,
        };
        draw_mark(scene, style, candidate.px, candidate.kind, colour);
    }
}

/// Draws one mark: a triangle for a summit, a gap for a pass, a square for a settlement, a dot for anything else.
pub(crate) fn draw_mark(scene: &mut Scene, style: &Style<'_>, at: DVec2, kind: PlaceKind, colour: [u8; 3]) {
    let r = style.pt(MARK_PT);
    let edge = Stroke::new(HALO, style.pt(0.9));
    let polygon = |corners: &[(f64, f64)]| {
        Outline::closed(corners.iter().map(|&(x, y)| at + DVec2::new(x, y) * r).collect::<Vec<_>>())
    };
    let outline = match kind {
        PlaceKind::Summit => polygon(&[(0.0, -1.1), (1.0, 0.75), (-1.0, 0.75)]),
        PlaceKind::Settlement => polygon(&[(-0.6, -0.6), (0.6, -0.6), (0.6, 0.6), (-0.6, 0.6)]),
        PlaceKind::Pass => {
            let bow = |side: f64| {
                let points = [(1.0, -0.9), (0.45, -0.35), (0.45, 0.35), (1.0, 0.9)];
                Outline::open(points.map(|(x, y)| at + DVec2::new(side * x, y) * r))
            };
            scene.stroke(vec![bow(1.0), bow(-1.0)], Stroke::new(HALO, style.pt(2.0)));
            return scene.stroke(vec![bow(1.0), bow(-1.0)], Stroke::new(colour, style.pt(0.8)));
        }
        _ => polygon(&[
            (0.0, -0.6),
            (0.42, -0.42),
            (0.6, 0.0),
            (0.42, 0.42),
            (0.0, 0.6),
            (-0.42, 0.42),
            (-0.6, 0.0),
            (-0.42, -0.42),
        ]),
    };
    scene.stroke(vec![outline.clone()], edge);
    scene.fill(vec![outline], Fill { colour, opacity: 1.0 });
}
