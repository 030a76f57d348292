//! The triangulated irregular network: a terrain surveyed as points, lines and triangles.
//!
//! A TIN is 2.5D: seen from above its triangles do not overlap. What only its file knows travels along, so that it can be
//! written back as it was: the lines that must not be smoothed away, the faces that the surveyor hid, the unit.

use crate::{Crs, TriangleMesh};
use glam::DVec3;

/// International foot, metres.
pub const FOOT_M: f64 = 0.3048;

/// US survey foot, metres.
pub const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;

/// A triangulated irregular network.
#[derive(Debug, Clone, PartialEq)]
pub struct Tin {
    /// Name of the surface, as its file has it. May be empty.
    pub name: String,
    /// Vertices in metres (x east, y north, z up, in the CRS's own axes: whatever the unit of the file, never shifted) and
    /// the triangles that are shown, counter-clockwise from above.
    pub mesh: TriangleMesh,
    /// Triangles that the file marks as invisible: outside the survey, or a hole in it. By the mesh's vertices.
    pub hidden: Vec<[u32; 3]>,
    /// Lines where the slope breaks.
    pub breaklines: Vec<Breakline>,
    /// The CRS of x and y; unknown where the file does not say.
    pub crs: Crs,
    /// Metres in a unit of the file's coordinates, for x, y and z alike: 1, [`FOOT_M`], [`US_SURVEY_FOOT_M`], 0.001.
    pub unit_m: f64,
}

/// A line along which the slope breaks: a ridge, the edge of an embankment, a river bank.
#[derive(Debug, Clone, PartialEq)]
pub struct Breakline {
    /// Name. May be empty.
    pub name: String,
    /// Whether its heights hold too.
    pub kind: BreaklineKind,
    /// Its points in metres, at least two.
    pub points: Vec<DVec3>,
}

/// How strictly a breakline holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BreaklineKind {
    /// In plan and in height.
    #[default]
    Hard,
    /// In plan: the line stays an edge, its heights may be smoothed.
    Soft,
    /// The border of the surface, or of a hole in it.
    Boundary,
}

impl Default for Tin {
    fn default() -> Self {
        Self {
            name: String::new(),
            mesh: TriangleMesh::default(),
            hidden: Vec::new(),
            breaklines: Vec::new(),
            crs: Crs::default(),
            unit_m: 1.0,
        }
    }
}

impl Tin {
    /// A TIN of a mesh alone, in metres, without a CRS.
    pub fn of_mesh(name: impl Into<String>, mesh: TriangleMesh) -> Self {
        Self { name: name.into(), mesh, ..Self::default() }
    }
}
