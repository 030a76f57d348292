//! A wavelet study as text and as JSON.

use crate::failure::Failure;
use crate::{out, text};
use serde_json::{Value, json};
use yamanami::multires::kdisk::Wavelet;
use yamanami::{Approximation, KEPT_SHARES, WaveletRow, WaveletStudy, paper_fullness};

/// Tables on stdout. Where thresholds were not asked for, only those that tell something are shown.
pub(super) fn print(study: &WaveletStudy, all_thresholds: bool) -> Result<(), Failure> {
    let last = study.vertices.last().copied().unwrap_or(0);
    out::row("model", &study.title)?;
    out::row(
        "semi-regular",
        format_args!(
            "{} base triangles, {} levels, {} vertices",
            text::count(study.base_faces),
            study.split_levels,
            text::count(last)
        ),
    )?;
    out::row("diagonal", text::length_m(study.diagonal_m))?;
    out::line("")?;
    out::line(format_args!(
        "{:<12}{:>9}{:>9}{:>10}{:>11}{:>11}{:>12}{:>16}",
        "wavelet", "set-up", "analysis", "synthesis", "n_I (13)", "n_N (13)", "cosine", "reconstruction"
    ))?;
    for row in &study.rows {
        out::line(format_args!(
            "{:<12}{:>6.1} ms{:>6.1} ms{:>7.1} ms{:>11}{:>11}{:>12}{:>16.0e}",
            row.wavelet.to_string(),
            1e3 * row.setup_s,
            1e3 * row.analysis_s,
            1e3 * row.synthesis_s,
            fullness(row, 0),
            fullness(row, 1),
            row.largest_cosine.map_or_else(|| "–".to_owned(), |c| format!("{c:.4}")),
            row.reconstruction
        ))?;
    }
    out::line(
        "non-zeros of the synthesis filter: the most frequent count, and by formula (13); cosine: a wavelet with a hat",
    )?;
    out::line("\nRMS displacement with the largest details kept, thousandths of the diagonal")?;
    let scale = 1e3 / study.diagonal_m;
    head(KEPT_SHARES.iter().map(|share| format!("{:.0} %", 100.0 * share)), 10)?;
    for row in &study.rows {
        cells(&row.wavelet.to_string(), row.shares.iter().map(|a| format!("{:.4}", scale * a.moved.rms_m)), 10)?;
    }
    out::line("\ncompression rate C_r (%), and E_MA and |E_MS| (thousandths of the diagonal), by threshold")?;
    head(study.rows.iter().map(|row| row.wavelet.to_string()), 22)?;
    let shown: Vec<usize> =
        if all_thresholds { (0..study.thresholds_m.len()).collect() } else { study.telling_thresholds().collect() };
    for nth in shown {
        let cell = |row: &WaveletRow| {
            let Approximation { compression_percent, moved, .. } = row.thresholds[nth];
            format!("{compression_percent:.1} {:.4} {:.4}", scale * moved.mean_m, scale * moved.normal_mean_m)
        };
        cells(&format!("{:.3e} m", study.thresholds_m[nth]), study.rows.iter().map(cell), 22)?;
    }
    Ok(())
}

fn fullness(row: &WaveletRow, which: usize) -> String {
    let Some(counted) = row.fullness else { return "–".to_owned() };
    let [_, mode] = if which == 0 { counted.coarse } else { counted.new };
    match row.wavelet {
        Wavelet::KDisk(k) => format!("{mode:.0} ({})", paper_fullness(k)[which]),
        _ => format!("{mode:.0}"),
    }
}

fn head(names: impl Iterator<Item = String>, width: usize) -> Result<(), Failure> {
    cells("", names, width)
}

fn cells(name: &str, cells: impl Iterator<Item = String>, width: usize) -> Result<(), Failure> {
    let cells: String = cells.map(|cell| format!("{cell:>width$}")).collect();
    out::line(format_args!("{name:<14}{cells}"))
}

/// One object with an array of wavelets.
pub(super) fn json(study: &WaveletStudy) -> Result<(), Failure> {
    let rows: Vec<Value> = study.rows.iter().map(|row| row_json(study, row)).collect();
    out::json(&json!({
        "title": study.title,
        "base_faces": study.base_faces,
        "levels": study.split_levels,
        "vertices": study.vertices,
        "diagonal_m": study.diagonal_m,
        "wavelets": rows,
    }))
}

fn row_json(study: &WaveletStudy, row: &WaveletRow) -> Value {
    let all = |list: &[Approximation]| -> Vec<Value> { list.iter().map(approximation_json).collect() };
    let shares: Vec<Value> = KEPT_SHARES
        .iter()
        .zip(&row.shares)
        .map(|(share, a)| {
            let mut object = approximation_json(a);
            object["kept_share"] = json!(share);
            object
        })
        .collect();
    let vertices = f64::from(study.vertices.last().copied().unwrap_or(0));
    json!({
        "wavelet": row.wavelet.to_string(),
        "setup_s": row.setup_s,
        "analysis_s": row.analysis_s,
        "synthesis_s": row.synthesis_s,
        "vertices_per_s": vertices / (row.analysis_s + row.synthesis_s),
        "reconstruction_share_of_diagonal": row.reconstruction,
        "largest_cosine": row.largest_cosine,
        "non_zeros": row.fullness.map(|f| json!({
            "level": f.level,
            "coarse_rows": { "mean": f.coarse[0], "most_frequent": f.coarse[1] },
            "new_rows": { "mean": f.new[0], "most_frequent": f.new[1] },
        })),
        "thresholds": all(&row.thresholds),
        "kept": shares,
        "levels": all(&row.levels),
    })
}

fn approximation_json(a: &Approximation) -> Value {
    json!({
        "threshold_m": a.threshold_m,
        "vertices": a.vertices,
        "closed_vertices": a.closed_vertices,
        "compression_percent": a.compression_percent,
        "e_ms_m": a.moved.signed_mean_m,
        "e_ms_without_signs_m": a.moved.normal_mean_m,
        "e_ma_m": a.moved.mean_m,
        "rms_m": a.moved.rms_m,
        "max_m": a.moved.max_m,
        "l2_m": a.l2_m,
        "surface_rms_m": a.surface.map(|s| s.rms_m),
        "surface_hausdorff_m": a.surface.map(|s| s.hausdorff_m),
    })
}
