//! What every reader of elevation grids must bear: opening, reading all, reading a window.

use yamanami_core::{HeightSource, Window};
use yamanami_io::dem::{self, OpenOptions};

/// Opens the bytes under a name; errors are fine, panics and great allocations are not.
pub fn exercise(name: &str, bytes: &[u8]) {
    let options = OpenOptions { max_samples: 1 << 20, cache_bytes: 1 << 20, ..OpenOptions::default() };
    let Ok(mut dem) = dem::from_bytes(name, bytes.to_vec(), &options) else { return };
    let [width, height] = dem.size();
    let window =
        Window { column: width / 2, row: height / 2, width: (width / 2).min(50), height: (height / 2).min(50) };
    let mut out = vec![0.0; window.width * window.height];
    let window_result = dem.read_window(window, &mut out);
    if let Ok(field) = dem.read_all() {
        assert!(window_result.is_ok());
        assert!(field.heights_m().iter().all(|z| !z.is_infinite()));
        for (i, z) in out.iter().enumerate() {
            let whole = field.at(window.column + i % window.width, window.row + i / window.width);
            assert!(z.to_bits() == whole.to_bits() || z.is_nan() && whole.is_nan());
        }
    }
}
