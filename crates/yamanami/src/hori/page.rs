//! hori's page: tables, CSV files, plots and what they say.

use super::modes::Mode;
use super::{Findings, PAPER_TRIANGLES};
use crate::Error;
use crate::page::{Page, count, write_csv};
use std::path::{Path, PathBuf};
use yamanami_measure::plot::{Chart, Reference, Series, Style, lines};
use yamanami_measure::{DistanceBin, LARGE_PX, SPLIT_PX, SigmaRow};

/// Most points of figure 14.
const MOST_POINTS: usize = 6_000;

pub(super) fn write(found: &Findings, out: &Path) -> Result<PathBuf, Error> {
    let mut page = Page::default();
    page.heading(1, "hori: level of detail of a deformed map");
    let map = &found.view.map;
    page.text(format!(
        "Hori, Okajima, Miyamura, Furuya, Saito: a map within {:.0} km of the centre, a panorama to {:.0} km around it, with \
         triangles whose size depends on the distance alone. Here: {}; samples every {:.0} m, {:.1} % of the disc with \
         data; eye at {:.0} m, α = {}, the plain map {:.0} px in radius in a picture of {} px.",
        map.ring_m / 1e3,
        found.view.rim_m / 1e3,
        found.title,
        found.spacing_m,
        100.0 * found.known_share,
        map.eye_m,
        map.alpha,
        found.view.ring_px,
        found.view.size_px[0]
    ));
    sigma(found, out, &mut page)?;
    table(found, out, &mut page)?;
    expected(found, out, &mut page)?;
    peaks(found, out, &mut page)?;
    pictures(found, "12", &mut page);
    polygons(found, out, &mut page)?;
    pictures(found, "13", &mut page);
    by_distance(found, out, &mut page)?;
    page.write(out, "hori.md", "hori")
}

/// The pictures of a figure.
fn pictures(found: &Findings, figure: &str, page: &mut Page) {
    for shown in found.pictures.iter().filter(|shown| shown.figure == figure) {
        page.picture(shown.file.clone(), shown.caption.clone());
    }
}

fn texts<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).into()
}

