//! Draws a chart into memory.

use super::axis::{Axis, is_drawable};
use super::{Chart, Series, Style};
use image::RgbImage;
use plotters::prelude::*;
use plotters::style::FontFamily;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::sync::Once;

/// Charts are drawn this many times as large, then reduced.
const OVERSAMPLING: u32 = 2;
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];
pub(super) const INK: RGBColor = RGBColor(38, 38, 38);
const GRID: RGBColor = RGBColor(226, 226, 226);

type Failure = Box<dyn std::error::Error>;

/// The font of all texts.
pub(super) fn font(size: i32) -> FontDesc<'static> {
    static REGISTERED: Once = Once::new();
    const NAME: &str = "DejaVu Sans of yamanami";
    // a font that could not be read would show as an error when text is drawn
    REGISTERED.call_once(|| {
        let _ = plotters::style::register_font(NAME, FontStyle::Normal, dejavu::sans::regular());
    });
    FontDesc::new(FontFamily::Name(NAME), f64::from(size), FontStyle::Normal)
}

pub(super) fn picture(chart: &Chart) -> Result<RgbImage, Failure> {
    let size = chart.size_px.map(|s| s.clamp(240, 8192));
    let [width, height] = size.map(|s| s * OVERSAMPLING);
    let mut pixels = vec![255; (width * height * 3) as usize];
    {
        let root = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        draw(chart, &root, OVERSAMPLING as i32)?;
        root.present()?;
    }
    let large = RgbImage::from_raw(width, height, pixels).ok_or("the picture has another size")?;
    Ok(image::imageops::resize(&large, size[0], size[1], image::imageops::FilterType::Triangle))
}

type Area<'a> = DrawingArea<BitMapBackend<'a>, plotters::coord::Shift>;

/// `px` is the number of drawn pixels to one of the picture.
fn draw(chart: &Chart, root: &Area<'_>, px: i32) -> Result<(), Failure> {
    root.fill(&WHITE)?;
    let width = root.dim_in_pixel().0 as i32;
    let mut top = 12 * px;
    if !chart.title.is_empty() {
        let middle = Pos::new(HPos::Center, VPos::Top);
        let style = font(22 * px).color(&INK).pos(middle);
        root.draw(&Text::new(chart.title.clone(), (width / 2, top), style))?;
        top += 34 * px;
    }
    top = legend(chart, root, top, px)?;

    let values = |k: usize| {
        let log = [chart.x_log, chart.y_log];
        let points = chart.series.iter().flat_map(|s| &s.points);
        points.filter(move |p| is_drawable(p[0], log[0]) && is_drawable(p[1], log[1])).map(move |p| p[k])
    };
    let x_axis = Axis::exact(values(0), chart.x_log);
    let reference = chart.reference.as_ref().map(|r| r.y).filter(|&y| is_drawable(y, chart.y_log));
    let zero = (chart.y_from_zero && !chart.y_log).then_some(0.0);
    let y_axis = Axis::roomy(values(1).chain(reference).chain(zero), chart.y_log, !chart.is_section);
    let [left, right] = x_axis.ends();

    let mut context = ChartBuilder::on(&root.margin(top, 12 * px, 12 * px, 28 * px))
        .x_label_area_size(52 * px)
        .y_label_area_size(96 * px)
        .build_cartesian_2d(x_axis, y_axis)?;
    let x_label = match exaggeration(chart, &context) {
        Some(times) => format!("{}; heights are drawn {times} times as tall", chart.x_label),
        None => chart.x_label.clone(),
    };
    context
        .configure_mesh()
        .axis_style(INK.stroke_width(px as u32))
        .bold_line_style(GRID.stroke_width(px as u32))
        .light_line_style(TRANSPARENT)
        .label_style(font(14 * px).color(&INK))
        .axis_desc_style(font(16 * px).color(&INK))
        .set_all_tick_mark_size(5 * px)
        .x_desc(x_label)
        .y_desc(&chart.y_label)
        .draw()?;
    for (series, colour) in chart.series.iter().zip(COLOURS.iter().cycle()) {
        let drawable = |p: &[f64; 2]| is_drawable(p[0], chart.x_log) && is_drawable(p[1], chart.y_log);
        let stroke = colour.stroke_width(2 * px as u32);
        for run in series.points.split(|p| !drawable(p)) {
            let run = run.iter().map(|&[x, y]| (x, y));
            match series.style {
                Style::Line | Style::LineAndPoints => {
                    context.draw_series(LineSeries::new(run.clone(), stroke))?;
                }
                Style::Dashed => {
                    context.draw_series(DashedLineSeries::new(run.clone(), 8 * px, 5 * px, stroke))?;
                }
                Style::Points => {}
            }
            if matches!(series.style, Style::Points | Style::LineAndPoints) {
                context.draw_series(run.map(|point| Circle::new(point, dot(series, px), colour.filled())))?;
            }
        }
    }
    if let Some(y) = reference {
        let style = INK.stroke_width(px as u32 * 3 / 2);
        let dashes = DashedLineSeries::new([(left, y), (right, y)], 10 * px, 7 * px, style);
        context.draw_series(dashes)?;
    }
    Ok(())
}

