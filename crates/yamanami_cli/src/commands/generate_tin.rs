//! `generate tin`: a made survey with a road and a river, triangulated along its breaklines.

use super::tin;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, out, text};
use std::path::Path;
use yamanami::core::Tin;
use yamanami::multires::tin::{DelaunayOptions, triangulate};
use yamanami_testkit::Survey;

/// Points west to east and south to north where none are asked for.
const USUAL_SIZE: [usize; 2] = [201, 151];
/// Metres between points where none are asked for.
const USUAL_SPACING_M: f64 = 10.0;

pub(super) fn run(output: &Path, size: Option<[usize; 2]>, spacing_m: Option<f64>, seed: u64) -> Result<(), Failure> {
    inputs::check_output(output, &tin::ENDINGS, &[])?;
    let spacing_m = spacing_m.unwrap_or(USUAL_SPACING_M);
    let size_m = size.unwrap_or(USUAL_SIZE).map(|n| (n - 1) as f64 * spacing_m);
    let made = {
        let _bar = Bar::spinner("generating");
        let survey = Survey { size_m, spacing_m, seed };
        let made = triangulate(&survey.points(), &survey.breaklines(), &DelaunayOptions::default())?;
        Tin { name: format!("made survey {seed}"), ..made.tin }
    };
    tin::write(output, &made, &[])?;
    out::row("file", format_args!("{}, {}", output.display(), text::bytes(inputs::file_bytes(output)?)))?;
    let count = |n: usize| text::count(n as u64);
    let (triangles, vertices) = (made.mesh.triangles.len(), made.mesh.positions.len());
    out::row("triangles", format_args!("{}, {} vertices", count(triangles), count(vertices)))?;
    out::row("breaklines", format_args!("{}: edges and feet of a road and a river", count(made.breaklines.len())))?;
    let bounds = made.mesh.bounds();
    let [low, high] = [bounds.min.z, bounds.max.z].map(text::number);
    out::row("heights", format_args!("{low} to {high} m, over {} x {} m", size_m[0], size_m[1]))
}
