//! hiraoka's page: tables, CSV files, plots and what they say.

use super::decimation::{COLLAPSE, COMPARED, LevelError};
use super::drawing::{CULLINGS, SizeFound};
use super::engine::EngineRow;
use super::poses::Losses;
use super::{DRAWN, Findings, PAPER_TRIANGLES, file_name};
use crate::page::{Page, count, write_csv};
use crate::{Culling, Error};
use std::path::{Path, PathBuf};
use yamanami_measure::plot::{Chart, Series, Style, lines};
use yamanami_multires::tin_block::CostReading;

pub(super) fn write(found: &Findings, out: &Path) -> Result<PathBuf, Error> {
    let mut page = Page::default();
    page.heading(1, "hiraoka: a TIN in blocks and levels");
    page.text(
        "Hiraoka, Yamada, Urahama: a TIN of 41,797 triangles in 6 × 4 blocks of 520 m is drawn whole within 1,000 m of the \
         eye, at half its triangles within 2,000 m and at a quarter beyond, and what is out of view is left out by the \
         corners of blocks and triangles: 0.006 s against 0.014 s for testing every triangle, on a Pentium M of 1.7 GHz. \
         Times here are of this machine, for choosing levels and collecting triangles, without drawing them.",
    );
    ground(found, &mut page);
    decimation(found, out, &mut page)?;
    for size in &found.sizes {
        drawing(size, out, &mut page)?;
    }
    by_size(found, out, &mut page)?;
    poses(found, out, &mut page)?;
    page.write(out, "hiraoka.md", "hiraoka")
}

fn ground(found: &Findings, page: &mut Page) {
    page.heading(2, "The ground");
    let [low, mean, high] = found.heights_m;
    let cut = found.sizes.first().and_then(|size| size.levels.first()).map_or(0, |level| level.0);
    page.text(format!(
        "{}. {} triangles after the cut (the paper: {}), heights {low:.3} to {high:.3} m, {mean:.3} m in the mean (the \
         paper: −4.553 to 65.603 m, 10.618 m).",
        found.title,
        count(cut as u64),
        count(PAPER_TRIANGLES as u64)
    ));
    page.picture("plan.png", "The TIN from above, north up");
}

/// Methods in the order of the table.
fn methods() -> Vec<&'static str> {
    CostReading::ALL.iter().map(|reading| reading.name()).chain([COLLAPSE]).collect()
}

fn decimation(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "Levels: how far from the source?");
    page.text(
        "Vertical distance to the whole TIN, exact over all of the plan. The paper picks by slope where its text asks for \
         change of slope: the readings differ by what \"least\" is taken of, and the last is the kindest. The collapse \
         measures vertical errors.",
    );
    let of = |method: &str, level: usize| found.decimation.iter().find(|e| e.method == method && e.level == level);
    let mut head = vec!["method".to_owned()];
    for level in 1..=COMPARED {
        head.push(format!("1/{}: triangles", 1 << level));
        head.push("RMS (m)".to_owned());
        head.push("greatest (m)".to_owned());
    }
    head.push("time (s)".to_owned());
    let mut rows = Vec::new();
    for method in methods() {
        let mut row = vec![method.to_owned()];
        for e in (1..=COMPARED).filter_map(|level| of(method, level)) {
            row.extend([count(e.triangles as u64), format!("{:.3}", e.rms_m), format!("{:.2}", e.max_m)]);
        }
        row.extend(of(method, 1).map(|e| format!("{:.2}", e.seconds)));
        rows.push(row);
    }
    page.table(head, rows);
    let ratio = |method: &str, level: usize| Some(of(method, level)?.rms_m / of(COLLAPSE, level)?.rms_m);
    let ratios = |method: &str| {
        let all: Vec<String> = (1..=COMPARED).filter_map(|l| ratio(method, l)).map(|r| format!("{r:.1}")).collect();
        all.join(", ")
    };
    page.text(format!(
        "In RMS the paper's plain reading is {} times as far off as the collapse (at 1/2, 1/4, 1/8), its kindest {} times.",
        ratios(CostReading::Plain.name()),
        ratios(CostReading::PlaneDeviation.name())
    ));
    let plot = |file: &str, what: &str, measure: fn(&LevelError) -> f64| {
        let series = methods().into_iter().map(|method| Series {
            name: method.to_owned(),
            points: (1..=COMPARED).filter_map(|l| of(method, l)).map(|e| [e.triangles as f64, measure(e)]).collect(),
            style: Style::LineAndPoints,
        });
        lines(
            out.join(file),
            &Chart {
                title: format!("{what} by number of triangles"),
                x_label: "triangles".to_owned(),
                y_label: format!("{what} (m)"),
                series: series.collect(),
                x_log: true,
                y_log: true,
                ..Chart::default()
            },
        )
    };
    plot("decimation_rms.png", "RMS vertical error", |e| e.rms_m)?;
    plot("decimation_max.png", "Greatest vertical error", |e| e.max_m)?;
    page.picture("decimation_rms.png", "RMS vertical error of the levels");
    page.picture("decimation_max.png", "Greatest vertical error of the levels");
    let rows: Vec<Vec<String>> = found
        .decimation
        .iter()
        .map(|e| {
            vec![
                format!("\"{}\"", e.method),
                e.level.to_string(),
                e.triangles.to_string(),
                format!("{:.4}", e.rms_m),
                format!("{:.4}", e.max_m),
                format!("{:.3}", e.seconds),
            ]
        })
        .collect();
    write_csv(&out.join("decimation.csv"), "method,level,triangles,rms_m,max_m,chain_s", &rows)
}

