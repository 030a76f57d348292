//! A small picture of a surface, drawn by the processor.

use crate::fault::Fault;
use crate::reply::{AN_HOUR, Content};
use crate::surface::Served;
use image::ImageFormat;
use std::io::Cursor;
use yamanami::io::pack::layout::PackKind;
use yamanami::{
    Canvas, Criteria, DrawWith, Error, Model, OpenOptions, Scene, Subject, Terrain, ViewCriterion, overview,
};

/// Width and height, pixels.
pub(crate) const SIZE_PX: [u32; 2] = [480, 300];
/// Drawn so many times larger, then made smaller: the software draws without smoothing edges.
const FOLD: u32 = 2;
/// Enough for a picture of this size.
const MOST_TRIANGLES: u32 = 200_000;

/// Draws a surface as PNG.
pub(crate) fn draw(served: &Served) -> Result<Content, Fault> {
    let drawn = match served.kind {
        PackKind::Terrain => {
            let terrain = Terrain::open(std::slice::from_ref(&served.path), &OpenOptions::default(), &|_| ());
            terrain.and_then(|mut terrain| picture(&mut terrain))
        }
        PackKind::Model | PackKind::Tin => Model::open(&served.path, &|_| ()).and_then(|mut model| picture(&mut model)),
    };
    let bytes = drawn.map_err(|e| served.unreadable(e))?;
    Ok(Content::new("image/png", bytes, AN_HOUR))
}

fn picture(subject: &mut impl Subject) -> Result<Vec<u8>, Error> {
    let view = overview(subject, SIZE_PX.map(|n| n * FOLD));
    let criteria = Criteria {
        view: Some(ViewCriterion { view, tolerance_px: 1.0, cull: true }),
        budget_triangles: Some(MOST_TRIANGLES),
        ..Criteria::default()
    };
    let mut scene = Scene::new(subject, Canvas::new(subject.bounds().centre(), DrawWith::Software)?);
    while scene.update(subject, &criteria)?.pages > 0 {}
    let drawn = scene.draw(&view, &subject.usual_style())?;
    let small = image::imageops::resize(&drawn, SIZE_PX[0], SIZE_PX[1], image::imageops::FilterType::Triangle);
    let mut bytes = Cursor::new(Vec::new());
    small
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|source| Error::Picture { path: "picture.png".into(), source })?;
    Ok(bytes.into_inner())
}
