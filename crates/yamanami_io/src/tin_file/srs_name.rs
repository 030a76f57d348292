//! The `srsName` of GML: its EPSG code, and whether the north comes first.
//!
//! Based on: Open Geospatial Consortium, "Definition identifier URNs in OGC namespace", 2009: a URN or an address means the
//! registry's own axis order, the short `EPSG:n` means x before y except for latitude and longitude.

use super::check::crs_of_epsg;
use crate::crs;
use yamanami_core::Crs;

/// The CRS of coordinates in a GML file.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Srs {
    pub(super) crs: Crs,
    /// Whether the CRS is known by formula.
    pub(super) is_known: bool,
    /// Latitude or northing comes before longitude or easting.
    pub(super) northing_first: bool,
}

impl Srs {
    /// The CRS of a code, in the order of the short form.
    pub(super) fn of_epsg(epsg: u32) -> Self {
        let crs = crs_of_epsg(epsg);
        Self { is_known: crs::from_epsg(epsg).is_some(), northing_first: crs.geographic, crs }
    }

    /// `http://www.opengis.net/def/crs/EPSG/0/6697`, `urn:ogc:def:crs:EPSG::6697`, `EPSG:6697`, `fguuid:jgd2011.bl`; of
    /// compounds the first.
    pub(super) fn parse(name: &str) -> Option<Self> {
        let lower = name.trim().to_ascii_lowercase();
        if lower.starts_with("fguuid:jgd2000") {
            return Some(Self::of_epsg(4612));
        }
        if lower.starts_with("fguuid:jgd") {
            return Some(Self::of_epsg(6668));
        }
        let (before, rest) = lower.split_once("epsg")?;
        let first = rest.split([',', '&', '+']).next()?;
        let epsg = first.rsplit(|c: char| !c.is_ascii_digit()).find(|word| !word.is_empty())?.parse().ok()?;
        let mut srs = Self::of_epsg(epsg);
        let is_long = before.contains("urn:") || before.contains("://");
        // Japan's plane rectangular zones and New Zealand's grid have north as their first axis
        srs.northing_first |= is_long && matches!(epsg, 2193 | 2443..=2461 | 6669..=6687 | 10162..=10174);
        Some(srs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_all_forms() {
        for (name, epsg, northing_first) in [
            ("http://www.opengis.net/def/crs/EPSG/0/6697", 6697, true),
            ("urn:ogc:def:crs:EPSG::6677", 6677, true),
            ("EPSG:6677", 6677, false),
            ("urn:ogc:def:crs,crs:EPSG:6.12:25832,crs:EPSG:6.12:5783", 25832, false),
            ("http://www.opengis.net/gml/srs/epsg.xml#4326", 4326, true),
            ("fguuid:jgd2011.bl", 6668, true),
            ("EPSG:25832+5783", 25832, false),
        ] {
            let srs = Srs::parse(name).unwrap();
            assert_eq!((srs.crs.epsg, srs.northing_first, srs.is_known), (Some(epsg), northing_first, true), "{name}");
        }
        assert!(!Srs::parse("urn:ogc:def:crs:EPSG::7415").unwrap().is_known);
        assert_eq!(Srs::parse("urn:adv:crs:ETRS89_UTM32"), None);
        assert_eq!(Srs::parse("EPSG:99999999999"), None);
    }
}
