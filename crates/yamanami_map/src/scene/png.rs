//! A finished picture as PNG that knows its size on paper.

use crate::MapError;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, RgbaImage};

/// Where the header chunk of a PNG ends: signature, then length, name, 13 bytes and check sum.
const AFTER_HEADER: usize = 8 + 4 + 4 + 13 + 4;

/// A picture as the bytes of a PNG file, with its dots per inch where given.
pub fn encode_png(picture: &RgbaImage, dpi: Option<f64>) -> Result<Vec<u8>, MapError> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive)
        .write_image(picture, picture.width(), picture.height(), ExtendedColorType::Rgba8)
        .map_err(|cause| MapError::Write("PNG", cause.to_string()))?;
    if let Some(dpi) = dpi.filter(|dpi| dpi.is_finite() && *dpi > 0.0) {
        let per_m = ((dpi / 0.0254).round() as u32).to_be_bytes();
        // pixels per metre across and down; 1: the unit is the metre
        let body = [b"pHYs".as_slice(), &per_m, &per_m, &[1]].concat();
        let chunk = [9u32.to_be_bytes().as_slice(), &body, &check_sum(&body).to_be_bytes()].concat();
        bytes.splice(AFTER_HEADER..AFTER_HEADER, chunk);
    }
    Ok(bytes)
}

/// CRC-32 as in the PNG specification, annex D.
fn check_sum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| if sum & 1 == 1 { 0xEDB8_8320 ^ (sum >> 1) } else { sum >> 1 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_knows_its_size_on_paper() {
        assert_eq!(check_sum(b"123456789"), 0xCBF4_3926);
        let picture = RgbaImage::from_pixel(3, 2, image::Rgba([1, 2, 3, 4]));
        let bytes = encode_png(&picture, Some(300.0)).unwrap();
        assert_eq!(&bytes[AFTER_HEADER + 4..AFTER_HEADER + 12], b"pHYs\0\0\x2E\x23");
        assert_eq!(image::load_from_memory(&bytes).unwrap().to_rgba8(), picture);
    }
}
