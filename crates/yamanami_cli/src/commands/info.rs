//! `info`: what is this file?

use super::info_text::{database_json, dem_json, print_database, print_dem};
use super::render;
use super::{info_mesh, info_model, info_tin, progressive};
use crate::args::ReadingArgs;
use crate::failure::Failure;
use crate::pictures::{self, PICTURE_ENDINGS};
use crate::progress::Bar;
use crate::{inputs, out};
use clap::Args;
use glam::DVec3;
use serde_json::Value;
use std::path::{Path, PathBuf};
use yamanami::core::{GeoReference, HeightField, HeightSource, View, Window};
use yamanami::gpu::{Background, Haze, RenderOptions};
use yamanami::io::{
    dem, mesh_file,
    store::{ClusterStore, TerrainStore},
};
use yamanami::{Criteria, DrawWith, Subject, Terrain, ViewCriterion};

/// Tell what a file is: elevation data, TIN, database or mesh
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami info dem.tif                        format, size, spacing, CRS, heights, no-data
  yamanami info N4?E001.hgt.zip                several elevation files are told as one mosaic
  yamanami info dem.tif --picture dem.png      with a small map
  yamanami info dem.yama mesh.glb --json       one object, or an array of several")]
pub(crate) struct InfoArgs {
    /// Elevation files and tile folders (together one mosaic), .yama databases, TIN and mesh files
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Draw a small map of the elevation data
    #[arg(long, value_name = "P.png")]
    picture: Option<PathBuf>,
    /// Read every page of a database and check it
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    reading: ReadingArgs,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// What a pass over the heights finds.
#[derive(Debug)]
pub(crate) struct HeightFacts {
    pub(crate) range_m: Option<[f32; 2]>,
    pub(crate) no_data: u64,
    /// Every so many samples, for a picture.
    sparse: Option<HeightField>,
}

/// Longest side of the map in pixels.
const MAP_PX: u32 = 640;
/// Most samples along a side of what the map is drawn from.
const SPARSE_SIDE: usize = 1280;
/// Samples read at once.
const BAND_SAMPLES: usize = 1 << 22;

pub(crate) fn run(args: &InfoArgs) -> Result<(), Failure> {
    if let Some(picture) = &args.picture {
        inputs::check_output(picture, &PICTURE_ENDINGS, &args.files)?;
    }
    let (apart, dems): (Vec<_>, Vec<_>) =
        args.files.iter().cloned().partition(|f| inputs::is_yama(f) || mesh_file::is_mesh_name(f) || inputs::is_tin(f));
    let mut found = Vec::new();
    let mut map = None;
    if !dems.is_empty() {
        let mut file = dem::open(&dems, &args.reading.options().dem)?;
        let facts = scan(&mut file, args.picture.is_some())?;
        found.push(dem_json(&dems, &file, &facts));
        if !args.json {
            print_dem(&dems, &file, &facts)?;
        }
        if let Some(sparse) = facts.sparse {
            map = Some(Terrain::build(sparse, String::new(), &|_| ())?);
        }
    }
    for path in &apart {
        if !args.json && !found.is_empty() {
            out::line("")?;
        }
        if inputs::is_progressive(path)? {
            found.push(progressive::tell(path, args.json)?);
        } else if inputs::is_yama(path) && ClusterStore::is_model(path)? {
            found.push(info_model::tell(path, args.json, args.verify)?);
        } else if inputs::is_yama(path) {
            found.push(database(path, args)?);
            if map.is_none() && args.picture.is_some() {
                map = Some(inputs::open(std::slice::from_ref(path), &args.reading)?);
            }
        } else if inputs::is_tin(path) {
            found.push(info_tin::tell(path, args.json)?);
        } else {
            found.push(info_mesh::tell(path, args.json)?);
        }
    }
    if args.json {
        out::json(&if found.len() == 1 { found.remove(0) } else { Value::Array(found) })?;
    }
    match (&args.picture, map) {
        (Some(picture), Some(mut terrain)) => draw_map(&mut terrain, picture, args.json),
        (Some(_), None) => Err(Failure::failed("--picture: there is no elevation data among the files")),
        (None, _) => Ok(()),
    }
}

fn database(path: &Path, args: &InfoArgs) -> Result<Value, Failure> {
    let store = TerrainStore::open(path)?;
    if args.verify {
        let _bar = Bar::spinner("verifying");
        store.verify()?;
    }
    let bytes = inputs::file_bytes(path)?;
    if !args.json {
        print_database(path, &store, bytes, args.verify)?;
    }
    Ok(database_json(path, &store, bytes, args.verify))
}

/// Reads all heights once, band by band.
fn scan(file: &mut dem::DemFile, keep_sparse: bool) -> Result<HeightFacts, Failure> {
    let [width, height] = file.size();
    let stride = [width, height].map(|n| width.max(height).div_ceil(SPARSE_SIDE).min(n - 1).max(1));
    let mut sparse = Vec::new();
    let chunk_rows = file.info().chunk[1].clamp(1, height);
    let rows = (BAND_SAMPLES / width / chunk_rows).max(1) * chunk_rows;
    let (mut range, mut no_data) = ([f32::INFINITY, f32::NEG_INFINITY], 0u64);
    let mut band = Vec::new();
    let bar = Bar::shares("reading");
    for first in (0..height).step_by(rows) {
        let window = Window { column: 0, row: first, width, height: rows.min(height - first) };
        band.resize(width * window.height, 0.0f32);
        file.read_window(window, &mut band)?;
        for &z in &band {
            if z.is_finite() {
                range = [range[0].min(z), range[1].max(z)];
            } else {
                no_data += 1;
            }
        }
        if keep_sparse {
            let kept = band.chunks_exact(width).zip(first..).filter(|(_, row)| row % stride[1] == 0);
            sparse.extend(kept.flat_map(|(row, _)| row.iter().step_by(stride[0]).copied()));
        }
        bar.set_share((first + window.height) as f32 / height as f32);
    }
    let range_m = (range[0] <= range[1]).then_some(range);
    let sparse = keep_sparse.then(|| {
        let size = [width.div_ceil(stride[0]), height.div_ceil(stride[1])];
        let step_m = file.geo().step_m;
        let geo = GeoReference::local([step_m[0] * stride[0] as f64, step_m[1] * stride[1] as f64], size[1]);
        HeightField::new(size[0], size[1], sparse, geo)
    });
    Ok(HeightFacts { range_m, no_data, sparse })
}

/// Draws a shaded map, north up, from high above.
fn draw_map(terrain: &mut Terrain, file: &Path, json: bool) -> Result<(), Failure> {
    let [east_m, north_m] = terrain.extent_m();
    let longest = east_m.max(north_m);
    let side = |m: f64| ((m / longest * f64::from(MAP_PX)).round() as u32).clamp(MAP_PX / 16, MAP_PX);
    let size = [side(east_m), side(north_m)];
    let fov_y_rad = 2f64.to_radians();
    let top_m = f64::from(terrain.range_m()[1]);
    let across_m = north_m.max(east_m * f64::from(size[1]) / f64::from(size[0]));
    let target = DVec3::new(0.5 * east_m, -0.5 * north_m, top_m);
    let eye = target + DVec3::Z * (0.505 * across_m / (0.5 * fov_y_rad).tan());
    let view = View { eye, target, fov_y_rad, viewport_px: size };
    let style = RenderOptions { haze: Haze::None, background: Background::Plain([255; 3]), ..terrain.usual_style() };
    let criteria =
        Criteria { view: Some(ViewCriterion { view, tolerance_px: 0.01, cull: false }), ..Criteria::default() };
    let drawn = render::picture(terrain, &criteria, &view, &style, DrawWith::Software)?;
    pictures::write(file, drawn.picture)?;
    if json { Ok(()) } else { out::row("picture", format_args!("{}, {} x {}", file.display(), size[0], size[1])) }
}
