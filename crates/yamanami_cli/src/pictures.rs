//! How pictures look, and how they are written.

use crate::failure::Failure;
use crate::progress::note;
use crate::{out, values};
use clap::{Args, ValueEnum};
use image::{DynamicImage, ImageFormat, RgbaImage};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use yamanami::core::TriangleMesh;
use yamanami::gpu::{ColourBy, RenderOptions, Wireframe};
use yamanami::{Error, GroundImage, Subject, model_style};

/// Endings of picture files.
pub(crate) const PICTURE_ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// Surfaces of one colour.
const GREY: [u8; 3] = [206, 206, 202];

/// What gives the surface its colour.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Colour {
    /// Hypsometric tint
    Height,
    /// Level of the vertices: dark is coarse, light is fine
    Level,
    /// One light grey
    Plain,
    /// Angle to the horizontal: level is light, 60° and more is dark
    Slope,
    /// Direction of fall: north red, east yellow, south green, west blue, level grey
    Aspect,
}

/// How a picture looks.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Drawing")]
pub(crate) struct StyleArgs {
    /// What gives the surface its colour; else height for terrain, and for models their own colours
    #[arg(long, value_enum, value_name = "BY")]
    colour: Option<Colour>,
    /// Lay an image (PNG or JPEG) over the surface: by its world file (.wld, .pgw, .jgw) where there is one, else over
    /// the whole of it, north up
    #[arg(long, value_name = "FILE", conflicts_with = "colour")]
    image: Option<PathBuf>,
    /// Draw the edges of the triangles
    #[arg(long)]
    wireframe: bool,
    /// One normal a triangle, so that the triangles show; usual for TINs, whose breaklines are edges
    #[arg(long)]
    flat: bool,
    /// Normals between those of the vertices, of TINs too
    #[arg(long, conflicts_with = "flat")]
    smooth: bool,
    /// Height of a water surface: what lies below is tinted blue, darker with depth
    #[arg(long, value_name = "M", value_parser = values::number, allow_hyphen_values = true)]
    water: Option<f64>,
    /// One sample a pixel instead of four
    #[arg(long)]
    one_sample: bool,
}

impl StyleArgs {
    pub(crate) fn options(&self, subject: &impl Subject) -> Result<RenderOptions, Failure> {
        if !subject.is_ground() {
            return self.over(subject.usual_style());
        }
        let mut options = self.coloured(subject.usual_style());
        if let Some(file) = &self.image {
            let image = GroundImage::read(file, None)?;
            if !image.lies_over(subject) {
                note(&format!("note: {} lies nowhere over the surface, by its world file", file.display()));
            }
            options.colour = ColourBy::Drape;
            options.drape = Some(Arc::new(image.drape(subject)));
        }
        Ok(options)
    }

    /// The style of a mesh drawn as it is.
    pub(crate) fn model_options(&self, mesh: &TriangleMesh) -> Result<RenderOptions, Failure> {
        self.over(model_style(mesh))
    }

    /// The style of a scan that is usually drawn so; images are for terrain.
    fn over(&self, usual: RenderOptions) -> Result<RenderOptions, Failure> {
        if self.image.is_some() {
            return Err(Failure::misuse("--image is laid over terrain and TINs; a mesh shows the colours of its file"));
        }
        Ok(self.coloured(usual))
    }

    fn coloured(&self, usual: RenderOptions) -> RenderOptions {
        let colour = match self.colour {
            None => usual.colour,
            Some(Colour::Height) => ColourBy::Height,
            Some(Colour::Level) => ColourBy::Level,
            Some(Colour::Plain) => ColourBy::Plain(GREY),
            Some(Colour::Slope) => ColourBy::Slope,
            Some(Colour::Aspect) => ColourBy::Aspect,
        };
        self.common(RenderOptions { colour, ..usual })
    }

    fn common(&self, options: RenderOptions) -> RenderOptions {
        RenderOptions {
            wireframe: self.wireframe.then(Wireframe::default),
            flat: (self.flat || options.flat) && !self.smooth,
            water_level_m: self.water,
            antialias: !self.one_sample,
            ..options
        }
    }
}

/// Writes a picture in the format of its name; it appears whole or not at all.
pub(crate) fn write(file: &Path, picture: RgbaImage) -> Result<(), Failure> {
    let failed = |source| Failure::from(Error::Picture { path: file.to_owned(), source });
    let format = ImageFormat::from_path(file).map_err(failed)?;
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::ImageRgba8(picture).into_rgb8().write_to(&mut bytes, format).map_err(failed)?;
    out::file(file, &bytes.into_inner())
}
