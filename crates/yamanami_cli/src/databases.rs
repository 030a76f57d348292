//! Sources as surface databases: those that are none yet are built into a folder that goes away with the program.

use crate::args::SourceArgs;
use crate::failure::Failure;
use crate::inputs;
use crate::progress::{Bar, note};
use std::path::{Path, PathBuf};
use yamanami::io::mesh_file;
use yamanami::io::tin_file::TinReadOptions;
use yamanami::{GroundOptions, ModelBuild, ModelStoreOptions, StoreOptions, Terrain, read_ground};

/// Databases, and the folder of those that were made.
#[derive(Debug)]
pub(crate) struct Databases {
    pub(crate) paths: Vec<PathBuf>,
    /// Keeps the folder there.
    _scratch: Option<tempfile::TempDir>,
}

/// The databases of sources: a `.yama`, a mesh or a TIN is one each, all elevation files together are one.
pub(crate) fn of(source: &SourceArgs) -> Result<Databases, Failure> {
    let mut paths = Vec::new();
    let mut grids = Vec::new();
    let mut scratch = None;
    for path in &source.sources {
        if inputs::is_progressive(path)? {
            return Err(Failure::failed(format!(
                "{}: expected a terrain, a scan or a TIN, found a progressive model; extract it first",
                path.display()
            )));
        }
        if inputs::is_yama(path) {
            paths.push(path.clone());
        } else if inputs::is_mesh(path) || inputs::is_tin(path) {
            let target = free_place(&mut scratch, path)?;
            build_model(source, path, &target)?;
            paths.push(target);
        } else {
            grids.push(path.clone());
        }
    }
    if let Some(first) = grids.first() {
        let target = free_place(&mut scratch, first)?;
        let terrain = inputs::open(&grids, &source.reading)?;
        build_terrain(&terrain, &grids, &target)?;
        paths.push(target);
    }
    Ok(Databases { paths, _scratch: scratch })
}

/// A name in the scratch folder that tells the source's.
fn free_place(scratch: &mut Option<tempfile::TempDir>, source: &Path) -> Result<PathBuf, Failure> {
    let folder = match scratch {
        Some(folder) => folder,
        None => scratch.insert(tempfile::tempdir()?),
    };
    let stem = source.file_stem().map_or_else(|| "surface".to_owned(), |s| s.to_string_lossy().into_owned());
    let number = std::fs::read_dir(folder.path())?.count();
    let own = folder.path().join(number.to_string());
    std::fs::create_dir(&own)?;
    Ok(own.join(format!("{stem}.yama")))
}

fn name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

fn build_terrain(terrain: &Terrain, sources: &[PathBuf], target: &Path) -> Result<(), Failure> {
    let names: Vec<String> = sources.iter().map(|p| name(p)).collect();
    let options = StoreOptions { source: names.join(", "), ..StoreOptions::default() };
    let bar = Bar::shares("preparing");
    Ok(terrain.store_as(target, &options, &|share| bar.set_share(share))?)
}

fn build_model(source: &SourceArgs, path: &Path, target: &Path) -> Result<(), Failure> {
    let bar = Bar::shares("building");
    let progress = |share| bar.set_share(share);
    let build = if inputs::is_tin(path) {
        let epsg = source.reading.options().dem.crs.and_then(|crs| crs.epsg);
        let tin = TinReadOptions { epsg, ..TinReadOptions::default() };
        let read = read_ground(&[path.to_owned()], &GroundOptions { tin, ..GroundOptions::default() })?;
        read.notes.iter().for_each(|line| note(&format!("note: {line}")));
        let title = if read.tin.name.is_empty() { name(path) } else { read.tin.name.clone() };
        ModelBuild::of_tin(&read.tin, title, &progress)?
    } else {
        ModelBuild::of_mesh(&mesh_file::read_mesh(path)?, name(path), &progress)?
    };
    build.store_as(target, &ModelStoreOptions { max_error_m: None, source: name(path) }, &|_| ())?;
    Ok(())
}
