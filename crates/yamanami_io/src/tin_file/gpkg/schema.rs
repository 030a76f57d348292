//! The tables of a GeoPackage, and the index of a feature table with the triggers that keep it.
//!
//! Based on: Open Geospatial Consortium, "OGC GeoPackage encoding standard", 1.4, 2024, annexes C and F.3.

use crate::crs::well_known_text;
use rusqlite::{Connection, params};
use yamanami_core::{Aabb, Crs};

/// Positions in no known CRS.
const UNDEFINED_CARTESIAN: i32 = -1;

/// "GPKG", version 1.4, and the tables that every GeoPackage has.
const BEGIN: &str = "
PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA locking_mode = EXCLUSIVE;
PRAGMA application_id = 0x47504B47; PRAGMA user_version = 10400;
BEGIN;
CREATE TABLE gpkg_spatial_ref_sys(
  srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents(
  table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE, description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
  min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER,
  CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns(
  table_name TEXT NOT NULL, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL,
  z TINYINT NOT NULL, m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name), CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_extensions(
  table_name TEXT, column_name TEXT, extension_name TEXT NOT NULL, definition TEXT NOT NULL, scope TEXT NOT NULL,
  CONSTRAINT ge_tce UNIQUE (table_name, column_name, extension_name));
";

const INSERT_SRS: &str = "INSERT OR IGNORE INTO gpkg_spatial_ref_sys VALUES(?1, ?2, ?3, ?4, ?5, ?6)";

const WGS84: &str = r#"GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]]"#;

/// The triggers of an index, for a table in place of `TABLE`.
const TRIGGERS: &str = "
CREATE TRIGGER rtree_TABLE_geom_insert AFTER INSERT ON TABLE
  WHEN (new.geom NOT NULL AND NOT ST_IsEmpty(NEW.geom))
  BEGIN INSERT OR REPLACE INTO rtree_TABLE_geom VALUES (
    NEW.fid, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom)); END;
CREATE TRIGGER rtree_TABLE_geom_update2 AFTER UPDATE ON TABLE
  WHEN OLD.fid = NEW.fid AND (NEW.geom ISNULL OR ST_IsEmpty(NEW.geom))
  BEGIN DELETE FROM rtree_TABLE_geom WHERE id = OLD.fid; END;
CREATE TRIGGER rtree_TABLE_geom_update4 AFTER UPDATE ON TABLE
  WHEN OLD.fid != NEW.fid AND (NEW.geom ISNULL OR ST_IsEmpty(NEW.geom))
  BEGIN DELETE FROM rtree_TABLE_geom WHERE id IN (OLD.fid, NEW.fid); END;
CREATE TRIGGER rtree_TABLE_geom_update5 AFTER UPDATE ON TABLE
  WHEN OLD.fid != NEW.fid AND (NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom))
  BEGIN DELETE FROM rtree_TABLE_geom WHERE id = OLD.fid;
  INSERT OR REPLACE INTO rtree_TABLE_geom VALUES (
    NEW.fid, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom)); END;
CREATE TRIGGER rtree_TABLE_geom_update6 AFTER UPDATE OF geom ON TABLE
  WHEN OLD.fid = NEW.fid AND (NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom))
    AND (OLD.geom NOTNULL AND NOT ST_IsEmpty(OLD.geom))
  BEGIN UPDATE rtree_TABLE_geom SET minx = ST_MinX(NEW.geom), maxx = ST_MaxX(NEW.geom),
    miny = ST_MinY(NEW.geom), maxy = ST_MaxY(NEW.geom) WHERE id = NEW.fid; END;
CREATE TRIGGER rtree_TABLE_geom_update7 AFTER UPDATE OF geom ON TABLE
  WHEN OLD.fid = NEW.fid AND (NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom))
    AND (OLD.geom ISNULL OR ST_IsEmpty(OLD.geom))
  BEGIN INSERT INTO rtree_TABLE_geom VALUES (
    NEW.fid, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom)); END;
CREATE TRIGGER rtree_TABLE_geom_delete AFTER DELETE ON TABLE
  WHEN old.geom NOT NULL BEGIN DELETE FROM rtree_TABLE_geom WHERE id = OLD.fid; END;
";

/// Begins a file of features in a CRS; its number in the file.
pub(super) fn begin(db: &Connection, crs: &Crs) -> rusqlite::Result<i32> {
    db.execute_batch(BEGIN)?;
    let mut insert = db.prepare(INSERT_SRS)?;
    insert.execute(params![
        "Undefined Cartesian SRS",
        UNDEFINED_CARTESIAN,
        "NONE",
        -1,
        "undefined",
        "no CRS is known"
    ])?;
    insert.execute(params!["Undefined geographic SRS", 0, "NONE", 0, "undefined", "no CRS is known"])?;
    insert.execute(params!["WGS 84", 4326, "EPSG", 4326, WGS84, "longitude and latitude in degrees"])?;
    let Some(srs_id) = crs.epsg.and_then(|epsg| i32::try_from(epsg).ok()).filter(|&id| id > 0) else {
        return Ok(UNDEFINED_CARTESIAN);
    };
    // most readers go by the code
    let definition = well_known_text(crs).unwrap_or("undefined".into());
    insert.execute(params![crs.name, srs_id, "EPSG", srs_id, definition, "x and y in metres"])?;
    Ok(srs_id)
}

/// A table of features with z.
pub(super) struct Table {
    pub(super) name: &'static str,
    /// Type of its geometries.
    pub(super) geometry: &'static str,
    pub(super) srs_id: i32,
}

impl Table {
    /// Creates the table, with these columns behind the geometry, and its index.
    pub(super) fn create(&self, db: &Connection, columns: &str) -> rusqlite::Result<()> {
        let Self { name, geometry, .. } = self;
        db.execute_batch(&format!(
            "CREATE TABLE {name}(fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {geometry}, {columns});
             CREATE VIRTUAL TABLE rtree_{name}_geom USING rtree(id, minx, maxx, miny, maxy)",
        ))
    }

    /// Enters the table, which has all its rows, into the tables of the GeoPackage.
    pub(super) fn finish(&self, db: &Connection, title: &str, bounds: Aabb) -> rusqlite::Result<()> {
        let Self { name, geometry, srs_id } = self;
        // the box of an empty table is not known
        let known = |value: f64| value.is_finite().then_some(value);
        let (min, max) = (bounds.min, bounds.max);
        db.execute(
            "INSERT INTO gpkg_contents(table_name, data_type, identifier, min_x, min_y, max_x, max_y, srs_id)
             VALUES(?1, 'features', ?2, ?3, ?4, ?5, ?6, ?7)",
            params![name, title, known(min.x), known(min.y), known(max.x), known(max.y), srs_id],
        )?;
        let columns = "INSERT INTO gpkg_geometry_columns VALUES(?1, 'geom', ?2, ?3, 1, 0)";
        db.execute(columns, params![name, geometry, srs_id])?;
        db.execute(
            "INSERT INTO gpkg_extensions VALUES(?1, 'geom', 'gpkg_rtree_index', \
             'http://www.geopackage.org/spec140/#extension_rtree', 'write-only')",
            params![name],
        )?;
        db.execute_batch(&TRIGGERS.replace("TABLE", name))
    }
}
