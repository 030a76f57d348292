//! Names over random places: never one over another or outside the picture, leaders never crossing each other or a
//! name; and what becomes of places that cannot be shown.

use crate::{BearingRing, Fonts, HiddenNames, Label, NameForm, Outcome, Sheet, SheetOptions};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use yamanami_core::{DeformedMap, MapView, NamedPlace, PlaceKind};

const NAMES: [&str; 6] = ["岳", "富士山", "ニセコアンヌプリ", "丹沢山<蛭ヶ岳>", "Mount Washington", "笊ヶ岳"];

fn labels_of(
    view: &MapView,
    options: &SheetOptions,
    places: &[NamedPlace],
    seen: &dyn Fn(DVec3) -> bool,
) -> Vec<Label> {
    let fonts = Fonts::default();
    let sheet = Sheet {
        view,
        title: "試し",
        centre_lon_lat: None,
        credits: &[],
        places,
        lines: &[],
        silhouettes: &[],
        tint: &[],
        options,
        fonts: &fonts,
    };
    sheet.compose(&|_| 0.0, seen).labels
}

fn places() -> impl Strategy<Value = Vec<NamedPlace>> {
    let one =
        (0.0..6.3f64, 0.0..1.0f64, 0.0..3800.0f64, 0..6usize, 0..5u8).prop_map(|(azimuth, far, height, name, kind)| {
            NamedPlace {
                name: NAMES[name].into(),
                reading: Some("ふじさん".into()),
                position: DVec2::from_angle(azimuth) * (far * far * 160e3),
                height_m: Some(height * far),
                kind: [
                    PlaceKind::Summit,
                    PlaceKind::Summit,
                    PlaceKind::Summit,
                    PlaceKind::Pass,
                    PlaceKind::Settlement,
                ][usize::from(kind)],
                ..NamedPlace::default()
            }
        });
    prop::collection::vec(one, 0..160)
}

/// Whether two pieces of lines have a point in common, ends aside.
fn cross(a: [DVec2; 2], b: [DVec2; 2]) -> bool {
    let side = |p: [DVec2; 2], q: DVec2| (p[1] - p[0]).perp_dot(q - p[0]);
    side(a, b[0]) * side(a, b[1]) < -1e-6 && side(b, a[0]) * side(b, a[1]) < -1e-6
}

