//! Meshes read a stretch at a time, as often as it takes: for scans larger than memory.
//!
//! PLY in all its forms: text and both byte orders, any order of properties, polygons cut into fans; packed ones are
//! unpacked into scratch space first. Places and colours of vertices come, no other attribute. Nothing here grows with the
//! size of the file.

mod faces;
mod vertices;
mod window;

use super::Format;
use super::packing::{Packing, UNPACKED_FOLD, UNPACKED_FREE};
use super::ply_header::{self, Element, Encoding};
use crate::{IoError, scratch};
use glam::DVec3;
use std::fs::File;
use std::io::{BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};
use window::Window;

/// Longest header read.
const HEADER_LIMIT: u64 = 1 << 20;

/// Some vertices of a mesh, one after the other.
#[derive(Debug, Clone, Copy)]
pub struct VertexRun<'a> {
    /// Number of the first.
    pub first: u32,
    /// Their places, finite.
    pub positions: &'a [DVec3],
    /// Their colours, or empty.
    pub colours: &'a [[u8; 4]],
}

/// Hears of vertices.
pub type VertexSink<'a> = dyn FnMut(VertexRun<'_>) -> Result<(), IoError> + 'a;
/// Hears of triangles; their corners are in range.
pub type TriangleSink<'a> = dyn FnMut(&[[u32; 3]]) -> Result<(), IoError> + 'a;

/// A mesh file that is read in passes of bounded memory.
#[derive(Debug)]
pub struct MeshStream {
    path: PathBuf,
    file: File,
    length: u64,
    encoding: Encoding,
    elements: Vec<Element>,
    /// Where in the file each element starts, as far as known.
    starts: Vec<Option<u64>>,
    vertex: usize,
    face: usize,
    layout: vertices::Layout,
}

impl MeshStream {
    /// Whether a file of this name can be read by stretches.
    pub fn knows(path: impl AsRef<Path>) -> bool {
        Format::of(&Packing::of(path.as_ref()).1).is_ok_and(|f| f == Format::Ply)
    }

    /// Opens a mesh file. A compressed one is unpacked into a file without a name in the folder `scratch`.
    pub fn open(path: impl AsRef<Path>, scratch: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref();
        let (packing, inner) = Packing::of(path);
        if Format::of(&inner)? != Format::Ply {
            return Err(IoError::unsupported(
                path,
                "only PLY files are read piece by piece",
                "save it as .ply, or allow the memory to hold it whole",
            ));
        }
        let mut file = File::open(path).map_err(|e| IoError::io(path, e))?;
        if packing != Packing::None {
            file = unpack(path, packing, file, scratch.as_ref())?;
        }
        let mut start = Vec::new();
        let length = file.metadata().and_then(|m| {
            file.rewind()?;
            (&mut file).take(HEADER_LIMIT).read_to_end(&mut start)?;
            Ok(m.len())
        });
        let length = length.map_err(|e| IoError::io(path, e))?;
        let (header, rest) = ply_header::read(path, &start)?;
        let body = (start.len() - rest.len()) as u64;
        let bad = |place: &str, expected: &str, found: &str| IoError::malformed(path, place, expected, found);
        let of_name = |name: &str| {
            let at = header.elements.iter().position(|e| e.name == name);
            at.ok_or_else(|| bad("header", &format!("an element '{name}'"), "none"))
        };
        let (vertex, face) = (of_name("vertex")?, of_name("face")?);
        if let Some(strips) = header.elements.iter().find(|e| e.name == "tristrips") {
            let what = format!("{} triangle strips beside the faces", strips.count);
            return Err(IoError::unsupported(path, what, "save it as a list of faces"));
        }
        let vertices = header.elements[vertex].count;
        if vertices >= u32::MAX.into() {
            return Err(IoError::too_large(path, "vertices", vertices, u64::from(u32::MAX) - 1));
        }
        let layout = vertices::Layout::of(path, &header.elements[vertex])?;
        let mut starts = vec![None; header.elements.len()];
        starts[0] = Some(body);
        let stream = Self {
            path: path.to_owned(),
            file,
            length,
            encoding: header.encoding,
            elements: header.elements,
            starts,
            vertex,
            face,
            layout,
        };
        stream.check_room(body)?;
        Ok(stream)
    }

    /// Vertices that the header announces; the file is long enough for them.
    pub fn vertices(&self) -> u64 {
        self.elements[self.vertex].count
    }

    /// Faces that the header announces. Polygons give more triangles.
    pub fn faces(&self) -> u64 {
        self.elements[self.face].count
    }

    /// Bytes of the file, unpacked.
    pub fn bytes(&self) -> u64 {
        self.length
    }

