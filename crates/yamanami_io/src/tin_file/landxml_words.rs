//! Words of LandXML: its units, and what its `CoordinateSystem` says in many ways.
//!
//! Based on: LandXML.org, "LandXML 1.2 schema", 2008; National Institute for Land and Infrastructure Management (Japan),
//! "J-LandXML, data exchange standard for 3D design data", for zones written as `9(X,Y)`.

use super::check::crs_of_epsg;
use super::notes::Notes;
use super::xml::Tag;
use yamanami_core::{Crs, FOOT_M, US_SURVEY_FOOT_M};

/// A unit of length: its system's element, its name, its metres.
pub(super) type Unit = (&'static str, &'static str, f64);

/// The units of the schema.
const UNITS: [Unit; 8] = [
    ("Metric", "meter", 1.0),
    ("Metric", "millimeter", 0.001),
    ("Metric", "centimeter", 0.01),
    ("Metric", "kilometer", 1000.0),
    ("Imperial", "foot", FOOT_M),
    ("Imperial", "USSurveyFoot", US_SURVEY_FOOT_M),
    ("Imperial", "inch", 0.0254),
    ("Imperial", "mile", 1609.344),
];

/// The unit of that many metres; the metre where there is none.
pub(super) fn unit_of(unit_m: f64) -> Unit {
    UNITS.into_iter().find(|unit| unit.2 == unit_m).unwrap_or(UNITS[0])
}

/// Metres in the unit that a `Metric` or `Imperial` element states.
pub(super) fn unit_m(tag: &Tag<'_>, line: u64, notes: &mut Notes) -> f64 {
    let stated = tag.attribute("linearUnit").unwrap_or_default();
    let name = match stated.trim() {
        "metre" | "metres" | "meters" | "m" => "meter",
        "millimetre" | "mm" => "millimeter",
        "centimetre" | "cm" => "centimeter",
        "kilometre" | "km" => "kilometer",
        "feet" | "ft" | "InternationalFoot" => "foot",
        "usSurveyFoot" | "US_survey_foot" | "ussurveyfoot" => "USSurveyFoot",
        name => name,
    };
    match UNITS.iter().find(|unit| unit.1.eq_ignore_ascii_case(name)) {
        Some(unit) => unit.2,
        None => {
            notes.say(format!("line {line}: unit '{}' is not known, metres assumed", stated.trim()));
            1.0
        }
    }
}

/// The CRS that a `CoordinateSystem` element states, as code or in words.
pub(super) fn crs(tag: &Tag<'_>, line: u64, notes: &mut Notes) -> Option<Crs> {
    let said = |name: &str| tag.attribute(name).map(|text| half_width(&text)).unwrap_or_default();
    let names = ["horizontalCoordinateSystemName", "projectedCoordinateSystemName", "name", "desc"].map(said);
    if let Some(epsg) = code(&said("epsgCode")).or_else(|| names.iter().find_map(|name| code_in(name))) {
        let mut crs = crs_of_epsg(epsg);
        // a code that is not known by formula keeps the name that the file gives it
        let name = tag.attribute("name").unwrap_or_default();
        if crs.name == format!("EPSG:{epsg}") && !name.trim().is_empty() {
            crs.name = name;
        }
        return Some(crs);
    }
    let datums = [said("horizontalDatum"), said("datum"), names.join(" ")].join(" ").to_uppercase();
    if let Some(zone) = names.iter().find_map(|name| japanese_zone(name)) {
        let first = match () {
            () if datums.contains("2011") || datums.contains("2024") => 6669,
            () if datums.contains("2000") => 2443,
            () if datums.contains("TD") || datums.contains("TOKYO") || datums.contains("日本測地系") => {
                notes.say(format!("line {line}: the Tokyo datum of before 2002 is named, not converted"));
                30161
            }
            () => {
                notes.say(format!("line {line}: zone {zone} without a datum, JGD2011 assumed"));
                6669
            }
        };
        return Some(crs_of_epsg(first + zone - 1));
    }
    let name = names.into_iter().find(|name| !name.trim().is_empty())?;
    notes.say(format!("line {line}: the coordinate system '{}' is not known by formula", name.trim()));
    Some(Crs { name: name.trim().to_owned(), ..Crs::default() })
}

