//! Which format a file is in: by its content first, by its name only where the content cannot tell.

use super::bytes::ByteSource;
use super::part::Part;
use super::tile_name::tile_from_path;
use super::{OpenOptions, ascii, dted, fg_gml, geotiff, hgt, tiff_tags, tile};
use crate::IoError;
use std::path::{Path, PathBuf};

const HEAD_BYTES: u64 = 8192;
/// Archives in archives: GSI packs zips into one more zip.
const MAX_NESTING: usize = 3;
const MAX_FOLDER_DEPTH: usize = 8;
const MAX_FOLDER_FILES: usize = 1 << 20;

type Parts = Vec<Box<dyn Part>>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Tiff,
    Zip,
    Gzip,
    Png,
    Dted,
    FgGml,
    Ascii,
    TextTile,
    Hgt,
}

fn detect(source: &ByteSource, head: &[u8]) -> Option<Format> {
    if tiff_tags::looks_like(head) {
        Some(Format::Tiff)
    } else if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        Some(Format::Zip)
    } else if head.starts_with(b"\x1f\x8b") {
        Some(Format::Gzip)
    } else if head.starts_with(b"\x89PNG\r\n\x1a\n") {
        Some(Format::Png)
    } else if dted::header_offset(head).is_some() {
        Some(Format::Dted)
    } else if fg_gml::looks_like(head) {
        Some(Format::FgGml)
    } else if ascii::looks_like(head) {
        Some(Format::Ascii)
    } else if tile::looks_like_text(head) {
        Some(Format::TextTile)
    } else {
        // SRTM has no mark of its own: the length is all it has.
        let is_named_hgt = extension(source.label()) == "hgt";
        let has_length = source.length().and_then(hgt::side_from_length).is_some();
        (is_named_hgt || has_length && hgt::corner_from_name(&source.file_name()).is_some()).then_some(Format::Hgt)
    }
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Opens one file, which must be an elevation grid or an archive of some.
pub(super) fn open_file(source: &ByteSource, options: &OpenOptions, parts: &mut Parts) -> Result<(), IoError> {
    let head = source.head(HEAD_BYTES)?;
    match open_detected(source, &head, options, parts, 0) {
        Ok(true) => Ok(()),
        Ok(false) => open_otherwise(source, options, parts, not_known(source, &head)),
        Err(error @ IoError::Unsupported { .. }) => open_otherwise(source, options, parts, error),
        Err(error) => Err(error),
    }
}

/// Leaves what is not read here to GDAL, if this build has it; else that is the `error`.
#[cfg_attr(not(feature = "gdal"), expect(unused_variables))]
fn open_otherwise(
    source: &ByteSource,
    options: &OpenOptions,
    parts: &mut Parts,
    error: IoError,
) -> Result<(), IoError> {
    #[cfg(feature = "gdal")]
    if let Some(part) = super::gdal_file::open(source, options)? {
        parts.push(Box::new(part));
        return Ok(());
    }
    Err(error)
}

/// Opens what is recognised; false when it is not.
fn open_detected(
    source: &ByteSource,
    head: &[u8],
    options: &OpenOptions,
    parts: &mut Parts,
    nesting: usize,
) -> Result<bool, IoError> {
    let Some(format) = detect(source, head) else { return Ok(false) };
    let part: Box<dyn Part> = match format {
        Format::Tiff => Box::new(geotiff::open(source, options)?),
        Format::Png => Box::new(tile::open_png(source, options)?),
        Format::TextTile => Box::new(tile::open_text(source, options)?),
        Format::Dted => Box::new(dted::open(source, options)?),
        Format::FgGml => Box::new(fg_gml::open(source, options)?),
        Format::Ascii => Box::new(ascii::open(source, options)?),
        Format::Hgt => Box::new(hgt::open(source, options)?),
        Format::Zip | Format::Gzip if nesting == MAX_NESTING => {
            let what = format!("archives in archives more than {MAX_NESTING} deep");
            return Err(IoError::unsupported(source.label(), what, "unpack them first"));
        }
        Format::Gzip => {
            let inner = ByteSource::gunzip(source)?;
            let head = inner.head(HEAD_BYTES)?;
            return open_detected(&inner, &head, options, parts, nesting + 1);
        }
        Format::Zip => return open_zip(source, options, parts, nesting),
    };
    parts.push(part);
    let promised = promised_by_name(source.label());
    if !promised.is_empty()
        && !promised.contains(&format)
        && let Some(part) = parts.last_mut()
    {
        let info = part.info_mut();
        let note = format!("named .{} but is {}", extension(source.label()), info.format);
        info.notes.push(note);
    }
    Ok(true)
}