    /// What the file says of the mesh that does not come by stretches.
    pub fn left_out(&self) -> Vec<&'static str> {
        let has = |element: usize, names: &[&str]| self.elements[element].property(names).is_some();
        let mut left_out = Vec::new();
        if has(self.vertex, &["nx"]) {
            left_out.push("normals");
        }
        if has(self.vertex, &["s", "u", "texture_u", "texture_s"]) || has(self.face, &["texcoord"]) {
            left_out.push("texture coordinates");
        }
        left_out
    }

    /// Whether vertices have colours.
    pub fn has_colours(&self) -> bool {
        self.layout.has_colours()
    }

    /// Whether single precision holds all places.
    pub fn is_single_precision(&self) -> bool {
        self.layout.is_single_precision()
    }

    /// Gives all vertices to `sink`, in order.
    pub fn each_vertex_run(&mut self, sink: &mut VertexSink<'_>) -> Result<(), IoError> {
        let start = self.start_of(self.vertex)?;
        let mut window = Window::new(&mut self.file, start, self.encoding).map_err(|e| IoError::io(&self.path, e))?;
        vertices::each_run(&self.path, &mut window, &self.elements[self.vertex], &self.layout, sink)?;
        let end = window.offset();
        if let Some(next) = self.starts.get_mut(self.vertex + 1) {
            *next = Some(end);
        }
        Ok(())
    }

    /// Gives all triangles to `sink`, in order.
    pub fn each_triangle_run(&mut self, sink: &mut TriangleSink<'_>) -> Result<(), IoError> {
        let vertices = self.vertices() as u32;
        let start = self.start_of(self.face)?;
        let mut window = Window::new(&mut self.file, start, self.encoding).map_err(|e| IoError::io(&self.path, e))?;
        faces::each_run(&self.path, &mut window, &self.elements[self.face], vertices, sink)
    }

    /// Refuses counts that the file cannot hold.
    fn check_room(&self, body: u64) -> Result<(), IoError> {
        let mut left = self.length.saturating_sub(body);
        for element in &self.elements {
            // text may lack the last separator
            let spare = u64::from(self.encoding == Encoding::Ascii);
            let needed = element.count.saturating_mul(element.least_bytes(self.encoding) as u64).saturating_sub(spare);
            if needed > left {
                let expected = format!("at least {needed} bytes for {} records", element.count);
                let place = format!("element '{}'", element.name);
                return Err(IoError::malformed(&self.path, place, expected, left.to_string()));
            }
            left -= needed;
        }
        Ok(())
    }

    /// Where an element starts; walks over what lies before it where its length is not known.
    fn start_of(&mut self, element: usize) -> Result<u64, IoError> {
        for k in 0..element {
            let Some(start) = self.starts[k] else { continue };
            if self.starts[k + 1].is_none() {
                self.starts[k + 1] = Some(self.end_of(k, start)?);
            }
        }
        // the first is known and every other was set from the one before
        Ok(self.starts[element].unwrap_or_default())
    }

    fn end_of(&mut self, element: usize, start: u64) -> Result<u64, IoError> {
        let Self { path, file, encoding, elements, .. } = self;
        let element = &elements[element];
        if element.is_fixed() && *encoding != Encoding::Ascii {
            // the room was checked
            return Ok(start + element.count * element.least_bytes(*encoding) as u64);
        }
        let mut window = Window::new(file, start, *encoding).map_err(|e| IoError::io(&*path, e))?;
        let mut items = Vec::new();
        if !element.properties.is_empty() {
            for number in 0..element.count {
                for property in 0..element.properties.len() {
                    faces::value(path, &mut window, element, number, property, &mut items)?;
                }
            }
        }
        Ok(window.offset())
    }
}

/// Unpacks into a file without a name.
fn unpack(path: &Path, packing: Packing, packed: File, scratch: &Path) -> Result<File, IoError> {
    let packed_bytes = packed.metadata().map_err(|e| IoError::io(path, e))?.len();
    let limit = packed_bytes.saturating_mul(UNPACKED_FOLD).max(UNPACKED_FREE);
    let packed = BufReader::with_capacity(1 << 18, packed);
    let mut unpacked: Box<dyn Read> = match packing {
        Packing::None => Box::new(packed),
        Packing::Gzip => Box::new(flate2::read::MultiGzDecoder::new(packed)),
        Packing::Zstd => Box::new(zstd::stream::read::Decoder::with_buffer(packed).map_err(|e| IoError::io(path, e))?),
    };
    let mut file = scratch::unnamed(scratch)?;
    let mut buffer = vec![0; 1 << 18];
    let mut total = 0;
    loop {
        let read = match unpacked.read(&mut buffer) {
            Ok(0) => return Ok(file),
            Ok(n) => n,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(IoError::malformed(path, "compressed data", "a whole stream", e.to_string())),
        };
        total += read as u64;
        if total > limit {
            return Err(IoError::too_large(path, "bytes unpacked", total, limit));
        }
        file.write_all(&buffer[..read]).map_err(|e| IoError::io(scratch, e))?;
    }
}
