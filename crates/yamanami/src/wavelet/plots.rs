//! Plots of a wavelet study: the paper's figure 7, figure 10 and the times.

use super::{Approximation, KEPT_SHARES, WaveletRow, WaveletStudy, paper_fullness};
use crate::Error;
use std::path::Path;
use yamanami_measure::plot::{Chart, Reference, Series, Style, lines};
use yamanami_multires::kdisk::Wavelet;

/// Accuracy is plotted from this compression rate on, per cent: below it errors fall to nothing.
const LEAST_PLOTTED_PERCENT: f64 = 5.0;

/// A plot: its file's name, and what it shows.
pub(crate) type Plot = (String, String);

/// Draws all plots into a folder, their names beginning with `name`.
pub fn write_wavelet_plots(study: &WaveletStudy, out: &Path, name: &str) -> Result<Vec<(String, String)>, Error> {
    let mut plots = Vec::new();
    compression(study, out, name, &mut plots)?;
    accuracy(study, out, name, &mut plots)?;
    beside_orthogonal(study, out, name, &mut plots)?;
    times(study, out, name, &mut plots)?;
    Ok(plots)
}

fn draw(out: &Path, file: String, chart: Chart, plots: &mut Vec<Plot>) -> Result<(), Error> {
    lines(out.join(&file), &chart)?;
    plots.push((file, chart.title));
    Ok(())
}

fn series(study: &WaveletStudy, points: impl Fn(&WaveletRow) -> Vec<[f64; 2]>) -> Vec<Series> {
    let style = |wavelet| match wavelet {
        Wavelet::KDisk(_) => Style::Line,
        _ => Style::Dashed,
    };
    study
        .rows
        .iter()
        .map(|row| Series { name: row.wavelet.to_string(), points: points(row), style: style(row.wavelet) })
        .collect()
}

/// Figure 7: what a threshold leaves out.
fn compression(study: &WaveletStudy, out: &Path, name: &str, plots: &mut Vec<Plot>) -> Result<(), Error> {
    let nth: Vec<usize> = study.telling_thresholds().collect();
    let at = |a: &Approximation| Some([a.threshold_m?, a.compression_percent]);
    draw(
        out,
        format!("{name}_compression.png"),
        Chart {
            title: format!("Figure 7, {}: compression", study.title),
            x_label: "threshold of the details (m)".to_owned(),
            y_label: "data compression rate C_r (%)".to_owned(),
            series: series(study, |row| nth.iter().filter_map(|&n| at(&row.thresholds[n])).collect()),
            x_log: true,
            y_from_zero: true,
            ..Chart::default()
        },
        plots,
    )
}

/// Figure 10 over the vertices kept: mean displacement, and distance along the normals.
fn accuracy(study: &WaveletStudy, out: &Path, name: &str, plots: &mut Vec<Plot>) -> Result<(), Error> {
    let mut plot = |file: &str, what: &str, label: &str, measure: fn(&Approximation) -> f64| {
        draw(
            out,
            format!("{name}_{file}.png"),
            Chart {
                title: format!("Figure 10, {}: {what}", study.title),
                x_label: "vertices kept (%)".to_owned(),
                y_label: label.to_owned(),
                series: series(study, |row| {
                    let rough = row.thresholds.iter().filter(|a| a.compression_percent >= LEAST_PLOTTED_PERCENT);
                    rough.map(|a| [100.0 - a.compression_percent, measure(a)]).collect()
                }),
                x_log: true,
                y_log: true,
                ..Chart::default()
            },
            plots,
        )
    };
    plot("e_ma", "mean displacement", "E_MA (m)", |a| a.moved.mean_m)?;
    plot("e_ms", "distance along the normals", "E_MS without signs (m)", |a| a.moved.normal_mean_m)
}

/// The error of each disk width as a multiple of the least-squares limit's.
fn beside_orthogonal(study: &WaveletStudy, out: &Path, name: &str, plots: &mut Vec<Plot>) -> Result<(), Error> {
    let Some(best) = study.rows.iter().find(|row| row.wavelet == Wavelet::Orthogonal) else { return Ok(()) };
    let by_disk = |of: &dyn Fn(&WaveletRow) -> f64| -> Vec<[f64; 2]> {
        study.disks().map(|(k, row)| [f64::from(k), of(row) / of(best)]).collect()
    };
    let mut all = Vec::new();
    for level in 0..best.levels.len() {
        let name = format!("levels up to {level}");
        all.push(Series { name, points: by_disk(&|row| row.levels[level].l2_m), style: Style::LineAndPoints });
    }
    for (nth, share) in KEPT_SHARES.iter().enumerate() {
        let name = format!("largest {:.0} %", 100.0 * share);
        all.push(Series { name, points: by_disk(&|row| row.shares[nth].l2_m), style: Style::Dashed });
    }
    draw(
        out,
        format!("{name}_width.png"),
        Chart {
            title: format!("{}: accuracy by disk width", study.title),
            x_label: "disk width k (edges)".to_owned(),
            y_label: "L2 error, multiple of orthogonal".to_owned(),
            series: all,
            reference: Some(Reference { name: "orthogonal".to_owned(), y: 1.0 }),
            ..Chart::default()
        },
        plots,
    )
}

/// Times by disk width beside the count (14) of the filter's non-zeros, which is scaled to the synthesis at the widest disk.
fn times(study: &WaveletStudy, out: &Path, name: &str, plots: &mut Vec<Plot>) -> Result<(), Error> {
    let disks: Vec<(u32, &WaveletRow)> = study.disks().collect();
    let Some(&(widest, last)) = disks.last() else { return Ok(()) };
    let work = |k: u32| {
        let [coarse, new] = paper_fullness(k);
        let count = |pair: &[u32]| u64::from(pair[0]) * coarse + u64::from(pair[1] - pair[0]) * new;
        study.vertices.windows(2).map(count).sum::<u64>() as f64
    };
    let scale = 1e3 * last.synthesis_s / work(widest);
    let points =
        |of: &dyn Fn(u32, &WaveletRow) -> f64| disks.iter().map(|&(k, row)| [f64::from(k), of(k, row)]).collect();
    let one = |name: &str, points, style| Series { name: name.to_owned(), points, style };
    draw(
        out,
        format!("{name}_time.png"),
        Chart {
            title: format!("{}: time by disk width", study.title),
            x_label: "disk width k (edges)".to_owned(),
            y_label: "time for all three coordinates (ms)".to_owned(),
            series: vec![
                one("analysis", points(&|_, row| 1e3 * row.analysis_s), Style::LineAndPoints),
                one("synthesis", points(&|_, row| 1e3 * row.synthesis_s), Style::LineAndPoints),
                one("non-zeros (14), scaled", points(&|k, _| scale * work(k)), Style::Dashed),
            ],
            y_from_zero: true,
            ..Chart::default()
        },
        plots,
    )
}
