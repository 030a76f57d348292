//! TINs from whatever survey: TIN files, points with breaklines, elevation grids; read, mended, ready to be built.

use crate::{Criteria, Error, Model, extract};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use yamanami_core::{Breakline, BreaklineKind, Crs, Tin};
use yamanami_io::points::{
    ColumnOrder, LineReadOptions, PointReadOptions, is_lines_name, is_points_name, read_lines, read_points,
};
use yamanami_io::tin_file::{self, TinReadOptions};
use yamanami_io::{IoError, dem, mesh_file};
use yamanami_multires::tin::{DelaunayOptions, GreedyOptions, greedy, mend, triangulate};

/// A TIN, and what was dropped, mended or assumed on the way to it.
#[derive(Debug, Clone)]
pub struct ReadGround {
    /// The TIN: no overlap in plan, every face counter-clockwise from above.
    pub tin: Tin,
    /// One line each.
    pub notes: Vec<String>,
}

/// How a survey becomes a TIN.
#[derive(Debug, Clone, Default)]
pub struct GroundOptions {
    /// Which surface of a TIN file, its unit and CRS where it does not say.
    pub tin: TinReadOptions,
    /// Files of lines that triangles must not cross: GeoJSON, text, or what a TIN file has.
    pub breaklines: Vec<PathBuf>,
    /// Of points: triangles with a longer edge in plan are left out, metres.
    pub longest_edge_m: Option<f64>,
    /// Of points in text: what the first coordinate is.
    pub order: ColumnOrder,
    /// Of a LAS file: the classes to take; else ground.
    pub classes: Option<Vec<u8>>,
    /// Of elevation grids: the TIN is within this of every sample, metres.
    pub max_error_m: Option<f64>,
    /// How elevation grids are read.
    pub dem: dem::OpenOptions,
}

/// Whether a file is a TIN by its name and, where that of an elevation grid may be the same, its content. Mesh files may be
/// TINs or not; they do not count here.
pub fn is_tin_file(path: &Path) -> bool {
    if !tin_file::is_tin_name(path) || mesh_file::is_mesh_name(path) {
        return false;
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let may_be_grid = ["xml", "gml", "gz", "zst"].contains(&ending.as_str());
    !may_be_grid || (!begins_as_grid(path) && dem::open(&[PathBuf::from(path)], &dem::OpenOptions::default()).is_err())
}

/// Whether an XML file begins as elevation grids of the Geospatial Information Authority of Japan do, sound or not.
fn begins_as_grid(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(4096).read_to_end(&mut head));
    read.is_ok() && head.windows(8).any(|word| word == b"<Dataset")
}

fn is_yama(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yama"))
}

/// Makes a TIN of one TIN file, mesh file that is terrain or `.yama` of a TIN; of files of points; or of elevation grids
/// that make one mosaic. Whatever it is made of, what comes out is safe.
pub fn read_ground(paths: &[PathBuf], options: &GroundOptions) -> Result<ReadGround, Error> {
    let [first, ..] = paths else {
        return Err(Error::Request("expected a file, found none".to_owned()));
    };
    let read = if paths.iter().all(is_points_name) {
        of_points(paths, options)?
    } else if let Some(max_error_m) = options.max_error_m {
        ReadGround { tin: of_grids(paths, options, max_error_m)?, notes: Vec::new() }
    } else if paths.len() > 1 {
        return Err(Error::Request("expected one TIN, or points alone, or elevation files and an error".to_owned()));
    } else if is_yama(first) {
        ReadGround { tin: Model::open(first, &|_| ())?.whole_tin()?, notes: Vec::new() }
    } else {
        of_file(first, options)?
    };
    if read.tin.mesh.triangles.is_empty() {
        let why = if read.notes.is_empty() { String::new() } else { format!(" ({})", read.notes.join("; ")) };
        return Err(Error::Request(format!("{}: expected a TIN with triangles, found none{why}", first.display())));
    }
    Ok(read)
}

