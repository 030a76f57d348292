//! TIN files: LandXML, DXF, CityGML relief, 2DM and quantized-mesh by their extension, and meshes that are terrain.
//!
//! | format | read | written | coordinates | breaklines | hidden faces | CRS |
//! |---|---|---|---|---|---|---|
//! | LandXML 1.2, 2.0, J-LandXML (`.xml`, `.landxml`) | yes | yes, 1.2 | every digit | yes | yes | yes |
//! | DXF (`.dxf`) | 3DFACE, polyface and polygon meshes, lines | 3DFACE | every digit | yes | layer | no |
//! | CityGML 2 relief (`.gml`) | `TINRelief` | no | projected | | | yes |
//! | SMS 2DM (`.2dm`) | triangles and quadrilaterals | yes | every digit | | | no |
//! | quantized-mesh (`.terrain`) | 1.0 | no | projected | | | yes |
//! | GeoPackage (`.gpkg`) | no | yes | doubles | yes | | yes |
//! | PLY, OBJ, STL, OFF, glTF (see [`crate::mesh_file`]) | yes | yes | | | | |
//!
//! `.gz` and `.zst` around any of the text formats. What comes out is in metres, z up, counter-clockwise from above,
//! whatever the axis order, unit and orientation of the file; every position is finite and every index in range.
//! Longitudes and latitudes are projected, vertex by vertex, into the metric CRS of their place on the same datum.

use crate::IoError;
use std::path::Path;
use yamanami_core::Tin;

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
}

/// Reads a TIN in the format of the path's extension.
pub fn read_tin(path: impl AsRef<Path>, options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let path = path.as_ref();
    let _ = options;
    Err(IoError::unsupported(path, "not read yet", "wait"))
}

/// Writes a TIN in the format of the path's extension. The file appears whole or not at all.
pub fn write_tin(path: impl AsRef<Path>, tin: &Tin) -> Result<(), IoError> {
    let path = path.as_ref();
    let _ = tin;
    Err(IoError::unsupported(path, "not written yet", "wait"))
}
