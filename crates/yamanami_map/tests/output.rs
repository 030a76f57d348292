//! One sheet in its three formats, and sheets that cannot be.

use glam::{DVec2, DVec3};
use image::{Rgba, RgbaImage};
use yamanami_core::{DeformedMap, LineKind, MapLine, MapView, NamedPlace};
use yamanami_map::{
    Composed, Fonts, MapError, MissingGlyphs, Outline, PackedBase, Scene, Shape, Sheet, SheetOptions, Stroke,
    encode_png,
};

fn compose(view: &MapView, options: &SheetOptions, fonts: &Fonts) -> Composed {
    let place = |name: &str, x: f64| NamedPlace {
        name: name.into(),
        reading: Some("なまえ".into()),
        position: DVec2::new(x, 2e3),
        height_m: Some(1000.0),
        ..NamedPlace::default()
    };
    let places = [place("富士山 & <co>", 1e3), place("\u{1F5FB}", -60e3)];
    let lines = [
        MapLine { points: vec![DVec2::ZERO, DVec2::new(5e3, 5e3)], kind: LineKind::Railway, ..MapLine::default() },
        MapLine {
            points: vec![DVec2::new(f64::NAN, 0.0); 3],
            kind: LineKind::Lake,
            is_area: true,
            ..MapLine::default()
        },
    ];
    let sheet = Sheet {
        view,
        title: "Title",
        centre_lon_lat: Some(DVec2::new(138.7, 35.4)),
        credits: &["Credit \u{10FFFF}".to_owned()],
        places: &places,
        lines: &lines,
        silhouettes: &[vec![DVec2::ZERO, DVec2::new(9.0, 9.0)], vec![]],
        tint: &[(0.0, [0, 90, 0]), (1000.0, [200, 200, 90])],
        options,
        fonts,
    };
    sheet.compose(&|_| f64::NAN, &|_: DVec3| true)
}

fn square(side: u32) -> MapView {
    let map = DeformedMap::default();
    MapView::fitted(map, [side, side], 100e3, 3000.0, SheetOptions::default().margin_px())
}

#[test]
fn all_formats_hold_the_same_sheet() {
    let (fonts, options) = (Fonts::default(), SheetOptions::default());
    let composed = compose(&square(700), &options, &fonts);
    let base = RgbaImage::from_pixel(700, 700, Rgba([200, 100, 50, 255]));
    let packed = PackedBase::pack(&base, options.paper).unwrap();

    let svg = composed.scene.to_svg(Some(&packed), 96.0, &fonts);
    assert!(
        svg.contains("富士山 &amp;") && svg.contains("data:image/jpeg;base64,") && svg.contains("width=\"185.208mm\"")
    );
    let pdf = composed.scene.to_pdf(Some(&packed), 96.0, &fonts).unwrap();
    let holds = |bytes: &[u8], word: &[u8]| bytes.windows(word.len()).any(|w| w == word);
    assert!(pdf.starts_with(b"%PDF") && holds(&pdf, b"FontFile2") && holds(&pdf, b"DCTDecode"));
    let picture = composed.scene.paint(base, &fonts).unwrap();
    let changed = picture.pixels().filter(|p| p.0 != [200, 100, 50, 255]).count();
    assert!((5_000..150_000).contains(&changed), "{changed} pixels drawn on");
    assert!(encode_png(&picture, None).unwrap().starts_with(b"\x89PNG"));

    assert_eq!(composed.missing.len(), 2, "a name and a credit");
    let said = MissingGlyphs::summary(&composed.missing).unwrap();
    assert_eq!(
        said,
        "fonts lack \u{1F5FB} (U+1F5FB), \u{10FFFF} (U+10FFFF) in 2 texts, 1 of them written by their reading instead"
    );
}

#[test]
fn what_is_transparent_stays_so_without_paper() {
    let (fonts, transparent) = (Fonts::default(), SheetOptions { paper: None, ..SheetOptions::default() });
    let composed = compose(&square(300), &transparent, &fonts);
    let base = RgbaImage::from_fn(150, 150, |x, _| Rgba([9, 9, 9, if x < 75 { 0 } else { 255 }]));
    let packed = PackedBase::pack(&base, None).unwrap();
    assert!(composed.scene.to_svg(Some(&packed), 96.0, &fonts).contains("data:image/png;base64,"));
    assert!(composed.scene.to_pdf(Some(&packed), 96.0, &fonts).unwrap().starts_with(b"%PDF"));
    let picture = composed.scene.paint(base, &fonts).unwrap();
    assert_eq!(picture.dimensions(), (300, 300), "a smaller picture of the ground is scaled");
    assert_eq!(picture.get_pixel(2, 150).0[3], 0);
    assert_eq!(picture.get_pixel(298, 150).0, [9, 9, 9, 255]);
}

#[test]
fn strips_leave_no_seam() {
    let line = Outline::open([DVec2::new(4.0, -5.0), DVec2::new(4.0, 2300.0)]);
    let shapes = vec![Shape::Outlines { outlines: vec![line], fill: None, stroke: Some(Stroke::new([0, 0, 0], 3.0)) }];
    let scene = Scene { size_px: [9, 2200], paper: None, shapes };
    let picture = scene.paint(RgbaImage::from_pixel(9, 2200, Rgba([255; 4])), &Fonts::default()).unwrap();
    let first: Vec<u8> = picture.as_raw()[..36].to_vec();
    assert!(first.contains(&0) && picture.as_raw().chunks(36).all(|row| row == first));
}

#[test]
fn nothing_is_too_small_or_too_odd() {
    let fonts = Fonts::default();
    for (size_px, point_px) in [([1, 1], 1.0), ([3, 900], f64::NAN), ([400, 300], 40.0), ([64, 64], 0.0)] {
        let options = SheetOptions { point_px, name_rings: 9, ..SheetOptions::default() };
        let view = MapView::fitted(DeformedMap::default(), size_px, 100e3, 3000.0, 10.0);
        let composed = compose(&view, &options, &fonts);
        let base = RgbaImage::new(size_px[0], size_px[1]);
        assert!(composed.scene.paint(base, &fonts).is_ok());
    }
    let nothing = Scene { size_px: [0, 0], paper: None, shapes: Vec::new() };
    assert!(matches!(nothing.paint(RgbaImage::new(0, 0), &fonts), Err(MapError::Write("PNG", _))));
    assert!(matches!(nothing.to_pdf(None, 96.0, &fonts), Err(MapError::Write("PDF", _))));
}
