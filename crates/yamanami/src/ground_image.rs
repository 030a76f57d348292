//! Pictures of the ground, aerial photos and maps: laid over a surface where it is shown, and cut to the part that a mesh
//! covers where it is written, so that every extract carries a texture of its own.
//!
//! A picture lies where its world file says (six numbers: ESRI, "World files for raster datasets"), in the unit of the
//! surface's CRS; without one, north up over the whole of the surface.

use crate::{Error, Subject};
use glam::{DVec2, DVec3};
use image::{DynamicImage, ImageFormat, RgbaImage, imageops};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use yamanami_core::{Material, Texture, TriangleMesh};
use yamanami_gpu::Drape;
use yamanami_io::IoError;

/// Longest side of a texture in a mesh file: what graphics hardware takes.
const MOST_SIDE_PX: u32 = 8192;
/// Quality of JPEG textures, of 100.
const JPEG_QUALITY: u8 = 92;
/// Most bytes of a world file.
const WORLD_FILE_BYTES: u64 = 4096;
/// What lies beside the picture.
const GREY: [f32; 4] = [0.6, 0.6, 0.58, 1.0];

/// A picture of the ground, and where it lies.
#[derive(Debug, Clone)]
pub struct GroundImage {
    /// Its file.
    path: PathBuf,
    image: RgbaImage,
    /// The numbers of its world file, in its order: a, d, b, e, c, f.
    world: Option<[f64; 6]>,
}

/// A picture's place on a surface: `u = a·x + b·y + c` (row 0) and `v` (row 1) of local x and y, metres.
type UvFromLocal = [[f64; 3]; 2];

impl GroundImage {
    /// Reads a picture (PNG, JPEG or TIFF), within the limits if any, and its world file if there is one (`.wld`, `.pgw`,
    /// `.jgw`, `.pngw`, `.jpgw`, `.tfw`).
    pub fn read(path: &Path, limits: Option<image::Limits>) -> Result<Self, Error> {
        Ok(Self { path: path.to_owned(), image: read_picture(path, limits)?, world: world_file(path)? })
    }

    /// The picture laid over a surface.
    pub fn drape(self, subject: &impl Subject) -> Drape {
        let place = self.place(subject);
        Drape::new(self.image, place)
    }

    /// Whether any of it lies over the box of a surface.
    pub fn lies_over(&self, subject: &impl Subject) -> bool {
        let place = self.place(subject);
        let corners = subject.bounds().corners().map(|p| uv(&place, p));
        [0, 1].into_iter().all(|k| !(corners.iter().all(|c| c[k] < 0.0) || corners.iter().all(|c| c[k] > 1.0)))
    }

    /// Where it lies in the local frame of a surface.
    fn place(&self, subject: &impl Subject) -> UvFromLocal {
        let bounds = subject.bounds();
        // half a sample beyond the first and the last of a grid
        let half = subject.as_terrain().map_or(DVec2::ZERO, |terrain| 0.5 * DVec2::from(terrain.geo().step_m).abs());
        let size = DVec2::new(f64::from(self.image.width()), f64::from(self.image.height()));
        let low = bounds.min.truncate() - half;
        // a surface without extent has a picture all the same
        let extent = (bounds.max.truncate() + half - low).max(DVec2::splat(1e-9));
        let (_, unit_m) = subject.crs_and_unit(true);
        let uv = |p: DVec2| match self.world {
            None => DVec2::new((p.x - low.x) / extent.x, 1.0 - (p.y - low.y) / extent.y),
            // pixel (column, row) has its middle at source (a·column + b·row + c, d·column + e·row + f)
            Some([a, d, b, e, c, f]) => {
                let source = subject.source_from_local(p.extend(bounds.min.z)).truncate() / unit_m - DVec2::new(c, f);
                let det = a * e - b * d;
                let pixel = DVec2::new(e * source.x - b * source.y, a * source.y - d * source.x) / det;
                (pixel + 0.5) / size
            }
        };
        // source coordinates are an affine map of local ones: three places tell it
        let origin = uv(low);
        let (east, north) = (uv(low + extent * DVec2::X) - origin, uv(low + extent * DVec2::Y) - origin);
        [0, 1].map(|k| {
            let [along_x, along_y] = [east[k] / extent.x, north[k] / extent.y];
            [along_x, along_y, origin[k] - along_x * low.x - along_y * low.y]
        })
    }

