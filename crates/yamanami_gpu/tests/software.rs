//! Pictures drawn in software: no cracks, the right side lit, the same whatever the threads.

mod common;

use glam::DVec3;
use image::RgbaImage;
use std::sync::Arc;
use yamanami_core::{TriangleMesh, View};
use yamanami_gpu::{
    Background, ColourBy, Drape, GpuError, Haze, Morph, RenderOptions, ResidentBuffers, Shading, Wireframe, software,
};

const RED: [u8; 3] = [255, 0, 0];

fn on_red() -> RenderOptions {
    RenderOptions {
        colour: ColourBy::Plain([0, 0, 255]),
        background: Background::Plain(RED),
        haze: Haze::None,
        ..RenderOptions::default()
    }
}

#[test]
fn a_surface_that_fills_the_view_has_no_crack() {
    let mesh = common::hills(60, 1000.0);
    let buffers = ResidentBuffers::from_mesh(&mesh);
    let bounds = mesh.bounds();
    // Close above the ground and looking down, so that large triangles cross the border of the picture and lie beside and
    // behind the eye.
    for (height_m, tilt_m) in [(150.0, 0.1), (60.0, 20.0), (12.0, 9.0), (2.0, 0.5)] {
        let ground = DVec3::new(bounds.centre().x + 33.3, bounds.centre().y + 21.7, bounds.max.z);
        let eye = ground + DVec3::Z * height_m;
        let view = View {
            eye,
            target: ground + DVec3::new(tilt_m, 0.3 * tilt_m, 0.0),
            fov_y_rad: 1.0,
            viewport_px: [211, 173],
        };
        assert_eq!(software::covered_pixels(&buffers, &view).unwrap(), 211 * 173, "from {height_m} m");
        let picture = software::render_to_image(&buffers, &view, &on_red()).unwrap();
        assert!(picture.pixels().all(|p| p.0[0] == 0 && p.0[2] > 0), "background shows from {height_m} m");
    }
}

