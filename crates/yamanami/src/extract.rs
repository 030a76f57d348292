//! The front for a tolerance, a view or a budget, as a mesh.

use crate::{Controller, Criteria, Data, Error, FrameReport, LimitedBy, Terrain};
use glam::DVec3;
use yamanami_core::{Hierarchy, Surface, TriangleMesh};

/// An extracted mesh and what it keeps.
#[derive(Debug, Clone)]
pub struct Extracted {
    /// The mesh, in metres in the local frame.
    pub mesh: TriangleMesh,
    /// No error left out is larger: metres without a view, pixels with one.
    pub error_left: f32,
    /// What bound the mesh.
    pub limited_by: LimitedBy,
}

/// The coordinates of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// Those of the source CRS.
    Source,
    /// Metres east and north of the first sample.
    Local,
}

/// Extracts the mesh that criteria ask for. From a database only the pages that the mesh needs are read.
pub fn extract(terrain: &Terrain, criteria: &Criteria) -> Result<Extracted, Error> {
    let surface = terrain.surface();
    if let (Data::Grid(_), None, None) = (surface.data(), &criteria.view, criteria.budget_triangles) {
        let tolerance_m = criteria.terrain_tolerance_m;
        let mesh = surface.mesh_of(&|node| surface.error_m(node) > tolerance_m);
        return Ok(Extracted { mesh, error_left: tolerance_m, limited_by: LimitedBy::Tolerance });
    }
    let mut controller = Controller::new(surface);
    let report = settle(terrain, &mut controller, criteria)?;
    let mesh = surface.mesh_of(controller.front());
    Ok(Extracted { mesh, error_left: report.error_left, limited_by: report.limited_by })
}

/// Updates a front until no page is missing.
pub(crate) fn settle(
    terrain: &Terrain,
    controller: &mut Controller,
    criteria: &Criteria,
) -> Result<FrameReport, Error> {
    loop {
        let report = controller.update(terrain.surface(), criteria, |_, _| ());
        if report.wanted.is_empty() || terrain.load(&report.wanted, usize::MAX)? == 0 {
            return Ok(report);
        }
    }
}

/// Moves a mesh of the local frame into a frame for writing.
pub fn to_frame(terrain: &Terrain, mut mesh: TriangleMesh, frame: Frame) -> TriangleMesh {
    if frame == Frame::Source {
        for p in &mut mesh.positions {
            let [x, y] = terrain.geo().source_from_local(p.x, p.y);
            *p = DVec3::new(x, y, p.z);
        }
    }
    mesh
}
