//! Several grids as one: the same CRS, the same step, aligned samples; later grids fill the holes of earlier ones.

use super::cache::ChunkCache;
use super::part::{Part, PartInfo, checked_size};
use super::{DemInfo, OpenOptions};
use crate::IoError;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use yamanami_core::{Crs, GeoReference, HeightField, HeightSource, Window};

/// How far, in steps, samples of two grids that should coincide may lie apart.
const MAX_MISALIGNMENT: f64 = 0.1;
/// Files kept open at once.
const MAX_OPEN_PARTS: usize = 32;
const MAX_NOTES: usize = 8;

/// An opened elevation grid: one file or a mosaic, read by windows.
pub struct DemFile {
    info: DemInfo,
    parts: Vec<Placed>,
    cache: ChunkCache,
    /// Parts that were read last, the latest at the back.
    open_parts: VecDeque<usize>,
    max_samples: u64,
    label: PathBuf,
}

struct Placed {
    part: Box<dyn Part>,
    /// Column and row of the mosaic at which the part begins.
    offset: [usize; 2],
}

impl std::fmt::Debug for DemFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("DemFile").field("info", &self.info).finish_non_exhaustive()
    }
}

fn same_crs(a: &Crs, b: &Crs) -> bool {
    match (a.epsg, b.epsg) {
        (Some(a), Some(b)) => a == b,
        (None, None) => a == b,
        _ => false,
    }
}

fn crs_name(crs: &Crs) -> String {
    match (crs.epsg, crs.name.as_str()) {
        (Some(code), name) => format!("EPSG:{code} ({name})"),
        (None, "") => "no CRS".to_owned(),
        (None, name) => format!("'{name}'"),
    }
}

/// Columns and rows from a grid's first sample to that of another, or why the two are no mosaic.
pub(super) fn offset(first: &PartInfo, info: &PartInfo) -> Result<[i64; 2], String> {
    if !same_crs(&first.geo.crs, &info.geo.crs) {
        let (a, b) = (crs_name(&first.geo.crs), crs_name(&info.geo.crs));
        return Err(format!("{a} against {b}; warp one of them, or state one CRS for both"));
    }
    let mut offset = [0; 2];
    for axis in 0..2 {
        let (a, b) = (first.geo.step[axis], info.geo.step[axis]);
        let samples = first.size[axis].max(info.size[axis]) as f64;
        if (a - b).abs() * samples > MAX_MISALIGNMENT * a.abs() {
            return Err(format!("steps of {} against {}", a.abs(), b.abs()));
        }
        let exact = (info.geo.origin[axis] - first.geo.origin[axis]) / a;
        if (exact - exact.round()).abs() > MAX_MISALIGNMENT || exact.abs() > 1e9 {
            let apart = exact - exact.round();
            return Err(format!("samples lie {apart:.3} of a step apart instead of upon each other"));
        }
        offset[axis] = exact.round() as i64;
    }
    Ok(offset)
}

impl DemFile {
    pub(super) fn new(mut parts: Vec<Box<dyn Part>>, options: &OpenOptions) -> Result<Self, IoError> {
        let Some(first) = parts.first().map(|part| part.info().clone()) else {
            return Err(IoError::BadRequest {
                what: "elevation files".to_owned(),
                expected: "at least one".to_owned(),
                given: "none".to_owned(),
            });
        };
        let mut offsets = Vec::with_capacity(parts.len());
        for part in &parts {
            let info = part.info();
            let mismatch =
                |why: String| IoError::Mismatch { first: first.label.clone(), second: info.label.clone(), why };
            offsets.push(offset(&first, info).map_err(mismatch)?);
        }
        let bound = |axis: usize| {
            let low = offsets.iter().map(|o| o[axis]).min().unwrap_or(0);
            let ends = offsets.iter().zip(&parts).map(|(o, p)| o[axis] + p.info().size[axis] as i64);
            (low, ends.max().unwrap_or(0))
        };
        let (bounds_x, bounds_y) = (bound(0), bound(1));
        let low = [bounds_x.0, bounds_y.0];
        let size = checked_size(&first.label, (bounds_x.1 - low[0]) as u64, (bounds_y.1 - low[1]) as u64)?;
        if size[0] < 2 || size[1] < 2 {
            let found = format!("{}x{}", size[0], size[1]);
            return Err(IoError::malformed(&first.label, "size of the grid", "at least 2x2 samples", found));
        }
        let geo = if parts.len() == 1 {
            first.geo.clone()
        } else {
            let origin = first.geo.source_from_grid(low[0] as f64, low[1] as f64);
            GeoReference::new(first.geo.crs.clone(), origin, first.geo.step, size)
        };

        let mut formats: Vec<String> = Vec::new();
        let mut notes: Vec<String> = Vec::new();
        for part in &parts {
            let info = part.info();
            if !formats.contains(&info.format) {
                formats.push(info.format.clone());
            }
            for note in &info.notes {
                if notes.len() < MAX_NOTES && !notes.contains(note) {
                    notes.push(note.clone());
                }
            }
        }
        if parts.len() > MAX_OPEN_PARTS {
            parts.iter_mut().for_each(|part| part.close());
        }
        let info = DemInfo {
            format: formats.join(" + "),
            files: parts.len(),
            size,
            sample_type: first.sample_type,
            geo,
            no_data: first.no_data,
            compression: first.compression,
            overviews: first.overviews,
            chunk: first.chunk,
            notes,
        };
        let place = |(part, offset): (Box<dyn Part>, [i64; 2])| Placed {
            part,
            offset: [(offset[0] - low[0]) as usize, (offset[1] - low[1]) as usize],
        };
        Ok(Self {
            info,
            parts: parts.into_iter().zip(offsets).map(place).collect(),
            cache: ChunkCache::new(options.cache_bytes),
            open_parts: VecDeque::new(),
            max_samples: options.max_samples,
            label: first.label,
        })
    }

