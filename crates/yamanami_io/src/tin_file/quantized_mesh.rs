//! quantized-mesh
use super::*;
pub(super) fn read(name: &Path, _c: impl BufRead, _o: &TinReadOptions) -> Result<ReadTin, IoError> {
    Err(IoError::unsupported(name, "", ""))
}