    /// Gives a mesh of a surface's local frame the part of the picture that it covers as its texture. Triangles that
    /// reach beyond the picture are grey. An error says that it lies nowhere on the picture.
    pub fn texture(&self, subject: &impl Subject, mesh: &mut TriangleMesh) -> Result<(), Error> {
        let place = self.place(subject);
        let at: Vec<DVec2> = mesh.positions.iter().map(|&p| uv(&place, p)).collect();
        let is_on = |p: DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::ONE).all();
        let painted: Vec<bool> = mesh.triangles.iter().map(|t| t.iter().all(|&v| is_on(at[v as usize]))).collect();
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (t, _) in mesh.triangles.iter().zip(&painted).filter(|(_, painted)| **painted) {
            for &v in t {
                low = low.min(at[v as usize]);
                high = high.max(at[v as usize]);
            }
        }
        if low.x > high.x {
            return Err(Error::Request(format!("{}: lies nowhere over the mesh", self.path.display())));
        }
        let size = DVec2::new(f64::from(self.image.width()), f64::from(self.image.height()));
        // a pixel around, so that colours mix at the border as they do inside
        let from = (low * size - 1.0).floor().max(DVec2::ZERO);
        let to = (high * size + 1.0).ceil().min(size);
        let [x, y, width, height] = [from.x, from.y, to.x - from.x, to.y - from.y].map(|v| v as u32);
        let part = shrunk(imageops::crop_imm(&self.image, x, y, width, height).to_image());
        let picture = self.encoded(part)?;
        let material = |name: &str, base_colour, texture| Material { name: name.to_owned(), base_colour, texture };
        mesh.materials = vec![material("ground", [1.0; 4], Some(picture))];
        mesh.material_of = Vec::new();
        if painted.contains(&false) {
            mesh.materials.push(material("beyond the picture", GREY, None));
            mesh.material_of = painted.iter().map(|&painted| u16::from(!painted)).collect();
        }
        mesh.texcoords = at.iter().map(|&p| ((p * size - from) / (to - from)).as_vec2().to_array()).collect();
        // a vertex colour would multiply the picture's
        mesh.colours.clear();
        Ok(())
    }

    /// A part of the picture as a file: JPEG where it was one, else PNG.
    fn encoded(&self, part: RgbaImage) -> Result<Texture, Error> {
        let failed = |source| Error::Picture { path: self.path.clone(), source };
        let mut bytes = Cursor::new(Vec::new());
        let is_jpeg = ImageFormat::from_path(&self.path).is_ok_and(|format| format == ImageFormat::Jpeg);
        if is_jpeg {
            let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
            DynamicImage::ImageRgba8(part).into_rgb8().write_with_encoder(encoder).map_err(failed)?;
        } else {
            part.write_to(&mut bytes, ImageFormat::Png).map_err(failed)?;
        }
        let name = self.path.with_extension(if is_jpeg { "jpg" } else { "png" });
        let name = name.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Texture { name, bytes: bytes.into_inner().into() })
    }
}

fn uv(place: &UvFromLocal, p: DVec3) -> DVec2 {
    let [u, v] = place.map(|[a, b, c]| a * p.x + b * p.y + c);
    DVec2::new(u, v)
}

/// Reads a picture (PNG, JPEG or TIFF), within the limits if any.
pub fn read_picture(path: &Path, limits: Option<image::Limits>) -> Result<RgbaImage, Error> {
    let io = |e| IoError::io(path, e);
    let mut reader = image::ImageReader::open(path).map_err(io)?.with_guessed_format().map_err(io)?;
    if let Some(limits) = limits {
        reader.limits(limits);
    }
    let picture = |source| Error::Picture { path: path.to_owned(), source };
    Ok(reader.decode().map_err(picture)?.into_rgba8())
}

/// A picture no larger than graphics hardware takes.
fn shrunk(part: RgbaImage) -> RgbaImage {
    let longest = part.width().max(part.height());
    if longest <= MOST_SIDE_PX {
        return part;
    }
    let side = |px: u32| (u64::from(px) * u64::from(MOST_SIDE_PX) / u64::from(longest)).max(1) as u32;
    imageops::resize(&part, side(part.width()), side(part.height()), imageops::FilterType::Triangle)
}

