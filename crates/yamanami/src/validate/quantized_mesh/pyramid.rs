//! A pyramid of quantized-mesh tiles: which there are, where they lie, and their decoded content.
//!
//! Based on: Cesium, "Quantized-mesh-1.0 terrain format", 2013 to 2024; Mapbox, "TileJSON 2.1".

use crate::Error;
use crate::validate::cache::Cache;
use glam::DVec3;
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::Arc;
use yamanami_core::TriangleMesh;
use yamanami_io::crs;
use yamanami_io::inspect::{Container, Fault, Faults, QuantizedMesh, quantized_mesh, without_gzip};
use yamanami_measure::tiles::earth::{SEMI_MAJOR_M, ecef_m};
use yamanami_measure::tiles::{Profile, plan_faults};

/// The greatest coordinate of a vertex.
pub(super) const GRID: f64 = 32767.0;

/// Bytes of decoded tiles that are held.
const HELD_BYTES: usize = 192 << 20;

/// A tile's zoom, column from the west and row from the south.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct TileId {
    pub(super) z: u32,
    pub(super) x: u32,
    pub(super) y: u32,
}

impl TileId {
    /// The tile that holds this one, so many levels above.
    pub(super) fn ancestor(self, levels: u32) -> Self {
        Self { z: self.z - levels, x: self.x >> levels, y: self.y >> levels }
    }

    pub(super) fn children(self) -> [Self; 4] {
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| Self { z: self.z + 1, x: 2 * self.x + x, y: 2 * self.y + y })
    }
}

/// A tile decoded, with the heights along its sides.
#[derive(Debug)]
pub(super) struct Tile {
    pub(super) id: TileId,
    pub(super) mesh: QuantizedMesh,
    /// West, south, east, north; places in steps of the tile's lattice.
    pub(super) sides: [Profile; 4],
    /// Bytes as stored.
    pub(super) stored: usize,
    /// Area that triangles cover, of 1.
    pub(super) covered: f64,
}

impl Tile {
    /// Half a step of its heights, metres.
    pub(super) fn half_step_m(&self) -> f64 {
        let [low, high] = self.mesh.heights_m;
        (high - low).abs() / GRID / 2.0
    }

    /// Its surface over a plan that `place` makes of u and v.
    pub(super) fn surface(&self, place: impl Fn(f64, f64) -> [f64; 2]) -> TriangleMesh {
        let vertex = |v: &[u16; 3]| {
            let [x, y] = place(f64::from(v[0]), f64::from(v[1]));
            DVec3::new(x, y, self.mesh.height_m(*v))
        };
        TriangleMesh::new(self.mesh.vertices.iter().map(vertex).collect(), self.mesh.triangles.clone())
    }
}

/// All tiles of a pyramid.
#[derive(Debug)]
pub(super) struct Pyramid {
    container: Container,
    pub(super) tiles: BTreeSet<TileId>,
    /// layer.json, where it could be read.
    pub(super) layer: Option<Value>,
    /// Rows in names count from the north.
    from_north: bool,
    /// Squares of Web Mercator, not of longitude and latitude.
    pub(super) mercator: bool,
    /// What stands around z/x/y in names.
    around: [String; 2],
    cache: Cache<TileId, Result<Tile, ()>>,
}

impl Pyramid {
    /// Lists a folder's tiles by the template that its layer.json has.
    pub(super) fn open(container: Container, layer: Option<Value>) -> Result<Self, Error> {
        let text = |key: &str| layer.as_ref().and_then(|l| l[key].as_str()).unwrap_or_default().to_owned();
        let template = layer.as_ref().and_then(|l| l["tiles"][0].as_str()).unwrap_or("{z}/{x}/{y}.terrain");
        let template = template.split(['?', '#']).next().unwrap_or_default().replace("{version}", &text("version"));
        let around = match template.split_once("{z}/{x}/{y}") {
            Some((before, after)) => [before.trim_start_matches("./").to_owned(), after.to_owned()],
            None => [String::new(), ".terrain".to_owned()],
        };
        let mut pyramid = Self {
            from_north: text("scheme").eq_ignore_ascii_case("slippyMap"),
            mercator: text("projection") == "EPSG:3857",
            around,
            tiles: BTreeSet::new(),
            cache: Cache::new(HELD_BYTES),
            container,
            layer,
        };
        for name in pyramid.container.list()? {
            let id = pyramid.id_of(&name);
            pyramid.tiles.extend(id);
        }
        Ok(pyramid)
    }

    fn id_of(&self, name: &str) -> Option<TileId> {
        let middle = name.strip_prefix(&self.around[0])?.strip_suffix(&self.around[1])?;
        let mut numbers = middle.split('/').map(|part| part.parse::<u32>().ok());
        let (z, x, y) = (numbers.next()??, numbers.next()??, numbers.next()??);
        let fits = numbers.next().is_none() && z <= 30 && x < self.columns(z) && y < 1 << z;
        fits.then(|| TileId { z, x, y: if self.from_north { (1 << z) - 1 - y } else { y } })
    }

