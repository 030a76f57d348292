//! The page of date's experiment: tables, figures, and what they say of the best disk width.

use super::date::{Findings, WAVELETS, excess};
use super::{KEPT_SHARES, WaveletRow, paper_fullness, write_wavelet_plots};
use crate::Error;
use crate::page::{Page, count};
use std::path::{Path, PathBuf};
use yamanami_multires::kdisk::Wavelet;

/// An L2 error within this share of the limit's counts as the same.
const SAME: f64 = 0.01;

pub(crate) fn write_page(findings: &[Findings], out: &Path) -> Result<PathBuf, Error> {
    let title = "k-disk wavelets: disk width, compression, accuracy and time";
    let mut page = Page::default();
    page.heading(1, title);
    page.text(
        "After Date, Kanai, Kishinami. Each model is analysed under every wavelet. Details above a threshold stay; C_r is the share of \
         vertices left out (9), E_MS the mean distance along the normals (10), E_MA the mean displacement of vertices and centroids \
         (11). The paper plots E_MS with signs, where hollows and bumps cancel; here the tables have both. L2 is the norm that the \
         wavelets are made for, with all triangles of a level taken as equal in area. Times are of this machine.",
    );
    page.heading(2, "Is k = 2…3 best?");
    for found in findings {
        page.text(verdict(found));
    }
    filters(findings, &mut page);
    for found in findings {
        chapter(found, out, &mut page)?;
    }
    page.write(out, "date.md", title)
}

fn best(found: &Findings) -> Option<&WaveletRow> {
    found.study.rows.iter().find(|row| row.wavelet == Wavelet::Orthogonal)
}

fn seconds(row: &WaveletRow) -> f64 {
    row.analysis_s + row.synthesis_s
}

/// What the measures say of the paper's conclusion.
fn verdict(found: &Findings) -> String {
    let title = &found.study.title;
    let Some(best) = best(found) else { return format!("{title}: the limit was not computed.") };
    let disks: Vec<(u32, &WaveletRow)> = found.study.disks().collect();
    let worst = |row: &WaveletRow| excess(row, best, |r| &r.levels).max(excess(row, best, |r| &r.shares));
    let enough = disks.iter().find(|(_, row)| worst(row) <= SAME);
    let list: Vec<String> = disks.iter().map(|(k, row)| format!("{:.2} % (k = {k})", 100.0 * worst(row))).collect();
    let lazy = found.study.rows.iter().find(|row| row.wavelet == Wavelet::Lazy);
    let lazy_text = lazy.map_or_else(String::new, |row| format!("{:.0} % (lazy), ", 100.0 * worst(row)));
    let all = format!(
        "At worst over all levels and shares kept, the L2 error exceeds the least-squares limit's by {lazy_text}{}.",
        list.join(", ")
    );
    match (enough, disks.last()) {
        (Some((k, row)), Some((widest, last))) => {
            let opinion = match k {
                2 | 3 => "the paper's 2…3 holds",
                0 | 1 => "less than the paper's 2…3 is enough",
                _ => "more than the paper's 2…3 is needed",
            };
            format!(
                "{title}: k = {k} is the least disk within {:.0} % of the limit: {opinion}. {all} Analysis and synthesis take {:.2} ms \
                 at k = {k} and {:.2} ms at k = {widest}. {}",
                100.0 * SAME,
                1e3 * seconds(row),
                1e3 * seconds(last),
                beside_lazy(found)
            )
        }
        _ => format!("{title}: no disk tried comes within {:.0} % of the limit. {all}", 100.0 * SAME),
    }
}

