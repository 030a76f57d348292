//! Writes a height field as GeoTIFF or ESRI ASCII grid.

use super::geo_keys::keys_for;
use crate::IoError;
use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tiff::TiffError;
use tiff::encoder::colortype::Gray32Float;
use tiff::encoder::{Compression, DeflateLevel, Predictor, TiffEncoder, TiffKind, TiffKindBig, TiffKindStandard};
use tiff::tags::Tag;
use yamanami_core::HeightField;

/// Classic TIFF ends at 4 GiB; deflated floats may be a little larger than plain ones.
const MAX_CLASSIC_BYTES: u64 = 3_900_000_000;

/// Writes 32-bit floats, deflated, samples as points, NaN for no-data. The file appears under its name only when it is
/// complete.
pub fn write_geotiff(path: &Path, field: &HeightField) -> Result<(), IoError> {
    write_whole(path, |file| {
        if field.heights_m().len() as u64 * 4 > MAX_CLASSIC_BYTES {
            encode::<_, TiffKindBig>(path, file, field)
        } else {
            encode::<_, TiffKindStandard>(path, file, field)
        }
    })
}

fn encode<W: Write + Seek, K: TiffKind>(path: &Path, file: W, field: &HeightField) -> Result<(), IoError> {
    let fail = |error: TiffError| match error {
        TiffError::IoError(e) => IoError::io(path, e),
        e => IoError::malformed(path, "grid to write", "a grid that fits a TIFF", e.to_string()),
    };
    let side = |n: usize| u32::try_from(n).map_err(|_| fail(TiffError::IntSizeError));
    let geo = field.geo();
    let (directory, text) = keys_for(&geo.crs);
    let encoder = TiffEncoder::<W, K>::new_generic(file).map_err(fail)?;
    let mut encoder =
        encoder.with_compression(Compression::Deflate(DeflateLevel::Balanced)).with_predictor(Predictor::None);
    let mut image = encoder.new_image::<Gray32Float>(side(field.width())?, side(field.height())?).map_err(fail)?;
    let tags = image.encoder();
    let scale = [geo.step[0], -geo.step[1], 0.0];
    tags.write_tag(Tag::ModelPixelScaleTag, &scale[..]).map_err(fail)?;
    let tie_point = [0.0, 0.0, 0.0, geo.origin[0], geo.origin[1], 0.0];
    tags.write_tag(Tag::ModelTiepointTag, &tie_point[..]).map_err(fail)?;
    tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..]).map_err(fail)?;
    if !text.is_empty() {
        tags.write_tag(Tag::GeoAsciiParamsTag, text.as_str()).map_err(fail)?;
    }
    tags.write_tag(Tag::GdalNodata, "nan").map_err(fail)?;
    image.write_data(field.heights_m()).map_err(fail)
}

/// Writes an ESRI ASCII grid with `xllcenter`; different steps along the axes are written as `dx` and `dy`.
pub fn write_asc(path: &Path, field: &HeightField) -> Result<(), IoError> {
    write_whole(path, |out| {
        let geo = field.geo();
        let [west, south] = geo.source_from_grid(0.0, (field.height() - 1) as f64);
        let [dx, dy] = [geo.step[0], -geo.step[1]];
        let mut text = || -> std::io::Result<()> {
            writeln!(out, "ncols {}\nnrows {}\nxllcenter {west}\nyllcenter {south}", field.width(), field.height())?;
            if dx == dy {
                writeln!(out, "cellsize {dx}")?;
            } else {
                writeln!(out, "dx {dx}\ndy {dy}")?;
            }
            writeln!(out, "nodata_value -9999")?;
            for row in field.heights_m().chunks_exact(field.width()) {
                for (i, z) in row.iter().enumerate() {
                    let blank = if i == 0 { "" } else { " " };
                    if z.is_nan() { write!(out, "{blank}-9999")? } else { write!(out, "{blank}{z}")? }
                }
                writeln!(out)?;
            }
            Ok(())
        };
        text().map_err(|e| IoError::io(path, e))
    })
}

/// Writes to a neighbouring `.part` file and renames it when all is well; nothing is left behind otherwise.
fn write_whole(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> Result<(), IoError>) -> Result<(), IoError> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    let io = |e| IoError::io(path, e);
    let result = File::create(&part).map_err(io).and_then(|file| {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        write(&mut out)?;
        out.flush().map_err(io)?;
        out.get_ref().sync_all().map_err(io)?;
        std::fs::rename(&part, path).map_err(io)
    });
    if result.is_err() {
        // The first error is the one to tell; a part file that was never made cannot be removed.
        let _ = std::fs::remove_file(&part);
    }
    result
}
