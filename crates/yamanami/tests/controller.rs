//! The controller against its oracle: after every frame of a moving view the incremental front is the greedy one.

use glam::DVec3;
use yamanami_core::{GeoReference, HeightField, Hierarchy, View};
use yamanami_lod::{Controller, Criteria, Front, ViewCriterion, extract};
use yamanami_multires::wavelet::{BuildOptions, GridData, TerrainSurface, build};

fn rough(width: usize, height: usize, step_m: f64) -> TerrainSurface<GridData> {
    let z = (0..width * height)
        .map(|i| {
            let (x, y) = ((i % width) as f32, (i / width) as f32);
            let hash = (i as u32).wrapping_mul(2_654_435_761) >> 20;
            300.0 * (x * 0.05).sin() * (y * 0.043).cos() + 60.0 * (x * 0.31 + y * 0.17).sin() + hash as f32 * 0.004
        })
        .collect();
    let field = HeightField::new(width, height, z, GeoReference::local([step_m; 2], height));
    build(field, &BuildOptions::default()).unwrap()
}

fn view(i: usize) -> View {
    let t = i as f64;
    let eye = DVec3::new(900.0 + 14.0 * t, -2500.0 + 9.0 * t + 40.0 * (t * 0.2).sin(), 700.0 + 6.0 * t);
    let heading = 0.3 + 0.013 * t;
    let target = eye + DVec3::new(heading.cos(), heading.sin(), -0.25);
    View { eye, target, fov_y_rad: 0.9, viewport_px: [1280, 720] }
}

fn follow(surface: &impl Hierarchy, frames: usize, criteria: impl Fn(usize) -> Criteria) {
    let mut controller = Controller::new(surface);
    let mut weighed = 0;
    for i in 0..frames {
        let criteria = criteria(i);
        let report = controller.update(surface, &criteria, |_, _| ());
        let expected: Front = extract(surface, &criteria);
        assert_eq!(report.triangles, expected.triangle_count(), "frame {i}: {report:?}");
        assert!(controller.front().nodes() == expected.nodes(), "frame {i}: another front, {report:?}");
        if let Some(budget) = criteria.budget_triangles {
            assert!(report.triangles <= budget as usize);
        }
        if i > 20 {
            weighed += report.weighed;
        }
    }
    println!("{} triangles, {} weighed a frame", controller.front().triangle_count(), weighed / (frames - 20).max(1));
}

#[test]
fn tolerance_and_culling_follow_the_oracle() {
    let surface = rough(301, 257, 25.0);
    for cull in [false, true] {
        follow(&surface, 120, |i| Criteria {
            view: Some(ViewCriterion { view: view(i), tolerance_px: 2.0, cull }),
            ..Criteria::default()
        });
    }
}

#[test]
fn a_budget_follows_the_oracle() {
    let surface = rough(257, 257, 50.0);
    for budget in [500, 5000] {
        for cull in [false, true] {
            follow(&surface, 120, |i| Criteria {
                terrain_tolerance_m: 0.5,
                view: Some(ViewCriterion { view: view(i), tolerance_px: 0.25, cull }),
                budget_triangles: Some(budget),
                ..Criteria::default()
            });
        }
    }
}

#[test]
fn changing_knobs_follow_the_oracle() {
    let surface = rough(200, 333, 25.0);
    follow(&surface, 90, |i| Criteria {
        terrain_tolerance_m: if i < 30 { 0.0 } else { 1.5 },
        view: (i % 40 < 30).then(|| ViewCriterion {
            view: view(i % 17 * 3),
            tolerance_px: 1.0 + (i / 10) as f32,
            cull: i % 20 < 10,
        }),
        budget_triangles: (i % 15 < 9).then_some(200 + 400 * (i as u32 % 7)),
        ..Criteria::default()
    });
}
