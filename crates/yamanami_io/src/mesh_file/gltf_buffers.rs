//! The numbers of a glTF document: buffers in the file, beside it and in its text, views of them (packed ones too), and
//! accessors (sparse ones too).

use super::gltf_json::{Accessor, Document, Packed};
use super::meshopt_decode::{MeshoptFilter, MeshoptMode, decode_meshopt};
use super::origin::Origin;
use crate::IoError;
use std::borrow::Cow;
use std::sync::Arc;

/// Instances and shared buffers let a small file name a huge mesh: most vertices and corners per byte of file.
const ITEMS_PER_BYTE: usize = 64;
/// Most bytes that packed views may give per byte of file, and how many at least.
const UNPACKED_FOLD: usize = 1000;
const UNPACKED_FREE: usize = 64 << 20;

/// Where accessors read from.
pub(super) struct Buffers<'a> {
    document: &'a Document,
    /// The bytes of each buffer; why not, otherwise.
    buffers: Vec<Result<Cow<'a, [u8]>, String>>,
    /// Packed views that were decoded already.
    unpacked: Vec<Option<Arc<[u8]>>>,
    unpacked_left: usize,
    items_left: usize,
}

impl<'a> Buffers<'a> {
    /// `binary` is the chunk of a GLB, where there is one.
    pub(super) fn new(origin: &Origin<'_>, document: &'a Document, binary: Option<&'a [u8]>) -> Self {
        // a buffer that only packed views name is no more than a place to unpack to
        let mut named = vec![false; document.buffers.len()];
        for view in &document.buffer_views {
            let buffer = view.extensions.packed().map_or(view.buffer, |packed| packed.buffer);
            if let Some(named) = named.get_mut(buffer) {
                *named = true;
            }
        }
        let load = |(number, buffer): (usize, &super::gltf_json::Buffer)| match &buffer.uri {
            _ if !named[number] => Err("no view needs it".into()),
            Some(uri) => fetch(origin, uri).map(Cow::Owned),
            None if number == 0 => binary.map(Cow::Borrowed).ok_or_else(|| "the file has no binary chunk".into()),
            None => Err("it has no uri".into()),
        };
        let buffers: Vec<_> = document.buffers.iter().enumerate().map(load).collect();
        let loaded: usize = buffers.iter().flatten().map(|b| b.len()).sum();
        Self {
            document,
            buffers,
            unpacked: vec![None; document.buffer_views.len()],
            unpacked_left: loaded.saturating_mul(UNPACKED_FOLD).max(UNPACKED_FREE),
            items_left: loaded.saturating_mul(ITEMS_PER_BYTE),
        }
    }

    pub(super) fn spend(&mut self, origin: &Origin<'_>, items: usize) -> Result<(), IoError> {
        match self.items_left.checked_sub(items) {
            Some(left) => self.items_left = left,
            None => {
                let (given, limit) = (items as u64, self.items_left as u64);
                return Err(IoError::too_large(origin.name, "vertices and corners of repeated parts", given, limit));
            }
        }
        Ok(())
    }

