//! What was found, plainly, and where the paper's text is at odds with itself.

use super::super::engine::{EQUAL_COUNT, EQUAL_RMS};
use super::super::peaks::PeakRow;
use super::super::{HoriFound, HoriGroundFound, HoriMode, PAPER_TRIANGLES};
use super::texts;
use crate::page::{Page, count};

pub(super) fn write(found: &HoriFound, peaks: &[PeakRow], page: &mut Page) {
    page.heading(2, "What was found");
    page.text(
        "The engine against the bands. At as many triangles as the paper's mesh: greatest error and share of samples over \
         3.5 px, as parts of the bands' (with own heights, which err less than with the paper's peaks); and the triangles \
         with which the engine has their RMS error.",
    );
    let head = ["ground", "greatest error", "share over 3.5 px", "triangles at equal RMS", "promises kept"];
    page.table(texts(head), found.grounds.iter().enumerate().map(against).collect());
    if let [none, paper, ours, ..] = peaks {
        page.text(format!(
            "Peaks. On a mesh of 6,400 m the paper's rule lifts the ground by {:.0} m in the mean (own heights: {:.0} m; summits \
             and ridges alone: {:.0} m), and draws its summits {:.0} m off (RMS; {:.0} m and {:.0} m).",
            paper.height_bias_m,
            none.height_bias_m,
            ours.height_bias_m,
            paper.summits.height_rms_m,
            none.summits.height_rms_m,
            ours.summits.height_rms_m
        ));
    }
    let Some(main) = found.grounds.first() else { return };
    let mode = |file: &str| main.modes.iter().find(|mode| mode.file == file);
    if let (Some(paper), Some(none)) = (mode("printed_paper"), mode("printed_none")) {
        page.text(format!(
            "With table 1 the paper's rule for peaks draws the ground {:.1} m too high in the mean and makes the RMS error {:.2} px, \
             against {:.2} px with own heights: what it gives summits it takes from slopes and valleys.",
            paper.report.height_bias_m, paper.report.far.rms_px, none.report.far.rms_px
        ));
        let [_, reduced] = PAPER_TRIANGLES;
        if paper.full_triangles == PAPER_TRIANGLES[0] {
            page.text(format!(
                "Counts. The paper's 3,958,784 polygons are 1,933 blocks of 6.4 km in full, which we meet exactly. Its table gives 77,360 \
                 in these blocks before neighbours are joined, and {} with what joins them without gaps; the paper says {}. \
                 It does not say how neighbours of two sizes are joined.",
                count(paper.triangles),
                count(reduced)
            ));
        }
    }
    page.text(
        "The text against itself. The plain map has a radius of about 10 km, but the coarse centre of table 1 ends at 3.2 km: half \
         a block, so that it is the eye's own block; the two radii are kept apart here. Equations (2) and (3) lack an α before \
         their first terms: without it neither α = 0 nor α = 1 is what equation (1) says. As printed, (3) joins the plain map \
         without a kink only where the eye stands half as high as the plain map is wide in radius, as here (5 km, 10 km). The Earth is \
         flat in the paper: at 160 km what stands below about 1,700 m is out of sight.",
    );
}

/// A ground's row.
fn against((nth, ground): (usize, &HoriGroundFound)) -> Vec<String> {
    let mode = |file: &str| ground.modes.iter().find(|mode| mode.file == file);
    let mut cells = vec![if nth == 0 { "this map".to_owned() } else { ground.title.clone() }];
    let part = |ours: f64, theirs: f64| if theirs > 0.0 { format!("{:.2}", ours / theirs) } else { "–".to_owned() };
    let none = mode("printed_none");
    match (mode(EQUAL_COUNT), none) {
        (Some(ours), Some(bands)) => {
            let (own, theirs) = (&ours.report, &bands.report);
            let of = |text: String, ours: String, theirs: String| format!("{text} ({ours} of {theirs})");
            cells.push(of(
                part(own.all.max_px, theirs.all.max_px),
                format!("{:.2}", own.all.max_px),
                format!("{:.2} px", theirs.all.max_px),
            ));
            cells.push(of(
                part(own.far.over_large, theirs.far.over_large),
                format!("{:.4}", 100.0 * own.far.over_large),
                format!("{:.4} %", 100.0 * theirs.far.over_large),
            ));
        }
        _ => cells.extend(["–".to_owned(), "–".to_owned()]),
    }
    cells.push(match (mode(EQUAL_RMS), none) {
        (Some(ours), Some(bands)) => format!(
            "{} ({} of {})",
            part(ours.triangles as f64, bands.triangles as f64),
            count(ours.triangles),
            count(bands.triangles)
        ),
        _ => "not met".to_owned(),
    });
    let kept: Vec<bool> = ground.modes.iter().filter_map(HoriMode::keeps_bound).collect();
    cells.push(format!("{} of {}", kept.iter().filter(|&&kept| kept).count(), kept.len()));
    cells
}
