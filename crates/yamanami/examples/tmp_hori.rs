//! Trial.
use glam::DVec2;
use std::time::Instant;
use yamanami::core::*;
use yamanami::measure::projected_error;
use yamanami::{DeformedScene, DrawWith};
use yamanami_multires::rtin::BuildOptions;

fn report(name: &str, scene: &DeformedScene, view: &MapView) {
    let t = Instant::now();
    let mesh = scene.mesh();
    let r = projected_error(view, scene.field().widest(), &mesh.positions, &mesh.triangles);
    let inside = mesh
        .triangles
        .iter()
        .filter(|t| {
            let c: glam::DVec3 = t.iter().map(|&v| mesh.positions[v as usize]).sum::<glam::DVec3>() / 3.0;
            (c.truncate() - view.map.centre).length() <= view.rim_m
        })
        .count();
    println!(
        "{name}: {} triangles ({inside} within the rim) max {:.2} p99.9 {:.2} rms {:.3} >3.5 {:.4} % >1.5 {:.3} % (measured in {:?})",
        mesh.triangles.len(),
        r.far.max_px,
        r.far.p999_px,
        r.far.rms_px,
        100.0 * r.far.over_large,
        100.0 * r.far.over_split,
        t.elapsed()
    );
}

fn main() {
    let half = 1024u32;
    let n = 2 * half as usize + 1;
    let mut field: Vec<f32> = yamanami_testkit::SyntheticTerrain::mountains(n, n, 7).to_field().into_heights_m();
    if std::env::args().any(|a| a == "sea") {
        for z in &mut field {
            *z = (*z - 600.0).max(0.0);
        }
    }
    let (lo, hi) = field.iter().fold((f32::MAX, f32::MIN), |(a, b), &z| (a.min(z), b.max(z)));
    for z in &mut field {
        *z = (*z - lo) / (hi - lo) * 3000.0;
    }
    if std::env::args().any(|a| a == "half") {
        for z in &mut field {
            *z = (*z - 1400.0).max(0.0) * 1.8;
        }
    }
    let mut s = 0.0f64;
    let mut c = 0.0;
    for r in (0..n - 4).step_by(4) {
        for k in (0..n - 4).step_by(4) {
            let d = (field[r * n + k + 2] - 0.5 * (field[r * n + k] + field[r * n + k + 4])) as f64;
            s += (2.0 * d / 800.0).powi(2);
            c += 1.0;
        }
    }
    println!(
        "heights {lo} {hi}; sigma(0.8 km) {:.3}; sea share {:.2}",
        (s / c).sqrt(),
        field.iter().filter(|&&z| z <= 0.0).count() as f64 / field.len() as f64
    );
    let field = NestedField::new(vec![FieldLevel::new(200.0, half, field)]);
    let t = Instant::now();
    let mut scene = DeformedScene::new(field, &BuildOptions::default(), DrawWith::Software).unwrap();
    println!("build {:?}", t.elapsed());
    let map = DeformedMap::default();
    let view = MapView {
        map,
        size_px: [1300, 1300],
        centre_px: DVec2::splat(650.0),
        ring_px: 330.0,
        rim_m: 160e3,
        up_azimuth_rad: 0.0,
    };
    for budget in [77_128u32, 34_000] {
        let t = Instant::now();
        let u = scene.update(&view, 0.01, Some(budget)).unwrap();
        println!(
            "budget {budget}: {:?} {:?} {} tri left {} weighed {}",
            t.elapsed(),
            u.update_time,
            u.report.triangles,
            u.report.error_left,
            u.report.weighed
        );
        report("  ", &scene, &view);
    }
    let t = Instant::now();
    let u = scene.update(&view, 1.5, None).unwrap();
    println!("1.5 px: {:?} {} left {}", t.elapsed(), u.report.triangles, u.report.error_left);
    report("  ", &scene, &view);
    scene.update(&view, 0.01, Some(77_128)).unwrap();
    for i in 0..8 {
        let map = DeformedMap {
            alpha: 0.002 * i as f64,
            eye_m: 5000.0 + 10.0 * i as f64,
            centre: DVec2::new(50.0 * i as f64, 0.0),
            ..map
        };
        let view = MapView { map, ..view };
        let t = Instant::now();
        let u = scene.update(&view, 0.01, Some(77_128)).unwrap();
        let up = t.elapsed();
        let t = Instant::now();
        let p = yamanami::gpu::software::map::render_to_image(scene.canvas().buffers(), &view, &Default::default())
            .unwrap();
        println!(
            "live {i}: {up:?} refined {} coarsened {} weighed {}; draw {:?} {}",
            u.report.refined,
            u.report.coarsened,
            u.report.weighed,
            t.elapsed(),
            p.width()
        );
    }
}
