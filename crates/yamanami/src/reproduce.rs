//! Figures 7(a), 7(b) and 8 of hashida on real elevation data: tables, plots and a page that says what holds.
//!
//! Based on: Hashida, Kanai, Kishinami. N_T = 5,000 triangles, L = 5 intervals, C_l in proportion to l − 1.

use crate::flight_report::summary;
use crate::{
    CameraPath, Canvas, Criteria, DrawWith, Error, FlightMode, FlightOptions, FrameStats, Lod, Scene, Staircase,
    Terrain, ViewCriterion, fly, overview, valley_run,
};
use glam::DVec3;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use yamanami_core::Hierarchy;
use yamanami_gpu::RenderOptions;
use yamanami_measure::plot::{Chart, Reference, Series, Style, lines};
use yamanami_measure::{FLIP_PIXELS_PER_DEGREE, flip, ssim};

const BUDGET: u32 = 5_000;
const INTERVALS: usize = 5;
const FRAMES: usize = 240;
/// Triangles of the paper's reduced picture, of 131,072.
const REDUCED: u32 = 31_592;
const FULL: u32 = 131_072;
const PICTURE_PX: [u32; 2] = [1280, 720];
/// Flights are drawn smaller, so that times show the front more than the drawing.
const FLIGHT_PX: [u32; 2] = [640, 360];

/// Writes `report.md` with its tables (CSV), plots and pictures into `out`; gives the report's path. `large` is a second,
/// larger terrain. `progress` hears what is being done.
pub fn hashida(
    mut small: Terrain,
    large: Option<Terrain>,
    out: &Path,
    progress: &dyn Fn(&str),
) -> Result<PathBuf, Error> {
    let file_error = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::File { path, source }
    };
    std::fs::create_dir_all(out).map_err(file_error(out))?;
    let mut page = String::from(
        "# hashida: three controls at once, and differences\n\nHashida, Kanai, Kishinami: wavelet and quadtree LOD of large \
         terrain. Budget N_T = 5,000 triangles, L = 5 intervals. Times are of this machine, drawn in software where it has \
         no GPU.\n",
    );
    chapter(&mut small, "small", out, progress, &mut page)?;
    if let Some(mut large) = large {
        chapter(&mut large, "large", out, progress, &mut page)?;
    }
    let report = out.join("report.md");
    std::fs::write(&report, page).map_err(file_error(&report))?;
    Ok(report)
}

fn chapter(
    terrain: &mut Terrain,
    name: &str,
    out: &Path,
    progress: &dyn Fn(&str),
    page: &mut String,
) -> Result<(), Error> {
    let [columns, rows] = terrain.size();
    let full = 2 * (columns - 1) * (rows - 1);
    let _ = write!(
        page,
        "\n## {}: {columns} × {rows} samples, {:.1} × {:.1} m, {full} triangles in full\n",
        terrain.title(),
        terrain.geo().step_m[0],
        terrain.geo().step_m[1]
    );
    // one sample a frame, along the first part of the run
    let whole = (0.7 * columns as f64) as usize;
    let mut path = valley_run(terrain, whole.max(FRAMES), FLIGHT_PX)?;
    path.views.truncate(FRAMES);
    budget_figure(terrain, name, &path, out, progress, page)?;
    difference_figure(terrain, name, &path, out, progress, page)?;
    picture_figure(terrain, name, full, out, progress, page)
}

fn criteria(terrain_tolerance_m: f32, budget: Option<u32>) -> Criteria {
    // the view's tolerance is small: the budget is what binds
    let view = ViewCriterion { view: placeholder_view(), tolerance_px: 0.25, cull: true };
    Criteria { terrain_tolerance_m, view: Some(view), budget_triangles: budget, ..Criteria::default() }
}

/// Replaced by the path's view in every frame.
fn placeholder_view() -> yamanami_core::View {
    yamanami_core::View { eye: DVec3::ZERO, target: DVec3::Y, fov_y_rad: 1.0, viewport_px: FLIGHT_PX }
}

