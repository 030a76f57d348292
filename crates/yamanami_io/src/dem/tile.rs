//! Web map tiles of heights: Mapbox Terrain-RGB, Terrarium and GSI `dem_png` pictures, and GSI's text tiles.
//!
//! Formats: Mapbox, "Terrain-RGB v1"; Mapzen/Tilezen joerd, "Terrarium"; GSI, "Elevation tile specification".

use super::bytes::ByteSource;
use super::part::{Part, PartInfo, clean};
use super::tile_name::tile_from_path;
use super::{OpenOptions, SampleType};
use crate::{IoError, crs};
use std::f64::consts::PI;
use yamanami_core::{Crs, GeoReference};

/// How a tile's colours mean heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TileEncoding {
    /// -10000 m + 0.1 m × (65536 R + 256 G + B); black is no-data.
    TerrainRgb,
    /// 256 R + G + B / 256 - 32768 m; black is no-data.
    Terrarium,
    /// 0.01 m × (65536 R + 256 G + B), negative above 2^23, no-data at 2^23.
    Gsi,
}

/// Sides of tiles in use are 256 to 1024 pixels.
const MAX_TILE_SIDE: u32 = 8192;
/// Text tiles are always 256 x 256.
const TEXT_TILE_SIDE: usize = 256;
/// No text tile is longer.
const MAX_TEXT_TILE_BYTES: u64 = 4 << 20;
const HALF_WORLD_M: f64 = PI * 6_378_137.0;

impl TileEncoding {
    /// Readable name.
    pub fn name(self) -> &'static str {
        match self {
            Self::TerrainRgb => "Terrain-RGB",
            Self::Terrarium => "Terrarium",
            Self::Gsi => "GSI dem_png",
        }
    }

    /// Step between heights that can be told apart, metres.
    pub fn quantum_m(self) -> f64 {
        match self {
            Self::TerrainRgb => 0.1,
            Self::Terrarium => 1.0 / 256.0,
            Self::Gsi => 0.01,
        }
    }

    /// The colour of a height in metres, the nearest there is; what means no data for NaN.
    pub fn colour(self, height_m: f32) -> [u8; 3] {
        let z = f64::from(height_m);
        let code = match self {
            // code 0 is no data
            _ if z.is_nan() => return if self == Self::Gsi { [128, 0, 0] } else { [0; 3] },
            Self::TerrainRgb => ((z + 10_000.0) * 10.0).round().clamp(1.0, f64::from(0xFF_FFFF)) as u32,
            Self::Terrarium => ((z + 32_768.0) * 256.0).round().clamp(1.0, f64::from(0xFF_FFFF)) as u32,
            Self::Gsi => (z * 100.0).round().clamp(f64::from(1 - (1 << 23)), f64::from((1 << 23) - 1)) as i32 as u32,
        };
        let [_, r, g, b] = code.to_be_bytes();
        [r, g, b]
    }

    /// The height in metres that a colour means; NaN is no data.
    pub fn height_m(self, [r, g, b]: [u8; 3]) -> f32 {
        let code = i32::from(r) << 16 | i32::from(g) << 8 | i32::from(b);
        match self {
            Self::TerrainRgb | Self::Terrarium if code == 0 => f32::NAN,
            Self::TerrainRgb => (-10_000.0 + 0.1 * f64::from(code)) as f32,
            Self::Terrarium => (f64::from(code) / 256.0 - 32_768.0) as f32,
            Self::Gsi => match code - (1 << 23) {
                0 => f32::NAN,
                below if below < 0 => (0.01 * f64::from(code)) as f32,
                _ => (0.01 * f64::from(code - (1 << 24))) as f32,
            },
        }
    }
}