/// How much taller than wide a unit is drawn, in words, where the chart is to say so.
fn exaggeration(
    chart: &Chart,
    context: &ChartContext<'_, BitMapBackend<'_>, Cartesian2d<Axis, Axis>>,
) -> Option<String> {
    let linear = !(chart.x_log || chart.y_log);
    let area = context.plotting_area();
    let (width, height) = area.dim_in_pixel();
    let [left, right] = area.as_coord_spec().x_spec().ends();
    let [low, high] = area.as_coord_spec().y_spec().ends();
    let times = (f64::from(height) / (high - low)) / (f64::from(width) / (right - left));
    (chart.is_section && linear && times.is_finite()).then(|| {
        let digits = (2.0 - times.log10()).clamp(0.0, 6.0) as usize;
        format!("{times:.digits$}")
    })
}

/// Radius of a dot: smaller where there are many.
fn dot(series: &Series, px: i32) -> i32 {
    if series.points.len() > 400 { px * 3 / 2 } else { px * 7 / 2 }
}

/// Draws samples and names of all lines, in rows between title and chart; gives the height where the chart may begin.
fn legend(chart: &Chart, root: &Area<'_>, top: i32, px: i32) -> Result<i32, Failure> {
    let named = chart.series.iter().zip(COLOURS.iter().cycle()).map(|(s, &colour)| (s.name.as_str(), s.style, colour));
    let reference = chart.reference.iter().map(|r| (r.name.as_str(), Style::Dashed, INK));
    let entries: Vec<_> = named.chain(reference).filter(|(name, ..)| !name.is_empty()).collect();
    let style = font(15 * px).color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    let (sample, gap, line_height) = (30 * px, 26 * px, 24 * px);
    let width = root.dim_in_pixel().0 as i32 - 48 * px;

    // for each row its length, and where in it each entry starts
    let mut rows: Vec<(i32, Vec<(i32, usize)>)> = Vec::new();
    for (k, entry) in entries.iter().enumerate() {
        let length = sample + 8 * px + root.estimate_text_size(entry.0, &style)?.0 as i32;
        match rows.last_mut() {
            Some((end, row)) if *end + gap + length <= width => {
                row.push((*end + gap, k));
                *end += gap + length;
            }
            _ => rows.push((length, vec![(0, k)])),
        }
    }
    let mut y = top + line_height / 2;
    for (length, row) in &rows {
        let left = 24 * px + (width - length).max(0) / 2;
        for &(at, k) in row {
            let (name, line, colour) = entries[k];
            let (from, to) = (left + at, left + at + sample);
            let stroke = colour.stroke_width(2 * px as u32);
            match line {
                Style::Line | Style::LineAndPoints => root.draw(&PathElement::new([(from, y), (to, y)], stroke))?,
                Style::Dashed => {
                    for start in [from, from + 12 * px, from + 24 * px] {
                        root.draw(&PathElement::new([(start, y), ((start + 8 * px).min(to), y)], stroke))?;
                    }
                }
                Style::Points => {}
            }
            if matches!(line, Style::Points | Style::LineAndPoints) {
                root.draw(&Circle::new(((from + to) / 2, y), px * 7 / 2, colour.filled()))?;
            }
            root.draw(&Text::new(name.to_owned(), (to + 8 * px, y), style.clone()))?;
        }
        y += line_height;
    }
    Ok(if rows.is_empty() { top } else { y - line_height / 2 + 6 * px })
}
