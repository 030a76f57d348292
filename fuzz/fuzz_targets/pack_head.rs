//! The head and an index of a packed surface from any bytes: an error or sections that fit together, never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::Path;
use yamanami_io::pack::layout::{MAGIC, PREFIX_BYTES, PackHead};

fuzz_target!(|data: &[u8]| {
    let name = Path::new("fuzz.pack");
    let _ = PackHead::parse(name, data);
    // the checksum made right, so that the JSON is reached
    let (json, index) = data.split_at(data.len() / 2);
    let mut bytes = MAGIC.to_vec();
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(crc32fast::hash(json).to_le_bytes());
    bytes.extend(json);
    if let Ok(head) = PackHead::parse(name, &bytes) {
        assert!(bytes.len() >= PREFIX_BYTES);
        for section in &head.sections {
            if let Ok(entries) = section.parse_entries(name, 0, index) {
                let end = section.index_at + section.bytes;
                assert!(entries.iter().all(|e| e.offset + u64::from(e.length) <= end));
            }
        }
    }
});
