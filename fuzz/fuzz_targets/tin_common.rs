//! What every reader of TINs must bear: either a TIN whose numbers can be used, or an error.

use yamanami_io::tin_file::{TinReadOptions, read_tin_from_bytes};

/// Reads the bytes under a name; errors are fine, panics and great allocations are not.
pub fn exercise(name: &str, bytes: &[u8]) {
    let Ok(read) = read_tin_from_bytes(name, bytes, &TinReadOptions::default()) else { return };
    let tin = read.tin;
    assert!(tin.mesh.positions.iter().all(|p| p.is_finite()));
    let vertices = tin.mesh.positions.len();
    assert!(tin.mesh.triangles.iter().chain(&tin.hidden).flatten().all(|&i| (i as usize) < vertices));
    assert!(tin.breaklines.iter().all(|line| line.points.len() > 1 && line.points.iter().all(|p| p.is_finite())));
}
