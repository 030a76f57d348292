//! GPX: waypoints are places, tracks and routes are lines.
//!
//! Format: "GPX: the GPS Exchange Format", 1.1, 2004 (Topografix).

use super::feature::{Feature, Features, Line};
use super::words::{Word, number};
use crate::tin_file::xml::{Node, Tag, Xml};
use crate::{IoError, crs};
use glam::DVec3;
use std::path::Path;
use yamanami_core::LineKind;

/// Reads a file's features.
pub(super) fn read(label: &Path, bytes: &[u8]) -> Result<Features, IoError> {
    let mut xml = Xml::new(label, bytes)?;
    let mut features = Vec::new();
    let (mut feature, mut depth_of_feature, mut depth) = (Feature::default(), None, 0usize);
    // the point whose elements are being read
    let mut point: Option<Option<DVec3>> = None;
    let mut is_gpx = false;
    loop {
        match xml.next()? {
            Node::Eof => break,
            Node::Start(tag, line) => {
                depth += 1;
                let name = tag.local_name();
                match name {
                    "gpx" => is_gpx = true,
                    _ if !is_gpx => {
                        return Err(IoError::malformed(label, format!("line {line}"), "<gpx>", format!("<{name}>")));
                    }
                    "wpt" | "trk" | "rte" if depth_of_feature.is_none() => {
                        feature = Feature { place: format!("line {line}"), ..Feature::default() };
                        depth_of_feature = Some(depth);
                        if name == "rte" {
                            feature.shape.lines.push(Line::default());
                        }
                    }
                    "trkseg" => feature.shape.lines.push(Line::default()),
                    _ => {}
                }
                if matches!(name, "wpt" | "trkpt" | "rtept") {
                    point = Some(place(&tag));
                }
            }
            Node::End(name, text, _) => {
                match name {
                    "ele" => {
                        if let Some(Some(point)) = &mut point {
                            point.z = number(text).unwrap_or(f64::NAN);
                        }
                    }
                    "name" if depth_of_feature == Some(depth - 1) => feature.words.add(Word::Name, text),
                    "sym" | "type" if depth_of_feature == Some(depth - 1) => feature.words.add(Word::Kind, text),
                    "wpt" | "trkpt" | "rtept" => match (point.take().flatten(), name) {
                        (None, _) => feature.fault = Some(format!("<{name}> without lat and lon")),
                        (Some(place), "wpt") => feature.shape.points.push(place),
                        (Some(place), _) => {
                            if let Some(line) = feature.shape.lines.last_mut() {
                                line.points.push(place);
                            }
                        }
                    },
                    _ => {}
                }
                if depth_of_feature == Some(depth) {
                    depth_of_feature = None;
                    features.push(std::mem::take(&mut feature));
                }
                depth = depth.saturating_sub(1);
            }
        }
    }
    if !is_gpx {
        return Err(IoError::malformed(label, "line 1", "<gpx>", "no element"));
    }
    Ok(Features { kind: Some(LineKind::Track), crs: crs::from_epsg(4326), features, ..Features::default() })
}

fn place(tag: &Tag<'_>) -> Option<DVec3> {
    let of = |name: &str| tag.attribute(name).and_then(|value| number(&value));
    Some(DVec3::new(of("lon")?, of("lat")?, f64::NAN))
}
