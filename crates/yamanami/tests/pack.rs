//! A packed surface is the database's bytes in another order: whole, by ranges, and as a file.

use proptest::prelude::*;
use std::path::{Path, PathBuf};
use yamanami::core::{Lattice, PageId};
use yamanami::io::pack::layout::{PREFIX_BYTES, PackHead, PackKind};
use yamanami::io::pack::{PackSource, write_pack};
use yamanami::io::store::{PageCodec, TerrainStore, row_id};
use yamanami::multires::tin::{DelaunayOptions, triangulate};
use yamanami::{ModelBuild, ModelStoreOptions, StoreOptions, Terrain};
use yamanami_testkit::{Holes, Survey, SyntheticTerrain, models};

fn terrain(folder: &Path) -> PathBuf {
    let path = folder.join("t.yama");
    let field = SyntheticTerrain::mountains(530, 401, 3).with_holes(Holes::Discs { count: 9, seed: 4 }).to_field();
    let grid = Terrain::build(field, "山 \"t\"".to_owned(), &|_| ()).unwrap();
    grid.store_as(&path, &StoreOptions::default(), &|_| ()).unwrap();
    path
}

fn model(folder: &Path) -> PathBuf {
    let path = folder.join("m.yama");
    let built = ModelBuild::of_mesh(&models::torus(120, 80, 0.1), "m".to_owned(), &|_| ()).unwrap();
    built.store_as(&path, &ModelStoreOptions::default(), &|_| ()).unwrap();
    path
}

fn tin(folder: &Path) -> PathBuf {
    let path = folder.join("tin.yama");
    let survey = Survey { size_m: [300.0, 200.0], spacing_m: 5.0, seed: 1 };
    let made = triangulate(&survey.points(), &survey.breaklines(), &DelaunayOptions::default()).unwrap();
    let built = ModelBuild::of_tin(&made.tin, "tin".to_owned(), &|_| ()).unwrap();
    built.store_as(&path, &ModelStoreOptions::default(), &|_| ()).unwrap();
    path
}

/// A reader that has nothing but the packed bytes: all entries are whole, and each section is as long as it says.
fn check(bytes: &[u8]) -> PackHead {
    let name = Path::new("packed");
    let head = PackHead::parse(name, bytes).unwrap();
    assert_eq!(head.bytes, bytes.len() as u64);
    let lattice = head.terrain().map(|m| Lattice::new(m.size[0] as usize, m.size[1] as usize));
    for section in &head.sections {
        let range = section.index_range(0, section.entries);
        let entries = section.parse_entries(name, 0, &bytes[range.start as usize..range.end as usize]).unwrap();
        for (number, entry) in (0..).zip(entries) {
            let row = lattice.as_ref().map_or_else(|_| section.model_row(number), |l| section.terrain_row(l, number));
            let data = &bytes[entry.offset as usize..][..entry.length as usize];
            assert!(entry.is_whole(row.unwrap(), data), "{} {number}", section.name);
        }
    }
    head
}

#[test]
fn the_file_is_what_the_database_gives_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (path, kind) in [(terrain(at), PackKind::Terrain), (model(at), PackKind::Model), (tin(at), PackKind::Tin)] {
        let source = PackSource::open(&path).unwrap();
        let packed = folder.path().join("surface.pack");
        write_pack(&source, &packed, &|_| ()).unwrap();
        let bytes = std::fs::read(&packed).unwrap();
        assert_eq!(bytes, source.read(0..source.bytes()).unwrap());
        assert_eq!(source.head().sections[0].index_at % 16, 0);
        assert!(bytes.len() as u64 <= std::fs::metadata(&path).unwrap().len());
        let head = check(&bytes);
        assert_eq!((head.kind, &head), (kind, source.head()));
        assert_eq!(
            PackHead::length(&packed, &bytes[..PREFIX_BYTES]).unwrap().next_multiple_of(16),
            head.sections[0].index_at as usize
        );
    }
}

#[test]
fn a_page_is_read_without_the_database() {
    let folder = tempfile::tempdir().unwrap();
    let path = terrain(folder.path());
    let (source, store) = (PackSource::open(&path).unwrap(), TerrainStore::open(&path).unwrap());
    let meta = source.head().terrain().unwrap();
    assert_eq!(&meta, store.meta());
    let codec =
        PageCodec::new(meta.size, meta.quantum, meta.has_holes, meta.error_steps_per_octave, meta.level0_slack_m)
            .unwrap();
    let section = &source.head().sections[0];
    let level = section.level.unwrap();
    let index = source.read(section.index_range(0, 1)).unwrap();
    let entry = section.parse_entries(&path, 0, &index).unwrap()[0];
    let bytes = source.read(entry.offset..entry.offset + u64::from(entry.length)).unwrap();
    let id = PageId { level, x: 0, y: 0 };
    assert!(entry.is_whole(row_id(id), &bytes));
    assert_eq!(codec.decode_page(id, &bytes, None).unwrap(), *store.page(id).unwrap());
}

#[test]
fn ranges_are_slices_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    for path in [terrain(folder.path()), model(folder.path())] {
        let source = PackSource::open(&path).unwrap();
        let whole = source.read(0..source.bytes()).unwrap();
        let end = whole.len() as u64;
        proptest!(ProptestConfig::with_cases(64), |(a in 0..end, length in 0u64..5000, about in 0u64..3000)| {
            let b = (a + length).min(end);
            let slice = &whole[a as usize..b as usize];
            prop_assert_eq!(source.read(a..b).unwrap(), slice);
            let piece = source.read_piece(a..b, about).unwrap();
            prop_assert!(slice.starts_with(&piece) && piece.is_empty() == slice.is_empty());
        });
        assert!(source.read(end..end).unwrap().is_empty());
        source.read(0..end + 1).unwrap_err();
        source.read(u64::MAX - 1..u64::MAX).unwrap_err();
    }
}

#[test]
fn another_surface_has_another_tag() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (terrain(folder.path()), model(folder.path()));
    let tag = |path: &Path| PackSource::open(path).unwrap().tag();
    assert_eq!(tag(&a), tag(&a));
    assert_ne!(tag(&a), tag(&b));
}

#[test]
fn a_damaged_database_is_an_error_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = terrain(folder.path());
    let mut bytes = std::fs::read(&path).unwrap();
    let (source, packed) = (PackSource::open(&path).unwrap(), folder.path().join("surface.pack"));
    let middle = bytes.len() / 2;
    bytes[middle..middle + 3000].fill(0xAA);
    std::fs::write(&path, &bytes).unwrap();
    let error = write_pack(&source, &packed, &|_| ()).unwrap_err().to_string();
    assert!(error.contains("t.yama") && !error.contains('\n'), "{error}");
    assert!(!packed.exists());
    std::fs::write(&path, &bytes[..middle]).unwrap();
    PackSource::open(&path).unwrap_err();
    write_pack(&source, &packed, &|_| ()).unwrap_err();
}
