//! Many TIN files as one TIN: sheet after sheet, sorted into tiles on the disk.

use super::{TinFacts, TinTiles};
use crate::{Error, GroundOptions, read_ground};
use glam::{DVec2, DVec3};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use yamanami_core::{Crs, SnapFinder, Tin, TriangleMesh};
use yamanami_io::IoError;
use yamanami_io::scratch::Scratch;
use yamanami_io::store::TinAnnex;

/// Triangles in a tile, about, by the density of the first file.
const TILE_TRIANGLES: f64 = 400_000.0;

/// Most tiles.
const MOST_TILES: usize = 1 << 16;

/// Bytes of a triangle on the disk: three corners of three doubles.
const TRIANGLE_BYTES: usize = 72;

/// Triangles read at once.
const READ_TRIANGLES: usize = 1 << 14;

/// TIN files that lie beside each other, sorted into tiles.
#[derive(Debug)]
pub struct FileTiles {
    scratch: Scratch,
    tiles: usize,
    shared: HashSet<[u64; 3]>,
    facts: TinFacts,
    /// What was dropped, mended or assumed in each file, one line each.
    pub notes: Vec<String>,
}

fn key(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

impl FileTiles {
    /// Reads the files one after the other; `folder` is where scratch space is taken. `progress` hears of the share read.
    /// Faces of one file that cover those of another are not looked for.
    pub fn read(
        files: &[PathBuf],
        options: &GroundOptions,
        folder: &Path,
        progress: &dyn Fn(f32),
    ) -> Result<Self, Error> {
        let scratch = Scratch::create(folder, MOST_TILES)?;
        let mut tiles: HashMap<[i64; 2], usize> = HashMap::new();
        let (mut shared, mut notes, mut annex) = (HashSet::new(), Vec::new(), TinAnnex::default());
        let mut first: Option<(Crs, f64, f64, SnapFinder)> = None;
        for (number, file) in files.iter().enumerate() {
            let read = read_ground(std::slice::from_ref(file), options)?;
            notes.extend(read.notes.iter().map(|note| format!("{}: {note}", file.display())));
            let tin = read.tin;
            let (crs, unit_m, tile_m, snap) = first.get_or_insert_with(|| {
                (tin.crs.clone(), tin.unit_m, tile_side_m(&tin.mesh), SnapFinder::new(tin.unit_m))
            });
            if tin.crs != *crs || tin.unit_m != *unit_m {
                let why = format!("CRS and unit differ: {} and {}", told(crs, *unit_m), told(&tin.crs, tin.unit_m));
                return Err(IoError::Mismatch { first: files[0].clone(), second: file.clone(), why }.into());
            }
            tin.mesh.positions.iter().for_each(|&p| snap.include(p));
            sort(&tin.mesh, *tile_m, &scratch, &mut tiles, &mut shared)?;
            add(&mut annex, TinAnnex::of(&tin));
            progress((number + 1) as f32 / files.len() as f32);
        }
        let Some((crs, unit_m, _, snap)) = first else {
            return Err(Error::Request("expected a TIN file, found none".to_owned()));
        };
        let name = |p: &PathBuf| p.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let source = match files {
            [a, .., b] if files.len() > 8 => format!("{} to {}, {} files", name(a), name(b), files.len()),
            _ => files.iter().map(name).collect::<Vec<_>>().join(", "),
        };
        let facts = TinFacts { title: source.clone(), source, crs, unit_m, snap: snap.finish(), annex };
        Ok(Self { scratch, tiles: tiles.len(), shared, facts, notes })
    }
}

fn told(crs: &Crs, unit_m: f64) -> String {
    let name = crs.epsg.map_or_else(|| "no CRS".to_owned(), |code| format!("EPSG:{code}"));
    format!("{name} in units of {unit_m} m")
}

/// The side of a tile, metres.
fn tile_side_m(mesh: &TriangleMesh) -> f64 {
    let bounds = mesh.bounds();
    let extent = (bounds.max - bounds.min).truncate().max(DVec2::splat(1e-3));
    (extent.x * extent.y / mesh.triangles.len().max(1) as f64 * TILE_TRIANGLES).sqrt()
}

/// Appends what another file has beside its triangles.
fn add(annex: &mut TinAnnex, other: TinAnnex) {
    annex.breaklines.extend(other.breaklines);
    let first = annex.unseen.positions.len() as u32;
    annex.unseen.positions.extend(other.unseen.positions);
    annex.unseen.triangles.extend(other.unseen.triangles.iter().map(|t| t.map(|v| v + first)));
}

/// Sorts triangles by the tile that their middles lie in. A vertex whose own tile is not that of every triangle at it is one
/// that tiles may share.
fn sort(
    mesh: &TriangleMesh,
    tile_m: f64,
    scratch: &Scratch,
    tiles: &mut HashMap<[i64; 2], usize>,
    shared: &mut HashSet<[u64; 3]>,
) -> Result<(), Error> {
    let tile_of = |p: DVec3| [(p.x / tile_m).floor() as i64, (p.y / tile_m).floor() as i64];
    let mut waiting: HashMap<usize, Vec<u8>> = HashMap::new();
    for t in 0..mesh.triangles.len() {
        let corners = mesh.corners(t);
        let tile = tile_of((corners[0] + corners[1] + corners[2]) / 3.0);
        let count = tiles.len();
        let stream = *tiles.entry(tile).or_insert(count);
        if stream >= MOST_TILES {
            return Err(Error::Request(format!(
                "expected files beside each other, found more than {MOST_TILES} tiles"
            )));
        }
        let bytes = waiting.entry(stream).or_default();
        for p in corners {
            p.to_array().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
            if tile_of(p) != tile {
                shared.insert(key(p));
            }
        }
        if bytes.len() >= READ_TRIANGLES * TRIANGLE_BYTES {
            scratch.append(stream, bytes)?;
            bytes.clear();
        }
    }
    for (stream, bytes) in waiting {
        scratch.append(stream, &bytes)?;
    }
    Ok(())
}

impl TinTiles for FileTiles {
    fn count(&self) -> usize {
        self.tiles
    }

    fn tile(&self, number: usize) -> Result<Tin, Error> {
        let mut mesh = TriangleMesh::default();
        let mut at: HashMap<[u64; 3], u32> = HashMap::new();
        let mut buffer = vec![0; READ_TRIANGLES * TRIANGLE_BYTES];
        self.scratch.read(number, TRIANGLE_BYTES, &mut buffer, &mut |bytes| {
            for triangle in bytes.chunks_exact(TRIANGLE_BYTES) {
                let number = |at: usize| f64::from_le_bytes(std::array::from_fn(|k| triangle[at + k]));
                mesh.triangles.push([0, 24, 48].map(|corner| {
                    let p = DVec3::from_array([0, 8, 16].map(|axis| number(corner + axis)));
                    *at.entry(key(p)).or_insert_with(|| {
                        mesh.positions.push(p);
                        mesh.positions.len() as u32 - 1
                    })
                }));
            }
            Ok::<_, Error>(())
        })?;
        let breaklines = self.facts.annex.breaklines.clone();
        Ok(Tin { breaklines, ..Tin::of_mesh(String::new(), mesh) })
    }

    fn is_shared(&self, place: DVec3) -> bool {
        self.shared.contains(&key(place))
    }

    fn facts(&self) -> TinFacts {
        self.facts.clone()
    }
}
