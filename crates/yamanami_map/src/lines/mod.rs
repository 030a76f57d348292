//! Lines over the ground: where they run in the picture, and how each kind is drawn.

mod drape;
mod look;

use crate::scene::{Fill, Outline, Scene, Stroke};
use crate::sheet::{LAKE, Sheet, Style};
use drape::Drape;
use glam::{DVec2, DVec3};
use look::look_of;
use yamanami_core::LineKind;

/// Widths of lines from the plain map outwards, as shares, and up to how many ring radii each holds.
const FADING: [(f64, f64); 4] = [(1.0, 1.0), (3.0, 0.75), (8.0, 0.55), (f64::INFINITY, 0.4)];

/// In the order they are drawn.
const ORDER: [LineKind; 8] = [
    LineKind::Lake,
    LineKind::Coast,
    LineKind::River,
    LineKind::Border,
    LineKind::Other,
    LineKind::Road,
    LineKind::Railway,
    LineKind::Track,
];

/// Draws all lines; the kinds there were, in the order of the legend.
pub(crate) fn draw(
    scene: &mut Scene,
    style: &Style<'_>,
    sheet: &Sheet<'_>,
    height_m: &dyn Fn(DVec2) -> f64,
    is_visible: &dyn Fn(DVec3) -> bool,
) -> Vec<LineKind> {
    let drape = Drape { view: sheet.view, height_m, is_visible };
    let mut kinds = Vec::new();
    for kind in ORDER {
        let mut by_width: [Vec<Outline>; 4] = Default::default();
        let mut areas = Vec::new();
        for line in sheet.lines.iter().filter(|line| line.kind == kind) {
            if kind == LineKind::Lake && line.is_area {
                areas.extend(drape.area(&line.points));
            }
            for run in drape.runs(&line.points, line.is_area, &FADING) {
                by_width[run.width_class].push(Outline::open(run.points));
            }
        }
        if by_width.iter().all(Vec::is_empty) {
            continue;
        }
        kinds.push(kind);
        scene.fill(areas, Fill { colour: LAKE, opacity: 0.9 });
        for layer in look_of(kind) {
            // far ones first: near lines lie over them
            for (class, outlines) in by_width.iter().enumerate().rev() {
                scene.stroke(outlines.clone(), layer_stroke(layer, style, FADING[class].1));
            }
        }
    }
    kinds
}

fn layer_stroke(layer: &look::Layer, style: &Style<'_>, share: f64) -> Stroke {
    let px = style.pt(share);
    let stroke = Stroke::new(layer.colour, layer.width_pt * px).at_opacity(layer.opacity);
    match layer.dash_pt {
        Some([dash, gap]) => stroke.dashed(dash * px, gap * px),
        None => stroke,
    }
}

/// Draws a sample of a kind for the legend, this long from its left end: a straight line, a patch for areas.
pub(crate) fn draw_sample(scene: &mut Scene, style: &Style<'_>, kind: LineKind, left: DVec2, length_px: f64) {
    let right = left + DVec2::new(length_px, 0.0);
    let mut outline = Outline::open([left, right]);
    if kind == LineKind::Lake {
        let half = DVec2::new(0.0, style.pt(2.6));
        outline = Outline::closed([left - half, right - half, right + half, left + half]);
        scene.fill(vec![outline.clone()], Fill { colour: LAKE, opacity: 0.9 });
    }
    for layer in look_of(kind) {
        scene.stroke(vec![outline.clone()], layer_stroke(layer, style, 1.0));
    }
}
