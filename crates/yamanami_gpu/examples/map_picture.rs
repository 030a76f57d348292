//! Draws a deformed map of made-up mountains and says how long it takes:
//! `cargo run --release -p yamanami_gpu --example map_picture -- OUT.png [style ...]`.
//! Styles: `alpha` (half a plane, with a veil), `wire`, `fine` (four samples a pixel), `gpu`, `large` (A1 at 300 dpi, in strips).

use glam::{DVec2, DVec3};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;
use yamanami_core::{DeformedMap, HeightField, MapView, TriangleMesh};
use yamanami_gpu::{
    Hidden, HorizonTable, MapOptions, MapTexture, MapTextures, ResidentBuffers, Veil, Wireframe, software::map,
};
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

const RIM_M: f64 = 160e3;
const SIDE: usize = 1281;
const SPACING_M: f64 = 250.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [output, styles @ ..] = arguments.as_slice() else { return Err("expected: OUT.png [style ...]".into()) };
    let has = |style: &str| styles.iter().any(|s| s == style);
    let shape = Shape::Fractal { relief_m: 3000.0, roughness: 0.55, seed: 5 };
    let heights = Heights(SyntheticTerrain::new(SIDE, SIDE, shape, Spacing::Metres(SPACING_M)).to_field());
    let buffers = ResidentBuffers::from_mesh(&mesh(&heights));
    let deformed = DeformedMap { alpha: if has("alpha") { 0.3 } else { 0.0 }, ..DeformedMap::default() };
    let size_px = if has("large") { [7016, 9933] } else { [1300, 1300] };
    let view = MapView::fitted(deformed, size_px, RIM_M, 2500.0, 10.0);
    let mut options = MapOptions {
        textures: Arc::new(MapTextures::new(vec![heights.texture(RIM_M, 1025), heights.texture(20e3, 513)])?),
        antialias: has("fine"),
        ..MapOptions::default()
    };
    if has("wire") {
        options.wireframe = Some(Wireframe { width_px: 0.8, ..Wireframe::default() });
    }
    if has("alpha") {
        let horizon = Arc::new(heights.horizon(&deformed)?);
        options.veil = Some(Veil { horizon, hidden: Hidden::Veiled([236, 238, 242], 0.7), slack_px: 2.0 });
    }
    if has("large") {
        let start = Instant::now();
        let painter = map::MapPainter::new(&buffers, &view, &options)?;
        let strips = (0..size_px[1]).step_by(512).map(|row| painter.paint_rows(row..row + 512).len());
        println!("{} bytes in strips: {:?}", strips.sum::<usize>(), start.elapsed());
        return Ok(());
    }
    let mut picture = map::render_to_image(&buffers, &view, &options)?;
    for _ in 0..5 {
        let start = Instant::now();
        let scene = map::MapScene::new(&buffers, &view)?;
        let placed = start.elapsed();
        let ground = scene.ground(0..size_px[1]);
        let (seen, restart) = (start.elapsed(), Instant::now());
        picture = map::render_to_image(&buffers, &view, &options)?;
        let count = ground.points().iter().filter(|point| point.is_ground()).count();
        println!(
            "{} triangles, {count} px: placed {placed:?}, ground {seen:?}, picture {:?}",
            buffers.triangle_count(),
            restart.elapsed()
        );
    }
    picture.save(output)?;
    #[cfg(feature = "wgpu")]
    if has("gpu") {
        let gpu = yamanami_gpu::Gpu::headless()?;
        let mut mesh = yamanami_gpu::ResidentMesh::with_buffers(&gpu, buffers);
        mesh.flush()?;
        let mut renderer = yamanami_gpu::MapRenderer::new(&gpu);
        renderer.render_to_image(&mesh, &view, &options)?;
        let start = Instant::now();
        let drawn = renderer.render_to_image(&mesh, &view, &options)?;
        println!("on {} with read-back: {:?}", gpu.description(), start.elapsed());
        drawn.save(std::path::Path::new(output).with_extension("gpu.png"))?;
        let difference: u64 = drawn.iter().zip(picture.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        println!("mean difference to software: {:.4} of 255", difference as f64 / drawn.len() as f64);
    }
    Ok(())
}

