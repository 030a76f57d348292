//! TINs from whatever files: read, mended, and thinned by the method that is asked for.

use crate::{Criteria, Error, Model, extract};
use std::path::{Path, PathBuf};
use yamanami_core::{HeightField, Tin};
use yamanami_io::store::ClusterStore;
use yamanami_io::tin_file::{self, TinReadOptions};
use yamanami_io::{dem, mesh_file};
use yamanami_multires::tin::{GreedyOptions, greedy, mend};

/// A TIN, and what was dropped, mended or assumed on the way to it.
#[derive(Debug, Clone)]
pub struct ReadGround {
    /// The TIN: no overlap in plan, every face counter-clockwise from above.
    pub tin: Tin,
    /// One line each.
    pub notes: Vec<String>,
}

/// Whether a file is a TIN by its name and, where that of an elevation grid may be the same, its content. Mesh files may be
/// TINs or not; they do not count here.
pub fn is_tin_file(path: &Path) -> bool {
    if !tin_file::is_tin_name(path) || mesh_file::is_mesh_name(path) {
        return false;
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let may_be_grid = ["xml", "gml", "gz", "zst"].contains(&ending.as_str());
    !may_be_grid || dem::open(&[PathBuf::from(path)], &dem::OpenOptions::default()).is_err()
}

/// Reads a TIN file, a mesh file that is terrain, or a `.yama` of a TIN, and makes it safe.
pub fn read_ground(path: &Path, options: &TinReadOptions) -> Result<ReadGround, Error> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yama")) {
        let tin = Model::open(path, &|_| ())?.whole_tin()?;
        return Ok(ReadGround { tin, notes: Vec::new() });
    }
    let read = tin_file::read_tin(path, options)?;
    let mut notes = read.notes;
    if !read.other_surfaces.is_empty() {
        notes.push(format!(
            "took surface '{}'; the file also has {}",
            read.tin.name,
            read.other_surfaces.iter().map(|n| format!("'{n}'")).collect::<Vec<_>>().join(", ")
        ));
    }
    let mended = mend(read.tin);
    notes.extend(mended.faults.iter().map(ToString::to_string));
    if mended.tin.mesh.triangles.is_empty() {
        return Err(Error::Request(format!("{}: expected a TIN with triangles, found none", path.display())));
    }
    Ok(ReadGround { tin: mended.tin, notes })
}

/// A TIN of a height field in its own metric frame, within `max_error_m` of every sample.
pub fn tin_of_field(field: &HeightField, max_error_m: f64) -> Result<Tin, Error> {
    let made = greedy(field, &GreedyOptions { max_error_m, most_triangles: None })?;
    let geo = field.geo();
    let mut tin = made.tin;
    if !geo.crs.geographic && !geo.crs.web_mercator {
        // the grid's own metres
        for p in &mut tin.mesh.positions {
            let [x, y] = geo.source_from_local(p.x, p.y);
            (p.x, p.y) = (x, y);
        }
        tin.crs = geo.crs.clone();
    }
    Ok(tin)
}

impl Model {
    /// The whole TIN: all its triangles, and what its file knew beside them. An error where the model is a scan.
    pub fn whole_tin(&mut self) -> Result<Tin, Error> {
        let Some(meta) = self.tin().cloned() else {
            return Err(Error::Request(format!("{}: expected a TIN, found a scan", crate::Subject::title(self))));
        };
        let annex = self.annex()?;
        let mesh = extract(self, &Criteria::default())?.mesh;
        let mesh = yamanami_core::TriangleMesh::new(mesh.positions, mesh.triangles);
        Ok(Tin { crs: meta.crs, unit_m: meta.unit_m, ..annex.complete(mesh) })
    }

    /// Whether a file is the database of a TIN.
    pub fn is_tin_database(path: &Path) -> Result<bool, Error> {
        Ok(ClusterStore::is_model(path)? && ClusterStore::open(path)?.meta().tin.is_some())
    }
}
