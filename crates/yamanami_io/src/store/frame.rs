//! Zstandard frames.

/// Undoes a frame of at most so many bytes; `None` when it is none.
#[cfg(feature = "files")]
pub(super) fn decompress(bytes: &[u8], most_bytes: usize) -> Option<Vec<u8>> {
    read(zstd::Decoder::new(bytes).ok()?, most_bytes)
}

/// Undoes a frame of at most so many bytes; `None` when it is none.
#[cfg(not(feature = "files"))]
pub(super) fn decompress(bytes: &[u8], most_bytes: usize) -> Option<Vec<u8>> {
    read(ruzstd::decoding::StreamingDecoder::new(bytes).ok()?, most_bytes)
}

fn read(frame: impl std::io::Read, most_bytes: usize) -> Option<Vec<u8>> {
    let mut raw = Vec::new();
    std::io::Read::read_to_end(&mut std::io::Read::take(frame, most_bytes as u64 + 1), &mut raw).ok()?;
    (raw.len() <= most_bytes).then_some(raw)
}
