//! OFF mesh from any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // either a mesh or an error: never a panic
    let _ = yamanami_io::mesh_file::read_mesh_from_bytes("a.off", bytes);
});
