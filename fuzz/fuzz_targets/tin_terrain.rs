//! quantized-mesh tile from any bytes.
#![no_main]

mod tin_common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tin_common::exercise("a.terrain", bytes));
