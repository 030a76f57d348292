//! A picture laid over the plain map and faded out beyond it: an aerial photo, a topographic map.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (texture within about ten
//! kilometres, blended out).

use crate::ground_image::world_file;
use crate::{Error, read_picture};
use glam::{DVec2, Vec4};
use image::{Rgba, RgbaImage};
use rayon::prelude::*;
use std::path::Path;
use yamanami_core::{Crs, GeoReference};
use yamanami_io::crs::{AzimuthalPlane, from_lon_lat};
use yamanami_io::dem::picture_place;
use yamanami_map::GroundPicture;

/// Share of the fading distance over which the picture fades.
const FADE_SHARE: f64 = 0.3;
/// A painted square is made this fine at most, pixels a side.
const MOST_SIDE_PX: u32 = 6001;

/// A picture and where it lies.
#[derive(Debug)]
pub struct MapImage {
    image: RgbaImage,
    geo: GeoReference,
}

impl MapImage {
    /// Reads a picture (PNG, JPEG, TIFF) and its place: a world file beside it, GeoTIFF keys, or a tile's name; `crs` is that
    /// of a world file, longitude and latitude unless said. A picture without a place is refused.
    pub fn read(path: &Path, crs: Option<&Crs>) -> Result<Self, Error> {
        let image = read_picture(path, Some(image::Limits::default()))?;
        let size = [image.width() as usize, image.height() as usize];
        let refuse = |what: &str| Error::Request(format!("{}: {what}", path.display()));
        let geo = match world_file(path)? {
            Some([_, d, b, ..]) if d != 0.0 || b != 0.0 => {
                return Err(refuse("expected a picture that is north up, got a world file that turns it"));
            }
            Some([a, _, _, e, c, f]) => {
                let geographic = || Crs { epsg: Some(4326), geographic: true, ..Crs::default() };
                GeoReference::new(crs.cloned().unwrap_or_else(geographic), [c, f], [a, e], size)
            }
            None => picture_place(path, size, crs)?.ok_or_else(|| {
                refuse("expected a place on Earth (GeoTIFF keys, a world file beside it, z/x/y in its name), got none")
            })?,
        };
        Ok(Self { image, geo })
    }

    /// The colour at a longitude and latitude, bilinear; `None` off the picture.
    fn at(&self, [lon, lat]: [f64; 2]) -> Option<Vec4> {
        let [x, y] = from_lon_lat(&self.geo.crs, lon, lat)?;
        let [column, row] = self.geo.grid_from_source(x, y);
        let (last_column, last_row) = (f64::from(self.image.width() - 1), f64::from(self.image.height() - 1));
        if !(-0.5..=last_column + 0.5).contains(&column) || !(-0.5..=last_row + 0.5).contains(&row) {
            return None;
        }
        let (column, row) = (column.clamp(0.0, last_column), row.clamp(0.0, last_row));
        let (i, j) = (column as u32, row as u32);
        let (next_i, next_j) = ((i + 1).min(self.image.width() - 1), (j + 1).min(self.image.height() - 1));
        let pixel = |i: u32, j: u32| Vec4::from_array(self.image.get_pixel(i, j).0.map(f32::from));
        let (u, v) = ((column - f64::from(i)) as f32, (row - f64::from(j)) as f32);
        let north = pixel(i, j).lerp(pixel(next_i, j), u);
        let south = pixel(i, next_j).lerp(pixel(next_i, next_j), u);
        Some(north.lerp(south, v))
    }

    /// Lays the picture over painted ground out to `reach_m` from `centre`, faded out over its last part; the squares within
    /// are made as fine as `metres_per_px` asks. Gives the share of the disc that the picture covers.
    pub fn lay_over(
        &self,
        pictures: &mut [GroundPicture],
        plane: &AzimuthalPlane,
        centre: DVec2,
        reach_m: f64,
        metres_per_px: f64,
    ) -> f64 {
        let mut covered = 0.0;
        for picture in pictures {
            // only what shows the disc need be finer
            let wanted = 2.0 * picture.reach_m / metres_per_px;
            let finer = (wanted / f64::from(picture.rgba.width() - 1)).ceil().clamp(1.0, 64.0) as u32;
            let side = (picture.rgba.width() - 1) * finer + 1;
            if finer > 1 && side <= MOST_SIDE_PX && picture.reach_m <= 4.0 * reach_m {
                picture.rgba = enlarged(&picture.rgba, finer);
            }
            covered = self.lay_over_one(picture, plane, centre, reach_m);
        }
        covered
    }

    fn lay_over_one(&self, picture: &mut GroundPicture, plane: &AzimuthalPlane, centre: DVec2, reach_m: f64) -> f64 {
        let width = picture.rgba.width() as usize;
        let step_m = 2.0 * picture.reach_m / (width - 1) as f64;
        let reach = picture.reach_m;
        let rows = picture.rgba.as_flat_samples_mut().samples.par_chunks_mut(4 * width).enumerate();
        let counts: Vec<[u64; 2]> = rows
            .map(|(row, line)| {
                let mut counts = [0u64; 2];
                for (column, pixel) in line.chunks_exact_mut(4).enumerate() {
                    let p = DVec2::new(column as f64 * step_m - reach, reach - row as f64 * step_m);
                    let off_m = (p - centre).length();
                    if off_m > reach_m {
                        continue;
                    }
                    counts[1] += 1;
                    let Some(over) = self.at(plane.to_lon_lat(p)) else { continue };
                    counts[0] += 1;
                    let share = ((1.0 - off_m / reach_m) / FADE_SHARE).min(1.0) as f32 * over.w / 255.0;
                    let under = Vec4::from_array([pixel[0], pixel[1], pixel[2], pixel[3]].map(f32::from));
                    let mixed = under.lerp(over.with_w(255.0), share);
                    pixel.copy_from_slice(&mixed.to_array().map(|v| v.round() as u8));
                }
                counts
            })
            .collect();
        let [covered, all] = counts.iter().fold([0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
        if all == 0 { 0.0 } else { covered as f64 / all as f64 }
    }
}

/// A picture with a whole number of pixels for each step between old ones, bilinear.
fn enlarged(picture: &RgbaImage, factor: u32) -> RgbaImage {
    let side = (picture.width() - 1) * factor + 1;
    RgbaImage::from_fn(side, side, |x, y| {
        let (i, j) = (x / factor, y / factor);
        let (next_i, next_j) = ((i + 1).min(picture.width() - 1), (j + 1).min(picture.height() - 1));
        let pixel = |i: u32, j: u32| Vec4::from_array(picture.get_pixel(i, j).0.map(f32::from));
        let (u, v) = ((x % factor) as f32 / factor as f32, (y % factor) as f32 / factor as f32);
        let north = pixel(i, j).lerp(pixel(next_i, j), u);
        Rgba(north.lerp(pixel(i, next_j).lerp(pixel(next_i, next_j), u), v).to_array().map(|v| v.round() as u8))
    })
}
