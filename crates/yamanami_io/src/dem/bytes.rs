//! Where the bytes of an elevation file come from: a plain file, memory, a gzip file, a member of a zip archive.
//!
//! Nothing is unpacked to disk. Compressed sources are read forwards and started again to go back, so that a grid
//! inside an archive is read by windows too.

use crate::IoError;
use flate2::read::{DeflateDecoder, MultiGzDecoder};
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A compressed source that must be seekable (a TIFF in an archive) is unpacked into memory up to this many bytes.
const MAX_UNPACKED_BYTES: u64 = 1 << 30;
/// Deflate cannot pack tighter than 1032 to 1.
const MAX_DEFLATE_RATIO: u64 = 1040;
/// An archive with more members than this is not a delivery of elevation data.
const MAX_ZIP_MEMBERS: usize = 100_000;

pub(super) trait ReadSeek: BufRead + Seek + Send {}
impl<T: BufRead + Seek + Send> ReadSeek for T {}

/// A readable sequence of bytes with a name for messages.
#[derive(Debug, Clone)]
pub(super) struct ByteSource {
    label: PathBuf,
    kind: Kind,
    /// Length as stated (exact for files and memory), if it is stated.
    length: Option<u64>,
    /// No more than this many bytes can come out.
    length_bound: u64,
}

#[derive(Debug, Clone)]
enum Kind {
    File(PathBuf),
    Memory(Arc<[u8]>),
    Gzip(Arc<ByteSource>),
    ZipMember { archive: Arc<ByteSource>, start: u64, compressed: u64, deflated: bool },
}

impl ByteSource {
    pub(super) fn file(path: &Path) -> Result<Self, IoError> {
        let metadata = std::fs::metadata(path).map_err(|e| IoError::io(path, e))?;
        if !metadata.is_file() {
            return Err(IoError::unsupported(path, "not a regular file", "give a file or a folder of files"));
        }
        Ok(Self {
            label: path.to_owned(),
            kind: Kind::File(path.to_owned()),
            length: Some(metadata.len()),
            length_bound: metadata.len(),
        })
    }

    pub(super) fn memory(label: &Path, bytes: Arc<[u8]>) -> Self {
        let length = bytes.len() as u64;
        Self { label: label.to_owned(), kind: Kind::Memory(bytes), length: Some(length), length_bound: length }
    }

