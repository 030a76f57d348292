//! TIN files: LandXML, DXF, CityGML relief, 2DM and quantized-mesh by their extension, and meshes that are terrain.
//!
//! | format | read | written | coordinates | breaklines | hidden faces | CRS |
//! |---|---|---|---|---|---|---|
//! | LandXML 1.0 to 2.0, J-LandXML (`.xml`, `.landxml`) | yes | yes, 1.2 | every digit | yes | yes | yes |
//! | DXF (`.dxf`) | 3DFACE, polyface and polygon meshes, MESH, lines | release 12, 3DFACE | every digit | yes | yes | no |
//! | CityGML 2 and 3 relief (`.gml`) | `TINRelief`, `BreaklineRelief` | no | projected | yes | no | yes |
//! | SMS 2DM (`.2dm`) | triangles and quadrilaterals | yes, in metres | every digit | all hard | no | no |
//! | quantized-mesh (`.terrain`) | 1.0 | no | projected | | | yes |
//! | GeoPackage (`.gpkg`) | no | polygons and lines | doubles | yes | yes | yes |
//! | PLY, OBJ, STL, OFF, glTF (see [`crate::mesh_file`]) | yes | yes | | | | |
//!
//! `.gz` and `.zst` around any of the text formats; XML in UTF-8, UTF-16, Shift_JIS, EUC-JP and others. What comes out is
//! in metres, z up, counter-clockwise from above, whatever the axis order, unit and orientation of the file; every position
//! is finite and every index in range. Longitudes and latitudes are projected, vertex by vertex, into the metric CRS of their
//! place on the same datum.

mod check;
mod citygml;
mod dxf;
mod gpkg;
mod landxml_read;
mod landxml_surface;
mod landxml_words;
mod landxml_write;
mod lines;
mod metric;
mod notes;
mod number;
mod quantized_mesh;
mod sms_2dm;
mod srs_name;
mod text;
mod upward;
mod weld;
pub(crate) mod xml;

use crate::IoError;
use crate::mesh_file::{self, MeshMeta, ReadMesh, atomic, packing::Packing};
use notes::Notes;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;
use yamanami_core::{Breakline, Crs, Tin};

/// What is asked of a file beside its path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TinReadOptions {
    /// Which surface, by name, where the file has several; else the one with the most triangles.
    pub surface: Option<String>,
    /// Metres in a unit of the coordinates, where the file does not say or is wrong.
    pub unit_m: Option<f64>,
    /// EPSG code of the coordinates, where the file does not say or is wrong.
    pub epsg: Option<u32>,
}

/// A TIN that was read, and what was not.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadTin {
    /// The TIN.
    pub tin: Tin,
    /// What was dropped, mended or assumed, with its place in the file: one line each.
    pub notes: Vec<String>,
    /// Names of the other surfaces of the file.
    pub other_surfaces: Vec<String>,
    /// Where triangles were looked for, which, and what was there instead; `None` where there are any.
    lack: Option<Lack>,
}

/// What a file lacks that has no triangle: place, expected, found.
type Lack = [String; 3];

/// Lines that were read, and what was not.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadBreaklines {
    /// The lines, in metres.
    pub lines: Vec<Breakline>,
    /// The CRS of x and y; unknown where the file does not say.
    pub crs: Crs,
    /// What was dropped, mended or assumed, with its place in the file: one line each.
    pub notes: Vec<String>,
}

impl ReadTin {
    /// An error where there is no triangle.
    fn with_triangles(self, name: &Path) -> Result<Self, IoError> {
        match self.lack {
            Some([place, expected, found]) => Err(IoError::malformed(name, place, expected, found)),
            None => Ok(self),
        }
    }
}

/// A TIN format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    /// LandXML or CityGML: the root element says which.
    Xml,
    Dxf,
    Sms2dm,
    QuantizedMesh,
    GeoPackage,
    /// A mesh that is terrain.
    Mesh,
}

impl Format {
    /// The format of a name without the end of its packing.
    fn of(name: &Path) -> Result<Self, IoError> {
        let extension = name.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "xml" | "landxml" | "gml" => Ok(Self::Xml),
            "dxf" => Ok(Self::Dxf),
            "2dm" => Ok(Self::Sms2dm),
            "terrain" => Ok(Self::QuantizedMesh),
            "gpkg" => Ok(Self::GeoPackage),
            _ if mesh_file::is_mesh_name(name) => Ok(Self::Mesh),
            _ => Err(IoError::unsupported(
                name,
                format!("'{extension}' is not a TIN format known here"),
                "use .xml (LandXML), .gml, .dxf, .2dm, .terrain, .gpkg, .ply, .obj, .stl, .off or .glb",
            )),
        }
    }
}