/// A code like `6677` or `EPSG:6677`.
fn code(text: &str) -> Option<u32> {
    let text = text.trim();
    code_in(text).or_else(|| text.parse().ok()).filter(|&code| code > 0)
}

/// The code in a text that has `EPSG:` and digits.
fn code_in(text: &str) -> Option<u32> {
    let upper = text.to_ascii_uppercase();
    let (_, rest) = upper.split_once("EPSG:")?;
    rest.trim_start_matches([':', ' ']).split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

/// Number of the Japanese plane rectangular zone that a text names: `9(X,Y)`, `9系`, `Japan Plane Rectangular CS IX`,
/// `JGD2011, Zone 9`.
fn japanese_zone(text: &str) -> Option<u32> {
    const ROMAN: [&str; 19] = [
        "I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X", "XI", "XII", "XIII", "XIV", "XV", "XVI", "XVII",
        "XVIII", "XIX",
    ];
    let upper = text.to_uppercase();
    let is_japanese = ["平面直角", "JAPAN", "JGD", "TOKYO"].iter().any(|word| upper.contains(word));
    let number_before = |mark: &str| {
        upper.match_indices(mark).find_map(|(at, _)| {
            let before = upper[..at].trim_end();
            before[before.trim_end_matches(|c: char| c.is_ascii_digit()).len()..].parse().ok()
        })
    };
    let word_after = |mark: &str| upper.split_once(mark)?.1.trim_start().split([' ', ',', '(', ')', '系']).next();
    let number_or_roman = |word: &str| {
        let roman = || ROMAN.iter().position(|&roman| roman == word).map(|index| index as u32 + 1);
        word.parse().ok().or_else(roman)
    };
    let zone = number_before("(X,Y)").or_else(|| number_before("系")).or_else(|| {
        let word = word_after("RECTANGULAR CS").or_else(|| word_after("ZONE")).or_else(|| word_after("平面直角座標系"));
        word.filter(|_| is_japanese && !upper.contains("UTM")).and_then(number_or_roman)
    });
    zone.filter(|zone| (1..=19).contains(zone))
}

/// Full-width digits, letters and brackets as ASCII.
fn half_width(text: &str) -> String {
    let half = |c: char| match c {
        '\u{ff01}'..='\u{ff5e}' => char::from_u32(c as u32 - 0xfee0).unwrap_or(c),
        '\u{3000}' => ' ',
        c => c,
    };
    text.chars().map(half).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zones_are_named_in_many_ways() {
        for (text, zone) in [
            ("9(X,Y)", Some(9)),
            ("JGD2011 / 9(X,Y)", Some(9)),
            ("平面直角座標系 第９系", Some(9)),
            ("平面直角座標系 12", Some(12)),
            ("第13系", Some(13)),
            ("JGD2011 / Japan Plane Rectangular CS XIX", Some(19)),
            ("Japan Geodetic Datum 2011, JGD2011, Zone 8, Meter", Some(8)),
            ("20(X,Y)", None),
            ("JGD2011 / UTM zone 54N", None),
            ("WGS 84 / UTM zone 54N", None),
            ("Massachusetts Mainland zone 4", None),
            ("", None),
        ] {
            assert_eq!(japanese_zone(&half_width(text)), zone, "{text}");
        }
    }

    #[test]
    fn codes_stand_alone_or_after_their_word() {
        assert_eq!(code("6677"), Some(6677));
        assert_eq!(code(" EPSG:2264 "), Some(2264));
        assert_eq!(code("EPSG::6677"), Some(6677));
        assert_eq!((code("none"), code("0"), code("99999999999")), (None, None, None));
        assert_eq!(code_in("EPSG:32647+EPSG:5703"), Some(32647));
    }
}
