//! Scratch space on a disk: many streams of bytes in one file that has no name, so that nothing is left of it however
//! the program ends.

use crate::IoError;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Where a piece of a stream lies in the file.
#[derive(Debug, Clone, Copy)]
struct Extent {
    start: u64,
    len: u64,
}

#[derive(Debug)]
struct Inner {
    file: File,
    end: u64,
    streams: Vec<Vec<Extent>>,
}

/// Streams that are appended to in any order, by any thread, and read one at a time. What a stream gives back depends on
/// its own pieces only, not on what else was written between them.
#[derive(Debug)]
pub struct Scratch {
    folder: PathBuf,
    inner: Mutex<Inner>,
}

impl Scratch {
    /// Empty streams in a file without a name in this folder.
    pub fn create(folder: impl AsRef<Path>, streams: usize) -> Result<Self, IoError> {
        let folder = folder.as_ref();
        let file = unnamed(folder)?;
        Ok(Self::over(file, folder, streams))
    }

    fn over(file: File, folder: &Path, streams: usize) -> Self {
        let inner = Inner { file, end: 0, streams: vec![Vec::new(); streams] };
        Self { folder: folder.to_owned(), inner: Mutex::new(inner) }
    }

    /// Every change is one step, so what a thread that panicked left behind is whole.
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn failed(&self, e: std::io::Error) -> IoError {
        let e = std::io::Error::new(e.kind(), format!("scratch space in this folder: {e}"));
        IoError::io(&self.folder, e)
    }

    /// Appends to a stream.
    pub fn append(&self, stream: usize, bytes: &[u8]) -> Result<(), IoError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let mut inner = self.inner();
        let start = inner.end;
        let file = &mut inner.file;
        file.seek(SeekFrom::Start(start)).and_then(|_| file.write_all(bytes)).map_err(|e| self.failed(e))?;
        let len = bytes.len() as u64;
        inner.end += len;
        match inner.streams[stream].last_mut() {
            Some(last) if last.start + last.len == start => last.len += len,
            _ => inner.streams[stream].push(Extent { start, len }),
        }
        Ok(())
    }

    /// Bytes in a stream.
    pub fn len(&self, stream: usize) -> u64 {
        self.inner().streams[stream].iter().map(|e| e.len).sum()
    }

    /// Whether nothing was ever appended.
    pub fn is_empty(&self) -> bool {
        self.inner().end == 0
    }

    /// Bytes in all streams.
    pub fn total_len(&self) -> u64 {
        self.inner().end
    }

    /// Gives a stream's records of `record` bytes to `sink`, as many at a time as fit `buffer`, never a part of one.
    ///
    /// # Panics
    /// When `buffer` is smaller than a record.
    pub fn read<E: From<IoError>>(
        &self,
        stream: usize,
        record: usize,
        buffer: &mut [u8],
        sink: &mut dyn FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        assert!(buffer.len() >= record, "a buffer of {} bytes for records of {record}", buffer.len());
        let whole = buffer.len() - buffer.len() % record;
        let extents = self.inner().streams[stream].clone();
        let mut filled = 0;
        for Extent { mut start, mut len } in extents {
            while len > 0 {
                let take = len.min((whole - filled) as u64) as usize;
                {
                    let mut inner = self.inner();
                    let file = &mut inner.file;
                    let into = &mut buffer[filled..filled + take];
                    file.seek(SeekFrom::Start(start))
                        .and_then(|_| file.read_exact(into))
                        .map_err(|e| self.failed(e))?;
                }
                filled += take;
                start += take as u64;
                len -= take as u64;
                if filled == whole {
                    sink(&buffer[..whole])?;
                    filled = 0;
                }
            }
        }
        if filled > 0 {
            sink(&buffer[..filled - filled % record])?;
        }
        Ok(())
    }
}

/// Level of packing: what lies on the disk for a minute is not worth more.
const FAST: i32 = -4;

impl Scratch {
    /// Appends bytes to a stream, packed; a stream is either packed or not.
    pub fn append_packed(&self, stream: usize, bytes: &[u8]) -> Result<(), IoError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let packed = zstd::bulk::compress(bytes, FAST).map_err(|e| self.failed(e))?;
        let head = [bytes.len() as u64, packed.len() as u64].map(u64::to_le_bytes);
        // in one piece: another thread may append to it, too
        self.append(stream, &[head.as_flattened(), &packed].concat())
    }

    /// All bytes of a packed stream.
    pub fn read_packed(&self, stream: usize) -> Result<Vec<u8>, IoError> {
        let mut packed = Vec::with_capacity(self.len(stream) as usize);
        let mut buffer = vec![0; 1 << 20];
        self.read(stream, 1, &mut buffer, &mut |bytes| {
            packed.extend_from_slice(bytes);
            Ok::<_, IoError>(())
        })?;
        let mut all = Vec::new();
        let mut rest = packed.as_slice();
        while let Some((head, more)) = rest.split_first_chunk::<16>() {
            let word = |at: usize| u64::from_le_bytes(std::array::from_fn(|k| head[at + k])) as usize;
            let (block, after) = more.split_at(word(8).min(more.len()));
            all.extend(zstd::bulk::decompress(block, word(0)).map_err(|e| self.failed(e))?);
            rest = after;
        }
        Ok(all)
    }
}

/// A file in a folder that no one else sees and that is gone when it is closed.
pub(crate) fn unnamed(folder: &Path) -> Result<File, IoError> {
    // the folder of a bare file name is an empty path
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    tempfile::tempfile_in(folder).map_err(|e| IoError::io(folder, e))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(scratch: &Scratch, stream: usize, record: usize, buffer: usize) -> Vec<u8> {
        let mut found = Vec::new();
        let mut buffer = vec![0; buffer];
        let sink = &mut |bytes: &[u8]| {
            assert_eq!(bytes.len() % record, 0);
            found.extend_from_slice(bytes);
            Ok::<_, IoError>(())
        };
        scratch.read(stream, record, &mut buffer, sink).unwrap();
        found
    }

    #[test]
    fn streams_come_back_whole_and_leave_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let scratch = Scratch::create(folder.path(), 3).unwrap();
        assert!(scratch.is_empty());
        for k in 0..100u8 {
            scratch.append(usize::from(k % 2), &[k; 12]).unwrap();
            scratch.append(0, &[k; 6]).unwrap();
        }
        assert_eq!([scratch.len(0), scratch.len(1), scratch.len(2)], [1200, 600, 0]);
        assert_eq!(scratch.total_len(), 1800);
        let expected: Vec<u8> = (0..100u8).flat_map(|k| vec![k; if k.is_multiple_of(2) { 18 } else { 6 }]).collect();
        for buffer in [6, 7, 100, 5000] {
            assert_eq!(all(&scratch, 0, 6, buffer), expected);
            assert!(all(&scratch, 2, 6, buffer).is_empty());
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "no name is left, even while it is open");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_one_line() {
        let file = File::options().write(true).open("/dev/full").unwrap();
        let scratch = Scratch::over(file, Path::new("here"), 1);
        let line = scratch.append(0, &[0; 10]).unwrap_err().to_string();
        assert!(
            line.contains("here: scratch space") && line.contains("No space left") && !line.contains('\n'),
            "{line}"
        );
    }
}
