//! Figures 12 and 13: the map under each rule for peaks, in full, reduced, lettered, and its mesh.

use super::drawing::{full_mesh, paper_mesh};
use super::engine::EQUAL_COUNT;
use super::modes::HoriMode;
use super::peaks::{RULES, mesh_of_rule};
use super::{HoriJob, Shown, Study};
use crate::page::count;
use crate::{BaseOptions, Error, MapJob, MapMesh, draw_base, make_map};
use image::codecs::jpeg::JpegEncoder;
use image::{Rgba, RgbaImage};
use std::path::Path;
use yamanami_core::{FieldLevel, MapView, NestedField, TriangleMesh};
use yamanami_gpu::{ResidentBuffers, Wireframe};
use yamanami_map::{Fonts, InkStyle, ReliefStyle, SeenFrom, SheetOptions, paint};

/// Beyond the horizon.
const SKY: [u8; 3] = [250, 250, 247];
/// Pictures are JPEG of this quality.
const QUALITY: u8 = 88;
/// Squares of figure 12, metres.
const SQUARE_M: f64 = 6_400.0;

/// Draws all pictures into `out`.
pub(super) fn draw(study: &mut Study, job: &mut HoriJob, modes: &[HoriMode], out: &Path) -> Result<Vec<Shown>, Error> {
    let mut shown = twelve(study, out)?;
    shown.extend(thirteen(study, job, modes, out)?);
    Ok(shown)
}

/// Figure 12: the mesh of 6,400 m, coloured by its own heights alone.
fn twelve(study: &Study, out: &Path) -> Result<Vec<Shown>, Error> {
    let said = [
        "(a) Heights as they are at the kept vertices. The paper: the ranges become flat on the whole. So it is here.",
        "(b) The paper's rule: a kept vertex takes the highest of its cell. The paper: high mountains can be seen. So they can, and \
         the ground between them has risen too.",
        "(c) Summits and ridges alone move: the same summits, over valleys that keep their heights.",
    ];
    let mut shown = Vec::new();
    for (((peaks, _), caption), letter) in RULES.into_iter().zip(said).zip(["a", "b", "c"]) {
        let mesh = mesh_of_rule(study.grid(), &study.view, peaks, &study.summits)?.mesh;
        let options = base_options(&own_heights(&mesh), &study.view)?;
        let file = format!("fig12{letter}.jpg");
        save(draw_base(&ResidentBuffers::from_mesh(&mesh), &study.view, &options, &|_| ())?, &out.join(&file))?;
        shown.push(Shown { figure: "12", file, caption: caption.to_owned() });
    }
    Ok(shown)
}

/// The heights of a mesh of squares as a field, for its colours.
fn own_heights(mesh: &TriangleMesh) -> NestedField {
    let reach_m = mesh.positions.iter().map(|p| p.truncate().abs().max_element()).fold(SQUARE_M, f64::max);
    let half = 2 * (0.5 * reach_m / SQUARE_M).ceil() as u32;
    let width = 2 * half as usize + 1;
    let empty = FieldLevel::new(SQUARE_M, half, vec![f32::NAN; width * width]);
    let mut heights_m = vec![f32::NAN; width * width];
    for p in &mesh.positions {
        let at = empty.grid_from_plane(p.truncate()).round();
        heights_m[at.y as usize * width + at.x as usize] = p.z as f32;
    }
    NestedField::new(vec![FieldLevel::new(SQUARE_M, half, heights_m)])
}

fn base_options(colours: &NestedField, view: &MapView) -> Result<BaseOptions, Error> {
    let mut options = BaseOptions::painted(paint(colours, &ReliefStyle::default(), view.map.centre))?;
    options.antialias = true;
    options.ink = Some(InkStyle::default());
    Ok(options)
}