/// The six numbers of the world file beside an image, if there is one.
pub(crate) fn world_file(image: &Path) -> Result<Option<[f64; 6]>, Error> {
    let endings = ["wld", "pgw", "jgw", "tfw", "pngw", "jpgw"];
    let Some(file) = endings.iter().map(|e| image.with_extension(e)).find(|f| f.is_file()) else { return Ok(None) };
    let bad = || {
        let expected = "expected six numbers of a map that can be turned round, one a line";
        Error::Request(format!("{}: {expected}", file.display()))
    };
    let io = |e| IoError::io(&file, e);
    if std::fs::metadata(&file).map_err(io)?.len() > WORLD_FILE_BYTES {
        return Err(bad());
    }
    let text = String::from_utf8(std::fs::read(&file).map_err(io)?).map_err(|_| bad())?;
    let number = |word: &str| word.parse::<f64>().ok().filter(|v| v.is_finite());
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(number).collect();
    let six = numbers.and_then(|v| <[f64; 6]>::try_from(v).ok()).filter(|[a, d, b, e, ..]| a * e - b * d != 0.0);
    six.map(Some).ok_or_else(bad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Criteria, Model, ModelBuild, extract};
    use yamanami_core::{FOOT_M, Tin};

    /// 10 by 10 feet, its south-west corner at (1000, 2000) feet.
    fn square() -> Model {
        let at = |x: f64, y: f64| DVec3::new(1000.0 + x, 2000.0 + y, 1.0) * FOOT_M;
        let places = vec![at(0.0, 0.0), at(10.0, 0.0), at(10.0, 10.0), at(0.0, 10.0)];
        let mesh = TriangleMesh::new(places, vec![[0, 1, 2], [0, 2, 3]]);
        let tin = Tin { unit_m: FOOT_M, ..Tin::of_mesh("s", mesh) };
        ModelBuild::of_tin(&tin, "s".to_owned(), &|_| ()).unwrap().into_model().unwrap()
    }

    /// A picture of 8 by 4 pixels that tells columns and rows.
    fn picture(folder: &Path, name: &str, world: &str) -> GroundImage {
        let image = RgbaImage::from_fn(8, 4, |x, y| image::Rgba([(30 * x) as u8, (60 * y) as u8, 9, 255]));
        image.save(folder.join(name)).unwrap();
        if !world.is_empty() {
            std::fs::write(folder.join(name).with_extension("wld"), world).unwrap();
        }
        GroundImage::read(&folder.join(name), None).unwrap()
    }

    #[test]
    fn a_world_file_counts_in_the_unit_of_the_crs() {
        let folder = tempfile::tempdir().unwrap();
        let mut model = square();
        let whole = picture(folder.path(), "a.png", "");
        let close = |a: DVec2, b: [f64; 2]| assert!(a.distance(b.into()) < 1e-9, "{a}");
        let corners = |image: &GroundImage, model: &Model| {
            let place = image.place(model);
            let bounds = model.bounds();
            [uv(&place, bounds.min), uv(&place, bounds.max)]
        };
        let [south_west, north_east] = corners(&whole, &model);
        close(south_west, [0.0, 1.0]);
        close(north_east, [1.0, 0.0]);
        // pixels of 2 feet; the upper left one's middle is at (1001, 2005)
        let placed = picture(folder.path(), "b.png", "2\n0\n0\n-2\n1001\n2005\n");
        let [south_west, north_east] = corners(&placed, &model);
        close(south_west, [0.0, 0.75]);
        close(north_east, [0.625, -0.5]);
        assert!(placed.lies_over(&model));
        assert!(!picture(folder.path(), "c.png", "2\n0\n0\n-2\n5001\n2005\n").lies_over(&model));

        let mut mesh = extract(&mut model, &Criteria::default()).unwrap().mesh;
        assert!(placed.texture(&model, &mut mesh).is_err(), "no triangle lies wholly on it");
        whole.texture(&model, &mut mesh).unwrap();
        assert_eq!((mesh.materials.len(), mesh.material_of.len(), mesh.texcoords.len()), (1, 0, 4));
    }

    #[test]
    fn a_texture_is_the_part_that_the_mesh_covers() {
        let folder = tempfile::tempdir().unwrap();
        let mut model = square();
        // pixels of 5 feet from (995, 2012.5) on: the mesh covers columns 1 and 2 and the middle of the rows
        let image = picture(folder.path(), "a.png", "5\n0\n0\n-5\n997.5\n2015\n");
        let mut mesh = extract(&mut model, &Criteria::default()).unwrap().mesh;
        image.texture(&model, &mut mesh).unwrap();
        let texture = mesh.materials[0].texture.clone().unwrap();
        let part = image::load_from_memory(&texture.bytes).unwrap().into_rgba8();
        assert_eq!((texture.name.as_str(), part.dimensions()), ("a.png", (4, 4)));
        assert_eq!(part, imageops::crop_imm(&image.image, 0, 0, 4, 4).to_image());
        let lowest = mesh.positions.iter().position(|p| (p.x / FOOT_M - 1000.0).abs() < 1e-6 && p.y / FOOT_M < 2001.0);
        assert_eq!(mesh.texcoords[lowest.unwrap()], [0.25, 0.875]);
    }

    #[test]
    fn bad_world_files_are_told() {
        let folder = tempfile::tempdir().unwrap();
        picture(folder.path(), "a.png", "");
        for bad in ["1 2 3", "1 0 0 0 5 5", "a b c d e f", "1 0 0 nan 5 5"] {
            std::fs::write(folder.path().join("a.wld"), bad).unwrap();
            let error = GroundImage::read(&folder.path().join("a.png"), None).unwrap_err().to_string();
            assert!(error.contains("a.wld: expected six numbers"), "{error}");
        }
    }
}
