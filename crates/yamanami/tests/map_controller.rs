//! The controller over deformed maps against its oracle: whatever changes between two frames, the front is the greedy one,
//! and the mesh follows it by differences.

use yamanami_core::{Hierarchy, MapView, MeshMirror, NodeId, Surface};
use yamanami_lod::{Controller, Criteria, FrameReport, LimitedBy, MapCriterion, Step, extract};
use yamanami_multires::rtin::{BuildOptions, Rtin};
use yamanami_testkit::laws::delta_law;
use yamanami_testkit::{Rng, nested_ground, random_map_view};

const FIELDS: [&[u32]; 3] = [&[32], &[24, 20], &[16, 12, 14]];

fn rtin(halves: &[u32]) -> Rtin {
    Rtin::build(nested_ground(halves, 900.0, 1100.0, 21), &BuildOptions::default()).unwrap()
}

/// Frames of a map that drifts, with a number of it or another control changed at random now and then.
struct Frames {
    rng: Rng,
    reach_m: f64,
    view: MapView,
    tolerance_px: f32,
    budget: Option<u32>,
    may_have_budget: bool,
}

impl Frames {
    fn new(seed: u64, surface: &Rtin, may_have_budget: bool) -> Self {
        let (mut rng, reach_m) = (Rng::new(seed), surface.field().widest().reach_m());
        let view = random_map_view(&mut rng, reach_m);
        Self { rng, reach_m, view, tolerance_px: 2.0, budget: None, may_have_budget }
    }

    fn next(&mut self) -> Criteria {
        let other = random_map_view(&mut self.rng, self.reach_m);
        let map = &mut self.view.map;
        match self.rng.below(12) {
            0 => map.centre = other.map.centre,
            1 => map.alpha = other.map.alpha,
            2 => map.ring_m = other.map.ring_m,
            3 => map.eye_m = other.map.eye_m,
            4 => map.scale = other.map.scale,
            5 => map.exaggeration = other.map.exaggeration,
            6 => (map.curvature, map.alpha_fall) = (other.map.curvature, other.map.alpha_fall),
            7 => (self.view.ring_px, self.view.rim_m) = (other.ring_px, other.rim_m * (0.3 + self.rng.unit())),
            8 => self.tolerance_px = 10f64.powf(-1.0 + 2.5 * self.rng.unit()) as f32,
            9 => {
                let is_kept = self.may_have_budget && self.rng.chance(0.8);
                self.budget = is_kept.then(|| self.rng.below(6000) as u32);
            }
            _ => map.centre += 0.003 * other.map.centre,
        }
        Criteria {
            map: Some(MapCriterion { view: self.view, tolerance_px: self.tolerance_px }),
            budget_triangles: self.budget,
            ..Criteria::default()
        }
    }
}

/// What a report says of a front is true.
fn honest(surface: &Rtin, controller: &Controller, criteria: &Criteria, report: &FrameReport) {
    let (front, map) = (controller.front(), criteria.map.unwrap());
    assert_eq!(report.triangles, front.triangle_count(), "{report:?}");
    if let Some(budget) = criteria.budget_triangles {
        assert!(report.triangles <= (budget as usize).max(surface.base_triangle_count()), "{report:?}");
    }
    let mut applied = vec![false; surface.node_bound() as usize];
    front.nodes().into_iter().for_each(|n| applied[n as usize] = true);
    let out = (0..surface.node_bound()).filter(|&n| !applied[n as usize]);
    let worst = out.map(|n| surface.map_error_px(n, &map.view)).fold(0.0, f32::max);
    // what comes below an open node may be above it by rounding alone
    assert!(worst <= report.error_left * (1.0 + 1e-6), "{worst} px is left out: {report:?}");
    if report.limited_by == LimitedBy::Tolerance {
        assert!(report.error_left <= map.tolerance_px, "{report:?}");
    }
}

