//! SRTM: any bytes as packed data, and repeated to the only length that is read.
#![no_main]

mod dem_common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    dem_common::exercise("N42E001.hgt.gz", bytes);
    if let [first, .., last] = bytes {
        let length = 2 * 1201 * 1201 + usize::from(*first == *last);
        let whole: Vec<u8> = bytes.iter().copied().cycle().take(length).collect();
        dem_common::exercise("N42E001.hgt", &whole);
    }
});
