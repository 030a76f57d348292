//! A scene as PDF: vectors, live text in the embedded part of the fonts, the ground as one image.

use super::{Scene, svg::Ground};
use crate::{Fonts, MapError};
use image::RgbaImage;
use resvg::usvg;
use std::sync::Arc;

/// How well the JPEG of the ground is kept, 1 to 100.
const JPEG_QUALITY: u8 = 92;

/// The picture of the ground as a file's bytes: JPEG, or PNG when it is transparent somewhere.
#[derive(Debug, Clone)]
pub struct PackedBase {
    bytes: Arc<Vec<u8>>,
    is_jpeg: bool,
}

impl PackedBase {
    /// Packs a picture; over paper (as JPEG) where some is given.
    pub fn pack(base: &RgbaImage, paper: Option<[u8; 3]>) -> Result<Self, MapError> {
        let is_jpeg = paper.is_some() || base.pixels().all(|p| p.0[3] == 255);
        let mut bytes = Vec::new();
        let (width, height) = base.dimensions();
        let written = if is_jpeg {
            let rgb: Vec<u8> = base.pixels().flat_map(|p| over(p.0, paper)).collect();
            let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
            encoder.encode(&rgb, width, height, image::ExtendedColorType::Rgb8)
        } else {
            let encoder = image::codecs::png::PngEncoder::new_with_quality(
                &mut bytes,
                image::codecs::png::CompressionType::Fast,
                image::codecs::png::FilterType::Adaptive,
            );
            image::ImageEncoder::write_image(encoder, base, width, height, image::ExtendedColorType::Rgba8)
        };
        let format = if is_jpeg { "JPEG" } else { "PNG" };
        written.map_err(|cause| MapError::Write(format, cause.to_string()))?;
        Ok(Self { bytes: Arc::new(bytes), is_jpeg })
    }

    /// As an address that holds the picture itself.
    pub(super) fn data_url(&self) -> String {
        let kind = if self.is_jpeg { "jpeg" } else { "png" };
        let mut out = format!("data:image/{kind};base64,");
        base64(&self.bytes, &mut out);
        out
    }

    fn kind(&self) -> usvg::ImageKind {
        match self.is_jpeg {
            true => usvg::ImageKind::JPEG(self.bytes.clone()),
            false => usvg::ImageKind::PNG(self.bytes.clone()),
        }
    }
}

impl Scene {
    /// The sheet as one PDF page of the size that `dpi` gives it.
    pub fn to_pdf(&self, base: Option<&PackedBase>, dpi: f64, fonts: &Fonts) -> Result<Vec<u8>, MapError> {
        let fault = |cause: String| MapError::Write("PDF", cause);
        let svg = self.written(base.map_or(Ground::None, |_| Ground::Named("ground")), None, fonts);
        let kind = base.map(PackedBase::kind);
        let resolver = usvg::ImageHrefResolver {
            resolve_string: Box::new(move |_, _| kind.clone()),
            ..usvg::ImageHrefResolver::default()
        };
        let options =
            usvg::Options { fontdb: fonts.database(), image_href_resolver: resolver, ..usvg::Options::default() };
        let tree = super::raster::tree(&svg, options).map_err(fault)?;
        let page = svg2pdf::PageOptions { dpi: dpi as f32 };
        svg2pdf::to_pdf(&tree, svg2pdf::ConversionOptions::default(), page).map_err(|cause| fault(cause.to_string()))
    }
}

fn over([r, g, b, a]: [u8; 4], paper: Option<[u8; 3]>) -> [u8; 3] {
    let paper = paper.unwrap_or([255; 3]);
    let mix = |c: u8, p: u8| ((u32::from(c) * u32::from(a) + u32::from(p) * u32::from(255 - a) + 127) / 255) as u8;
    [mix(r, paper[0]), mix(g, paper[1]), mix(b, paper[2])]
}

/// Base 64 as in RFC 4648.
fn base64(bytes: &[u8], out: &mut String) {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    out.reserve(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(three.get(i).copied().unwrap_or(0)));
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            out.push(if i <= three.len() { char::from(digit) } else { '=' });
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn base64_is_that_of_the_rfc() {
        let coded = |text: &str| {
            let mut out = String::new();
            super::base64(text.as_bytes(), &mut out);
            out
        };
        assert_eq!(["", "f", "fo", "foo", "foob"].map(coded), ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg=="]);
    }
}
