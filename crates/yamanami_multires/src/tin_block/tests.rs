//! Blocks of all mixes of levels: no gap, no T-vertex, nothing turned over.

use super::*;
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use yamanami_core::TriangleMesh;
use yamanami_testkit::laws::Kind;
use yamanami_testkit::{Rng, check_conforming};

/// A rough grid of `side`² cells whose inner vertices are moved about.
pub(super) fn rough_tin(side: u32, seed: u64) -> TriangleMesh {
    let mut rng = Rng::new(seed);
    let mut positions = Vec::new();
    for (y, x) in (0..=side).flat_map(|y| (0..=side).map(move |x| (y, x))) {
        let is_inner = x > 0 && y > 0 && x < side && y < side;
        let mut shift = || if is_inner { 0.4 * (rng.unit() - 0.5) } else { 0.0 };
        let (dx, dy) = (shift(), shift());
        let hill = (f64::from(x) * 0.7).sin() * (f64::from(y) * 0.4).cos();
        positions.push(DVec3::new(10.0 * (f64::from(x) + dx), 10.0 * (f64::from(y) + dy), 8.0 * hill + rng.unit()));
    }
    let mut triangles = Vec::new();
    for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
        let a = y * (side + 1) + x;
        let [b, c, d] = [a + 1, a + side + 2, a + side + 1];
        triangles.extend(if (x + y) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    }
    TriangleMesh::new(positions, triangles)
}

fn blocks_of(source: &TriangleMesh, levels: usize, columns: usize, rows: usize) -> TinBlocks {
    let chain = centroid_chain(source, levels, CostReading::Plain).unwrap();
    let bounds = source.bounds();
    let extent = (bounds.max - bounds.min).truncate();
    let grid = BlockGrid::new(bounds.min.truncate(), extent / DVec2::new(columns as f64, rows as f64), [columns, rows]);
    TinBlocks::new(&chain, grid.unwrap()).unwrap()
}

/// What is shown is one surface over the whole ground, in each block as many triangles as its own or more.
fn check(blocks: &TinBlocks, shown: &[u8], kind: Kind) -> Result<(), String> {
    let base = blocks.mesh(&vec![0; shown.len()]);
    check_conforming(&blocks.mesh(shown), &base, kind)?;
    for block in 0..shown.len() {
        let (mut all, mut one_by_one) = (Vec::new(), Vec::new());
        let joined = blocks.joined(block, shown);
        joined.all(&mut all);
        let own = blocks.triangles(block, joined.level());
        (0..own.len()).for_each(|t| joined.one(t, &mut one_by_one));
        if all != one_by_one || all.len() < own.len() {
            return Err(format!("block {block}: {} triangles, {} one by one", all.len(), one_by_one.len()));
        }
        let bounds = blocks.bounds(block);
        let inside = |v: &u32| {
            bounds.is_some_and(|b| {
                let p = blocks.positions()[*v as usize];
                p.cmpge(b.min).all() && p.cmple(b.max).all()
            })
        };
        if !all.as_flattened().iter().all(inside) {
            return Err(format!("block {block} leaves its box"));
        }
    }
    Ok(())
}

#[test]
fn any_two_levels_meet_without_a_gap() {
    let blocks = blocks_of(&rough_tin(15, 3), 4, 2, 2);
    for mix in 0..256usize {
        let shown: Vec<u8> = (0..4).map(|block| (mix >> (2 * block) & 3) as u8).collect();
        assert_eq!(check(&blocks, &shown, Kind::Terrain), Ok(()), "{shown:?}");
    }
}

#[test]
fn beside_its_own_level_a_block_is_as_it_was_cut() {
    let source = rough_tin(20, 5);
    let blocks = blocks_of(&source, 3, 3, 2);
    for level in 0..3u8 {
        let mesh = blocks.mesh(&[level; 6]);
        assert_eq!(mesh.triangles.len(), blocks.triangle_count(usize::from(level)));
    }
    assert_eq!(blocks.error_m(0), 0.0);
    assert!(blocks.error_m(1) > 0.0 && blocks.error_m(2) > 0.0);
}

#[test]
fn links_name_all_triangles_at_a_vertex() {
    let blocks = blocks_of(&rough_tin(12, 6), 2, 2, 2);
    for (block, level) in (0..4).flat_map(|block| (0..2).map(move |level| (block, level))) {
        let own = blocks.triangles(block, level);
        for &v in own.as_flattened() {
            let expected: Vec<usize> = (0..own.len()).filter(|&t| own[t].contains(&v)).collect();
            assert_eq!(blocks.linked(block, level, v).collect::<Vec<_>>(), expected);
        }
    }
}

#[test]
fn holes_and_empty_blocks_are_no_gap() {
    let mut source = rough_tin(30, 8);
    // a hole across a crossing of lines, one across a side, and a block without ground
    let middle = |mesh: &TriangleMesh, t: usize| mesh.corners(t).iter().sum::<DVec3>().truncate() / 3.0;
    let keep: Vec<bool> = (0..source.triangles.len())
        .map(|t| {
            let p = middle(&source, t);
            p.distance(DVec2::splat(100.0)) > 24.0
                && p.distance(DVec2::new(200.0, 150.0)) > 31.0
                && p.min_element() < 193.0
        })
        .collect();
    let mut kept = keep.iter();
    source.triangles.retain(|_| kept.next() == Some(&true));
    let blocks = blocks_of(&source, 4, 3, 3);
    assert_eq!(blocks.bounds(8), None);
    let mut rng = Rng::new(4);
    for _ in 0..60 {
        let shown: Vec<u8> = (0..9).map(|_| rng.below(4) as u8).collect();
        assert_eq!(check(&blocks, &shown, Kind::TerrainWithHoles), Ok(()), "{shown:?}");
        // no mix has another border than the source
        assert_eq!(border(&blocks.mesh(&shown)), border(&blocks.mesh(&[0; 9])));
    }
}

/// Border edges by their places.
fn border(mesh: &TriangleMesh) -> std::collections::BTreeSet<[[u64; 3]; 2]> {
    let mut edges = std::collections::BTreeSet::new();
    for t in 0..mesh.triangles.len() {
        let places = mesh.corners(t).map(|p| p.to_array().map(f64::to_bits));
        for k in 0..3 {
            let (p, q) = (places[k], places[(k + 1) % 3]);
            if !edges.remove(&[q, p]) {
                edges.insert([p, q]);
            }
        }
    }
    edges
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn random_levels_of_random_blocks_are_one_surface(
        seed in any::<u64>(), side in 6u32..20, columns in 1usize..6, rows in 1usize..6, levels in 1usize..5,
    ) {
        let blocks = blocks_of(&rough_tin(side, seed), levels, columns, rows);
        let mut rng = Rng::new(seed);
        for _ in 0..6 {
            let shown: Vec<u8> = (0..columns * rows).map(|_| rng.below(levels) as u8).collect();
            prop_assert_eq!(check(&blocks, &shown, Kind::Terrain), Ok(()));
        }
    }
}
