//! Opening what a command works on, and looking before writing.

use crate::args::{ReadingArgs, SourceArgs};
use crate::failure::Failure;
use crate::progress::{Bar, note};
use std::path::{Path, PathBuf};
use yamanami::core::{HeightField, TriangleMesh};
use yamanami::io::points::is_points_name;
use yamanami::io::tin_file::TinReadOptions;
use yamanami::io::{IoError, dem, mesh_file, progressive, store::ClusterStore};
use yamanami::{FullSurface, Model, Terrain, WaveletModel};

/// What a command works on.
#[derive(Debug)]
pub(crate) enum Opened {
    Terrain(Box<Terrain>),
    Model(Box<Model>),
    Progressive(Box<WaveletModel>),
}

/// Opens what a command works on: a terrain, or a model where its one source is a mesh file, a model's
/// database or a progressive model.
pub(crate) fn subject(source: &SourceArgs) -> Result<Opened, Failure> {
    if let [path] = source.sources.as_slice()
        && is_model(path)?
    {
        if is_progressive(path)? {
            let _bar = Bar::spinner("decoding");
            return Ok(Opened::Progressive(Box::new(WaveletModel::open(path, u64::MAX)?)));
        }
        let bar = Bar::shares("opening");
        let model = Model::open(path, &|share| bar.set_share(share))?;
        drop(bar);
        model.notes().iter().for_each(|line| note(&format!("note: {line}")));
        return Ok(Opened::Model(Box::new(model)));
    }
    match open(&source.sources, &source.reading) {
        Err(_) if source.sources.iter().all(|p| is_points_name(p) && p.is_file()) => Err(Failure::failed(format!(
            "{}: points are no surface yet: yamanami tin makes a TIN of them",
            source.sources[0].display()
        ))),
        opened => Ok(Opened::Terrain(Box::new(opened?))),
    }
}

/// Whether a file is a TIN by its format; meshes may be TINs and do not count.
pub(crate) fn is_tin(path: &Path) -> bool {
    yamanami::is_tin_file(path)
}

/// Whether a file is a TIN, a mesh or a model's database.
pub(crate) fn is_model(path: &Path) -> Result<bool, Failure> {
    Ok(is_tin(path) || is_mesh(path) || is_progressive(path)? || (is_yama(path) && ClusterStore::is_model(path)?))
}

/// Whether a file is a progressive model.
pub(crate) fn is_progressive(path: &Path) -> Result<bool, Failure> {
    Ok(is_yama(path) && progressive::is_progressive(path)?)
}

/// A mesh file as it is, or the finest mesh of a model's database.
pub(crate) fn mesh(path: &Path) -> Result<TriangleMesh, Failure> {
    Ok(yamanami::finest_mesh(path)?)
}

/// All triangles of a terrain: a TIN, a mesh, a database, or elevation files. Tells on stderr what was dropped.
pub(crate) fn full_surface(
    sources: &[PathBuf],
    reading: &ReadingArgs,
    tin: &TinReadOptions,
) -> Result<FullSurface, Failure> {
    let full = {
        let bar = Bar::shares("opening");
        FullSurface::open(sources, &reading.options(), tin, &|share| bar.set_share(share))?
    };
    full.notes.iter().for_each(|line| note(&format!("note: {line}")));
    if full.mesh.triangles.is_empty() {
        return Err(Failure::failed(format!("{}: has no triangles", sources[0].display())));
    }
    Ok(full)
}

/// Whether a file's name is that of a mesh.
pub(crate) fn is_mesh(path: &Path) -> bool {
    mesh_file::is_mesh_name(path)
}

/// Opens a database, or builds elevation files in memory.
pub(crate) fn open(sources: &[PathBuf], reading: &ReadingArgs) -> Result<Terrain, Failure> {
    let bar = Bar::shares("opening");
    Ok(Terrain::open(sources, &reading.options(), &|share| bar.set_share(share))?)
}

/// The heights to measure against: those of the files themselves, or all that a database holds.
pub(crate) fn field(terrain: &Terrain, source: &SourceArgs) -> Result<HeightField, Failure> {
    let _bar = Bar::spinner("reading heights");
    if terrain.store().is_some() {
        return Ok(terrain.field()?);
    }
    Ok(dem::open(&source.sources, &source.reading.options().dem)?.read_all()?)
}

/// Whether a file's name is that of a database.
pub(crate) fn is_yama(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yama"))
}

/// Checks the name of a file to write: its ending is one of `endings`, and it is none of the inputs.
pub(crate) fn check_output(output: &Path, endings: &[&str], inputs: &[PathBuf]) -> Result<(), Failure> {
    let ending = output.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if !endings.contains(&ending.as_str()) {
        let list = endings.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ");
        let what = if ending.is_empty() { "no ending".to_owned() } else { format!("unknown ending .{ending}") };
        return Err(IoError::unsupported(output, what, format!("expected one of {list}")).into());
    }
    let same = |input: &PathBuf| match (input.canonicalize(), output.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    if inputs.iter().any(same) {
        return Err(Failure::failed(format!("{}: is an input; give another name with -o", output.display())));
    }
    match output.parent().filter(|p| !p.as_os_str().is_empty()) {
        Some(folder) if !folder.is_dir() => {
            Err(Failure::failed(format!("{}: there is no folder {}", output.display(), folder.display())))
        }
        _ if output.is_dir() => Err(Failure::failed(format!("{}: is a folder", output.display()))),
        _ => Ok(()),
    }
}

/// Makes a folder for results.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|e| IoError::io(folder, e).into())
}

/// Writes a text file.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|e| IoError::io(path, e).into())
}

/// Bytes of a file.
pub(crate) fn file_bytes(path: &Path) -> Result<u64, Failure> {
    Ok(std::fs::metadata(path).map_err(|e| IoError::io(path, e))?.len())
}

/// Bytes of files and of what lies in folders; what cannot be read counts nothing.
pub(crate) fn total_bytes(paths: &[PathBuf]) -> u64 {
    let mut waiting = paths.to_vec();
    let mut sum = 0;
    while let Some(path) = waiting.pop() {
        if path.is_dir() {
            let entries = std::fs::read_dir(&path).into_iter().flatten().flatten();
            waiting.extend(entries.filter(|e| e.file_type().is_ok_and(|t| !t.is_symlink())).map(|e| e.path()));
        } else {
            sum += std::fs::metadata(&path).map_or(0, |m| m.len());
        }
    }
    sum
}