/// Heights over the plane, the centre in the middle of the field; the low is sea.
struct Heights(HeightField);

impl Heights {
    fn at(&self, p: DVec2) -> f64 {
        let middle = (SIDE - 1) as f64 / 2.0;
        let at = (DVec2::new(p.x, -p.y) / SPACING_M + middle).clamp(DVec2::ZERO, DVec2::splat(2.0 * middle - 1e-6));
        let (column, row) = (at.x as usize, at.y as usize);
        let part = at - at.floor();
        // folded many times, a smooth relief becomes ridges and valleys
        let z = |dx, dy| {
            let folds = f64::from(self.0.heights_m()[(row + dy) * SIDE + column + dx]) / 200.0;
            2900.0 * (1.0 - 2.0 * (folds - folds.round()).abs()) - 700.0
        };
        let (upper, lower) = (z(0, 0) + (z(1, 0) - z(0, 0)) * part.x, z(0, 1) + (z(1, 1) - z(0, 1)) * part.x);
        (upper + (lower - upper) * part.y).max(0.0)
    }

    /// Tint and relief.
    fn texture(&self, reach_m: f64, side_px: u32) -> MapTexture {
        let step_m = 2.0 * reach_m / f64::from(side_px - 1);
        let colour = |i: u32| {
            let p = DVec2::new(f64::from(i % side_px) * step_m - reach_m, reach_m - f64::from(i / side_px) * step_m);
            let z = self.at(p);
            if z <= 0.0 {
                return [166, 200, 222, 255];
            }
            let d = step_m.max(SPACING_M);
            let slope = DVec2::new(self.at(p + DVec2::X * d) - z, self.at(p + DVec2::Y * d) - z) / d;
            let normal = DVec3::new(-slope.x, -slope.y, 0.6).normalize();
            let light = 0.35 + 0.75 * normal.dot(DVec3::new(-0.5, 0.5, 0.7)).max(0.0);
            let t = (z / 2000.0).min(1.0);
            let tint = DVec3::new(120.0, 165.0, 105.0).lerp(DVec3::new(235.0, 225.0, 205.0), t) * light;
            [tint.x as u8, tint.y as u8, tint.z as u8, 255]
        };
        MapTexture { reach_m, side_px, rgba: (0..side_px * side_px).flat_map(colour).collect() }
    }

    fn horizon(&self, deformed: &DeformedMap) -> Result<HorizonTable, Box<dyn Error>> {
        let (azimuths, step_m) = (2048u32, 200.0);
        let mut entries = Vec::new();
        for i in 0..azimuths {
            let (east, north) = (f64::from(i) / f64::from(azimuths) * std::f64::consts::TAU).sin_cos();
            let mut highest = 0f64;
            for j in 0..=(RIM_M / step_m) as u32 {
                let r_m = f64::from(j) * step_m;
                highest = highest.max(deformed.half_tangent(r_m, self.at(DVec2::new(east, north) * r_m)));
                entries.push(highest as f32);
            }
        }
        Ok(HorizonTable::new(azimuths, step_m, entries)?)
    }
}

/// 77,618 triangles, small near the centre and large far away.
fn mesh(heights: &Heights) -> TriangleMesh {
    let cells = 197u32;
    let place = |i: u32| {
        let t = 2.0 * f64::from(i) / f64::from(cells) - 1.0;
        (0.25 * t + 0.75 * t * t.abs()) * RIM_M
    };
    let mut mesh = TriangleMesh::default();
    for j in 0..=cells {
        for i in 0..=cells {
            let p = DVec2::new(place(i), place(j));
            mesh.positions.push(p.extend(heights.at(p)));
        }
    }
    let across = cells + 1;
    for j in 0..cells {
        for i in 0..cells {
            let [a, b, c, d] = [j * across + i, j * across + i + 1, (j + 1) * across + i, (j + 1) * across + i + 1];
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    mesh
}