fn km(m: f64) -> String {
    let text = format!("{:.3}", m / 1e3);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn sigma(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Figure 9: the slopes that a size of triangle hides");
    let tables = &found.tables;
    page.text(format!(
        "σ(a), the root of the mean square of E = 2d/a, over a square of 40 km, the roughest of the map ({:.0} km east and \
         {:.0} km north of the centre), and over all of it. The paper's falls with a, since heights have a limit.",
        tables.square.x / 1e3,
        tables.square.y / 1e3
    ));
    let series = |name: &str, rows: &[SigmaRow]| Series {
        name: name.to_owned(),
        points: rows.iter().map(|row| [row.hypotenuse_m / 1e3, row.sigma]).collect(),
        style: Style::LineAndPoints,
    };
    lines(
        out.join("fig9.png"),
        &Chart {
            title: "Figure 9: σ of hypotenuses".to_owned(),
            x_label: "hypotenuse (km)".to_owned(),
            y_label: "σ of E = 2d/a".to_owned(),
            series: vec![series("roughest 40 km square", &tables.rough), series("whole map", &tables.all)],
            x_log: true,
            y_from_zero: true,
            ..Chart::default()
        },
    )?;
    page.picture("fig9.png", "σ by hypotenuse");
    let all = |row: &SigmaRow| tables.all.iter().find(|other| other.hypotenuse_m == row.hypotenuse_m);
    let cells = |row: &SigmaRow| {
        let whole = all(row).map_or(String::new(), |r| format!("{:.4}", r.sigma));
        vec![km(row.hypotenuse_m), format!("{:.4}", row.sigma), whole]
    };
    let rows: Vec<_> = tables.rough.iter().map(cells).collect();
    write_csv(&out.join("fig9.csv"), "hypotenuse_km,sigma_rough,sigma_all", &rows)?;
    page.table(texts(["hypotenuse (km)", "σ, roughest square", "σ, whole map"]), rows);
    Ok(())
}

fn table(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Table 1: bands of distance");
    let mut csv = Vec::new();
    for (name, table) in [
        ("As the paper prints it", &found.tables.printed),
        ("By its rule, on this ground", &found.tables.measured),
        ("By its rule, counting what the projection bends as well", &found.tables.bent),
    ] {
        let cells = |band: &yamanami_lod::Band| {
            vec![
                format!("{:.1} to {:.1}", band.near_m / 1e3, band.far_m / 1e3),
                km(band.hypotenuse_m),
                band.level.to_string(),
                count(band.triangles().round() as u64),
            ]
        };
        page.heading(3, name);
        page.table(
            texts(["distance (km)", "hypotenuse (km)", "level", "triangles by area"]),
            table.bands.iter().map(cells).collect(),
        );
        let (blocks, triangles) = table.triangles_by_blocks(yamanami_multires::rtin::band_mesh::PAPER_REACH_M);
        page.text(format!(
            "{} triangles by area; {} in {} whole blocks, before neighbours are joined.",
            count(table.triangles_by_area().round() as u64),
            count(triangles),
            count(blocks)
        ));
        csv.extend(table.bands.iter().map(|band| {
            let numbers = [band.near_m, band.far_m, band.hypotenuse_m].map(|v| format!("{v:.1}"));
            [vec![format!("\"{name}\"")], numbers.into(), vec![band.level.to_string()]].concat()
        }));
    }
    write_csv(&out.join("table1.csv"), "table,near_m,far_m,hypotenuse_m,level", &csv)
}

fn expected(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Figure 11: the error that the rule expects");
    page.text(
        "e by distance: how far the picture moves when the height that the triangles there typically hide, (a/2)·σ(a) in the \
         roughest square, is left out. The rule splits at 1.5 px. The paper says \"the error at the middle of the hypotenuse\": \
         with the middle as drawn, the bend of the projection counts too, the greater part near the ring on gentle ground.",
    );
    let [printed, measured, bent] = &found.tables.expected;
    let series = |name: &str, points: &[[f64; 2]]| Series {
        name: name.to_owned(),
        points: points.iter().map(|&[r_m, px]| [r_m / 1e3, px]).collect(),
        style: Style::Line,
    };
    lines(
        out.join("fig11.png"),
        &Chart {
            title: "Figure 11: expected error by distance".to_owned(),
            x_label: "distance from the centre (km)".to_owned(),
            y_label: "e (px)".to_owned(),
            series: vec![
                series("table 1 as printed", printed),
                series("table measured here", measured),
                series("with bend", bent),
            ],
            reference: Some(Reference { name: "split at 1.5 px".to_owned(), y: SPLIT_PX }),
            y_from_zero: true,
            ..Chart::default()
        },
    )?;
    page.picture("fig11.png", "Expected error by distance");
    let rows: Vec<_> = printed
        .iter()
        .zip(measured)
        .zip(bent)
        .map(|((p, m), b)| {
            [vec![format!("{:.0}", p[0])], [p[1], m[1], b[1]].map(|px| format!("{px:.4}")).into()].concat()
        })
        .collect();
    write_csv(&out.join("fig11.csv"), "distance_m,printed_px,measured_px,with_bend_px", &rows)
}

fn peaks(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Figure 12: are peaks kept?");
    let summits = found.peaks.first().map_or(0, |row| row.summits.count);
    page.text(format!(
        "A mesh of 6,400 m spacing under each rule: how far all samples are from it vertically, and how {} summits of {:.0} m \
         prominence and more are drawn by the vertex that stands for them. The paper's rule raises slopes as well as \
         summits, which shows as bias; moving summits and ridges alone raises less.",
        count(summits as u64),
        super::peaks::MIN_PROMINENCE_M
    ));
    let cells = |row: &super::peaks::PeakRow| {
        let s = &row.summits;
        let mut cells = vec![row.rule.to_owned(), row.triangles.to_string()];
        let metres = [
            row.height_rms_m,
            row.height_bias_m,
            s.height_rms_m,
            s.lowest_m,
            s.shift_mean_m,
            s.shift_max_m,
        ];
        cells.extend(metres.map(|m| format!("{m:.0}")));
        cells
    };
    let rows: Vec<_> = found.peaks.iter().map(cells).collect();
    let csv: Vec<_> = rows.iter().map(|row| [vec![format!("\"{}\"", row[0])], row[1..].to_vec()].concat()).collect();
    let names = "rule,triangles,height_rms_m,height_bias_m,summit_rms_m,summit_lowest_m,shift_mean_m,shift_max_m";
    write_csv(&out.join("fig12.csv"), names, &csv)?;
    page.table(
        texts([
            "rule",
            "triangles",
            "height RMS (m)",
            "bias (m)",
            "summits: RMS (m)",
            "lowest (m)",
            "mean shift (m)",
            "most (m)",
        ]),
        rows,
    );
    Ok(())
}

fn polygons(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Figure 13: polygons and true errors");
    let [full, reduced] = PAPER_TRIANGLES;
    page.text(format!(
        "The paper: {} polygons in full, {} by its table, 1/{:.1}. Errors are true ones: of every sample with data between \
         ring and rim, how far it is drawn from its place, in pixels.",
        count(full),
        count(reduced),
        full as f64 / reduced as f64
    ));
    let cells = |mode: &Mode| {
        let (triangles, far) = (mode.mesh.triangles.len() as u64, &mode.report.far);
        let mut cells = vec![mode.name.to_owned(), count(mode.full), count(triangles)];
        cells.push(format!("1/{:.1}", mode.full as f64 / triangles.max(1) as f64));
        cells.extend([far.max_px, far.p999_px, far.p99_px, far.rms_px].map(|px| format!("{px:.2}")));
        cells.extend([far.over_split, far.over_large].map(|share| format!("{:.3} %", 100.0 * share)));
        cells.push(format!("{:.1}", mode.report.height_bias_m));
        cells.push(mode.summits.map_or("–".to_owned(), |s| format!("{:.0}", s.height_rms_m)));
        cells
    };
    page.table(
        texts([
            "mode",
            "in full",
            "triangles",
            "ratio",
            "greatest (px)",
            "99.9 % (px)",
            "99 % (px)",
            "RMS (px)",
            "over 1.5 px",
            "over 3.5 px",
            "height bias (m)",
            "summits: RMS (m)",
        ]),
        found.modes.iter().map(cells).collect(),
    );
    if let Some(mode) = found.modes.first() {
        let (far, all) = (&mode.report.far, &mode.report.all);
        page.text(format!(
            "{} samples lie between ring and rim, {} more within the ring; {} to the rim are not drawn, as the disc is one of \
             whole blocks.",
            count(far.samples as u64),
            count((all.samples - far.samples) as u64),
            count(mode.report.uncovered as u64)
        ));
    }
    let csv: Vec<_> = found
        .modes
        .iter()
        .map(|mode| {
            let far = &mode.report.far;
            let counts = [mode.full, mode.mesh.triangles.len() as u64, far.samples as u64].map(|n| n.to_string());
            let errors = [far.max_px, far.p999_px, far.p99_px, far.rms_px, far.over_split, far.over_large];
            [
                vec![format!("\"{}\"", mode.name)],
                counts.into(),
                errors.map(|v| format!("{v:.6}")).into(),
            ]
            .concat()
        })
        .collect();
    let names =
        "mode,full_triangles,triangles,samples,max_px,p999_px,p99_px,rms_px,share_over_1_5_px,share_over_3_5_px";
    write_csv(&out.join("fig13.csv"), names, &csv)
}

fn by_distance(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Figure 14: errors of 3.5 px and more by distance");
    let points = |mode: &Mode| -> Vec<[f64; 2]> {
        let step = mode.report.large.len().div_ceil(MOST_POINTS).max(1);
        mode.report.large.iter().step_by(step).map(|&[r_m, px]| [r_m / 1e3, px]).collect()
    };
    for mode in &found.modes {
        let file = format!("fig14_{}.png", mode.file);
        let series = vec![
            Series { name: mode.name.to_owned(), points: points(mode), style: Style::Points },
            Series { name: "greatest in 5 km".to_owned(), points: of_bins(mode, |bin| bin.max_px), style: Style::Line },
        ];
        let reference = Some(Reference { name: "3.5 px".to_owned(), y: LARGE_PX });
        chart(&out.join(&file), "Figure 14: errors of 3.5 px and more", "error (px)", series, reference)?;
        let within = mode.report.large.iter().filter(|point| point[0] <= 40_000.0).count();
        let large = mode.report.large.len();
        page.picture(
            file,
            format!(
                "{}: {} samples, {:.0} % of them within 40 km",
                mode.name,
                count(large as u64),
                100.0 * within as f64 / large.max(1) as f64
            ),
        );
    }
    let bins = |value: fn(&DistanceBin) -> f64| -> Vec<Series> {
        let series = |mode: &Mode| Series {
            name: mode.name.to_owned(),
            points: of_bins(mode, value),
            style: Style::LineAndPoints,
        };
        found.modes.iter().map(series).collect()
    };
    let share = bins(|bin| 100.0 * bin.large as f64 / bin.samples.max(1) as f64);
    chart(&out.join("fig14_share.png"), "Samples of 3.5 px and more", "share of samples (%)", share, None)?;
    chart(&out.join("fig14_rms.png"), "RMS error by distance", "RMS error (px)", bins(|bin| bin.rms_px), None)?;
    page.picture("fig14_share.png", "Share of samples with errors of 3.5 px and more, in bins of 5 km");
    page.picture("fig14_rms.png", "RMS error in bins of 5 km");
    let rows = found.modes.iter().flat_map(|mode| {
        mode.report.bins.iter().map(|bin| {
            let mut cells = vec![format!("\"{}\"", mode.name)];
            cells.extend([bin.near_m, bin.far_m].map(|m| format!("{m:.0}")));
            cells.extend([bin.samples.to_string(), bin.large.to_string()]);
            cells.extend([bin.max_px, bin.rms_px].map(|px| format!("{px:.4}")));
            cells
        })
    });
    write_csv(&out.join("fig14.csv"), "mode,near_m,far_m,samples,large,max_px,rms_px", &rows.collect::<Vec<_>>())
}

/// A value of each bin over its middle, km.
fn of_bins(mode: &Mode, value: fn(&DistanceBin) -> f64) -> Vec<[f64; 2]> {
    let bins = mode.report.bins.iter().filter(|bin| bin.samples > 0);
    bins.map(|bin| [0.5e-3 * (bin.near_m + bin.far_m), value(bin)]).collect()
}

fn chart(
    path: &Path,
    title: &str,
    y_label: &str,
    series: Vec<Series>,
    reference: Option<Reference>,
) -> Result<(), Error> {
    lines(
        path,
        &Chart {
            title: title.to_owned(),
            x_label: "distance from the centre (km)".to_owned(),
            y_label: y_label.to_owned(),
            series,
            y_from_zero: true,
            reference,
            ..Chart::default()
        },
    )?;
    Ok(())
}
