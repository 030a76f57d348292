//! The laws of 3D Tiles of models and terrains: no crack at any mix of levels, and errors that hold.

use super::model_cells::Plan;
use super::placement::Placement;
use super::terrain_3d::{Ground, tile_place};
use super::terrain_tiles::TerrainTiles;
use super::tileset_files::TilePlace;
use super::{ExportOptions, GeoidChoice, HeightKind};
use crate::{Model, ModelBuild, Subject, Terrain};
use glam::DVec3;
use std::collections::{BTreeMap, HashMap, HashSet};
use yamanami_core::{GeoReference, HeightField};
use yamanami_core::{Tin, TriangleMesh};
use yamanami_io::crs::from_epsg;
use yamanami_io::tiles::glb::LatticeMesh;
use yamanami_measure::SurfaceIndex;
use yamanami_multires::tiles::CutScratch;
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain, models};

struct Cut {
    parts: BTreeMap<TilePlace, (LatticeMesh, f64)>,
    step_m: f64,
    levels: usize,
}

fn cut(model: &Model, placement: Option<Placement>, leaf_error_m: f64, leaf_triangles: i64) -> Cut {
    let plan = Plan::of(model, placement, leaf_error_m, leaf_triangles);
    let part = |&(tile, is_leaf): &(TilePlace, bool)| {
        let (front, error_m) = plan.front(tile, is_leaf, model.surface());
        let (part, sag_m) = plan.part(tile, &front, model).unwrap();
        (tile, (part, error_m + sag_m))
    };
    let levels = plan.tiles.iter().map(|((level, _), _)| *level as usize + 1).max().unwrap();
    Cut { parts: plan.tiles.iter().map(part).collect(), step_m: plan.cells.step_m, levels }
}

type Edge = [[i64; 3]; 2];

/// The border of triangles as a chain: how often each edge is run along one way more than the other.
fn add_border(chain: &mut HashMap<Edge, i64>, mesh: &LatticeMesh, sign: i64) {
    for t in &mesh.triangles {
        for k in 0..3 {
            let [a, b] = [t[k], t[(k + 1) % 3]].map(|v| mesh.places[v as usize]);
            let (edge, way) = if a < b { ([a, b], sign) } else { ([b, a], -sign) };
            *chain.entry(edge).or_default() += if a == b { 0 } else { way };
        }
    }
}

/// What a tile's border is, the borders of its children are together. So every mix of levels has the border of the root: no
/// crack anywhere. The border of the source itself, between `outer` places, may get sharper; and of three places so many steps
/// apart, in a row, one may be left out.
fn check_seams(cut: &Cut, outer: &HashSet<[i64; 3]>, near: u64) {
    let mut parents = 0;
    for (&(level, place), (parent, _)) in &cut.parts {
        let children: Vec<&LatticeMesh> = cut
            .parts
            .iter()
            .filter(|((l, p), _)| *l == level + 1 && p.map(|c| c >> 1) == place)
            .map(|(_, (part, _))| part)
            .collect();
        if children.is_empty() {
            continue;
        }
        parents += 1;
        let mut chain = HashMap::new();
        add_border(&mut chain, parent, 1);
        children.iter().for_each(|child| add_border(&mut chain, child, -1));
        let is_outer = |edge: &Edge| edge.iter().all(|p| outer.contains(p));
        let torn: Vec<(&Edge, &i64)> = chain
            .iter()
            .filter(|&(edge, &n)| n != 0 && !is_outer(edge))
            .filter(|([a, b], _)| (0..3).any(|k| a[k].abs_diff(b[k]) > near))
            .collect();
        assert!(torn.is_empty(), "tile {level} {place:?}: {torn:?}");
    }
    assert!(parents > 3 && cut.levels > 2, "{parents} tiles with children on {} levels", cut.levels);
}

