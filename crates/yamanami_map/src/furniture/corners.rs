//! What stands in the corners: title, legend, scale bar and credits, each made smaller until the round map leaves it
//! room.

use super::distance::{bar_numbers, round_length_m};
use crate::boxes::{OrientedBox, Taken};
use crate::labels::draw_mark;
use crate::lines::draw_sample;
use crate::scene::{Anchor, Colour, Fill, Outline, Scene, Stroke};
use crate::sheet::{INK, PAPER, RUST, SOFT_INK, Sheet, SheetOptions, Style, grouped};
use glam::DVec2;
use yamanami_core::{LineKind, PlaceKind};

/// How large a block may become, tried in order; a title may be larger than the rest.
const SIZES: [f64; 9] = [1.3, 1.15, 1.0, 0.92, 0.84, 0.76, 0.68, 0.6, 0.52];
/// Size of credits, points.
const CREDIT_PT: f64 = 5.4;
/// Widest line of credits, points.
const CREDITS_PT: f64 = 190.0;

/// Steps of the bar of heights.
const BAR_STEPS: u32 = 48;

/// Shapes with their upper left corner at the origin.
struct Block {
    scene: Scene,
    size: DVec2,
}

impl Block {
    fn new() -> Self {
        Self { scene: Scene { size_px: [0, 0], paper: None, shapes: Vec::new() }, size: DVec2::ZERO }
    }
}

/// Draws all corners that are wanted.
pub(super) fn draw(scene: &mut Scene, style: &Style<'_>, sheet: &Sheet<'_>, kinds: &[LineKind], taken: &mut Taken) {
    let options = sheet.options;
    let mut put = |corner: DVec2, largest: f64, make: &dyn Fn(&Style<'_>) -> Block| {
        if let Some((block, at)) = fitted(style, sheet, corner, largest, make) {
            taken.take(OrientedBox::upright(at, block.size).grown(style.pt(3.0)));
            scene.shapes.extend(block.scene.shapes.into_iter().map(|shape| shape.moved(at)));
        }
    };
    if options.has_title {
        put(DVec2::new(0.0, 0.0), 1.3, &|style| title(style, sheet));
    }
    if options.has_legend {
        put(DVec2::new(0.0, 1.0), 1.0, &|style| legend(style, sheet, kinds));
    }
    if options.has_scale_bar || options.has_credits {
        put(DVec2::new(1.0, 1.0), 1.0, &|style| scale_and_credits(style, sheet));
    }
}

