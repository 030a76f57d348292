//! The browser viewer and its data as static files.

use super::{ExportJob, ExportReport, ExportSubject};
use crate::Error;

pub(super) fn folder(_subject: ExportSubject<'_>, _job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    Err(Error::Request("site cannot be written yet".to_owned()))
}