/// Figure 13, the paper's four and the engine's two beside them.
fn thirteen(study: &mut Study, job: &mut HoriJob, modes: &[HoriMode], out: &Path) -> Result<Vec<Shown>, Error> {
    let view = study.view;
    let options = base_options(study.scene.field(), &view)?;
    let meshed = BaseOptions { ink: None, wireframe: Some(Wireframe::default()), ..options.clone() };
    let mut shown = Vec::new();
    let mut show = |mesh: &ResidentBuffers, options: &BaseOptions, letter: &str, caption: String| {
        let file = format!("fig13{letter}.jpg");
        let caption = caption.replace("{}", &count(mesh.triangle_count() as u64));
        shown.push(Shown { figure: "13", file: file.clone(), caption });
        save(draw_base(mesh, &view, options, &|_| ())?, &out.join(file))
    };
    let full = full_mesh(study.grid(), &view)?;
    show(&full, &options, "a", "(a) Every sample, {} triangles; the paper's 3,958,784 took 6.4 s.".to_owned())?;
    drop(full);
    let paper = paper_mesh(study)?;
    let b = "(b) Reduced by table 1, peaks kept by the paper's rule: {} triangles; the paper's 77,128 took 0.4 s. The paper: few \
             great errors, for heights are replaced. Here colours come from all samples in both, so that what differs are the \
             outlines of the ranges.";
    show(&paper, &options, "b", b.to_owned())?;
    let d = "(d) The mesh of (b): coarse in the middle, where height does not show, finest from 3.2 to 35 km, and the same all \
             around, over mountains and plains. Lines fade where triangles are smaller than a few pixels.";
    show(&paper, &meshed, "d", d.to_owned())?;
    drop(paper);
    let budget = modes.iter().find(|mode| mode.file == EQUAL_COUNT).map(|mode| mode.triangles as u32);
    study.scene.update(&view, 0.0, budget)?;
    let engine = study.scene.canvas().buffers();
    let b = "(b') The engine with as many triangles, {}: each is there for what it moves in the picture.";
    show(engine, &options, "b2", b.to_owned())?;
    let d =
        "(d') The mesh of (b'): fine where ground is steep and near the ring, coarse on plains, at sea and far away.";
    show(engine, &meshed, "d2", d.to_owned())?;
    shown.insert(2, lettered(study, job, out)?);
    Ok(shown)
}

/// Figure 13 (c): the paper's mesh as a map, with names, and a picture in the middle where one is given.
fn lettered(study: &mut Study, job: &mut HoriJob, out: &Path) -> Result<Shown, Error> {
    let size_px = [job.side_px; 2];
    let sheet = SheetOptions {
        point_px: SheetOptions::point_px_for(size_px, None),
        has_title: false,
        has_credits: !job.credits.is_empty(),
        ..SheetOptions::default()
    };
    let (map, rim_m) = (study.view.map, study.view.rim_m);
    let top_m = f64::from(study.scene.field().range_m()[1]);
    let view = MapView::fitted(map, size_px, rim_m, top_m, sheet.margin_px());
    let made = MapJob {
        view,
        mesh: MapMesh::Paper,
        relief: ReliefStyle::default(),
        ink: Some(InkStyle::default()),
        wireframe: None,
        antialias: true,
        is_checked: false,
        seen_from: SeenFrom::Picture,
        sheet,
        title: String::new(),
        credits: job.credits.clone(),
        image: job.image.take(),
        fonts: Fonts::default(),
    };
    let map = make_map(&mut study.scene, &made, job.centre_lon_lat, &job.places, &job.lines, &|_, _| ())?;
    save(map.composed.scene.paint(map.base, &made.fonts)?, &out.join("fig13c.jpg"))?;
    let middle = match map.image_share {
        Some(share) => format!(
            "the picture given lies in the middle and fades out beyond 10 km; it covers {:.0} % there.",
            100.0 * share
        ),
        None => "no such picture is given, so that relief and lines stand in the middle.".to_owned(),
    };
    let caption = format!(
        "(c) The mesh of (b) as a map, with names. The paper lays a picture of a map over the inner 10 km and blends it out; here \
         {middle}"
    );
    Ok(Shown { figure: "13", file: "fig13c.jpg".to_owned(), caption })
}

/// Writes a picture as JPEG, on the sky where there is nothing.
fn save(picture: RgbaImage, path: &Path) -> Result<(), Error> {
    let mut flat = image::RgbImage::new(picture.width(), picture.height());
    for (to, &Rgba([r, g, b, a])) in flat.pixels_mut().zip(picture.pixels()) {
        let mix = |over: u8, under: u8| {
            ((u32::from(over) * u32::from(a) + u32::from(under) * (255 - u32::from(a)) + 127) / 255) as u8
        };
        to.0 = [mix(r, SKY[0]), mix(g, SKY[1]), mix(b, SKY[2])];
    }
    let file = std::fs::File::create(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
    let encoder = JpegEncoder::new_with_quality(std::io::BufWriter::new(file), QUALITY);
    flat.write_with_encoder(encoder).map_err(|source| Error::Picture { path: path.to_owned(), source })
}
