//! Pictures in rows and columns with names: the contact sheet.

use super::draw::{INK, font};
use crate::MeasureError;
use image::{Rgb, RgbImage, RgbaImage, imageops};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// Room between cells and around them, pixels.
const GAP_PX: u32 = 8;
/// Room for a line of text.
const LINE_PX: u32 = 26;
/// Room for the names of the rows.
const NAMES_PX: u32 = 110;
/// No sheet is wider or higher.
const LONGEST_SIDE_PX: u32 = 16_384;

/// A contact sheet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Title above the sheet.
    pub title: String,
    /// Names above the columns.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<SheetRow>,
    /// Side of a cell, pixels. Pictures are enlarged by whole numbers, so that their own pixels stay to be seen.
    pub cell_px: u32,
    /// What stands in empty cells.
    pub empty: String,
}

/// A row of a sheet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SheetRow {
    /// Its name.
    pub name: String,
    /// Its pictures; a column without one stays empty.
    pub cells: Vec<Option<RgbaImage>>,
}

/// Draws a sheet into a PNG file.
pub fn sheet(path: impl AsRef<Path>, sheet: &Sheet) -> Result<(), MeasureError> {
    let path = path.as_ref();
    let failed = |why: String| MeasureError::Chart { path: path.to_owned(), title: sheet.title.clone(), why };
    let picture = picture(sheet).map_err(|e| failed(e.to_string()))?;
    picture.save_with_format(path, image::ImageFormat::Png).map_err(|e| failed(e.to_string()))
}

fn picture(sheet: &Sheet) -> Result<RgbImage, Box<dyn std::error::Error>> {
    let step = sheet.cell_px.clamp(16, 1024) + GAP_PX;
    let top = 2 * LINE_PX + GAP_PX;
    let side = |count: usize, rest: u32| (count as u32).saturating_mul(step).saturating_add(rest);
    let (width, height) = (side(sheet.columns.len(), NAMES_PX + GAP_PX), side(sheet.rows.len(), top));
    if width.max(height) > LONGEST_SIDE_PX {
        return Err(format!("the sheet would be {width} x {height} pixels, {LONGEST_SIDE_PX} a side are drawn").into());
    }
    let mut canvas = RgbImage::from_pixel(width, height, Rgb([255; 3]));
    for (row, y) in sheet.rows.iter().zip((top..).step_by(step as usize)) {
        for (cell, x) in row.cells.iter().take(sheet.columns.len()).zip((NAMES_PX..).step_by(step as usize)) {
            match cell {
                Some(cell) => {
                    imageops::overlay(&mut canvas, &enlarged(cell, step - GAP_PX), i64::from(x), i64::from(y))
                }
                None => {
                    let blank = RgbImage::from_pixel(step - GAP_PX, step - GAP_PX, Rgb([246; 3]));
                    imageops::overlay(&mut canvas, &blank, i64::from(x), i64::from(y));
                }
            }
        }
    }
    let mut pixels = canvas.into_raw();
    {
        let root = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        let text = |text: &str, at: (u32, u32), size: i32, horizontal: HPos| {
            let style = font(size).color(&INK).pos(Pos::new(horizontal, VPos::Center));
            root.draw(&Text::new(text.to_owned(), (at.0 as i32, at.1 as i32), style)).map_err(|e| e.to_string())
        };
        text(&sheet.title, (GAP_PX, LINE_PX / 2 + 2), 18, HPos::Left)?;
        for (name, x) in sheet.columns.iter().zip((NAMES_PX..).step_by(step as usize)) {
            text(name, (x + (step - GAP_PX) / 2, LINE_PX + LINE_PX / 2 + 4), 15, HPos::Center)?;
        }
        for (row, y) in sheet.rows.iter().zip((top..).step_by(step as usize)) {
            text(&row.name, (GAP_PX, y + step / 2), 15, HPos::Left)?;
            for (cell, x) in row.cells.iter().take(sheet.columns.len()).zip((NAMES_PX..).step_by(step as usize)) {
                if cell.is_none() {
                    text(&sheet.empty, (x + (step - GAP_PX) / 2, y + (step - GAP_PX) / 2), 13, HPos::Center)?;
                }
            }
        }
        root.present().map_err(|e| e.to_string())?;
    }
    RgbImage::from_raw(width, height, pixels).ok_or_else(|| "the picture has another size".into())
}

/// A picture enlarged by the largest whole number that fits, or cut to what fits, in a square.
fn enlarged(picture: &RgbaImage, side: u32) -> RgbImage {
    let times = (side / picture.width().max(picture.height()).max(1)).max(1);
    let (width, height) = (picture.width() * times, picture.height() * times);
    let large = imageops::resize(picture, width, height, imageops::FilterType::Nearest);
    let part = imageops::crop_imm(&large, 0, 0, width.min(side), height.min(side)).to_image();
    image::DynamicImage::ImageRgba8(part).into_rgb8()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn a_sheet_has_its_pictures_and_its_texts() {
        let red = RgbaImage::from_pixel(20, 10, Rgba([255, 0, 0, 255]));
        let sheet_of = |columns: usize| Sheet {
            title: "parts".into(),
            columns: (0..columns).map(|k| format!("{k} ×")).collect(),
            rows: vec![SheetRow { name: "roof".into(), cells: vec![Some(red.clone()), None] }],
            cell_px: 60,
            empty: "none".into(),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sheet.png");
        sheet(&path, &sheet_of(2)).unwrap();
        let drawn = image::open(&path).unwrap().into_rgb8();
        assert_eq!(drawn.dimensions(), (2 * 68 + 118, 68 + 60));
        assert_eq!(drawn.pixels().filter(|p| p.0 == [255, 0, 0]).count(), 60 * 30, "three times as large");
        assert!(drawn.pixels().any(|p| p.0[0] < 100 && p.0[0] == p.0[1]), "ink");
        assert!(sheet(&path, &sheet_of(1000)).unwrap_err().to_string().contains("16384"));
    }
}
