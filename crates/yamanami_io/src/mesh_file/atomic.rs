//! A file that appears whole or not at all, packed where its name says so.

use super::packing::Packing;
use crate::IoError;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes beside the path (`name.part`), makes sure of the bytes and only then takes the name. On failure nothing is
/// left behind, and an old file keeps its content.
pub(crate) fn write(
    path: &Path,
    packing: Packing,
    content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), IoError> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    let written = File::create(&part).and_then(|file| {
        let mut out = BufWriter::with_capacity(1 << 18, file);
        packing.write(&mut out, content)?;
        out.flush()?;
        out.get_ref().sync_all()
    });
    let named = written.and_then(|()| std::fs::rename(&part, path));
    if let Err(e) = named {
        // the first failure is the one to report; the remnant may not even exist
        let _ = std::fs::remove_file(&part);
        return Err(IoError::io(path, e));
    }
    Ok(())
}