#[test]
fn triangles_through_the_eye_are_cut_without_a_gap() {
    // A floor far larger than the picture, one of its corners behind the eye.
    let mesh = TriangleMesh {
        positions: vec![
            DVec3::new(-1e4, -1e4, 0.0),
            DVec3::new(1e4, -1e4, 0.0),
            DVec3::new(1e4, 1e4, 0.0),
            DVec3::new(-1e4, 1e4, 0.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..TriangleMesh::default()
    };
    let buffers = ResidentBuffers::from_mesh(&mesh);
    let eye = DVec3::new(1.7, -3.1, 2.0);
    let view = View { eye, target: eye + DVec3::new(1.0, 0.9, -1.2), fov_y_rad: 1.0, viewport_px: [160, 120] };
    assert_eq!(software::covered_pixels(&buffers, &view).unwrap(), 160 * 120);
}

#[test]
fn covered_pixels_are_those_of_the_geometry() {
    // A square of 2 x 2 m seen squarely from 10 m away.
    let positions = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let mesh =
        TriangleMesh { positions: positions.into(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..TriangleMesh::default() };
    let buffers = ResidentBuffers::from_mesh(&mesh);
    let view =
        View { eye: DVec3::Z * 10.0, target: DVec3::ZERO, fov_y_rad: 2.0 * 0.25f64.atan(), viewport_px: [400, 200] };
    // 200 px stand for 5 m, so 2 m are 80 px.
    assert_eq!(software::covered_pixels(&buffers, &view).unwrap(), 80 * 80);
    assert_eq!(software::covered_pixels(&ResidentBuffers::new(DVec3::ZERO), &view).unwrap(), 0);
}

#[test]
fn pictures_repeat_exactly_on_any_number_of_threads() {
    let mesh = common::hills(50, 1000.0);
    let buffers = ResidentBuffers::from_mesh(&mesh);
    let view = common::view_of(&mesh, DVec3::new(0.2, -0.9, 0.5), [161, 97]);
    let options = RenderOptions { wireframe: Some(Wireframe::default()), ..RenderOptions::default() };
    let draw = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| software::render_to_image(&buffers, &view, &options)).unwrap()
    };
    assert_eq!(draw(1), draw(3));
}

#[test]
fn hills_are_lit_from_the_north_west() {
    // A tent with its ridge from south-west to north-east, seen from above: the north-western side is lighter.
    let positions =
        [(-1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, -0.7), (1.0, -1.0, -0.7)].map(|(x, y, z)| DVec3::new(x, y, z));
    let (ridge_nw, ridge_se) = ([0, 1, 2], [0, 3, 1]);
    let mean = |triangle| {
        let mesh = TriangleMesh { positions: positions.into(), triangles: vec![triangle], ..TriangleMesh::default() };
        let view = View { eye: DVec3::Z * 5.0, target: DVec3::ZERO, fov_y_rad: 0.5, viewport_px: [64, 64] };
        let options = RenderOptions { colour: ColourBy::Plain([128; 3]), ..on_red() };
        let picture = software::render_to_image(&ResidentBuffers::from_mesh(&mesh), &view, &options).unwrap();
        let lit: Vec<u32> = picture.pixels().filter(|p| p.0[2] > 0).map(|p| u32::from(p.0[1])).collect();
        lit.iter().sum::<u32>() / lit.len() as u32
    };
    assert!(mean(ridge_nw) > mean(ridge_se) + 40);
}

#[test]
fn morphing_at_weight_zero_draws_the_coarser_mesh() {
    use yamanami_core::{Sink, SurfaceVertex};
    let mesh = common::hills(1, 100.0);
    let centre = mesh.bounds().centre();
    let vertex = |position, detail_m, error_m| SurfaceVertex {
        position,
        normal: [0.0, 0.0, 1.0],
        detail_m,
        error_m,
        bound_radius_m: 0.0,
        level: 0,
        colour: [255; 3],
    };
    let flat: Vec<DVec3> = mesh.positions.iter().map(|p| DVec3::new(p.x, p.y, centre.z)).collect();
    let tent = |lift_m: f64| {
        let mut buffers = ResidentBuffers::new(centre);
        for (id, &p) in (0u32..).zip(&flat) {
            buffers.add_vertex(id, vertex(p, 0.0, f32::INFINITY));
        }
        buffers.add_vertex(9, vertex(centre + DVec3::Z * lift_m, lift_m as f32, 0.5));
        for (key, corners) in [[0, 1, 9], [1, 3, 9], [3, 2, 9], [2, 0, 9]].into_iter().enumerate() {
            buffers.add_triangle(key as u64, corners);
        }
        buffers
    };
    let view = common::view_of(&mesh, DVec3::new(0.0, -1.5, 0.4), [96, 64]);
    let draw = |lift_m, morph| {
        let tint_range_m = Some([centre.z - 50.0, centre.z + 50.0]);
        let depth_planes_m = Some([1.0, 1000.0]);
        let options =
            RenderOptions { morph, tint_range_m, depth_planes_m, haze: Haze::None, ..RenderOptions::default() };
        software::render_to_image(&tent(lift_m), &view, &options).unwrap()
    };
    let never = Some(Morph { tau_px: 1e6, width: 1.0 });
    assert_eq!(draw(30.0, never), draw(0.0, None), "at weight 0 the tent lies flat");
    assert_ne!(draw(30.0, None), draw(0.0, None));
    assert_eq!(draw(30.0, Some(Morph { tau_px: 1e-6, width: 1.0 })), draw(30.0, None), "at weight 1 it stands");
}

#[test]
fn an_image_lies_the_right_way_round() {
    let mesh = common::hills(8, 1000.0);
    let bounds = mesh.bounds();
    // Red in the north-west, green in the north-east, blue in the south.
    let image = RgbaImage::from_fn(64, 64, |x, y| {
        image::Rgba(match (x < 32, y < 32) {
            (true, true) => [255, 0, 0, 255],
            (false, true) => [0, 255, 0, 255],
            _ => [0, 0, 255, 255],
        })
    });
    let drape = Drape::over_box(image, [bounds.min.x, bounds.min.y], [bounds.max.x, bounds.max.y]);
    let options = RenderOptions { colour: ColourBy::Drape, drape: Some(Arc::new(drape)), ..RenderOptions::default() };
    let view = common::view_of(&mesh, DVec3::Z * 1.2, [90, 90]);
    let picture = software::render_to_image(&ResidentBuffers::from_mesh(&mesh), &view, &options).unwrap();
    let strongest = |x, y| (0..3).max_by_key(|&c| picture.get_pixel(x, y).0[c]);
    assert_eq!([strongest(30, 30), strongest(60, 30), strongest(30, 60), strongest(60, 60)], [0, 1, 2, 2].map(Some));
}

#[test]
fn odd_input_is_an_error_or_a_picture_never_a_panic() {
    let mesh = common::hills(3, 10.0);
    let buffers = ResidentBuffers::from_mesh(&mesh);
    let view = common::view_of(&mesh, DVec3::new(0.1, -1.0, 0.4), [16, 16]);
    let options = RenderOptions::default();
    let sized = |viewport_px| software::render_to_image(&buffers, &View { viewport_px, ..view }, &options);
    assert!(matches!(sized([0, 16]), Err(GpuError::PictureSize { .. })));
    assert!(matches!(sized([16, 1 << 30]), Err(GpuError::PictureSize { .. })));
    for view in [
        View { eye: view.target, ..view },
        View { eye: DVec3::NAN, ..view },
        View { fov_y_rad: 0.0, ..view },
        View { fov_y_rad: 7.0, ..view },
        View { eye: DVec3::splat(1e300), ..view },
        View { target: DVec3::INFINITY, ..view },
    ] {
        assert!(software::render_to_image(&buffers, &view, &options).is_ok());
    }
    let broken = TriangleMesh {
        positions: vec![DVec3::NAN, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2], [0, 1, 77], [1, 1, 1]],
        ..TriangleMesh::default()
    };
    assert!(software::render_to_image(&ResidentBuffers::from_mesh(&broken), &view, &options).is_ok());
}

