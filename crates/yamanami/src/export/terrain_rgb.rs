//! Heights as colours of PNG tiles: a folder of zoom/column/row.png with its TileJSON, or one PMTiles archive by the output's
//! ending.

use super::{ExportJob, ExportKind, ExportReport, ExportSubject, ZoomReport};
use crate::{Error, HeightTiles, MOST_ZOOM, SurfaceHeights, halved};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use yamanami_io::dem::TileEncoding;
use yamanami_io::tiles::{PmtilesArchive, PmtilesFacts, TileFolder, TileOutput, encode_height_png};

pub(super) fn tiles(subject: ExportSubject<'_>, job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    let terrain = subject.terrain("terrain-rgb")?;
    let heights = SurfaceHeights::of(terrain)?;
    let tiles = HeightTiles::new(&heights, job.options.tile_px)?;
    let zooms = job.options.zooms.unwrap_or([0, tiles.full_zoom()]);
    if zooms[1] > MOST_ZOOM {
        return Err(Error::Request(format!("zoom {}: expected at most {MOST_ZOOM}", zooms[1])));
    }
    let facts = |report: &ExportReport| facts(terrain.title(), &tiles, report, job.options.tile_encoding);
    if job.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("pmtiles")) {
        let archive = PmtilesArchive::create(job.output)?;
        let report = write(&tiles, zooms, job, &archive)?;
        let zooms = zooms_of(&report);
        archive.finish(&PmtilesFacts { zooms, bounds_deg: tiles.bounds_deg(), metadata: facts(&report) })?;
        return Ok(report);
    }
    let folder = TileFolder::create(job.output, &job.identity(ExportKind::TerrainRgb))?;
    let report = write(&tiles, zooms, job, &folder)?;
    folder.put("tiles.json", facts(&report).to_string().as_bytes())?;
    folder.finish()?;
    Ok(report)
}

/// Coarsest and finest zoom that have tiles.
fn zooms_of(report: &ExportReport) -> [u32; 2] {
    [report.zooms.first(), report.zooms.last()].map(|zoom| zoom.map_or(0, |zoom| zoom.zoom))
}

/// TileJSON 3.0, which is also what an archive says of itself.
fn facts(title: &str, tiles: &HeightTiles<'_>, report: &ExportReport, encoding: TileEncoding) -> Value {
    let [coarsest, finest] = zooms_of(report);
    let [west, south, east, north] = tiles.bounds_deg();
    json!({
        "tilejson": "3.0.0",
        "name": title,
        "tiles": ["{z}/{x}/{y}.png"],
        "minzoom": coarsest,
        "maxzoom": finest,
        "bounds": [west, south, east.min(180.0), north],
        "type": "raster-dem",
        "format": "png",
        "tileSize": tiles.side_px(),
        "encoding": match encoding {
            TileEncoding::Terrarium => "terrarium",
            TileEncoding::Gsi => "gsi",
            _ => "mapbox",
        },
    })
}

fn write(
    tiles: &HeightTiles<'_>,
    zooms: [u32; 2],
    job: &ExportJob<'_>,
    output: &dyn TileOutput,
) -> Result<ExportReport, Error> {
    let encoding = job.options.tile_encoding;
    let count = |zoom: u32| tiles.tiles(zoom).map(|range| range.count() as u64).iter().product::<u64>();
    let full = tiles.full_zoom();
    let all = count(full) + (full + 1..=zooms[1]).map(count).sum::<u64>();
    let run = Run {
        tiles,
        zooms,
        encoding,
        output,
        job,
        all,
        done: AtomicU64::new(0),
        kept: AtomicU64::new(0),
        written: Mutex::new(vec![[0; 2]; zooms[1] as usize + 1]),
    };
    run.pyramid(0, 0, 0)?;
    for zoom in full + 1..=zooms[1] {
        let [columns, rows] = tiles.tiles(zoom);
        rows.into_par_iter().try_for_each(|y| {
            columns.clone().try_for_each(|x| {
                let x = x & ((1 << zoom) - 1);
                run.finest(zoom, x, y).map(|_| ())
            })
        })?;
    }
    let written = run.written.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let of = |zoom: u32| {
        let [tiles, bytes] = written[zoom as usize];
        ZoomReport { zoom, tiles, bytes, error_m: 0.5 * encoding.quantum_m(), ..ZoomReport::default() }
    };
    let mut notes = Vec::new();
    if zooms[0] < full {
        notes.push(format!(
            "below zoom {full} a pixel is the mean height of its ground; the error told is that of the colours"
        ));
    }
    // on the coarsest zooms a small terrain is less than a pixel
    let zooms: Vec<ZoomReport> = (zooms[0]..=zooms[1]).map(of).filter(|zoom| zoom.tiles > 0).collect();
    if zooms.is_empty() {
        return Err(Error::Request("there is no ground to be seen in these zooms".to_owned()));
    }
    Ok(ExportReport { zooms, kept: run.kept.into_inner(), notes })
}

