//! hori's experiment on a made ground: the page is whole, says what it must, and promises are kept.

use yamanami::core::{FieldLevel, NestedField};
use yamanami::{HoriGround, HoriJob, hori};
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

fn ground(half: u32, relief_m: f32, name: &str) -> HoriGround {
    let width = 2 * half as usize + 1;
    let shape = Shape::Fractal { relief_m, roughness: 0.65, seed: 3 };
    let field = SyntheticTerrain::new(width, width, shape, Spacing::Metres(200.0)).to_field();
    let field = NestedField::new(vec![FieldLevel::new(200.0, half, field.into_heights_m())]);
    HoriGround { name: name.to_owned(), title: format!("A made ground, {name}"), field }
}

fn job(ground: HoriGround, made: Vec<HoriGround>) -> HoriJob {
    HoriJob {
        ground,
        made,
        side_px: 260,
        centre_lon_lat: None,
        places: Vec::new(),
        lines: Vec::new(),
        image: None,
        credits: Vec::new(),
    }
}

#[test]
fn the_page_is_whole() {
    let out = tempfile::tempdir().unwrap();
    let job = job(ground(144, 2_500.0, "main"), vec![ground(80, 1_000.0, "gentle")]);
    let found = hori(job, out.path(), &|_| ()).unwrap();
    assert_eq!(found.page, out.path().join("index.html"));
    let text = std::fs::read_to_string(out.path().join("hori.md")).unwrap();
    for part in [
        "77,291 triangles by area; 77,360 in 1,933 whole blocks",
        "What was found",
        "Figure 9",
        "Figure 11",
        "Figure 14",
        "fig12c.jpg",
        "fig13d2.jpg",
        "A made ground, gentle",
    ] {
        assert!(text.contains(part), "{part}");
    }
    // every picture that the page names is there
    for name in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        assert!(out.path().join(name).metadata().unwrap().len() > 1_000, "{name}");
    }
    for ground in &found.grounds {
        let mode = |file: &str| ground.modes.iter().find(|mode| mode.file == file).unwrap();
        let (bands, engine) = (mode("printed_none"), mode("engine_equal"));
        assert!(engine.triangles <= mode("printed_paper").triangles);
        assert!(engine.report.all.max_px < bands.report.all.max_px);
        assert!(mode("engine_rms").report.far.rms_px <= bands.report.far.rms_px);
        assert!(mode("engine_1_5px").report.all.max_px <= 1.5);
        let kept: Vec<bool> = ground.modes.iter().filter_map(yamanami::HoriMode::keeps_bound).collect();
        assert_eq!(kept, [true; 4]);
    }
    assert!(found.draws[0].triangles > found.draws[1].triangles && found.flights.len() == 2);
    let table = std::fs::read_to_string(out.path().join("fig12.csv")).unwrap();
    let cell = |row: usize, column: usize| -> f64 {
        table.lines().nth(row + 1).unwrap().rsplit(',').nth(6 - column).unwrap().parse().unwrap()
    };
    // bias and summits: the paper's rule lifts the ground, moving summits alone keeps them without
    assert!(cell(1, 2) > 3.0 * cell(0, 2).abs().max(cell(2, 2).abs()), "{table}");
    assert!(cell(2, 3) < 0.2 * cell(0, 3), "{table}");
}

#[test]
fn ground_above_the_eye_is_refused() {
    let out = tempfile::tempdir().unwrap();
    let refused = hori(job(ground(80, 12_000.0, "high"), Vec::new()), out.path(), &|_| ()).unwrap_err().to_string();
    assert!(refused.starts_with("eye height: expected above all ground near the ring"), "{refused}");
}
