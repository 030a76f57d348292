//! mizuno's page: tables, plots, contact sheets, and whether 50 polygons a pixel hold.

use crate::mizuno::{Findings, OnDisplay, PAPER_K, Rung, STYLES};
use crate::mizuno_sheet::{k_name, write_sheet};
use crate::page::{Page, count};
use crate::{Error, LookLimits, POLYGONS_PER_PIXEL};
use std::path::{Path, PathBuf};
use yamanami_measure::ModelDifference;
use yamanami_measure::plot::{Chart, Reference, Series, Style, lines};

/// The paper's covered pixels, display by display.
const PAPER_PIXELS: [([u32; 2], u64); 4] = [
    ([1920, 1080], 156_072),
    ([1600, 900], 109_441),
    ([1280, 720], 68_004),
    ([800, 600], 36_616),
];

/// A least k within this factor of 50 is taken for 50.
const NEAR: f64 = 1.5;

pub(crate) fn write_page(findings: &[Findings], out: &Path) -> Result<PathBuf, Error> {
    let mut page = Page::default();
    page.heading(1, "mizuno: how many polygons does a pixel need?");
    page.text(
        "Mizuno, Okumoto, Takata, Joe: a scanned building is reduced to k times the pixels that it covers on a display; by \
         eye, 50 times was the least without a visible loss. Here the same steps are run on the models below, from one \
         view, the side that it does not see taken away as in the paper, and the pictures are held against those of the \
         source by FLIP (67 pixels a degree), SSIM and PSNR over the covered pixels.",
    );
    let limits = LookLimits::default();
    page.text(format!(
        "Pictures count as looking the same when the mean FLIP is at most {}, one pixel in a hundred at most exceeds {}, and \
         the mean SSIM is at least {}; or when they differ by no more than pictures of the source itself before and after a \
         move by an eighth of a pixel, which nobody sees.",
        limits.flip_mean, limits.flip_p99, limits.ssim
    ));
    for found in findings {
        chapter(found, out, &mut page)?;
    }
    page.write(out, "mizuno.md", "mizuno")
}

fn name_of(display: &OnDisplay) -> String {
    format!("{} × {}", display.size_px[0], display.size_px[1])
}

fn chapter(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, found.title.clone());
    page.text(format!(
        "{} faces, {} of them on the side that is seen. Only those are counted below.",
        count(found.source_faces as u64),
        count(found.seen_faces as u64)
    ));
    page.text(verdict(found));
    table_1(found, page);
    curves(found, out, page)?;
    for display in &found.displays {
        measures(display, found, page);
    }
    page.heading(3, "Table 2: parts, enlarged");
    for display in &found.displays {
        let [width, height] = display.size_px;
        let file = format!("parts_{}_{width}x{height}.png", found.name);
        let title = format!("{}, {}: polygons a pixel", found.title, name_of(display));
        write_sheet(display, &title, &out.join(&file))?;
        page.picture(file, title);
    }
    Ok(())
}

fn table_1(found: &Findings, page: &mut Page) {
    page.heading(3, "Table 1: polygons for each display");
    let mut head = vec!["display".to_owned(), "pixels in the paper".to_owned(), "pixels here".to_owned()];
    head.extend(PAPER_K.iter().map(|&k| k_name(k)));
    head.push("looks the same from".to_owned());
    let row = |display: &OnDisplay| {
        let paper = PAPER_PIXELS.iter().find(|(size, _)| *size == display.size_px).map(|&(_, pixels)| count(pixels));
        let mut cells = vec![name_of(display), paper.unwrap_or_else(|| "–".to_owned()), count(display.pixels)];
        cells.extend(PAPER_K.iter().map(|&k| match rung(display, k).and_then(|rung| rung.faces) {
            None => "source too small".to_owned(),
            Some(faces) if is_least(display, k, faces) => format!("{} (least)", count(faces as u64)),
            Some(faces) => count(faces as u64),
        }));
        cells.push(display.look.map_or_else(
            || "the source only".to_owned(),
            |(faces, _)| format!("{} ({:.2} ×)", count(faces as u64), faces as f64 / display.pixels.max(1) as f64),
        ));
        cells
    };
    page.table(head, found.displays.iter().map(row).collect());
    let has_least = |d: &OnDisplay| d.rungs.iter().any(|r| r.faces.is_some_and(|faces| is_least(d, r.k, faces)));
    if found.displays.iter().any(has_least) {
        page.text("(least): with fewer polygons the surface would fold or be pinched somewhere.");
    }
    let most = found.displays.iter().map(|d| found.seen_faces as f64 / d.pixels.max(1) as f64);
    let most: Vec<String> =
        found.displays.iter().zip(most).map(|(d, most)| format!("{:.1} on {}", most, name_of(d))).collect();
    page.text(format!("The source itself has so many faces a covered pixel: {}.", most.join(", ")));
}

