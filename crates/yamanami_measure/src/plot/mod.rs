//! Line charts as PNG files: title, labelled axes, legend, the same picture on every machine.
//!
//! Charts are drawn at twice their size and reduced, for smooth lines. The font (DejaVu Sans) is part of the program.
//! Colours after Okabe, Ito, "Color universal design", 2008: told apart with any colour vision.

mod axis;
mod draw;
mod sheet;

pub use sheet::{Sheet, SheetRow, sheet};

use crate::MeasureError;
use std::path::Path;

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// A line through the points.
    #[default]
    Line,
    /// A broken line through the points.
    Dashed,
    /// Dots only.
    Points,
    /// A line through dots.
    LineAndPoints,
}

/// One named run of points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// The points, x and y, in drawing order. Where one is not finite, or not above zero on a logarithmic axis, the
    /// line is interrupted.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub style: Style,
}

impl Series {
    /// A line of values over their numbers 0, 1, 2, …
    pub fn of_values(name: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        let points = values.into_iter().enumerate().map(|(i, y)| [i as f64, y]).collect();
        Self { name: name.into(), points, style: Style::Line }
    }
}

/// A horizontal line that values are held against: a budget, a tolerance.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Name in the legend.
    pub name: String,
    /// Where it lies on the y axis.
    pub y: f64,
}

/// What a chart shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Title above the chart.
    pub title: String,
    /// Label of the x axis, with its unit: `frame`, `distance (m)`.
    pub x_label: String,
    /// Label of the y axis, with its unit.
    pub y_label: String,
    /// The lines, drawn in order.
    pub series: Vec<Series>,
    /// Width and height in pixels; kept between 240 and 8192.
    pub size_px: [u32; 2],
    /// Logarithmic x axis.
    pub x_log: bool,
    /// Logarithmic y axis.
    pub y_log: bool,
    /// A linear y axis that holds zero whatever the values.
    pub y_from_zero: bool,
    /// A section: both axes are lengths, so that the x label goes on to say how much taller than wide a unit is drawn, and y
    /// need not reach zero.
    pub is_section: bool,
    /// A horizontal line that values are held against.
    pub reference: Option<Reference>,
}

impl Default for Chart {
    fn default() -> Self {
        Self {
            title: String::new(),
            x_label: String::new(),
            y_label: String::new(),
            series: Vec::new(),
            size_px: [1200, 720],
            x_log: false,
            y_log: false,
            y_from_zero: false,
            is_section: false,
            reference: None,
        }
    }
}

/// Draws a chart into a PNG file.
pub fn lines(path: impl AsRef<Path>, chart: &Chart) -> Result<(), MeasureError> {
    let path = path.as_ref();
    let failed = |why: String| MeasureError::Chart { path: path.to_owned(), title: chart.title.clone(), why };
    let picture = draw::picture(chart).map_err(|e| failed(e.to_string()))?;
    picture.save_with_format(path, image::ImageFormat::Png).map_err(|e| failed(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let wave = |k: f64| (0..200).map(move |i| 4000.0 + k * (f64::from(i) * 0.1).sin());
        Chart {
            title: "Triangles per frame".into(),
            x_label: "frame".into(),
            y_label: "triangles".into(),
            series: vec![Series::of_values("no budget", wave(3000.0)), Series::of_values("budget", wave(900.0))],
            reference: Some(Reference { name: "budget 5,000".into(), y: 5000.0 }),
            ..Chart::default()
        }
    }

    fn drawn(chart: &Chart) -> image::RgbImage {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chart.png");
        lines(&path, chart).unwrap();
        image::open(&path).unwrap().to_rgb8()
    }

    #[test]
    fn a_chart_has_its_size_its_lines_and_its_texts() {
        let picture = drawn(&chart());
        assert_eq!(picture.dimensions(), (1200, 720));
        let like = |colour: [u8; 3]| {
            picture.pixels().filter(|p| p.0.iter().zip(colour).all(|(a, b)| a.abs_diff(b) < 24)).count()
        };
        assert!(like([0, 114, 178]) > 500 && like([213, 94, 0]) > 500, "both lines");
        // where the title stands, there is ink
        let title = image::imageops::crop_imm(&picture, 0, 0, 1200, 50).to_image();
        assert!(title.pixels().any(|p| p.0[0] < 100));
        let mut untitled = chart();
        untitled.title.clear();
        assert_ne!(drawn(&untitled), picture);
    }

    #[test]
    fn equal_charts_are_equal_pictures() {
        assert_eq!(drawn(&chart()), drawn(&chart()));
    }

    #[test]
    fn the_exaggeration_is_stated_where_it_is_asked_for() {
        let stated = Chart { is_section: true, ..chart() };
        assert_ne!(drawn(&stated), drawn(&chart()));
    }

    #[test]
    fn odd_data_make_a_chart_all_the_same() {
        let odd = [[1.0, f64::NAN], [f64::INFINITY, 2.0], [3.0, -1.0], [0.0, 0.0]];
        for (points, log) in [(vec![], false), (vec![], true), (odd.to_vec(), false), (odd.to_vec(), true)] {
            for style in [Style::Line, Style::Dashed, Style::Points, Style::LineAndPoints] {
                let series = vec![Series { name: "odd".into(), points: points.clone(), style }];
                let size_px = [0, 9];
                drawn(&Chart { series, x_log: log, y_log: log, size_px, ..Chart::default() });
            }
        }
        let huge = Series { points: vec![[0.0, -1e308], [1e-300, 1e308]], ..Series::default() };
        drawn(&Chart { series: vec![huge], size_px: [300, 300], ..Chart::default() });
        let same = Series { points: vec![[5.0, 7.0]; 3], ..Series::default() };
        drawn(&Chart { series: vec![same], size_px: [300, 300], ..Chart::default() });
    }

    #[test]
    fn a_chart_that_cannot_be_written_says_where() {
        let line = lines("absent/folder/chart.png", &chart()).unwrap_err().to_string();
        assert!(line.starts_with("absent/folder/chart.png: chart 'Triangles per frame': "), "{line}");
    }
}
