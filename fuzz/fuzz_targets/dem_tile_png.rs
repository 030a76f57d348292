//! Picture and text tiles from any bytes.
#![no_main]

mod dem_common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dem_common::exercise("4/5/6.png", bytes));