    /// What the gzip file `packed` holds. The stated length is that of its trailer, right below 4 GiB.
    pub(super) fn gunzip(packed: &ByteSource) -> Result<Self, IoError> {
        let mut trailer = [0; 4];
        let mut length = None;
        if let (Some(packed_length), Kind::File(_) | Kind::Memory(_)) = (packed.length, &packed.kind)
            && packed_length >= 18
        {
            RandomReader::new(packed.clone()).read_exact_at(packed_length - 4, &mut trailer)?;
            length = Some(u64::from(u32::from_le_bytes(trailer)));
        }
        let mut label = packed.label.clone();
        if label.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz")) {
            label.set_extension("");
        }
        Ok(Self {
            label,
            kind: Kind::Gzip(Arc::new(packed.clone())),
            length,
            length_bound: packed.length_bound.saturating_mul(MAX_DEFLATE_RATIO),
        })
    }

    /// The files in the zip archive `packed`, by name.
    pub(super) fn unzip(packed: &ByteSource) -> Result<Vec<Self>, IoError> {
        let broken = |e: zip::result::ZipError| {
            IoError::malformed(&packed.label, "zip directory", "a complete zip archive", e.to_string())
        };
        let mut archive = zip::ZipArchive::new(packed.seekable()?).map_err(broken)?;
        if archive.len() > MAX_ZIP_MEMBERS {
            let (given, limit) = (archive.len() as u64, MAX_ZIP_MEMBERS as u64);
            return Err(IoError::too_large(&packed.label, "members of the archive", given, limit));
        }
        let shared = Arc::new(packed.clone());
        let mut members = Vec::with_capacity(archive.len());
        for index in 0..archive.len() {
            let member = archive.by_index_raw(index).map_err(broken)?;
            if !member.is_file() {
                continue;
            }
            let name = String::from_utf8_lossy(member.name_raw()).replace(char::is_control, "_");
            let label = packed.label.join(name.trim_start_matches('/'));
            let deflated = match member.compression() {
                zip::CompressionMethod::Stored => false,
                zip::CompressionMethod::Deflated => true,
                other => {
                    let what = format!("zip compression method {other}");
                    return Err(IoError::unsupported(label, what, "pack again with deflate, or unpack first"));
                }
            };
            if member.encrypted() {
                return Err(IoError::unsupported(label, "an encrypted archive", "unpack it first"));
            }
            let Some(start) = member.data_start() else { continue };
            let compressed = member.compressed_size().min(packed.length_bound);
            let length_bound = if deflated { compressed.saturating_mul(MAX_DEFLATE_RATIO) } else { compressed };
            members.push(Self {
                label,
                kind: Kind::ZipMember { archive: shared.clone(), start, compressed, deflated },
                length: Some(member.size()),
                length_bound: length_bound.min(member.size()),
            });
        }
        members.sort_by(|a, b| a.label.cmp(&b.label));
        Ok(members)
    }

    /// Name for messages: the path, or archive path and member name.
    pub(super) fn label(&self) -> &Path {
        &self.label
    }

    /// The path, if the bytes are a file of their own.
    #[cfg(feature = "gdal")]
    pub(super) fn path(&self) -> Option<&Path> {
        match &self.kind {
            Kind::File(path) => Some(path),
            _ => None,
        }
    }

    /// The last part of the name.
    pub(super) fn file_name(&self) -> String {
        self.label.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
    }

    /// The length, if it is stated anywhere.
    pub(super) fn length(&self) -> Option<u64> {
        self.length
    }

    /// No more bytes than this can be read.
    pub(super) fn length_bound(&self) -> u64 {
        self.length_bound
    }

    /// All bytes from the first.
    pub(super) fn reader(&self) -> Result<Box<dyn Read + Send>, IoError> {
        Ok(match &self.kind {
            Kind::File(path) => {
                let file = File::open(path).map_err(|e| IoError::io(path, e))?;
                Box::new(BufReader::with_capacity(1 << 16, file))
            }
            Kind::Memory(bytes) => Box::new(Cursor::new(bytes.clone())),
            Kind::Gzip(packed) => Box::new(BufReader::new(MultiGzDecoder::new(packed.reader()?))),
            Kind::ZipMember { archive, start, compressed, deflated } => {
                let raw: Box<dyn Read + Send> = match &archive.kind {
                    Kind::File(_) | Kind::Memory(_) => {
                        let mut reader = archive.seekable()?;
                        reader.seek(SeekFrom::Start(*start)).map_err(|e| IoError::io(&self.label, e))?;
                        Box::new(reader.take(*compressed))
                    }
                    _ => {
                        let mut reader = archive.reader()?;
                        let skipped = std::io::copy(&mut reader.by_ref().take(*start), &mut std::io::sink());
                        skipped.map_err(|e| self.read_error(0, 0, e))?;
                        Box::new(reader.take(*compressed))
                    }
                };
                if *deflated { Box::new(BufReader::new(DeflateDecoder::new(raw))) } else { raw }
            }
        })
    }

    /// The bytes with free movement; compressed sources are unpacked into memory.
    pub(super) fn seekable(&self) -> Result<Box<dyn ReadSeek>, IoError> {
        Ok(match &self.kind {
            Kind::File(path) => {
                let file = File::open(path).map_err(|e| IoError::io(path, e))?;
                Box::new(BufReader::with_capacity(1 << 16, file))
            }
            Kind::Memory(bytes) => Box::new(Cursor::new(bytes.clone())),
            _ => Box::new(Cursor::new(self.read_all(MAX_UNPACKED_BYTES)?)),
        })
    }

    /// All bytes, an error beyond `limit`.
    pub(super) fn read_all(&self, limit: u64) -> Result<Vec<u8>, IoError> {
        let mut bytes = Vec::new();
        let read = self.reader()?.take(limit + 1).read_to_end(&mut bytes);
        read.map_err(|e| self.read_error(bytes.len() as u64, 0, e))?;
        if bytes.len() as u64 > limit {
            return Err(IoError::too_large(&self.label, "unpacked bytes", bytes.len() as u64, limit));
        }
        Ok(bytes)
    }

    /// Up to `count` bytes from the start.
    pub(super) fn head(&self, count: u64) -> Result<Vec<u8>, IoError> {
        let mut bytes = Vec::new();
        let read = self.reader()?.take(count).read_to_end(&mut bytes);
        read.map_err(|e| self.read_error(bytes.len() as u64, 0, e))?;
        Ok(bytes)
    }

    /// The error for a failed read of `wanted` bytes at `offset`.
    pub(super) fn read_error(&self, offset: u64, wanted: usize, error: std::io::Error) -> IoError {
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => {
                let found = match self.length {
                    Some(length) if !self.is_packed() => format!("the end of the file after {length} bytes"),
                    _ => "the end of the data".to_owned(),
                };
                IoError::malformed(&self.label, format!("byte {offset}"), format!("{wanted} more bytes"), found)
            }
            std::io::ErrorKind::InvalidInput | std::io::ErrorKind::InvalidData if self.is_packed() => {
                let place = format!("unpacked byte {offset}");
                IoError::malformed(&self.label, place, "sound compressed data", error.to_string())
            }
            _ => IoError::io(&self.label, error),
        }
    }

    /// How the bytes are packed, for information.
    pub(super) fn compression_name(&self) -> &'static str {
        match &self.kind {
            Kind::File(_) | Kind::Memory(_) => "none",
            Kind::Gzip(_) => "gzip",
            Kind::ZipMember { .. } => "zip",
        }
    }

    fn is_packed(&self) -> bool {
        matches!(self.kind, Kind::Gzip(_) | Kind::ZipMember { .. })
    }
}

