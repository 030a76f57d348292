//! hori's page: tables, CSV files, plots, pictures and what they say.

mod findings;
mod modes;
mod times;

use super::peaks::PeakRow;
use super::{HoriFound, HoriGroundFound, Shown};
use crate::Error;
use crate::page::{Page, count, write_csv};
use std::path::{Path, PathBuf};
use yamanami_measure::plot::{Chart, Reference, Series, Style, lines};
use yamanami_measure::{SPLIT_PX, SigmaRow};

pub(super) fn write(found: &HoriFound, peaks: &[PeakRow], shown: &[Shown], out: &Path) -> Result<PathBuf, Error> {
    let mut page = Page::default();
    page.heading(1, "hori: level of detail of a deformed map");
    let Some((main, made)) = found.grounds.split_first() else { return page.write(out, "hori.md", "hori") };
    let map = &main.view.map;
    page.text(format!(
        "Hori, Okajima, Miyamura, Furuya, Saito: a map within {:.0} km of the centre, a panorama to {:.0} km around it, with \
         triangles whose size depends on the distance alone. Here: {}; samples every {:.0} m, {:.1} % of the disc with \
         data; eye at {:.0} m, α = {}, the plain map {:.0} px in radius in a picture of {} px.",
        map.ring_m / 1e3,
        main.view.rim_m / 1e3,
        main.title,
        main.spacing_m,
        100.0 * main.known_share,
        map.eye_m,
        map.alpha,
        main.view.ring_px,
        main.view.size_px[0]
    ));
    findings::write(found, peaks, &mut page);
    sigma(main, out, &mut page)?;
    table(main, out, &mut page)?;
    expected(main, out, &mut page)?;
    peaks_of(peaks, out, &mut page)?;
    pictures(shown, "12", &mut page);
    page.heading(2, "Figure 13: the map in full, reduced, lettered, and its mesh");
    pictures(shown, "13", &mut page);
    modes::table(main, out, &mut page)?;
    times::write(found, out, &mut page)?;
    modes::by_distance(main, out, &mut page)?;
    for ground in made {
        page.heading(2, format!("The same measure elsewhere: {}", ground.title));
        modes::table(ground, out, &mut page)?;
    }
    page.write(out, "hori.md", "hori")
}

/// The pictures of a figure.
fn pictures(shown: &[Shown], figure: &str, page: &mut Page) {
    for shown in shown.iter().filter(|shown| shown.figure == figure) {
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

fn sigma(found: &HoriGroundFound, out: &Path, page: &mut Page) -> Result<(), Error> {
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

fn table(found: &HoriGroundFound, out: &Path, page: &mut Page) -> Result<(), Error> {
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

fn expected(found: &HoriGroundFound, out: &Path, page: &mut Page) -> Result<(), Error> {
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

fn peaks_of(peaks: &[PeakRow], out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Figure 12: are peaks kept?");
    let summits = peaks.first().map_or(0, |row| row.summits.count);
    page.text(format!(
        "A mesh of 6,400 m spacing under each rule: how far all samples are from it vertically, and how {} summits of {:.0} m \
         prominence and more are drawn by the vertex that stands for them. The paper's rule raises slopes as well as \
         summits, which shows as bias; moving summits and ridges alone raises less.",
        count(summits as u64),
        super::peaks::MIN_PROMINENCE_M
    ));
    let cells = |row: &PeakRow| {
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
    let rows: Vec<_> = peaks.iter().map(cells).collect();
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
