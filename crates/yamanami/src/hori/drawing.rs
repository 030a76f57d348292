//! Times: drawing the full map and reduced ones, and following the map while α and the eye move.
//!
//! The paper draws 3,958,784 polygons in 6.4 s and 77,128 in 0.4 s on its machine of 2008. Here the software renderer
//! draws.

use super::engine::EQUAL_COUNT;
use super::modes::{HoriMode, mesh_of, two_ways};
use super::{PAPER_TRIANGLES, Study};
use crate::{BaseOptions, Error, draw_base};
use glam::DVec2;
use std::time::Instant;
use yamanami_core::{DeformedMap, FieldLevel, MapView};
use yamanami_gpu::ResidentBuffers;
use yamanami_lod::{Band, BandTable, PAPER_BLOCK_M};
use yamanami_map::{ReliefStyle, paint};
use yamanami_measure::LARGE_PX;
use yamanami_multires::rtin::band_mesh::PeakRule;

/// Drawings that a time is the median of.
const RUNS: usize = 5;
/// α, and the eye's place in metres, at the end of the flight, and its frames.
const LAST_ALPHA: f64 = 0.3;
const LAST_EYE_M: DVec2 = DVec2::new(2_400.0, 1_200.0);
const FRAMES: u32 = 60;

/// How long drawing takes.
#[derive(Debug, Clone)]
pub struct HoriDraw {
    /// What is drawn.
    pub name: &'static str,
    /// Triangles.
    pub triangles: u64,
    /// Median time of drawing, milliseconds.
    pub draw_ms: f64,
}

/// How the mesh follows while the map changes.
#[derive(Debug, Clone)]
pub struct HoriFlight {
    /// What is asked of it.
    pub name: &'static str,
    /// Frames.
    pub frames: u32,
    /// Time to find the new front and change the mesh: of a frame in the mean, and at worst, milliseconds.
    pub update_ms: [f64; 2],
    /// Nodes applied in a frame, in the mean.
    pub refined: f64,
    /// Nodes undone in a frame, in the mean.
    pub coarsened: f64,
    /// Bytes written in a frame, in the mean and at most.
    pub bytes: [f64; 2],
    /// Fewest and most triangles.
    pub triangles: [usize; 2],
    /// No ground of any frame is drawn further from its place, pixels.
    pub bound_px: f32,
}

/// Every sample of the paper's blocks.
pub(super) fn full_mesh(grid: &FieldLevel, view: &MapView) -> Result<ResidentBuffers, Error> {
    // halved as often as there are samples
    let level = u32::MAX;
    let all = Band { near_m: 0.0, far_m: f64::INFINITY, hypotenuse_m: grid.spacing_m(), level };
    let table = BandTable { bands: vec![all], block_m: PAPER_BLOCK_M };
    Ok(ResidentBuffers::from_mesh(&mesh_of(grid, view, &table, PeakRule::None, &[])?.mesh))
}

/// The paper's mesh.
pub(super) fn paper_mesh(study: &Study) -> Result<ResidentBuffers, Error> {
    let [(table, peaks, ..), _] = two_ways(&study.tables);
    let built = mesh_of(study.grid(), &study.view, table, peaks, &study.summits)?;
    Ok(ResidentBuffers::from_mesh(&built.mesh))
}

/// Times of the full map, the paper's and the engine's.
pub(super) fn times(study: &mut Study, modes: &[HoriMode]) -> Result<Vec<HoriDraw>, Error> {
    let view = study.view;
    let painted = paint(study.scene.field(), &ReliefStyle::default(), view.map.centre);
    let options = BaseOptions::painted(painted)?;
    let time = |name: &'static str, mesh: &ResidentBuffers| -> Result<HoriDraw, Error> {
        let mut runs = [0.0; RUNS];
        for run in &mut runs {
            let started = Instant::now();
            draw_base(mesh, &view, &options, &|_| ())?;
            *run = 1e3 * started.elapsed().as_secs_f64();
        }
        runs.sort_by(f64::total_cmp);
        Ok(HoriDraw { name, triangles: mesh.triangle_count() as u64, draw_ms: runs[RUNS / 2] })
    };
    let mut draws = vec![
        time("every sample", &full_mesh(study.grid(), &view)?)?,
        time("table 1, the paper's peaks", &paper_mesh(study)?)?,
    ];
    let count = modes.iter().find(|mode| mode.file == EQUAL_COUNT).map(|mode| mode.triangles as u32);
    for (name, tolerance_px, budget) in [
        ("engine, as many as the bands", 0.0, count),
        ("engine, 1.5 px", 1.5, None),
        ("engine, 3.5 px", LARGE_PX as f32, None),
    ] {
        study.scene.update(&view, tolerance_px, budget)?;
        draws.push(time(name, study.scene.canvas().buffers())?);
    }
    Ok(draws)
}

/// α goes up and the eye goes away, at a tolerance and at the paper's count.
pub(super) fn flights(study: &mut Study) -> Result<Vec<HoriFlight>, Error> {
    let [_, reduced] = PAPER_TRIANGLES;
    Ok(vec![
        flight(study, "3.5 px", LARGE_PX as f32, None)?,
        flight(study, "at most 77,128 triangles", 0.0, Some(reduced as u32))?,
    ])
}

fn flight(study: &mut Study, name: &'static str, tolerance_px: f32, budget: Option<u32>) -> Result<HoriFlight, Error> {
    let at = |share: f64| {
        let map = DeformedMap { alpha: share * LAST_ALPHA, centre: share * LAST_EYE_M, ..study.view.map };
        MapView { map, ..study.view }
    };
    let scene = &mut study.scene;
    scene.check(&at(1.0).map).map_err(|fault| Error::Request(fault.to_string()))?;
    scene.update(&at(0.0), tolerance_px, budget)?;
    let mut flight = HoriFlight {
        name,
        frames: FRAMES,
        update_ms: [0.0; 2],
        refined: 0.0,
        coarsened: 0.0,
        bytes: [0.0; 2],
        triangles: [usize::MAX, 0],
        bound_px: 0.0,
    };
    let each = 1.0 / f64::from(FRAMES);
    for frame in 1..=FRAMES {
        let update = scene.update(&at(each * f64::from(frame)), tolerance_px, budget)?;
        let ms = 1e3 * update.update_time.as_secs_f64();
        let bytes = update.upload.bytes as f64;
        flight.update_ms = [flight.update_ms[0] + each * ms, flight.update_ms[1].max(ms)];
        flight.bytes = [flight.bytes[0] + each * bytes, flight.bytes[1].max(bytes)];
        flight.refined += each * update.report.refined as f64;
        flight.coarsened += each * update.report.coarsened as f64;
        let [fewest, most] = flight.triangles;
        flight.triangles = [fewest.min(update.report.triangles), most.max(update.report.triangles)];
        flight.bound_px = flight.bound_px.max(update.report.error_left);
    }
    Ok(flight)
}