/// Whether a text begins like a GSI text tile: numbers or `e`, separated by commas.
pub(super) fn looks_like_text(head: &[u8]) -> bool {
    let line = head.split(|b| *b == b'\n').next().unwrap_or_default().trim_ascii();
    let commas = line.iter().filter(|b| **b == b',').count();
    (255..=256).contains(&commas) && line.iter().all(|b| b.is_ascii_digit() || b",.-e".contains(b))
}

pub(super) struct Tile {
    info: PartInfo,
    source: ByteSource,
    encoding: Option<TileEncoding>,
}

fn place(source: &ByteSource, options: &OpenOptions) -> Result<[u32; 3], IoError> {
    options.tile.or_else(|| tile_from_path(source.label())).ok_or_else(|| {
        let expected = "the tile's zoom, column and row, like 10/906/404.png or dem_z10_x906_y404.png";
        IoError::malformed(source.label(), "file name", expected, source.file_name())
    })
}

/// Where the pixels of a tile lie.
pub(super) fn georeference(size: [usize; 2], [zoom, x, y]: [u32; 3], given: Option<&Crs>) -> GeoReference {
    let tile_m = 2.0 * HALF_WORLD_M / f64::from(1u32 << zoom);
    let step = [tile_m / size[0] as f64, tile_m / size[1] as f64];
    let origin = [
        -HALF_WORLD_M + f64::from(x) * tile_m + 0.5 * step[0],
        HALF_WORLD_M - f64::from(y) * tile_m - 0.5 * step[1],
    ];
    let crs = given.cloned().or_else(|| crs::from_epsg(3857)).unwrap_or_default();
    GeoReference::new(crs, origin, [step[0], -step[1]], size)
}

fn part_info(
    source: &ByteSource,
    options: &OpenOptions,
    format: &str,
    size: [usize; 2],
    [zoom, x, y]: [u32; 3],
) -> Result<PartInfo, IoError> {
    if zoom > 30 || u64::from(x.max(y)) >= 1 << zoom {
        let found = format!("{zoom}/{x}/{y}");
        return Err(IoError::malformed(source.label(), "tile number", "column and row below 2^zoom", found));
    }
    Ok(PartInfo {
        label: source.label().to_owned(),
        format: format.to_owned(),
        size,
        geo: georeference(size, [zoom, x, y], options.crs.as_ref()),
        sample_type: SampleType::Rgb,
        no_data: None,
        compression: "png".to_owned(),
        overviews: Vec::new(),
        chunk: size,
        notes: Vec::new(),
    })
}

/// Opens a picture tile; the encoding is taken from the options, the name or the colours.
pub(super) fn open_png(source: &ByteSource, options: &OpenOptions) -> Result<Tile, IoError> {
    let tile = place(source, options)?;
    let (size, _) = decode_png(source, false)?;
    let mut info = part_info(source, options, "tile", size, tile)?;
    let (encoding, how) = match options.tile_encoding.or_else(|| encoding_from_name(source)) {
        Some(encoding) => (encoding, None),
        None => (guess_encoding(&decode_png(source, true)?.1, &info)?, Some("guessed from the colours")),
    };
    info.format = format!("{} tile", encoding.name());
    info.notes.extend(how.map(|how| format!("encoding {}: {how}", encoding.name())));
    Ok(Tile { info, source: source.clone(), encoding: Some(encoding) })
}

/// Opens a text tile.
pub(super) fn open_text(source: &ByteSource, options: &OpenOptions) -> Result<Tile, IoError> {
    let tile = place(source, options)?;
    let mut info = part_info(source, options, "GSI text tile", [TEXT_TILE_SIDE; 2], tile)?;
    info.sample_type = SampleType::Text;
    info.compression = source.compression_name().to_owned();
    Ok(Tile { info, source: source.clone(), encoding: None })
}

