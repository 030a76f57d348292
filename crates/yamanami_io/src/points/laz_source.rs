//! Records of a LAZ file, unpacked by the `laz` crate.
//!
//! Format: Isenburg, "LASzip: lossless compression of LiDAR data", 2013. The crate trusts its input: sizes that it would
//! allocate are checked here first, on the way in, and should it panic over broken data, that is the end of the points.

use super::las::Records;
use super::source::ReadSeek;
use crate::IoError;
use laz::{LasZipDecompressor, LazVlr};
use std::io::{Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Version of the compressor whose chunks state the sizes of their layers.
const LAYERED: u16 = 3;
/// Sizes below are no harm, whatever the file.
const HARMLESS_BYTES: u64 = 1 << 24;

pub(super) struct LazRecords<'a> {
    unpacker: LasZipDecompressor<'a, Guarded<Box<dyn ReadSeek + 'a>>>,
}

impl<'a> LazRecords<'a> {
    /// `bytes` stand where the points start; `record` describes the packing.
    pub(super) fn new(
        mut bytes: Box<dyn ReadSeek + 'a>,
        record: &[u8],
        point_bytes: usize,
        points_at: u64,
        length: u64,
        label: &Path,
    ) -> Result<Self, IoError> {
        let bad = |found: String| IoError::malformed(label, "record of LASzip", "how the points are packed", found);
        let packing = LazVlr::from_buffer(record).map_err(|e| bad(e.to_string()))?;
        let sizes: usize = packing.items().iter().map(|item| usize::from(item.size())).sum();
        if packing.items().is_empty() || sizes != point_bytes {
            return Err(bad(format!("{} items of {sizes} bytes for points of {point_bytes}", packing.items().len())));
        }
        check_chunk_table(&mut *bytes, points_at, length).map_err(|found| {
            IoError::malformed(label, "chunk table", "a number of chunks that fits the file", found)
        })?;
        bytes.seek(SeekFrom::Start(points_at)).map_err(|e| IoError::io(label, e))?;
        let is_on = Arc::new(AtomicBool::new(false));
        let guarded = Guarded { bytes, is_on: is_on.clone(), most: length.max(HARMLESS_BYTES) };
        let unpacker = catch_unwind(AssertUnwindSafe(|| LasZipDecompressor::new(guarded, packing)));
        let unpacker = match unpacker {
            Ok(Ok(unpacker)) => unpacker,
            Ok(Err(e)) => return Err(bad(e.to_string())),
            Err(_) => return Err(bad("what cannot be unpacked".into())),
        };
        is_on.store(u16::from_le_bytes([record[0], record[1]]) == LAYERED, Ordering::Relaxed);
        Ok(Self { unpacker })
    }
}

impl Records for LazRecords<'_> {
    fn fill(&mut self, out: &mut [u8], length: usize) -> usize {
        let mut filled = 0;
        let _ = catch_unwind(AssertUnwindSafe(|| {
            for record in out.chunks_exact_mut(length) {
                if self.unpacker.decompress_one(record).is_err() {
                    break;
                }
                filled += 1;
            }
        }));
        filled
    }
}

/// The number of chunks is what room is made for: each takes a point's bytes at least.
fn check_chunk_table(bytes: &mut dyn ReadSeek, points_at: u64, length: u64) -> Result<(), String> {
    let mut eight_at = |at: u64| {
        let mut eight = [0; 8];
        bytes.seek(SeekFrom::Start(at)).and_then(|_| bytes.read_exact(&mut eight)).ok().map(|()| eight)
    };
    let table_at = eight_at(points_at).map(i64::from_le_bytes);
    // a file that was written in one go has the place at its end
    let table_at =
        if table_at == Some(-1) { eight_at(length.saturating_sub(8)).map(i64::from_le_bytes) } else { table_at };
    let Some(table_at) = table_at.and_then(|at| u64::try_from(at).ok()) else { return Ok(()) };
    match eight_at(table_at) {
        Some([_, _, _, _, a, b, c, d]) if u64::from(u32::from_le_bytes([a, b, c, d])) > length / 20 + 1 => {
            Err(u32::from_le_bytes([a, b, c, d]).to_string())
        }
        _ => Ok(()),
    }
}

/// Lets no size of a layer pass that is larger than the file.
struct Guarded<R> {
    bytes: R,
    /// From the first chunk on, when all that is read in fours is a size or a number of points.
    is_on: Arc<AtomicBool>,
    most: u64,
}

impl<R: Read> Read for Guarded<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        if out.len() != 4 || !self.is_on.load(Ordering::Relaxed) {
            return self.bytes.read(out);
        }
        self.bytes.read_exact(out)?;
        let size = u64::from(u32::from_le_bytes([out[0], out[1], out[2], out[3]]));
        if size > self.most {
            return Err(std::io::Error::other("a layer larger than the file"));
        }
        Ok(4)
    }
}

impl<R: Seek> Seek for Guarded<R> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.bytes.seek(to)
    }
}
