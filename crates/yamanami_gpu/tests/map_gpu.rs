//! Deformed maps drawn on a GPU are those drawn in software. Without an adapter, a note says so.
#![cfg(feature = "wgpu")]

mod common;

use common::maps::{Mountains, view};
use common::target::{drawn_on, mean_difference, plain_gpu};
use std::sync::Arc;
use yamanami_core::{Curvature, DeformedMap, DropFrom, MapView};
use yamanami_gpu::{
    Gpu, GpuError, Hidden, HorizonTable, MapOptions, MapRenderer, MapTexture, MapTextures, ResidentBuffers,
    ResidentMesh, Veil, Wireframe, software::map::render_to_image, wgpu,
};

fn gpu() -> Option<Gpu> {
    Gpu::headless().inspect_err(|error| println!("skipped: {error}")).ok()
}

#[test]
fn pictures_equal_those_drawn_in_software() {
    let Some(gpu) = gpu() else { return };
    let mountains = Mountains::new();
    let mut mesh = ResidentMesh::with_buffers(&gpu, ResidentBuffers::from_mesh(&mountains.mesh()));
    mesh.flush().unwrap();
    let mut renderer = MapRenderer::new(&gpu);
    let base = MapOptions { textures: mountains.textures(), ..MapOptions::default() };
    let plain = MapOptions { ground: [90, 140, 70, 255], background: [250, 248, 240, 255], ..MapOptions::default() };
    let curvature = Some(Curvature { refraction: 0.13, from: DropFrom::Ring });
    let sphere = MapView { up_azimuth_rad: 0.3, ..view(0.0, [220, 200]) };
    let between = view(0.4, [220, 200]);
    let bent = DeformedMap { curvature, exaggeration: 1.2, alpha_fall: 1.5, ..between.map };
    // so low an eye that much is hidden
    let low = MapView { map: DeformedMap { ring_m: 5e3, eye_m: 2e3, ..between.map }, ring_px: 14.0, ..between };
    let horizon = mountains.horizon(&low.map);
    let veil = |hidden| Some(Veil { horizon: Arc::clone(&horizon), hidden, slack_px: 0.1 });
    let veiled = MapOptions { veil: veil(Hidden::Veiled([230, 230, 240], 0.8)), ..base.clone() };
    let dropped = MapOptions { veil: veil(Hidden::Dropped), ..base.clone() };
    let unveiled = render_to_image(mesh.buffers(), &low, &base).unwrap();
    assert!(mean_difference(&unveiled, &render_to_image(mesh.buffers(), &low, &dropped).unwrap()) > 2.0);
    let wire = MapOptions { wireframe: Some(Wireframe::default()), ..plain.clone() };
    let fine = MapOptions { antialias: true, ..plain.clone() };
    let close = MapView { ring_px: 600.0, centre_px: glam::DVec2::new(-450.0, 270.0), ..sphere };
    for (name, view, options, bound) in [
        ("sphere", &sphere, &base, 0.3),
        ("close", &close, &base, 0.3),
        ("between", &between, &base, 0.3),
        ("curved", &MapView { map: bent, ..between }, &base, 0.3),
        ("plain", &sphere, &plain, 0.1),
        ("veiled", &low, &veiled, 0.3),
        ("dropped", &low, &dropped, 0.3),
        ("wire", &close, &wire, 1.0),
        ("fine", &sphere, &fine, 0.3),
        ("fine pictures", &sphere, &MapOptions { antialias: true, ..base.clone() }, 1.0),
    ] {
        let drawn = renderer.render_to_image(&mesh, view, options).unwrap();
        let reference = render_to_image(mesh.buffers(), view, options).unwrap();
        let difference = mean_difference(&drawn, &reference);
        println!("{name}: mean difference {difference:.3} of 255");
        assert!(difference < bound, "{name}: {difference}");
    }
}

#[test]
fn without_storage_buffers_the_map_is_the_same_and_edges_are_left_out() {
    let Some(gpu) = plain_gpu() else { return };
    let mountains = Mountains::new();
    let mut mesh = ResidentMesh::with_buffers(&gpu, ResidentBuffers::from_mesh(&mountains.mesh()));
    mesh.flush().unwrap();
    let options = MapOptions { textures: mountains.textures(), ..MapOptions::default() };
    let edged = MapOptions { wireframe: Some(Wireframe::default()), ..options.clone() };
    let view = view(0.0, [120, 110]);
    let drawn = MapRenderer::new(&gpu).render_to_image(&mesh, &view, &edged).unwrap();
    assert!(mean_difference(&drawn, &render_to_image(mesh.buffers(), &view, &options).unwrap()) < 0.3);
}

/// A window's texture often takes bytes as they are: the shaders then leave sRGB as it is.
#[test]
fn a_target_without_srgb_shows_the_same_picture() {
    let Some(gpu) = gpu() else { return };
    let mountains = Mountains::new();
    let mut mesh = ResidentMesh::with_buffers(&gpu, ResidentBuffers::from_mesh(&mountains.mesh()));
    mesh.flush().unwrap();
    let (view, format) = (view(0.0, [192, 180]), wgpu::TextureFormat::Rgba8Unorm);
    let options =
        MapOptions { textures: mountains.textures(), background: [255, 250, 240, 255], ..MapOptions::default() };
    let drawn = drawn_on(&gpu, view.size_px, format, |target| {
        MapRenderer::new(&gpu).draw(target, format, &mesh, &view, &options).unwrap();
    });
    assert!(mean_difference(&drawn, &render_to_image(mesh.buffers(), &view, &options).unwrap()) < 0.3);
}

#[test]
fn what_does_not_fit_is_refused_and_an_empty_mesh_is_the_background() {
    let Some(gpu) = gpu() else { return };
    let mut mesh = ResidentMesh::new(&gpu, glam::DVec3::ZERO);
    mesh.flush().unwrap();
    let mut renderer = MapRenderer::new(&gpu);
    let small = view(0.0, [20, 10]);
    let options = MapOptions {
        background: [200, 100, 50, 128],
        wireframe: Some(Wireframe::default()),
        antialias: true,
        ..MapOptions::default()
    };
    let empty = renderer.render_to_image(&mesh, &small, &options).unwrap();
    assert!(empty.pixels().all(|p| p.0[3] == 128 && p.0[0].abs_diff(200) < 3 && p.0[2].abs_diff(50) < 3));
    let wide = MapView { size_px: [1 << 20, 8], ..small };
    assert!(matches!(renderer.render_to_image(&mesh, &wide, &options), Err(GpuError::PictureSize { .. })));
    let limit_px = gpu.device().limits().max_texture_dimension_2d;
    let long = HorizonTable::new(1, 1.0, vec![0.0; limit_px as usize + 1]).unwrap();
    let veil = Some(Veil { horizon: Arc::new(long), hidden: Hidden::Dropped, slack_px: 1.0 });
    let error = renderer.render_to_image(&mesh, &small, &MapOptions { veil, ..options.clone() }).unwrap_err();
    assert!(matches!(error, GpuError::TextureTooLarge { what: "horizon table", .. }), "{error}");
    // and afterwards all is well
    let texture = MapTexture { reach_m: 10.0, side_px: 3, rgba: vec![255; 36] };
    let textures = Arc::new(MapTextures::new(vec![texture]).unwrap());
    assert!(renderer.render_to_image(&mesh, &small, &MapOptions { textures, ..options }).is_ok());
}
