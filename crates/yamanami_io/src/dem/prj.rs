//! The `.prj` file beside a grid: a CRS as well-known text.

use super::bytes::ByteSource;
use crate::{IoError, crs};
use yamanami_core::Crs;

const MAX_PRJ_BYTES: u64 = 1 << 16;

/// The CRS of the `.prj` file of the same name in the same folder, if there is one.
pub(super) fn beside(source: &ByteSource) -> Result<Option<Crs>, IoError> {
    let path = source.label().with_extension("prj");
    if !path.is_file() {
        return Ok(None);
    }
    let prj = ByteSource::file(&path)?;
    let text = String::from_utf8_lossy(&prj.read_all(MAX_PRJ_BYTES)?).into_owned();
    match from_wkt(&text) {
        Some(crs) => Ok(Some(crs)),
        None => Err(IoError::malformed(path, "start", "a CRS as well-known text in metres or degrees", excerpt(&text))),
    }
}

fn excerpt(text: &str) -> String {
    let start: String = text.trim().chars().take(60).collect();
    format!("'{}'", start.escape_default())
}

/// Name, kind and, where it is written out, EPSG code of a CRS in well-known text (1 or 2); `None` when it is neither
/// geographic nor projected in metres.
pub(crate) fn from_wkt(text: &str) -> Option<Crs> {
    let text = text.trim();
    let (keyword, rest) = text.split_once('[')?;
    let name = rest.trim_start().strip_prefix('"')?.split('"').next()?.to_owned();
    let geographic = match keyword.trim().to_ascii_uppercase().as_str() {
        "GEOGCS" | "GEOGCRS" | "GEOGRAPHICCRS" => true,
        "PROJCS" | "PROJCRS" | "PROJECTEDCRS" => false,
        _ => return None,
    };
    if let Some(known) = last_authority_code(text).and_then(crs::from_epsg)
        && known.geographic == geographic
    {
        return Some(known);
    }
    // The unit of a projected CRS is the last linear unit of the text.
    let upper = text.to_ascii_uppercase();
    let unit = upper.rfind("UNIT[\"").map(|at| upper[at + 6..].split('"').next().unwrap_or_default().to_owned());
    let is_metre = unit.is_some_and(|u| u.starts_with("MET"));
    if !geographic && !is_metre {
        return None;
    }
    Some(Crs { epsg: None, geographic, web_mercator: false, name })
}

/// The code of the outermost `AUTHORITY["EPSG","n"]` or `ID["EPSG",n]`, which closes the text.
pub(crate) fn last_authority_code(text: &str) -> Option<u32> {
    let at = text.rfind("\"EPSG\"")?;
    let rest = text[at + 6..].trim_start_matches([',', ' ', '"']);
    let digits = rest.find(|c: char| !c.is_ascii_digit())?;
    let (code, after) = rest.split_at(digits);
    // its own bracket and that of the whole: the code of a unit closes one more
    let is_last = after.chars().all(|c| matches!(c, ']' | '"' | ' ' | '\n' | '\r' | '\t'));
    let is_outermost = is_last && after.chars().filter(|&c| c == ']').count() == 2;
    if is_outermost { code.parse().ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_kinds_and_codes() {
        let esri = r#"PROJCS["WGS_1984_UTM_Zone_54N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["Degree",0.017453292519943295]],PROJECTION["Transverse_Mercator"],UNIT["Meter",1]]"#;
        let crs = from_wkt(esri).unwrap();
        assert_eq!((crs.name.as_str(), crs.epsg, crs.geographic), ("WGS_1984_UTM_Zone_54N", None, false));
        assert!(from_wkt(&esri.replace("Meter", "Foot_US")).is_none());
        let ogc = r#"GEOGCS["JGD2011",DATUM["Japanese_Geodetic_Datum_2011",SPHEROID["GRS 1980",6378137,298.257222101,AUTHORITY["EPSG","7019"]]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","6668"]]"#;
        assert_eq!(from_wkt(ogc).unwrap().epsg, Some(6668));
        let foot = r#"PROJCS["Lambert",UNIT["foot",0.3048,AUTHORITY["EPSG","9002"]]]"#;
        assert_eq!((last_authority_code(foot), last_authority_code(ogc)), (None, Some(6668)));
        assert_eq!(last_authority_code(r#"PROJCRS["IX", ID["EPSG", 6677]]"#), Some(6677));
        assert!(from_wkt("hello").is_none());
        assert!(from_wkt("GEOGCS[\"標高").is_some());
    }
}
