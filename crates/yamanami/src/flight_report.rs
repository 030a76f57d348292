//! What a flight's numbers say: a summary for people, and plots.

use crate::{Error, FrameStats};
use serde::Serialize;
use std::path::{Path, PathBuf};
use yamanami_measure::plot::{Chart, Reference, Series, lines};

/// The middle and the worst of a flight.
#[derive(Debug, Clone, Serialize)]
pub struct FlightSummary {
    /// Frames flown.
    pub frames: usize,
    /// Median of triangles.
    pub triangles_median: usize,
    /// Most triangles of any frame.
    pub triangles_max: usize,
    /// Median of nodes applied and undone a frame.
    pub changed_median: usize,
    /// Median update time, milliseconds.
    pub update_ms_median: f64,
    /// Worst update time after the first frame, milliseconds.
    pub update_ms_max: f64,
    /// Median upload time, milliseconds.
    pub upload_ms_median: f64,
    /// Median bytes written a frame.
    pub upload_bytes_median: u64,
    /// Median draw time, milliseconds.
    pub draw_ms_median: f64,
    /// Worst error of any frame, pixels.
    pub error_px_max: f32,
}

/// Sums a flight up. The first frame, which builds all it shows, counts for triangles only.
pub fn summary(frames: &[FrameStats]) -> FlightSummary {
    let rest = frames.get(1..).filter(|r| !r.is_empty()).unwrap_or(frames);
    FlightSummary {
        frames: frames.len(),
        triangles_median: median(frames.iter().map(|f| f.triangles)).unwrap_or(0),
        triangles_max: frames.iter().map(|f| f.triangles).max().unwrap_or(0),
        changed_median: median(rest.iter().map(|f| f.refined + f.coarsened)).unwrap_or(0),
        update_ms_median: median_f64(rest.iter().map(|f| f.update_ms)),
        update_ms_max: rest.iter().map(|f| f.update_ms).fold(0.0, f64::max),
        upload_ms_median: median_f64(rest.iter().map(|f| f.upload_ms)),
        upload_bytes_median: median(rest.iter().map(|f| f.upload_bytes)).unwrap_or(0),
        draw_ms_median: median_f64(rest.iter().map(|f| f.draw_ms)),
        error_px_max: frames.iter().map(|f| f.error_px).fold(0.0, f32::max),
    }
}

fn median<T: Ord + Copy>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut v: Vec<T> = values.collect();
    v.sort_unstable();
    v.get(v.len() / 2).copied()
}

fn median_f64(values: impl Iterator<Item = f64>) -> f64 {
    let mut v: Vec<f64> = values.collect();
    v.sort_unstable_by(f64::total_cmp);
    v.get(v.len() / 2).copied().unwrap_or(0.0)
}

/// Draws `triangles.png`, `time.png`, `upload.png` and `error.png` of a flight into a folder; gives their paths.
pub fn write_flight_plots(
    frames: &[FrameStats],
    budget: Option<u32>,
    title: &str,
    folder: &Path,
) -> Result<Vec<PathBuf>, Error> {
    let chart = |name: &str, y_label: &str, y_log: bool, series: Vec<Series>, reference: Option<Reference>| {
        let path = folder.join(format!("{name}.png"));
        let chart = Chart {
            title: format!("{title}: {name}"),
            x_label: "frame".to_owned(),
            y_label: y_label.to_owned(),
            series,
            y_log,
            y_from_zero: !y_log,
            reference,
            ..Chart::default()
        };
        lines(&path, &chart).map(|()| path)
    };
    let of = |name: &str, value: fn(&FrameStats) -> f64| Series::of_values(name, frames.iter().map(value));
    Ok(vec![
        chart(
            "triangles",
            "triangles",
            false,
            vec![of("shown", |f| f.triangles as f64)],
            budget.map(|n| Reference { name: "budget".to_owned(), y: f64::from(n) }),
        )?,
        chart(
            "time",
            "time (ms)",
            true,
            vec![of("update", |f| f.update_ms), of("upload", |f| f.upload_ms), of("draw", |f| f.draw_ms)],
            None,
        )?,
        chart("upload", "written (bytes)", true, vec![of("upload", |f| f.upload_bytes as f64)], None)?,
        chart(
            "error",
            "largest error left (px; staircase: m)",
            false,
            vec![of("error", |f| f64::from(f.error_px))],
            None,
        )?,
    ])
}
