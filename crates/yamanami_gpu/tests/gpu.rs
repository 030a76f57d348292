//! The GPU's mesh equals the mirror, and its pictures those drawn in software. Without an adapter, a note says so.
#![cfg(feature = "wgpu")]

mod common;

use common::Walk;
use common::target::{drawn_on, mean_difference, plain_gpu};
use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;
use yamanami_core::{MeshMirror, Sink};
use yamanami_gpu::{
    ColourBy, Drape, Gpu, GpuError, Haze, MeshContents, Morph, RenderOptions, Renderer, ResidentBuffers, ResidentMesh,
    Shading, TRIANGLE_BYTES, VERTEX_BYTES, Wireframe, software,
};

fn gpu() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => {
            println!("on {}", gpu.description());
            Some(gpu)
        }
        Err(error) => {
            assert!(!error.to_string().contains('\n'), "one clear line");
            println!("skipped: {error}");
            None
        }
    }
}

#[test]
fn read_back_equals_the_mirror_over_growth_and_small_changes() {
    let Some(gpu) = gpu() else { return };
    check_read_back(&gpu, 1);
}

#[test]
fn without_compute_shaders_the_mesh_is_the_same_and_edges_are_left_out() {
    let Some(gpu) = plain_gpu() else { return };
    check_read_back(&gpu, 2048 / TRIANGLE_BYTES);
    let hills = common::hills(20, 5000.0);
    let mut mesh = ResidentMesh::with_buffers(&gpu, ResidentBuffers::from_mesh(&hills));
    mesh.flush().unwrap();
    let view = common::view_of(&hills, DVec3::new(0.3, -0.9, 0.6), [160, 100]);
    let options = RenderOptions { wireframe: Some(Wireframe::default()), ..RenderOptions::default() };
    let drawn = Renderer::new(&gpu).render_to_image(&mesh, &view, &options).unwrap();
    let reference = software::render_to_image(mesh.buffers(), &view, &RenderOptions::default()).unwrap();
    assert!(mean_difference(&drawn, &reference) < 0.6);
}

/// Changes a mesh in rounds large and small; small ones may upload `slack` times what changed.
fn check_read_back(gpu: &Gpu, slack: u64) {
    let origin = DVec3::new(3.0, 4.0, 5.0);
    let (mut mesh, mut mirror) = (ResidentMesh::new(gpu, origin), MeshMirror::default());
    let (mut walk, mut twin) = (Walk::default(), Walk::default());
    let mut code = 12345u32;
    for round in 0..12 {
        for _ in 0..if round % 3 == 0 { 3000 } else { 40 } {
            code = code.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Mostly growth at first, so that buffers have to double.
            let step = if round == 0 { code >> 9 & !7 | [0, 1, 3, 4][(code >> 7 & 3) as usize] } else { code >> 9 };
            walk.step(step, &mut mesh);
            twin.step(step, &mut mirror);
        }
        let stats = mesh.flush().unwrap();
        assert!(stats.grown_bytes > 0 || round > 0, "{stats:?}");
        if round % 3 != 0 {
            assert!(stats.vertex_bytes <= 8 + slack * 40 * (VERTEX_BYTES + 4), "{stats:?}");
            assert!(stats.index_bytes <= 8 + slack * 40 * (TRIANGLE_BYTES + 4), "{stats:?}");
        }
        assert_eq!(mesh.read_back().unwrap(), MeshContents::of_mirror(&mirror, origin), "round {round}");
    }
    let whole = mesh.upload_all().unwrap();
    assert_eq!(whole.index_bytes, mesh.buffers().triangle_count() as u64 * TRIANGLE_BYTES);
    assert_eq!(mesh.read_back().unwrap(), MeshContents::of_mirror(&mirror, origin));
}

