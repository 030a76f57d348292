//! The tables of a `.yama` file, and the facts of a surface as rows of one of them.

use super::cluster::{ClusterMeta, TinMeta};
use super::facts::{Fact, Facts};
use super::meta::TerrainMeta;
use super::quantum::Quantum;
use rusqlite::types::{Value, ValueRef};
use rusqlite::{Connection, params};

/// "YAMA": bytes 68 to 71 of the file.
pub(super) const APPLICATION_ID: u32 = 0x5941_4D41;
/// Bytes 60 to 63 of the file tell what it holds and in which version; 0 while it is being written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// A terrain.
    Terrain = 1,
    /// A model of clusters.
    Clusters = 2,
    /// A TIN of clusters.
    Tin = 3,
}

impl Content {
    /// All that is known.
    pub(super) const ALL: [Self; 3] = [Self::Terrain, Self::Clusters, Self::Tin];

    /// In words.
    pub(super) fn in_words(self) -> &'static str {
        match self {
            Self::Terrain => "a terrain",
            Self::Clusters => "a model",
            Self::Tin => "a TIN",
        }
    }
}

/// Pages' bytes are stored one after the other in chunks of about this size: a blob a page would leave too much room
/// unused, and a longer one takes too long to find one's way in.
pub(super) const CHUNK_BYTES: usize = 256 << 10;

/// Bytes of a database page: every table takes one at least, which is much for a small grid; but each costs a link.
pub(super) fn db_page_bytes(size: [u32; 2]) -> u32 {
    match (u64::from(size[0]) * u64::from(size[1])).ilog2() {
        ..22 => 512,
        22..26 => 1024,
        _ => 4096,
    }
}

/// Name and statement of a table.
pub(super) type Table = (&'static str, &'static str);

const META: Table = ("meta", "CREATE TABLE meta(key TEXT PRIMARY KEY, value) WITHOUT ROWID");
const CHUNK: Table = ("chunk", "CREATE TABLE chunk(id INTEGER PRIMARY KEY, data BLOB NOT NULL)");
const PAGE: Table = (
    "page",
    "CREATE TABLE page(id INTEGER PRIMARY KEY, chunk INTEGER NOT NULL, start INTEGER NOT NULL, \
     length INTEGER NOT NULL, crc32 INTEGER NOT NULL)",
);

/// Names and statements of everything in a terrain's file; a reader insists on exactly these.
pub(super) const TERRAIN_TABLES: [Table; 5] = [
    META,
    ("level", "CREATE TABLE level(level INTEGER PRIMARY KEY, pages INTEGER NOT NULL, bound_radius_m REAL)"),
    CHUNK,
    PAGE,
    (
        "page_bounds",
        "CREATE VIRTUAL TABLE page_bounds USING rtree(id, x_min_m, x_max_m, y_min_m, y_max_m, z_min_m, z_max_m)",
    ),
];

/// The same of a model's file.
pub(super) const CLUSTER_TABLES: [Table; 4] = [
    META,
    ("node_block", "CREATE TABLE node_block(id INTEGER PRIMARY KEY, crc32 INTEGER NOT NULL, data BLOB NOT NULL)"),
    CHUNK,
    PAGE,
];