fn encoding_from_name(source: &ByteSource) -> Option<TileEncoding> {
    let path = source.label().to_string_lossy().to_ascii_lowercase();
    let name = path.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    let known = |text: &str| {
        let has = |words: &[&str]| words.iter().any(|w| text.contains(w));
        if has(&["terrarium"]) {
            Some(TileEncoding::Terrarium)
        } else if has(&["terrainrgb", "terrain-rgb", "terrain_rgb", "mapbox"]) {
            Some(TileEncoding::TerrainRgb)
        } else if has(&["gsi_dem", "dem_png", "dem5a_png", "dem5b_png", "dem5c_png", "demgm_png", "dem1a_png"]) {
            Some(TileEncoding::Gsi)
        } else {
            None
        }
    };
    known(&name).or_else(|| known(&path))
}

/// Picks the encoding under which the colours are terrain: within the heights of Earth, and not steeper than rock.
fn guess_encoding(pixels: &[[u8; 4]], info: &PartInfo) -> Result<TileEncoding, IoError> {
    let width = info.size[0];
    let is_terrain = |encoding: TileEncoding| {
        let mut slopes = (0.0, 0u32);
        for row in pixels.chunks_exact(width) {
            let mut last = f32::NAN;
            for [r, g, b, a] in row {
                let z = if *a == 0 { f32::NAN } else { encoding.height_m([*r, *g, *b]) };
                if z.is_finite() && !(-12_000.0..=9_000.0).contains(&z) {
                    return false;
                }
                let rise = (z - last).abs();
                if rise.is_finite() {
                    slopes = (slopes.0 + f64::from(rise) / info.geo.step_m[0], slopes.1 + 1);
                }
                last = z;
            }
        }
        slopes.0 <= MAX_MEAN_SLOPE * f64::from(slopes.1.max(1))
    };
    const MAX_MEAN_SLOPE: f64 = 1.0;
    let has_gsi_no_data = pixels.iter().any(|[r, g, b, _]| [*r, *g, *b] == [128, 0, 0]);
    let order = if has_gsi_no_data {
        [TileEncoding::Gsi, TileEncoding::Terrarium, TileEncoding::TerrainRgb]
    } else {
        [TileEncoding::TerrainRgb, TileEncoding::Terrarium, TileEncoding::Gsi]
    };
    order.into_iter().find(|encoding| is_terrain(*encoding)).ok_or_else(|| {
        IoError::malformed(
            &info.label,
            "colours",
            "heights in the Terrain-RGB, Terrarium or GSI encoding",
            "colours that are no terrain in any of them",
        )
    })
}

/// Size of a PNG and, if wanted, its pixels as RGBA.
fn decode_png(source: &ByteSource, with_pixels: bool) -> Result<([usize; 2], Vec<[u8; 4]>), IoError> {
    let label = source.label();
    let broken = |e: png::DecodingError| match e {
        png::DecodingError::IoError(e) if e.kind() != std::io::ErrorKind::UnexpectedEof => IoError::io(label, e),
        e => IoError::malformed(label, "PNG data", "a complete picture", e.to_string()),
    };
    let mut decoder = png::Decoder::new(source.seekable()?);
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(broken)?;
    let (width, height) = (reader.info().width, reader.info().height);
    if width > MAX_TILE_SIDE || height > MAX_TILE_SIDE {
        let given = u64::from(width.max(height));
        return Err(IoError::too_large(label, "pixels on a tile's side", given, MAX_TILE_SIDE.into()));
    }
    let channels = match reader.output_color_type() {
        (png::ColorType::Rgb, png::BitDepth::Eight) => 3,
        (png::ColorType::Rgba, png::BitDepth::Eight) => 4,
        (colour, depth) => {
            let what = format!("a PNG with {colour:?} samples of {} bits", depth as u8);
            return Err(IoError::unsupported(label, what, "tiles of heights are RGB or RGBA with 8 bits"));
        }
    };
    let size = [width as usize, height as usize];
    if !with_pixels {
        return Ok((size, Vec::new()));
    }
    let mut bytes = vec![0; size[0] * size[1] * channels];
    reader.next_frame(&mut bytes).map_err(broken)?;
    let pixels = bytes.chunks_exact(channels).map(|p| [p[0], p[1], p[2], p.get(3).copied().unwrap_or(255)]).collect();
    Ok((size, pixels))
}

