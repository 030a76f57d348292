//! Heights as the colours of a PNG: Mapbox Terrain-RGB, Terrarium, GSI `dem_png`.

use crate::dem::TileEncoding;

/// A square PNG of heights in metres, row by row from the north-west; NaN is transparent, or the colour that means it.
///
/// # Panics
/// When the heights make no square of `side_px`.
pub fn encode_height_png(encoding: TileEncoding, heights_m: &[f32], side_px: u32) -> Vec<u8> {
    assert_eq!(heights_m.len(), side_px as usize * side_px as usize, "heights make a square");
    // GSI's has a colour for no data and is never transparent
    let has_alpha = encoding != TileEncoding::Gsi && heights_m.iter().any(|z| z.is_nan());
    let mut pixels = Vec::with_capacity(heights_m.len() * if has_alpha { 4 } else { 3 });
    for z in heights_m {
        pixels.extend(encoding.colour(*z));
        if has_alpha {
            pixels.push(if z.is_nan() { 0 } else { 255 });
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side_px, side_px);
    encoder.set_color(if has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
    debug_assert!(written.is_ok(), "memory can be written");
    bytes
}
