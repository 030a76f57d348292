//! The front for a tolerance, a view or a budget, as a mesh.

use crate::{Controller, Criteria, Error, FrameReport, LimitedBy, Subject};
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
    /// Those of the source: its CRS, or the model file's own.
    Source,
    /// Metres east and north of the first sample.
    Local,
}

/// Extracts the mesh that criteria ask for. From a database only the pages that the mesh needs are read.
pub fn extract(subject: &mut impl Subject, criteria: &Criteria) -> Result<Extracted, Error> {
    if let (false, None, None) = (subject.is_paged(), &criteria.view, criteria.budget_triangles) {
        let surface = subject.surface();
        let tolerance_m = criteria.terrain_tolerance_m;
        let mesh = surface.mesh_of(&|node| surface.error_m(node) > tolerance_m);
        return Ok(Extracted { mesh, error_left: tolerance_m, limited_by: LimitedBy::Tolerance });
    }
    let mut controller = Controller::new(subject.surface());
    let report = settle(subject, &mut controller, criteria)?;
    let mesh = subject.surface().mesh_of(controller.front());
    Ok(Extracted { mesh, error_left: report.error_left, limited_by: report.limited_by })
}

/// Updates a front until no page is missing.
pub(crate) fn settle(
    subject: &mut impl Subject,
    controller: &mut Controller,
    criteria: &Criteria,
) -> Result<FrameReport, Error> {
    loop {
        let report = controller.update(subject.surface(), criteria, |_, _| ());
        if report.wanted.is_empty() || subject.load(&report.wanted, usize::MAX)? == 0 {
            return Ok(report);
        }
    }
}

/// Moves a mesh of the local frame into a frame for writing.
pub fn to_frame(subject: &impl Subject, mut mesh: TriangleMesh, frame: Frame) -> TriangleMesh {
    if frame == Frame::Source {
        for p in &mut mesh.positions {
            *p = subject.source_from_local(*p);
        }
    }
    mesh
}