/// Every tile is within its error of the source, and all tiles of a level (or leaves above it) of every vertex of the source.
fn check_errors(cut: &Cut, source: &TriangleMesh) {
    let metres = |p: &[i64; 3]| DVec3::from_array(p.map(|c| c as f64)) * cut.step_m;
    let index = SurfaceIndex::new(source);
    let is_leaf =
        |&(level, place): &TilePlace| !cut.parts.keys().any(|(l, p)| *l == level + 1 && p.map(|c| c >> 1) == place);
    for level in 0..cut.levels as u32 {
        let mut shown = TriangleMesh::default();
        let mut most_m = 0.0f64;
        let of_level = cut.parts.iter().filter(|(tile, _)| tile.0 == level || tile.0 < level && is_leaf(tile));
        for (tile, (part, error_m)) in of_level {
            let first = shown.positions.len() as u32;
            shown.positions.extend(part.places.iter().map(metres));
            shown.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
            most_m = most_m.max(*error_m);
            for t in part.triangles.iter().step_by(7) {
                let middle = t.iter().map(|&v| metres(&part.places[v as usize])).sum::<DVec3>() / 3.0;
                let off_m = index.closest(middle).unwrap().distance_m;
                assert!(off_m <= *error_m, "{tile:?}: {off_m} m off, {error_m} m promised");
            }
        }
        let back = SurfaceIndex::new(&shown);
        for &p in source.positions.iter().step_by(11) {
            let off_m = back.closest(p).unwrap().distance_m;
            assert!(off_m <= most_m, "level {level}: {off_m} m off, {most_m} m promised");
        }
    }
}

fn scan() -> (TriangleMesh, Model) {
    let mut mesh = models::torus(120, 80, 0.02);
    models::shake(&mut mesh, 0.001, 3);
    let model = ModelBuild::of_mesh(&mesh, "ring".to_owned(), &|_| ()).unwrap().into_model().unwrap();
    (mesh, model)
}

#[test]
fn tiles_of_a_scan_have_no_cracks_and_true_errors() {
    let (mesh, model) = scan();
    for leaf_error_m in [0.0, 0.004] {
        let cut = cut(&model, None, leaf_error_m, 1000);
        check_seams(&cut, &HashSet::new(), 0);
        check_errors(&cut, &mesh);
        if leaf_error_m == 0.0 {
            let root = &cut.parts[&(0, [0; 3])];
            assert!(root.0.triangles.len() < mesh.triangles.len() / 4, "{}", root.0.triangles.len());
        }
    }
}

#[test]
fn tiles_of_a_tin_on_the_globe_have_no_cracks_and_true_errors() {
    let terrain = SyntheticTerrain::new(120, 110, Shape::mountains(4), Spacing::Metres(40.0)).to_field();
    let at = |c: usize, r: usize| {
        DVec3::new(293e3 + 40.0 * c as f64, 3_915e3 - 40.0 * r as f64, f64::from(terrain.at(c, r)))
    };
    let positions = (0..110).flat_map(|r| (0..120).map(move |c| at(c, r))).collect();
    let quads = (0..109u32).flat_map(|r| (0..119u32).map(move |c| r * 120 + c));
    let triangles = quads.flat_map(|a| [[a, a + 120, a + 1], [a + 1, a + 120, a + 121]]).collect();
    let tin = Tin { crs: from_epsg(32654).unwrap(), ..Tin::of_mesh("hills", TriangleMesh::new(positions, triangles)) };
    let model = ModelBuild::of_tin(&tin, "hills".to_owned(), &|_| ()).unwrap().into_model().unwrap();
    let placed =
        Placement::of(&tin.crs, &model.bounds(), Some(HeightKind::Orthometric), &GeoidChoice::Egm96, &mut Vec::new());
    let placement = placed.unwrap().unwrap();
    let mut source = tin.mesh.clone();
    source.positions.iter_mut().for_each(|p| *p = placement.local(*p));
    let cut = cut(&model, Some(placement), 0.0, 1500);
    let outer = source.positions.iter().enumerate().filter(|(i, _)| {
        let (c, r) = (i % 120, i / 120);
        c == 0 || c == 119 || r == 0 || r == 109
    });
    let steps = |p: &DVec3| (*p / cut.step_m).round().to_array().map(|c| c as i64);
    check_seams(&cut, &outer.map(|(_, p)| steps(p)).collect(), 0);
    check_errors(&cut, &source);
    let normal =
        cut.parts[&(0, [0; 3])].0.normals.iter().fold(DVec3::ZERO, |sum, n| sum + DVec3::from_array(n.map(f64::from)));
    assert!(normal.normalize().z > 0.95);
}