fn flight(
    terrain: &mut Terrain,
    path: &CameraPath,
    criteria: Criteria,
    lod: Lod,
    mode: FlightMode,
    draw: bool,
) -> Result<Vec<FrameStats>, Error> {
    let range = terrain.range_m().map(f64::from);
    let style = RenderOptions { tint_range_m: Some(range), ..RenderOptions::default() };
    let options = FlightOptions { criteria, lod, mode, draw, style, morph: true };
    let canvas = Canvas::new(path.views[0].eye, DrawWith::Auto)?;
    fly(terrain, canvas, path, &options, |_, _, _| Ok(()))
}

/// Figure 7(a): triangles a frame with and without the budget.
fn budget_figure(
    terrain: &mut Terrain,
    name: &str,
    path: &CameraPath,
    out: &Path,
    progress: &dyn Fn(&str),
    page: &mut String,
) -> Result<(), Error> {
    progress("figure 7(a): flights with and without the budget");
    let [east_m, north_m] = terrain.extent_m();
    // the nearest interval keeps τ*, so that must leave the budget room: six budgets for the whole terrain
    let tolerance_m = tolerance_for(terrain, 6 * BUDGET as usize);
    let staircase = Staircase::new(tolerance_m, 0.0, 0.8 * east_m.hypot(north_m), INTERVALS);
    let mut run =
        |lod: Lod, budget| flight(terrain, path, criteria(tolerance_m, budget), lod, FlightMode::Differences, false);
    let free = run(Lod::Paper(staircase.clone()), None)?;
    let paper = run(Lod::Paper(staircase), Some(BUDGET))?;
    let exact = run(Lod::Exact, Some(BUDGET))?;
    let counts = |frames: &[FrameStats]| frames.iter().map(|f| f.triangles as f64).collect::<Vec<_>>();
    let dashed =
        |name: &str, frames: &[FrameStats]| Series { style: Style::Dashed, ..Series::of_values(name, counts(frames)) };
    lines(
        out.join(format!("fig7a_{name}.png")),
        &Chart {
            title: format!("Figure 7(a), {}: triangles with and without a budget", terrain.title()),
            x_label: "frame".to_owned(),
            y_label: "triangles".to_owned(),
            series: vec![
                dashed("paper's staircase, no budget", &free),
                Series::of_values("paper's feedback", counts(&paper)),
                Series::of_values("exact controller", counts(&exact)),
            ],
            y_log: true,
            reference: Some(Reference { name: "N_T = 5,000".to_owned(), y: f64::from(BUDGET) }),
            ..Chart::default()
        },
    )?;
    write_csv(
        &out.join(format!("fig7a_{name}.csv")),
        &["no_budget", "paper", "exact"],
        &[&free, &paper, &exact],
        |f| f.triangles.to_string(),
    )?;
    let settled = settling_frame(&paper);
    let off = |frames: &[FrameStats], from: usize| {
        let bound = |f: &&FrameStats| f.limited_by == "budget" || f.triangles > BUDGET as usize;
        let off = |f: &FrameStats| (f.triangles as f64 / f64::from(BUDGET) - 1.0).abs();
        frames.iter().skip(from).filter(bound).map(off).fold(0.0, f64::max) * 100.0
    };
    let _ = write!(
        page,
        "\n### Figure 7(a): the budget\n\n![triangles a frame](fig7a_{name}.png)\n\n\
         | control | median triangles | most | largest deviation from N_T after frame 3, where the budget binds |\n|---|---|---|---|\n\
         | staircase, no budget (τ* = {tolerance_m:.1} m) | {} | {} | – |\n| paper's feedback | {} | {} | {:.1} % |\n\
         | exact controller | {} | {} | {:.2} % |\n\n{}\n",
        summary(&free).triangles_median,
        summary(&free).triangles_max,
        summary(&paper).triangles_median,
        summary(&paper).triangles_max,
        off(&paper, 3),
        summary(&exact).triangles_median,
        summary(&exact).triangles_max,
        off(&exact, 3),
        settled.map_or_else(
            || {
                "The paper's feedback did not come within 5 % of N_T for ten frames on end: the nearest interval, whose τ* \
                 it may not change, takes too much of the budget."
                    .to_owned()
            },
            |f| {
                format!(
                    "The paper's feedback settles (within 5 % of N_T for ten frames) at frame {f}, and lags where the view \
                     changes; the exact controller is at N_T from the first frame, or below it where nothing is left above τ*."
                )
            },
        )
    );
    Ok(())
}