fn drawing(size: &SizeFound, out: &Path, page: &mut Page) -> Result<(), Error> {
    let all = size.levels.first().map_or(0, |level| level.0);
    let area = match size.copies {
        1 => "the paper's ground".to_owned(),
        n => format!("{} × the area", n * n),
    };
    page.heading(
        2,
        format!("Drawing: {area}, {} triangles in {} blocks", count(all as u64), count(size.blocks as u64)),
    );
    let levels: Vec<String> = size
        .levels
        .iter()
        .enumerate()
        .map(|(l, (triangles, error_m))| {
            format!("1/{}: {} triangles, {error_m:.2} m", 1 << l, count(*triangles as u64))
        })
        .collect();
    page.text(format!(
        "The paper's levels ({}) after the cut, with their greatest vertical errors: {}. Made in {:.2} s, cut and joined in {:.2} s.",
        DRAWN.name(),
        levels.join("; "),
        size.chain_s,
        size.blocks_s
    ));
    let brute_ms = size.rows.first().map_or(f64::NAN, |row| row.median_ms);
    let head = [
        "",
        "time (ms)",
        "next frame (ms)",
        "× brute force",
        "triangles",
        "blocks",
        "tests of blocks",
        "tests of triangles",
        "seen but not drawn",
        "blocks lost",
        "SSIM",
        "mean FLIP",
    ];
    let mut rows: Vec<Vec<String>> = Vec::new();
    for row in &size.rows {
        rows.push(vec![
            row.name.to_owned(),
            format!("{:.3}", row.median_ms),
            format!("{:.3}", row.median_ms),
            format!("{:.1}", brute_ms / row.median_ms),
            count(row.triangles as u64),
            row.counts.blocks.to_string(),
            count(row.counts.block_tests as u64),
            count(row.counts.triangle_tests as u64),
            row.lost_triangles.to_string(),
            row.lost_blocks.to_string(),
            format!("{:.4}", row.ssim),
            format!("{:.4}", row.flip),
        ]);
    }
    for engine in &size.engine.rows {
        let mut row = vec![
            engine.name.clone(),
            format!("{:.3}", engine.first_ms),
            format!("{:.3}", engine.next_ms),
            format!("{:.1}", brute_ms / engine.first_ms),
            count(engine.triangles as u64),
        ];
        row.extend(vec!["–".to_owned(); 5]);
        row.extend([format!("{:.4}", engine.ssim), format!("{:.4}", engine.flip)]);
        rows.push(row);
    }
    write_csv(
        &out.join(format!("drawing_{}x{}.csv", size.copies, size.copies)),
        "method,median_ms,next_frame_ms,times_brute_force,triangles,blocks,block_tests,triangle_tests,lost_triangles,lost_blocks,ssim,flip",
        &rows.iter().map(|row| row.iter().map(|cell| cell.replace([',', '–'], "")).collect()).collect::<Vec<_>>(),
    )?;
    page.table(head.map(str::to_owned).to_vec(), rows);
    page.text(format!(
        "Eye at (260, 260, 100) m, looking level to the north-east corner of the paper's ground, 45° from bottom to top, 1024 × \
         768 pixels. Pictures are held against that of the whole TIN. Open edges inside the ground: {} with the seams, {} \
         with each block drawn as it was cut.",
        size.gaps.joined,
        count(size.gaps.apart as u64)
    ));
    let left: Vec<String> =
        size.engine.rows.iter().map(|row| format!("{}: {:.2} px", row.name, row.error_px)).collect();
    page.text(format!(
        "The engine's hierarchy took {:.2} s. Its time is that of finding the first front and meshing it, from the base mesh; its \
         next frames (the mean of 60, the eye going 10 m ahead in each) pay for differences only, where the others begin \
         again. Its triangles are all that it holds, those out of view too. Largest error left: {}.",
        size.engine.build_s,
        left.join("; ")
    ));
    if size.copies == 1 {
        page.picture("view_full.png", "The whole TIN");
        page.picture("triangles_full.png", "The whole TIN with its triangles");
        for (culling, name) in CULLINGS.into_iter().filter(|(culling, _)| *culling != Culling::BruteForce) {
            let file = file_name(culling);
            page.picture(format!("triangles_{file}.png"), format!("Drawn: {name}"));
            page.picture(
                format!("difference_{file}.png"),
                format!("Difference from the whole TIN, four times as strong: {name}"),
            );
            page.picture(
                format!("levels_{file}.png"),
                format!(
                    "What is drawn from above, {name}: blue whole, orange half, green a quarter, grey not at all; red: the field of \
                     view and the distances 1,000 and 2,000 m"
                ),
            );
        }
    }
    Ok(())
}

