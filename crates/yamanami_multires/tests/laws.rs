//! The laws of the design page over the terrain quadtree: odd sizes, holes, and spacings from half a metre to 50 m.

use yamanami_core::{HeightSource, Hierarchy, MeshMirror, Surface};
use yamanami_multires::wavelet::{BuildOptions, GridData, TerrainSurface, build};
use yamanami_testkit::laws::{Kind, closure_law_of, ends_law, error_law, hierarchy_law, surface_law};
use yamanami_testkit::{Holes, Shape, Spacing, SyntheticTerrain};

fn terrains() -> Vec<SyntheticTerrain> {
    let mut all: Vec<_> = [
        (2, 2),
        (2, 9),
        (3, 3),
        (5, 17),
        (33, 33),
        (47, 20),
        (64, 65),
        (70, 61),
        (121, 90),
        (130, 31),
    ]
    .into_iter()
    .zip([Spacing::Metres(50.0), Spacing::ArcSeconds(1.0), Spacing::Metres(0.5)].into_iter().cycle())
    .map(|((w, h), spacing)| SyntheticTerrain::new(w, h, Shape::mountains(3), spacing))
    .collect();
    all.push(SyntheticTerrain::mountains(257, 257, 5));
    for holes in [
        Holes::Speckle { share: 0.05, seed: 1 },
        Holes::Discs { count: 6, seed: 2 },
        Holes::Border { samples: 7 },
        Holes::BeyondDiagonal,
    ] {
        all.push(SyntheticTerrain::mountains(70, 61, 3).with_holes(holes));
        all.push(SyntheticTerrain::mountains(65, 65, 4).with_holes(holes));
    }
    all
}

fn surface(terrain: &SyntheticTerrain) -> TerrainSurface<GridData> {
    build(terrain.to_field(), &BuildOptions::default()).unwrap_or_else(|e| panic!("{:?}: {e}", terrain.size()))
}

#[test]
fn every_terrain_obeys_the_hierarchy_law() {
    for terrain in terrains() {
        hierarchy_law(&surface(&terrain));
    }
}

#[test]
fn every_front_is_conforming() {
    for terrain in terrains() {
        let s = surface(&terrain);
        let kind = if terrain.to_field().no_data_count() > 0 { Kind::TerrainWithHoles } else { Kind::Terrain };
        closure_law_of(&s, 11, kind);
    }
}

#[test]
fn refining_then_coarsening_restores_the_sink() {
    for terrain in terrains() {
        surface_law(&surface(&terrain), 1);
    }
}

#[test]
fn the_full_front_is_the_source() {
    for terrain in terrains() {
        let field = terrain.to_field();
        ends_law(&surface(&terrain), &field, 0.0);
    }
}

#[test]
fn errors_bound_the_true_vertical_distance() {
    for terrain in terrains() {
        let field = terrain.to_field();
        error_law(&surface(&terrain), &field, &[0.0, 0.1, 1.0, 5.0, 20.0, 100.0]);
    }
}

#[test]
fn all_no_data_is_refused_in_one_line() {
    let field = SyntheticTerrain::mountains(9, 9, 1).with_holes(Holes::All).to_field();
    let error = build(field, &BuildOptions::default()).unwrap_err().to_string();
    assert_eq!(error, "nothing to build: of 9x9 samples, 81 have no data and no triangle is left");
}

#[test]
fn node_numbers_run_from_coarse_to_fine() {
    let s = surface(&SyntheticTerrain::mountains(40, 29, 2));
    let levels: Vec<u32> = (0..s.node_bound()).map(|n| s.level(n)).collect();
    assert!(levels.is_sorted());
}

#[test]
fn a_front_emitted_whole_is_the_front_reached_by_steps() {
    for terrain in terrains() {
        let s = surface(&terrain);
        let active = |node: u32| s.error_m(node) > 8.0;
        let mut by_steps = MeshMirror::default();
        s.emit_base(&mut by_steps);
        for node in (0..s.node_bound()).filter(|&n| s.exists(n) && active(n)) {
            s.refine(node, &|n: u32| n < node && s.exists(n) && active(n), &mut by_steps);
        }
        let mut whole = MeshMirror::default();
        s.emit_front(&active, &mut whole);
        assert_eq!(whole.triangles, by_steps.triangles);
        assert_eq!(whole.vertices, by_steps.vertices, "{:?}", terrain.size());
    }
}
