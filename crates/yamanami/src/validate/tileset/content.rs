//! The triangles of a tile in the world, and whether volumes hold them.

use super::tree::{Tile, Tree};
use crate::validate::cache::Cache;
use glam::{DVec2, DVec3};
use std::sync::Arc;
use yamanami_core::TriangleMesh;
use yamanami_io::inspect::{Fault, Faults, Wrapped, glb, unwrapped, without_gzip};
use yamanami_measure::tiles::OpenEdges;
use yamanami_measure::tiles::earth::{SEMI_MINOR_M, geodetic, is_on_earth, local_from_ecef};

/// Bytes of decoded tiles that are held.
const HELD_BYTES: usize = 256 << 20;

/// Of its size a volume may be smaller than what it holds, for single precision.
const TOLERATED: f64 = 1e-6;

/// The triangles of a tile.
#[derive(Debug, Default)]
pub(super) struct Content {
    pub(super) mesh: TriangleMesh,
    pub(super) stored: usize,
    /// Size from corner to corner, metres.
    pub(super) size_m: f64,
}

/// Where a terrain tile is looked at from above.
#[derive(Debug, Clone, Copy)]
pub(super) struct Level {
    origin: DVec3,
    local_from_world: glam::DMat3,
}

impl Level {
    /// A position east, north and up of the origin.
    pub(super) fn local(&self, p: DVec3) -> DVec3 {
        self.local_from_world * (p - self.origin)
    }

    pub(super) fn plan(&self, p: DVec3) -> (DVec2, f64) {
        let p = self.local(p);
        (p.truncate(), p.z)
    }

    pub(super) fn surface(&self, mesh: &TriangleMesh) -> TriangleMesh {
        TriangleMesh::new(mesh.positions.iter().map(|&p| self.local(p)).collect(), mesh.triangles.clone())
    }
}

/// Decodes contents and keeps them for a while.
pub(super) struct Contents<'t, 'c> {
    pub(super) tree: &'t Tree<'c>,
    pub(super) is_on_globe: bool,
    meshes: Cache<usize, Content>,
    edges: Cache<usize, OpenEdges>,
}

impl<'t, 'c> Contents<'t, 'c> {
    pub(super) fn new(tree: &'t Tree<'c>) -> Self {
        let is_far = |tile: &Tile| tile.volume.is_some_and(|v| v.sphere().0.length() > 0.5 * SEMI_MINOR_M);
        let is_on_globe = tree.tiles.first().is_some_and(is_far);
        Self { tree, is_on_globe, meshes: Cache::new(HELD_BYTES), edges: Cache::new(HELD_BYTES / 4) }
    }

    /// A tile's triangles; none where they cannot be read.
    pub(super) fn mesh(&self, tile: usize) -> Arc<Content> {
        let made = self.meshes.get(tile, || -> Result<_, std::convert::Infallible> {
            let content = self.read(tile).0;
            let bytes = 24 * content.mesh.positions.len() + 12 * content.mesh.triangles.len();
            Ok((content, bytes))
        });
        match made {
            Ok(content) => content,
            Err(never) => match never {},
        }
    }

    /// The open edges of a tile's triangles.
    pub(super) fn edges(&self, tile: usize) -> Arc<OpenEdges> {
        let made = self.edges.get(tile, || -> Result<_, std::convert::Infallible> {
            let content = self.mesh(tile);
            let edges = OpenEdges::new(&content.mesh, (1e-7 * content.size_m).max(1e-6));
            let bytes = 160 * edges.len();
            Ok((edges, bytes))
        });
        match made {
            Ok(edges) => edges,
            Err(never) => match never {},
        }
    }