/// Whether a file's name ends like one that [`read_tin`] knows.
pub fn is_tin_name(path: &Path) -> bool {
    Format::of(&Packing::of(path).1).is_ok()
}

/// Reads a TIN in the format of the path's extension.
pub fn read_tin(path: impl AsRef<Path>, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let path = path.as_ref();
    read_file(path, options)?.with_triangles(path)
}

/// Reads the breaklines of a TIN file, whether it has triangles or not.
pub fn read_breaklines(path: impl AsRef<Path>, options: &TinReadOptions) -> Result<ReadBreaklines, IoError> {
    let path = path.as_ref();
    let ReadTin { tin, notes, .. } = read_file(path, options)?;
    if tin.breaklines.is_empty() {
        let found = format!("none, and {} triangles", tin.mesh.triangles.len());
        return Err(IoError::malformed(path, "whole file", "breaklines", found));
    }
    Ok(ReadBreaklines { lines: tin.breaklines, crs: tin.crs, notes })
}

fn read_file(path: &Path, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    check::options(options)?;
    if Format::of(&Packing::of(path).1)? == Format::Mesh {
        return of_mesh(path, mesh_file::read_mesh_with_notes(path)?, options);
    }
    let file = File::open(path).map_err(|e| IoError::io(path, e))?;
    let bytes = file.metadata().map_err(|e| IoError::io(path, e))?.len();
    read(path, BufReader::with_capacity(1 << 18, file), bytes, options)
}

/// Reads a TIN from the bytes of a file; the name's extension says the format. Files beside it are not looked for.
pub fn read_tin_from_bytes(name: impl AsRef<Path>, bytes: &[u8], options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let name = name.as_ref();
    check::options(options)?;
    if Format::of(&Packing::of(name).1)? == Format::Mesh {
        let mesh = mesh_file::read_mesh_from_bytes(name, bytes)?;
        return of_mesh(name, ReadMesh { mesh, ..ReadMesh::default() }, options)?.with_triangles(name);
    }
    read(name, bytes, bytes.len() as u64, options)?.with_triangles(name)
}

/// Reads what is no mesh. Readers take the name for messages, the content without its packing, and the options.
fn read(name: &Path, packed: impl BufRead, packed_bytes: u64, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let (packing, inner) = Packing::of(name);
    let content = packing.reader(packed, packed_bytes).map_err(|e| IoError::io(name, e))?;
    match Format::of(&inner)? {
        Format::Xml => xml::read(name, content, options),
        Format::Dxf => dxf::read(name, content, options),
        Format::Sms2dm => sms_2dm::read(name, content, options),
        Format::QuantizedMesh => quantized_mesh::read(name, content, options),
        Format::GeoPackage => {
            Err(IoError::unsupported(name, "GeoPackages are only written", "read what it was made of"))
        }
        Format::Mesh => Err(IoError::unsupported(name, "a mesh is not read as a stream", "read it whole")),
    }
}

/// The mesh of a file as a TIN: its unit and CRS are those of the options.
fn of_mesh(name: &Path, read: ReadMesh, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let inner = Packing::of(name).1;
    let mut tin = Tin::of_mesh(inner.file_stem().unwrap_or_default().to_string_lossy(), read.mesh);
    tin.unit_m = options.unit_m.unwrap_or(1.0);
    tin.crs = check::crs(options);
    for p in &mut tin.mesh.positions {
        *p *= tin.unit_m;
    }
    let mut notes = Notes::default();
    for line in read.notes {
        notes.say(line);
    }
    Ok(check::readable(tin, notes))
}

/// Writes a TIN in the format of the path's extension. The file appears whole or not at all.
pub fn write_tin(path: impl AsRef<Path>, tin: &Tin) -> Result<(), IoError> {
    let path = path.as_ref();
    let (packing, inner) = Packing::of(path);
    let format = Format::of(&inner)?;
    check::writable(path, tin)?;
    match format {
        Format::Xml => atomic::write(path, packing, |out| landxml_write::write(out, tin)),
        Format::Dxf => atomic::write(path, packing, |out| dxf::write(out, tin)),
        Format::Sms2dm => atomic::write(path, packing, |out| sms_2dm::write(out, tin)),
        Format::QuantizedMesh => Err(IoError::unsupported(path, "quantized-mesh is only read", "write .xml or .dxf")),
        Format::GeoPackage => gpkg::write(path, tin),
        Format::Mesh => {
            let crs = tin.crs.epsg.map_or(String::new(), |epsg| format!("EPSG:{epsg} {}", tin.crs.name));
            let meta = MeshMeta { title: tin.name.clone(), crs, note: String::new() };
            mesh_file::write_mesh(path, &tin.mesh, &meta)
        }
    }
}
