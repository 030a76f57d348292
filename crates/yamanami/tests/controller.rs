//! The controller against its oracle: after every frame of a moving view the incremental front is the greedy one.

use glam::DVec3;
use yamanami_core::{GeoReference, HeightField, Hierarchy, Surface, View};
use yamanami_lod::{Controller, Criteria, Front, PaperController, Staircase, Step, ViewCriterion, extract};
use yamanami_multires::cluster::{ClusterOptions, ClusterSurface};
use yamanami_multires::wavelet::{BuildOptions, GridData, TerrainSurface, build};
use yamanami_testkit::laws::delta_law;
use yamanami_testkit::ring;

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

fn kit_step(step: Step) -> yamanami_testkit::Step {
    match step {
        Step::Refine(n) => yamanami_testkit::Step::Refine(n),
        Step::Coarsen(n) => yamanami_testkit::Step::Coarsen(n),
    }
}

#[test]
fn every_delta_can_be_stopped_anywhere_and_walked_back() {
    let surface = rough(150, 129, 25.0);
    let criteria = |i: usize| Criteria {
        view: Some(ViewCriterion { view: view(i * 4), tolerance_px: 1.0, cull: true }),
        budget_triangles: Some(1500),
        ..Criteria::default()
    };
    let mut exact = Controller::new(&surface);
    let mut paper = PaperController::new(&surface, Staircase::new(2.0, 0.0, 4000.0, 5));
    for i in 0..12 {
        for by_paper in [false, true] {
            let from = if by_paper { paper.front().nodes() } else { exact.front().nodes() };
            let mut steps = Vec::new();
            let to = if by_paper {
                paper.update(&surface, &criteria(i), |step, _| steps.push(kit_step(step)));
                paper.front().nodes()
            } else {
                exact.update(&surface, &criteria(i), |step, _| steps.push(kit_step(step)));
                exact.front().nodes()
            };
            delta_law(&surface, &from, &to, &steps);
        }
    }
}

#[test]
fn a_step_limit_stops_at_a_legal_front_and_gets_there_in_the_end() {
    let surface = rough(200, 160, 25.0);
    let wanted = Criteria {
        view: Some(ViewCriterion { view: view(0), tolerance_px: 1.0, cull: false }),
        budget_triangles: Some(3000),
        ..Criteria::default()
    };
    let limited = Criteria { max_steps: Some(50), ..wanted };
    let mut controller = Controller::new(&surface);
    let mut frames = 0;
    while controller.update(&surface, &limited, |_, _| ()).refined > 0 {
        frames += 1;
        assert!(controller.front().triangle_count() <= 3000 && frames < 200);
    }
    assert!(frames > 10);
    assert_eq!(controller.front().nodes(), extract(&surface, &wanted).nodes());
}

/// A ring of small clusters, so that a small mesh has many nodes.
fn clusters() -> ClusterSurface {
    let options = ClusterOptions { cluster_triangles: 24, group_clusters: 6, ..ClusterOptions::default() };
    yamanami_multires::cluster::build(&ring(160, 70), &options).unwrap().into_surface().unwrap()
}

/// Flies around and through the ring.
fn view_of_ring(i: usize) -> View {
    let t = i as f64 * 0.05;
    let eye = DVec3::new(6.0 * t.cos(), 5.0 * t.sin(), 2.0 * (0.3 * t).sin());
    let target = DVec3::new(3.0 * (t + 1.0).cos(), 3.0 * (t + 1.0).sin(), 0.0);
    View { eye, target, fov_y_rad: 0.8, viewport_px: [800, 600] }
}

fn of_ring(i: usize, tolerance_px: f32, cull: bool) -> Criteria {
    Criteria { view: Some(ViewCriterion { view: view_of_ring(i), tolerance_px, cull }), ..Criteria::default() }
}

#[test]
fn clusters_follow_the_oracle() {
    let surface = clusters();
    for cull in [false, true] {
        follow(&surface, 150, |i| of_ring(i, 6.0, cull));
        for budget in [700, 6000] {
            follow(&surface, 150, |i| Criteria { budget_triangles: Some(budget), ..of_ring(i, 0.5, cull) });
        }
    }
}

#[test]
fn deltas_of_clusters_can_be_stopped_anywhere_and_walked_back() {
    let surface = clusters();
    let mut controller = Controller::new(&surface);
    for i in 0..12 {
        let from = controller.front().nodes();
        let mut steps = Vec::new();
        let criteria = Criteria { budget_triangles: Some(4000), ..of_ring(i * 9, 2.0, true) };
        controller.update(&surface, &criteria, |step, _| steps.push(kit_step(step)));
        delta_law(&surface, &from, &controller.front().nodes(), &steps);
    }
}

#[test]
fn absent_pages_leave_coarser_places() {
    let mut surface = clusters();
    let absent: Vec<u32> = (0..surface.node_bound()).filter(|n| n % 7 == 3).collect();
    for &node in &absent {
        assert!(surface.remove(node).is_some());
    }
    let mut controller = Controller::new(&surface);
    for i in 0..40 {
        let report = controller.update(&surface, &of_ring(i, 1.0, true), |_, _| ());
        assert!(report.wanted.iter().all(|n| absent.contains(n)), "{:?}", report.wanted);
        assert_eq!(controller.front().nodes(), extract(&surface, &of_ring(i, 1.0, true)).nodes());
        let mesh = surface.mesh_of(controller.front());
        assert_eq!(mesh.triangles.len(), report.triangles);
    }
}
