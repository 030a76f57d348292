//! DXF drawing from any bytes.
#![no_main]

mod tin_common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tin_common::exercise("a.dxf", bytes));
