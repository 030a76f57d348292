//! Tests of the true projected error: against nothing, against brute force, with gaps.

use super::*;
use yamanami_core::DeformedMap;

/// A grid of 200 m, 60 km wide.
fn ground(half: u32) -> FieldLevel {
    let width = 2 * half as usize + 1;
    let z = |k: usize| {
        let (x, y) = ((k % width) as f32, (k / width) as f32);
        700.0 + 400.0 * (0.21 * x).sin() * (0.13 * y).cos() + 150.0 * (0.9 * x + 0.4 * y).sin()
    };
    FieldLevel::new(200.0, half, (0..width * width).map(z).collect())
}

/// Two triangles a square of `stride` cells.
fn mesh(grid: &FieldLevel, stride: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let lines: Vec<usize> = (0..grid.width()).step_by(stride).collect();
    let n = lines.len() as u32;
    let mut positions = Vec::new();
    for &row in &lines {
        for &column in &lines {
            let z = f64::from(grid.heights_m()[row * grid.width() + column]);
            positions.push(grid.plane_from_grid(column, row).extend(z));
        }
    }
    let mut triangles = Vec::new();
    for k in (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| j * n + i)) {
        triangles.extend([[k, k + n, k + 1], [k + 1, k + n, k + n + 1]]);
    }
    (positions, triangles)
}

fn view(rim_m: f64) -> MapView {
    MapView::fitted(DeformedMap::default(), [1300, 1300], rim_m, 3_000.0, 0.0)
}

#[test]
fn the_full_mesh_is_drawn_where_it_is() {
    let grid = ground(150);
    let (positions, triangles) = mesh(&grid, 1);
    let report = projected_error(&view(28_000.0), &grid, &positions, &triangles);
    assert!(report.all.max_px < 1e-6, "{:?}", report.all);
    assert!(report.height_rms_m < 1e-6 && report.large.is_empty());
    let in_disc = |r_m: f64| {
        let p = |k: usize| grid.plane_from_grid(k % grid.width(), k / grid.width());
        (0..grid.heights_m().len()).filter(|&k| p(k).length() <= r_m).count()
    };
    assert_eq!(report.all.samples, in_disc(28_000.0));
    assert_eq!(report.all.samples - report.far.samples, in_disc(10_000.0));
    assert_eq!(report.bins.iter().map(|bin| bin.samples).sum::<usize>(), report.all.samples);
}

#[test]
fn agrees_with_every_sample_against_every_triangle() {
    let grid = ground(80);
    let (positions, triangles) = mesh(&grid, 20);
    let view = view(15_500.0);
    let report = projected_error(&view, &grid, &positions, &triangles);
    let (mut most_px, mut squares, mut count, mut large) = (0.0f64, 0.0, 0, 0);
    for k in 0..grid.heights_m().len() {
        let p = grid.plane_from_grid(k % grid.width(), k / grid.width());
        if p.length() > view.rim_m {
            continue;
        }
        let true_px = view.px_from_plane(p.extend(f64::from(grid.heights_m()[k])));
        let mut off_px = -1.0f64;
        for t in &triangles {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            let turn = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
            let [a2, b2, c2] = [a, b, c].map(DVec3::truncate);
            let area = turn(a2, b2, c2);
            let weights = [turn(b2, c2, p), turn(c2, a2, p), turn(a2, b2, p)].map(|w| w / area);
            if weights.iter().all(|&w| w >= -1e-9) {
                let corners_px = [a, b, c].map(|corner| view.px_from_plane(corner));
                let drawn_px: DVec2 = weights.iter().zip(corners_px).map(|(&w, px)| px * w).sum();
                off_px = off_px.max(drawn_px.distance(true_px));
            }
        }
        most_px = most_px.max(off_px);
        squares += off_px * off_px;
        count += 1;
        large += usize::from(off_px >= LARGE_PX);
    }
    assert_eq!((report.all.samples, report.large.len(), report.uncovered), (count, large, 0));
    assert!(large > 0, "the test means something");
    assert!((report.all.max_px / most_px - 1.0).abs() < 1e-6, "{} {most_px}", report.all.max_px);
    assert!((report.all.rms_px / (squares / count as f64).sqrt() - 1.0).abs() < 1e-6);
}

#[test]
fn what_is_not_covered_or_not_known_is_said() {
    let width = 161;
    let z = |k: usize| if k % width < 80 { 5.0 } else { f32::NAN };
    let grid = FieldLevel::new(200.0, 80, (0..width * width).map(z).collect());
    let corners = [DVec3::new(-16e3, -16e3, 5.0), DVec3::new(-16e3, 0.0, 5.0), DVec3::new(-8e3, 0.0, 5.0)];
    let report = projected_error(&view(15_000.0), &grid, &corners, &[[0, 2, 1], [0, 2, 9], [1, 1, 2]]);
    let known = (0..grid.heights_m().len())
        .filter(|&k| grid.known()[k] && grid.plane_from_grid(k % width, k / width).length() <= 15e3)
        .count();
    assert_eq!(report.all.samples + report.uncovered, known);
    assert!(report.all.samples > 100 && report.uncovered > 100);
    assert_eq!(projected_error(&view(15e3), &grid, &[], &[]).uncovered, known);
}