    /// The bytes of a part of a buffer.
    fn part(
        &self,
        origin: &Origin<'_>,
        place: &str,
        buffer: usize,
        offset: usize,
        length: usize,
    ) -> Result<&[u8], IoError> {
        match self.buffers.get(buffer) {
            None => Err(origin.bad(place, format!("a buffer below {}", self.buffers.len()), buffer.to_string())),
            Some(Err(why)) => Err(IoError::unsupported(
                origin.name,
                format!("{place}: buffer {buffer} cannot be read: {why}"),
                "keep its files together, or pack all buffers into a GLB",
            )),
            Some(Ok(bytes)) => {
                let end = offset.checked_add(length);
                end.and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
                    let expected = format!("{length} bytes from byte {offset} of buffer {buffer}");
                    origin.bad(place, expected, format!("{} bytes of buffer", bytes.len()))
                })
            }
        }
    }

    /// The bytes of a view.
    pub(super) fn view(&mut self, origin: &Origin<'_>, number: usize) -> Result<Cow<'_, [u8]>, IoError> {
        let document = self.document;
        let place = format!("buffer view {number}");
        let Some(view) = document.buffer_views.get(number) else {
            let expected = format!("a buffer view below {}", document.buffer_views.len());
            return Err(origin.bad("buffer views", expected, number.to_string()));
        };
        let Some(packed) = view.extensions.packed() else {
            return self.part(origin, &place, view.buffer, view.byte_offset, view.byte_length).map(Cow::Borrowed);
        };
        if self.unpacked[number].is_none() {
            let decoded: Arc<[u8]> = self.unpack(origin, &place, packed)?.into();
            self.unpacked_left = self.unpacked_left.saturating_sub(decoded.len());
            self.items_left = self.items_left.saturating_add(decoded.len().saturating_mul(ITEMS_PER_BYTE));
            self.unpacked[number] = Some(decoded);
        }
        Ok(Cow::Borrowed(self.unpacked[number].as_deref().unwrap_or_default()))
    }

    fn unpack(&self, origin: &Origin<'_>, place: &str, packed: &Packed) -> Result<Vec<u8>, IoError> {
        let mode = match packed.mode.as_str() {
            "ATTRIBUTES" => MeshoptMode::Attributes,
            "TRIANGLES" => MeshoptMode::Triangles,
            "INDICES" => MeshoptMode::Indices,
            mode => return Err(origin.bad(place, "a mode of meshopt compression", mode)),
        };
        let filter = match packed.filter.as_deref() {
            None | Some("NONE") => MeshoptFilter::None,
            Some("OCTAHEDRAL") => MeshoptFilter::Octahedral,
            Some("QUATERNION") => MeshoptFilter::Quaternion,
            Some("EXPONENTIAL") => MeshoptFilter::Exponential,
            Some("COLOR") => MeshoptFilter::Colour,
            Some(filter) => return Err(origin.bad(place, "a filter of meshopt compression", filter)),
        };
        let bytes = packed.count.saturating_mul(packed.byte_stride);
        if bytes > self.unpacked_left {
            let (given, limit) = (bytes as u64, self.unpacked_left as u64);
            return Err(IoError::too_large(origin.name, format!("{place}: bytes unpacked"), given, limit));
        }
        let data = self.part(origin, place, packed.buffer, packed.byte_offset, packed.byte_length)?;
        decode_meshopt(mode, filter, packed.count, packed.byte_stride, data)
            .map_err(|found| origin.bad(place, format!("{} elements packed by meshopt", packed.count), found))
    }

    fn accessor(&self, origin: &Origin<'_>, place: &str, number: usize) -> Result<&'a Accessor, IoError> {
        let accessors = &self.document.accessors;
        accessors
            .get(number)
            .ok_or_else(|| origin.bad(place, format!("an accessor below {}", accessors.len()), number.to_string()))
    }

    /// How many numbers an item of an accessor has.
    pub(super) fn width(&self, number: usize) -> usize {
        match self.document.accessors.get(number).map_or("", |a| a.shape.as_str()) {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 0,
        }
    }

    /// All numbers of an accessor of scalars (`width` 1) or vectors.
    pub(super) fn values(
        &mut self,
        origin: &Origin<'_>,
        place: &str,
        number: usize,
        width: usize,
    ) -> Result<Vec<f64>, IoError> {
        let place = format!("{place}, accessor {number}");
        let accessor = self.accessor(origin, &place, number)?;
        if width == 0 || self.width(number) != width {
            let given: String = accessor.shape.chars().take(20).collect();
            let expected = ["SCALAR", "VEC2", "VEC3", "VEC4"][width.clamp(1, 4) - 1];
            return Err(origin.bad(place, expected, given));
        }
        if let Some(view) = accessor.buffer_view {
            // a buffer that is missing is worth telling before a count that is too large without it
            self.view(origin, view)?;
        }
        self.spend(origin, accessor.count)?;
        let component = component(origin, &place, accessor.component_type)?;
        let scale = component.largest();
        let mut values = Vec::new();
        if let Some(view) = accessor.buffer_view {
            let stride = self.document.buffer_views.get(view).and_then(|v| v.byte_stride.or(v.packed_stride()));
            let view = self.view(origin, view)?;
            let shape = Shape { component, width, stride, offset: accessor.byte_offset, count: accessor.count };
            values.reserve(accessor.count * width);
            for item in shape.items(origin, &place, &view)? {
                values.extend(item.chunks_exact(component.size()).map(|raw| component.value(raw)));
            }
        } else {
            // zeros, of which a sparse part may replace some
            values.resize(accessor.count * width, 0.0);
        }
        if let Some(sparse) = &accessor.sparse {
            let place = format!("{place}, sparse part");
            self.spend(origin, sparse.count)?;
            let kind = self::component(origin, &place, sparse.indices.component_type.unwrap_or(0))?;
            let shape = Shape {
                component: kind,
                width: 1,
                stride: None,
                offset: sparse.indices.byte_offset,
                count: sparse.count,
            };
            let view = self.view(origin, sparse.indices.buffer_view)?;
            let places: Vec<f64> = shape.items(origin, &place, &view)?.map(|raw| kind.value(raw)).collect();
            let shape =
                Shape { component, width, stride: None, offset: sparse.values.byte_offset, count: sparse.count };
            let view = self.view(origin, sparse.values.buffer_view)?;
            for (at, item) in places.into_iter().zip(shape.items(origin, &place, &view)?) {
                if !(at >= 0.0 && at < accessor.count as f64) {
                    return Err(origin.bad(place, format!("items below {}", accessor.count), at.to_string()));
                }
                let target = &mut values[at as usize * width..][..width];
                for (value, raw) in target.iter_mut().zip(item.chunks_exact(component.size())) {
                    *value = component.value(raw);
                }
            }
        }
        if accessor.normalized {
            // the least of a signed type stands for -1, as its neighbour does
            values.iter_mut().for_each(|v| *v = (*v / scale).max(-1.0));
        }
        Ok(values)
    }

    /// The indices of an accessor, each below `limit`.
    pub(super) fn indices(
        &mut self,
        origin: &Origin<'_>,
        place: &str,
        number: usize,
        limit: usize,
    ) -> Result<Vec<u32>, IoError> {
        let values = self.values(origin, place, number, 1)?;
        if let Some(k) = values.iter().position(|&v| !(v >= 0.0 && v < limit as f64 && v.fract() == 0.0)) {
            let expected = format!("indices below {limit}");
            return Err(origin.bad(format!("{place}, index {k}"), expected, values[k].to_string()));
        }
        Ok(values.into_iter().map(|v| v as u32).collect())
    }
}

/// The bytes that a uri holds or names.
pub(super) fn fetch(origin: &Origin<'_>, uri: &str) -> Result<Vec<u8>, String> {
    let Some(data) = uri.strip_prefix("data:") else {
        return origin.read_beside(&percent_decoded(uri));
    };
    let (kind, text) = data.split_once(',').ok_or("a data uri without data")?;
    if kind.ends_with(";base64") {
        base64(text).ok_or_else(|| "a data uri that is not base64".into())
    } else {
        Ok(percent_decoded(text).into_bytes())
    }
}

fn percent_decoded(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let pair = after.get(..2).filter(|_| *first == b'%').and_then(|p| std::str::from_utf8(p).ok());
        match pair.and_then(|p| u8::from_str_radix(p, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Decodes base64 of either alphabet, with or without padding.
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut held, mut bits) = (0u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let six = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ if c.is_ascii_whitespace() => continue,
            _ => return None,
        };
        held = held << 6 | u32::from(six);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((held >> bits) as u8);
        }
    }
    Some(bytes)
}

