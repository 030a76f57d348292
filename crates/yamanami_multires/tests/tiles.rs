//! The laws of tiles: borders that are the same lines on both sides at every mix of zooms, errors that hold at every
//! sample, full cover.

use std::collections::HashMap;
use yamanami_core::HeightField;
use yamanami_multires::tiles::{CutOptions, CutScratch, Cutter, GRID, Placement, Tile, TilePiece};
use yamanami_multires::wavelet::{BuildOptions, build};
use yamanami_testkit::{Holes, Shape, Spacing, SyntheticTerrain};

const LAST: i64 = GRID as i64;

struct Case {
    name: &'static str,
    field: HeightField,
    placement: Placement,
    options: CutOptions,
}

/// Samples so far apart that a tile of the finest zoom is `samples` wide; the first sample lies at (x, y) in the zoom 0 tile.
fn axes(field: &HeightField, last: u32, samples: f64, [x, y]: [f64; 2]) -> Placement {
    let step = 1.0 / f64::from(1u32 << last) / samples;
    Placement::axes(
        (0..field.width()).map(|k| x + k as f64 * step).collect(),
        (0..field.height()).map(|k| y - k as f64 * step * 0.93).collect(),
    )
}

fn options(field: &HeightField, zooms: [u32; 2], tolerance_m: f64) -> CutOptions {
    let [low, high] = field.range_m().unwrap().map(f64::from);
    CutOptions { zooms, tolerance_m, globe_radius_m: None, height_range_m: [low, high], fill_m: None }
}

fn case(name: &'static str, terrain: &SyntheticTerrain, zooms: [u32; 2], samples: f64, tolerance_m: f64) -> Case {
    let field = terrain.to_field();
    let placement = axes(&field, zooms[1], samples, [0.4913, 0.5377]);
    Case { name, options: options(&field, zooms, tolerance_m), placement, field }
}

fn cases() -> Vec<Case> {
    let mountains = |w, h, seed| SyntheticTerrain::new(w, h, Shape::mountains(seed), Spacing::Metres(30.0));
    let mut all = vec![
        case("square", &mountains(129, 129, 5), [3, 9], 23.7, 4.0),
        case("odd", &mountains(150, 77, 6), [0, 8], 17.1, 2.0),
        case("clamped", &mountains(151, 139, 12), [3, 9], 26.0, 3.0),
        case("deep", &mountains(90, 131, 7), [2, 10], 32.0, 0.5),
        case("coarse", &mountains(140, 140, 8), [1, 7], 52.0, 15.0),
        case("discs", &mountains(121, 118, 4).with_holes(Holes::Discs { count: 6, seed: 2 }), [4, 9], 20.0, 3.0),
        case("speckle", &mountains(70, 61, 4).with_holes(Holes::Speckle { share: 0.05, seed: 1 }), [4, 8], 20.0, 3.0),
    ];
    // samples on the lines themselves
    let field = mountains(129, 97, 9).to_field();
    let step = 1.0 / 512.0 / 16.0;
    let placement = Placement::axes(
        (0..129).map(|k| 0.5 - 64.0 * step + f64::from(k) * step).collect(),
        (0..97).map(|k| 0.5 + 48.0 * step - f64::from(k) * step).collect(),
    );
    all.push(Case { name: "aligned", options: options(&field, [0, 9], 3.0), placement, field });
    // turned and bent, as a projected grid is in degrees
    let field = mountains(140, 120, 11).to_field();
    let step = 1.0 / 512.0 / 21.0;
    let to_tiles = move |[c, r]: [f64; 2]| {
        let (x, y) = ((c - 70.0) * step, (60.0 - r) * step);
        [0.5021 + x + 0.03 * y + 0.4 * x * y, 0.4987 + y - 0.03 * x - 0.3 * x * x]
    };
    let to_grid = move |[x, y]: [f64; 2]| {
        let mut at = [70.0, 60.0];
        for _ in 0..30 {
            let p = to_tiles(at);
            at = [at[0] + (x - p[0]) / step, at[1] - (y - p[1]) / step];
        }
        at
    };
    let placement = Placement::warped([140, 120], to_tiles, to_grid);
    all.push(Case { name: "warped", options: options(&field, [2, 9], 3.0), placement, field: field.clone() });
    // the same with ground all around
    let placement = Placement::warped([140, 120], to_tiles, to_grid);
    all.push(filled(Case { name: "warped, filled", options: options(&field, [2, 9], 3.0), placement, field }));
    all.push(filled(case("square, filled", &mountains(129, 129, 5), [0, 9], 23.7, 4.0)));
    all.push(filled(case("odd, filled", &mountains(150, 77, 6), [0, 8], 17.1, 2.0)));
    let speckled = mountains(70, 61, 4).with_holes(Holes::Speckle { share: 0.05, seed: 1 });
    all.push(filled(case("speckle, filled", &speckled, [4, 8], 20.0, 3.0)));
    all
}

