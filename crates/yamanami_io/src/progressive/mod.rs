//! Semi-regular models as an embedded stream: any prefix of the file, once the head is there, is the whole surface, less
//! exactly.
//!
//! [`renumber`] gives a mesh the numbers that its file will have, [`encode`] makes the bytes, [`decode`] reads as many as there are,
//! [`write()`] puts them into a file. `docs/format.md` says what each byte means.

mod base;
mod coder;
mod contexts;
mod header;
mod links;
mod mixing;
mod planes;

use crate::IoError;
use coder::{Decoder, Encoder};
use std::path::Path;
use yamanami_core::SemiRegular;

pub use base::{Renumbered, renumber};
pub use header::ProgressiveMeta;

/// Vertices that any file may have, and those that each byte there is pays for: a few bytes must not claim gigabytes.
const FREE_VERTICES: u64 = 1 << 20;
const VERTICES_A_BYTE: u64 = 512;

/// How much a reader takes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProgressiveLimits {
    /// Most vertices of the finest level: a reader needs some hundred bytes for each, however short the file.
    pub vertices: u64,
}

impl Default for ProgressiveLimits {
    fn default() -> Self {
        Self { vertices: 1 << 25 }
    }
}

/// How much of a file was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProgressiveReport {
    /// Bytes read, with the head.
    pub bytes: u64,
    /// Bytes of the whole file.
    pub bytes_of: u64,
    /// Bit planes that are complete.
    pub planes: u32,
    /// Bit planes of the whole file.
    pub planes_of: u32,
    /// Levels that are complete in the plane after these.
    pub levels: u32,
    /// Levels of the mesh.
    pub levels_of: u32,
}

/// What was read of a file.
#[derive(Debug, Clone)]
pub struct ProgressiveModel {
    /// The mesh.
    pub mesh: SemiRegular,
    /// By vertex: what its integers are estimated to be; whole ones where the file is whole.
    pub coefficients: Vec<[f64; 3]>,
    /// What the file says of itself.
    pub meta: ProgressiveMeta,
    /// How much was read.
    pub report: ProgressiveReport,
}

/// The bytes of a file: a mesh with the numbers of [`renumber`], and three integers of at most 28 bits for each vertex.
pub fn encode(mesh: &SemiRegular, coefficients: &[[i32; 3]], meta: &ProgressiveMeta) -> Result<Vec<u8>, IoError> {
    let count = mesh.vertex_count(mesh.levels()) as usize;
    if coefficients.len() != count {
        return Err(bad_request("three integers for each vertex", format!("{} for {count}", coefficients.len())));
    }
    let planes = planes::planes_of(coefficients);
    if planes > planes::MOST_PLANES {
        return Err(bad_request("integers of at most 28 bits", format!("one of {planes} bits")));
    }
    let body = planes::put(mesh, coefficients, planes, Encoder::new()).finish();
    let (body_bytes, body_crc) = (body.len() as u64, crc32fast::hash(&body));
    let mut bytes = header::Header { meta: meta.clone(), mesh: mesh.clone(), planes, body_bytes, body_crc }.bytes();
    // what cannot be read again, for numbers or text out of range, is not written
    header::Header::read(Path::new("the model to write"), &bytes, u64::MAX)?;
    bytes.extend(body);
    Ok(bytes)
}

/// Reads a file, or as much of its beginning as there is, down to an error when that is not the whole head. `name` is for messages.
///
/// Safe on any bytes: never panics, and allocates no more than the limits allow and the bytes there are pay for: a million vertices, and 512
/// for each byte.
pub fn decode(name: &Path, bytes: &[u8], limits: ProgressiveLimits) -> Result<ProgressiveModel, IoError> {
    let paid_for = FREE_VERTICES + VERTICES_A_BYTE * bytes.len() as u64;
    let (header, rest) = header::Header::read(name, bytes, limits.vertices.min(paid_for))?;
    let head_bytes = (bytes.len() - rest.len()) as u64;
    let body = &rest[..rest.len().min(usize::try_from(header.body_bytes).unwrap_or(usize::MAX))];
    let is_whole = body.len() as u64 == header.body_bytes;
    if is_whole && crc32fast::hash(body) != header.body_crc {
        let expected = format!("checksum {:08x} over the rest", header.body_crc);
        let found = format!("{:08x}", crc32fast::hash(body));
        return Err(IoError::malformed(name, format!("byte {head_bytes}"), expected, found));
    }
    let known = planes::get(&header.mesh, header.planes, Decoder::new(body));
    if is_whole && known.reach.planes < header.planes {
        let expected = format!("{} bit planes", header.planes);
        return Err(IoError::malformed(name, format!("byte {head_bytes}"), expected, known.reach.planes.to_string()));
    }
    let report = ProgressiveReport {
        bytes: head_bytes + body.len() as u64,
        bytes_of: head_bytes.saturating_add(header.body_bytes),
        planes: known.reach.planes,
        planes_of: header.planes,
        levels: known.reach.levels,
        levels_of: header.mesh.levels(),
    };
    Ok(ProgressiveModel { mesh: header.mesh, coefficients: known.coefficients, meta: header.meta, report })
}

/// Whether a file begins as a progressive model does.
pub fn is_progressive(path: &Path) -> Result<bool, IoError> {
    use std::io::Read;
    let mut first = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(header::MAGIC.len() as u64).read_to_end(&mut first));
    read.map_err(|e| IoError::io(path, e))?;
    Ok(first == header::MAGIC)
}

/// Writes a file of these bytes; it appears whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    crate::mesh_file::write_file(path, bytes)
}

fn bad_request(expected: &str, given: String) -> IoError {
    IoError::BadRequest { what: "progressive model".into(), expected: expected.into(), given }
}
