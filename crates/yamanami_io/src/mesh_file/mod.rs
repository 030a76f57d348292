//! Mesh files: PLY, OBJ, STL, OFF, glTF and GLB by their extension, in and out; `.gz` and `.zst` around any of them.
//!
//! | format | written as | coordinates | colours | texture coordinates | materials and pictures |
//! |---|---|---|---|---|---|
//! | `.ply` | binary, little endian | double precision | yes | yes | pictures beside it |
//! | `.obj` | text | every digit | without alpha | yes | in an `.mtl` and pictures beside it |
//! | `.stl` | binary | single precision, relative to an origin stated in the header where they are large | | | |
//! | `.off` | text | every digit | yes | yes | |
//! | `.glb` | glTF 2.0, y up | single precision, relative to an origin that is the node's translation | yes | yes | in it |
//!
//! glTF of text (`.gltf`) is read only. Its buffers may lie in it, beside it, or be packed by meshopt.
//!
//! What is read back is in metres, z up, checked: every position finite, every index in range, every attribute one a
//! vertex or absent. Polygons come as triangles; repeated corners and faces are the model's own affair and stay.

pub(crate) mod atomic;
mod checked;
mod companions;
mod glb_write;
mod gltf_buffers;
mod gltf_json;
mod gltf_materials;
mod gltf_read;
mod meshopt_decode;
mod meshopt_filter;
mod mtl;
mod obj_read;
mod obj_write;
mod off;
mod origin;
pub(crate) mod packing;
mod ply_header;
mod ply_read;
mod ply_values;
mod ply_vertices;
mod ply_write;
mod polygon;
mod seams;
mod srgb;
mod stl;
mod stream;

pub use stream::{MeshStream, TriangleSink, VertexRun, VertexSink};

use crate::IoError;
use companions::Pictures;
pub(crate) use glb_write::glb_head;
pub use meshopt_decode::{MeshoptFilter, MeshoptMode, decode_meshopt};
use origin::Origin;
use packing::Packing;
pub(crate) use srgb::linear_word_of_byte;
use std::path::Path;
use yamanami_core::TriangleMesh;

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

/// Writes a file of these bytes; it appears whole or not at all.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    atomic::write(path, Packing::None, |out| out.write_all(bytes))
}

/// Text without line breaks or other control characters.
pub(crate) fn one_line(text: &str) -> String {
    text.split(char::is_control).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
}

/// A mesh format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Ply,
    Obj,
    Stl,
    Off,
    Glb,
    Gltf,
}

impl Format {
    /// The format of a name without the end of its packing.
    fn of(name: &Path) -> Result<Self, IoError> {
        let extension = name.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "ply" => Ok(Self::Ply),
            "obj" => Ok(Self::Obj),
            "stl" => Ok(Self::Stl),
            "off" => Ok(Self::Off),
            "glb" => Ok(Self::Glb),
            "gltf" => Ok(Self::Gltf),
            _ => Err(IoError::unsupported(
                name,
                format!("'{extension}' is not a mesh format known here"),
                "use .ply, .obj, .stl, .off, .glb or .gltf",
            )),
        }
    }
}

/// Whether a file's name ends like one of a mesh that [`read_mesh`] knows.
pub fn is_mesh_name(path: &Path) -> bool {
    Format::of(&Packing::of(path).1).is_ok()
}

/// Writes a mesh in the format of the path's extension, and the pictures and materials that belong to it beside it where
/// the format wants that. Each file appears whole or not at all; the mesh is the last.
pub fn write_mesh(path: impl AsRef<Path>, mesh: &TriangleMesh, meta: &MeshMeta) -> Result<(), IoError> {
    let path = path.as_ref();
    let (packing, inner) = Packing::of(path);
    let format = Format::of(&inner)?;
    checked::writable(path, mesh)?;
    match format {
        Format::Ply => {
            let pictures = Pictures::of(&inner, mesh);
            pictures.write(path)?;
            atomic::write(path, packing, |out| ply_write::write(out, mesh, meta, &pictures))
        }
        Format::Obj => {
            let pictures = Pictures::of(&inner, mesh);
            pictures.write(path)?;
            let materials = obj_write::material_names(mesh);
            let library = inner.with_extension("mtl");
            if !materials.is_empty() {
                atomic::write(&library, Packing::None, |out| {
                    obj_write::write_library(out, mesh, &materials, &pictures)
                })?;
            }
            let library = library.file_name().unwrap_or_default().to_string_lossy();
            atomic::write(path, packing, |out| obj_write::write(out, mesh, meta, &library, &materials))
        }
        Format::Stl => atomic::write(path, packing, |out| stl::write(out, mesh, meta)),
        Format::Off => atomic::write(path, packing, |out| off::write(out, mesh, meta)),
        Format::Glb => {
            glb_write::check_size(path, mesh)?;
            atomic::write(path, packing, |out| glb_write::write(out, mesh, meta))
        }
        Format::Gltf => Err(IoError::unsupported(path, "glTF is written as one binary file", "use .glb")),
    }
}

/// A mesh that was read, and what was not.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadMesh {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// What was left out or could not be read without making the mesh useless: a missing picture, a vertex without a
    /// place. One line each.
    pub notes: Vec<String>,
}

/// Reads a mesh file.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<TriangleMesh, IoError> {
    read_mesh_with_notes(path).map(|read| read.mesh)
}

/// Reads a mesh file and says what it left out.
pub fn read_mesh_with_notes(path: impl AsRef<Path>) -> Result<ReadMesh, IoError> {
    let path = path.as_ref();
    Format::of(&Packing::of(path).1)?;
    let bytes = std::fs::read(path).map_err(|e| IoError::io(path, e))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    read(Origin::new(path, Some(folder)), &bytes)
}

/// Reads a mesh from the bytes of a file; the name's extension says the format. Files beside it are not looked for.
pub fn read_mesh_from_bytes(name: impl AsRef<Path>, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    read(Origin::new(name.as_ref(), None), bytes).map(|read| read.mesh)
}

fn read(mut origin: Origin<'_>, bytes: &[u8]) -> Result<ReadMesh, IoError> {
    let (packing, inner) = Packing::of(origin.name);
    let format = Format::of(&inner)?;
    let bytes = packing.unpack(origin.name, bytes)?;
    let mesh = match format {
        Format::Ply => ply_read::read(&mut origin, &bytes),
        Format::Obj => obj_read::read(&mut origin, &bytes),
        Format::Stl => stl::read(origin.name, &bytes),
        Format::Off => off::read(&mut origin, &bytes),
        Format::Glb => gltf_read::read_binary(&mut origin, &bytes),
        Format::Gltf => gltf_read::read_text(&mut origin, &bytes),
    }?;
    let mesh = checked::readable(&mut origin, mesh)?;
    Ok(ReadMesh { mesh, notes: origin.into_notes() })
}
