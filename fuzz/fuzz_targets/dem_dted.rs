//! DTED from any bytes.
#![no_main]

mod dem_common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dem_common::exercise("a.dt1", bytes));
