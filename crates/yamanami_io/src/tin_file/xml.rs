//! XML files: LandXML or CityGML, as the root element says.

use super::{ReadTin, TinReadOptions};
use crate::IoError;
use std::io::BufRead;
use std::path::Path;

/// Reads the TIN of an XML file.
pub(super) fn read(name: &Path, content: impl BufRead, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let _ = (content, options);
    Err(IoError::unsupported(name, "not read yet", "wait"))
}