/// A terrain's samples where they stand, and its tiles with the places on its outer border.
fn cut_terrain(field: HeightField, options: &ExportOptions) -> (TriangleMesh, Cut, HashSet<[i64; 3]>) {
    let [columns, rows] = [field.width(), field.height()].map(|n| (n - 1) as f64);
    let terrain = Terrain::build(field.clone(), "hills".to_owned(), &|_| ()).unwrap();
    let (ground, cut_options) = Ground::of(&terrain, options, &mut Vec::new()).unwrap();
    let cutter = TerrainTiles::new(&terrain, &ground.space, &cut_options);
    let mut cut = Cut { parts: BTreeMap::new(), step_m: ground.step_m, levels: cut_options.zooms[1] as usize + 1 };
    let mut outer = HashSet::new();
    for tile in (0..=cut_options.zooms[1]).flat_map(|zoom| cutter.tiles(zoom)) {
        let piece = cutter.cut(tile, &mut CutScratch::default()).unwrap();
        let (mesh, range) = ground.mesh(tile, &piece, &terrain).unwrap();
        assert_eq!(range.is_some(), ground.placement.is_some());
        for (&place, &steps) in piece.places.iter().zip(&mesh.places) {
            let [c, r] = ground.space.grid(tile_place(tile, place));
            if c.min(columns - c).min(r).min(rows - r) < 1e-2 {
                outer.insert(steps);
            }
        }
        cut.parts.insert((tile.zoom, [tile.x, tile.y, 0]), (mesh, ground.error_m(&piece)));
    }
    let mut samples = TriangleMesh::default();
    for r in 0..field.height() {
        for c in 0..field.width() {
            let z = f64::from(field.at(c, r));
            let [x, y] = terrain.geo().source_from_grid(c as f64, r as f64);
            let local = terrain.local_from_source(DVec3::new(x, y, z));
            samples.positions.push(ground.placement.as_ref().map_or(local, |p| p.local(DVec3::new(x, y, z))));
        }
    }
    (samples, cut, outer)
}

#[test]
fn tiles_of_terrains_have_no_cracks_and_true_errors() {
    let hills = SyntheticTerrain::new(300, 270, Shape::mountains(4), Spacing::Metres(40.0)).to_field();
    let heights = hills.heights_m().to_vec();
    let utm = GeoReference::new(from_epsg(32654).unwrap(), [290e3, 3_920e3], [40.0, -40.0], [300, 270]);
    let degrees = GeoReference::new(from_epsg(4326).unwrap(), [138.0, 35.5], [4e-4, -4e-4], [300, 270]);
    for geo in [utm, degrees, hills.geo().clone()] {
        let options = ExportOptions {
            tolerance_m: Some(4.0),
            zooms: Some([0, 3]),
            heights: Some(HeightKind::Ellipsoidal),
            ..ExportOptions::default()
        };
        let field = HeightField::new(300, 270, heights.clone(), geo);
        let (samples, cut, outer) = cut_terrain(field, &options);
        check_seams(&cut, &outer, 4);
        for level in 0..cut.levels as u32 {
            let (mut shown, mut most_m) = (TriangleMesh::default(), 0.0f64);
            for (part, error_m) in cut.parts.iter().filter(|(tile, _)| tile.0 == level).map(|(_, part)| part) {
                let first = shown.positions.len() as u32;
                shown.positions.extend(part.places.iter().map(|p| DVec3::from_array(p.map(|c| c as f64)) * cut.step_m));
                shown.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
                most_m = most_m.max(*error_m);
            }
            assert!(most_m < 20.0 * f64::from(8 >> level), "level {level}: {most_m} m");
            let index = SurfaceIndex::new(&shown);
            for &p in samples.positions.iter().step_by(41) {
                let off_m = index.closest(p).unwrap().distance_m;
                assert!(off_m <= most_m, "level {level}: {off_m} m off, {most_m} m promised");
            }
        }
        let leaf = &cut.parts[&(3, [3, 3, 0])].0;
        assert!(leaf.normals.iter().all(|n| n[2] > 0.3) && leaf.normals.len() == leaf.places.len());
    }
}
