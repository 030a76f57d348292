//! Mesh files: PLY, OBJ, STL and GLB by their extension, in and out; `.gz` around any of them when reading.
//!
//! | format | written as | coordinates |
//! |---|---|---|
//! | `.ply` | binary, little endian | double precision |
//! | `.obj` | text | every digit |
//! | `.stl` | binary | single precision, relative to an origin stated in the header where they are large |
//! | `.glb` | glTF 2.0, y up | single precision, relative to an origin that is the node's translation |
//!
//! What is read back is in metres, z up, checked: every position finite, every index in range.

mod atomic;
mod checked;
mod glb_read;
mod glb_write;
mod obj;
mod ply_header;
mod ply_read;
mod ply_write;
mod stl;
mod stream;

pub use stream::{MeshStream, TriangleSink, VertexRun, VertexSink};

use crate::IoError;
use std::io::Read;
use std::path::Path;
use yamanami_core::TriangleMesh;

/// Most bytes that a compressed mesh file may unpack to.
const UNPACKED_LIMIT: u64 = 8 << 30;

/// What a mesh file says about itself beside the mesh.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MeshMeta {
    /// Title, e.g. the source's name. May be empty.
    pub title: String,
    /// The coordinate reference system, e.g. `EPSG:32654 WGS 84 / UTM zone 54N`. May be empty.
    pub crs: String,
    /// Anything else: the frame, credits, the error kept. May be empty.
    pub note: String,
}

impl MeshMeta {
    /// The lines worth writing, each label and text on one line.
    fn lines(&self) -> impl Iterator<Item = String> {
        [("title", &self.title), ("crs", &self.crs), ("note", &self.note)]
            .into_iter()
            .filter(|(_, text)| !text.trim().is_empty())
            .map(|(label, text)| format!("{label}: {}", one_line(text)))
    }
}

/// Text without line breaks or other control characters.
fn one_line(text: &str) -> String {
    text.split(char::is_control).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
}

/// A mesh format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Ply,
    Obj,
    Stl,
    Glb,
}

impl Format {
    fn of(name: &Path) -> Result<Self, IoError> {
        let extension = name.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "ply" => Ok(Self::Ply),
            "obj" => Ok(Self::Obj),
            "stl" => Ok(Self::Stl),
            "glb" => Ok(Self::Glb),
            _ => Err(IoError::unsupported(
                name,
                format!("'{extension}' is not a mesh format known here"),
                "use .ply, .obj, .stl or .glb",
            )),
        }
    }
}

/// Whether a file's name ends like one of a mesh that [`read_mesh`] knows.
pub fn is_mesh_name(path: &Path) -> bool {
    Format::of(&without_gz(path)).is_ok()
}

/// Writes a mesh in the format of the path's extension. The file appears whole or not at all.
pub fn write_mesh(path: impl AsRef<Path>, mesh: &TriangleMesh, meta: &MeshMeta) -> Result<(), IoError> {
    let path = path.as_ref();
    let format = Format::of(path)?;
    checked::writable(path, mesh)?;
    if format == Format::Glb {
        glb_write::check_size(path, mesh)?;
    }
    atomic::write(path, |out| match format {
        Format::Ply => ply_write::write(out, mesh, meta),
        Format::Obj => obj::write(out, mesh, meta),
        Format::Stl => stl::write(out, mesh, meta),
        Format::Glb => glb_write::write(out, mesh, meta),
    })
}

/// Reads a mesh file.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<TriangleMesh, IoError> {
    let path = path.as_ref();
    Format::of(&without_gz(path))?;
    let bytes = std::fs::read(path).map_err(|e| IoError::io(path, e))?;
    read_mesh_from_bytes(path, &bytes)
}

/// Reads a mesh from the bytes of a file; the name's extension says the format.
pub fn read_mesh_from_bytes(name: impl AsRef<Path>, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let name = name.as_ref();
    let inner = without_gz(name);
    let format = Format::of(&inner)?;
    let unpacked;
    let bytes = if inner == name {
        bytes
    } else {
        unpacked = unpack(name, bytes)?;
        &unpacked
    };
    let mesh = match format {
        Format::Ply => ply_read::read(name, bytes),
        Format::Obj => obj::read(name, bytes),
        Format::Stl => stl::read(name, bytes),
        Format::Glb => glb_read::read(name, bytes),
    }?;
    checked::readable(name, mesh)
}

/// The name without a final `.gz`.
fn without_gz(name: &Path) -> std::path::PathBuf {
    let packed = name.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    if packed { name.with_extension("") } else { name.to_owned() }
}

fn unpack(name: &Path, bytes: &[u8]) -> Result<Vec<u8>, IoError> {
    let mut unpacked = Vec::new();
    flate2::read::MultiGzDecoder::new(bytes)
        .take(UNPACKED_LIMIT + 1)
        .read_to_end(&mut unpacked)
        .map_err(|e| IoError::malformed(name, "compressed data", "a whole gzip stream", e.to_string()))?;
    if unpacked.len() as u64 > UNPACKED_LIMIT {
        return Err(IoError::too_large(name, "bytes unpacked", unpacked.len() as u64, UNPACKED_LIMIT));
    }
    Ok(unpacked)
}
