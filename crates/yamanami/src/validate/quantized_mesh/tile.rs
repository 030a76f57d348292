//! The rules of a single quantized-mesh tile, once it is decoded.
//!
//! Based on: Cesium, "Quantized-mesh-1.0 terrain format", 2013 to 2024; Meyer et al., "On floating-point normal vectors",
//! 2010 (octahedral normals).

use super::pyramid::{GRID, Pyramid, Tile, TileId};
use glam::DVec3;
use yamanami_io::inspect::{Faults, QuantizedMesh, SIDE_NAMES};
use yamanami_measure::tiles::earth::{SEMI_MINOR_M, ecef_m, geodetic, horizon_excess, local_from_ecef};
use yamanami_measure::tiles::plan_faults;

/// Share of a tile that rounding of its border may leave.
const UNFILLED: f64 = 1e-6;

/// Judges a tile that was read.
pub(super) fn check(pyramid: &Pyramid, tile: &Tile, faults: &mut Faults) {
    check_alone(&tile.mesh, faults);
    let positions = pyramid.positions_m(tile.id, &tile.mesh);
    if check_place(pyramid, tile, faults) {
        check_bounds(tile, &positions, faults);
        check_normals(pyramid, tile, faults);
    }
    check_metadata(pyramid, tile, faults);
}

/// What can be said of a tile whose place is not known.
pub(super) fn check_alone(mesh: &QuantizedMesh, faults: &mut Faults) {
    check_plan(mesh, faults);
    check_sides(mesh, faults);
    check_heights(mesh, faults);
}

fn check_plan(mesh: &QuantizedMesh, faults: &mut Faults) {
    let plan = plan_faults(&mesh.vertices, &mesh.triangles, GRID as u16);
    let first = plan.first.map_or_else(String::new, |t| format!("triangle {t}"));
    if plan.degenerate > 0 {
        faults.add("QM09", first.clone(), "triangles with an area in plan", format!("{} without", plan.degenerate));
    }
    if plan.flipped > 0 {
        faults.add("QM10", first, "counter-clockwise triangles", format!("{} clockwise", plan.flipped));
    }
    if plan.open_edges > 0 && plan.flipped == 0 {
        let found = format!("{} edges with one", plan.open_edges);
        faults.add("QM25", "triangles", "two triangles at each inner edge", found);
    }
    let filled = plan.twice_area as f64 / (2.0 * GRID * GRID);
    if filled < 1.0 - UNFILLED {
        let found = format!("{:.4} % of it", 100.0 * filled);
        faults.add("QM19", "triangles", "the whole tile", found);
    } else if filled > 1.0 + UNFILLED {
        faults.add("QM20", "triangles", "the tile's area", format!("{:.4} times it", filled));
    }
}

fn check_sides(mesh: &QuantizedMesh, faults: &mut Faults) {
    let ends = [(0, 0), (1, 0), (0, GRID as u16), (1, GRID as u16)];
    for ((name, listed), (axis, value)) in SIDE_NAMES.iter().zip(&mesh.sides).zip(ends) {
        let vertices = &mesh.vertices;
        let off = listed.iter().filter(|&&k| vertices[k as usize][axis] != value);
        if let Some(first) = off.clone().next() {
            let found = format!("{} elsewhere, as vertex {first}", off.count());
            faults.add("QM11", format!("{name} side"), format!("vertices on the {name} side"), found);
        }
        let mut is_listed = vec![false; vertices.len()];
        listed.iter().for_each(|&k| is_listed[k as usize] = true);
        let missing = (0..vertices.len()).filter(|&k| vertices[k][axis] == value && !is_listed[k]);
        if let Some(first) = missing.clone().next() {
            let found = format!("{} not listed, as vertex {first}", missing.count());
            faults.add("QM12", format!("{name} side"), "all vertices on it", found);
        }
    }
}