/// One export under way.
struct Run<'a> {
    tiles: &'a HeightTiles<'a>,
    zooms: [u32; 2],
    encoding: TileEncoding,
    output: &'a dyn TileOutput,
    job: &'a ExportJob<'a>,
    /// Finest tiles that may be there, and those looked at.
    all: u64,
    done: AtomicU64,
    kept: AtomicU64,
    /// Tiles and bytes by zoom.
    written: Mutex<Vec<[u64; 2]>>,
}

impl Run<'_> {
    /// Writes a tile and all below it down to the full zoom; gives its heights.
    fn pyramid(&self, zoom: u32, x: u32, y: u32) -> Result<Option<Vec<f32>>, Error> {
        if !self.tiles.reaches(zoom, x, y) {
            return Ok(None);
        }
        if zoom >= self.tiles.full_zoom() {
            return self.finest(zoom, x, y);
        }
        let below = |dx: u32, dy: u32| self.pyramid(zoom + 1, 2 * x + dx, 2 * y + dy);
        let ((a, b), (c, d)) =
            rayon::join(|| rayon::join(|| below(0, 0), || below(1, 0)), || rayon::join(|| below(0, 1), || below(1, 1)));
        let quarters = [a?, b?, c?, d?];
        if quarters.iter().all(Option::is_none) {
            return Ok(None);
        }
        let heights_m = self.joined(&quarters);
        self.put(zoom, x, y, &heights_m)?;
        Ok(Some(heights_m))
    }

    /// Writes a tile of the surface itself.
    fn finest(&self, zoom: u32, x: u32, y: u32) -> Result<Option<Vec<f32>>, Error> {
        let heights_m = self.tiles.heights_m(zoom, x, y)?;
        if let Some(heights_m) = &heights_m {
            self.put(zoom, x, y, heights_m)?;
        }
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        (self.job.progress)((done as f32 / self.all.max(1) as f32).min(1.0));
        Ok(heights_m)
    }

    /// A tile of the four below it.
    fn joined(&self, quarters: &[Option<Vec<f32>>; 4]) -> Vec<f32> {
        let side = self.tiles.side_px() as usize;
        let mut large = vec![f32::NAN; 4 * side * side];
        for (k, quarter) in quarters.iter().enumerate() {
            let first = (k / 2) * side * 2 * side + (k % 2) * side;
            for (row, heights_m) in quarter.iter().flat_map(|q| q.chunks_exact(side)).enumerate() {
                let at = first + row * 2 * side;
                large[at..at + side].copy_from_slice(heights_m);
            }
        }
        halved(&large, 2 * side)
    }

    fn put(&self, zoom: u32, x: u32, y: u32, heights_m: &[f32]) -> Result<(), Error> {
        // thin ground may be lost in the means
        if !(self.zooms[0]..=self.zooms[1]).contains(&zoom) || heights_m.iter().all(|z| z.is_nan()) {
            return Ok(());
        }
        let path = format!("{zoom}/{x}/{y}.png");
        let mut bytes = 0;
        if self.output.has(&path) {
            self.kept.fetch_add(1, Ordering::Relaxed);
        } else {
            let png = encode_height_png(self.encoding, heights_m, self.tiles.side_px());
            self.output.put(&path, &png)?;
            bytes = png.len() as u64;
        }
        let mut written = self.written.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let [tiles, sum] = &mut written[zoom as usize];
        *tiles += 1;
        *sum += bytes;
        Ok(())
    }
}
