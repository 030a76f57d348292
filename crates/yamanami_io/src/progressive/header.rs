//! The head of a progressive file: what must be there whole before any prefix says something.

use super::planes::MOST_PLANES;
use crate::IoError;
use crate::store::{connectivity, put_varint, take, take_varint};
use glam::DVec3;
use std::path::Path;
use yamanami_core::{BaseMesh, DetailScheme, Predictor, SemiRegular};

/// What a file begins with.
pub(super) const MAGIC: &[u8; 8] = b"YAMAPRG1";
const VERSION: u64 = 1;
/// Bit 0 of the flags.
const BUTTERFLY: u64 = 1;
/// Longest text, bytes.
const MOST_TEXT: usize = 1 << 16;
/// No triangle takes so little of a byte.
const MOST_TRIANGLES_A_BYTE: u64 = 1024;

/// What a progressive file says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgressiveMeta {
    /// For people.
    pub title: String,
    /// Where the model comes from, for people.
    pub source: String,
    /// What the coefficients mean; its origin is the centre of the model's box.
    pub scheme: DetailScheme,
    /// Half the size of the model's box, metres.
    pub half_size_m: [f32; 3],
    /// No vertex of the whole file is farther from the one that was given, metres.
    pub max_error_m: f32,
}

/// A file's head.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) meta: ProgressiveMeta,
    pub(super) mesh: SemiRegular,
    pub(super) planes: u32,
    /// Bytes after the head in the whole file.
    pub(super) body_bytes: u64,
    pub(super) body_crc: u32,
}

impl Header {
    /// Magic, length, content and checksum.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let (meta, mesh) = (&self.meta, &self.mesh);
        let base = mesh.base();
        let mut out = Vec::new();
        put_varint(&mut out, VERSION);
        put_varint(&mut out, if meta.scheme.predictor == Predictor::Butterfly { BUTTERFLY } else { 0 });
        for text in [&meta.title, &meta.source] {
            put_varint(&mut out, text.len() as u64);
            out.extend(text.as_bytes());
        }
        let counts = [base.vertex_count(), base.triangles().len() as u32, mesh.levels(), self.planes];
        counts.into_iter().for_each(|n| put_varint(&mut out, n.into()));
        let s = &meta.scheme;
        let [x, y, z] = s.origin_m.to_array();
        [x, y, z, s.base_step_m, s.step_m].into_iter().for_each(|v| out.extend(v.to_le_bytes()));
        let [a, b, c] = meta.half_size_m;
        let small = [s.level_ratio, s.tangent_ratio, s.update, a, b, c, meta.max_error_m];
        small.into_iter().for_each(|v| out.extend(v.to_le_bytes()));
        put_varint(&mut out, self.body_bytes);
        out.extend(self.body_crc.to_le_bytes());
        out.extend(connectivity::encode(base.vertex_count(), base.triangles()));
        let mut bytes = MAGIC.to_vec();
        put_varint(&mut bytes, out.len() as u64);
        bytes.extend(&out);
        bytes.extend(crc32fast::hash(&out).to_le_bytes());
        bytes
    }

    /// Reads a head; gives the bytes after it, too. `name` is for messages.
    pub(super) fn read<'a>(name: &Path, bytes: &'a [u8], most_vertices: u64) -> Result<(Self, &'a [u8]), IoError> {
        let whole = bytes.len();
        let cut = |what: &str, rest: &[u8]| {
            let place = format!("byte {}", whole - rest.len());
            IoError::malformed(
                name,
                place,
                format!("{what} of a progressive model"),
                format!("{} more bytes", rest.len()),
            )
        };
        let mut rest = bytes;
        match take(&mut rest, MAGIC.len()) {
            Some(magic) if magic == MAGIC => {}
            Some(magic) => {
                let found = format!("{:?}", String::from_utf8_lossy(magic));
                return Err(IoError::malformed(name, "byte 0", "YAMAPRG1, a progressive model", found));
            }
            None => return Err(cut("the first eight bytes", bytes)),
        }
        let length = take_varint(&mut rest).ok_or_else(|| cut("the length of the head", rest))?;
        let head = usize::try_from(length).ok().and_then(|length| take(&mut rest, length));
        let head = head.ok_or_else(|| cut(&format!("{length} bytes of the head"), rest))?;
        let crc = take(&mut rest, 4).ok_or_else(|| cut("the checksum of the head", rest))?;
        let (expected, found) = (crc32fast::hash(head), u32::from_le_bytes(crc.try_into().unwrap_or_default()));
        if expected != found {
            let expected = format!("checksum {expected:08x}, as the head has");
            return Err(IoError::malformed(name, "the head", expected, format!("{found:08x}")));
        }
        Ok((Fields { name, rest: head }.header(most_vertices)?, rest))
    }
}

/// The fields of a head, one after the other.
struct Fields<'a> {
    name: &'a Path,
    rest: &'a [u8],
}

