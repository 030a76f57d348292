//! `layer.json`: what a pyramid of tiles has.

use serde_json::{Value, json};

/// What a pyramid has.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layer {
    /// Name of what it shows.
    pub name: String,
    /// Whom to name for the data.
    pub attribution: String,
    /// West, south, east, north, degrees.
    pub bounds_deg: [f64; 4],
    /// Whether tiles carry normals.
    pub has_normals: bool,
    /// By zoom from 0: rectangles of tiles that are there, as first and last column, first and last row from the south.
    pub available: Vec<Vec<[u32; 4]>>,
    /// By zoom from 0: no sample is further from its tiles, metres.
    pub error_m: Vec<Option<f64>>,
}

impl Layer {
    /// The file's text.
    pub fn to_json(&self) -> String {
        let range = |[x0, x1, y0, y1]: &[u32; 4]| json!({ "startX": x0, "startY": y0, "endX": x1, "endY": y1 });
        let available: Vec<Value> = self.available.iter().map(|zoom| zoom.iter().map(range).collect()).collect();
        let first = self.available.iter().position(|zoom| !zoom.is_empty()).unwrap_or(0);
        let extensions: &[&str] = if self.has_normals { &["octvertexnormals"] } else { &[] };
        let layer = json!({
            "tilejson": "2.1.0",
            "name": self.name,
            "version": "1.0.0",
            "format": "quantized-mesh-1.0",
            "scheme": "tms",
            "projection": "EPSG:4326",
            "tiles": ["{z}/{x}/{y}.terrain"],
            "attribution": self.attribution,
            "bounds": self.bounds_deg,
            "minzoom": first,
            "maxzoom": self.available.len().saturating_sub(1),
            "extensions": extensions,
            "available": available,
            "error_m": self.error_m,
        });
        format!("{layer:#}\n")
    }
}
