//! Judges pyramids of height pictures: Terrain-RGB, Terrarium and GSI, as folders z/x/y.png or PMTiles.
//!
//! Tiles of pixels have no seams to close: neighbours are held against each other by the step from one's last row to the
//! other's first, which should be no greater than steps inside of both, and a tile against its children by their means.

use super::cache::Cache;
use super::report::{ErrorRow, ValidateReport};
use super::{Progress, Source, ValidateOptions, sample};
use crate::Error;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use yamanami_core::{HeightSource, Window};
use yamanami_io::dem::{self, OpenOptions, TileEncoding};
use yamanami_io::inspect::{Container, Fault, Faults, PmTile, PmTiles, without_gzip};

/// Bytes of decoded tiles that are held.
const HELD_BYTES: usize = 128 << 20;

/// A tile's step to its neighbour may be so many times the greatest step inside of either.
const STEPS: f64 = 3.0;

/// Zoom, column, row from the north.
type TileId = [u32; 3];

enum Where {
    Folder(Container),
    Archive(Box<PmTiles>, BTreeMap<TileId, PmTile>),
}

struct Pyramid {
    place: Where,
    tiles: BTreeSet<TileId>,
    options: OpenOptions,
    cache: Cache<TileId, Option<Heights>>,
}

/// Size and bytes of a tile, what is wrong with it, and how far its heights are from its children's.
type Checked = (Option<([usize; 2], usize)>, Vec<Fault>, f64);

/// A tile's heights in metres, row by row from the north-west; NaN where there are none.
#[derive(Debug)]
struct Heights {
    size: [usize; 2],
    heights_m: Vec<f32>,
    bytes: usize,
}

impl Heights {
    fn at(&self, column: usize, row: usize) -> f64 {
        f64::from(self.heights_m[row * self.size[0] + column])
    }

    /// Greatest step from one pixel to the next along a line of them.
    fn step(&self, line: impl Fn(usize) -> [usize; 2], count: usize) -> f64 {
        let at = |k: usize| {
            let [c, r] = line(k);
            self.at(c, r)
        };
        (1..count).map(|k| (at(k) - at(k - 1)).abs()).filter(|d| d.is_finite()).fold(0.0, f64::max)
    }
}

/// Judges a folder z/x/y.png.
pub(super) fn folder(
    path: &Path,
    options: &ValidateOptions,
    source: Option<&Source>,
    progress: Progress<'_>,
) -> Result<ValidateReport, Error> {
    let container = Container::folder(path);
    let tiles: BTreeSet<TileId> = container.list()?.iter().filter_map(|name| id_of(name)).collect();
    if tiles.is_empty() {
        return Err(Error::Request(format!("{}: expected tiles named z/x/y.png, found none", path.display())));
    }
    judge(Where::Folder(container), tiles, path, ValidateReport::new("raster tiles"), options, source, progress)
}

/// Judges a PMTiles archive.
pub(super) fn archive(
    path: &Path,
    options: &ValidateOptions,
    source: Option<&Source>,
    progress: Progress<'_>,
) -> Result<ValidateReport, Error> {
    let mut report = ValidateReport::new("PMTiles archive");
    let mut faults = Faults::default();
    let archive = PmTiles::open(path, &mut faults)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    report.add_all(&name, faults.into_vec());
    let Some(archive) = archive else { return Ok(report) };
    if archive.tile_type != 2 {
        report.add("PM11", &name, "header", "tile type 2, PNG", archive.tile_type.to_string());
    }
    let places: BTreeMap<TileId, PmTile> = archive.tiles.iter().map(|tile| (tile.place, *tile)).collect();
    let tiles = places.keys().copied().collect();
    judge(Where::Archive(Box::new(archive), places), tiles, path, report, options, source, progress)
}

fn id_of(name: &str) -> Option<TileId> {
    let mut numbers = name.strip_suffix(".png")?.rsplit('/').map(|part| part.parse::<u32>().ok());
    let (y, x, z) = (numbers.next()??, numbers.next()??, numbers.next()??);
    (z <= 30 && u64::from(x.max(y)) < 1 << z && numbers.next().is_none()).then_some([z, x, y])
}

fn name_of([z, x, y]: TileId) -> String {
    format!("{z}/{x}/{y}.png")
}