fn promised_by_name(path: &Path) -> &'static [Format] {
    match extension(path).as_str() {
        "tif" | "tiff" => &[Format::Tiff],
        "png" => &[Format::Png],
        "asc" | "agr" | "grd" => &[Format::Ascii],
        "hgt" => &[Format::Hgt],
        "xml" | "gml" => &[Format::FgGml],
        "dt0" | "dt1" | "dt2" => &[Format::Dted],
        "zip" => &[Format::Zip],
        "gz" => &[Format::Gzip],
        _ => &[],
    }
}

fn open_zip(source: &ByteSource, options: &OpenOptions, parts: &mut Parts, nesting: usize) -> Result<bool, IoError> {
    let members = ByteSource::unzip(source)?;
    let before = parts.len();
    for member in &members {
        let head = member.head(HEAD_BYTES)?;
        open_detected(member, &head, options, parts, nesting + 1)?;
    }
    if parts.len() == before {
        let names: Vec<String> = members.iter().take(4).map(ByteSource::file_name).collect();
        let more = if members.len() > 4 { format!(" and {} more", members.len() - 4) } else { String::new() };
        let found = if names.is_empty() { "nothing".to_owned() } else { format!("{}{more}", names.join(", ")) };
        return Err(IoError::malformed(source.label(), "members of the zip", "an elevation grid", found));
    }
    Ok(true)
}

/// The error for a file that is none of the formats, with what it rather seems to be.
fn not_known(source: &ByteSource, head: &[u8]) -> IoError {
    const MARKS: [(&[u8], &str); 11] = [
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"GIF8", "a GIF picture"),
        (b"RIFF", "a RIFF file (WebP?)"),
        (b"\x89HDF", "an HDF5 or NetCDF-4 file"),
        (b"CDF", "a NetCDF file"),
        (b"LASF", "a LAS or LAZ point cloud"),
        (b"ply", "a PLY mesh"),
        (b"EHFA_HEADER_TAG", "an Erdas Imagine file"),
        (b"SQLite format 3", "an SQLite database (.yama, GeoPackage, MBTiles?)"),
        (b"glTF", "a GLB mesh"),
        (b"%PDF", "a PDF"),
    ];
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    let found = if head.is_empty() {
        "an empty file".to_owned()
    } else if let Some((_, name)) = MARKS.iter().find(|(mark, _)| head.starts_with(mark)) {
        (*name).to_owned()
    } else if text.starts_with(b"<") {
        "XML or HTML without an FG-GML elevation mesh".to_owned()
    } else {
        let start: String = head.iter().take(8).map(|b| b.escape_ascii().to_string()).collect();
        format!("a start of '{start}'")
    };
    let expected = "a GeoTIFF, SRTM hgt, DTED, ESRI ASCII grid, FG-GML DEM or tile PNG (or a zip or gzip of one)";
    IoError::malformed(source.label(), "content", expected, found)
}

/// Opens all elevation grids of a folder and the folders in it, in order of their names. Of picture tiles in `z/x/y`
/// folders only one zoom is taken.
pub(super) fn open_folder(folder: &Path, options: &OpenOptions, parts: &mut Parts) -> Result<(), IoError> {
    let mut files = Vec::new();
    list(folder, 0, &mut files)?;
    files.sort();
    let tile_zoom = |path: &PathBuf| {
        let is_tile = matches!(extension(path).as_str(), "png" | "txt");
        is_tile.then(|| tile_from_path(path)).flatten().map(|[zoom, _, _]| zoom)
    };
    let zoom = options.zoom.or_else(|| files.iter().filter_map(tile_zoom).max());
    files.retain(|path| tile_zoom(path).is_none_or(|z| Some(z) == zoom));
    let before = parts.len();
    for path in &files {
        let source = ByteSource::file(path)?;
        let head = source.head(HEAD_BYTES)?;
        let is_known = open_detected(&source, &head, options, parts, 0)?;
        if !is_known && !matches!(extension(path).as_str(), "xml" | "txt" | "gz") {
            return Err(not_known(&source, &head));
        }
    }
    if parts.len() == before {
        let expected = match options.zoom {
            Some(zoom) => format!("elevation files, or tiles of zoom {zoom}"),
            None => "elevation files".to_owned(),
        };
        return Err(IoError::malformed(folder, "content of the folder", expected, "none"));
    }
    Ok(())
}

fn list(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) -> Result<(), IoError> {
    for entry in std::fs::read_dir(folder).map_err(|e| IoError::io(folder, e))? {
        let path = entry.map_err(|e| IoError::io(folder, e))?.path();
        if path.is_dir() {
            if depth < MAX_FOLDER_DEPTH {
                list(&path, depth + 1, files)?;
            }
        } else if !promised_by_name(&path).is_empty() || extension(&path) == "txt" {
            files.push(path);
        }
        if files.len() > MAX_FOLDER_FILES {
            return Err(IoError::too_large(folder, "files", files.len() as u64, MAX_FOLDER_FILES as u64));
        }
    }
    Ok(())
}
