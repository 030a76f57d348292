//! The ground of a map as a picture, by strips of rows, so that a poster need not be in memory twice.

use crate::Error;
use image::RgbaImage;
use std::sync::Arc;
use yamanami_core::MapView;
use yamanami_gpu::software::map::{GroundBuffer, MapPainter, MapScene};
use yamanami_gpu::{Hidden, HorizonTable, MapOptions, MapTexture, MapTextures, ResidentBuffers, Veil, Wireframe};
use yamanami_map::{GroundPicture, InkStyle, ink};

/// Rows drawn at once.
const STRIP_ROWS: u32 = 512;

/// How the ground is drawn.
#[derive(Debug, Clone, Default)]
pub struct BaseOptions {
    /// Its colours.
    pub textures: Arc<MapTextures>,
    /// Lines along the ridges.
    pub ink: Option<InkStyle>,
    /// The mesh.
    pub wireframe: Option<Wireframe>,
    /// Ground that lies hidden, paler by this share; only where the plane has a share of the picture.
    pub veil: Option<(yamanami_map::HorizonTable, [u8; 3], f32)>,
    /// Four samples a pixel.
    pub antialias: bool,
}

impl BaseOptions {
    /// Colours painted before.
    pub fn painted(pictures: Vec<GroundPicture>) -> Result<Self, Error> {
        Ok(Self { textures: Arc::new(textures(pictures)?), ..Self::default() })
    }
}

/// Painted ground as what drawing takes.
fn textures(pictures: Vec<GroundPicture>) -> Result<MapTextures, Error> {
    let texture = |picture: GroundPicture| MapTexture {
        reach_m: picture.reach_m,
        side_px: picture.rgba.width(),
        rgba: picture.rgba.into_raw(),
    };
    Ok(MapTextures::new(pictures.into_iter().map(texture).collect())?)
}

/// Draws the ground; transparent where there is none. `progress` hears of the share drawn.
pub fn draw_base(
    mesh: &ResidentBuffers,
    view: &MapView,
    options: &BaseOptions,
    progress: &dyn Fn(f32),
) -> Result<RgbaImage, Error> {
    let veil = options.veil.as_ref().map(|(table, colour, share)| -> Result<Veil, Error> {
        let table = HorizonTable::new(table.azimuth_count as u32, table.step_m, table.half_tangents.clone())?;
        Ok(Veil { horizon: Arc::new(table), hidden: Hidden::Veiled(*colour, *share), slack_px: 3.0 })
    });
    let style = MapOptions {
        textures: Arc::clone(&options.textures),
        wireframe: options.wireframe,
        veil: veil.transpose()?,
        antialias: options.antialias,
        ..MapOptions::default()
    };
    let painter = MapPainter::new(mesh, view, &style)?;
    let scene = MapScene::new(mesh, view)?;
    let [width, height] = view.size_px;
    let mut picture = RgbaImage::new(width, height);
    for first in (0..height).step_by(STRIP_ROWS as usize) {
        let rows = first..(first + STRIP_ROWS).min(height);
        let bytes = painter.paint_rows(rows.clone());
        let mut strip = RgbaImage::from_raw(width, rows.len() as u32, bytes).unwrap_or_default();
        if let Some(style) = &options.ink {
            let reach = style.width_px.ceil() as u32 + 1;
            let ground = scene.ground(first.saturating_sub(reach)..(rows.end + reach).min(height));
            ink(&mut strip, first, view.centre_px, view.ring_px, style, |x, y| distance_m(&ground, view, x, y));
        }
        let at = first as usize * width as usize * 4;
        picture.as_flat_samples_mut().samples[at..at + strip.len()].copy_from_slice(&strip);
        progress(rows.end as f32 / height as f32);
    }
    Ok(picture)
}

/// Distance from the map's centre of the ground at a pixel; NaN where there is none.
fn distance_m(ground: &GroundBuffer, view: &MapView, x: i64, y: i64) -> f32 {
    let (Ok(column), Ok(row)) = (u32::try_from(x), u32::try_from(y)) else { return f32::NAN };
    ground.at(column, row).map_or(f32::NAN, |p| {
        let [east, north] = view.map.centre.as_vec2().to_array();
        (p.x_m - east).hypot(p.y_m - north)
    })
}
