//! What a tile's content is, and the glTF inside the older formats around it.
//!
//! Based on: Open Geospatial Consortium, "3D Tiles Specification 1.0", 2019.

use super::{Bytes, Faults};

/// What a content is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wrapped<'b> {
    /// Binary glTF; `centre_m` is what positions are relative to.
    Glb {
        /// The glTF.
        glb: &'b [u8],
        /// `RTC_CENTER` of a batched model.
        centre_m: [f64; 3],
    },
    /// A tileset.
    Tileset,
    /// Something that is known but not looked into: `i3dm`, `pnts`, `cmpt`, glTF of text.
    Other(&'static str),
    /// Nothing known.
    Unknown,
}

/// Looks at the start of a content.
pub fn unwrapped<'b>(bytes: &'b [u8], faults: &mut Faults) -> Wrapped<'b> {
    match bytes.get(..4) {
        Some(b"glTF") => Wrapped::Glb { glb: bytes, centre_m: [0.0; 3] },
        Some(b"b3dm") => match batched(bytes) {
            Some((glb, centre_m)) => Wrapped::Glb { glb, centre_m },
            None => {
                faults.add("GL01", "b3dm header", "28 bytes, tables and a glTF of the length stated", "less");
                Wrapped::Other("b3dm")
            }
        },
        Some(b"i3dm") => Wrapped::Other("i3dm"),
        Some(b"pnts") => Wrapped::Other("pnts"),
        Some(b"cmpt") => Wrapped::Other("cmpt"),
        _ => match serde_json::from_slice::<serde_json::Value>(bytes) {
            Ok(v) if v["root"].is_object() => Wrapped::Tileset,
            Ok(v) if v["asset"].is_object() => Wrapped::Other("gltf"),
            _ => Wrapped::Unknown,
        },
    }
}

fn batched(bytes: &[u8]) -> Option<(&[u8], [f64; 3])> {
    let mut reader = Bytes::new(bytes);
    reader.take(4)?;
    let [_version, length, feature_json, feature_bin, batch_json, batch_bin] = [(); 6].map(|()| reader.u32());
    let feature = reader.take(feature_json? as usize)?;
    for skipped in [feature_bin?, batch_json?, batch_bin?] {
        reader.take(skipped as usize)?;
    }
    let glb = bytes.get(reader.at..length? as usize)?;
    let table: serde_json::Value = serde_json::from_slice(feature).unwrap_or_default();
    let centre = &table["RTC_CENTER"];
    Some((glb, [0, 1, 2].map(|k| centre[k].as_f64().unwrap_or(0.0))))
}
