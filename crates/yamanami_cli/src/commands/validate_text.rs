//! What `validate` prints.

use crate::failure::Failure;
use crate::{out, text};
use serde_json::{Value, json};
use yamanami::{CrackRow, ErrorRow, Severity, ValidateReport};

/// The report as JSON.
pub(super) fn json(report: &ValidateReport) -> Value {
    let findings = report.findings.iter().map(|f| {
        json!({
            "severity": f.severity.to_string(), "code": f.code, "tile": f.tile, "place": f.place,
            "expected": f.expected, "found": f.found, "count": f.count,
        })
    });
    let cracks = report.cracks.iter().map(|r| {
        json!({
            "coarse_level": r.coarse, "fine_level": r.fine, "pairs": r.pairs, "max_m": r.max_m,
            "pairs_over": r.over, "uncovered_share": r.uncovered, "worst": r.worst,
        })
    });
    let errors = report.errors.iter().map(|r| {
        json!({
            "level": r.level, "tiles": r.tiles, "declared_m": r.declared_m, "measured_m": r.measured_m, "ratio": r.ratio,
            "samples": r.samples[0], "samples_uncovered": r.samples[1], "source_max_m": r.source_m[0],
            "source_rms_m": r.source_m[1], "source_ratio": r.source_ratio, "shift_samples": r.shift,
        })
    });
    json!({
        "kind": report.kind,
        "tiles": report.tiles[0],
        "tiles_checked": report.tiles[1],
        "bytes": report.bytes,
        "triangles": report.triangles,
        "errors": report.count(Severity::Error),
        "warnings": report.count(Severity::Warning),
        "notes": report.count(Severity::Note),
        "counts": report.counts,
        "findings": findings.collect::<Vec<_>>(),
        "cracks": cracks.collect::<Vec<_>>(),
        "errors_by_level": errors.collect::<Vec<_>>(),
    })
}

/// The report as text: findings, tables, a summary.
pub(super) fn print(report: &ValidateReport) -> Result<(), Failure> {
    for finding in &report.findings {
        out::line(finding)?;
    }
    for (code, count) in report.counts.iter().filter(|(_, count)| **count > ValidateReport::SHOWN) {
        out::line(format_args!("{code}: {} more tiles not listed", text::count(count - ValidateReport::SHOWN)))?;
    }
    if !report.cracks.is_empty() {
        print_cracks(&report.cracks)?;
    }
    if !report.errors.is_empty() {
        print_errors(&report.errors)?;
    }
    let [all, looked_at] = report.tiles.map(text::count);
    let some = if report.tiles[0] == report.tiles[1] { String::new() } else { format!(", {looked_at} looked at") };
    out::line(format_args!(
        "{}: {all} tiles{some}, {} triangles, {}",
        report.kind,
        text::count(report.triangles),
        text::bytes(report.bytes)
    ))?;
    let [errors, warnings, notes] =
        [Severity::Error, Severity::Warning, Severity::Note].map(|s| text::count(report.count(s)));
    out::line(format_args!("{errors} errors, {warnings} warnings, {notes} notes"))
}

fn print_cracks(rows: &[CrackRow]) -> Result<(), Failure> {
    out::line("cracks     levels     pairs   greatest     too wide   worst at")?;
    for r in rows {
        out::line(format_args!(
            "{:>10} {:>2} and {:>2} {:>9} {:>8} m {:>12}   {:.6}, {:.6}",
            "",
            r.coarse,
            r.fine,
            text::count(r.pairs),
            text::number(r.max_m),
            text::count(r.over),
            r.worst[0],
            r.worst[1]
        ))?;
    }
    Ok(())
}

fn print_errors(rows: &[ErrorRow]) -> Result<(), Failure> {
    out::line("errors  level   tiles  declared   to finest   ratio   to source      rms   ratio  uncovered   shift")?;
    for r in rows {
        let number = |v: f64| format!("{} m", text::number(v));
        let mut line = format!(
            "{:>13} {:>7} {:>9} {:>11} {:>7}",
            r.level,
            text::count(r.tiles),
            number(r.declared_m),
            number(r.measured_m),
            text::number(r.ratio)
        );
        if r.samples[0] > 0 {
            let shift = r.shift.map_or_else(|| "?".into(), |[x, y]| format!("{x:+.3}, {y:+.3} samples"));
            line += &format!(
                " {:>11} {:>8} {:>7} {:>10}   {shift}",
                number(r.source_m[0]),
                text::number(r.source_m[1]),
                text::number(r.source_ratio),
                text::count(r.samples[1])
            );
        }
        out::line(line)?;
    }
    Ok(())
}
