//! One binary glTF.

use super::{ExportJob, ExportReport, ExportSubject};
use crate::Error;

pub(super) fn file(_subject: ExportSubject<'_>, _job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    Err(Error::Request("glb cannot be written yet".to_owned()))
}
