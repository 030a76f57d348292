//! The geo-keys of a GeoTIFF: where its samples lie and in which CRS.
//!
//! Format: OGC 19-008r4, "GeoTIFF Standard" 1.1, 2019 (N. Ritter, M. Ruth, 1995).

use super::part::guess_crs;
use super::tiff_tags::{self as tags, Directory, Tiff};
use crate::{IoError, crs};
use std::path::Path;
use yamanami_core::{Crs, GeoReference, PixelConvention};

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const CITATION: u16 = 1026;
const GEOGRAPHIC_TYPE: u16 = 2048;
const GEOGRAPHIC_CITATION: u16 = 2049;
const ANGULAR_UNITS: u16 = 2054;
const PROJECTED_TYPE: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;
const PROJECTION_METHOD: u16 = 3075;
const LINEAR_UNITS: u16 = 3076;
const CENTRAL_MERIDIAN: [u16; 3] = [3080, 3084, 3088];
const VERTICAL_UNITS: u16 = 4099;
const USER_DEFINED: u32 = 32767;
const METRE: u32 = 9001;
const DEGREE: u32 = 9102;

/// The tags that place a GeoTIFF, as stored.
#[derive(Debug, Default)]
pub(super) struct GeoTags {
    pub(super) pixel_scale: Vec<f64>,
    pub(super) tie_points: Vec<f64>,
    pub(super) transformation: Vec<f64>,
    pub(super) directory: Vec<u16>,
    pub(super) doubles: Vec<f64>,
    pub(super) ascii: String,
}

/// What the tags say.
#[derive(Debug)]
pub(super) struct Placement {
    pub(super) geo: GeoReference,
    /// Metres per unit of the stored heights.
    pub(super) metres_per_unit: f64,
    pub(super) notes: Vec<String>,
}

impl GeoTags {
    /// The tags of a directory.
    pub(super) fn read(tiff: &mut Tiff, directory: &Directory) -> Result<Self, IoError> {
        Ok(Self {
            pixel_scale: tiff.doubles(directory, tags::MODEL_PIXEL_SCALE)?,
            tie_points: tiff.doubles(directory, tags::MODEL_TIE_POINT)?,
            transformation: tiff.doubles(directory, tags::MODEL_TRANSFORMATION)?,
            directory: tiff.numbers(directory, tags::GEO_KEY_DIRECTORY)?.into_iter().map(|n| n as u16).collect(),
            doubles: tiff.doubles(directory, tags::GEO_DOUBLE_PARAMS)?,
            ascii: tiff.text(directory, tags::GEO_ASCII_PARAMS)?,
        })
    }

    /// Whether the file says where its samples lie.
    pub(super) fn is_placed(&self) -> bool {
        !self.transformation.is_empty() || (!self.pixel_scale.is_empty() && !self.tie_points.is_empty())
    }

    /// The value of a key that is stored as a number.
    fn code(&self, key: u16) -> Option<u32> {
        let entry = self.directory.get(4..)?.chunks_exact(4).find(|entry| entry[0] == key)?;
        (entry[1] == 0).then_some(u32::from(entry[3]))
    }

    fn double(&self, key: u16) -> Option<f64> {
        let entry = self.directory.get(4..)?.chunks_exact(4).find(|entry| entry[0] == key && entry[1] == 34736)?;
        self.doubles.get(usize::from(entry[3])).copied()
    }

    fn text(&self, key: u16) -> Option<&str> {
        let entry = self.directory.get(4..)?.chunks_exact(4).find(|entry| entry[0] == key && entry[1] == 34737)?;
        let start = usize::from(entry[3]);
        let text = self.ascii.get(start..start + usize::from(entry[2]))?;
        Some(text.trim_end_matches(['|', '\0', ' ']))
    }

