//! Places and lines of every format from any bytes: the first says which.
#![no_main]

use yamanami_io::geodata::{LineReadOptions, PlaceReadOptions, read_lines_from_bytes, read_places_from_bytes};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((&kind, bytes)) = bytes.split_first() else { return };
    let name = ["a.csv", "a.geojson", "a.gpx", "a.shp"][usize::from(kind % 4)];
    // either places and lines or an error: never a panic
    let _ = read_places_from_bytes(name, bytes, &PlaceReadOptions::default());
    let _ = read_lines_from_bytes(name, bytes, &LineReadOptions::default());
});
