//! A surface database with any bytes changed: opening and reading all of it is an error or succeeds, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;
use yamanami_core::{ErrorCode, GeoReference, PageId, TerrainPage};
use yamanami_io::store::{Quantum, TerrainMeta, TerrainStore, TerrainWriter};

/// A whole file of a small surface.
static WHOLE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let size = [90u32, 70];
    let path = scratch("whole");
    let meta = TerrainMeta {
        geo: GeoReference::local([30.0, 30.0], 70),
        size,
        height_range_m: [0.0, 100.0],
        bound_radius_m: vec![100.0; 7],
        has_holes: false,
        max_error_m: 0.0,
        quantum: Quantum::PerMetre(1),
        error_steps_per_octave: 2,
        level0_slack_m: 0.0,
        title: "fuzz".into(),
        source: String::new(),
    };
    let mut writer = TerrainWriter::create(&path, meta).expect("a writable folder");
    for level in (0..=writer.codec().lattice().levels()).rev() {
        let id = PageId { level, x: 0, y: 0 };
        let lattice = writer.codec().lattice().clone();
        let [width, height] = lattice.points(level);
        let points = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let height_m = |(x, y): (u32, u32)| {
            let [x, y] = lattice.sample(level, x, y);
            ((x * x + 3 * y * y + x * y) % 101) as f32
        };
        let error =
            |(x, y): (u32, u32)| ErrorCode(if (x | y) & 1 == 1 && level < 7 { 9000 + 1000 * level as u16 } else { 0 });
        let page = TerrainPage {
            id,
            width,
            height,
            heights_m: points().map(height_m).collect(),
            errors: points().map(error).collect(),
            shown: Vec::new(),
        };
        writer.write_page(&page).expect("a page that fits");
    }
    writer.finish().expect("a whole file");
    std::fs::read(&path).expect("the file just written")
});

fn scratch(name: &str) -> std::path::PathBuf {
    std::env::temp_dir().join(format!("yamanami_fuzz_{}_{name}.yama", std::process::id()))
}

fuzz_target!(|data: &[u8]| {
    let mut bytes = WHOLE.clone();
    // four bytes of input change one byte of the file; an odd remainder cuts it short
    let (changes, rest) = data.as_chunks::<4>();
    for &[low, high, top, value] in changes {
        let at = u32::from_le_bytes([low, high, top, 0]) as usize % bytes.len();
        bytes[at] = value;
    }
    if let [low, high] = rest {
        bytes.truncate(usize::from(u16::from_le_bytes([*low, *high])));
    }
    let path = scratch("changed");
    if std::fs::write(&path, &bytes).is_ok()
        && let Ok(store) = TerrainStore::open(&path)
    {
        // a size made up by the change may promise far more pages than there are: reading one stops at once
        let _ = store.verify();
        let _ = store.read_height_block(0, 0, 0, 2, 2);
    }
});