#[test]
fn pictures_equal_those_drawn_in_software() {
    let Some(gpu) = gpu() else { return };
    let mut hills = common::hills(90, 5000.0);
    let bounds = hills.bounds();
    hills.colours = (0..hills.positions.len()).map(|i| [(i % 91 * 2) as u8, (i / 91 * 2) as u8, 120, 255]).collect();
    let mut mesh = ResidentMesh::with_buffers(&gpu, ResidentBuffers::from_mesh(&hills));
    mesh.flush().unwrap();
    let mut renderer = Renderer::new(&gpu);
    let board = RgbaImage::from_fn(96, 80, |x, y| {
        image::Rgba([(x * 2) as u8, (y * 3) as u8, if (x / 8 + y / 8) % 2 == 0 { 200 } else { 90 }, 255])
    });
    let drape = Drape::over_box(board, [bounds.min.x + 500.0, bounds.min.y], [bounds.max.x, bounds.max.y]);
    let base = RenderOptions::default();
    let styles = [
        ("height", base.clone()),
        ("one sample", RenderOptions { antialias: false, ..base.clone() }),
        ("plain", RenderOptions { colour: ColourBy::Plain([200, 190, 170]), ..base.clone() }),
        ("level", RenderOptions { colour: ColourBy::Level, ..base.clone() }),
        ("drape", RenderOptions { colour: ColourBy::Drape, drape: Some(Arc::new(drape)), ..base.clone() }),
        ("wire", RenderOptions { wireframe: Some(Wireframe::default()), ..base.clone() }),
        ("painted", RenderOptions { colour: ColourBy::Vertex, ..base.clone() }),
        ("slope", RenderOptions { colour: ColourBy::Slope, ..base.clone() }),
        ("aspect", RenderOptions { colour: ColourBy::Aspect, ..base.clone() }),
        ("flat aspect", RenderOptions { colour: ColourBy::Aspect, flat: true, ..base.clone() }),
        ("water", RenderOptions { water_level_m: Some(0.5 * (bounds.min.z + bounds.max.z)), ..base.clone() }),
        ("flat", RenderOptions { flat: true, ..base.clone() }),
        ("model", RenderOptions { shading: Shading::Model, haze: Haze::None, ..base.clone() }),
        ("flat model", RenderOptions { shading: Shading::Model, flat: true, ..base.clone() }),
        ("morph", RenderOptions { morph: Some(Morph { tau_px: 2.0, width: 0.5 }), ..base.clone() }),
    ];
    // from beside, near, above and below
    let views = [(0.3, -0.9, 0.6), (0.05, -0.1, 0.09), (-0.2, 0.1, 1.1), (0.4, 0.5, -0.7)].map(DVec3::from);
    for (name, options) in styles {
        for from in views {
            let view = common::view_of(&hills, from, [320, 200]);
            let drawn = renderer.render_to_image(&mesh, &view, &options).unwrap();
            let reference = software::render_to_image(mesh.buffers(), &view, &options).unwrap();
            let difference = mean_difference(&drawn, &reference);
            println!("{name} from {from}: mean difference {difference:.3} of 255");
            // Anisotropic filtering and hardware derivatives are the device's own business.
            let bound = if matches!(name, "drape" | "wire") { 2.0 } else { 0.6 };
            assert!(difference < bound, "{name} from {from}: {difference}");
        }
    }
}

#[test]
fn geomorphing_lowers_the_same_vertices_on_both() {
    let Some(gpu) = gpu() else { return };
    let hills = common::hills(40, 5000.0);
    let mut buffers = ResidentBuffers::new(hills.bounds().centre());
    for (id, &position) in (0u32..).zip(&hills.positions) {
        let mut vertex = common::vertex(id, 1);
        vertex.position = position;
        vertex.normal = [0.0, 0.0, 1.0];
        vertex.detail_m = if id % 2 == 0 { 0.0 } else { 120.0 };
        vertex.error_m = 30.0;
        vertex.bound_radius_m = 200.0;
        buffers.add_vertex(id, vertex);
    }
    for (key, &corners) in (0u64..).zip(&hills.triangles) {
        buffers.add_triangle(key, corners);
    }
    let mut mesh = ResidentMesh::with_buffers(&gpu, buffers);
    mesh.flush().unwrap();
    let view = common::view_of(&hills, DVec3::new(0.0, -0.9, 0.4), [320, 200]);
    let whole = RenderOptions::default();
    let fading = RenderOptions { morph: Some(Morph { tau_px: 1.0, width: 1.5 }), ..RenderOptions::default() };
    let reference = software::render_to_image(mesh.buffers(), &view, &fading).unwrap();
    let drawn = Renderer::new(&gpu).render_to_image(&mesh, &view, &fading).unwrap();
    let unfaded = software::render_to_image(mesh.buffers(), &view, &whole).unwrap();
    assert!(mean_difference(&drawn, &reference) < 0.6);
    assert!(mean_difference(&reference, &unfaded) > 1.0, "fading shows");
}

/// A window's texture often takes bytes as they are: the shaders then encode sRGB.
#[test]
fn a_target_without_srgb_shows_the_same_picture() {
    use yamanami_gpu::wgpu;
    let Some(gpu) = gpu() else { return };
    let hills = common::hills(30, 5000.0);
    let mut mesh = ResidentMesh::with_buffers(&gpu, ResidentBuffers::from_mesh(&hills));
    mesh.flush().unwrap();
    let view = common::view_of(&hills, DVec3::new(0.3, -0.9, 0.6), [128, 72]);
    let (format, options) = (wgpu::TextureFormat::Rgba8Unorm, RenderOptions::default());
    let drawn = drawn_on(&gpu, view.viewport_px, format, |target| {
        Renderer::new(&gpu).draw(target, format, &mesh, &view, &options).unwrap();
    });
    let reference = software::render_to_image(mesh.buffers(), &view, &options).unwrap();
    assert!(mean_difference(&drawn, &reference) < 1.0);
}

#[test]
fn sizes_that_cannot_be_drawn_and_empty_meshes_are_handled() {
    let Some(gpu) = gpu() else { return };
    let mut mesh = ResidentMesh::new(&gpu, DVec3::ZERO);
    mesh.flush().unwrap();
    let mut renderer = Renderer::new(&gpu);
    let view = common::view_of(&common::hills(2, 10.0), DVec3::new(0.0, -1.0, 1.0), [8, 8]);
    let options = RenderOptions { wireframe: Some(Wireframe::default()), ..RenderOptions::default() };
    assert!(renderer.render_to_image(&mesh, &view, &options).is_ok());
    let too_wide = yamanami_core::View { viewport_px: [1 << 20, 8], ..view };
    let error = renderer.render_to_image(&mesh, &too_wide, &options).unwrap_err();
    assert!(matches!(error, GpuError::PictureSize { .. }));
}