fn judge(
    place: Where,
    tiles: BTreeSet<TileId>,
    path: &Path,
    mut report: ValidateReport,
    options: &ValidateOptions,
    source: Option<&Source>,
    progress: Progress<'_>,
) -> Result<ValidateReport, Error> {
    let mut pyramid = Pyramid { place, tiles, options: options.dem.clone(), cache: Cache::new(HELD_BYTES) };
    pyramid.settle_encoding(path);
    let all: Vec<TileId> = pyramid.tiles.iter().copied().collect();
    let chosen = options.tiles.map_or_else(|| all.clone(), |n| sample(&all, n, options.seed));
    report.tiles = [all.len() as u64, chosen.len() as u64];
    let least = all.iter().map(|id| id[0]).min().unwrap_or(0);
    let encoding = pyramid.options.tile_encoding.map_or("unknown colours", TileEncoding::name);
    report.kind = format!("{} of {encoding}", report.kind);
    let mut size: Option<[usize; 2]> = None;
    let mut rows: BTreeMap<u32, ErrorRow> = BTreeMap::new();
    const AT_ONCE: usize = 64;
    for (k, ids) in chosen.chunks(AT_ONCE).enumerate() {
        progress("tiles", (k * AT_ONCE) as f32 / chosen.len() as f32);
        let found: Vec<_> = ids.par_iter().map(|&id| pyramid.check(id)).collect();
        for (&id, (own, faults, worst_m)) in ids.iter().zip(found) {
            let name = name_of(id);
            report.add_all(&name, faults);
            if id[0] > least && !pyramid.tiles.contains(&[id[0] - 1, id[1] / 2, id[2] / 2]) {
                let parent = name_of([id[0] - 1, id[1] / 2, id[2] / 2]);
                report.add("RT06", &name, "", format!("its parent {parent}"), "no such tile");
            }
            let Some(([width, height], bytes)) = own else { continue };
            report.bytes += bytes as u64;
            let first = *size.get_or_insert([width, height]);
            if first != [width, height] {
                report.add(
                    "RT02",
                    &name,
                    "",
                    format!("{first:?} pixels as the others"),
                    format!("{:?}", [width, height]),
                );
            } else if width != height || ![256, 512].contains(&width) {
                report.add("RT03", &name, "", "256 or 512 pixels square", format!("{width} x {height}"));
            }
            let row = rows.entry(id[0]).or_insert(ErrorRow { level: id[0], ..ErrorRow::default() });
            row.tiles += 1;
            row.measured_m = row.measured_m.max(worst_m);
        }
    }
    if let Some(source) = source {
        super::raster_fit::measure(&chosen, &mut rows, source, &mut report, &|id| pyramid.grid(id), &|s| {
            progress("errors", s)
        })?;
    }
    report.errors.extend(rows.into_values());
    Ok(report)
}

impl Pyramid {
    /// One encoding for all: as told, else as the deepest tile's colours and the path say.
    fn settle_encoding(&mut self, path: &Path) {
        for &id in self.tiles.iter().rev().take(16) {
            if self.options.tile_encoding.is_some() {
                return;
            }
            let Ok(bytes) = self.bytes(id) else { continue };
            let options = OpenOptions { tile: Some(id), ..self.options.clone() };
            let Ok(file) = dem::from_bytes(path.join(name_of(id)), bytes, &options) else { continue };
            let format = file.info().format.clone();
            let all = [TileEncoding::TerrainRgb, TileEncoding::Terrarium, TileEncoding::Gsi];
            self.options.tile_encoding = all.into_iter().find(|e| format.starts_with(e.name()));
        }
    }

    fn bytes(&self, id: TileId) -> Result<Vec<u8>, String> {
        match &self.place {
            Where::Folder(container) => match container.read(&name_of(id)) {
                Ok(bytes) => bytes.ok_or_else(|| "no such file".into()),
                Err(cause) => Err(cause.to_string()),
            },
            Where::Archive(archive, places) => {
                let tile = places.get(&id).ok_or("no such tile")?;
                let bytes = archive.read(tile).map_err(|e| e.to_string())?;
                without_gzip(&bytes, "RT01", &mut Faults::default())
                    .map(|b| b.into_owned())
                    .ok_or_else(|| "damaged gzip".into())
            }
        }
    }

    fn decode(&self, id: TileId) -> Result<Heights, String> {
        let bytes = self.bytes(id)?;
        let length = bytes.len();
        let options = OpenOptions { tile: Some(id), ..self.options.clone() };
        let read = || {
            let mut file = dem::from_bytes(name_of(id), bytes, &options)?;
            let size = file.size();
            let mut heights_m = vec![f32::NAN; size[0] * size[1]];
            file.read_window(Window { column: 0, row: 0, width: size[0], height: size[1] }, &mut heights_m)?;
            Ok(Heights { size, heights_m, bytes: length })
        };
        read().map_err(|e: yamanami_io::IoError| e.to_string())
    }

