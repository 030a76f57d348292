//! CRS and units of a LAS file: GeoTIFF keys, or well-known text.
//!
//! Format: OGC 19-008r4, "GeoTIFF Standard" 1.1, 2019; OGC 01-009 and 18-010r7, well-known text of CRSs.

use crate::crs;
use crate::dem::prj::last_authority_code;
use yamanami_core::{Crs, FOOT_M, US_SURVEY_FOOT_M};

const MODEL_TYPE: u16 = 1024;
const CITATION: u16 = 1026;
const GEOGRAPHIC_TYPE: u16 = 2048;
const PROJECTED_TYPE: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;
const LINEAR_UNITS: u16 = 3076;
const VERTICAL_UNITS: u16 = 4099;
const TEXT_PARAMETERS: u16 = 34737;

/// What a file says of its coordinates.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Georef {
    pub(super) crs: Crs,
    /// Metres in a unit of x and y.
    pub(super) unit_m: Option<f64>,
    /// Metres in a unit of z, where it says so.
    pub(super) height_unit_m: Option<f64>,
}

/// Metres in a unit by EPSG code.
fn unit_of_code(code: u16) -> Option<f64> {
    match code {
        9001 => Some(1.0),
        9002 => Some(FOOT_M),
        9003 => Some(US_SURVEY_FOOT_M),
        _ => None,
    }
}

/// By the directory of keys and its text.
pub(super) fn of_keys(directory: &[u16], text: &[u8]) -> Georef {
    let entry = |key: u16| directory.get(4..)?.chunks_exact(4).find(|entry| entry[0] == key);
    let code = |key: u16| entry(key).filter(|e| e[1] == 0).map(|e| e[3]).filter(|&code| code != 0 && code != 32767);
    let words = |key: u16| {
        let entry = entry(key).filter(|e| e[1] == TEXT_PARAMETERS)?;
        let start = usize::from(entry[3]);
        let bytes = text.get(start..start + usize::from(entry[2]))?;
        Some(String::from_utf8_lossy(bytes).trim_end_matches(['|', '\0', ' ']).to_owned())
    };
    let geographic = code(MODEL_TYPE) == Some(2);
    let epsg = code(if geographic { GEOGRAPHIC_TYPE } else { PROJECTED_TYPE }).map(u32::from);
    let known = epsg.and_then(crs::from_epsg).filter(|crs| crs.geographic == geographic);
    // the systems that are known here are in metres
    let unit_m = code(LINEAR_UNITS).and_then(unit_of_code).or(known.as_ref().map(|_| 1.0));
    let crs = known.unwrap_or_else(|| Crs {
        epsg,
        geographic,
        web_mercator: false,
        name: words(PROJECTED_CITATION).or_else(|| words(CITATION)).unwrap_or_default(),
    });
    Georef { crs, unit_m, height_unit_m: code(VERTICAL_UNITS).and_then(unit_of_code) }
}

/// By well-known text, 1 or 2, compound or not.
pub(super) fn of_wkt(text: &str) -> Option<Georef> {
    let plan = ["PROJCS", "PROJCRS", "PROJECTEDCRS"].iter().find_map(|keyword| part(text, keyword));
    let vertical = ["VERT_CS", "VERTCRS", "VERTICALCRS"].iter().find_map(|keyword| part(text, keyword));
    let (plan, geographic) = match plan {
        Some(plan) => (plan, false),
        None => (["GEOGCS", "GEOGCRS", "GEODCRS"].iter().find_map(|keyword| part(text, keyword))?, true),
    };
    let name = plan.split('"').nth(1).unwrap_or_default().to_owned();
    let epsg = last_authority_code(plan);
    let known = epsg.and_then(crs::from_epsg).filter(|crs| crs.geographic == geographic);
    let unit_m = if geographic { None } else { last_unit(plan) };
    let crs = known.unwrap_or(Crs { epsg, geographic, web_mercator: false, name });
    Some(Georef { crs, unit_m, height_unit_m: vertical.and_then(last_unit) })
}

/// The part `KEYWORD[...]` of a text, brackets balanced.
fn part<'a>(text: &'a str, keyword: &str) -> Option<&'a str> {
    let starts = text.match_indices(keyword).map(|(at, _)| at);
    let start = starts.into_iter().find(|&at| text[at + keyword.len()..].trim_start().starts_with('['))?;
    let mut depth = 0;
    for (at, c) in text[start..].char_indices() {
        match c {
            '[' => depth += 1,
            ']' if depth == 1 => return Some(&text[start..=start + at]),
            ']' => depth -= 1,
            _ => {}
        }
    }
    None
}

/// The factor of the last unit of a part: its own, after those of what it builds upon.
fn last_unit(part: &str) -> Option<f64> {
    let after = &part[part.rfind("UNIT[")? + 5..];
    let factor = after.split(',').nth(1)?.split([',', ']']).next()?.trim();
    factor.parse().ok().filter(|factor: &f64| factor.is_finite() && *factor > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_say_system_and_units() {
        let directory = [1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 6677, 4099, 0, 1, 9003];
        let georef = of_keys(&directory, b"");
        assert_eq!((georef.crs.epsg, georef.unit_m), (Some(6677), Some(1.0)));
        assert_eq!(georef.height_unit_m, Some(US_SURVEY_FOOT_M));
        let directory = [1, 1, 0, 3, 1024, 0, 1, 1, 1026, 34737, 6, 1, 3072, 0, 1, 32767, 3076, 0, 1, 9002];
        let georef = of_keys(&directory, b"xOregon|");
        assert_eq!((georef.crs.name.as_str(), georef.unit_m), ("Oregon", Some(FOOT_M)));
        assert_eq!(of_keys(&[1], b"").unit_m, None);
    }

    #[test]
    fn text_says_system_and_units() {
        let text = r#"COMPD_CS["both",PROJCS["state plane",GEOGCS["x",UNIT["degree",0.0174]],UNIT["US survey foot",0.3048006096012192],AUTHORITY["EPSG","2285"]],VERT_CS["up",UNIT["foot",0.3048]]]"#;
        let georef = of_wkt(text).unwrap();
        assert_eq!((georef.crs.epsg, georef.crs.name.as_str()), (Some(2285), "state plane"));
        assert_eq!((georef.unit_m, georef.height_unit_m), (Some(0.3048006096012192), Some(FOOT_M)));
        let text = r#"PROJCRS["JGD2011 / IX",BASEGEOGCRS["JGD2011",ANGLEUNIT["degree",0.017]],CS[Cartesian,2],LENGTHUNIT["metre",1],ID["EPSG",6677]]"#;
        assert_eq!(of_wkt(text).unwrap().unit_m, Some(1.0));
        assert!(of_wkt(r#"GEOGCS["WGS 84",UNIT["degree",0.0174]]"#).unwrap().crs.geographic);
        for bad in ["", "PROJCS", "PROJCS[", "PROJCS[\"標高", "PROJCS[UNIT[]", "PROJCS[UNIT[\"a\",nan]]"] {
            assert_eq!(of_wkt(bad).and_then(|g| g.unit_m), None);
        }
    }
}
