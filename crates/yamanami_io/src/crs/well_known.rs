//! A CRS in words that programs know.
//!
//! Based on: Open Geospatial Consortium, "OpenGIS implementation specification: coordinate transformation services", 01-009,
//! 2001 (well-known text, the form that files still have).

use super::table::{self, Projection};
use super::transverse_mercator::Given;
use yamanami_core::Crs;

/// The well-known text of a transverse Mercator CRS that is known by its EPSG code; `None` for others, and for those with
/// a vertical part.
pub fn well_known_text(crs: &Crs) -> Option<String> {
    let epsg = crs.epsg?;
    let (name, Projection::TransverseMercator(zone)) = table::look_up(epsg)? else { return None };
    let (datum, grid) = name.split_once(" / ")?;
    if grid.contains('+') {
        return None;
    }
    let Given { ellipsoid, origin_deg: [lat, lon], scale, false_origin_m: [easting, northing] } = zone.given;
    let (radius, flattening) = (ellipsoid.semi_major_m, ellipsoid.inverse_flattening);
    Some(format!(
        "PROJCS[\"{name}\",GEOGCS[\"{datum}\",DATUM[\"{datum}\",SPHEROID[\"{datum}\",{radius},{flattening}]],\
         PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],\
         PARAMETER[\"latitude_of_origin\",{lat}],PARAMETER[\"central_meridian\",{lon}],PARAMETER[\"scale_factor\",{scale}],\
         PARAMETER[\"false_easting\",{easting}],PARAMETER[\"false_northing\",{northing}],UNIT[\"metre\",1],\
         AUTHORITY[\"EPSG\",\"{epsg}\"]]"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::from_epsg;

    #[test]
    fn zones_in_words() {
        let text = |epsg| well_known_text(&from_epsg(epsg).unwrap());
        assert_eq!(
            text(6677).unwrap(),
            "PROJCS[\"JGD2011 / Japan Plane Rectangular CS IX\",GEOGCS[\"JGD2011\",DATUM[\"JGD2011\",\
             SPHEROID[\"JGD2011\",6378137,298.257222101]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],\
             PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",36],\
             PARAMETER[\"central_meridian\",139.83333333333334],PARAMETER[\"scale_factor\",0.9999],\
             PARAMETER[\"false_easting\",0],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"6677\"]]"
        );
        assert!(text(32733).unwrap().contains("PARAMETER[\"false_northing\",10000000]"));
        assert_eq!((text(4326), text(3857), text(10170)), (None, None, None));
        assert_eq!(well_known_text(&Crs::default()), None);
    }
}
