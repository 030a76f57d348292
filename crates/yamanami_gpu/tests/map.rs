//! Deformed maps drawn in software: the right ground at every pixel, no cracks, the same whatever the threads.

mod common;

use common::maps::{Mountains, RIM_M, SPACING_M, view};
use glam::{DVec2, DVec3};
use image::RgbaImage;
use std::sync::Arc;
use yamanami_core::{DeformedMap, MapView, TriangleMesh};
use yamanami_gpu::{
    GpuError, Hidden, HorizonTable, MapOptions, ResidentBuffers, Veil, Wireframe,
    software::map::{GroundBuffer, MapPainter, MapScene, render_to_image},
};

fn ground(buffers: &ResidentBuffers, view: &MapView) -> GroundBuffer {
    MapScene::new(buffers, view).unwrap().ground(0..view.size_px[1])
}

fn middle(column: u32, row: u32) -> DVec2 {
    DVec2::new(f64::from(column), f64::from(row)) + 0.5
}

#[test]
fn every_pixel_shows_the_nearest_ground_that_is_drawn_there() {
    let mountains = Mountains::new();
    let buffers = ResidentBuffers::from_mesh(&mountains.mesh());
    for alpha in [0.0, 0.3] {
        let view = MapView { up_azimuth_rad: 0.4, ..view(alpha, [301, 257]) };
        let seen = ground(&buffers, &view);
        let (mut shown, mut farthest_px) = (0, 0f64);
        for row in 0..257 {
            for column in 0..301 {
                let at = view.image_from_px(middle(column, row));
                let Some(point) = seen.at(column, row) else {
                    assert!(at.length() > view.map.rho(RIM_M, 0.0) - 2.0 / view.ring_px, "a hole at {column}, {row}");
                    continue;
                };
                let p = DVec3::new(point.x_m.into(), point.y_m.into(), point.z_m.into());
                farthest_px = farthest_px.max((view.px_from_plane(p) - middle(column, row)).length());
                assert!((mountains.at(p.truncate()) - p.z).abs() < 1.0, "on the mesh");
                assert!((point.depth_key(&view) - view.depth_key(p)).abs() < 1e-6 && view.depth_key(p) <= 1.0 + 1e-6);
                let [a, b, c] = buffers.triangles()[point.triangle as usize].map(|v| v as usize);
                let corner = |i: usize| (buffers.vertices()[i].local().as_dvec3() + buffers.origin()).truncate();
                let middle = (corner(a) + corner(b) + corner(c)) / 3.0;
                assert!((middle - p.truncate()).length() < SPACING_M, "in its triangle");
                shown += 1;
                if (row + column) % 16 == 0 {
                    // the first ground outward that reaches so far out in the picture
                    let (out, px) = (at.normalize(), 1.0 / view.ring_px);
                    let first = |rho: f64| {
                        let rises = |&r_m: &f64| view.map.rho(r_m, mountains.at(out * r_m)) >= rho;
                        (0..).map(|i| f64::from(i) * 50.0).take_while(|&r_m| r_m < RIM_M).find(rises).unwrap_or(RIM_M)
                    };
                    let (from_m, to_m) = (first(at.length() - px), first(at.length() + px));
                    let r_m = p.truncate().length();
                    assert!((from_m - 150.0..to_m + 150.0).contains(&r_m), "{r_m} outside {from_m} to {to_m}");
                }
            }
        }
        // inside a triangle places run straight, which the projection does not
        assert!(shown > 40_000 && farthest_px < 1.0, "{shown} pixels, off by up to {farthest_px} px");
    }
}

#[test]
fn each_pixel_belongs_to_one_of_adjoining_triangles() {
    // all plane: nothing is drawn over anything
    let view = MapView { centre_px: DVec2::new(40.0, 40.0), ..view(1.0, [80, 80]) };
    // corners on pixel middles and off them
    let step_m = 2.0 * view.map.ring_m / view.ring_px;
    let positions: Vec<DVec3> = (0..49)
        .map(|i| {
            let shift = if i % 3 == 0 { 0.37 } else { 0.0 };
            let place = |v: i32| (f64::from(v - 3) * 5.0 + 0.25 + shift) * step_m;
            DVec3::new(place(i % 7), place(i / 7), 0.0)
        })
        .collect();
    let cells = (0..36u32).map(|i| i / 6 * 7 + i % 6);
    let triangles: Vec<[u32; 3]> = cells.flat_map(|a| [[a, a + 1, a + 8], [a, a + 8, a + 7]]).collect();
    let count = |triangles: Vec<[u32; 3]>| {
        let buffers = ResidentBuffers::from_mesh(&TriangleMesh::new(positions.clone(), triangles));
        ground(&buffers, &view).points().iter().filter(|point| point.is_ground()).count()
    };
    let apart: usize = triangles.iter().map(|&triangle| count(vec![triangle])).sum();
    assert_eq!(apart, count(triangles));
    assert!(apart > 3000, "{apart}");
}