/// The block in a corner (0 or 1 across and down), as large as the round map allows, and where it goes.
fn fitted(
    style: &Style<'_>,
    sheet: &Sheet<'_>,
    corner: DVec2,
    largest: f64,
    make: &dyn Fn(&Style<'_>) -> Block,
) -> Option<(Block, DVec2)> {
    let picture = DVec2::new(f64::from(sheet.view.size_px[0]), f64::from(sheet.view.size_px[1]));
    let inset = DVec2::splat(style.pt(SheetOptions::FRAME_PT));
    let round_px = sheet.outer_px(style) + style.pt(sheet.options.bearing_pt());
    let mut last = None;
    for by in SIZES.into_iter().filter(|&size| size <= largest) {
        let block = make(&style.scaled(by));
        let at = inset + corner * (picture - 2.0 * inset - block.size);
        let inner = at + (DVec2::ONE - corner) * block.size;
        let is_clear = (inner - sheet.view.centre_px).length() >= round_px
            || (inner - sheet.view.centre_px).abs().max_element() >= round_px;
        if block.size == DVec2::ZERO {
            return None;
        }
        last = Some((block, at));
        if is_clear {
            break;
        }
    }
    last
}

fn title(style: &Style<'_>, sheet: &Sheet<'_>) -> Block {
    let mut block = Block::new();
    let mut y = 0.0;
    let mut write = |text: String, points: f64, leading: f64, colour| {
        let run = style.run(text, points, colour);
        block.size.x = block.size.x.max(style.width_px(std::slice::from_ref(&run)));
        block.scene.text(style.line(DVec2::new(0.0, y + style.pt(0.86 * points)), Anchor::Start, vec![run]));
        y += style.pt(leading);
    };
    if !sheet.title.is_empty() {
        write(sheet.title.to_owned(), 23.0, 31.0, INK);
    }
    if let Some(lon_lat) = sheet.centre_lon_lat {
        write(style.strings().lon_lat(lon_lat), 7.4, 11.5, SOFT_INK);
    }
    for line in style.strings().projection(&sheet.view.map, sheet.view.rim_m) {
        write(line, 6.6, 9.6, SOFT_INK);
    }
    block.size.y = y;
    block
}

fn legend(style: &Style<'_>, sheet: &Sheet<'_>, kinds: &[LineKind]) -> Block {
    let marks: Vec<PlaceKind> = [PlaceKind::Summit, PlaceKind::Pass, PlaceKind::Settlement, PlaceKind::Other]
        .into_iter()
        .filter(|kind| sheet.options.has_names && sheet.places.iter().any(|p| p.kind == *kind))
        .collect();
    let (row, sample) = (style.pt(10.4), style.pt(17.0));
    let rows = (kinds.len() + marks.len()) as f64 * row;
    let bar = if sheet.tint.len() > 1 { style.pt(74.0) } else { 0.0 };
    let mut block = Block::new();
    block.size.y = rows.max(bar);
    let mut x = 0.0;
    if bar > 0.0 {
        x = heights(&mut block, style, sheet, bar) + style.pt(12.0);
        block.size.x = x;
    }
    let mut y = block.size.y - rows + 0.5 * row;
    let write = |block: &mut Block, y: f64, name: &str| {
        let run = style.run(name, 6.4, INK);
        let at = DVec2::new(x + sample + style.pt(5.0), y);
        block.size.x = block.size.x.max(at.x + style.width_px(std::slice::from_ref(&run)));
        block.scene.text(style.centred(at, 0.0, Anchor::Start, vec![run]));
    };
    for &kind in kinds {
        draw_sample(&mut block.scene, style, kind, DVec2::new(x, y), sample);
        write(&mut block, y, style.strings().line_kind(kind));
        y += row;
    }
    for kind in marks {
        let colour = if kind == PlaceKind::Summit { RUST } else { INK };
        draw_mark(&mut block.scene, style, DVec2::new(x + 0.5 * sample, y), kind, colour);
        write(&mut block, y, style.strings().place_kind(kind));
        y += row;
    }
    block
}

/// The bar of colours with its numbers; gives its right end.
fn heights(block: &mut Block, style: &Style<'_>, sheet: &Sheet<'_>, height: f64) -> f64 {
    let (Some(low), Some(high)) = (sheet.tint.first(), sheet.tint.last()) else { return 0.0 };
    let range = (high.0 - low.0).max(1e-9);
    let top = block.size.y - height;
    let (head, width) = (style.pt(13.0), style.pt(7.0));
    let size_px = DVec2::new(width, height - head - style.pt(3.0));
    let corner = DVec2::new(0.0, top + head);
    let heading = style.run(style.strings().heights, 6.4, INK);
    let mut right = style.width_px(std::slice::from_ref(&heading));
    block.scene.text(style.centred(DVec2::new(0.0, top + style.pt(3.2)), 0.0, Anchor::Start, vec![heading]));
    // each colour from its height to the top, so that no seam shows between two
    for i in 0..BAR_STEPS {
        let share = f64::from(i) / f64::from(BAR_STEPS);
        let colour = tint_at(sheet.tint, low.0 + (share + 0.5 / f64::from(BAR_STEPS)) * range);
        let part = DVec2::new(width, size_px.y * (1.0 - share));
        block.scene.fill(vec![rectangle(corner, part)], Fill { colour, opacity: 1.0 });
    }
    block.scene.stroke(vec![rectangle(corner, size_px)], Stroke::new(INK, style.pt(0.25)));
    let step = 2.0 * round_length_m(range / 6.0);
    let first = (low.0 / step).ceil() as i64;
    for i in (first..).take_while(|i| *i as f64 * step <= high.0).take(12) {
        let number = i as f64 * step;
        let y = corner.y + size_px.y * (1.0 - (number - low.0) / range);
        let tick = [DVec2::new(width, y), DVec2::new(width + style.pt(1.8), y)];
        block.scene.stroke(vec![Outline::open(tick)], Stroke::new(INK, style.pt(0.3)));
        let run = style.run(grouped(number), 5.8, SOFT_INK);
        let x = width + style.pt(3.6);
        right = right.max(x + style.width_px(std::slice::from_ref(&run)));
        block.scene.text(style.centred(DVec2::new(x, y), 0.0, Anchor::Start, vec![run]));
    }
    right
}

fn rectangle(corner: DVec2, size: DVec2) -> Outline {
    let (across, down) = (DVec2::new(size.x, 0.0), DVec2::new(0.0, size.y));
    Outline::closed([corner, corner + across, corner + size, corner + down])
}

/// The colour of a height, mixed from the stops around it.
fn tint_at(tint: &[(f64, Colour)], height_m: f64) -> Colour {
    let above = tint.partition_point(|stop| stop.0 <= height_m).clamp(1, tint.len() - 1);
    let (low, high) = (tint[above - 1], tint[above]);
    let share = ((height_m - low.0) / (high.0 - low.0).max(1e-9)).clamp(0.0, 1.0);
    [0, 1, 2].map(|c| (f64::from(low.1[c]) * (1.0 - share) + f64::from(high.1[c]) * share).round() as u8)
}

fn scale_and_credits(style: &Style<'_>, sheet: &Sheet<'_>) -> Block {
    let mut block = Block::new();
    let mut lines = Vec::new();
    if sheet.options.has_credits {
        lines = sheet.credits.iter().flat_map(|credit| wrapped(style, credit, style.pt(CREDITS_PT))).collect();
    }
    let runs: Vec<_> = lines.into_iter().map(|line| style.run(line, CREDIT_PT, SOFT_INK)).collect();
    let width = runs.iter().map(|run| style.width_px(std::slice::from_ref(run))).fold(0.0, f64::max);
    let px_per_m = sheet.view.ring_px / sheet.view.map.ring_m;
    let length_m = round_length_m(style.pt(92.0).min(sheet.view.ring_px) / px_per_m);
    let caption = style.run(style.strings().plain_map, 5.8, SOFT_INK);
    let bar_px = length_m * px_per_m;
    let mut y = 0.0;
    block.size.x = width;
    if sheet.options.has_scale_bar && bar_px.is_finite() {
        let numbers_px = style.pt(18.0);
        block.size.x = width.max(bar_px + numbers_px).max(style.width_px(std::slice::from_ref(&caption)));
        let left = block.size.x - numbers_px - bar_px;
        draw_bar(&mut block.scene, style, DVec2::new(left, style.pt(9.0)), bar_px, length_m);
        let at = DVec2::new(block.size.x, style.pt(19.5));
        block.scene.text(style.centred(at, 0.0, Anchor::End, vec![caption]));
        y = style.pt(25.0);
    }
    if !runs.is_empty() && y > 0.0 {
        y += style.pt(4.0);
    }
    for run in runs {
        y += style.pt(7.6);
        let at = DVec2::new(block.size.x, y - style.pt(1.6));
        block.scene.text(style.line(at, Anchor::End, vec![run]));
    }
    block.size.y = y;
    block
}

/// A bar of four parts, filled and empty by turns, with numbers above.
fn draw_bar(scene: &mut Scene, style: &Style<'_>, at: DVec2, bar_px: f64, length_m: f64) {
    let height = style.pt(2.6);
    let size = DVec2::new(0.25 * bar_px, height);
    let part = |i: usize| rectangle(at + DVec2::new(size.x * i as f64, 0.0), size);
    scene.fill((0..4).map(part).collect(), Fill { colour: PAPER, opacity: 1.0 });
    scene.fill([0, 2].map(part).to_vec(), Fill { colour: INK, opacity: 1.0 });
    scene.stroke((0..4).map(part).collect(), Stroke::new(INK, style.pt(0.3)));
    for (share, number) in [0.0, 0.5, 1.0].into_iter().zip(bar_numbers(length_m)) {
        let run = style.run(number, 5.8, INK);
        let place = DVec2::new(at.x + share * bar_px, at.y - style.pt(2.6));
        scene.text(style.line(place, Anchor::Middle, vec![run]));
    }
}

/// A text in lines no wider than this: parted at spaces, else anywhere.
fn wrapped(style: &Style<'_>, text: &str, most_px: f64) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for c in text.chars() {
        line.push(c);
        let width_px = style.width_px(&[style.run(line.as_str(), CREDIT_PT, SOFT_INK)]);
        if width_px <= most_px || line.chars().count() == 1 {
            continue;
        }
        let part = line.rfind(' ').filter(|&at| at > 0).unwrap_or(line.len() - c.len_utf8());
        let rest = line.split_off(part);
        lines.push(std::mem::take(&mut line));
        line.push_str(rest.trim_start());
    }
    lines.extend((!line.is_empty()).then_some(line));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fonts;

    #[test]
    fn long_credits_are_parted() {
        let (options, fonts) = (SheetOptions { point_px: 1.0, ..SheetOptions::default() }, Fonts::default());
        let style = Style::new(&options, &fonts);
        assert_eq!(wrapped(&style, "short", 100.0), ["short"]);
        assert_eq!(wrapped(&style, "one two three", 32.0), ["one two", "three"]);
        assert_eq!(wrapped(&style, "国土地理院国土地理院", 5.4 * 6.0), ["国土地理院国", "土地理院"]);
        assert_eq!(wrapped(&style, "山", 1.0), ["山"]);
        assert!(wrapped(&style, "", 10.0).is_empty());
    }
}