fn of_file(path: &Path, options: &GroundOptions) -> Result<ReadGround, Error> {
    let read = tin_file::read_tin(path, &options.tin)?;
    let mut notes = read.notes;
    if !read.other_surfaces.is_empty() {
        let others = read.other_surfaces.iter().map(|n| format!("'{n}'")).collect::<Vec<_>>().join(", ");
        notes.push(format!("took surface '{}'; the file also has {others}", read.tin.name));
    }
    let mended = mend(read.tin);
    notes.extend(mended.faults.iter().map(ToString::to_string));
    let mut tin = mended.tin;
    // lines of other files hold where they run along edges; what else they ask for takes another triangulation
    let mut more = lines(options, &tin.crs, tin.unit_m, &mut notes)?;
    more.retain(|line| line.points.iter().all(|p| p.is_finite()));
    tin.breaklines.extend(more);
    Ok(ReadGround { tin, notes })
}

fn of_points(paths: &[PathBuf], options: &GroundOptions) -> Result<ReadGround, Error> {
    let reading = PointReadOptions {
        order: options.order,
        classes: options.classes.clone(),
        unit_m: options.tin.unit_m,
        epsg: options.tin.epsg,
    };
    let (mut points, mut notes) = (Vec::new(), Vec::new());
    let (mut crs, mut unit_m) = (Crs::default(), 1.0);
    for (number, path) in paths.iter().enumerate() {
        let read = read_points(path, &reading)?;
        points.extend(read.points_m);
        notes.extend(read.notes);
        if number == 0 {
            (crs, unit_m) = (read.crs, read.unit_m);
        } else if read.crs != crs {
            return Err(IoError::Mismatch {
                first: paths[0].clone(),
                second: path.clone(),
                why: "their CRSs differ".to_owned(),
            }
            .into());
        }
    }
    let lines = lines(options, &crs, unit_m, &mut notes)?;
    let delaunay = DelaunayOptions { longest_edge_m: options.longest_edge_m, ..DelaunayOptions::default() };
    let made =
        triangulate(&points, &lines, &delaunay).map_err(|e| Error::Request(format!("{}: {e}", paths[0].display())))?;
    notes.extend(made.notes);
    let name = paths[0].file_stem().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    Ok(ReadGround { tin: Tin { name, crs, unit_m, ..made.tin }, notes })
}

fn lines(options: &GroundOptions, crs: &Crs, unit_m: f64, notes: &mut Vec<String>) -> Result<Vec<Breakline>, Error> {
    let mut lines = Vec::new();
    for path in &options.breaklines {
        if is_lines_name(path) {
            let reading = LineReadOptions {
                order: options.order,
                unit_m: Some(options.tin.unit_m.unwrap_or(unit_m)),
                crs: crs.clone(),
                kind: BreaklineKind::Hard,
            };
            let read = read_lines(path, &reading)?;
            lines.extend(read.lines);
            notes.extend(read.notes);
        } else {
            // which surface is asked of the terrain, not of its lines
            let reading = TinReadOptions { surface: None, ..options.tin.clone() };
            let read = tin_file::read_breaklines(path, &reading)?;
            if let (Some(own), Some(wanted)) = (read.crs.epsg, crs.epsg)
                && own != wanted
            {
                let why = format!("its lines are in EPSG:{own}, the surface in EPSG:{wanted}");
                return Err(Error::Request(format!("{}: {why}", path.display())));
            }
            lines.extend(read.lines);
            notes.extend(read.notes);
        }
    }
    Ok(lines)
}

fn of_grids(paths: &[PathBuf], options: &GroundOptions, max_error_m: f64) -> Result<Tin, Error> {
    let field = dem::open(paths, &options.dem)?.read_all()?;
    let mut tin = greedy(&field, &GreedyOptions { max_error_m, most_triangles: None })?.tin;
    let geo = field.geo();
    if !geo.crs.geographic && !geo.crs.web_mercator {
        // the grid's own metres
        for p in &mut tin.mesh.positions {
            [p.x, p.y] = geo.source_from_local(p.x, p.y);
        }
        tin.crs = geo.crs.clone();
    }
    tin.name = paths[0].file_stem().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
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
}
