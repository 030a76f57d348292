//! Small sound tilesets, each without a finding; then faults planted in them, one at a time, each found by its code.

mod archives;
mod quantized;
mod raster;
mod tiles3d;

use std::path::Path;
use yamanami::{ValidateOptions, ValidateReport, validate};

/// All of a tileset, judged.
fn judged(path: &Path, options: &ValidateOptions) -> ValidateReport {
    validate(path, options, &|_, _| ()).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// A sound tileset has no finding but notes.
fn assert_sound(path: &Path, options: &ValidateOptions) -> ValidateReport {
    let report = judged(path, options);
    let lines: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    assert!(lines.iter().all(|line| line.contains(" note: ")), "{}", lines.join("\n"));
    report
}

/// A fault is found by its code.
fn assert_finds(path: &Path, options: &ValidateOptions, code: &str) -> ValidateReport {
    let report = judged(path, options);
    let lines: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    assert!(report.counts.contains_key(code), "{code} is not among\n{}", lines.join("\n"));
    report
}

/// Changes the bytes of a file.
fn edit(path: &Path, change: impl FnOnce(&mut Vec<u8>)) {
    let mut bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    change(&mut bytes);
    std::fs::write(path, bytes).unwrap();
}

/// Changes a text in a file, which must be there.
fn replace(path: &Path, old: &str, new: &str) {
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(old), "{old} is not in {text}");
    std::fs::write(path, text.replacen(old, new, 1)).unwrap();
}

#[test]
fn damaged_bytes_are_findings_never_panics() {
    let folder = tempfile::tempdir().unwrap();
    let options = ValidateOptions::default();
    let tile = quantized::Tile::made([2, 4, 2]).encode();
    let path = folder.path().join("tile.terrain");
    for cut in (0..tile.len()).step_by(7) {
        std::fs::write(&path, &tile[..cut]).unwrap();
        judged(&path, &options);
        let mut bent = tile.clone();
        bent[cut] ^= 0x55;
        std::fs::write(&path, &bent).unwrap();
        judged(&path, &options);
    }
    let glb_path = folder.path().join("tile.glb");
    let glb = tiles3d::glb(0, [0, 0], 0.0);
    for cut in (0..glb.len()).step_by(23) {
        std::fs::write(&glb_path, &glb[..cut]).unwrap();
        judged(&glb_path, &options);
        let mut bent = glb.clone();
        bent[cut] ^= 0x55;
        std::fs::write(&glb_path, &bent).unwrap();
        judged(&glb_path, &options);
    }
}
