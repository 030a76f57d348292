//! One page of a surface database from any bytes: an error or a page of the right shape, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use yamanami_core::{ErrorCode, PageId, TerrainPage};
use yamanami_io::store::{PageCodec, Quantum};

fuzz_target!(|data: &[u8]| {
    let [size, kind, level, bytes @ ..] = data else { return };
    let size = [2 + u32::from(size & 15) * 20, 2 + u32::from(size >> 4) * 20];
    let quantum =
        [Quantum::PerMetre(1), Quantum::PerMetre(10), Quantum::Step(0.37), Quantum::Bits][usize::from(kind & 3)];
    let Ok(codec) = PageCodec::new(size, quantum, kind & 4 != 0, 1 << (kind >> 4 & 7), 0.0) else { return };
    let id = PageId { level: u32::from(level & 15).min(codec.lattice().levels()), x: 0, y: u32::from(level >> 7) };
    let parent = codec.parent(id).map(|id| {
        let [width, height] = codec.page_points(id).unwrap_or([2, 2]);
        let points = (width * height) as usize;
        let mut heights_m: Vec<f32> = (0..points).map(|i| (i * 7 % 50) as f32).collect();
        quantum.quantise(&mut heights_m);
        TerrainPage { id, width, height, heights_m, errors: vec![ErrorCode(0); points], shown: Vec::new() }
    });
    if let Ok(page) = codec.decode_page(id, bytes, parent.as_ref()) {
        assert_eq!(Some([page.width, page.height]), codec.page_points(id));
        assert!(page.heights_m.iter().all(|z| z.is_finite()));
        // what was read can be written, and says the same
        let again = codec.encode_page(&page).expect("a page that was read can be written");
        let back = codec.decode_page(id, again.bytes(), parent.as_ref()).expect("and read again");
        assert_eq!(back.heights_m, page.heights_m);
        assert_eq!(back.errors, page.errors);
    }
});