    /// Reads a tile's files and judges them.
    pub(super) fn read(&self, number: usize) -> (Content, Vec<(String, Vec<Fault>)>) {
        let tile = &self.tree.tiles[number];
        let mut content = Content::default();
        let mut all = Vec::new();
        for name in &tile.contents {
            let mut faults = Faults::default();
            match self.tree.container.read(name) {
                Ok(Some(bytes)) => {
                    content.stored += bytes.len();
                    let plain = without_gzip(&bytes, "TS10", &mut faults);
                    if let Some(plain) = plain {
                        take(tile, &plain, &mut content.mesh, &mut faults);
                    }
                }
                Ok(None) => faults.add("TS09", "", "a file", "none"),
                Err(cause) => faults.add("TS09", "", "a file that can be read", cause.to_string()),
            }
            all.push((name.clone(), faults.into_vec()));
        }
        content.size_m = if content.mesh.positions.is_empty() { 0.0 } else { content.mesh.bounds().diagonal() };
        (content, all)
    }

    /// Whether the volumes of a tile and of all above it hold its content.
    pub(super) fn check_volumes(&self, number: usize, content: &Content, faults: &mut Faults) {
        let tolerated_m = (TOLERATED * content.size_m).max(0.01);
        let mut at = Some(number);
        while let Some(k) = at {
            let tile = &self.tree.tiles[k];
            at = tile.parent;
            let Some(volume) = tile.volume else { continue };
            let outside = content.mesh.positions.iter().map(|&p| volume.outside_m(p));
            let farthest = outside.clone().fold(0.0, f64::max);
            let tolerated_m = tolerated_m.max(TOLERATED * volume.sphere().1);
            if farthest > tolerated_m {
                let count = outside.filter(|&d| d > tolerated_m).count();
                let found =
                    format!("{count} of {} vertices outside, by up to {farthest:.3} m", content.mesh.positions.len());
                let (code, whose) =
                    if k == number { ("TS07", String::new()) } else { ("TS06", format!(" of {}", tile.name)) };
                faults.add(code, "boundingVolume", format!("vertices within the volume{whose}"), found);
            }
        }
        let bad = content.mesh.positions.iter().find(|&&p| self.is_on_globe && !is_on_earth(p));
        if let Some(p) = bad {
            faults.add("TS12", "content", "places near the ground", format!("{:.0}, {:.0}, {:.0}", p.x, p.y, p.z));
        }
    }

    /// The level frame of a terrain tile; `None` where triangles hang over, or it spans too much of the globe.
    pub(super) fn level(&self, content: &Content) -> Option<Level> {
        const WIDEST_M: f64 = 400e3;
        if content.mesh.triangles.is_empty() {
            return None;
        }
        let origin = content.mesh.bounds().centre();
        let local_from_world = if self.is_on_globe {
            let [lon, lat, _] = geodetic(origin);
            local_from_ecef([lon, lat])
        } else {
            glam::DMat3::IDENTITY
        };
        let level = Level { origin, local_from_world };
        let (mut up, mut down) = (0.0, 0.0);
        for t in 0..content.mesh.triangles.len() {
            let [a, b, c] = content.mesh.corners(t).map(|p| level.local(p));
            let turn = (b - a).truncate().perp_dot((c - a).truncate());
            *(if turn > 0.0 { &mut up } else { &mut down }) += turn.abs();
        }
        (down <= 1e-4 * up && !(self.is_on_globe && content.size_m > WIDEST_M)).then_some(level)
    }
}

fn take(tile: &Tile, bytes: &[u8], mesh: &mut TriangleMesh, faults: &mut Faults) {
    match unwrapped(bytes, faults) {
        Wrapped::Glb { glb: bytes, centre_m } => {
            let found = glb(bytes, faults).mesh;
            let first = mesh.positions.len() as u32;
            let place = |p: &DVec3| tile.world_from_tile.transform_point3(*p + DVec3::from(centre_m));
            mesh.positions.extend(found.positions.iter().map(place));
            mesh.triangles.extend(found.triangles.iter().map(|t| t.map(|c| first + c)));
        }
        Wrapped::Tileset => {}
        Wrapped::Other(kind) => faults.add("TS16", "content", "binary glTF or b3dm", kind),
        Wrapped::Unknown => {
            let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4)]).into_owned();
            faults.add("TS10", "content", "glTF, b3dm, i3dm, pnts, cmpt or a tileset", format!("'{start}'"));
        }
        #[allow(unreachable_patterns)]
        _ => {}
    }
}
