//! What a flight's frames say, as a table, as a summary and as JSON.

use crate::failure::Failure;
use crate::{out, text};
use serde_json::{Value, json};
use yamanami::{FlightSummary, FrameStats, summary};

/// About so many rows of the table are printed.
const ROWS: usize = 24;

/// The frames as JSON. The paper's control knows no error on the screen: its top threshold in metres stands instead.
pub(crate) fn frames_json(frames: &[FrameStats], paper: bool) -> Value {
    let frame = |f: &FrameStats| {
        let mut value = json!(f);
        if let (true, Value::Object(map)) = (paper, &mut value) {
            let top = map.remove("error_px");
            map.insert("top_threshold_m".to_owned(), json!(top));
        }
        value
    };
    Value::Array(frames.iter().map(frame).collect())
}

/// The middle and the worst of a flight as JSON.
pub(crate) fn summary_json(frames: &[FrameStats], paper: bool) -> Value {
    let mut value = json!(summary(frames));
    if let Value::Object(map) = &mut value {
        if paper {
            map.remove("error_px_max");
        }
        map.insert("frames_per_s".to_owned(), json!(frames_per_s(frames)));
    }
    value
}

/// Frames a second, all work counted.
pub(crate) fn frames_per_s(frames: &[FrameStats]) -> f64 {
    let ms: f64 = frames.iter().map(|f| f.update_ms + f.upload_ms + f.draw_ms).sum();
    if ms > 0.0 { frames.len() as f64 * 1e3 / ms } else { 0.0 }
}

/// Prints every so many frames: `every`, or about two dozen rows.
pub(crate) fn print_table(frames: &[FrameStats], every: Option<usize>, paper: bool) -> Result<(), Failure> {
    let error = if paper { "top f (m)" } else { "error px" };
    out::line(format_args!(
        "{:>6} {:>10} {:>8} {:>8} {:>10} {:>10} {:>9} {:>8} {error:>9}  bound by",
        "frame", "triangles", "refined", "undone", "update ms", "upload KiB", "upload ms", "draw ms"
    ))?;
    let every = every.unwrap_or(frames.len() / ROWS).max(1);
    for (i, f) in frames.iter().enumerate().filter(|(i, _)| i % every == 0 || i + 1 == frames.len()) {
        out::line(format_args!(
            "{i:>6} {:>10} {:>8} {:>8} {:>10.3} {:>10.1} {:>9.3} {:>8.2} {:>9}  {}",
            f.triangles,
            f.refined,
            f.coarsened,
            f.update_ms,
            f.upload_bytes as f64 / 1024.0,
            f.upload_ms,
            f.draw_ms,
            text::number(f64::from(f.error_px)),
            f.limited_by
        ))?;
    }
    Ok(())
}

/// Prints the middle and the worst.
pub(crate) fn print_summary(frames: &[FrameStats], budget: Option<u32>, paper: bool) -> Result<(), Failure> {
    let s: FlightSummary = summary(frames);
    let of = budget.map_or_else(String::new, |n| format!(" of a budget of {}", text::count(n)));
    let (median, most) = (text::count(s.triangles_median as u64), text::count(s.triangles_max as u64));
    out::row("triangles", format_args!("{median} in the middle, {most} at most{of}"))?;
    if !paper {
        let px = text::number(f64::from(s.error_px_max));
        out::row("error", format_args!("never above {px} px"))?;
    }
    out::row(
        "update",
        format_args!(
            "{} ms a frame, worst {} ms; {} details changed",
            text::number(s.update_ms_median),
            text::number(s.update_ms_max),
            text::count(s.changed_median as u64)
        ),
    )?;
    out::row(
        "upload",
        format_args!("{}, {} ms a frame", text::bytes(s.upload_bytes_median), text::number(s.upload_ms_median)),
    )?;
    let waiting = frames.iter().filter(|f| f.limited_by == "residency").count();
    if waiting > 0 {
        out::row("pages", format_args!("{waiting} frames were coarser than asked for while pages were read"))?;
    }
    if s.draw_ms_median > 0.0 {
        out::row(
            "draw",
            format_args!(
                "{} ms a frame; {} frames a second with all",
                text::number(s.draw_ms_median),
                text::number(frames_per_s(frames))
            ),
        )?;
    }
    Ok(())
}

/// The same flight by differences and by rebuilding.
#[derive(Debug)]
pub(crate) struct Comparison {
    pub(crate) differences: Vec<FrameStats>,
    pub(crate) rebuild: Vec<FrameStats>,
}

impl Comparison {
    /// Median milliseconds of update and upload together, and median bytes written. The first frame builds all it shows
    /// either way and is left out.
    fn medians(frames: &[FrameStats]) -> (f64, u64) {
        let rest = frames.get(1..).filter(|f| !f.is_empty()).unwrap_or(frames);
        let mut ms: Vec<f64> = rest.iter().map(|f| f.update_ms + f.upload_ms).collect();
        let mut bytes: Vec<u64> = rest.iter().map(|f| f.upload_bytes).collect();
        ms.sort_unstable_by(f64::total_cmp);
        bytes.sort_unstable();
        let middle = rest.len() / 2;
        (ms.get(middle).copied().unwrap_or(0.0), bytes.get(middle).copied().unwrap_or(0))
    }

    fn ratio(&self) -> f64 {
        Self::medians(&self.rebuild).0 / Self::medians(&self.differences).0.max(1e-9)
    }

    pub(crate) fn to_json(&self) -> Value {
        let side = |frames: &[FrameStats]| {
            let (ms, bytes) = Self::medians(frames);
            json!({ "update_and_upload_ms_median": ms, "upload_bytes_median": bytes })
        };
        json!({
            "differences": side(&self.differences),
            "rebuild": side(&self.rebuild),
            "rebuild_over_differences": self.ratio(),
        })
    }

    pub(crate) fn print(&self) -> Result<(), Failure> {
        for (name, frames) in [("differences", &self.differences), ("rebuild", &self.rebuild)] {
            let (ms, bytes) = Self::medians(frames);
            out::row(name, format_args!("{} ms and {} written a frame", text::number(ms), text::bytes(bytes)))?;
        }
        out::row(
            "",
            format_args!(
                "differences are {} times as fast (finding the front is not counted against the rebuild)",
                text::number(self.ratio())
            ),
        )
    }
}