fn by_size(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    if found.sizes.len() < 2 {
        return Ok(());
    }
    let series = CULLINGS.iter().enumerate().map(|(nth, (_, name))| Series {
        name: (*name).to_owned(),
        points: found
            .sizes
            .iter()
            .filter_map(|size| Some([size.levels.first()?.0 as f64, size.rows.get(nth)?.median_ms]))
            .collect(),
        style: Style::LineAndPoints,
    });
    let engine = [("first", false), ("next", true)].into_iter().flat_map(|(which, is_next)| {
        [0, 1].map(move |nth| {
            let time = |row: &EngineRow| if is_next { row.next_ms } else { row.first_ms };
            let point = |size: &SizeFound| Some([size.levels.first()?.0 as f64, time(size.engine.rows.get(nth)?)]);
            let name = found.sizes[0].engine.rows.get(nth).map_or("", |row| row.name.as_str());
            Series {
                name: format!("{name}: {which}"),
                points: found.sizes.iter().filter_map(point).collect(),
                style: Style::Dashed,
            }
        })
    });
    lines(
        out.join("time_by_size.png"),
        &Chart {
            title: "Choosing what to draw, by the size of the TIN".to_owned(),
            x_label: "triangles of the TIN".to_owned(),
            y_label: "time (ms)".to_owned(),
            series: series.chain(engine).collect(),
            x_log: true,
            y_log: true,
            ..Chart::default()
        },
    )?;
    page.heading(2, "By size");
    page.picture("time_by_size.png", "Time of the drawing step by the size of the TIN, same eye");
    Ok(())
}

fn poses(found: &Findings, out: &Path, page: &mut Page) -> Result<(), Error> {
    page.heading(2, "What the rules lose");
    page.text(
        "Eyes anywhere over the ground at 100 m height, looking level in any direction, with the same field of view. What is seen is found by clipping every triangle.",
    );
    let share = |part: usize, of: usize| format!("{:.2} %", 100.0 * part as f64 / of.max(1) as f64);
    let row = |name: &str, l: &Losses| {
        vec![
            name.to_owned(),
            count(l.poses as u64),
            share(l.own_cornerless, l.own_seen),
            share(l.cornerless_blocks, l.seen_blocks),
            share(l.lost_faithful, l.seen),
            l.lost_conservative.to_string(),
        ]
    };
    let rows: Vec<Vec<String>> = found.losses.iter().map(|(name, losses)| row(name, losses)).collect();
    let head = [
        "",
        "poses",
        "the eye's block, in view without a corner",
        "blocks in view without a corner",
        "triangles lost by the paper's rule",
        "lost by the conservative one",
    ];
    page.table(head.map(str::to_owned).to_vec(), rows.clone());
    page.text(format!(
        "An example: the eye over the middle of a block, looking east and 20° down. The paper's rule loses {} triangles that are \
         seen, and {} block(s) whole.",
        count(found.own_block_lost[0] as u64),
        found.own_block_lost[1]
    ));
    page.picture("own_block_paper.png", "Drawn: the paper's rule; the ground before the eye is missing");
    page.picture("own_block_conservative.png", "Drawn: conservative");
    write_csv(
        &out.join("poses.csv"),
        "tin,poses,own_block_cornerless,blocks_cornerless,faithful_lost,conservative_lost",
        &rows.iter().map(|row| row.iter().map(|cell| cell.replace(',', "")).collect()).collect::<Vec<_>>(),
    )
}