    /// Places a grid of `size` samples; `given` is a CRS that stands over the file's own.
    pub(super) fn place(&self, label: &Path, size: [usize; 2], given: Option<&Crs>) -> Result<Placement, IoError> {
        let mut notes = Vec::new();
        let convention = match self.code(RASTER_TYPE) {
            Some(2) => PixelConvention::Point,
            _ => PixelConvention::Area,
        };
        let metres_per_unit = match self.code(VERTICAL_UNITS) {
            Some(9002) => 0.3048,
            Some(9003) => 1200.0 / 3937.0,
            _ => 1.0,
        };
        if metres_per_unit != 1.0 {
            notes.push("heights in feet turned into metres".to_owned());
        }
        let Some([mut origin, step]) = self.origin_and_step(label)? else {
            notes.push("no geo-reference in the file: taken as a metre between samples".to_owned());
            let mut geo = GeoReference::local([1.0, 1.0], size[1]);
            if let Some(crs) = given {
                geo = GeoReference::new(crs.clone(), geo.origin, geo.step, size);
            }
            return Ok(Placement { geo, metres_per_unit, notes });
        };
        if convention == PixelConvention::Area {
            origin = [origin[0] + 0.5 * step[0], origin[1] + 0.5 * step[1]];
        }
        let crs = match given {
            Some(crs) => crs.clone(),
            None => match self.crs(label)? {
                Some(crs) => crs,
                None => guess_crs(origin, [step[0], -step[1]], size, &mut notes),
            },
        };
        Ok(Placement { geo: GeoReference::new(crs, origin, step, size), metres_per_unit, notes })
    }

    /// Position of raster point (0, 0) and the steps between columns and rows.
    fn origin_and_step(&self, label: &Path) -> Result<Option<[[f64; 2]; 2]>, IoError> {
        let (origin, step) = if let [a, b, _, x, c, d, _, y, ..] = self.transformation[..] {
            if b != 0.0 || c != 0.0 {
                return Err(IoError::unsupported(label, "a rotated grid", "warp it to north-up first (gdalwarp)"));
            }
            ([x, y], [a, d])
        } else if let ([scale_x, scale_y, ..], [column, row, _, x, y, _, ..]) =
            (&self.pixel_scale[..], &self.tie_points[..])
        {
            ([x - column * scale_x, y + row * scale_y], [*scale_x, -scale_y])
        } else if self.tie_points.len() > 6 {
            let what = "a grid placed by control points";
            return Err(IoError::unsupported(label, what, "warp it to north-up first (gdalwarp)"));
        } else {
            return Ok(None);
        };
        if !origin.iter().chain(&step).all(|v| v.is_finite()) || step.contains(&0.0) {
            let found = format!("origin {origin:?}, step {step:?}");
            return Err(IoError::malformed(label, "geo-reference tags", "a place and a step above 0", found));
        }
        if step[0] < 0.0 || step[1] > 0.0 {
            return Err(IoError::unsupported(label, "a grid that is not north-up", "warp it first (gdalwarp)"));
        }
        Ok(Some([origin, step]))
    }

    fn crs(&self, label: &Path) -> Result<Option<Crs>, IoError> {
        match self.code(MODEL_TYPE) {
            Some(1) => self.projected_crs(label).map(Some),
            Some(2) => self.geographic_crs(label).map(Some),
            Some(3) => Err(IoError::unsupported(label, "geocentric coordinates", "warp it to a map CRS first")),
            _ => Ok(None),
        }
    }

    fn geographic_crs(&self, label: &Path) -> Result<Crs, IoError> {
        if let Some(unit) = self.code(ANGULAR_UNITS).filter(|unit| ![DEGREE, 9122, 0].contains(unit)) {
            let what = format!("angular unit {unit} (only degrees, {DEGREE}, are read)");
            return Err(IoError::unsupported(label, what, "warp it to EPSG:4326 first"));
        }
        let code = self.code(GEOGRAPHIC_TYPE).filter(|code| *code != USER_DEFINED && *code != 0);
        let name = self.text(GEOGRAPHIC_CITATION).or_else(|| self.text(CITATION)).unwrap_or_default();
        match code.map(|code| (code, crs::from_epsg(code))) {
            Some((_, Some(crs))) if crs.geographic => Ok(crs),
            Some((code, Some(crs))) => {
                let found = format!("EPSG:{code}, {}", crs.name);
                Err(IoError::malformed(label, "key GeodeticCRS", "a geographic CRS", found))
            }
            Some((code, None)) => {
                let name = if name.is_empty() { format!("EPSG:{code}") } else { name.to_owned() };
                Ok(Crs { epsg: Some(code), geographic: true, web_mercator: false, name })
            }
            None => {
                let name = if name.is_empty() { "user-defined longitude/latitude" } else { name };
                Ok(Crs { epsg: None, geographic: true, web_mercator: false, name: name.to_owned() })
            }
        }
    }

