//! Heights as colours of PNG tiles.

use super::{ExportJob, ExportReport, ExportSubject};
use crate::Error;

pub(super) fn tiles(_subject: ExportSubject<'_>, _job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    Err(Error::Request("terrain-rgb cannot be written yet".to_owned()))
}