/// What the two-disk gains over the lazy wavelet, by kept share and by threshold.
fn beside_lazy(found: &Findings) -> String {
    let of = |wavelet| found.study.rows.iter().find(|row| row.wavelet == wavelet);
    let (Some(lazy), Some(disk)) = (of(Wavelet::Lazy), of(Wavelet::KDisk(2))) else { return String::new() };
    let less: Vec<f64> = lazy.shares.iter().zip(&disk.shares).map(|(a, b)| 100.0 * (1.0 - b.l2_m / a.l2_m)).collect();
    let (low, high) = less.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    // where next to nothing is left out, both are next to zero
    let is_rough = |n: &usize| lazy.thresholds[*n].compression_percent >= 10.0 && lazy.thresholds[*n].l2_m > 0.0;
    let nth: Vec<usize> = found.study.telling_thresholds().filter(is_rough).collect();
    let mean = |of: &dyn Fn(usize) -> f64| nth.iter().map(|&n| of(n)).sum::<f64>() / nth.len().max(1) as f64;
    let points = mean(&|n| disk.thresholds[n].compression_percent - lazy.thresholds[n].compression_percent);
    let ratio = mean(&|n| (disk.thresholds[n].l2_m / lazy.thresholds[n].l2_m).ln()).exp();
    format!(
        "Against lazy, k = 2 has {low:.0} to {high:.0} % less L2 error with as many details kept. At the same threshold C_r differs by {points:+.1} \
         points on average, and the L2 error is {ratio:.2} of lazy's (geometric mean, thresholds that leave out a tenth of the vertices or more)."
    )
}

/// The non-zeros of (13), counted.
fn filters(findings: &[Findings], page: &mut Page) {
    page.heading(2, "Non-zeros of the synthesis filter");
    page.text(
        "Rows of Q for coarse vertices (n_I) and new ones (n_N), by the paper's formula (13) and counted: the most frequent number, which is \
         that of regular surroundings where those prevail, and the mean, which borders and small levels make smaller and vertices of more \
         than six edges larger.",
    );
    let head = ["k", "n_I (13)", "n_N (13)", "model", "level", "n_I counted (mean)", "n_N counted (mean)"];
    let mut rows = Vec::new();
    for wavelet in WAVELETS {
        let Wavelet::KDisk(k) = wavelet else { continue };
        for found in findings {
            let row = found.study.rows.iter().find(|row| row.wavelet == wavelet);
            let Some(fullness) = row.and_then(|row| row.fullness) else { continue };
            let [coarse, new] = paper_fullness(k);
            let counted = |[mean, mode]: [f64; 2]| format!("{mode:.0} ({mean:.1})");
            rows.push(vec![
                k.to_string(),
                coarse.to_string(),
                new.to_string(),
                found.study.title.clone(),
                format!("{} → {}", fullness.level, fullness.level + 1),
                counted(fullness.coarse),
                counted(fullness.new),
            ]);
        }
    }
    page.table(head.map(str::to_owned).into(), rows);
}

fn chapter(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    let study = &found.study;
    page.heading(2, study.title.clone());
    let last = study.vertices.last().copied().unwrap_or(0);
    page.text(format!(
        "{} {} base triangles, {} levels, {} vertices, diagonal {:.4} m.",
        found.origin,
        count(study.base_faces as u64),
        study.split_levels,
        count(u64::from(last)),
        study.diagonal_m
    ));
    page.picture(format!("{}_levels.png", found.name), "Figure 6: levels by wavelet");
    for (file, shows) in write_wavelet_plots(study, out, &found.name)? {
        page.picture(file, shows);
    }
    page.heading(3, "Wavelets");
    let head = [
        "wavelet",
        "largest cosine",
        "reconstruction",
        "set-up (ms)",
        "analysis (ms)",
        "synthesis (ms)",
        "million vertices a second, both ways",
    ];
    let rows = study.rows.iter().map(|row| {
        vec![
            row.wavelet.to_string(),
            row.largest_cosine.map_or_else(|| "–".to_owned(), |c| format!("{c:.4}")),
            format!("{:.0e}", row.reconstruction),
            format!("{:.1}", 1e3 * row.setup_s),
            format!("{:.2}", 1e3 * row.analysis_s),
            format!("{:.2}", 1e3 * row.synthesis_s),
            format!("{:.2}", f64::from(last) / seconds(row) / 1e6),
        ]
    });
    page.table(head.map(str::to_owned).into(), rows.collect());
    kept_table(found, page);
    level_table(found, page);
    threshold_table(found, page);
    Ok(())
}

