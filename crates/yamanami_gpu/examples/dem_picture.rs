//! Draws a whole elevation GeoTIFF (32-bit floats), two triangles a cell:
//! `cargo run --release -p yamanami_gpu --example dem_picture -- DEM.tif SPACING_M OUT.png [style ...]`.
//! Styles: `gpu`, `wire`, `level`, `plain`, `low` (eye near the ground), `map` (from straight above), `drape`, `coarse`.

use glam::DVec3;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;
use yamanami_core::{TriangleMesh, View};
use yamanami_gpu::{Background, ColourBy, Drape, Haze, RenderOptions, ResidentBuffers, Wireframe, software};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, spacing_m, output, styles @ ..] = arguments.as_slice() else {
        return Err("expected: DEM.tif SPACING_M OUT.png [style ...]".into());
    };
    let has = |style: &str| styles.iter().any(|s| s == style);
    let mesh = load(input, spacing_m.parse()?, if has("coarse") { 8 } else { 1 })?;
    let bounds = mesh.bounds();
    let size = bounds.max - bounds.min;
    let viewport_px = [1280, 720];
    let (eye, target) = if has("map") {
        (bounds.centre() + DVec3::Z * size.y * 1.4, bounds.centre())
    } else if has("low") {
        let start =
            DVec3::new(bounds.min.x + 0.06 * size.x, bounds.min.y + 0.06 * size.y, bounds.min.z + 0.45 * size.z);
        (start, bounds.centre() + DVec3::Z * 0.1 * size.z)
    } else {
        (bounds.centre() + DVec3::new(-0.35, -1.0, 0.45) * size.y, bounds.centre() - DVec3::Z * 0.15 * size.z)
    };
    let view = View { eye, target, fov_y_rad: 0.75, viewport_px };
    let mut options = RenderOptions::default();
    if has("wire") {
        options.wireframe = Some(Wireframe::default());
    }
    if has("level") {
        options.colour = ColourBy::Level;
    }
    if has("plain") {
        options.colour = ColourBy::Plain([205, 200, 190]);
        options.background = Background::Plain([255, 255, 255]);
        options.haze = Haze::None;
    }
    if has("drape") {
        let board = image::RgbaImage::from_fn(512, 512, |x, y| {
            let dark = (x / 32 + y / 32) % 2 == 0;
            image::Rgba(if dark { [90, 120, 160, 255] } else { [235, 225, 200, 255] })
        });
        options.drape =
            Some(Arc::new(Drape::over_box(board, [bounds.min.x, bounds.min.y], [bounds.max.x, bounds.max.y])));
        options.colour = ColourBy::Drape;
    }
    let buffers = ResidentBuffers::from_mesh(&mesh);
    let start = Instant::now();
    let picture = software::render_to_image(&buffers, &view, &options)?;
    println!("{} triangles in software: {:?}", buffers.triangle_count(), start.elapsed());
    picture.save(output)?;
    #[cfg(feature = "wgpu")]
    if has("gpu") {
        let gpu = yamanami_gpu::Gpu::headless()?;
        let mut mesh = yamanami_gpu::ResidentMesh::with_buffers(&gpu, buffers.clone());
        println!("{}: {:?}", gpu.description(), mesh.flush()?);
        let mut renderer = yamanami_gpu::Renderer::new(&gpu);
        renderer.render_to_image(&mesh, &view, &options)?;
        let start = Instant::now();
        let drawn = renderer.render_to_image(&mesh, &view, &options)?;
        println!("on the GPU with read-back: {:?}", start.elapsed());
        drawn.save(std::path::Path::new(output).with_extension("gpu.png"))?;
        let difference: u64 = drawn.iter().zip(picture.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        println!("mean difference to software: {:.4} of 255", difference as f64 / drawn.len() as f64);
    }
    println!("covered: {} px", software::covered_pixels(&buffers, &view)?);
    Ok(())
}

/// Reads every `stride`th sample and gives each grid cell two triangles.
fn load(path: &str, spacing_m: f64, stride: usize) -> Result<TriangleMesh, Box<dyn Error>> {
    let mut decoder = tiff::decoder::Decoder::new(std::io::BufReader::new(std::fs::File::open(path)?))?;
    let (width, height) = decoder.dimensions()?;
    let heights_m: Vec<f64> = match decoder.read_image()? {
        tiff::decoder::DecodingResult::F32(z) => z.into_iter().map(f64::from).collect(),
        tiff::decoder::DecodingResult::I16(z) => z.into_iter().map(f64::from).collect(),
        tiff::decoder::DecodingResult::U16(z) => z.into_iter().map(f64::from).collect(),
        _ => return Err(format!("{path}: expected heights as 16-bit integers or 32-bit floats").into()),
    };
    let columns: Vec<usize> = (0..width as usize).step_by(stride).collect();
    let rows: Vec<usize> = (0..height as usize).step_by(stride).collect();
    let mut mesh = TriangleMesh::default();
    for &j in &rows {
        for &i in &columns {
            let z = heights_m[j * width as usize + i];
            mesh.positions.push(DVec3::new(i as f64 * spacing_m, -(j as f64) * spacing_m, z));
        }
    }
    let across = columns.len() as u32;
    for j in 0..rows.len() as u32 - 1 {
        for i in 0..across - 1 {
            let [a, b, c, d] = [j * across + i, j * across + i + 1, (j + 1) * across + i, (j + 1) * across + i + 1];
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    Ok(mesh)
}
