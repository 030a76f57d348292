//! quantized-mesh 1.0: one tile of a terrain on the globe, its longitudes, latitudes and heights brought into metres.
//!
//! Based on: Cesium, "Quantized-mesh-1.0 terrain format", 2013 to 2024.

mod bytes;
mod tile;

use super::upward::upward;
use super::{Notes, ReadTin, TinReadOptions, check};
use crate::mesh_file::packing::Packing;
use crate::{IoError, crs};
use bytes::{Decoded, GRID};
use glam::DVec3;
use std::io::{BufRead, Read};
use std::path::Path;
use tile::Rectangle;
use yamanami_core::{Crs, Tin};

/// Most bytes of a tile. Those in use have some kilobytes.
const TILE_LIMIT: u64 = 1 << 30;

/// Reads a tile. Many servers' files are packed without their name saying so.
pub(super) fn read(name: &Path, mut content: impl BufRead, _options: &TinReadOptions) -> Result<ReadTin, IoError> {
    let mut bytes = whole(name, &mut content)?;
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let packed = std::mem::take(&mut bytes);
        let unpacked = Packing::Gzip.reader(packed.as_slice(), packed.len() as u64);
        bytes = whole(name, &mut unpacked.map_err(|e| IoError::io(name, e))?)?;
    }
    let mut notes = Notes::default();
    let decoded = bytes::decode(name, &bytes, &mut notes)?;
    let inner = Packing::of(name).1;
    let rectangle = Rectangle::of(&inner, &decoded.header, &mut notes)?;
    let stem = inner.file_stem().unwrap_or_default().to_string_lossy();
    let mut tin = Tin { name: stem.into_owned(), ..Tin::default() };
    (tin.crs, tin.mesh.positions) = metric(name, &decoded, rectangle, &mut notes)?;
    let place = |number: u32| tin.mesh.positions[number as usize];
    let upright = (1..).zip(&decoded.triangles).filter_map(|(number, &corners): (u64, _)| {
        upward(corners, place, &mut notes, format_args!("triangle {number}"))
    });
    tin.mesh.triangles = upright.collect();
    Ok(check::readable(tin, notes))
}

fn whole(name: &Path, content: &mut dyn BufRead) -> Result<Vec<u8>, IoError> {
    let mut bytes = Vec::new();
    let read = content.take(TILE_LIMIT + 1).read_to_end(&mut bytes);
    read.map_err(|e| super::lines::unreadable(name, "the packing", e))?;
    if bytes.len() as u64 > TILE_LIMIT {
        return Err(IoError::too_large(name, "bytes of a tile", bytes.len() as u64, TILE_LIMIT));
    }
    Ok(bytes)
}

/// The CRS in metres of the tile's place, and its vertices there.
fn metric(
    name: &Path,
    decoded: &Decoded,
    rectangle: Rectangle,
    notes: &mut Notes,
) -> Result<(Crs, Vec<DVec3>), IoError> {
    let wgs84 = crs::from_epsg(4326).unwrap_or_default();
    let [lon, lat] = rectangle.at([0.5, 0.5]);
    let utm = crs::metric_crs_at(&wgs84, lon, lat);
    let [low, high] = decoded.header.heights_m;
    let vertex = |&[u, v, height]: &[u16; 3], project: &dyn Fn(f64, f64) -> Option<[f64; 2]>| {
        let [u, v, height] = [u, v, height].map(|value| f64::from(value) / GRID);
        let [lon, lat] = rectangle.at([u, v]);
        let [x, y] = project(lon, lat)?;
        Some(DVec3::new(x, y, low + height * (high - low)))
    };
    let all = |project: &dyn Fn(f64, f64) -> Option<[f64; 2]>| -> Option<Vec<DVec3>> {
        decoded.vertices.iter().map(|values| vertex(values, project)).collect()
    };
    if let Some(places) = all(&|lon, lat| crs::from_lon_lat(&utm, lon, lat)) {
        return Ok((utm, places));
    }
    // half the globe is too much for a zone
    let cylindrical = Crs { epsg: Some(4087), name: "WGS 84 / World Equidistant Cylindrical".into(), ..Crs::default() };
    notes.say(format!("too wide for {}: in {}", utm.name, cylindrical.name));
    let places = all(&equidistant_cylindrical).ok_or_else(|| {
        IoError::malformed(name, "tile", "a place on the globe", format!("longitude {lon}, latitude {lat}"))
    })?;
    Ok((cylindrical, places))
}

/// Along the equator and along the meridian, metres.
fn equidistant_cylindrical(lon: f64, lat: f64) -> Option<[f64; 2]> {
    // on its central meridian UTM is the meridian's length, scaled
    let [_, northing] = crs::from_lon_lat(&crs::from_epsg(32631)?, 3.0, lat)?;
    Some([tile::SEMI_MAJOR_M * lon.to_radians(), northing / 0.9996])
}
