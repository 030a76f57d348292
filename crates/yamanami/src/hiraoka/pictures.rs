//! The experiment's pictures: hill-shaded, their difference, and which level each block is drawn at.

use super::ground::plan_view;
use crate::{Canvas, DrawWith, Error, TinDrawing};
use glam::{DVec2, DVec3};
use image::{Rgba, RgbaImage};
use std::collections::HashSet;
use std::path::Path;
use yamanami_core::{TriangleMesh, View};
use yamanami_gpu::{Background, ColourBy, Haze, Light, RenderOptions, Wireframe};
use yamanami_multires::tin_block::TinBlocks;

/// Colours of the levels (Okabe, Ito, "Color universal design", 2008), and of what is not drawn.
const LEVEL_COLOURS: [[u8; 4]; 3] = [[0, 114, 178, 255], [230, 159, 0, 255], [0, 158, 115, 255]];
const NOT_DRAWN: [u8; 4] = [222, 222, 222, 255];
const MARK: [u8; 4] = [180, 20, 40, 255];
/// Near and far planes, the same in all pictures.
const DEPTH_M: [f64; 2] = [1.0, 60_000.0];
/// Differences are shown so many times as strong.
const STRONGER: u32 = 4;

/// The picture of the whole TIN, and how it was drawn.
#[derive(Debug)]
pub(super) struct FullPicture {
    picture: RgbaImage,
    style: RenderOptions,
}

/// Draws a whole TIN.
pub(super) fn full_picture(tin: &TriangleMesh, view: &View) -> Result<FullPicture, Error> {
    let bounds = tin.bounds();
    let style = RenderOptions {
        tint_range_m: Some([bounds.min.z, bounds.max.z]),
        haze: Haze::Distance(8_000.0),
        depth_planes_m: Some(DEPTH_M),
        light: Light { strength: 4.0, ..Light::default() },
        ..RenderOptions::default()
    };
    Ok(FullPicture { picture: picture(tin, view, &style)?, style })
}

impl FullPicture {
    pub(super) fn picture(&self) -> &RgbaImage {
        &self.picture
    }

    pub(super) fn style(&self) -> &RenderOptions {
        &self.style
    }

    /// Draws another mesh the same way.
    pub(super) fn like(&self, mesh: &TriangleMesh, view: &View) -> Result<RgbaImage, Error> {
        picture(mesh, view, &self.style)
    }

    /// Saves the picture itself, plain and with triangles.
    pub(super) fn save_itself(&self, tin: &TriangleMesh, view: &View, out: &Path) -> Result<(), Error> {
        save(&self.picture, &out.join("view_full.png"))?;
        self.save_triangles(tin, view, &out.join("triangles_full.png"))
    }

    /// Saves another mesh drawn the same way, with its triangles.
    pub(super) fn save_triangles(&self, mesh: &TriangleMesh, view: &View, path: &Path) -> Result<(), Error> {
        save(&picture(mesh, view, &wired(&self.style))?, path)
    }

    /// Saves what was drawn of a mesh, with its triangles, and how it differs: white where it does not.
    pub(super) fn save(
        &self,
        mesh: &TriangleMesh,
        drawn: &RgbaImage,
        view: &View,
        out: &Path,
        name: &str,
    ) -> Result<(), Error> {
        let difference = RgbaImage::from_fn(drawn.width(), drawn.height(), |x, y| {
            let (a, b) = (self.picture.get_pixel(x, y).0, drawn.get_pixel(x, y).0);
            let most = (0..3).map(|k| u32::from(a[k].abs_diff(b[k]))).max().unwrap_or(0);
            let grey = 255 - (STRONGER * most).min(255) as u8;
            Rgba([grey, grey, grey, 255])
        });
        self.save_triangles(mesh, view, &out.join(format!("triangles_{name}.png")))?;
        save(&difference, &out.join(format!("difference_{name}.png")))
    }
}

fn wired(style: &RenderOptions) -> RenderOptions {
    RenderOptions { wireframe: Some(Wireframe { opacity: 0.4, ..Wireframe::default() }), ..style.clone() }
}

fn picture(mesh: &TriangleMesh, view: &View, style: &RenderOptions) -> Result<RgbaImage, Error> {
    Canvas::of_mesh(mesh, DrawWith::Software)?.draw(view, style)
}

/// The plan of the whole TIN, hill-shaded, with its triangles.
pub(super) fn plan(tin: &TriangleMesh, path: &Path) -> Result<(), Error> {
    let style = RenderOptions {
        haze: Haze::None,
        background: Background::Plain([255; 3]),
        light: Light { strength: 4.0, ..Light::default() },
        wireframe: Some(Wireframe { opacity: 0.25, ..Wireframe::default() }),
        ..RenderOptions::default()
    };
    save(&picture(tin, &plan_view(1560), &style)?, path)
}

/// The plan with each block in the colour of its level, pale where it is not drawn, and the eye with its field of view.
pub(super) fn levels_picture(blocks: &TinBlocks, drawing: &TinDrawing, view: &View, path: &Path) -> Result<(), Error> {
    let mut mesh = TriangleMesh::default();
    let mut add = |corners: [DVec3; 3], colour: [u8; 4]| {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.colours.extend([colour; 3]);
        mesh.triangles.push([first, first + 1, first + 2]);
    };
    for block in 0..blocks.grid().len() {
        let drawn: HashSet<_> = drawing.triangles_of(block).iter().collect();
        let joined = blocks.joined(block, drawing.shown());
        let mut all = Vec::new();
        joined.all(&mut all);
        for triangle in &all {
            let colour = if drawn.contains(triangle) { LEVEL_COLOURS[joined.level() % 3] } else { NOT_DRAWN };
            add(triangle.map(|v| blocks.positions()[v as usize]), colour);
        }
    }
    // the sides of the field of view, and the circles of the thresholds where they are seen
    let high_m = blocks.positions().iter().map(|p| p.z).fold(0.0, f64::max) + 100.0;
    let eye = view.eye.truncate();
    let mut line = |from: DVec2, to: DVec2| {
        let across = 5.0 * (to - from).normalize_or_zero().perp();
        let [a, b, c, d] = [from - across, to - across, to + across, from + across].map(|p| p.extend(high_m));
        add([a, b, c], MARK);
        add([a, c, d], MARK);
    };
    let half_rad = ((0.5 * view.fov_y_rad).tan() * view.aspect()).atan();
    let ahead = view.forward().truncate().normalize_or_zero();
    let turned = |share: f64| DVec2::from_angle(share * half_rad).rotate(ahead);
    for side in [-1.0, 1.0] {
        line(eye, eye + 4000.0 * turned(side));
    }
    for &radius_m in &drawing.thresholds_m {
        for step in -16..16 {
            let [from, to] = [step, step + 1].map(|at| eye + radius_m * turned(f64::from(at) / 16.0));
            line(from, to);
        }
    }
    let style = RenderOptions {
        colour: ColourBy::Vertex,
        flat: true,
        haze: Haze::None,
        background: Background::Plain([255; 3]),
        light: Light { strength: 0.6, ..Light::default() },
        wireframe: Some(Wireframe { opacity: 0.35, ..Wireframe::default() }),
        ..RenderOptions::default()
    };
    save(&picture(&mesh, &plan_view(1560), &style)?, path)
}

fn save(picture: &RgbaImage, path: &Path) -> Result<(), Error> {
    picture.save(path).map_err(|source| Error::Picture { path: path.to_owned(), source })
}