    fn heights(&self, id: TileId) -> Option<Arc<Option<Heights>>> {
        if !self.tiles.contains(&id) {
            return None;
        }
        let made = self.cache.get(id, || -> Result<_, ()> {
            let heights = self.decode(id).ok();
            let bytes = heights.as_ref().map_or(64, |h| 4 * h.heights_m.len());
            Ok((heights, bytes))
        });
        made.ok().filter(|h| h.is_some())
    }

    /// Size and heights of a tile.
    fn grid(&self, id: TileId) -> Option<([usize; 2], Vec<f32>)> {
        self.heights(id)?.as_ref().as_ref().map(|h| (h.size, h.heights_m.clone()))
    }

    fn check(&self, id: TileId) -> Checked {
        let mut faults = Faults::default();
        let own = match self.decode(id) {
            Ok(own) => own,
            Err(cause) => {
                faults.add("RT01", "", "a whole PNG of heights", cause);
                return (None, faults.into_vec(), 0.0);
            }
        };
        let [z, x, y] = id;
        let columns = 1u32 << z;
        let east = self.heights([z, (x + 1) % columns, y]).filter(|_| columns > 1);
        for (side, other) in [("east", east), ("south", self.heights([z, x, y + 1]))] {
            if let Some(Some(other)) = other.as_deref() {
                check_side(&own, other, side, &mut faults);
            }
        }
        let worst_m = self.check_children(id, &own, &mut faults);
        (Some((own.size, own.bytes)), faults.into_vec(), worst_m)
    }

    fn check_children(&self, [z, x, y]: TileId, own: &Heights, faults: &mut Faults) -> f64 {
        let mut worst_m: f64 = 0.0;
        for [dx, dy] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let Some(child) = self.heights([z + 1, 2 * x + dx, 2 * y + dy]) else { continue };
            let Some(child) = child.as_ref().as_ref().filter(|c| c.size == own.size) else { continue };
            let (mut apart, mut rough, mut count) = (0.0, 0.0, 0u32);
            for row in 0..own.size[1] / 2 {
                for column in 0..own.size[0] / 2 {
                    let at = |c: usize, r: usize| child.at(2 * column + c, 2 * row + r);
                    let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                    let mean = four.iter().sum::<f64>() / 4.0;
                    let (dx, dy) = (dx as usize * own.size[0] / 2, dy as usize * own.size[1] / 2);
                    let d = (own.at(column + dx, row + dy) - mean).abs();
                    if d.is_finite() {
                        let range = four.iter().copied().fold(f64::MIN, f64::max)
                            - four.iter().copied().fold(f64::MAX, f64::min);
                        (apart, rough, count) = (apart + d, rough + range, count + 1);
                        worst_m = worst_m.max(d);
                    }
                }
            }
            // means of four, and picks of one of them, lie within the range of the four
            if count > 0 && apart > 2.0 * rough + f64::from(count) {
                let found = format!("{:.1} m apart on the mean", apart / f64::from(count));
                let name = name_of([z + 1, 2 * x + dx, 2 * y + dy]);
                faults.add("RT05", "", format!("heights like those of {name}"), found);
            }
        }
        worst_m
    }
}

/// The step to a neighbour against the steps inside.
fn check_side(own: &Heights, other: &Heights, side: &str, faults: &mut Faults) {
    if own.size != other.size || own.size[0].min(own.size[1]) < 4 {
        return;
    }
    let [width, height] = own.size;
    let count = if side == "east" { height } else { width };
    let (mut over, mut inside, mut worst) = (0.0, 0.0, (0.0, 0));
    let mut compared = 0u32;
    for k in 0..count {
        let (a, b, c, d) = if side == "east" {
            (own.at(width - 2, k), own.at(width - 1, k), other.at(0, k), other.at(1, k))
        } else {
            (own.at(k, height - 2), own.at(k, height - 1), other.at(k, 0), other.at(k, 1))
        };
        let step = (c - b).abs();
        if step.is_finite() && (b - a).is_finite() && (d - c).is_finite() {
            (over, inside) = (over + step, inside + ((b - a).abs() + (d - c).abs()) / 2.0);
            compared += 1;
            if step > worst.0 {
                worst = (step, k);
            }
        }
    }
    // pixels that lie on both sides' border make no step
    let along = own.step(|k| if side == "east" { [width - 1, k] } else { [k, height - 1] }, count);
    let mean = |sum: f64| sum / f64::from(compared.max(1));
    if compared > 0 && mean(over) > STEPS * mean(inside) + 1.0 && worst.0 > along {
        let found = format!("{:.1} m on the mean, {:.1} m at pixel {}", mean(over), worst.0, worst.1);
        faults.add("RT04", format!("{side} side"), format!("steps like those inside, {:.1} m", mean(inside)), found);
    }
}
