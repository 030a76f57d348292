//! gpkg
use super::*;
pub(super) fn write(name: &Path, _t: &Tin) -> Result<(), IoError> {
    Err(IoError::unsupported(name, "", ""))
}
