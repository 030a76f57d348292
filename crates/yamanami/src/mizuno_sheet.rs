//! mizuno's table 2: parts of the pictures, cut out and laid side by side.

use crate::mizuno::{OnDisplay, PAPER_K};
use crate::{Error, MODEL_BACKGROUND};
use glam::DVec3;
use image::{RgbaImage, imageops};
use std::path::Path;
use yamanami_core::{Perspective, Projection, View};
use yamanami_measure::plot::{Sheet, SheetRow, sheet};

/// Side of the sheet's cells.
const CELL_PX: u32 = 240;

/// A square of a picture.
#[derive(Debug, Clone)]
pub(crate) struct Cut {
    pub(crate) name: String,
    left: u32,
    top: u32,
    side: u32,
}

impl Cut {
    pub(crate) fn out_of(&self, picture: &RgbaImage) -> RgbaImage {
        imageops::crop_imm(picture, self.left, self.top, self.side, self.side).to_image()
    }

    fn around(name: &str, middle: [f64; 2], radius: f64, size_px: [u32; 2]) -> Self {
        let side = ((2.0 * radius).round() as u32).clamp(8, size_px[0].min(size_px[1]).max(8));
        let start = |k: usize| {
            let most = f64::from(size_px[k].saturating_sub(side));
            (middle[k] - 0.5 * f64::from(side)).round().clamp(0.0, most) as u32
        };
        Self { name: name.to_owned(), left: start(0), top: start(1), side }
    }
}

/// Where the regions are in a picture; three places of the model, from top to bottom, where none are given.
pub(crate) fn cuts_of(regions: &[(String, DVec3, f64)], view: &View, picture: &RgbaImage) -> Vec<Cut> {
    if regions.is_empty() {
        return places_of(picture);
    }
    let projection = Perspective::new(*view, 1e-6, 1e6);
    let [width, height] = view.viewport_px.map(f64::from);
    regions
        .iter()
        .filter_map(|(name, centre, radius_m)| {
            let clip = projection.clip_from_world(*centre);
            let radius = radius_m * view.pixels_per_radian() / (*centre - view.eye).length();
            let middle = [(0.5 + 0.5 * clip.x / clip.w) * width, (0.5 - 0.5 * clip.y / clip.w) * height];
            (clip.w > 0.0).then(|| Cut::around(name, middle, radius, view.viewport_px))
        })
        .collect()
}

fn places_of(picture: &RgbaImage) -> Vec<Cut> {
    let shown: Vec<[u32; 2]> =
        picture.enumerate_pixels().filter(|(_, _, p)| p.0[..3] != MODEL_BACKGROUND).map(|(x, y, _)| [x, y]).collect();
    let (Some(first), Some(last)) = (shown.first(), shown.last()) else { return Vec::new() };
    let height = f64::from(last[1] - first[1] + 1);
    [("top", 0.2), ("middle", 0.5), ("bottom", 0.8)]
        .into_iter()
        .map(|(name, share)| {
            let row = first[1] + (share * height) as u32;
            let columns: Vec<u32> = shown.iter().filter(|p| p[1] == row).map(|p| p[0]).collect();
            let middle = columns.get(columns.len() / 2).copied().unwrap_or(picture.width() / 2);
            Cut::around(name, [f64::from(middle), f64::from(row)], 0.1 * height, [picture.width(), picture.height()])
        })
        .collect()
}

/// Writes the sheet of a display.
pub(crate) fn write_sheet(display: &OnDisplay, title: &str, path: &Path) -> Result<(), Error> {
    let mut columns: Vec<String> = PAPER_K.iter().map(|&k| k_name(k)).collect();
    columns.push("source".to_owned());
    let rows = display.cuts.iter().map(|(name, source, cells)| {
        // cells come from the most polygons down
        let cells = cells.iter().rev().cloned().chain([Some(source.clone())]).collect();
        SheetRow { name: name.clone(), cells }
    });
    let rows = rows.collect();
    Ok(sheet(
        path,
        &Sheet { title: title.to_owned(), columns, rows, cell_px: CELL_PX, empty: "source too small".to_owned() },
    )?)
}

/// `1/10 ×`, `50 ×`.
pub(crate) fn k_name(k: f64) -> String {
    if k < 1.0 { format!("1/{:.0} ×", 1.0 / k) } else { format!("{k:.0} ×") }
}
