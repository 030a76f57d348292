//! The numbers of a glTF's accessors, for judging: every length and offset is held against what is there.
//!
//! Based on: Khronos Group, "glTF 2.0 Specification", 2021; `EXT_meshopt_compression` and `KHR_meshopt_compression`.

use super::Faults;
use crate::mesh_file::{MeshoptFilter, MeshoptMode, decode_meshopt};
use serde_json::Value;
use std::borrow::Cow;

/// Extensions under which a buffer view is packed by meshopt.
pub const MESHOPT_EXTENSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Unpacked bytes in a view for each of the file: as far as real files go, and far from what fills memory.
const UNPACKED_FOLD: usize = 1 << 10;

/// The numbers of an accessor.
#[derive(Debug, Clone, Default)]
pub(super) struct Numbers {
    /// All numbers, as they mean, that is between -1 and 1 where normalised.
    pub(super) values: Vec<f64>,
    /// As stored.
    pub(super) raw: Vec<f64>,
    /// Numbers an item.
    pub(super) width: usize,
}

/// Reads the accessors of one document.
pub(super) struct Accessors<'d> {
    pub(super) document: &'d Value,
    pub(super) binary: &'d [u8],
}

/// A non-negative whole number.
pub(super) fn whole(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|v| usize::try_from(v).ok())
}

fn offset(value: &Value) -> usize {
    whole(value).unwrap_or(0)
}

/// Size in bytes of a component and what a normalised 1 is stored as.
fn component(kind: Option<u64>) -> Option<(usize, f64)> {
    Some(match kind? {
        5120 => (1, 127.0),
        5121 => (1, 255.0),
        5122 => (2, 32767.0),
        5123 => (2, 65535.0),
        5125 => (4, f64::from(u32::MAX)),
        5126 => (4, 1.0),
        _ => return None,
    })
}

fn value(kind: u64, raw: &[u8]) -> f64 {
    let mut bytes = [0; 4];
    bytes[..raw.len()].copy_from_slice(raw);
    let bits = u32::from_le_bytes(bytes);
    match kind {
        5120 => f64::from(bits as i8),
        5122 => f64::from(bits as i16),
        5126 => f64::from(f32::from_bits(bits)),
        _ => f64::from(bits),
    }
}

fn numbers_of(shape: &Value) -> Option<usize> {
    ["SCALAR", "VEC2", "VEC3", "VEC4"].iter().position(|name| shape == name).map(|at| at + 1)
}

