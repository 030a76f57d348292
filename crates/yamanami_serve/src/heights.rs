//! Exact heights of an elevation grid: at a place, and along a line.

use crate::fault::Fault;
use crate::surface::Served;
use serde::Deserialize;
use serde_json::{Value, json};
use yamanami::SurfaceHeights;
use yamanami::io::crs::AzimuthalPlane;

/// Most corners of a line.
const MOST_CORNERS: usize = 200;
/// Most places of a profile, and how many where nothing is said.
const MOST_POINTS: usize = 5000;
const USUAL_POINTS: usize = 500;

/// A place: longitude and latitude, or x and y of the surface's own CRS.
#[derive(Debug, Deserialize)]
pub(crate) struct Place {
    lon: Option<f64>,
    lat: Option<f64>,
    x: Option<f64>,
    y: Option<f64>,
}

/// A line: `lon,lat;lon,lat;…`, and how many places of it.
#[derive(Debug, Deserialize)]
pub(crate) struct Line {
    line: String,
    points: Option<usize>,
}

/// Height at a place; null where there is no ground.
pub(crate) fn height(served: &Served, place: &Place) -> Result<Value, Fault> {
    let ground = served.ground()?;
    let (grid, mut told) = match *place {
        Place { lon: Some(lon), lat: Some(lat), x: None, y: None } => {
            (ground.grid_from_lon_lat(lon, lat), json!({ "lon": lon, "lat": lat }))
        }
        Place { lon: None, lat: None, x: Some(x), y: Some(y) } => {
            (Some(ground.geo().grid_from_source(x, y).into()), json!({ "x": x, "y": y }))
        }
        _ => return Err(Fault::bad("expected ?lon=DEGREES&lat=DEGREES, or ?x=X&y=Y in the surface's CRS")),
    };
    let height_m = match grid {
        Some(place) => ground.at(0, &[place]).map_err(|e| served.unreadable(e))?[0],
        None => f32::NAN,
    };
    told["height_m"] = number(height_m);
    Ok(told)
}

/// Heights along a line, at equal distances along each of its legs.
pub(crate) fn profile(served: &Served, line: &Line) -> Result<Value, Fault> {
    let ground = served.ground()?;
    let corners = corners(&line.line)?;
    let points = line.points.unwrap_or(USUAL_POINTS);
    if !(2..=MOST_POINTS).contains(&points) {
        return Err(Fault::bad(format!("points: expected 2 to {MOST_POINTS}")));
    }
    let lengths_m: Vec<f64> = corners.windows(2).map(|leg| distance_m(leg[0], leg[1])).collect();
    let total_m: f64 = lengths_m.iter().sum();
    let mut places = Vec::with_capacity(points);
    let (mut leg, mut before_m) = (0, 0.0);
    for k in 0..points {
        let along_m = total_m * k as f64 / (points - 1) as f64;
        while leg + 1 < lengths_m.len() && along_m > before_m + lengths_m[leg] {
            before_m += lengths_m[leg];
            leg += 1;
        }
        let share = if lengths_m[leg] > 0.0 { ((along_m - before_m) / lengths_m[leg]).clamp(0.0, 1.0) } else { 0.0 };
        let ([a, b], [c, d]) = (corners[leg], corners[leg + 1]);
        places.push((along_m, [a + share * (c - a), b + share * (d - b)]));
    }
    let heights_m = heights_of(ground, &places).map_err(|e| served.unreadable(e))?;
    let told: Vec<Value> = places
        .iter()
        .zip(&heights_m)
        .map(|((along_m, [lon, lat]), z)| json!({ "distance_m": along_m, "lon": lon, "lat": lat, "height_m": number(*z) }))
        .collect();
    Ok(json!({ "distance_m": total_m, "points": told }))
}

fn heights_of(ground: &SurfaceHeights<'_>, places: &[(f64, [f64; 2])]) -> Result<Vec<f32>, yamanami::Error> {
    let grid: Vec<_> = places
        .iter()
        .map(|(_, [lon, lat])| ground.grid_from_lon_lat(*lon, *lat).unwrap_or_else(|| [f64::NAN; 2].into()))
        .collect();
    ground.at(0, &grid)
}

fn corners(text: &str) -> Result<Vec<[f64; 2]>, Fault> {
    let bad = || Fault::bad(format!("line: expected 2 to {MOST_CORNERS} places like 138.7,35.3;138.8,35.4"));
    let place = |text: &str| {
        let (lon, lat) = text.split_once(',')?;
        let [lon, lat] = [lon, lat].map(|v| v.trim().parse::<f64>().ok().filter(|v| v.is_finite()));
        Some([lon?, lat.filter(|lat| lat.abs() <= 90.0)?])
    };
    let corners: Vec<[f64; 2]> =
        text.split(';').take(MOST_CORNERS + 1).map(place).collect::<Option<_>>().ok_or_else(bad)?;
    if (2..=MOST_CORNERS).contains(&corners.len()) { Ok(corners) } else { Err(bad()) }
}

/// Along the ellipsoid.
fn distance_m([lon, lat]: [f64; 2], [to_lon, to_lat]: [f64; 2]) -> f64 {
    AzimuthalPlane::new(lon, lat).map_or(0.0, |plane| plane.to_plane(to_lon, to_lat).length())
}

fn number(height_m: f32) -> Value {
    if height_m.is_nan() { Value::Null } else { json!(height_m) }
}
