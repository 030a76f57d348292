//! gzip and zstd around a mesh or TIN file, by the end of its name.

use crate::IoError;
use std::borrow::Cow;
use std::io::{BufRead, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

/// Most bytes that a packed mesh file may unpack to, and how many more than the packed ones: meshes pack a hundredfold
/// at best, so more is a bomb.
const UNPACKED_LIMIT: u64 = 8 << 30;
pub(super) const UNPACKED_FREE: u64 = 64 << 20;
pub(super) const UNPACKED_FOLD: u64 = 1000;

/// How a file is packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packing {
    None,
    Gzip,
    Zstd,
}

impl Packing {
    /// The packing that a name states, and the name without it.
    pub(crate) fn of(name: &Path) -> (Self, PathBuf) {
        let is = |end: &str| name.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
        match () {
            () if is("gz") => (Self::Gzip, name.with_extension("")),
            () if is("zst") => (Self::Zstd, name.with_extension("")),
            () => (Self::None, name.to_owned()),
        }
    }

    pub(super) fn unpack<'a>(self, name: &Path, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, IoError> {
        let limit = UNPACKED_LIMIT.min((bytes.len() as u64).saturating_mul(UNPACKED_FOLD).max(UNPACKED_FREE));
        let mut unpacked = Vec::new();
        let (read, kind) = match self {
            Self::None => return Ok(Cow::Borrowed(bytes)),
            Self::Gzip => (flate2::read::MultiGzDecoder::new(bytes).take(limit + 1).read_to_end(&mut unpacked), "gzip"),
            Self::Zstd => {
                let read = zstd::stream::read::Decoder::with_buffer(bytes)
                    .and_then(|decoder| decoder.take(limit + 1).read_to_end(&mut unpacked));
                (read, "zstd")
            }
        };
        read.map_err(|e| IoError::malformed(name, "compressed data", format!("a whole {kind} stream"), e.to_string()))?;
        if unpacked.len() as u64 > limit {
            return Err(IoError::too_large(name, "bytes unpacked", unpacked.len() as u64, limit));
        }
        Ok(Cow::Owned(unpacked))
    }

    /// Unpacks while it is read. Beyond the limit is an error that says so.
    pub(crate) fn reader<'a>(
        self,
        packed: impl BufRead + 'a,
        packed_bytes: u64,
    ) -> std::io::Result<Box<dyn BufRead + 'a>> {
        let left = packed_bytes.saturating_mul(UNPACKED_FOLD).max(UNPACKED_FREE);
        let buffered = |bytes: Box<dyn Read + 'a>| BufReader::with_capacity(1 << 16, Limited { bytes, left });
        Ok(match self {
            Self::None => Box::new(packed),
            Self::Gzip => Box::new(buffered(Box::new(flate2::bufread::MultiGzDecoder::new(packed)))),
            Self::Zstd => Box::new(buffered(Box::new(zstd::stream::read::Decoder::with_buffer(packed)?))),
        })
    }

    pub(super) fn write(
        self,
        out: &mut impl Write,
        content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        match self {
            Self::None => content(out),
            Self::Gzip => {
                let packer = flate2::write::GzEncoder::new(out, flate2::Compression::default());
                // what is written comes in small pieces
                let mut buffer = BufWriter::with_capacity(1 << 16, packer);
                content(&mut buffer)?;
                buffer.into_inner().map_err(std::io::IntoInnerError::into_error)?.finish()?;
                Ok(())
            }
            Self::Zstd => {
                let packer = zstd::stream::write::Encoder::new(out, 3)?;
                let mut buffer = BufWriter::with_capacity(1 << 16, packer);
                content(&mut buffer)?;
                buffer.into_inner().map_err(std::io::IntoInnerError::into_error)?.finish()?;
                Ok(())
            }
        }
    }
}

/// Passes so many bytes on, then fails.
struct Limited<R> {
    bytes: R,
    left: u64,
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let count = self.bytes.read(out)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| {
            let why = "far more bytes unpacked than a file of this kind has";
            std::io::Error::new(std::io::ErrorKind::InvalidData, why)
        })?;
        Ok(count)
    }
}