/// Whether the tile lies where its name says.
fn check_place(pyramid: &Pyramid, tile: &Tile, faults: &mut Faults) -> bool {
    let centre = DVec3::from(tile.mesh.centre_m);
    // the middle of half a globe may lie deep within it
    if !centre.is_finite() || centre.length() < 0.8 * SEMI_MINOR_M {
        return centre.is_finite();
    }
    let [lon, lat, _] = geodetic(centre);
    let holds = |id: TileId| {
        let ([west, south], [east, north]) = (pyramid.place(id, [0.0; 2]), pyramid.place(id, [GRID; 2]));
        let margin = [0.01 * (east - west), 0.01 * (north - south)];
        (west - margin[0]..=east + margin[0]).contains(&lon) && (south - margin[1]..=north + margin[1]).contains(&lat)
    };
    if !holds(tile.id) {
        let flipped = TileId { y: (1 << tile.id.z) - 1 - tile.id.y, ..tile.id };
        let why = if holds(flipped) { ", where its row would be if counted from the other end" } else { "" };
        let [x, y] = pyramid.place(tile.id, [GRID / 2.0; 2]);
        let expected = format!("a centre near longitude {x:.5}, latitude {y:.5}");
        faults.add("QM21", "header", expected, format!("longitude {lon:.5}, latitude {lat:.5}{why}"));
        return false;
    }
    let [low, high] = tile.mesh.heights_m;
    let [x, y] = pyramid.place(tile.id, [GRID / 2.0; 2]);
    let own = ecef_m([x, y, (low + high) / 2.0]);
    let size = ecef_m([x, y, low]).distance({
        let [x, y] = pyramid.place(tile.id, [0.0; 2]);
        ecef_m([x, y, low])
    });
    if own.distance(centre) > 0.1 * size + (high - low) {
        faults.add("QM14", "header", "the tile's centre", format!("{:.0} m from it", own.distance(centre)));
    }
    true
}

fn check_bounds(tile: &Tile, positions: &[DVec3], faults: &mut Faults) {
    let (centre, radius) = (DVec3::from(tile.mesh.sphere_centre_m), tile.mesh.sphere_radius_m);
    let farthest = positions.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    if farthest > radius + (1e-6 * farthest).max(0.01) {
        faults.add(
            "QM13",
            "bounding sphere",
            format!("a radius of at least {farthest:.2} m"),
            format!("{radius:.2} m"),
        );
    }
    let excess = horizon_excess(tile.mesh.horizon_point, positions);
    let needed = DVec3::from(tile.mesh.horizon_point).length() + excess;
    // where half the globe is in a tile no point does; heights are rounded, and it goes with their square root
    if excess.is_finite() && excess > 1e-3 * (needed - 1.0) + 1e-8 {
        let found = format!("too low by {:.1} m", excess * SEMI_MINOR_M);
        faults.add("QM15", "horizon occlusion point", "a point that hides only what cannot be seen", found);
    }
}

/// A direction from two bytes.
fn normal([x, y]: [u8; 2]) -> DVec3 {
    let [x, y] = [x, y].map(|b| f64::from(b) / 255.0 * 2.0 - 1.0);
    let z = 1.0 - x.abs() - y.abs();
    let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
    let [x, y] = if z < 0.0 { [(1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y)] } else { [x, y] };
    DVec3::new(x, y, z).normalize_or_zero()
}

fn check_normals(pyramid: &Pyramid, tile: &Tile, faults: &mut Faults) {
    let downward = |(vertex, &n): (&[u16; 3], &[u8; 2])| {
        let place = pyramid.place(tile.id, [f64::from(vertex[0]), f64::from(vertex[1])]);
        // two bytes are right to a degree
        (local_from_ecef(place) * normal(n)).z < -0.03
    };
    let down = tile.mesh.vertices.iter().zip(&tile.mesh.normals).filter(|&pair| downward(pair)).count();
    if down > 0 {
        let found = format!("{down} of {} that point down", tile.mesh.vertices.len());
        faults.add("QM18", "normals", "Earth-centred normals that point up", found);
    }
}

fn check_heights(mesh: &QuantizedMesh, faults: &mut Faults) {
    let [low, high] = mesh.heights_m;
    let heights = || mesh.vertices.iter().map(|v| v[2]);
    let (Some(least), Some(most)) = (heights().min(), heights().max()) else { return };
    // what simplification removed may have been higher, but not by much
    if high - low > 1.0 && f64::from(most - least) < 0.5 * GRID {
        let [a, b] = [least, most].map(|h| mesh.height_m([0, 0, h]));
        faults.add("QM16", "header", format!("heights about {a:.1} to {b:.1} m"), format!("{low:.1} to {high:.1} m"));
    }
}

fn check_metadata(pyramid: &Pyramid, tile: &Tile, faults: &mut Faults) {
    let Some(metadata) = tile.mesh.metadata.as_ref() else { return };
    if pyramid.layer.as_ref().is_some_and(|layer| layer["metadataAvailability"].is_null()) {
        faults.add("QM27", "metadata", "none, or metadataAvailability in layer.json", "metadata");
    }
    let Some(levels) = metadata["available"].as_array() else { return };
    for (z, ranges) in (tile.id.z + 1..).zip(levels) {
        for range in ranges.as_array().into_iter().flatten() {
            let missing = super::layer::Range::of(range).and_then(|range| range.missing(pyramid, z));
            if let Some(id) = missing {
                faults.add("QM26", "metadata", format!("{} to be there", pyramid.name(id)), "no such file");
            }
        }
    }
}
