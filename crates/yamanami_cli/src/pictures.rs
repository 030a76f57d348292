//! How pictures look, and how they are written.

use crate::failure::Failure;
use crate::progress::note;
use crate::{inputs, out, values};
use clap::{Args, ValueEnum};
use image::{DynamicImage, ImageFormat, RgbaImage};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use yamanami::core::TriangleMesh;
use yamanami::gpu::{ColourBy, Drape, RenderOptions, Wireframe};
use yamanami::io::IoError;
use yamanami::{Error, Subject, Terrain, model_style};

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
    /// the whole terrain, north up
    #[arg(long, value_name = "FILE", conflicts_with = "colour")]
    image: Option<PathBuf>,
    /// Draw the edges of the triangles
    #[arg(long)]
    wireframe: bool,
    /// One normal a triangle, so that the triangles show
    #[arg(long)]
    flat: bool,
    /// Height of a water surface: what lies below is tinted blue, darker with depth
    #[arg(long, value_name = "M", value_parser = values::number, allow_hyphen_values = true)]
    water: Option<f64>,
    /// One sample a pixel instead of four
    #[arg(long)]
    one_sample: bool,
}

impl StyleArgs {
    pub(crate) fn options(&self, subject: &impl Subject) -> Result<RenderOptions, Failure> {
        let Some(terrain) = subject.as_terrain() else { return self.over(subject.usual_style()) };
        let mut options = self.coloured(subject.usual_style());
        if let Some(file) = &self.image {
            options.colour = ColourBy::Drape;
            options.drape = Some(Arc::new(drape(terrain, file)?));
        }
        Ok(options)
    }

    /// The style of a mesh drawn as it is.
    pub(crate) fn model_options(&self, mesh: &TriangleMesh) -> Result<RenderOptions, Failure> {
        self.over(model_style(mesh))
    }

    /// The style of a model that is usually drawn so; images are for terrain.
    fn over(&self, usual: RenderOptions) -> Result<RenderOptions, Failure> {
        if self.image.is_some() {
            return Err(Failure::misuse("--image is laid over terrain; a mesh shows the colours of its file"));
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
            flat: self.flat,
            water_level_m: self.water,
            antialias: !self.one_sample,
            ..options
        }
    }
}

/// Reads a picture.
pub(crate) fn read(file: &Path) -> Result<RgbaImage, Failure> {
    let picture = |source| Error::Picture { path: file.to_owned(), source };
    let reader = image::ImageReader::open(file).map_err(|e| IoError::io(file, e))?;
    let reader = reader.with_guessed_format().map_err(|e| IoError::io(file, e))?;
    Ok(reader.decode().map_err(picture)?.into_rgba8())
}

/// Writes a picture in the format of its name; it appears whole or not at all.
pub(crate) fn write(file: &Path, picture: RgbaImage) -> Result<(), Failure> {
    let failed = |source| Failure::from(Error::Picture { path: file.to_owned(), source });
    let format = ImageFormat::from_path(file).map_err(failed)?;
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::ImageRgba8(picture).into_rgb8().write_to(&mut bytes, format).map_err(failed)?;
    out::file(file, &bytes.into_inner())
}

/// An image laid over a terrain.
fn drape(terrain: &Terrain, file: &Path) -> Result<Drape, Failure> {
    let image = read(file)?;
    let size = [f64::from(image.width()), f64::from(image.height())];
    let Some(pixel) = world_file(file)? else {
        let [dx, dy] = terrain.geo().step_m.map(|s| 0.5 * s);
        let [east_m, north_m] = terrain.extent_m();
        return Ok(Drape::over_box(image, [-dx, -north_m - dy], [east_m + dx, dy]));
    };
    // pixel (column, row) lies at source (a·column + b·row + c, d·column + e·row + f), its middle; source coordinates
    // are an affine map of the local frame: three places tell it
    let [a, d, b, e, c, f] = pixel;
    let det = a * e - b * d;
    let uv = |x_m: f64, y_m: f64| {
        let [x, y] = terrain.geo().source_from_local(x_m, y_m);
        let (x, y) = (x - c, y - f);
        [((e * x - b * y) / det + 0.5) / size[0], ((a * y - d * x) / det + 0.5) / size[1]]
    };
    let [east_m, north_m] = terrain.extent_m();
    let (origin, east, south) = (uv(0.0, 0.0), uv(east_m, 0.0), uv(0.0, -north_m));
    let apart = |k: usize| {
        let far = east[k] + south[k] - origin[k];
        let reach = [origin[k], east[k], south[k], far];
        reach.iter().all(|&v| v < 0.0) || reach.iter().all(|&v| v > 1.0)
    };
    if apart(0) || apart(1) {
        note(&format!("note: {} lies nowhere over the terrain, by its world file", file.display()));
    }
    let row = |k: usize| [(east[k] - origin[k]) / east_m, (south[k] - origin[k]) / -north_m, origin[k]];
    Ok(Drape::new(image, [row(0), row(1)]))
}

/// The six numbers of the world file beside an image, if there is one.
fn world_file(image: &Path) -> Result<Option<[f64; 6]>, Failure> {
    let file = ["wld", "pgw", "jgw", "pngw", "jpgw"].iter().map(|e| image.with_extension(e)).find(|f| f.is_file());
    let Some(file) = file else { return Ok(None) };
    if inputs::file_bytes(&file)? > 4096 {
        return Err(Failure::failed(format!("{}: expected six numbers, one a line", file.display())));
    }
    let text = std::fs::read_to_string(&file).map_err(|e| IoError::io(&file, e))?;
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|t| values::number(t).ok()).collect();
    let six = numbers.and_then(|v| <[f64; 6]>::try_from(v).ok()).filter(|[a, d, b, e, ..]| a * e - b * d != 0.0);
    six.map(Some).ok_or_else(|| {
        Failure::failed(format!(
            "{}: expected six numbers of a map that can be turned round, one a line",
            file.display()
        ))
    })
}
