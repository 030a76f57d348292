//! hori's experiment on a made ground: the page is whole, and says what it must.

use yamanami::core::{FieldLevel, NestedField};
use yamanami::hori;
use yamanami::multires::rtin::band_mesh::Summit;
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

const HALF: u32 = 200;

fn ground(relief_m: f32) -> NestedField {
    let width = 2 * HALF as usize + 1;
    let shape = Shape::Fractal { relief_m, roughness: 0.5, seed: 3 };
    let field = SyntheticTerrain::new(width, width, shape, Spacing::Metres(200.0)).to_field();
    NestedField::new(vec![FieldLevel::new(200.0, HALF, field.into_heights_m())])
}

/// Samples that are the highest within 2 km.
fn summits(field: &NestedField) -> Vec<Summit> {
    let (grid, width) = (field.widest(), field.widest().width());
    let z = |column: usize, row: usize| grid.heights_m()[row * width + column];
    let inner = 10..width - 10;
    let places = inner.clone().flat_map(|row| inner.clone().map(move |column| (column, row)));
    let is_top = |&(column, row): &(usize, usize)| {
        (row - 10..=row + 10).all(|r| (column - 10..=column + 10).all(|c| z(c, r) <= z(column, row)))
    };
    let summit = |(column, row): (usize, usize)| Summit {
        column: column as u32,
        row: row as u32,
        height_m: f64::from(z(column, row)),
        prominence_m: 150.0,
        saddle: None,
    };
    places.filter(is_top).map(summit).collect()
}

#[test]
fn the_page_is_whole() {
    let field = ground(2_500.0);
    let summits = summits(&field);
    assert!(summits.len() > 10);
    let out = tempfile::tempdir().unwrap();
    let page = hori(&field, &summits, "A made ground".to_owned(), out.path(), &|_| ()).unwrap();
    assert_eq!(page, out.path().join("index.html"));
    let text = std::fs::read_to_string(out.path().join("hori.md")).unwrap();
    for part in [
        "77,291 triangles by area; 77,360 in 1,933 whole blocks",
        "Figure 9",
        "Figure 11",
        "Figure 14",
    ] {
        assert!(text.contains(part), "{part}");
    }
    // every picture that the page names is there
    for name in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        assert!(out.path().join(name).metadata().unwrap().len() > 1_000, "{name}");
    }
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
    let field = ground(9_000.0);
    let out = tempfile::tempdir().unwrap();
    let refused = hori(&field, &[], String::new(), out.path(), &|_| ()).unwrap_err().to_string();
    assert!(refused.starts_with("eye height: expected above all ground near the ring"), "{refused}");
}