/// The largest details by what they cost: errors as shares of the diagonal.
fn kept_table(found: &Findings, page: &mut Page) {
    page.heading(3, "The largest details kept");
    page.text("Errors in thousandths of the diagonal, the details chosen by what leaving them out costs.");
    let mut head = vec!["wavelet".to_owned()];
    head.extend(KEPT_SHARES.iter().map(|s| format!("RMS, {:.0} %", 100.0 * s)));
    head.extend(KEPT_SHARES.iter().map(|s| format!("E_MA, {:.0} %", 100.0 * s)));
    let scale = 1e3 / found.study.diagonal_m;
    let rows = found.study.rows.iter().map(|row| {
        let mut cells = vec![row.wavelet.to_string()];
        cells.extend(row.shares.iter().map(|a| format!("{:.4}", scale * a.moved.rms_m)));
        cells.extend(row.shares.iter().map(|a| format!("{:.4}", scale * a.moved.mean_m)));
        cells
    });
    page.table(head, rows.collect());
    page.text(
        "The same details in the mesh without cracks, with all that they need: its vertices, and the two-sided distance of its surface \
         from the source, RMS and greatest, by samples.",
    );
    let mut head = vec!["wavelet".to_owned()];
    head.extend(KEPT_SHARES.iter().map(|s| format!("{:.0} %", 100.0 * s)));
    let rows = found.study.rows.iter().map(|row| {
        let mut cells = vec![row.wavelet.to_string()];
        cells.extend(row.shares.iter().map(|a| {
            let [rms, greatest] = a.surface.map_or([0.0; 2], |s| [s.rms_m, s.hausdorff_m]).map(|m| scale * m);
            format!("{}: {rms:.4}, {greatest:.3}", count(u64::from(a.closed_vertices)))
        }));
        cells
    });
    page.table(head, rows.collect());
}

fn level_table(found: &Findings, page: &mut Page) {
    page.heading(3, "Whole levels kept");
    page.text(
        "E_MS with signs / without, and E_MA, in thousandths of the diagonal: all details up to a level, none beyond.",
    );
    let mut head = vec!["wavelet".to_owned()];
    let levels = 0..found.study.split_levels as usize;
    head.extend(
        levels.map(|level| format!("level {level}, {} vertices", count(u64::from(found.study.vertices[level])))),
    );
    let scale = 1e3 / found.study.diagonal_m;
    let rows = found.study.rows.iter().map(|row| {
        let mut cells = vec![row.wavelet.to_string()];
        cells.extend(row.levels.iter().map(|a| {
            let m = &a.moved;
            format!("{:.3} / {:.3}, {:.3}", scale * m.signed_mean_m, scale * m.normal_mean_m, scale * m.mean_m)
        }));
        cells
    });
    page.table(head, rows.collect());
}

/// C_r at thresholds; for terrain how many vertices each wavelet needs beside lazy.
fn threshold_table(found: &Findings, page: &mut Page) {
    page.heading(3, "Thresholds");
    page.text(if found.is_terrain {
        "C_r in per cent / RMS of the heights in metres, at the same threshold."
    } else {
        "C_r in per cent / RMS displacement in thousandths of the diagonal, at the same threshold."
    });
    let mut head = vec!["threshold (m)".to_owned()];
    head.extend(found.study.rows.iter().map(|row| row.wavelet.to_string()));
    let scale = if found.is_terrain { 1.0 } else { 1e3 / found.study.diagonal_m };
    let rows = found.study.telling_thresholds().map(|nth| {
        let mut cells = vec![format!("{:.3e}", found.study.thresholds_m[nth])];
        cells.extend(found.study.rows.iter().map(|row| {
            let a = &row.thresholds[nth];
            format!("{:.1} / {:.4}", a.compression_percent, scale * a.moved.rms_m)
        }));
        cells
    });
    page.table(head, rows.collect());
}

#[cfg(test)]
mod tests {
    use crate::{DateModel, SemiRegularModel, date};
    use yamanami_testkit::{Relief, carved};

    #[test]
    fn the_page_has_its_tables_and_pictures() {
        let folder = tempfile::tempdir().unwrap();
        let model = SemiRegularModel::recognised(&carved(3, Relief::Sharp), "A ball".to_owned()).unwrap().unwrap();
        assert!(model.mesh.levels() >= 3);
        let models = vec![DateModel { name: "ball".to_owned(), origin: "Made.".to_owned(), model, is_terrain: false }];
        let page = date(models, folder.path(), &|_| ()).unwrap();
        let html = std::fs::read_to_string(page).unwrap();
        for file in html.split("src=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
            assert!(folder.path().join(file).is_file(), "{file}");
        }
        assert_eq!(html.matches("<img").count(), 6);
        assert!(html.contains("least-squares limit") && html.contains("kdisk:2"), "{html}");
    }
}