#[test]
fn strips_and_threads_change_nothing() {
    let mountains = Mountains::new();
    let buffers = ResidentBuffers::from_mesh(&mountains.mesh());
    let view = view(0.0, [150, 131]);
    let options = MapOptions {
        textures: mountains.textures(),
        wireframe: Some(Wireframe::default()),
        antialias: true,
        ..MapOptions::default()
    };
    let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let whole = on(3).install(|| (ground(&buffers, &view), render_to_image(&buffers, &view, &options).unwrap()));
    let strips = on(1).install(|| {
        let (scene, painter) =
            (MapScene::new(&buffers, &view).unwrap(), MapPainter::new(&buffers, &view, &options).unwrap());
        let (mut points, mut bytes) = (Vec::new(), Vec::new());
        for rows in [0..1, 1..37, 37..37, 37..100, 100..999] {
            let strip = scene.ground(rows.clone());
            assert_eq!(strip.rows(), rows.start..rows.end.min(131));
            points.extend_from_slice(strip.points());
            bytes.extend(painter.paint_rows(rows));
        }
        (points, bytes)
    });
    // NaN is not itself
    let bits = |points: &[yamanami_gpu::software::map::GroundPoint]| -> Vec<[u32; 4]> {
        points.iter().map(|p| [p.x_m.to_bits(), p.y_m.to_bits(), p.z_m.to_bits(), p.triangle]).collect()
    };
    assert_eq!(bits(whole.0.points()), bits(&strips.0));
    assert_eq!(whole.1.as_raw(), &strips.1);
}

/// Level ground with a wall of 2 km across the north, 20 km away.
fn wall() -> ResidentBuffers {
    let mut mesh = TriangleMesh::default();
    for j in 0..=120u32 {
        for i in 0..=120u32 {
            let p = DVec2::new(f64::from(i), f64::from(j)) * 1000.0 - 60e3;
            mesh.positions.push(p.extend(if j == 80 { 2000.0 } else { 0.0 }));
        }
    }
    for a in (0..120 * 121).filter(|a| a % 121 != 120) {
        mesh.triangles.extend([[a, a + 1, a + 122], [a, a + 122, a + 121]]);
    }
    ResidentBuffers::from_mesh(&mesh)
}

/// What the wall leaves to be seen, along azimuths all round.
fn walled_horizon(map: &DeformedMap) -> Arc<HorizonTable> {
    let entries = (0..360).flat_map(|degree| {
        let north = f64::from(degree).to_radians().cos();
        (0..=600).map(move |i| (north, f64::from(i) * 100.0))
    });
    let highest = entries.map(|(north, r_m)| {
        let wall_m = 20e3 / north;
        let seen = map.half_tangent(r_m, 0.0);
        let behind = north > 0.0 && r_m >= wall_m;
        (if behind { seen.max(map.half_tangent(wall_m, 2000.0)) } else { seen }) as f32
    });
    Arc::new(HorizonTable::new(360, 100.0, highest.collect()).unwrap())
}

#[test]
fn ground_behind_others_is_veiled_or_dropped() {
    let buffers = wall();
    let view = view(0.5, [400, 400]);
    let veiled = |hidden| {
        let veil = Veil { horizon: walled_horizon(&view.map), hidden, slack_px: 1.0 };
        let options = MapOptions { ground: [0, 120, 0, 255], veil: Some(veil), ..MapOptions::default() };
        render_to_image(&buffers, &view, &options).unwrap()
    };
    let pixel = |picture: &RgbaImage, x_m: f64, y_m: f64| {
        let px = view.px_from_plane(DVec3::new(x_m, y_m, 0.0));
        picture.get_pixel(px.x as u32, px.y as u32).0
    };
    let (mixed, dropped) = (veiled(Hidden::Veiled([200, 0, 0], 0.5)), veiled(Hidden::Dropped));
    for (x_m, y_m) in [(0.0, 23e3), (3e3, 22.5e3)] {
        assert_eq!(pixel(&mixed, x_m, y_m), [100, 60, 0, 255], "behind the wall");
        assert_eq!(pixel(&dropped, x_m, y_m)[3], 0);
    }
    for (x_m, y_m) in [(0.0, 5e3), (0.0, 17e3), (0.0, -40e3), (40e3, -3e3), (3e3, 55e3)] {
        assert_eq!(pixel(&mixed, x_m, y_m), [0, 120, 0, 255], "seen from above at {x_m}, {y_m}");
        assert_eq!(pixel(&dropped, x_m, y_m), [0, 120, 0, 255]);
    }
}

