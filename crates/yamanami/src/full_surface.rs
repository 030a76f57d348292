//! A terrain with all its triangles, from whatever file: what exact measures are taken on.
//!
//! Heights, sections, volumes and water levels are those of the whole surface, never of a front of it.

use crate::{
    Criteria, Error, GroundOptions, Model, OpenOptions, Terrain, WaveletModel, extract, is_tin_file, read_ground,
};
use glam::{DVec2, DVec3};
use std::path::{Path, PathBuf};
use yamanami_core::{Crs, GeoReference, TriangleMesh};
use yamanami_io::points::is_points_name;
use yamanami_io::store::ClusterStore;
use yamanami_io::tin_file::TinReadOptions;
use yamanami_io::{dem, mesh_file, progressive};

/// A terrain with all its triangles.
#[derive(Debug, Clone)]
pub struct FullSurface {
    /// All triangles, in metres: in the coordinates of the source, or from the first sample of a grid east and north.
    pub mesh: TriangleMesh,
    /// The CRS of the source.
    pub crs: Crs,
    /// What its reader dropped, mended or assumed, one line each.
    pub notes: Vec<String>,
    /// Where the grid lies that it was made of, if any.
    geo: Option<GeoReference>,
}

impl FullSurface {
    /// Reads the whole of one surface: a TIN or mesh file, files of points, any `.yama`, or elevation files that make one
    /// mosaic, each of whose cells gives two triangles. `tin` tells which surface of a TIN file; `progress` hears of the
    /// share done.
    pub fn open(
        paths: &[PathBuf],
        options: &OpenOptions,
        tin: &TinReadOptions,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Self, Error> {
        if let [path] = paths
            && is_yama(path)
            && ClusterStore::is_model(path)?
        {
            let mut model = Model::open(path, progress)?;
            let crs = model.tin().map_or_else(Crs::default, |meta| meta.crs.clone());
            return Ok(Self { crs, ..Self::plain(extract(&mut model, &Criteria::default())?.mesh) });
        }
        if let [path] = paths
            && (is_mesh(path) || is_progressive(path)?)
        {
            return Ok(Self::plain(finest_mesh(path)?));
        }
        // tables of numbers may be elevation tiles, too
        let is_no_grid = || dem::open(paths, &options.dem).is_err();
        if paths.iter().all(|p| is_tin_file(p)) || (paths.iter().all(is_points_name) && is_no_grid()) {
            let epsg = options.dem.crs.as_ref().and_then(|crs| crs.epsg);
            let tin = TinReadOptions { epsg: epsg.or(tin.epsg), ..tin.clone() };
            let read = read_ground(paths, &GroundOptions { tin, ..GroundOptions::default() })?;
            return Ok(Self { crs: read.tin.crs, notes: read.notes, ..Self::plain(read.tin.mesh) });
        }
        let mut terrain = Terrain::open(paths, options, progress)?;
        let mesh = extract(&mut terrain, &Criteria::default())?.mesh;
        let geo = terrain.geo().clone();
        Ok(Self { crs: geo.crs.clone(), geo: Some(geo), ..Self::plain(mesh) })
    }

    fn plain(mesh: TriangleMesh) -> Self {
        Self { mesh, crs: Crs::default(), notes: Vec::new(), geo: None }
    }

    /// A place in the source's coordinates, in those of the mesh.
    pub fn local_from_source(&self, place: DVec2) -> DVec2 {
        self.geo.as_ref().map_or(place, |geo| geo.local_from_source(place.x, place.y).into())
    }

    /// A place in the mesh's coordinates, in those of the source.
    pub fn source_from_local(&self, place: DVec2) -> DVec2 {
        self.geo.as_ref().map_or(place, |geo| geo.source_from_local(place.x, place.y).into())
    }

    /// The mesh in the coordinates of another surface's mesh. An error says that both are known to have different CRSs.
    pub fn in_frame_of(self, other: &Self) -> Result<TriangleMesh, Error> {
        let differ = match (self.crs.epsg, other.crs.epsg) {
            (Some(own), Some(others)) => own != others,
            _ => self.crs.geographic != other.crs.geographic,
        };
        if differ {
            let name = |crs: &Crs| match crs.epsg {
                Some(code) => format!("EPSG:{code}"),
                None if crs.geographic => "longitude and latitude".to_owned(),
                None => "plain metres".to_owned(),
            };
            let [a, b] = [name(&other.crs), name(&self.crs)];
            return Err(Error::Request(format!("the two surfaces differ in CRS: {a} and {b}")));
        }
        if self.geo == other.geo {
            return Ok(self.mesh);
        }
        let place = |p: &DVec3| other.local_from_source(self.source_from_local(p.truncate())).extend(p.z);
        let positions = self.mesh.positions.iter().map(place).collect();
        Ok(TriangleMesh { positions, ..self.mesh })
    }
}

fn is_mesh(path: &Path) -> bool {
    mesh_file::is_mesh_name(path)
}

fn is_yama(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yama"))
}

fn is_progressive(path: &Path) -> Result<bool, Error> {
    Ok(is_yama(path) && progressive::is_progressive(path)?)
}

/// The mesh of a mesh file as it is, or the finest one of a model's database or progressive file.
pub fn finest_mesh(path: &Path) -> Result<TriangleMesh, Error> {
    if is_mesh(path) {
        return Ok(mesh_file::read_mesh(path)?);
    }
    if is_progressive(path)? {
        return Ok(WaveletModel::open(path, u64::MAX)?.finest());
    }
    Ok(extract(&mut Model::open(path, &|_| ())?, &Criteria::default())?.mesh)
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_measure::tin::{PlanIndex, footing, vertical_difference};
    use yamanami_testkit::SyntheticTerrain;

    fn opened(path: PathBuf) -> FullSurface {
        FullSurface::open(&[path], &OpenOptions::default(), &TinReadOptions::default(), &|_| ()).unwrap()
    }

    #[test]
    fn a_grid_its_database_and_its_mesh_are_the_same_surface() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        let field = SyntheticTerrain::mountains(33, 40, 5).to_field();
        dem::write_geotiff(&file("a.tif"), &field).unwrap();
        let grid = opened(file("a.tif"));
        let index = PlanIndex::new(&grid.mesh);
        for [column, row] in [[3, 5], [20, 1], [7, 30]] {
            let place = field.geo().source_from_grid(column as f64, row as f64);
            let at = footing(&index, grid.local_from_source(place.into())).unwrap();
            assert!((at.height_m - f64::from(field.at(column, row))).abs() < 1e-6);
        }

        let terrain = Terrain::open(&[file("a.tif")], &OpenOptions::default(), &|_| ()).unwrap();
        terrain.store_as(&file("a.yama"), &crate::StoreOptions::default(), &|_| ()).unwrap();
        let in_source = crate::to_frame(&terrain, grid.mesh.clone(), crate::Frame::Source);
        mesh_file::write_mesh(file("a.ply"), &in_source, &Default::default()).unwrap();
        for name in ["a.yama", "a.ply"] {
            let mesh = opened(file(name)).in_frame_of(&grid).unwrap();
            let d = vertical_difference(&mesh, &index);
            assert!(d.max_m < 0.01 && d.overlap_m2 > 0.0, "{name}: {d:?}");
        }
    }

    #[test]
    fn surfaces_in_different_systems_are_not_held_against_each_other() {
        let of =
            |epsg| FullSurface { crs: Crs { epsg, ..Crs::default() }, ..FullSurface::plain(TriangleMesh::default()) };
        assert!(of(Some(6677)).in_frame_of(&of(Some(6677))).is_ok() && of(None).in_frame_of(&of(Some(6677))).is_ok());
        let error = of(Some(6678)).in_frame_of(&of(Some(6677))).unwrap_err().to_string();
        assert_eq!(error, "the two surfaces differ in CRS: EPSG:6677 and EPSG:6678");
    }
}