    /// What is known without reading heights.
    pub fn info(&self) -> &DemInfo {
        &self.info
    }

    /// The first file, for messages.
    pub fn label(&self) -> &Path {
        &self.label
    }

    /// The rectangles of the grid that files fill; between them there is no data.
    pub fn parts(&self) -> impl Iterator<Item = Window> {
        self.parts.iter().map(|placed| {
            let ([column, row], [width, height]) = (placed.offset, placed.part.info().size);
            Window { column, row, width, height }
        })
    }

    /// Brings the whole grid into memory, if it has no more samples than [`OpenOptions::max_samples`].
    pub fn read_all(&mut self) -> Result<HeightField, IoError> {
        let [width, height] = self.info.size;
        let samples = width as u64 * height as u64;
        if samples > self.max_samples {
            let what = format!("samples to hold in memory ({width}x{height})");
            return Err(IoError::too_large(&self.label, what, samples, self.max_samples));
        }
        let mut heights_m = vec![f32::NAN; width * height];
        self.read_window(Window { column: 0, row: 0, width, height }, &mut heights_m)?;
        Ok(HeightField::new(width, height, heights_m, self.info.geo.clone()))
    }

    fn chunk(&mut self, part: usize, chunk: [usize; 2]) -> Result<Arc<[f32]>, IoError> {
        let key = (part, chunk[0], chunk[1]);
        if let Some(heights_m) = self.cache.get(key) {
            return Ok(heights_m);
        }
        if self.open_parts.back() != Some(&part) {
            self.open_parts.retain(|open| *open != part);
            self.open_parts.push_back(part);
            if self.open_parts.len() > MAX_OPEN_PARTS
                && let Some(oldest) = self.open_parts.pop_front()
            {
                self.parts[oldest].part.close();
            }
        }
        let heights_m: Arc<[f32]> = self.parts[part].part.read_chunk(chunk)?.into();
        self.cache.insert(key, heights_m.clone());
        Ok(heights_m)
    }
}

/// Columns or rows that two ranges share, as `start..end`.
fn overlap(a: (usize, usize), b: (usize, usize)) -> Option<(usize, usize)> {
    let (start, end) = (a.0.max(b.0), (a.0 + a.1).min(b.0 + b.1));
    (start < end).then_some((start, end))
}

impl HeightSource for DemFile {
    type Error = IoError;

    fn size(&self) -> [usize; 2] {
        self.info.size
    }

    fn geo(&self) -> &GeoReference {
        &self.info.geo
    }

    fn read_window(&mut self, window: Window, out: &mut [f32]) -> Result<(), IoError> {
        let [columns, rows] = self.info.size;
        let fits = |start: usize, length: usize, end: usize| start.checked_add(length).is_some_and(|sum| sum <= end);
        if !fits(window.column, window.width, columns)
            || !fits(window.row, window.height, rows)
            || out.len() != window.width * window.height
        {
            return Err(IoError::BadRequest {
                what: "window".to_owned(),
                expected: format!("a rectangle inside {columns}x{rows} samples and a buffer of its size"),
                given: format!("{window:?} and a buffer of {}", out.len()),
            });
        }
        out.fill(f32::NAN);
        for index in 0..self.parts.len() {
            let [part_column, part_row] = self.parts[index].offset;
            let [part_width, part_height] = self.parts[index].part.info().size;
            let shared_x = overlap((window.column, window.width), (part_column, part_width));
            let shared_y = overlap((window.row, window.height), (part_row, part_height));
            let (Some((x0, x1)), Some((y0, y1))) = (shared_x, shared_y) else { continue };
            let out_row = |y: usize| (y - window.row) * window.width + x0 - window.column;
            if index > 0 && (y0..y1).all(|y| !out[out_row(y)..][..x1 - x0].iter().any(|z| z.is_nan())) {
                continue;
            }
            let [chunk_width, chunk_height] = self.parts[index].part.info().chunk;
            for chunk_y in (y0 - part_row) / chunk_height..=(y1 - 1 - part_row) / chunk_height {
                for chunk_x in (x0 - part_column) / chunk_width..=(x1 - 1 - part_column) / chunk_width {
                    let heights_m = self.chunk(index, [chunk_x, chunk_y])?;
                    let range = self.parts[index].part.info().chunk_range([chunk_x, chunk_y]);
                    let [column, row, width, height] = range;
                    let (column, row) = (column + part_column, row + part_row);
                    let shared = (overlap((x0, x1 - x0), (column, width)), overlap((y0, y1 - y0), (row, height)));
                    let (Some((cx0, cx1)), Some((cy0, cy1))) = shared else { continue };
                    for y in cy0..cy1 {
                        let to = &mut out[(y - window.row) * window.width + cx0 - window.column..][..cx1 - cx0];
                        let from = &heights_m[(y - row) * width + cx0 - column..][..cx1 - cx0];
                        if index == 0 {
                            to.copy_from_slice(from);
                        } else {
                            for (to, from) in to.iter_mut().zip(from) {
                                if to.is_nan() {
                                    *to = *from;
                                }
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
