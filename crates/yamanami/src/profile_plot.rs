//! The picture of a section: height over the distance along its line, with the exaggeration stated.

use crate::Error;
use std::path::Path;
use yamanami_measure::plot::{Chart, Series, Style, lines};
use yamanami_measure::tin::Section;

/// Draws a section into a PNG file; `turns_m` are the distances at which its line turns.
pub fn write_profile_plot(section: &Section, title: &str, turns_m: &[f64], path: &Path) -> Result<(), Error> {
    let gap = [f64::NAN; 2];
    let run = |run: &Vec<_>| {
        let points = run.iter().map(|p: &yamanami_measure::tin::SectionPoint| [p.distance_m, p.point.z]);
        points.chain([gap]).collect::<Vec<_>>()
    };
    let surface = Series { points: section.runs.iter().flat_map(run).collect(), ..Series::default() };
    let turns = turns_m.iter().filter_map(|&turn| Some([turn, section.height_at_m(turn)?])).collect::<Vec<_>>();
    let mut series = vec![surface];
    if !turns.is_empty() {
        series[0].name = "surface".to_owned();
        series.push(Series { name: "the line turns".to_owned(), points: turns, style: Style::Points });
    }
    let chart = Chart {
        title: title.to_owned(),
        x_label: "distance along the line (m)".to_owned(),
        y_label: "height (m)".to_owned(),
        series,
        size_px: [1600, 640],
        is_section: true,
        ..Chart::default()
    };
    Ok(lines(path, &chart)?)
}
