//! An archive is read back by a reader that knows nothing of the writer.

use super::*;
use flate2::read::GzDecoder;
use std::collections::BTreeMap;

fn varint(bytes: &mut &[u8]) -> u64 {
    let (mut n, mut shift) = (0, 0);
    loop {
        let byte = bytes[0];
        *bytes = &bytes[1..];
        n |= u64::from(byte & 0x7F) << shift;
        shift += 7;
        if byte < 0x80 {
            return n;
        }
    }
}

/// All tiles of an archive by number.
fn read(bytes: &[u8]) -> BTreeMap<u64, Vec<u8>> {
    let word = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    assert_eq!(&bytes[..8], b"PMTiles\x03");
    assert!(word(8) + word(16) <= 16384);
    let mut tiles = BTreeMap::new();
    let mut waiting = vec![(word(8), word(16))];
    while let Some((at, length)) = waiting.pop() {
        let mut raw = Vec::new();
        GzDecoder::new(&bytes[at..at + length]).read_to_end(&mut raw).unwrap();
        let mut rest = &raw[..];
        let count = varint(&mut rest) as usize;
        let mut column = || (0..count).map(|_| varint(&mut rest)).collect::<Vec<u64>>();
        let [steps, runs, lengths, offsets] = [column(), column(), column(), column()];
        let (mut tile, mut next) = (0, 0);
        for i in 0..count {
            tile += steps[i];
            let offset = if offsets[i] == 0 { next } else { offsets[i] as usize - 1 };
            next = offset + lengths[i] as usize;
            if runs[i] == 0 {
                waiting.push((word(40) + offset, lengths[i] as usize));
                continue;
            }
            for k in 0..runs[i] {
                tiles.insert(tile + k, bytes[word(56) + offset..word(56) + next].to_vec());
            }
        }
    }
    assert_eq!(tiles.len(), word(72));
    tiles
}

#[test]
fn numbers_follow_hilbert_s_curve() {
    let numbers =
        |zoom: u32| (0..1 << zoom).flat_map(move |y| (0..1 << zoom).map(move |x| (tile_number(zoom, x, y), x, y)));
    assert_eq!(
        [
            tile_number(0, 0, 0),
            tile_number(1, 0, 0),
            tile_number(1, 0, 1),
            tile_number(1, 1, 1),
            tile_number(1, 1, 0)
        ],
        [0, 1, 2, 3, 4]
    );
    // of the specification
    assert_eq!(tile_number(12, 3423, 1763), 19_078_479);
    let mut all: Vec<_> = numbers(4).collect();
    all.sort_unstable();
    assert!(all.windows(2).all(|w| w[1].0 == w[0].0 + 1 && w[0].1.abs_diff(w[1].1) + w[0].2.abs_diff(w[1].2) == 1));
    assert_eq!(all[0].0, 85);
}

#[test]
fn every_tile_comes_back_from_a_small_and_a_large_archive() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("a.pmtiles");
    for (zoom, side) in [(3, 8u32), (8, 200)] {
        let archive = PmtilesArchive::create(&target).unwrap();
        let mut expected = BTreeMap::new();
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))).rev() {
            // every third is sea
            let bytes = if x % 3 == 0 {
                b"sea".to_vec()
            } else {
                format!("{}", (x * 7919 + y * 104_729) % 30_011).into_bytes()
            };
            archive.put(&format!("{zoom}/{x}/{y}.png"), &bytes).unwrap();
            expected.insert(tile_number(zoom, x, y), bytes);
        }
        let metadata = serde_json::json!({ "name": "a" });
        archive.finish(&PmtilesFacts { zooms: [0, zoom], bounds_deg: [-1.0, -2.0, 3.0, 4.0], metadata }).unwrap();
        let bytes = std::fs::read(&target).unwrap();
        assert_eq!(read(&bytes), expected);
        let distinct: std::collections::BTreeSet<_> = expected.values().collect();
        assert_eq!(u64::from_le_bytes(bytes[88..96].try_into().unwrap()), distinct.len() as u64);
        assert_eq!(bytes[96..102], [1, 2, 1, 2, 0, zoom as u8]);
        assert_eq!(i32::from_le_bytes(bytes[102..106].try_into().unwrap()), -10_000_000);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
}

#[test]
fn what_is_no_tile_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let archive = PmtilesArchive::create(&folder.path().join("a.pmtiles")).unwrap();
    for path in ["1/2/0.png", "a/0/0.png", "0/0/0.webp", "0/0.png", "0/0/0/0.png", "99/0/0.png"] {
        assert!(archive.put(path, b"x").is_err(), "{path}");
    }
    drop(archive);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
