//! 3D Tiles 1.1: a folder, or one archive.

use super::{ExportJob, ExportReport, ExportSubject};
use crate::Error;

pub(super) fn folder(_subject: ExportSubject<'_>, _job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    Err(Error::Request("3dtiles cannot be written yet".to_owned()))
}

pub(super) fn archive(_subject: ExportSubject<'_>, _job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    Err(Error::Request("3tz cannot be written yet".to_owned()))
}