/// The tolerance at which the whole terrain takes about so many triangles.
fn tolerance_for(terrain: &Terrain, triangles: usize) -> f32 {
    let surface = terrain.surface();
    let mut errors: Vec<f32> =
        (0..surface.node_bound()).filter(|&n| surface.exists(n)).map(|n| surface.error_m(n)).collect();
    errors.sort_unstable_by(|a, b| b.total_cmp(a));
    // a node adds two triangles
    errors.get(triangles / 2).copied().unwrap_or(0.0)
}

/// The first of ten frames on end that are within 5 % of the budget.
fn settling_frame(frames: &[FrameStats]) -> Option<usize> {
    let within = |f: &FrameStats| (f.triangles as f64 / f64::from(BUDGET) - 1.0).abs() <= 0.05;
    frames.windows(10).position(|ten| ten.iter().all(within))
}

/// Figure 7(b): frame rate with and without differences.
fn difference_figure(
    terrain: &mut Terrain,
    name: &str,
    path: &CameraPath,
    out: &Path,
    progress: &dyn Fn(&str),
    page: &mut String,
) -> Result<(), Error> {
    progress("figure 7(b): flights by differences and by rebuild");
    let full = 2 * (terrain.size()[0] - 1) * (terrain.size()[1] - 1);
    let mut table = String::from(
        "| budget | differences: update + upload (ms) | rebuild: mesh + upload (ms) | ratio | bytes a frame, differences | bytes, rebuild | ratio |\n|---|---|---|---|---|---|---|\n",
    );
    let mut rates = Vec::new();
    for budget in [BUDGET, 50_000, 500_000].into_iter().filter(|&b| (b as usize) < full) {
        let draw = budget == BUDGET;
        let mut run = |mode| flight(terrain, path, criteria(0.0, Some(budget)), Lod::Exact, mode, draw);
        let by_differences = run(FlightMode::Differences)?;
        let by_rebuild = run(FlightMode::Rebuild)?;
        let (d, r) = (summary(&by_differences), summary(&by_rebuild));
        let (d_ms, r_ms) = (d.update_ms_median + d.upload_ms_median, r.update_ms_median + r.upload_ms_median);
        let _ = writeln!(
            table,
            "| {budget} | {d_ms:.3} | {r_ms:.3} | {:.1} × | {} | {} | {:.0} × |",
            r_ms / d_ms,
            d.upload_bytes_median,
            r.upload_bytes_median,
            r.upload_bytes_median as f64 / d.upload_bytes_median.max(1) as f64
        );
        if draw {
            let per_second = |frames: &[FrameStats]| {
                frames.iter().skip(1).map(|f| 1e3 / (f.update_ms + f.upload_ms)).collect::<Vec<_>>()
            };
            rates = vec![
                Series::of_values("by differences", per_second(&by_differences)),
                Series::of_values("by rebuild", per_second(&by_rebuild)),
            ];
            write_csv(
                &out.join(format!("fig7b_{name}.csv")),
                &[
                    "differences_update_ms",
                    "differences_upload_ms",
                    "differences_bytes",
                    "rebuild_update_ms",
                    "rebuild_upload_ms",
                    "rebuild_bytes",
                ],
                &[&by_differences, &by_rebuild],
                |f| format!("{:.4},{:.4},{}", f.update_ms, f.upload_ms, f.upload_bytes),
            )?;
            let draw_ms = summary(&by_differences).draw_ms_median;
            let _ = write!(
                page,
                "\n### Figure 7(b): differences\n\n![frames a second](fig7b_{name}.png)\n\nDrawing takes {draw_ms:.1} ms a frame either way and is left out of the figure and the table.\n\n"
            );
        }
    }
    lines(
        out.join(format!("fig7b_{name}.png")),
        &Chart {
            title: format!("Figure 7(b), {}: front and mesh, N_T = 5,000", terrain.title()),
            x_label: "frame".to_owned(),
            y_label: "frames a second, without drawing".to_owned(),
            series: rates,
            y_log: true,
            ..Chart::default()
        },
    )?;
    page.push_str(&table);
    page.push_str("\nThe rebuild is timed without finding the front; the paper reports about 3 × for whole frames.\n");
    Ok(())
}