fn filled(mut case: Case) -> Case {
    case.options.fill_m = Some(-40.0);
    case
}

/// All tiles of all zooms.
fn cut_all(case: &Case) -> HashMap<Tile, TilePiece> {
    let surface = build(case.field.clone(), &BuildOptions::default()).unwrap();
    let cutter = Cutter::new(&surface, &case.placement, &case.options);
    let mut scratch = CutScratch::default();
    let [first, last] = cutter.zooms();
    let tiles: Vec<Tile> = (first..=last).flat_map(|zoom| cutter.tiles(zoom).collect::<Vec<_>>()).collect();
    tiles
        .into_iter()
        .map(|tile| (tile, cutter.cut(tile, &mut scratch).unwrap()))
        .filter(|(_, piece)| !piece.is_empty())
        .collect()
}

/// A side as (step along, height in quanta).
fn line(piece: &TilePiece, side: usize) -> Vec<(i64, i64)> {
    let axis = 1 - side % 2;
    let vertex = |&v: &u32| {
        let quanta = piece.heights_m[v as usize] / piece.quantum_m;
        assert_eq!(quanta.fract(), 0.0);
        (i64::from(piece.places[v as usize][axis]), quanta as i64)
    };
    piece.sides[side].iter().map(vertex).collect()
}

/// Edges of the mesh along a side, as pairs of steps: where there is ground at it.
fn edges(piece: &TilePiece, side: usize) -> Vec<(i64, i64)> {
    let (axis, far) = (side % 2, if side < 2 { 0 } else { GRID as u16 });
    let mut out = Vec::new();
    for t in &piece.triangles {
        for k in 0..3 {
            let [a, b] = [t[k], t[(k + 1) % 3]].map(|v| piece.places[v as usize]);
            if a[axis] == far && b[axis] == far {
                let [a, b] = [a, b].map(|p| i64::from(p[1 - axis]));
                out.push((a.min(b), a.max(b)));
            }
        }
    }
    out.sort_unstable();
    out
}

/// The tile beyond a side.
fn beyond(tile: Tile, side: usize) -> Option<Tile> {
    let [x, y] = match side {
        0 => [tile.x.checked_sub(1)?, tile.y],
        1 => [tile.x, tile.y.checked_sub(1)?],
        2 => [tile.x + 1, tile.y],
        _ => [tile.x, tile.y + 1],
    };
    Some(Tile { x, y, ..tile })
}

#[test]
fn borders_of_one_zoom_are_the_same_to_the_bit() {
    for case in cases() {
        let pieces = cut_all(&case);
        let mut borders = 0;
        for (&tile, piece) in &pieces {
            for side in [2, 3] {
                let Some(other) = beyond(tile, side).and_then(|t| pieces.get(&t)) else { continue };
                assert_eq!(edges(piece, side), edges(other, side - 2), "{}: {tile:?} side {side}", case.name);
                let touched = |piece: &TilePiece, side: usize| -> Vec<(i64, i64)> {
                    let edges = edges(piece, side);
                    let used = |s: i64| edges.iter().any(|&(a, b)| a == s || b == s);
                    line(piece, side).into_iter().filter(|&(s, _)| used(s)).collect()
                };
                assert_eq!(touched(piece, side), touched(other, side - 2), "{}: {tile:?} side {side}", case.name);
                borders += usize::from(!edges(piece, side).is_empty());
            }
        }
        assert!(borders > 10, "{}: {borders}", case.name);
    }
}