    fn projected_crs(&self, label: &Path) -> Result<Crs, IoError> {
        let unit = self.code(LINEAR_UNITS).filter(|unit| *unit != 0 && *unit != USER_DEFINED);
        if let Some(unit) = unit.filter(|unit| *unit != METRE) {
            let what = format!("linear unit {unit} (only metres, {METRE}, are read)");
            return Err(IoError::unsupported(label, what, "warp it to a CRS in metres first"));
        }
        let code = self.code(PROJECTED_TYPE).filter(|code| *code != USER_DEFINED && *code != 0);
        match code.map(|code| (code, crs::from_epsg(code))) {
            Some((_, Some(crs))) if !crs.geographic => Ok(crs),
            Some((code, Some(crs))) => {
                let found = format!("EPSG:{code}, {}", crs.name);
                Err(IoError::malformed(label, "key ProjectedCRS", "a projected CRS", found))
            }
            Some((code, None)) if unit == Some(METRE) => {
                Ok(Crs { epsg: Some(code), geographic: false, web_mercator: false, name: format!("EPSG:{code}") })
            }
            Some((code, None)) => {
                let what =
                    format!("EPSG:{code} is not known here and the file does not say that its unit is the metre");
                let hint = "warp it to UTM, a plane rectangular zone or longitude/latitude, or state the CRS";
                Err(IoError::unsupported(label, what, hint))
            }
            None => Ok(self.user_defined_projection()),
        }
    }

    fn user_defined_projection(&self) -> Crs {
        let citation = self.text(PROJECTED_CITATION).or_else(|| self.text(CITATION)).unwrap_or_default();
        let lower = citation.to_ascii_lowercase();
        if ["pseudo-mercator", "web_mercator", "web mercator", "popular visualisation"]
            .iter()
            .any(|w| lower.contains(w))
        {
            return Crs { epsg: None, geographic: false, web_mercator: true, name: citation.to_owned() };
        }
        let name = if citation.is_empty() || lower == "unknown" {
            let method = match self.code(PROJECTION_METHOD) {
                Some(1) => "transverse Mercator",
                Some(8 | 9) => "Lambert conformal conic",
                Some(10) => "Lambert azimuthal equal area",
                Some(11) => "Albers equal area",
                Some(15) => "polar stereographic",
                _ => "projection",
            };
            let meridian = CENTRAL_MERIDIAN.iter().find_map(|key| self.double(*key));
            let meridian = meridian.map(|lon| format!(", central meridian {lon}")).unwrap_or_default();
            format!("user-defined {method}{meridian}")
        } else {
            citation.to_owned()
        };
        Crs { epsg: None, geographic: false, web_mercator: false, name }
    }
}

/// The keys that say what `crs` is: the directory and its text parameters.
pub(super) fn keys_for(crs: &Crs) -> (Vec<u16>, String) {
    let code = crs.epsg.and_then(|code| u16::try_from(code).ok());
    let mut text = String::new();
    let mut entries: Vec<[u16; 4]> = vec![[RASTER_TYPE, 0, 1, 2]];
    let model = if crs.geographic { 2 } else { 1 };
    let is_local = code.is_none() && crs.name.is_empty() && !crs.geographic;
    entries.insert(0, [MODEL_TYPE, 0, 1, if is_local { USER_DEFINED as u16 } else { model }]);
    if !crs.name.is_empty() && crs.name.is_ascii() && crs.name.len() < 1000 {
        text = format!("{}|", crs.name.replace('|', "/"));
        entries.push([CITATION, 34737, text.len() as u16, 0]);
    }
    if crs.geographic {
        entries.push([GEOGRAPHIC_TYPE, 0, 1, code.unwrap_or(USER_DEFINED as u16)]);
        entries.push([ANGULAR_UNITS, 0, 1, DEGREE as u16]);
    } else if !is_local {
        entries.push([PROJECTED_TYPE, 0, 1, code.unwrap_or(USER_DEFINED as u16)]);
        entries.push([LINEAR_UNITS, 0, 1, METRE as u16]);
    }
    let mut directory = vec![1, 1, 0, entries.len() as u16];
    directory.extend(entries.iter().flatten());
    (directory, text)
}