/// A square of 2 x 2 m in the plane x = 0 with its outside to the east, its halves red and blue.
fn board() -> TriangleMesh {
    let positions = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(y, z)| DVec3::new(0.0, y, z));
    let red = [200, 0, 0, 255];
    let mut mesh = TriangleMesh::new(positions.into(), vec![[0, 1, 2], [0, 2, 3]]);
    mesh.colours = vec![red, red, red, [0, 0, 200, 255]];
    mesh
}

fn from(eye: DVec3) -> View {
    View { eye, target: DVec3::ZERO, fov_y_rad: 0.6, viewport_px: [64, 64] }
}

#[test]
fn models_show_their_colours_and_their_insides_darker() {
    let buffers = ResidentBuffers::from_mesh(&board());
    let style = RenderOptions {
        colour: ColourBy::Vertex,
        shading: Shading::Model,
        haze: Haze::None,
        ..RenderOptions::default()
    };
    let outside = software::render_to_image(&buffers, &from(DVec3::X * 5.0), &style).unwrap();
    let inside = software::render_to_image(&buffers, &from(DVec3::X * -5.0), &style).unwrap();
    // the red half is at the lower right from outside, at the lower left from within
    let (front, back) = (outside.get_pixel(40, 40).0, inside.get_pixel(23, 40).0);
    assert!(front[0] > 150 && front[1] < 10 && front[2] < 10, "{front:?}");
    assert!(back[0] < front[0] - front[0] / 4 && back[0] > 40 && back[2] < 10, "{back:?}");
    let blue = outside.get_pixel(18, 18).0;
    assert!(blue[2] > blue[0], "{blue:?}");
}

#[test]
fn flat_shading_does_not_ask_the_vertices() {
    let mut mesh = board();
    let options = RenderOptions { flat: true, shading: Shading::Model, ..on_red() };
    let draw = |mesh: &TriangleMesh, flat| {
        let options = RenderOptions { flat, ..options.clone() };
        software::render_to_image(&ResidentBuffers::from_mesh(mesh), &from(DVec3::X * 5.0), &options).unwrap()
    };
    let (flat, smooth) = (draw(&mesh, true), draw(&mesh, false));
    assert_eq!(flat, smooth, "the board is flat");
    mesh.normals = vec![[0.0, 1.0, 0.0]; 4];
    assert_eq!(draw(&mesh, true), flat);
    assert_ne!(draw(&mesh, false), flat);
}

#[test]
fn tiny_models_are_drawn_like_large_ones() {
    let draw = |scale: f64| {
        let mut mesh = board();
        mesh.positions.iter_mut().for_each(|p| *p *= scale);
        let view = from(DVec3::new(4.0, -3.0, 2.0) * scale);
        let options = RenderOptions { shading: Shading::Model, ..on_red() };
        software::render_to_image(&ResidentBuffers::from_mesh(&mesh), &view, &options).unwrap()
    };
    assert_eq!(draw(1.0), draw(2f64.powi(-17)));
}

#[test]
fn a_view_sees_what_is_in_front() {
    // a small board behind a large one, and one beside it
    let mut mesh = board();
    let behind = board();
    for (offset, scale) in [(DVec3::new(-1.0, 0.0, 0.0), 0.5), (DVec3::new(-1.0, 1.6, 0.0), 0.3)] {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(behind.positions.iter().map(|&p| p * scale + offset));
        mesh.triangles.extend(behind.triangles.iter().map(|t| t.map(|c| c + first)));
    }
    let seen = software::visibility(&ResidentBuffers::from_mesh(&mesh), &from(DVec3::X * 5.0)).unwrap();
    assert_eq!(seen.may_be_seen, [true, true, false, false, true, true]);
    assert!(seen.samples[0] > 100 && seen.samples[2] == 0 && seen.samples[4] > 10, "{:?}", seen.samples);
}