/// How items lie in a view.
struct Shape {
    component: Component,
    width: usize,
    stride: Option<usize>,
    offset: usize,
    count: usize,
}

impl Shape {
    fn items<'v>(
        &self,
        origin: &Origin<'_>,
        place: &str,
        view: &'v [u8],
    ) -> Result<impl Iterator<Item = &'v [u8]> + use<'v>, IoError> {
        let size = self.component.size() * self.width;
        let stride = self.stride.unwrap_or(size);
        let part = || {
            let part = view.get(self.offset..)?;
            let needed = match self.count {
                0 => 0,
                n => (n - 1).checked_mul(stride)?.checked_add(size)?,
            };
            (stride >= size).then(|| part.get(..needed))?
        };
        match part() {
            Some(part) => Ok(part.chunks(stride.max(1)).map(move |item| &item[..size])),
            None => {
                let expected = format!("{} items every {stride} bytes from byte {}", self.count, self.offset);
                Err(origin.bad(place, expected, format!("{} bytes of buffer view", view.len())))
            }
        }
    }
}

fn component(origin: &Origin<'_>, place: &str, number: u32) -> Result<Component, IoError> {
    Component::numbered(number).ok_or_else(|| origin.bad(place, "a component type of 5120 to 5126", number.to_string()))
}

/// Type of an accessor's numbers.
#[derive(Clone, Copy)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn numbered(number: u32) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// What a normalised value of 1 is stored as.
    fn largest(self) -> f64 {
        match self {
            Self::I8 => i8::MAX.into(),
            Self::U8 => u8::MAX.into(),
            Self::I16 => i16::MAX.into(),
            Self::U16 => u16::MAX.into(),
            Self::U32 => u32::MAX.into(),
            Self::F32 => 1.0,
        }
    }

    fn value(self, raw: &[u8]) -> f64 {
        let mut bytes = [0u8; 4];
        bytes[..raw.len()].copy_from_slice(raw);
        let bits = u32::from_le_bytes(bytes);
        match self {
            Self::I8 => f64::from(bits as i8),
            Self::U8 => f64::from(bits as u8),
            Self::I16 => f64::from(bits as i16),
            Self::U16 => f64::from(bits as u16),
            Self::U32 => f64::from(bits),
            Self::F32 => f64::from(f32::from_bits(bits)),
        }
    }
}