/// Writes the facts of a terrain.
pub(super) fn write_meta(db: &Connection, meta: &TerrainMeta) -> rusqlite::Result<()> {
    let mut put = fact_writer(db)?;
    let geo = &meta.geo;
    put("kind", Value::Text("terrain".into()))?;
    put("title", Value::Text(meta.title.clone()))?;
    put("source", Value::Text(meta.source.clone()))?;
    put("columns", Value::Integer(meta.size[0].into()))?;
    put("rows", Value::Integer(meta.size[1].into()))?;
    put("crs_epsg", geo.crs.epsg.map_or(Value::Null, |code| Value::Integer(code.into())))?;
    put("crs_name", Value::Text(geo.crs.name.clone()))?;
    put("crs_geographic", Value::Integer(geo.crs.geographic.into()))?;
    put("crs_web_mercator", Value::Integer(geo.crs.web_mercator.into()))?;
    put("origin_x", Value::Real(geo.origin[0]))?;
    put("origin_y", Value::Real(geo.origin[1]))?;
    put("step_x", Value::Real(geo.step[0]))?;
    put("step_y", Value::Real(geo.step[1]))?;
    put("step_x_m", Value::Real(geo.step_m[0]))?;
    put("step_y_m", Value::Real(geo.step_m[1]))?;
    put("height_min_m", Value::Real(meta.height_range_m[0].into()))?;
    put("height_max_m", Value::Real(meta.height_range_m[1].into()))?;
    put("has_holes", Value::Integer(meta.has_holes.into()))?;
    put("max_error_m", Value::Real(meta.max_error_m))?;
    put("error_steps_per_octave", Value::Integer(meta.error_steps_per_octave.into()))?;
    put("level0_slack_m", Value::Real(meta.level0_slack_m.into()))?;
    let (name, value) = match meta.quantum {
        Quantum::PerMetre(n) => ("per_metre", Value::Integer(n.into())),
        Quantum::Step(step_m) => ("step_m", Value::Real(step_m)),
        Quantum::Bits => ("bits", Value::Null),
    };
    put("quantum", Value::Text(name.into()))?;
    put("quantum_value", value)
}

/// Writes facts one by one.
fn fact_writer(db: &Connection) -> rusqlite::Result<impl FnMut(&str, Value) -> rusqlite::Result<()>> {
    let mut insert = db.prepare("INSERT INTO meta(key, value) VALUES(?1, ?2)")?;
    Ok(move |key: &str, value: Value| insert.execute(params![key, value]).map(|_| ()))
}

/// Writes the facts of a model.
pub(super) fn write_cluster_meta(db: &Connection, meta: &ClusterMeta) -> rusqlite::Result<()> {
    let mut put = fact_writer(db)?;
    put("kind", Value::Text(if meta.tin.is_some() { "tin" } else { "clusters" }.into()))?;
    put("title", Value::Text(meta.title.clone()))?;
    put("source", Value::Text(meta.source.clone()))?;
    put("source_faces", count(meta.source_faces))?;
    put("source_vertices", count(meta.source_vertices))?;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        put(&format!("{name}_min_m"), Value::Real(meta.bounds.min[axis]))?;
        put(&format!("{name}_max_m"), Value::Real(meta.bounds.max[axis]))?;
    }
    put("quantum_m", Value::Real(meta.quantum_m))?;
    put("max_error_m", Value::Real(meta.max_error_m))?;
    put("has_colours", Value::Integer(meta.has_colours.into()))?;
    put("nodes", count(meta.nodes.into()))?;
    put("triangles", count(meta.triangles))?;
    put("vertices", count(meta.vertices))?;
    if let Some(TinMeta { crs, unit_m, snap }) = &meta.tin {
        put("crs_epsg", crs.epsg.map_or(Value::Null, |code| Value::Integer(code.into())))?;
        put("crs_name", Value::Text(crs.name.clone()))?;
        put("unit_m", Value::Real(*unit_m))?;
        put("snap_unit_m", Value::Real(snap.unit_m))?;
        put("snap_per_unit", Value::Real(snap.per_unit))?;
    }
    Ok(())
}

fn count(n: u64) -> Value {
    Value::Integer(i64::try_from(n).unwrap_or(i64::MAX))
}

/// The facts as they are in the file; the inner error says what is wrong.
pub(super) fn read_meta(db: &Connection) -> rusqlite::Result<Result<Facts, String>> {
    let mut facts = Facts::default();
    let mut select = db.prepare("SELECT key, value FROM meta LIMIT 1000")?;
    let mut rows = select.query([])?;
    while let Some(row) = rows.next()? {
        let key = match row.get_ref(0)? {
            ValueRef::Text(text) => String::from_utf8_lossy(text).into_owned(),
            other => return Ok(Err(format!("a key that is {}", other.data_type()))),
        };
        let fact = match row.get::<_, Value>(1)? {
            Value::Null => Fact::Null,
            Value::Integer(v) => Fact::Integer(v),
            Value::Real(v) => Fact::Real(v),
            Value::Text(v) => Fact::Text(v),
            Value::Blob(_) => return Ok(Err(format!("`{key}` is a blob"))),
        };
        facts.insert(key, fact);
    }
    Ok(Ok(facts))
}
