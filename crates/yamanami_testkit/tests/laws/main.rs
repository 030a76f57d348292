//! The kit tries itself: a sound surface passes every law, and each way of being broken is caught by the law it breaks.

mod strip;

use std::panic::{AssertUnwindSafe, catch_unwind};
use strip::{Fault, Strip};
use yamanami_core::ActiveSet;
use yamanami_testkit::laws::{Kind, closure_law, closure_law_of, delta_law, hierarchy_law, surface_law};
use yamanami_testkit::{RandomFront, Step};

fn sound() -> Strip {
    Strip::new(6, Fault::None)
}

/// What a law says of a strip with a fault.
#[track_caller]
fn complaint(fault: Fault, law: impl Fn(&Strip)) -> String {
    let strip = Strip::new(6, fault);
    match catch_unwind(AssertUnwindSafe(|| law(&strip))) {
        Ok(()) => panic!("{fault:?} was not caught"),
        Err(cause) => match cause.downcast::<String>() {
            Ok(message) => *message,
            Err(cause) => cause.downcast_ref::<&str>().copied().unwrap_or_default().to_owned(),
        },
    }
}

#[test]
fn a_sound_surface_keeps_every_law() {
    for levels in 1..=7 {
        let strip = Strip::new(levels, Fault::None);
        hierarchy_law(&strip);
        for seed in 0..4 {
            closure_law(&strip, seed);
            surface_law(&strip, seed);
        }
    }
    closure_law_of(&sound(), 1, Kind::Solid);
    closure_law_of(&sound(), 1, Kind::TerrainWithHoles);
}

#[test]
fn a_broken_order_is_caught() {
    for (fault, word) in [
        (Fault::Error, "error not monotone"),
        (Fault::Bound, "bound not nested"),
        (Fault::Children, "whose children are"),
        (Fault::ParentCount, "parent_count"),
    ] {
        let message = complaint(fault, hierarchy_law);
        assert!(message.contains(word), "{fault:?}: {message}");
    }
}

#[test]
fn a_broken_mesh_is_caught() {
    for (fault, kind, word) in [
        (Fault::TVertex, Kind::Terrain, "T-vertex"),
        (Fault::TVertex, Kind::TerrainWithHoles, "T-vertex"),
        // in space the coarse side's edge is not even near the vertex
        (Fault::TVertex, Kind::Solid, "crack"),
        (Fault::Flipped, Kind::Terrain, "clockwise"),
        (Fault::Flipped, Kind::Solid, "both run"),
        (Fault::Count, Kind::Terrain, "triangles against"),
    ] {
        let message = complaint(fault, |s| closure_law_of(s, 5, kind));
        assert!(message.contains(word), "{fault:?}: {message}");
    }
}

#[test]
fn a_broken_emission_is_caught() {
    for (fault, word) in [
        (Fault::Leftover, "applying and undoing"),
        (Fault::EarlyRemoval, "while a triangle uses it"),
        (Fault::Order, "vertex"),
        (Fault::MeshOf, "mesh_of"),
        (Fault::Count, "triangles gained"),
    ] {
        let message = complaint(fault, |s| surface_law(s, 5));
        assert!(message.contains(word), "{fault:?}: {message}");
    }
}

#[test]
fn a_delta_is_checked_step_by_step() {
    let strip = sound();
    let mut front = RandomFront::new(&strip, 3);
    front.wander(60, 20);
    let from = front.nodes();
    let steps: Vec<Step> = (0..40)
        .filter_map(|_| {
            let step = front.pick(0.5)?;
            front.take(step);
            Some(step)
        })
        .collect();
    let to = front.nodes();
    delta_law(&strip, &from, &to, &steps);

    let cut_short = catch_unwind(|| delta_law(&strip, &from, &to, &steps[..39]));
    assert!(cut_short.is_err(), "an unfinished delta passed");
    let illegal = catch_unwind(|| delta_law(&strip, &[], &[0, 62], &[Step::Refine(0), Step::Refine(62)]));
    assert!(illegal.is_err(), "a node without its parents passed");
}

#[test]
fn random_fronts_stay_closed_and_reach_everything() {
    let strip = sound();
    let mut front = RandomFront::new(&strip, 11);
    let closed = |front: &RandomFront<'_, Strip>| {
        use yamanami_core::Hierarchy;
        front.nodes().iter().all(|&n| strip.parents(n).iter().all(|&p| front.is_active(p)))
    };
    front.wander(2000, 63);
    assert_eq!(front.len(), 63, "the whole hierarchy");
    assert!(front.refinable().is_empty());
    while let Some(node) = front.pick_coarsen() {
        front.take(Step::Coarsen(node));
        assert!(closed(&front));
    }
    assert!(front.is_empty() && front.refinable() == [0]);
    let order = {
        front.wander(100, 30);
        front.nodes_shuffled()
    };
    assert_eq!(order.len(), front.len());
}
