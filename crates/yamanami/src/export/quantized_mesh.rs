//! quantized-mesh 1.0: the pyramid and its `layer.json`.

use super::{ExportJob, ExportReport, ExportSubject};
use crate::Error;

pub(super) fn folder(_subject: ExportSubject<'_>, _job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    Err(Error::Request("quantized-mesh cannot be written yet".to_owned()))
}