impl Accessors<'_> {
    /// All numbers of an accessor, or `None` with the fault noted.
    pub(super) fn read(&self, number: usize, faults: &mut Faults) -> Option<Numbers> {
        let place = format!("accessor {number}");
        let Some(accessor) = self.document["accessors"].get(number) else {
            faults.add("GL03", place, "an accessor that is there", "none");
            return None;
        };
        let kind = accessor["componentType"].as_u64();
        let (count, width) = (whole(&accessor["count"]), numbers_of(&accessor["type"]));
        let (Some((size, largest)), Some(count), Some(width)) = (component(kind), count, width) else {
            let found = format!("{} {} {}", accessor["componentType"], accessor["count"], accessor["type"]);
            faults.add("GL03", place, "a component type, a count and a type", found);
            return None;
        };
        let view = whole(&accessor["bufferView"]);
        let Some((bytes, stride)) = view.and_then(|view| self.view(view, faults)) else {
            if view.is_none() {
                faults.add("GL12", place, "a buffer view", "none, or sparse values, which are not looked at");
            }
            return None;
        };
        let (each, start) = (size * width, offset(&accessor["byteOffset"]));
        let stride = stride.unwrap_or(each);
        let end = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(each));
        let part = end.and_then(|length| bytes.get(start..start.checked_add(length)?));
        let Some(part) = part.filter(|_| stride >= each) else {
            let expected = format!("{count} items of {each} bytes every {stride} from byte {start}");
            faults.add("GL03", place, expected, format!("{} bytes of buffer view", bytes.len()));
            return None;
        };
        let mut numbers = Numbers { width, ..Numbers::default() };
        numbers.raw.reserve(count * width);
        for item in part.chunks(stride.max(1)).take(count) {
            let values = item[..each].chunks_exact(size).map(|raw| value(kind.unwrap_or(0), raw));
            numbers.raw.extend(values);
        }
        numbers.values = numbers.raw.clone();
        if accessor["normalized"] == true {
            numbers.values.iter_mut().for_each(|v| *v = (*v / largest).max(-1.0));
        }
        self.check_range(&place, accessor, &numbers, faults);
        Some(numbers)
    }

    /// `min` and `max` are those of the numbers as stored.
    fn check_range(&self, place: &str, accessor: &Value, numbers: &Numbers, faults: &mut Faults) {
        for (name, pick) in [("min", f64::min as fn(f64, f64) -> f64), ("max", f64::max)] {
            let Some(stated) = accessor[name].as_array() else { continue };
            for k in 0..numbers.width {
                let own = numbers.raw.iter().skip(k).step_by(numbers.width).copied().reduce(pick).unwrap_or(0.0);
                let stated = stated.get(k).and_then(Value::as_f64).unwrap_or(f64::NAN);
                // JSON may hold a single-precision number in fewer digits
                if (stated - own).abs() > 1e-6 * own.abs().max(1e-3) || stated.is_nan() {
                    faults.add("GL05", format!("{place}, {name}[{k}]"), own.to_string(), stated.to_string());
                }
            }
        }
    }

    /// The bytes of a view and the distance of its items where it says one.
    fn view(&self, number: usize, faults: &mut Faults) -> Option<(Cow<'_, [u8]>, Option<usize>)> {
        let place = format!("buffer view {number}");
        let Some(view) = self.document["bufferViews"].get(number) else {
            faults.add("GL03", place, "a buffer view that is there", "none");
            return None;
        };
        let packed = MESHOPT_EXTENSIONS.iter().map(|name| &view["extensions"][name]).find(|p| p.is_object());
        if let Some(packed) = packed {
            return self.unpack(&place, packed, faults).map(|bytes| (Cow::Owned(bytes), whole(&packed["byteStride"])));
        }
        let bytes = self.part(&place, view, faults)?;
        Some((Cow::Borrowed(bytes), whole(&view["byteStride"])))
    }

    fn part(&self, place: &str, view: &Value, faults: &mut Faults) -> Option<&[u8]> {
        let (start, length) = (offset(&view["byteOffset"]), whole(&view["byteLength"]));
        let buffer = whole(&view["buffer"]);
        let inside = buffer.is_some_and(|b| self.document["buffers"][b].is_object());
        let own = buffer == Some(0) && self.document["buffers"][0]["uri"].is_null();
        if inside && !own {
            faults.add("GL12", place, "a buffer in the file", "one outside it, which is not looked at");
            return None;
        }
        let part = length.and_then(|n| self.binary.get(start..start.checked_add(n)?)).filter(|_| inside);
        if part.is_none() {
            let found = format!("{} from byte {start} of buffer {}", view["byteLength"], view["buffer"]);
            faults.add("GL03", place, format!("a part of the {} bytes of buffer 0", self.binary.len()), found);
        }
        part
    }

    fn unpack(&self, place: &str, packed: &Value, faults: &mut Faults) -> Option<Vec<u8>> {
        let data = self.part(place, packed, faults)?;
        let mode = match packed["mode"].as_str() {
            Some("ATTRIBUTES") => Some(MeshoptMode::Attributes),
            Some("TRIANGLES") => Some(MeshoptMode::Triangles),
            Some("INDICES") => Some(MeshoptMode::Indices),
            _ => None,
        };
        let filter = match packed["filter"].as_str() {
            None | Some("NONE") => Some(MeshoptFilter::None),
            Some("OCTAHEDRAL") => Some(MeshoptFilter::Octahedral),
            Some("QUATERNION") => Some(MeshoptFilter::Quaternion),
            Some("EXPONENTIAL") => Some(MeshoptFilter::Exponential),
            Some("COLOR") => Some(MeshoptFilter::Colour),
            Some(_) => None,
        };
        let (count, stride) = (whole(&packed["count"]), whole(&packed["byteStride"]));
        let (Some(mode), Some(filter), Some(count), Some(stride)) = (mode, filter, count, stride) else {
            faults.add("GL11", place, "mode, filter, count and byteStride of meshopt", packed.to_string());
            return None;
        };
        if count.checked_mul(stride).is_none_or(|n| n > data.len().saturating_mul(UNPACKED_FOLD)) {
            faults.add("GL11", place, "a count that its bytes can hold", format!("{count} items of {stride} bytes"));
            return None;
        }
        decode_meshopt(mode, filter, count, stride, data)
            .map_err(|found| faults.add("GL11", place, format!("{count} items packed by meshopt"), found))
            .ok()
    }
}
