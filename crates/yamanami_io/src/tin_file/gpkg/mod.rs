//! Writing a GeoPackage: the triangles as polygons with their slope and aspect, the lines as lines, both in space and with
//! an index. (A type of its own for TINs exists in the format as an extension only, which few programs read.)
//!
//! Based on: Open Geospatial Consortium, "OGC GeoPackage encoding standard", 1.4, 2024.

mod geometry;
mod schema;

use crate::IoError;
use crate::mesh_file::packing::Packing;
use crate::store::write_error;
use geometry::Geometry;
use glam::{DVec2, DVec3};
use rusqlite::{Connection, Statement, params};
use schema::Table;
use std::path::{Path, PathBuf};
use yamanami_core::{Aabb, BreaklineKind, Tin};

/// Writes a TIN. The file appears whole or not at all.
pub(super) fn write(path: &Path, tin: &Tin) -> Result<(), IoError> {
    if Packing::of(path).0 != Packing::None {
        return Err(IoError::unsupported(path, "a packed GeoPackage", "write it without .gz or .zst"));
    }
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let part = Part(PathBuf::from(part));
    let io = |e| IoError::io(path, e);
    // made here, so that a missing folder or permission is told in the system's words; an old remnant is emptied
    std::fs::File::create(&part.0).map_err(io)?;
    let db = Connection::open(&part.0).map_err(|e| write_error(path, e))?;
    fill(&db, tin).map_err(|e| write_error(path, e))?;
    db.close().map_err(|(_, e)| write_error(path, e))?;
    std::fs::File::open(&part.0).and_then(|file| file.sync_all()).map_err(io)?;
    std::fs::rename(&part.0, path).map_err(io)
}

/// A file in the making, removed if it does not get its name.
struct Part(PathBuf);

impl Drop for Part {
    fn drop(&mut self) {
        // after its renaming there is nothing to remove
        let _ = std::fs::remove_file(&self.0);
    }
}

fn fill(db: &Connection, tin: &Tin) -> rusqlite::Result<()> {
    let srs_id = schema::begin(db, &tin.crs)?;
    let title = |what: &str| if tin.name.is_empty() { what.to_owned() } else { format!("{}: {what}", tin.name) };

    let triangles = Table { name: "triangles", geometry: "POLYGON", srs_id };
    triangles.create(db, "slope_deg DOUBLE, aspect_deg DOUBLE, hidden BOOLEAN NOT NULL")?;
    let mut rows = Rows::new(db, &triangles, "slope_deg, aspect_deg, hidden", 3)?;
    let shown = tin.mesh.triangles.iter().map(|t| (t, false));
    for (triangle, hidden) in shown.chain(tin.hidden.iter().map(|t| (t, true))) {
        let corners = triangle.map(|i| tin.mesh.positions[i as usize]);
        let [slope_deg, aspect_deg] = slope_and_aspect_deg(corners);
        let fid = rows.index(&corners)?;
        let blob = rows.geometry.triangle(srs_id, corners);
        rows.insert.execute(params![fid, blob, slope_deg, aspect_deg, hidden])?;
    }
    let bounds = rows.bounds;
    triangles.finish(db, &title("triangles"), bounds)?;

    let lines = Table { name: "breaklines", geometry: "LINESTRING", srs_id };
    lines.create(db, "name TEXT, kind TEXT NOT NULL")?;
    let mut rows = Rows::new(db, &lines, "name, kind", 2)?;
    for line in &tin.breaklines {
        let kind = match line.kind {
            BreaklineKind::Hard => "hard",
            BreaklineKind::Soft => "soft",
            BreaklineKind::Boundary => "boundary",
        };
        let fid = rows.index(&line.points)?;
        let blob = rows.geometry.line(srs_id, &line.points);
        rows.insert.execute(params![fid, blob, line.name, kind])?;
    }
    let bounds = rows.bounds;
    lines.finish(db, &title("breaklines"), bounds)?;

    db.execute_batch("COMMIT")
}

/// The rows of a table and of its index, as they are inserted.
struct Rows<'a> {
    insert: Statement<'a>,
    index: Statement<'a>,
    geometry: Geometry,
    count: i64,
    /// Around all rows.
    bounds: Aabb,
}

impl<'a> Rows<'a> {
    fn new(db: &'a Connection, table: &Table, columns: &str, count: usize) -> rusqlite::Result<Self> {
        let places = ", ?".repeat(count);
        Ok(Self {
            insert: db.prepare(&format!("INSERT INTO {}(fid, geom, {columns}) VALUES(?, ?{places})", table.name))?,
            index: db.prepare(&format!("INSERT INTO rtree_{}_geom VALUES(?, ?, ?, ?, ?)", table.name))?,
            geometry: Geometry::default(),
            count: 0,
            bounds: Aabb::EMPTY,
        })
    }

    /// Puts the next row into the index; its number.
    fn index(&mut self, points: &[DVec3]) -> rusqlite::Result<i64> {
        let mut bounds = Aabb::EMPTY;
        points.iter().for_each(|&p| bounds.include(p));
        self.bounds.include(bounds.min);
        self.bounds.include(bounds.max);
        self.count += 1;
        self.index.execute(params![self.count, bounds.min.x, bounds.max.x, bounds.min.y, bounds.max.y])?;
        Ok(self.count)
    }
}

/// Slope, and which way it falls, clockwise from north; nothing for what is vertical, and no way for what is level.
fn slope_and_aspect_deg([a, b, c]: [DVec3; 3]) -> [Option<f64>; 2] {
    let normal = (b - a).cross(c - a);
    let steepness: DVec2 = normal.truncate();
    if normal.z <= 0.0 {
        return [None; 2];
    }
    let slope_deg = steepness.length().atan2(normal.z).to_degrees();
    let aspect_deg = steepness.x.atan2(steepness.y).to_degrees().rem_euclid(360.0);
    [Some(slope_deg), (steepness != DVec2::ZERO).then_some(aspect_deg)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_fall_where_they_fall() {
        let plane = |x: f64, y: f64| [DVec3::ZERO, DVec3::new(1.0, 0.0, x), DVec3::new(0.0, 1.0, y)];
        let near = |corners, slope: f64, aspect: f64| {
            let [s, a] = slope_and_aspect_deg(corners).map(Option::unwrap);
            assert!((s - slope).abs() < 1e-9 && (a - aspect).abs() < 1e-9, "{s} {a}");
        };
        near(plane(1.0, 0.0), 45.0, 270.0);
        near(plane(-1.0, 0.0), 45.0, 90.0);
        near(plane(0.0, 1.0), 45.0, 180.0);
        near(plane(0.0, -1.0), 45.0, 0.0);
        assert_eq!(slope_and_aspect_deg(plane(0.0, 0.0)), [Some(0.0), None]);
        assert_eq!(slope_and_aspect_deg([DVec3::ZERO, DVec3::X, DVec3::Z]), [None, None]);
    }
}
