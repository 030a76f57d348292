//! CityGML relief.

use super::xml::Xml;
use super::{ReadTin, TinReadOptions};
use crate::IoError;
use std::io::BufRead;

/// Reads the TIN of a city model.
pub(super) fn read<R: BufRead>(xml: Xml<'_, R>, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let _ = options;
    Err(IoError::unsupported(xml.name(), "not read yet", "wait"))
}
