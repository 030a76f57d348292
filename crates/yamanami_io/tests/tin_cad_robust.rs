//! Bad TIN files: one clear line each, no panic, and never much more memory than the file deserves.

mod damage;
mod tin_samples;

use damage::{Noise, largest_piece};
use proptest::prelude::*;
use tin_samples::samples;
use yamanami_io::tin_file::{TinReadOptions, read_tin_from_bytes};

/// Most bytes at once for files of a few kilobytes.
const MOST: usize = 4 << 20;

fn read(name: &str, bytes: &[u8]) -> Result<(), String> {
    let (read, largest) = largest_piece(|| read_tin_from_bytes(name, bytes, &TinReadOptions::default()));
    assert!(largest < MOST, "{name}: {largest} bytes at once");
    match read {
        Ok(read) => {
            let tin = read.tin;
            let vertices = tin.mesh.positions.len();
            assert!(tin.mesh.positions.iter().all(|p| p.is_finite()));
            assert!(tin.mesh.triangles.iter().chain(&tin.hidden).flatten().all(|&i| (i as usize) < vertices));
            assert!(tin.breaklines.iter().all(|l| l.points.len() > 1 && l.points.iter().all(|p| p.is_finite())));
            assert!(read.notes.iter().all(|note| !note.contains('\n')));
            Ok(())
        }
        Err(e) => {
            let line = e.to_string();
            assert!(!line.contains('\n') && line.starts_with(name), "{line}");
            Err(line)
        }
    }
}

#[test]
fn every_sample_is_read() {
    for (name, bytes) in samples() {
        assert_eq!(read(name, &bytes), Ok(()), "{name}");
        for length in 0..bytes.len() {
            let _ = read(name, &bytes[..length]);
        }
    }
}

#[test]
fn bytes_flipped_cut_and_spliced_never_panic() {
    let samples = samples();
    let mut noise = Noise(0x5eed_5eed_5eed_5eed);
    let mut read_on = 0;
    for case in 0..12_000 {
        let bytes = noise.damaged(case % samples.len(), &samples);
        read_on += usize::from(read(samples[case % samples.len()].0, &bytes).is_ok());
    }
    assert!(read_on > 1000, "{read_on} still read");
}

proptest! {
    #[test]
    fn any_bytes_are_an_error_or_a_tin(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for name in ["a.dxf", "a.2dm", "a.terrain", "a.dxf.gz", "a.2dm.zst"] {
            let _ = read(name, &bytes);
        }
        let _ = read("a.2dm", &[b"MESH2D\n", &bytes[..]].concat());
        let _ = read("a.dxf", &[b"0\nSECTION\n2\nENTITIES\n0\nPOLYLINE\n", &bytes[..]].concat());
    }
}

#[test]
fn counts_that_lie() {
    let tile = tin_samples::grid_tile(5, false);
    let with = |at: usize, number: u32| {
        let mut tile = tile.clone();
        tile[at..at + 4].copy_from_slice(&number.to_le_bytes());
        read("a.terrain", &tile).unwrap_err()
    };
    let vertices = 25;
    let triangles_at = 92 + vertices * 6;
    assert_eq!(
        with(88, u32::MAX),
        format!("a.terrain: byte 92: expected vertices of 25769803770 bytes, found {} bytes", tile.len() - 92)
    );
    assert!(with(88, 0).contains("expected vertices, found none"));
    assert!(with(triangles_at, u32::MAX).contains("expected corners of 25769803770 bytes"));
    assert!(with(triangles_at + 4, 5).contains("expected corners of triangle 0 below 25, found 65531"));
    assert!(with(triangles_at + 4 + 32 * 6, u32::MAX).contains("expected vertices on a side of 8589934590 bytes"));
    let mesh = "0\nSECTION\n2\nENTITIES\n0\nMESH\n92\n4294967295\n93\n4294967295\n90\n4294967295\n0\nEOF\n";
    let error = read("a.dxf", mesh.as_bytes()).unwrap_err();
    assert!(error.contains("no face that is shown"), "{error}");
    let endless = [b"0\nSECTION\n2\n".as_slice(), &vec![b'x'; 2 << 20]].concat();
    let error = read("a.dxf", &endless).unwrap_err();
    assert_eq!(error, "a.dxf: line 4: expected a short line, found 1048576 bytes or more");
}
