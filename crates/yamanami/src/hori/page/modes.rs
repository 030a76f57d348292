//! Ways of reducing the map beside each other: triangles, true errors, promises; figure 14.

use super::super::{HoriGroundFound, HoriMode, PAPER_TRIANGLES};
use super::texts;
use crate::Error;
use crate::page::{Page, count, write_csv};
use std::path::Path;
use yamanami_measure::plot::{Chart, Reference, Series, Style, lines};
use yamanami_measure::{DistanceBin, LARGE_PX};

/// Most points of figure 14.
const MOST_POINTS: usize = 6_000;

/// The table of ways on a ground.
pub(super) fn table(found: &HoriGroundFound, out: &Path, page: &mut Page) -> Result<(), Error> {
    let [full, reduced] = PAPER_TRIANGLES;
    page.heading(3, "Polygons and true errors");
    page.text(format!(
        "The paper: {} polygons in full, {} by its table, 1/{:.1}. Errors are true ones: of every sample with data between \
         ring and rim, how far it is drawn from its place, in pixels. \"Promised\" is the engine's own bound for all samples, \
         which the greatest error must not pass. Of the engine's meshes all triangles count, those beyond the rim too; at \
         a count of triangles its tolerance is 0. {:.1} % of the disc has data; the bands draw triangles where there are none, and the \
         engine draws the edge of the data like a cliff.",
        count(full),
        count(reduced),
        full as f64 / reduced as f64,
        100.0 * found.known_share
    ));
    let cells = |mode: &HoriMode| {
        let far = &mode.report.far;
        let mut cells = vec![mode.name.to_owned(), count(mode.triangles)];
        cells.push(format!("1/{:.1}", mode.full_triangles as f64 / mode.triangles.max(1) as f64));
        cells.push(mode.bound_px.map_or("–".to_owned(), |px| format!("{px:.2}")));
        cells.extend([mode.report.all.max_px, far.p999_px, far.p99_px, far.rms_px].map(|px| format!("{px:.2}")));
        cells.extend([far.over_split, far.over_large].map(|share| format!("{:.3} %", 100.0 * share)));
        cells.push(format!("{:.1}", mode.report.height_bias_m));
        cells.push(format!("{:.0}", mode.summits.height_rms_m));
        cells
    };
    let head = [
        "mode",
        "triangles",
        "ratio",
        "promised (px)",
        "greatest (px)",
        "99.9 % (px)",
        "99 % (px)",
        "RMS (px)",
        "over 1.5 px",
        "over 3.5 px",
        "height bias (m)",
        "summits: RMS (m)",
    ];
    page.table(texts(head), found.modes.iter().map(cells).collect());
    if let Some(mode) = found.modes.first() {
        let (far, all) = (&mode.report.far, &mode.report.all);
        page.text(format!(
            "In full {} triangles in whole blocks. {} samples lie between ring and rim, {} more within the ring; of the \
             bands' {} to the rim are not drawn, as their disc is one of whole blocks.",
            count(mode.full_triangles),
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
            let counts = [mode.full_triangles, mode.triangles, far.samples as u64].map(|n| n.to_string());
            let bound = mode.bound_px.map_or(String::new(), |px| format!("{px:.6}"));
            let most_px = mode.report.all.max_px;
            let errors = [most_px, far.p999_px, far.p99_px, far.rms_px, far.over_split, far.over_large];
            let errors = errors.map(|v| format!("{v:.6}"));
            [vec![format!("\"{}\"", mode.name)], counts.into(), vec![bound], errors.into()].concat()
        })
        .collect();
    let names = "mode,full_triangles,triangles,samples,bound_px,max_px,p999_px,p99_px,rms_px,share_over_1_5_px,share_over_3_5_px";
    write_csv(&out.join(format!("modes_{}.csv", found.name)), names, &csv)
}

/// Figure 14, for all ways.
pub(super) fn by_distance(found: &HoriGroundFound, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Figure 14: errors of 3.5 px and more by distance");
    page.text(
        "The paper shows such errors by distance: most lie within 40 km, although the triangles are small there, and it names steep \
         mountains and the join at the ring as causes.",
    );
    let points = |mode: &HoriMode| -> Vec<[f64; 2]> {
        let step = mode.report.large.len().div_ceil(MOST_POINTS).max(1);
        mode.report.large.iter().step_by(step).map(|&[r_m, px]| [r_m / 1e3, px]).collect()
    };
    for mode in &found.modes {
        let large = mode.report.large.len();
        if large == 0 {
            page.text(format!("{}: no sample has such an error.", mode.name));
            continue;
        }
        let file = format!("fig14_{}.png", mode.file);
        let series = vec![
            Series { name: mode.name.to_owned(), points: points(mode), style: Style::Points },
            Series { name: "greatest in 5 km".to_owned(), points: of_bins(mode, |bin| bin.max_px), style: Style::Line },
        ];
        let reference = Some(Reference { name: "3.5 px".to_owned(), y: LARGE_PX });
        chart(&out.join(&file), "Figure 14: errors of 3.5 px and more", "error (px)", series, reference)?;
        let within = mode.report.large.iter().filter(|point| point[0] <= 40_000.0).count();
        page.picture(
            file,
            format!(
                "{}: {} samples, {:.0} % of them within 40 km",
                mode.name,
                count(large as u64),
                100.0 * within as f64 / large as f64
            ),
        );
    }
    // the bands, then the engine beside the first of them: more lines than colours would be in one chart
    let (bands, engine): (Vec<&HoriMode>, Vec<&HoriMode>) = found.modes.iter().partition(|m| m.bound_px.is_none());
    let beside = bands.iter().take(2).copied().chain(engine).collect();
    for (modes, file, who) in [(bands, "bands", "bands"), (beside, "engine", "table 1 and the engine")] {
        let bins = |value: fn(&DistanceBin) -> f64| -> Vec<Series> {
            let series = |mode: &&HoriMode| Series {
                name: mode.name.to_owned(),
                points: of_bins(mode, value),
                style: Style::LineAndPoints,
            };
            modes.iter().map(series).collect()
        };
        let share = bins(|bin| 100.0 * bin.large as f64 / bin.samples.max(1) as f64);
        let (share_file, rms_file) = (format!("fig14_share_{file}.png"), format!("fig14_rms_{file}.png"));
        chart(&out.join(&share_file), "Samples of 3.5 px and more", "share of samples (%)", share, None)?;
        chart(&out.join(&rms_file), "RMS error by distance", "RMS error (px)", bins(|bin| bin.rms_px), None)?;
        page.picture(share_file, format!("Share of samples with errors of 3.5 px and more, in bins of 5 km: {who}"));
        page.picture(rms_file, format!("RMS error in bins of 5 km: {who}"));
    }
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
fn of_bins(mode: &HoriMode, value: fn(&DistanceBin) -> f64) -> Vec<[f64; 2]> {
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
