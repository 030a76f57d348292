//! 3D Tiles 1.1: a folder, or one archive.

use super::{ExportJob, ExportKind, ExportReport, ExportSubject, model_tiles, terrain_3d};
use crate::Error;
use std::path::PathBuf;
use yamanami_io::IoError;
use yamanami_io::tiles::{TileFolder, pack_3tz};

pub(super) fn folder(subject: ExportSubject<'_>, job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    let folder = TileFolder::create(job.output, &job.identity(ExportKind::Tiles3d))?;
    let report = tiles(subject, job, &folder)?;
    folder.finish()?;
    Ok(report)
}

pub(super) fn archive(subject: ExportSubject<'_>, job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    if job.output.is_dir() {
        return Err(Error::Request(format!("{}: is a folder; an archive is a file", job.output.display())));
    }
    let mut beside = job.output.as_os_str().to_owned();
    beside.push(".tiles");
    let folder = TileFolder::create(&PathBuf::from(beside), &job.identity(ExportKind::Tiles3tz))?;
    let report = tiles(subject, job, &folder)?;
    pack_3tz(folder.part(), job.output)?;
    std::fs::remove_dir_all(folder.part()).map_err(|e| IoError::io(folder.part(), e))?;
    Ok(report)
}

fn tiles(subject: ExportSubject<'_>, job: &ExportJob<'_>, folder: &TileFolder) -> Result<ExportReport, Error> {
    match subject {
        ExportSubject::Model(model) => model_tiles::write(model, job, folder),
        ExportSubject::Terrain(terrain) => terrain_3d::write(terrain, job, folder),
    }
}