/// Whether a collapse ended before the faces wanted, for the surface's sake.
fn is_least(display: &OnDisplay, k: f64, faces: usize) -> bool {
    faces as f64 > k * display.pixels as f64 + 2.5
}

fn rung(display: &OnDisplay, k: f64) -> Option<&Rung> {
    display.rungs.iter().find(|rung| rung.k == k)
}

fn curves(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    let series = |name: &str, display: &OnDisplay, style: usize, measure: fn(&ModelDifference) -> f64| {
        let points = display.rungs.iter().filter_map(|r| Some([r.k, measure(r.differences.get(style)?)]));
        Series { name: name.to_owned(), points: points.collect(), style: Style::LineAndPoints }
    };
    let mut draw = |file: String, title: String, series: Vec<Series>, y_label: &str, limit: f64| {
        lines(
            out.join(&file),
            &Chart {
                title: title.clone(),
                x_label: "polygons a covered pixel (k)".to_owned(),
                y_label: y_label.to_owned(),
                series,
                x_log: true,
                y_from_zero: true,
                reference: Some(Reference { name: format!("looks the same: {limit:.3}"), y: limit }),
                ..Chart::default()
            },
        )?;
        page.picture(file, title);
        Ok::<_, Error>(())
    };
    let full = &found.displays[found.full];
    let limits = full.limits[0];
    let by_style = |measure| STYLES.iter().enumerate().map(|(i, s)| series(s.name, full, i, measure)).collect();
    draw(
        format!("difference_{}.png", found.name),
        format!("{}: visible difference on {}", found.title, name_of(full)),
        by_style(|d| d.flip_mean),
        "mean FLIP over covered pixels",
        limits.flip_mean,
    )?;
    draw(
        format!("worst_{}.png", found.name),
        format!("{}: difference of the worst pixels on {}", found.title, name_of(full)),
        by_style(|d| d.flip_p99),
        "FLIP, 99th percentile",
        limits.flip_p99,
    )?;
    draw(
        format!("displays_{}.png", found.name),
        format!("{}: visible difference on each display ({})", found.title, STYLES[0].name),
        found.displays.iter().map(|d| series(&name_of(d), d, 0, |d| d.flip_mean)).collect(),
        "mean FLIP over covered pixels",
        LookLimits::default().flip_mean,
    )
}

fn measures(display: &OnDisplay, found: &Findings, page: &mut Page) {
    let is_full = std::ptr::eq(display, &raw const found.displays[found.full]);
    for (number, style) in STYLES.iter().enumerate().take(if is_full { STYLES.len() } else { 1 }) {
        page.heading(3, format!("Measures, {}, {}", name_of(display), style.name));
        let head = [
            "k",
            "faces",
            "mean FLIP",
            "99 % FLIP",
            "SSIM",
            "PSNR (dB)",
            "silhouette changed (% of pixels)",
        ];
        let cells = |d: &ModelDifference| {
            [
                format!("{:.4}", d.flip_mean),
                format!("{:.3}", d.flip_p99),
                format!("{:.4}", d.ssim),
                if d.psnr_db.is_finite() { format!("{:.1}", d.psnr_db) } else { "∞".to_owned() },
                format!("{:.3}", 100.0 * d.silhouette_px as f64 / d.covered_px.max(1) as f64),
            ]
        };
        let mut rows = Vec::new();
        for rung in display.rungs.iter().rev() {
            if let (Some(faces), Some(difference)) = (rung.faces, rung.differences.get(number)) {
                let mut row = vec![k_name(rung.k), count(faces as u64)];
                row.extend(cells(difference));
                rows.push(row);
            }
        }
        if let Some(unseen) = display.unseen.get(number) {
            let mut row = vec!["moved ⅛ pixel".to_owned(), "the source".to_owned()];
            row.extend(cells(unseen));
            rows.push(row);
        }
        page.table(head.map(str::to_owned).to_vec(), rows);
    }
}

