//! `render` of a mesh file: one picture of a model.

use super::render::RenderArgs;
use crate::failure::Failure;
use crate::pictures;
use crate::progress::Bar;
use crate::{out, text};
use serde_json::json;
use std::path::Path;
use std::time::Instant;
use yamanami::core::{TriangleMesh, View};
use yamanami::gpu::RenderOptions;
use yamanami::io::mesh_file;
use yamanami::{Canvas, model_camera, model_pixels, model_views};

/// Picture size where none is asked for.
const USUAL_SIZE_PX: [u32; 2] = [1600, 900];

pub(crate) fn run(args: &RenderArgs, file: &Path) -> Result<(), Failure> {
    let mut mesh = {
        let _bar = Bar::spinner("reading");
        mesh_file::read_mesh(file)?
    };
    args.up.turn(&mut mesh);
    let (view, style) = (view(args, &mesh), args.style.model_options(&mesh)?);
    let started = Instant::now();
    let (picture, covered_px, drawn_with) = {
        let _bar = Bar::spinner("drawing");
        let mut canvas = Canvas::of_mesh(&mesh, args.draw.with())?;
        let covered_px = model_pixels(&canvas, &[view])?[0];
        (canvas.draw(&view, &style)?, covered_px, canvas.description())
    };
    let ms = started.elapsed().as_secs_f64() * 1e3;
    pictures::write(&args.output, picture)?;
    report(args, &view, &style, &mesh, covered_px, drawn_with, ms)
}

fn view(args: &RenderArgs, mesh: &TriangleMesh) -> View {
    let size = args.lens.size.unwrap_or(USUAL_SIZE_PX);
    match (args.eye.eye, args.eye.target) {
        (Some(eye), Some(target)) => model_camera(args.up.place(eye), args.up.place(target), args.lens.fov, size),
        _ => {
            let view = model_views(&mesh.positions, 1, size)[0];
            View { fov_y_rad: args.lens.fov.unwrap_or(view.fov_y_rad), ..view }
        }
    }
}

fn report(
    args: &RenderArgs,
    view: &View,
    style: &RenderOptions,
    mesh: &TriangleMesh,
    covered_px: u64,
    drawn_with: &str,
    ms: f64,
) -> Result<(), Failure> {
    let ([width, height], triangles) = (view.viewport_px, mesh.triangles.len());
    if args.json {
        return out::json(&json!({
            "output": args.output,
            "width_px": width,
            "height_px": height,
            "triangles": triangles,
            "covered_px": covered_px,
            "antialiased": style.antialias,
            "drawn_with": drawn_with,
            "time_ms": ms,
        }));
    }
    out::row("picture", format_args!("{}, {width} x {height}", args.output.display()))?;
    out::row("triangles", text::count(triangles as u64))?;
    out::row(
        "covered",
        format_args!(
            "{} pixels: {} triangles a pixel",
            text::count(covered_px),
            text::number(triangles as f64 / covered_px.max(1) as f64)
        ),
    )?;
    out::row("drawn", format_args!("with {drawn_with} in {} ms", text::number(ms)))
}