/// Reads at any offset; on packed sources, going back means starting again.
pub(super) struct RandomReader {
    source: ByteSource,
    state: State,
    unpacks: bool,
}

enum State {
    Closed,
    Seek(Box<dyn ReadSeek>),
    Forward { reader: Box<dyn Read + Send>, offset: u64 },
}

impl RandomReader {
    pub(super) fn new(source: ByteSource) -> Self {
        Self { source, state: State::Closed, unpacks: false }
    }

    /// A reader for data in no order: packed sources are unpacked into memory.
    pub(super) fn unpacking(source: ByteSource) -> Self {
        Self { source, state: State::Closed, unpacks: true }
    }

    pub(super) fn source(&self) -> &ByteSource {
        &self.source
    }

    /// Lets go of the file handle; the next read opens it again.
    pub(super) fn close(&mut self) {
        self.state = State::Closed;
    }

    /// The true length, which may mean unpacking.
    pub(super) fn length(&mut self) -> Result<u64, IoError> {
        if let State::Closed = self.state {
            self.state = State::Seek(self.source.seekable()?);
        }
        match &mut self.state {
            State::Seek(reader) => reader.seek(SeekFrom::End(0)).map_err(|e| IoError::io(&self.source.label, e)),
            _ => Ok(self.source.length_bound),
        }
    }

    pub(super) fn read_exact_at(&mut self, offset: u64, out: &mut [u8]) -> Result<(), IoError> {
        let read = self.read_at(offset, out)?;
        if read < out.len() {
            let end = std::io::Error::from(std::io::ErrorKind::UnexpectedEof);
            return Err(self.source.read_error(offset + read as u64, out.len() - read, end));
        }
        Ok(())
    }

    /// Fills `out` as far as the data go.
    pub(super) fn read_at(&mut self, offset: u64, out: &mut [u8]) -> Result<usize, IoError> {
        match &self.state {
            State::Closed if self.source.is_packed() && !self.unpacks => self.restart()?,
            State::Closed => self.state = State::Seek(self.source.seekable()?),
            State::Forward { offset: at, .. } if *at > offset => self.restart()?,
            _ => {}
        }
        let mut filled = 0;
        let result = match &mut self.state {
            State::Seek(reader) => reader.seek(SeekFrom::Start(offset)).and_then(|_| fill(reader, out, &mut filled)),
            State::Forward { reader, offset: at } => {
                let skip = std::io::copy(&mut reader.by_ref().take(offset - *at), &mut std::io::sink());
                skip.and_then(|skipped| {
                    *at += skipped;
                    if *at == offset { fill(reader, out, &mut filled) } else { Ok(()) }
                })
            }
            State::Closed => Ok(()),
        };
        if let State::Forward { offset: at, .. } = &mut self.state {
            *at += filled as u64;
        }
        result.map_err(|e| self.source.read_error(offset + filled as u64, out.len() - filled, e))?;
        Ok(filled)
    }

    fn restart(&mut self) -> Result<(), IoError> {
        self.state = State::Forward { reader: self.source.reader()?, offset: 0 };
        Ok(())
    }
}

fn fill(reader: &mut dyn Read, out: &mut [u8], filled: &mut usize) -> std::io::Result<()> {
    while *filled < out.len() {
        match reader.read(&mut out[*filled..]) {
            Ok(0) => break,
            Ok(count) => *filled += count,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(())
}