impl Fields<'_> {
    fn bad(&self, place: &str, expected: impl Into<String>, found: impl ToString) -> IoError {
        IoError::malformed(self.name, format!("the head, {place}"), expected, found.to_string())
    }

    fn integer(&mut self, place: &str, most: u64) -> Result<u64, IoError> {
        let found = take_varint(&mut self.rest).ok_or_else(|| self.bad(place, "an integer", "the end"))?;
        if found > most { Err(self.bad(place, format!("at most {most}"), found)) } else { Ok(found) }
    }

    fn bytes<const N: usize>(&mut self, place: &str) -> Result<[u8; N], IoError> {
        let found = take(&mut self.rest, N).and_then(|b| b.try_into().ok());
        found.ok_or_else(|| self.bad(place, format!("{N} bytes"), "the end"))
    }

    fn text(&mut self, place: &str) -> Result<String, IoError> {
        let length = self.integer(place, MOST_TEXT as u64)? as usize;
        let text = take(&mut self.rest, length).ok_or_else(|| self.bad(place, format!("{length} bytes"), "the end"))?;
        String::from_utf8(text.to_vec()).map_err(|e| self.bad(place, "UTF-8", e))
    }

    fn real(&mut self, place: &str, is_right: impl Fn(f64) -> bool) -> Result<f64, IoError> {
        let value = f64::from_le_bytes(self.bytes(place)?);
        if is_right(value) { Ok(value) } else { Err(self.bad(place, "a number in range", value)) }
    }

    fn small_real(&mut self, place: &str, is_right: impl Fn(f32) -> bool) -> Result<f32, IoError> {
        let value = f32::from_le_bytes(self.bytes(place)?);
        if is_right(value) { Ok(value) } else { Err(self.bad(place, "a number in range", value)) }
    }

    fn header(mut self, most_vertices: u64) -> Result<Header, IoError> {
        let version = self.integer("version", u64::MAX)?;
        if version != VERSION {
            let what = format!("version {version} of progressive models");
            return Err(IoError::unsupported(self.name, what, format!("this program reads version {VERSION}")));
        }
        let flags = self.integer("flags", BUTTERFLY)?;
        let [title, source] = [self.text("title")?, self.text("source")?];
        let vertices = self.integer("base vertices", u32::MAX.into())?;
        let triangles = self.integer("base triangles", u64::from(u32::MAX) / 3)?;
        let levels = self.integer("levels", 15)? as u32;
        let planes = self.integer("planes", MOST_PLANES.into())? as u32;
        let far = |x: f64| x.is_finite() && x.abs() < 1e12;
        let step = |x: f64| x > 1e-30 && x < 1e12;
        let [x, y, z] = [self.real("origin", far)?, self.real("origin", far)?, self.real("origin", far)?];
        let [base_step_m, step_m] = [self.real("base step", step)?, self.real("step", step)?];
        let ratio = |x: f32| x > 1e-6 && x < 1e6;
        let [level_ratio, tangent_ratio] =
            [self.small_real("level ratio", ratio)?, self.small_real("tangent ratio", ratio)?];
        let update = self.small_real("update", |x| (0.0..=1.0).contains(&x))?;
        let size = |x: f32| x.is_finite() && x >= 0.0;
        let half_size_m = [
            self.small_real("size", size)?,
            self.small_real("size", size)?,
            self.small_real("size", size)?,
        ];
        let max_error_m = self.small_real("error", size)?;
        let body_bytes = self.integer("length of the rest", u64::MAX)?;
        let body_crc = u32::from_le_bytes(self.bytes("checksum of the rest")?);
        if triangles == 0 || triangles > MOST_TRIANGLES_A_BYTE * self.rest.len() as u64 || vertices > 3 * triangles {
            let found = format!("{triangles} of {vertices} vertices in {} bytes", self.rest.len());
            return Err(self.bad("base triangles", "some, of vertices that they use", found));
        }
        // a mesh has at least half as many vertices as triangles, or as many corners
        let finest = (triangles << (2 * levels)) / 2;
        if finest > most_vertices {
            return Err(IoError::too_large(self.name, "vertices of the finest level", finest, most_vertices));
        }
        let base = connectivity::decode(vertices as u32, triangles as usize, self.rest)
            .ok_or_else(|| self.bad("base triangles", "bytes that tell them", "others"))?;
        let mesh = BaseMesh::new(vertices as u32, base).and_then(|base| SemiRegular::new(base, levels));
        let mesh = mesh.map_err(|fault| self.bad("base triangles", "a surface", format!("{fault:?}")))?;
        let count = u64::from(mesh.vertex_count(levels));
        if count > most_vertices {
            return Err(IoError::too_large(self.name, "vertices of the finest level", count, most_vertices));
        }
        let predictor = if flags & BUTTERFLY != 0 { Predictor::Butterfly } else { Predictor::Hat };
        let origin_m = DVec3::new(x, y, z);
        let scheme = DetailScheme { predictor, update, origin_m, base_step_m, step_m, level_ratio, tangent_ratio };
        let meta = ProgressiveMeta { title, source, scheme, half_size_m, max_error_m };
        Ok(Header { meta, mesh, planes, body_bytes, body_crc })
    }
}
