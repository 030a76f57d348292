//! A 3tz archive, sound and spoilt.

use super::{assert_finds, assert_sound, edit, tiles3d};
use std::path::Path;
use yamanami::ValidateOptions;
use yamanami::io::tiles::{INDEX_NAME, pack_3tz};

/// Changes the index, which lies unpacked in the archive, with a sum over it that zip readers check.
fn in_index(path: &Path, change: impl FnOnce(&mut [u8])) {
    edit(path, |bytes| {
        let name = INDEX_NAME.as_bytes();
        let local = bytes.windows(name.len()).position(|w| w == name).expect("an index");
        let header = local - 30;
        let extra = usize::from(u16::from_le_bytes([bytes[header + 28], bytes[header + 29]]));
        let central = bytes.windows(name.len()).rposition(|w| w == name).expect("an entry") - 46;
        let field = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let (method, size) = (bytes[central + 10], field(central + 24));
        assert_eq!(method, 0, "the index is stored");
        let start = local + name.len() + extra;
        change(&mut bytes[start..start + size]);
        let sum = crc32(&bytes[start..start + size]).to_le_bytes();
        bytes[header + 14..header + 18].copy_from_slice(&sum);
        bytes[central + 16..central + 20].copy_from_slice(&sum);
    });
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |s, _| if s & 1 == 1 { s >> 1 ^ 0xedb8_8320 } else { s >> 1 })
    })
}

#[test]
fn faults_of_an_archive_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let tiles = folder.path().join("tiles");
    std::fs::create_dir(&tiles).unwrap();
    tiles3d::sound(&tiles);
    let archive = folder.path().join("a.3tz");
    pack_3tz(&tiles, &archive).unwrap();
    let options = ValidateOptions::default();
    let report = assert_sound(&archive, &options);
    assert_eq!(report.kind, "3tz archive of 3D Tiles");
    let whole = std::fs::read(&archive).unwrap();
    type Spoil = fn(&Path);
    let faults: [(&str, Spoil); 4] = [
        ("TZ01", |p| edit(p, |b| b.truncate(b.len() / 2))),
        ("TZ03", |p| in_index(p, |index| (0..24).for_each(|k| index.swap(k, 24 + k)))),
        ("TZ04", |p| in_index(p, |index| index[9] ^= 0x40)),
        ("TZ05", |p| in_index(p, |index| index[16] ^= 1)),
    ];
    for (code, spoil) in faults {
        std::fs::write(&archive, &whole).unwrap();
        spoil(&archive);
        assert_finds(&archive, &options, code);
    }
    std::fs::remove_file(tiles.join("tileset.json")).unwrap();
    std::fs::remove_file(&archive).unwrap();
    if pack_3tz(&tiles, &archive).is_ok() {
        assert_finds(&archive, &options, "TZ06");
    }
}