fn check(labels: &[Label], view: &MapView) -> Result<(), TestCaseError> {
    let shown: Vec<&Label> = labels.iter().filter(|l| l.box_px.is_some()).collect();
    let pieces = |label: &Label| -> Vec<[DVec2; 2]> { label.leader_px.windows(2).map(|w| [w[0], w[1]]).collect() };
    let edges = |label: &Label| -> Vec<[DVec2; 2]> {
        let c = label.box_px.map_or([DVec2::ZERO; 4], |b| b.corners());
        (0..4).map(|i| [c[i], c[(i + 1) % 4]]).collect()
    };
    for (i, a) in shown.iter().enumerate() {
        let (box_a, size) = (a.box_px.unwrap(), DVec2::new(f64::from(view.size_px[0]), f64::from(view.size_px[1])));
        for corner in box_a.corners() {
            prop_assert!(corner.cmpge(DVec2::ZERO).all() && corner.cmple(size).all(), "{} at {corner}", a.name);
        }
        prop_assert!(matches!(a.outcome, Outcome::Shown | Outcome::ShownHidden));
        for b in &shown[i + 1..] {
            prop_assert!(!box_a.overlaps(&b.box_px.unwrap()), "{} over {}", a.name, b.name);
            for p in pieces(a) {
                prop_assert!(pieces(b).iter().all(|&q| !cross(p, q)), "leaders of {} and {}", a.name, b.name);
            }
        }
        for b in shown.iter().filter(|b| !std::ptr::eq(*a, **b)) {
            for p in pieces(a) {
                prop_assert!(edges(b).iter().all(|&q| !cross(p, q)), "leader of {} through {}", a.name, b.name);
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn names_and_leaders_keep_apart(
        places in places(),
        (alpha, ring_m, width, height, rings) in (0.0..1.0f64, 5e3..30e3f64, 500..1500u32, 500..1500u32, 1..4u32),
        (is_both, is_inner, is_seen_share) in (any::<bool>(), any::<bool>(), 0.0..1.0f64),
    ) {
        let options = SheetOptions {
            point_px: 1.0,
            names: if is_both { NameForm::Both } else { NameForm::Local },
            bearing: if is_inner { BearingRing::PlainMap } else { BearingRing::Outside },
            hidden: HiddenNames::Grey,
            name_rings: rings,
            ..SheetOptions::default()
        };
        let map = DeformedMap { alpha, alpha_fall: 1.0, ring_m, ..DeformedMap::default() };
        let view = MapView::fitted(map, [width, height], 160e3, 3000.0, options.margin_px());
        let labels = labels_of(&view, &options, &places, &|p| p.x.sin().abs() < is_seen_share);
        check(&labels, &view)?;
    }
}

fn view() -> MapView {
    MapView::fitted(DeformedMap::default(), [1000, 1000], 100e3, 3000.0, SheetOptions::default().margin_px())
}

fn summit(name: &str, x: f64, y: f64, height_m: f64) -> NamedPlace {
    NamedPlace { name: name.into(), position: DVec2::new(x, y), height_m: Some(height_m), ..NamedPlace::default() }
}

#[test]
fn what_became_of_each_is_said() {
    let places = [
        summit("near", 1e3, 0.0, 900.0),
        summit("far", 0.0, 60e3, 2900.0),
        summit("hidden", 0.0, -30e3, 100.0),
        summit("beyond", 0.0, 150e3, 2000.0),
        summit("nowhere", f64::NAN, 0.0, 2000.0),
        summit("under the near", 1e3, 10.0, 800.0),
    ];
    let seen = |p: DVec3| p.z != 100.0;
    let words = |options: &SheetOptions| -> Vec<&str> {
        labels_of(&view(), options, &places, &seen).iter().map(|l| l.outcome.word()).collect()
    };
    let options = SheetOptions::default();
    assert_eq!(words(&options), ["shown", "shown", "hidden", "beyond_rim", "no_coordinates", "crowded"]);
    let grey = SheetOptions { hidden: HiddenNames::Grey, ..options.clone() };
    assert_eq!(words(&grey)[2], "shown_hidden");
    let none = SheetOptions { has_names: false, ..options };
    assert_eq!(words(&none)[0], "crowded");
}

#[test]
fn names_stand_on_the_ground_at_the_true_summit_and_say_where_it_is() {
    let view = view();
    let labels = labels_of(&view, &SheetOptions::default(), &[summit("北岳", 30e3, -40e3, 3193.0)], &|_| true);
    let label = &labels[0];
    // the ground that is drawn lies at sea level there
    assert_eq!(label.anchor_px, view.px_from_plane(DVec3::new(30e3, -40e3, 0.0)));
    assert_eq!(label.at.z, 3193.0);
    assert!((label.distance_m - 50e3).abs() < 1e-6 && (label.bearing_rad.to_degrees() - 143.13).abs() < 0.01);
    assert_eq!(label.leader_px[0], label.anchor_px);
    let out = |p: DVec2| (p - view.centre_px).length();
    assert!(out(label.box_px.unwrap().centre) > out(label.anchor_px));
}

#[test]
fn the_nearer_and_the_more_prominent_win() {
    let mut places = [summit("小", 0.0, 50e3, 1500.0), summit("大", 30.0, 50e3, 1500.0)];
    (places[0].rank, places[1].rank) = (Some(100.0), Some(900.0));
    let shown = |places: &[NamedPlace]| -> Vec<bool> {
        let labels = labels_of(&view(), &SheetOptions::default(), places, &|_| true);
        labels.iter().map(|l| l.box_px.is_some()).collect()
    };
    assert_eq!(shown(&places), [false, true]);
    let near_and_far = [summit("遠", 0.0, 90e3, 2000.0), summit("近", 10.0, 30e3, 1500.0)];
    assert_eq!(shown(&near_and_far), [false, true]);
}