    /// The name of a tile's file.
    pub(super) fn name(&self, id: TileId) -> String {
        let row = if self.from_north { (1 << id.z) - 1 - id.y } else { id.y };
        format!("{}{}/{}/{row}{}", self.around[0], id.z, id.x, self.around[1])
    }

    /// Columns of a zoom.
    pub(super) fn columns(&self, z: u32) -> u32 {
        if self.mercator { 1 << z } else { 2 << z }
    }

    /// Side of a tile in degrees, or in metres of Web Mercator.
    fn side(&self, z: u32) -> f64 {
        let half_world = if self.mercator { std::f64::consts::PI * SEMI_MAJOR_M } else { 90.0 };
        2.0 * half_world / f64::from(1u32 << z)
    }

    /// Plan position of u and v in a tile: degrees, or metres of Web Mercator.
    pub(super) fn plan(&self, id: TileId, [u, v]: [f64; 2]) -> [f64; 2] {
        let side = self.side(id.z);
        let west = if self.mercator { -std::f64::consts::PI * SEMI_MAJOR_M } else { -180.0 };
        let south = if self.mercator { west } else { -90.0 };
        [west + (f64::from(id.x) + u / GRID) * side, south + (f64::from(id.y) + v / GRID) * side]
    }

    /// Longitude and latitude in degrees of a plan position.
    pub(super) fn lon_lat(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        if !self.mercator {
            return [x, y];
        }
        [(x / SEMI_MAJOR_M).to_degrees(), (y / SEMI_MAJOR_M).sinh().atan().to_degrees()]
    }

    /// Plan position of a longitude and latitude.
    pub(super) fn plan_of(&self, [lon, lat]: [f64; 2]) -> [f64; 2] {
        if !self.mercator {
            return [lon, lat];
        }
        crs::from_epsg(3857).and_then(|m| crs::from_lon_lat(&m, lon, lat)).unwrap_or([f64::NAN; 2])
    }

    /// Longitude and latitude of a tile's corner or inner point.
    pub(super) fn place(&self, id: TileId, [u, v]: [f64; 2]) -> [f64; 2] {
        self.lon_lat(self.plan(id, [u, v]))
    }

    /// Earth-centred positions of a tile's vertices.
    pub(super) fn positions_m(&self, id: TileId, mesh: &QuantizedMesh) -> Vec<DVec3> {
        let position = |v: &[u16; 3]| {
            let [lon, lat] = self.place(id, [f64::from(v[0]), f64::from(v[1])]);
            ecef_m([lon, lat, mesh.height_m(*v)])
        };
        mesh.vertices.iter().map(position).collect()
    }

    /// A tile without its faults; `None` where it cannot be read, which is told once by [`Self::read`].
    pub(super) fn tile(&self, id: TileId) -> Option<Arc<Result<Tile, ()>>> {
        if !self.tiles.contains(&id) {
            return None;
        }
        let made = self.cache.get(id, || -> Result<_, ()> {
            let tile = self.read(id).0.ok_or(());
            let bytes = tile
                .as_ref()
                .map_or(64, |t| 22 * t.mesh.triangles.len() + t.sides.iter().map(Profile::size_bytes).sum::<usize>());
            Ok((tile, bytes))
        });
        made.ok().filter(|tile| tile.is_ok())
    }

    /// Reads a tile and what is wrong with its bytes.
    pub(super) fn read(&self, id: TileId) -> (Option<Tile>, Vec<Fault>) {
        let mut faults = Faults::default();
        let tile = match self.container.read(&self.name(id)) {
            Ok(Some(stored)) => without_gzip(&stored, "QM01", &mut faults)
                .and_then(|bytes| quantized_mesh(&bytes, &mut faults))
                .map(|mesh| Self::with_sides(id, mesh, stored.len())),
            Ok(None) => None,
            Err(cause) => {
                faults.add("QM01", "", "a file that can be read", cause.to_string());
                None
            }
        };
        (tile, faults.into_vec())
    }

    fn with_sides(id: TileId, mesh: QuantizedMesh, stored: usize) -> Tile {
        let side = |axis: usize, value: u16| {
            let on_side = mesh.vertices.iter().filter(|v| v[axis] == value);
            Profile::new(on_side.map(|v| [f64::from(v[1 - axis]), mesh.height_m(*v)]).collect())
        };
        let sides = [side(0, 0), side(1, 0), side(0, GRID as u16), side(1, GRID as u16)];
        let plan = plan_faults(&mesh.vertices, &mesh.triangles, GRID as u16);
        let covered = (plan.twice_area as f64 / (2.0 * GRID * GRID)).min(1.0);
        Tile { id, mesh, sides, stored, covered }
    }

    pub(super) fn has_children(&self, id: TileId) -> bool {
        id.z < 30 && id.children().iter().any(|child| self.tiles.contains(child))
    }
}