#[test]
fn edges_show_where_they_are_seen() {
    let buffers = wall();
    let view = view(0.0, [600, 600]);
    let wireframe = Some(Wireframe { colour: [0; 3], opacity: 1.0, width_px: 1.0 });
    let options = MapOptions { ground: [255; 4], wireframe, ..MapOptions::default() };
    let picture = render_to_image(&buffers, &view, &options).unwrap();
    let shade = |px: DVec2| picture.get_pixel(px.x as u32, px.y as u32).0[0];
    let (mut on, mut off) = (0, 0);
    for i in 0..8 {
        // along an edge of the plain map, and through the middle of cells; a line's middle may lie between two pixels
        let y_m = f64::from(i) * 1000.0 + 370.0;
        on += u32::from(255 - shade(view.px_from_plane(DVec3::new(2000.0, y_m, 0.0))));
        off += u32::from(255 - shade(view.px_from_plane(DVec3::new(2500.0, y_m, 0.0))));
    }
    assert!(on > 8 * 60 && off < 8 * 20, "{on} on edges, {off} off");
}

#[test]
fn the_border_is_soft_when_antialiased_and_the_background_fills_up() {
    let buffers = wall();
    let view = view(1.0, [200, 200]);
    let options = MapOptions { ground: [10, 200, 30, 255], antialias: true, ..MapOptions::default() };
    let clear = render_to_image(&buffers, &view, &options).unwrap();
    assert_eq!(clear.get_pixel(0, 0).0, [0; 4]);
    let soft = clear.pixels().filter(|p| (1..255).contains(&p.0[3]));
    assert!(soft.clone().count() > 100 && soft.clone().all(|p| p.0[..3] == [10, 200, 30]), "straight alpha");
    let hard = render_to_image(&buffers, &view, &MapOptions { antialias: false, ..options.clone() }).unwrap();
    assert!(hard.pixels().all(|p| p.0[3] == 0 || p.0[3] == 255));
    let on_white = render_to_image(&buffers, &view, &MapOptions { background: [255; 4], ..options }).unwrap();
    assert!(on_white.pixels().all(|p| p.0[3] == 255));
    assert_eq!(on_white.get_pixel(0, 0).0, [255; 4]);
}

#[test]
fn odd_views_are_an_error_or_a_picture_never_a_panic() {
    let buffers = wall();
    let view = view(0.0, [40, 40]);
    let options = MapOptions { antialias: true, ..MapOptions::default() };
    for size_px in [[0, 5], [5, 1 << 20]] {
        let sized = MapView { size_px, ..view };
        assert!(matches!(render_to_image(&buffers, &sized, &options), Err(GpuError::PictureSize { .. })));
    }
    let map = view.map;
    for view in [
        MapView { ring_px: 1e12, ..view },
        MapView { ring_px: f64::NAN, ..view },
        MapView { ring_px: -3.0, ..view },
        MapView { rim_m: 0.0, ..view },
        MapView { rim_m: f64::INFINITY, ..view },
        MapView { centre_px: DVec2::splat(1e300), ..view },
        MapView { up_azimuth_rad: f64::INFINITY, ..view },
        MapView { map: DeformedMap { ring_m: 0.0, ..map }, ..view },
        MapView { map: DeformedMap { eye_m: -1e9, ..map }, ..view },
        MapView { map: DeformedMap { centre: DVec2::NAN, ..map }, ..view },
    ] {
        assert!(render_to_image(&buffers, &view, &options).is_ok());
    }
    let nothing = ResidentBuffers::new(DVec3::ZERO);
    assert!(render_to_image(&nothing, &view, &options).unwrap().pixels().all(|p| p.0 == [0; 4]));
    assert!(ground(&nothing, &view).at(3, 3).is_none());
}