#[test]
fn borders_of_different_zooms_are_the_same_line() {
    for case in cases() {
        let surface = build(case.field.clone(), &BuildOptions::default()).unwrap();
        let closed = Cutter::new(&surface, &case.placement, &case.options).closed_from();
        let pieces = cut_all(&case);
        let mut pairs = 0;
        for (&coarse, piece) in pieces.iter().filter(|(t, _)| t.zoom >= closed) {
            for side in 0..4 {
                let Some(next) = beyond(coarse, side) else { continue };
                let ground = edges(piece, side);
                let coarse_line: HashMap<i64, i64> = line(piece, side).into_iter().collect();
                // all tiles of finer zooms along the side
                for zoom in coarse.zoom + 1..=case.options.zooms[1] {
                    let up = zoom - coarse.zoom;
                    for along in 0..1u32 << up {
                        let near = if side < 2 { (1 << up) - 1 } else { 0 };
                        let [x, y] = if side % 2 == 0 { [near, along] } else { [along, near] };
                        let fine = Tile { zoom, x: (next.x << up) + x, y: (next.y << up) + y };
                        let Some(other) = pieces.get(&fine) else { continue };
                        pairs += 1;
                        let fine_ground = edges(other, (side + 2) % 4);
                        // in steps of the fine tile, from the coarse one's corner
                        let offset = i64::from(along) * LAST;
                        for (s, h) in line(other, (side + 2) % 4) {
                            if !fine_ground.iter().any(|&(a, b)| a == s || b == s) {
                                continue;
                            }
                            let at = s + offset;
                            let Some(&(a, b)) = ground.iter().find(|&&(a, b)| a << up <= at && at <= b << up) else {
                                // the ground ends between two steps of the coarse tile
                                let is_end = |e: i64| ((e << up) - at).abs() < 1 << up;
                                let ends = ground.iter().any(|&(a, b)| is_end(a) || is_end(b));
                                assert!(ends, "{}: {fine:?} has ground where {coarse:?} has none", case.name);
                                continue;
                            };
                            let (ha, hb) = (coarse_line[&a], coarse_line[&b]);
                            let (da, db) = (at - (a << up), (b << up) - at);
                            assert_eq!(
                                h * (da + db),
                                ha * db + hb * da,
                                "{}: {coarse:?} {fine:?} {side} {s}",
                                case.name
                            );
                        }
                        // and every vertex of the coarse one is there
                        for a in ground.iter().flat_map(|&(a, b)| [a, b]) {
                            let s = (a << up) - offset;
                            if 0 < s && s < LAST {
                                let at_vertex = fine_ground.iter().any(|&(p, q)| p == s || q == s);
                                assert!(at_vertex, "{}: {coarse:?} has a vertex that {fine:?} lacks", case.name);
                            }
                        }
                    }
                }
            }
        }
        assert!(pairs > 30, "{}: {pairs}", case.name);
    }
}

/// Calls `f` with each sample with data in or on a tile, its place on the tile's lattice and its height.
fn samples(case: &Case, tile: Tile, mut f: impl FnMut([f64; 2], f64)) {
    let scale = f64::from(1u32 << tile.zoom);
    for row in 0..case.field.height() {
        for column in 0..case.field.width() {
            let z = case.field.at(column, row);
            let [x, y] = case.placement.place([column as u32, row as u32]);
            let [u, v] = [x * scale - f64::from(tile.x), y * scale - f64::from(tile.y)].map(|k| k * f64::from(GRID));
            let within = 0.0..=f64::from(GRID);
            if !z.is_nan() && within.contains(&u) && within.contains(&v) {
                f([u, v], f64::from(z));
            }
        }
    }
}

