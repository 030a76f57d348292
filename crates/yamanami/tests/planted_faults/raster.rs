//! Height pictures of two zooms, as a folder and as PMTiles.

use super::{assert_finds, assert_sound, edit};
use std::path::Path;
use yamanami::ValidateOptions;
use yamanami::io::dem::TileEncoding;
use yamanami::io::tiles::encode_height_png;

const SIDE: u32 = 256;

/// A tile's picture of ground that is the same where the globe closes.
fn picture([z, x, y]: [u32; 3], side: u32, lift_m: f32) -> Vec<u8> {
    let pixels = (0..side * side).map(|k| {
        let at =
            |tile: u32, pixel: u32| (f64::from(tile) + (f64::from(pixel) + 0.5) / f64::from(side)) / f64::from(1 << z);
        let (u, v) = (at(x, k % side), at(y, k / side));
        (900.0 * (2.0 * u - 1.0).abs() + 700.0 * v) as f32 + 100.0 + lift_m
    });
    encode_height_png(TileEncoding::TerrainRgb, &pixels.collect::<Vec<_>>(), side)
}

fn places() -> Vec<[u32; 3]> {
    vec![[0, 0, 0], [1, 0, 0], [1, 0, 1], [1, 1, 1], [1, 1, 0]]
}

fn folder_of_tiles(folder: &Path) {
    for [z, x, y] in places() {
        let path = folder.join(format!("{z}/{x}/{y}.png"));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, picture([z, x, y], SIDE, 0.0)).unwrap();
    }
}

fn options() -> ValidateOptions {
    let mut options = ValidateOptions::default();
    options.dem.tile_encoding = Some(TileEncoding::TerrainRgb);
    options
}

#[test]
fn faults_of_pictures_are_found() {
    type Spoil = fn(&Path);
    let faults: [(&str, Spoil); 5] = [
        ("RT01", |f| edit(&f.join("1/0/0.png"), |b| b.truncate(b.len() / 2))),
        ("RT02", |f| std::fs::write(f.join("1/0/0.png"), picture([1, 0, 0], 128, 0.0)).unwrap()),
        ("RT04", |f| {
            // rows counted from the south
            let (a, b) = (f.join("1/0/0.png"), f.join("1/0/1.png"));
            std::fs::rename(&a, f.join("x")).unwrap();
            std::fs::rename(&b, &a).unwrap();
            std::fs::rename(f.join("x"), &b).unwrap();
        }),
        ("RT05", |f| std::fs::write(f.join("1/0/0.png"), picture([1, 0, 0], SIDE, 60.0)).unwrap()),
        ("RT06", |f| {
            std::fs::create_dir_all(f.join("3/0")).unwrap();
            std::fs::write(f.join("3/0/0.png"), picture([3, 0, 0], SIDE, 0.0)).unwrap();
        }),
    ];
    let folder = tempfile::tempdir().unwrap();
    folder_of_tiles(folder.path());
    assert_sound(folder.path(), &options());
    for (code, spoil) in faults {
        let folder = tempfile::tempdir().unwrap();
        folder_of_tiles(folder.path());
        spoil(folder.path());
        assert_finds(folder.path(), &options(), code);
    }
}

/// An archive of the same tiles, one directory, nothing packed.
fn archive(count: u64, first_offset: u64) -> Vec<u8> {
    let (mut data, mut directory) = (Vec::new(), vec![5u8]);
    let mut lengths = Vec::new();
    for place in places() {
        let tile = picture(place, SIDE, 0.0);
        lengths.push(tile.len() as u64);
        data.extend(tile);
    }
    let varint = |out: &mut Vec<u8>, mut v: u64| {
        while v >= 128 {
            out.push(v as u8 | 128);
            v >>= 7;
        }
        out.push(v as u8);
    };
    // differences of numbers, runs, lengths, offsets
    directory.extend([0, 1, 1, 1, 1, 1, 1, 1, 1, 1]);
    lengths.iter().for_each(|&length| varint(&mut directory, length));
    varint(&mut directory, first_offset + 1);
    directory.extend([0, 0, 0, 0]);
    let metadata = b"{}";
    let mut file = b"PMTiles\x03".to_vec();
    let root = (127, directory.len() as u64);
    let meta = (root.0 + root.1, metadata.len() as u64);
    let leaves = (meta.0 + meta.1, 0);
    let tiles = (leaves.0, data.len() as u64);
    for (start, size) in [root, meta, leaves, tiles] {
        file.extend(start.to_le_bytes());
        file.extend(size.to_le_bytes());
    }
    [count, 5, 5].iter().for_each(|n| file.extend(n.to_le_bytes()));
    file.extend([1, 1, 1, 2, 0, 1]);
    [-1_800_000_000i32, -850_000_000, 1_800_000_000, 850_000_000].iter().for_each(|v| file.extend(v.to_le_bytes()));
    file.resize(127, 0);
    file.extend(directory);
    file.extend(metadata);
    file.extend(data);
    file
}

#[test]
fn faults_of_pmtiles_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pmtiles");
    std::fs::write(&path, archive(5, 0)).unwrap();
    assert_eq!(assert_sound(&path, &options()).tiles, [5, 5]);
    for (code, bytes) in [("PM05", archive(9, 0)), ("PM02", archive(5, 1 << 30)), ("PM04", archive(5, 9))] {
        std::fs::write(&path, bytes).unwrap();
        assert_finds(&path, &options(), code);
    }
    let spoil = |at: usize, value: u8| {
        let mut bytes = archive(5, 0);
        bytes[at] = value;
        std::fs::write(&path, bytes).unwrap();
    };
    for (code, at, value) in [("PM01", 7, 2), ("PM03", 127, 99), ("PM07", 101, 4), ("PM11", 99, 3)] {
        spoil(at, value);
        assert_finds(&path, &options(), code);
    }
    std::fs::write(&path, &archive(5, 0)[..100]).unwrap();
    assert_finds(&path, &options(), "PM01");
}
