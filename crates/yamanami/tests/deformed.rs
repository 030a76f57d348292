//! A deformed scene keeps what it promises: its bound, its summits, what is picked, what it refuses, its differences.

use glam::{DVec2, DVec3};
use yamanami::core::{DeformedMap, MapFault, MapView, NestedField};
use yamanami::multires::rtin::{BuildOptions, summits};
use yamanami::{DeformedScene, DrawWith};
use yamanami_testkit::{Rng, nested_ground, random_map_view};

fn scene(field: NestedField) -> DeformedScene {
    DeformedScene::new(field, &BuildOptions::default(), DrawWith::Software).unwrap()
}

/// 32 km either way, finer within 12 km.
fn small() -> DeformedScene {
    scene(nested_ground(&[32, 24], 1000.0, 1400.0, 4))
}

fn samples(field: &NestedField) -> impl Iterator<Item = DVec3> {
    field.levels().iter().flat_map(|grid| {
        let place = |k: usize| grid.plane_from_grid(k % grid.width(), k / grid.width());
        grid.heights_m().iter().enumerate().map(move |(k, &z)| place(k).extend(f64::from(z)))
    })
}

/// Maps at random that the scene's ground allows.
fn allowed(rng: &mut Rng, scene: &DeformedScene) -> MapView {
    loop {
        let view = random_map_view(rng, scene.field().widest().reach_m());
        if scene.check(&view.map).is_ok() {
            return view;
        }
    }
}

#[test]
fn what_is_measured_stays_within_what_is_promised() {
    let (mut scene, mut rng) = (small(), Rng::new(3));
    let tops = summits(scene.field().widest(), 30.0);
    assert!(tops.len() > 5, "{} summits", tops.len());
    let (mut tightest, mut limited) = (0f64, 0);
    for i in 0..300 {
        let view = allowed(&mut rng, &scene);
        let tolerance_px = 10f64.powf(-0.5 + 1.5 * rng.unit()) as f32;
        let budget = (i % 3 == 0).then(|| 200 + rng.below(2500) as u32);
        let report = scene.update(&view, tolerance_px, budget).unwrap().report;
        let (found, promised_px) = (scene.measure(&view), f64::from(report.error_left));
        assert!(found.samples > 100 && found.max_px <= promised_px, "{found:?}, {report:?}, {view:?}");
        assert!(found.rms_px <= found.p999_px.max(found.max_px) && found.p999_px <= found.max_px);
        tightest = tightest.max(found.max_px / promised_px);
        limited += usize::from(report.error_left > tolerance_px);
        for top in &tops {
            let place = scene.field().widest().plane_from_grid(top.column, top.row);
            if (place - view.map.centre).length() <= view.rim_m {
                let off_px = scene.error_px_at(&view, place.extend(f64::from(top.height_m)));
                assert!(off_px <= promised_px, "a summit is off by {off_px} px: {report:?}");
                assert!(budget.is_some() || off_px <= f64::from(tolerance_px));
            }
        }
    }
    assert!(tightest > 0.3 && limited > 10, "{tightest} of the bound, {limited} limited by the budget");
}

#[test]
fn what_is_picked_is_what_the_pixel_shows() {
    let mut scene = scene(nested_ground(&[40, 40], 200.0, 500.0, 6));
    let reach_m = scene.field().widest().reach_m();
    let [_, top_m] = scene.field().range_m().map(f64::from);
    for (alpha, up_azimuth_rad) in [(0.0, 0.0), (0.0, 2.0), (0.4, 0.0)] {
        let map = DeformedMap { ring_m: 2000.0, eye_m: 1500.0, alpha, ..DeformedMap::default() };
        let fitted = MapView::fitted(map, [500, 400], 0.9 * reach_m, top_m, 5.0);
        let view = MapView { up_azimuth_rad, ..fitted };
        scene.check(&view.map).unwrap();
        scene.update(&view, 0.2, None).unwrap();
        let (mut rng, mut found) = (Rng::new(9), 0);
        for _ in 0..150 {
            let px = DVec2::new(rng.below(500) as f64 + 0.5, rng.below(400) as f64 + 0.5);
            let Some(place) = scene.pick(&view, px).unwrap() else { continue };
            let off_px = (view.px_from_plane(place) - px).length();
            assert!(off_px <= 1.0, "{px}: {place} is drawn {off_px} px away");
            assert_eq!(place.z, scene.field().height_m(place.truncate()));
            found += 1;
        }
        assert!(found > 60, "{found} of 150 show ground");
        for off in [
            DVec2::new(-1.0, 5.0),
            DVec2::new(500.0, 5.0),
            DVec2::new(5.0, 400.0),
            DVec2::NAN,
            DVec2::INFINITY,
        ] {
            assert_eq!(scene.pick(&view, off).unwrap(), None, "{off}");
        }
    }
}

#[test]
fn ground_above_the_eye_near_the_ring_is_refused_and_no_other() {
    let (scene, mut rng) = (small(), Rng::new(77));
    let mut refused = 0;
    for _ in 0..200 {
        let reach_m = scene.field().widest().reach_m();
        let mut map = random_map_view(&mut rng, reach_m).map;
        map.eye_m = 300.0 + 1500.0 * rng.unit();
        let stands_above = samples(scene.field()).any(|p| {
            let r_m = (p.truncate() - map.centre).length();
            r_m <= 2.0 * map.ring_m && map.exaggeration * (p.z - map.drop_m(r_m)) >= map.eye_m
        });
        match scene.check(&map) {
            Ok(()) => assert!(!stands_above, "{map:?}"),
            Err(MapFault::AboveTheEye { at, height_m, eye_m }) => {
                let place = at + map.centre;
                let z = scene.field().height_m(place) * map.exaggeration;
                assert!(stands_above && eye_m == map.eye_m && (height_m - z).abs() < 1e-6, "{at}: {height_m}, {z}");
                refused += 1;
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!((40..160).contains(&refused), "{refused} of 200 refused");
    for wrong in [
        DeformedMap { alpha: 1.5, ..DeformedMap::default() },
        DeformedMap { alpha: f64::NAN, ..DeformedMap::default() },
        DeformedMap { ring_m: 0.0, ..DeformedMap::default() },
        DeformedMap { eye_m: -1.0, ..DeformedMap::default() },
        DeformedMap { centre: DVec2::new(f64::NAN, 0.0), ..DeformedMap::default() },
    ] {
        assert!(matches!(scene.check(&wrong), Err(MapFault::Number(..))), "{wrong:?}");
    }
}

#[test]
fn live_changes_end_in_the_mesh_of_a_fresh_scene() {
    let (mut live, mut rng) = (small(), Rng::new(12));
    for i in 0..30 {
        let view = allowed(&mut rng, &live);
        let (tolerance_px, budget) = (0.5 + 4.0 * rng.unit() as f32, (i % 2 == 0).then(|| 1500 + 50 * i));
        let update = live.update(&view, tolerance_px, budget).unwrap();
        if i % 3 != 0 {
            continue;
        }
        let mut fresh = small();
        let first = fresh.update(&view, tolerance_px, budget).unwrap();
        assert_eq!(first.report.error_left, update.report.error_left);
        assert!(live.front().nodes() == fresh.front().nodes() && live.mesh() == fresh.mesh(), "update {i}");
        let [followed, whole] = [&live, &fresh].map(|scene| scene.canvas().buffers().contents());
        assert!(followed.triangles.len() == update.report.triangles && followed == whole, "update {i}");
    }
}
