//! Streams of meshopt compression from any bytes; the first three choose the kind, the size of an element, the number.
#![no_main]

use yamanami_io::mesh_file::{MeshoptFilter, MeshoptMode, decode_meshopt};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let [kind, stride, count, data @ ..] = bytes else { return };
    let mode = [MeshoptMode::Attributes, MeshoptMode::Triangles, MeshoptMode::Indices][usize::from(kind % 3)];
    let filter = [
        MeshoptFilter::None,
        MeshoptFilter::Octahedral,
        MeshoptFilter::Quaternion,
        MeshoptFilter::Exponential,
        MeshoptFilter::Colour,
    ][usize::from(kind / 3 % 5)];
    // either elements, all of them, or an error: never a panic
    if let Ok(decoded) = decode_meshopt(mode, filter, 3 * usize::from(*count), usize::from(*stride), data) {
        assert_eq!(decoded.len(), 3 * usize::from(*count) * usize::from(*stride));
    }
});