fn read_text(source: &ByteSource) -> Result<Vec<f32>, IoError> {
    let label = source.label();
    let text = source.read_all(MAX_TEXT_TILE_BYTES)?;
    let mut heights_m = Vec::with_capacity(TEXT_TILE_SIDE * TEXT_TILE_SIDE);
    for (row, line) in text.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).filter(|l| !l.is_empty()).enumerate() {
        let line = line.strip_suffix(b",").unwrap_or(line);
        for (column, word) in line.split(|b| *b == b',').enumerate() {
            let word = String::from_utf8_lossy(word.trim_ascii());
            let height = if word == "e" { Some(f32::NAN) } else { word.parse().ok().map(clean) };
            heights_m.push(height.ok_or_else(|| {
                let place = format!("row {}, column {}", row + 1, column + 1);
                IoError::malformed(label, place, "a height or e", format!("'{}'", word.escape_default()))
            })?);
        }
        if heights_m.len() != (row + 1) * TEXT_TILE_SIDE {
            let found = heights_m.len().saturating_sub(row * TEXT_TILE_SIDE).to_string();
            return Err(IoError::malformed(label, format!("row {}", row + 1), "256 heights", found));
        }
    }
    if heights_m.len() != TEXT_TILE_SIDE * TEXT_TILE_SIDE {
        let found = format!("{} rows", heights_m.len() / TEXT_TILE_SIDE);
        return Err(IoError::malformed(label, "end of the file", "256 rows", found));
    }
    Ok(heights_m)
}

impl Part for Tile {
    fn info(&self) -> &PartInfo {
        &self.info
    }

    fn info_mut(&mut self) -> &mut PartInfo {
        &mut self.info
    }

    fn read_chunk(&mut self, _chunk: [usize; 2]) -> Result<Vec<f32>, IoError> {
        let Some(encoding) = self.encoding else { return read_text(&self.source) };
        let (size, pixels) = decode_png(&self.source, true)?;
        if size != self.info.size {
            let expected = format!("{:?} pixels as before", self.info.size);
            return Err(IoError::malformed(&self.info.label, "PNG header", expected, format!("{size:?}")));
        }
        let height = |[r, g, b, a]: &[u8; 4]| if *a == 0 { f32::NAN } else { encoding.height_m([*r, *g, *b]) };
        Ok(pixels.iter().map(height).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_mean_heights() {
        assert_eq!(TileEncoding::TerrainRgb.height_m([1, 134, 160]), 0.0);
        assert_eq!(TileEncoding::Terrarium.height_m([128, 1, 128]), 1.5);
        assert_eq!(TileEncoding::Gsi.height_m([0, 1, 0]), 2.56);
        assert_eq!(TileEncoding::Gsi.height_m([255, 255, 255]), -0.01);
        assert!(TileEncoding::Gsi.height_m([128, 0, 0]).is_nan());
        assert!(TileEncoding::TerrainRgb.height_m([0, 0, 0]).is_nan());
    }

    proptest::proptest! {
        #[test]
        fn heights_come_back_within_half_a_step(z in -9_999.0f32..9_000.0) {
            for encoding in [TileEncoding::TerrainRgb, TileEncoding::Terrarium, TileEncoding::Gsi] {
                let back = encoding.height_m(encoding.colour(z));
                let half_m = 0.5 * encoding.quantum_m() + 1e-3;
                proptest::prop_assert!(f64::from((back - z).abs()) <= half_m, "{z} {back}");
                proptest::prop_assert!(encoding.height_m(encoding.colour(f32::NAN)).is_nan());
                proptest::prop_assert!(!encoding.height_m(encoding.colour(z * 1e6)).is_nan());
            }
        }
    }
}
