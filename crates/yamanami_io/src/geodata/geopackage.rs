//! GeoPackages: the features of all their tables.
//!
//! Format: Open Geospatial Consortium, "GeoPackage encoding standard", 1.4, 2024.

use super::feature::{Feature, Features, Shape};
use super::wkb;
use super::words::{Word, Words, word_of};
use crate::dem::prj;
use crate::{IoError, crs};
use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, OpenFlags};
use std::path::Path;
use yamanami_core::Crs;

/// No feature is larger.
const MOST_BLOB_BYTES: i32 = 256 << 20;

/// Reads all tables of features.
pub(super) fn read(path: &Path) -> Result<Vec<Features>, IoError> {
    // a missing file or permission is told in the system's words
    let file = std::fs::File::open(path).map_err(|e| IoError::io(path, e))?;
    if !file.metadata().map_err(|e| IoError::io(path, e))?.is_file() {
        return Err(IoError::unsupported(path, "not a regular file", "give a GeoPackage"));
    }
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let all = Connection::open_with_flags(path, flags).and_then(|db| read_all(&db));
    let all = all.map_err(|e| IoError::malformed(path, "database", "a whole GeoPackage", e.to_string()))?;
    if all.is_empty() {
        return Err(IoError::malformed(path, "gpkg_geometry_columns", "tables of features", "none"));
    }
    Ok(all)
}

fn read_all(db: &Connection) -> rusqlite::Result<Vec<Features>> {
    db.set_limit(Limit::SQLITE_LIMIT_LENGTH, MOST_BLOB_BYTES)?;
    db.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON")?;
    // tables only: a view may run for ever
    let mut select = db.prepare(
        "SELECT g.table_name, g.column_name, s.organization, s.organization_coordsys_id, s.definition
         FROM gpkg_geometry_columns g JOIN sqlite_master m ON m.type = 'table' AND m.name = g.table_name
         AND m.sql NOT LIKE 'CREATE VIRTUAL%'
         LEFT JOIN gpkg_spatial_ref_sys s ON s.srs_id = g.srs_id ORDER BY g.table_name",
    )?;
    type Row = (String, String, Option<String>, Option<i64>, Option<String>);
    let tables = select.query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?)))?;
    let tables = tables.collect::<rusqlite::Result<Vec<Row>>>()?;
    tables
        .into_iter()
        .map(|(table, column, organization, code, definition)| {
            let crs = crs_of(organization.as_deref(), code, definition.as_deref());
            let features = read_table(db, &table, &column)?;
            Ok(Features { name: table, crs, features, ..Features::default() })
        })
        .collect()
}

/// The CRS of a row of `gpkg_spatial_ref_sys`; `None` when it is said to be undefined.
fn crs_of(organization: Option<&str>, code: Option<i64>, definition: Option<&str>) -> Option<Crs> {
    let code = code.and_then(|code| u32::try_from(code).ok()).filter(|&code| code > 0)?;
    let is_epsg = organization.is_some_and(|name| name.eq_ignore_ascii_case("epsg"));
    let known = if is_epsg { crs::from_epsg(code) } else { None };
    let name = || format!("{}:{code}", organization.unwrap_or("unknown"));
    let described = || definition.and_then(prj::from_wkt);
    Some(known.or_else(described).unwrap_or_else(|| Crs { name: name(), ..Crs::default() }))
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

fn read_table(db: &Connection, table: &str, column: &str) -> rusqlite::Result<Vec<Feature>> {
    let mut columns: Vec<(String, Word)> = Vec::new();
    let mut info = db.prepare(&format!("PRAGMA table_info({})", quoted(table)))?;
    for name in info.query_map([], |row| row.get::<_, String>(1))? {
        let name = name?;
        if let Some(word) = word_of(&name).filter(|_| name != column) {
            columns.push((quoted(&name), word));
        }
    }
    let mut wanted = quoted(column);
    columns.iter().for_each(|(name, _)| wanted.extend([", ", name]));
    let mut select = db.prepare(&format!("SELECT {wanted} FROM {}", quoted(table)))?;
    let mut rows = select.query([])?;
    let mut features = Vec::new();
    while let Some(row) = rows.next()? {
        let place = format!("row {} of {table}", features.len() + 1);
        let (shape, fault) = match row.get_ref(0)? {
            ValueRef::Blob(blob) => match wkb::parse_gpkg(blob) {
                Some(shape) => (shape, None),
                None => (Shape::default(), Some("a geometry that is none".to_owned())),
            },
            _ => (Shape::default(), Some("no geometry".to_owned())),
        };
        let mut words = Words::default();
        for (k, (_, word)) in columns.iter().enumerate() {
            match row.get_ref(k + 1)? {
                ValueRef::Text(text) => words.add(*word, &String::from_utf8_lossy(text)),
                ValueRef::Integer(number) => words.add(*word, &number.to_string()),
                ValueRef::Real(number) => words.add(*word, &number.to_string()),
                _ => {}
            }
        }
        features.push(Feature { place, words, shape, fault });
    }
    Ok(features)
}