/// Height of a triangle at a place in or on it.
fn height_at(piece: &TilePiece, t: [u32; 3], [u, v]: [f64; 2]) -> Option<f64> {
    let [a, b, c] = t.map(|i| piece.places[i as usize].map(f64::from));
    let cross = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
    let area = cross(a, b, c);
    let at = [u, v];
    let w = [cross(at, b, c) / area, cross(a, at, c) / area, cross(a, b, at) / area];
    let z = t.map(|i| piece.heights_m[i as usize]);
    w.iter().all(|&w| w >= -1e-9).then(|| w[0] * z[0] + w[1] * z[1] + w[2] * z[2])
}

#[test]
fn no_sample_is_further_than_declared() {
    for case in cases() {
        let pieces = cut_all(&case);
        let (mut measured, mut worst_share) = (0, 0f64);
        let last = case.options.zooms[1];
        let declared_m = pieces.iter().filter(|(t, _)| t.zoom == last).map(|(_, p)| p.error_m).fold(0.0, f64::max);
        println!("{}: {declared_m} m declared of {} m", case.name, case.options.tolerance_m);
        for (&tile, piece) in &pieces {
            let mut boxes: Vec<([f64; 2], [f64; 2], [u32; 3])> = Vec::new();
            for &t in &piece.triangles {
                let p = t.map(|i| piece.places[i as usize].map(f64::from));
                let low = [0, 1].map(|k| p[0][k].min(p[1][k]).min(p[2][k]) - 1e-6);
                let high = [0, 1].map(|k| p[0][k].max(p[1][k]).max(p[2][k]) + 1e-6);
                boxes.push((low, high, t));
            }
            // a sample without neighbours is in no triangle of the ground, but may be in one of the rim
            if case.options.fill_m.is_some() && case.field.no_data_count() > 0 {
                continue;
            }
            samples(&case, tile, |at, z| {
                for (low, high, t) in &boxes {
                    if (0..2).any(|k| at[k] < low[k] || at[k] > high[k]) {
                        continue;
                    }
                    if let Some(height) = height_at(piece, *t, at) {
                        measured += 1;
                        worst_share = worst_share.max((height - z).abs() / piece.error_m);
                        let error_m = (height - z).abs();
                        assert!(
                            error_m <= piece.error_m + 1e-4,
                            "{}: {tile:?} at {at:?}: {error_m} m off, {} declared",
                            case.name,
                            piece.error_m
                        );
                    }
                }
            });
        }
        assert!(measured > 1000 || case.options.fill_m.is_some());
        println!("{}: {measured} measured, at worst {worst_share:.3} of what is declared", case.name);
    }
}

#[test]
fn tiles_within_the_ground_are_covered_once() {
    for case in cases().into_iter().filter(|c| c.field.no_data_count() == 0) {
        let bounds = case.placement.bounds();
        let mut whole = 0;
        for (&tile, piece) in &cut_all(&case) {
            let area: i64 = piece
                .triangles
                .iter()
                .map(|t| {
                    let [a, b, c] = t.map(|i| piece.places[i as usize].map(i64::from));
                    let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
                    assert!(area > 0);
                    area
                })
                .sum();
            let side = 1.0 / f64::from(1u32 << tile.zoom);
            // a warped grid does not fill its bounds
            let inset = if case.placement.is_warped() { 0.06 * (bounds[0][1] - bounds[0][0]) } else { 0.0 };
            let inside = [tile.x, tile.y]
                .into_iter()
                .zip(bounds)
                .all(|(k, [low, high])| f64::from(k) * side >= low + inset && f64::from(k + 1) * side <= high - inset);
            if inside || case.options.fill_m.is_some() {
                whole += 1;
                // where rows bend, a triangle at a corner of the rim may lie over its neighbour by a step
                let spare = if case.placement.is_warped() { LAST * LAST / 500_000 } else { 0 };
                assert!((area - 2 * LAST * LAST).abs() <= spare, "{}: {tile:?} {area}", case.name);
            }
        }
        assert!(whole > 0, "{}", case.name);
    }
}
