//! LandXML or CityGML from any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // either a TIN or an error: never a panic
    let _ = yamanami_io::tin_file::read_tin_from_bytes("a.xml", bytes, &Default::default());
});