#[test]
fn whatever_changes_the_front_is_the_oracle_s() {
    for halves in FIELDS {
        let surface = rtin(halves);
        for may_have_budget in [false, true] {
            let mut frames = Frames::new(5, &surface, may_have_budget);
            let mut controller = Controller::new(&surface);
            let (mut sizes, mut limited) = (Vec::new(), 0);
            for i in 0..80 {
                let criteria = frames.next();
                let report = controller.update(&surface, &criteria, |_, _| ());
                let expected = extract(&surface, &criteria);
                assert!(controller.front().nodes() == expected.nodes(), "frame {i}: {report:?}, {criteria:?}");
                honest(&surface, &controller, &criteria, &report);
                sizes.push(report.triangles);
                limited += usize::from(report.limited_by == LimitedBy::Budget);
            }
            sizes.sort_unstable();
            sizes.dedup();
            assert!(sizes.len() > 25 && (limited > 2) == may_have_budget, "{limited} limited, {sizes:?}");
        }
    }
}

#[test]
fn every_way_between_fronts_can_be_stopped_anywhere_and_walked_back() {
    for halves in FIELDS {
        let surface = rtin(halves);
        let mut frames = Frames::new(8, &surface, true);
        let mut controller = Controller::new(&surface);
        for _ in 0..10 {
            let (from, mut steps) = (controller.front().nodes(), Vec::new());
            controller.update(&surface, &frames.next(), |step, _| {
                steps.push(match step {
                    Step::Refine(node) => yamanami_testkit::Step::Refine(node),
                    Step::Coarsen(node) => yamanami_testkit::Step::Coarsen(node),
                });
            });
            delta_law(&surface, &from, &controller.front().nodes(), &steps);
        }
    }
}

#[test]
fn a_mesh_that_follows_the_steps_is_the_front_s() {
    for halves in FIELDS {
        let surface = rtin(halves);
        let mut frames = Frames::new(13, &surface, true);
        let mut controller = Controller::new(&surface);
        let mut mirror = MeshMirror::default();
        surface.emit_base(&mut mirror);
        for _ in 0..40 {
            controller.update(&surface, &frames.next(), |step, front| match step {
                Step::Refine(node) => surface.refine(node, front, &mut mirror),
                Step::Coarsen(node) => surface.coarsen(node, front, &mut mirror),
            });
            let mut whole = MeshMirror::default();
            surface.emit_front(controller.front(), &mut whole);
            assert!(mirror == whole, "by steps and whole differ");
            let corners = |mesh: &yamanami_core::TriangleMesh| {
                let bits = |t: usize| {
                    let mut corners = mesh.corners(t).map(|p| p.to_array().map(f64::to_bits));
                    corners.sort_unstable();
                    corners
                };
                let mut all: Vec<_> = (0..mesh.triangles.len()).map(bits).collect();
                all.sort_unstable();
                all
            };
            assert!(corners(&mirror.to_mesh()) == corners(&surface.mesh_of(controller.front())));
        }
    }
}

#[test]
fn a_step_limit_is_kept_and_the_front_gets_there() {
    let surface = rtin(FIELDS[1]);
    let view = random_map_view(&mut Rng::new(40), surface.field().widest().reach_m());
    let wanted = Criteria {
        map: Some(MapCriterion { view, tolerance_px: 1.0 }),
        budget_triangles: Some(3000),
        ..Criteria::default()
    };
    let limited = Criteria { max_steps: Some(60), ..wanted };
    let mut controller = Controller::new(&surface);
    let mut frames = 0;
    loop {
        let report = controller.update(&surface, &limited, |_, _| ());
        honest(&surface, &controller, &limited, &report);
        assert!(report.refined <= 60 && frames < 200, "{report:?}");
        if report.refined == 0 {
            break;
        }
        frames += 1;
    }
    assert!(frames > 10, "{frames} frames");
    assert_eq!(controller.front().nodes(), extract(&surface, &wanted).nodes());
}

#[test]
fn the_front_is_the_same_whatever_the_number_of_threads() {
    let run = |threads: usize| -> Vec<(Vec<NodeId>, u32)> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let surface = rtin(FIELDS[2]);
            let mut frames = Frames::new(2, &surface, true);
            let mut controller = Controller::new(&surface);
            let one = |_| {
                let report = controller.update(&surface, &frames.next(), |_, _| ());
                (controller.front().nodes(), report.error_left.to_bits())
            };
            (0..30).map(one).collect()
        })
    };
    let alone = run(1);
    assert!(alone == run(2) && alone == run(5));
}