/// Figure 8: the full picture against the reduced one.
fn picture_figure(
    terrain: &mut Terrain,
    name: &str,
    full: usize,
    out: &Path,
    progress: &dyn Fn(&str),
    page: &mut String,
) -> Result<(), Error> {
    progress("figure 8: the full and the reduced picture");
    let share = f64::from(REDUCED) / f64::from(FULL);
    let view = overview(terrain, PICTURE_PX);
    let style = RenderOptions { tint_range_m: Some(terrain.range_m().map(f64::from)), ..RenderOptions::default() };
    let mut picture = |budget: Option<u32>, tolerance_px: f32, file: &str| {
        let mut scene = Scene::new(terrain, Canvas::new(view.eye, DrawWith::Auto)?);
        let criteria = Criteria {
            view: Some(ViewCriterion { view, tolerance_px, cull: budget.is_some() }),
            budget_triangles: budget,
            ..Criteria::default()
        };
        let mut update = scene.update(terrain, &criteria)?;
        while update.pages > 0 {
            update = scene.update(terrain, &criteria)?;
        }
        let image = scene.draw(&view, &style)?;
        let path = out.join(file);
        image.save(&path).map_err(|source| Error::Picture { path, source })?;
        Ok::<_, Error>((image, update.report.triangles, update.report.error_left))
    };
    let (reference, all, _) = picture(None, 0.0, &format!("fig8_{name}_full.png"))?;
    let mut table =
        String::from("| triangles | share of all | largest error (px) | SSIM | mean FLIP |\n|---|---|---|---|---|\n");
    for share in [share, 0.1, 0.03] {
        let budget = (share * full as f64).round() as u32;
        let (image, triangles, error_px) = picture(Some(budget), 0.0, &format!("fig8_{name}_{budget}.png"))?;
        let similarity = ssim(&reference, &image)?;
        let difference = flip(&reference, &image, FLIP_PIXELS_PER_DEGREE)?.mean;
        let _ = writeln!(
            table,
            "| {triangles} | {:.1} % | {error_px:.2} | {similarity:.4} | {difference:.4} |",
            100.0 * share
        );
    }
    let reduced = (share * full as f64).round() as u32;
    let _ = write!(
        page,
        "\n### Figure 8: the reduced picture\n\nAll {all} triangles, and the paper's share of them (31,592 of 131,072):\n\n\
         ![full](fig8_{name}_full.png)\n![reduced](fig8_{name}_{reduced}.png)\n\n{table}\n\
         SSIM is 1 and FLIP 0 for equal pictures; a mean FLIP of 0.05 is hardly visible.\n"
    );
    Ok(())
}

fn write_csv(
    path: &Path,
    names: &[&str],
    flights: &[&[FrameStats]],
    cell: impl Fn(&FrameStats) -> String,
) -> Result<(), Error> {
    let mut text = format!("frame,{}\n", names.join(","));
    for i in 0..flights[0].len() {
        let cells: Vec<String> = flights.iter().map(|f| cell(&f[i])).collect();
        let _ = writeln!(text, "{i},{}", cells.join(","));
    }
    std::fs::write(path, text).map_err(|source| Error::File { path: path.to_owned(), source })
}
