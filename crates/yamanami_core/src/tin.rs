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

/// A lattice of places: coordinates that are whole multiples of `unit_m / per_unit` metres, each the one number that
/// `steps / per_unit * unit_m` gives. A survey in feet of four decimals lies on one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snap {
    /// Metres in a unit.
    pub unit_m: f64,
    /// Parts of a unit.
    pub per_unit: f64,
}

impl Snap {
    /// The nearest whole number of steps.
    pub fn steps(&self, x_m: f64) -> f64 {
        (x_m / self.unit_m * self.per_unit).round()
    }

    /// The coordinate of a whole number of steps.
    pub fn metres(&self, steps: f64) -> f64 {
        steps / self.per_unit * self.unit_m
    }

    /// The nearest place of the lattice.
    pub fn place(&self, p: DVec3) -> DVec3 {
        // adding zero makes -0 and 0 one
        DVec3::from_array(p.to_array().map(|x| self.metres(self.steps(x)) + 0.0))
    }

    /// The lattice of these coordinates; `unit_m` is that of their file. See [`SnapFinder`].
    pub fn of(positions: &[DVec3], unit_m: f64) -> Self {
        let mut finder = SnapFinder::new(unit_m);
        positions.iter().for_each(|&p| finder.include(p));
        finder.finish()
    }
}

/// Finds the lattice that coordinates lie on as they come: the coarsest of decimals that all lie on exactly, or else a
/// fine one of halves of a metre that they do not. No coordinate is more than 2³⁰ steps from another.
#[derive(Debug, Clone)]
pub struct SnapFinder {
    candidates: Vec<Snap>,
    unit_m: f64,
    low: DVec3,
    high: DVec3,
}

impl SnapFinder {
    /// For coordinates of a file in such units.
    pub fn new(unit_m: f64) -> Self {
        let candidates = (0..=MOST_DECIMALS).map(|k| Snap { unit_m, per_unit: 10f64.powi(k) }).collect();
        Self { candidates, unit_m, low: DVec3::INFINITY, high: DVec3::NEG_INFINITY }
    }

    /// Looks at a place.
    pub fn include(&mut self, p: DVec3) {
        self.low = self.low.min(p);
        self.high = self.high.max(p);
        // the first is the coarsest: mostly it is the one
        while let Some(snap) = self.candidates.first()
            && snap.place(p) != p
        {
            self.candidates.remove(0);
        }
    }

    /// The lattice.
    pub fn finish(&self) -> Snap {
        let extent_m = (self.high - self.low).max_element().max(0.0);
        match self.candidates.first() {
            Some(&snap) if extent_m / self.unit_m * snap.per_unit < MOST_STEPS => snap,
            _ => {
                let finest = (MOST_STEPS / extent_m.max(f64::MIN_POSITIVE)).log2().floor();
                Snap { unit_m: 1.0, per_unit: finest.min(USUAL_HALVINGS).exp2() }
            }
        }
    }
}

/// Most steps between two coordinates.
const MOST_STEPS: f64 = (1u32 << 29) as f64;
/// Decimals that are tried.
const MOST_DECIMALS: i32 = 6;
/// A place between the steps is 2⁻¹³ m, a tenth of a millimetre, from one at most.
const USUAL_HALVINGS: f64 = 12.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_of_feet_are_found_and_come_back() {
        let feet = |x: f64| x * US_SURVEY_FOOT_M;
        let positions = [[835771.7111, 1069494.2166, 450.6821], [835738.5361, 1069521.32, -0.5]]
            .map(|p: [f64; 3]| DVec3::from_array(p.map(feet)));
        let snap = Snap::of(&positions, US_SURVEY_FOOT_M);
        assert_eq!(snap.per_unit, 1e4);
        assert!(positions.iter().all(|&p| snap.place(p) == p));
        let other = Snap::of(&[positions[0], positions[1] * (1.0 / 3.0)], US_SURVEY_FOOT_M);
        assert_eq!((other.unit_m, other.per_unit.log2().fract()), (1.0, 0.0));
        assert!(Snap::of(&[], 1.0).per_unit >= 1.0);
    }
}
