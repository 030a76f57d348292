//! Points and lines of every format from any bytes: the first says which.
#![no_main]

use yamanami_io::points::{LineReadOptions, PointReadOptions, read_lines_from_bytes, read_points_from_bytes};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((&kind, bytes)) = bytes.split_first() else { return };
    // either points or an error: never a panic
    let _ = match kind % 5 {
        0 => read_points_from_bytes("a.csv", bytes, &PointReadOptions::default()).map(|_| ()),
        1 => read_points_from_bytes("a.sim", bytes, &PointReadOptions::default()).map(|_| ()),
        2 => read_points_from_bytes("a.las", bytes, &PointReadOptions::default()).map(|_| ()),
        3 => read_lines_from_bytes("a.geojson", bytes, &LineReadOptions::default()).map(|_| ()),
        _ => read_lines_from_bytes("a.csv", bytes, &LineReadOptions::default()).map(|_| ()),
    };
});