/// Whether 50 holds, from what was measured.
fn verdict(found: &Findings) -> String {
    let at_50: Vec<(&OnDisplay, &ModelDifference)> =
        found.displays.iter().filter_map(|d| Some((d, rung(d, POLYGONS_PER_PIXEL)?.differences.first()?))).collect();
    let least: Vec<f64> =
        found.displays.iter().filter_map(|d| Some(d.look?.0 as f64 / d.pixels.max(1) as f64)).collect();
    let range = |values: &[f64]| {
        let (low, high) = values.iter().fold((f64::INFINITY, 0f64), |(a, b), &v| (a.min(v), b.max(v)));
        if high - low < 0.005 { format!("{low:.2}") } else { format!("{low:.2} to {high:.2}") }
    };
    let needed = if least.is_empty() {
        "On no display does any smaller mesh look the same as the source.".to_owned()
    } else {
        format!("The least that looks the same is {} polygons a pixel.", range(&least))
    };
    let most_needed = least.iter().copied().fold(0.0, f64::max);
    if at_50.is_empty() {
        let holds = if least.is_empty() {
            "whether 50 holds cannot be said"
        } else {
            "50 itself could not be tried; by what was found it is more than is needed"
        };
        return format!("The source has fewer than 50 polygons a pixel on every display: {holds}. {needed}");
    }
    let same = at_50.iter().filter(|(display, d)| display.limits[0].hold(d)).count();
    let tried = at_50.len();
    let rest = found.displays.len() - tried;
    let tried_on = match rest {
        0 => format!("all {tried} displays"),
        _ => format!("{tried} of {} displays (the source is too small for the others)", found.displays.len()),
    };
    let outcome = if same < tried {
        format!("50 does not hold: at 50 the pictures look the same on {same} of {tried} displays tried")
    } else if most_needed * NEAR >= POLYGONS_PER_PIXEL {
        "50 holds: it is enough, and about what is needed".to_owned()
    } else {
        format!(
            "50 is enough but not the least: it is {:.0} times what the most demanding display needs",
            POLYGONS_PER_PIXEL / most_needed
        )
    };
    format!("{outcome}. Tried on {tried_on}. {needed}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(flip_mean: f64) -> ModelDifference {
        ModelDifference { covered_px: 9, silhouette_px: 0, flip_mean, flip_p99: 0.0, ssim: 1.0, psnr_db: 40.0 }
    }

    /// Displays of a thousand pixels: the mean FLIP at 50 polygons a pixel, and the least that looks the same.
    fn found(displays: &[(Option<f64>, Option<usize>)]) -> Findings {
        let display = |&(at_50, least): &(Option<f64>, Option<usize>)| OnDisplay {
            size_px: [64, 48],
            pixels: 1000,
            rungs: vec![Rung {
                k: 50.0,
                faces: at_50.map(|_| 50_000),
                differences: at_50.map(difference).into_iter().collect(),
            }],
            unseen: vec![difference(0.0)],
            limits: vec![LookLimits::default()],
            cuts: Vec::new(),
            look: least.map(|faces| (faces, difference(0.0))),
        };
        Findings {
            name: "a".to_owned(),
            title: "A".to_owned(),
            source_faces: 200_000,
            seen_faces: 100_000,
            displays: displays.iter().map(display).collect(),
            full: 0,
        }
    }

    #[test]
    fn the_verdict_follows_the_measures() {
        let says = |displays: &[(Option<f64>, Option<usize>)], part: &str| {
            let text = verdict(&found(displays));
            assert!(text.contains(part), "{text}");
        };
        says(&[(Some(0.01), Some(45_000))], "50 holds: it is enough, and about what is needed");
        says(&[(Some(0.01), Some(2_000)), (None, Some(5_000))], "50 is enough but not the least: it is 10 times");
        says(&[(Some(0.01), Some(2_000)), (None, Some(5_000))], "1 of 2 displays (the source is too small");
        says(
            &[(Some(0.5), None), (Some(0.01), Some(40_000))],
            "50 does not hold: at 50 the pictures look the same on 1 of 2",
        );
        says(&[(None, None)], "whether 50 holds cannot be said");
        says(&[(None, Some(3_000))], "by what was found it is more than is needed");
        says(&[(None, Some(3_000))], "3.00 polygons a pixel");
    }

    #[test]
    fn the_page_has_its_tables_and_pictures() {
        let folder = tempfile::tempdir().unwrap();
        let page = write_page(&[found(&[(Some(0.01), Some(45_000)), (None, None)])], folder.path()).unwrap();
        let html = std::fs::read_to_string(page).unwrap();
        for file in html.split("src=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
            assert!(folder.path().join(file).is_file(), "{file}");
        }
        assert_eq!(html.matches("<img").count(), 5);
        assert!(html.contains("45,000 (45.00 ×)") && html.contains("the source only"), "{html}");
        assert!(folder.path().join("mizuno.md").is_file());
    }
}
