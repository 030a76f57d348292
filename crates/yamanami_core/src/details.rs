//! How the vertices of a semi-regular mesh are told as integers: what the builder of a progressive model and its file agree on.

use glam::DVec3;

/// How a new vertex is foretold from the coarser mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Predictor {
    /// The edge's midpoint.
    Hat,
    /// The modified butterfly scheme (Zorin, Schröder, Sweldens 1996).
    Butterfly,
}

/// What integers of a semi-regular mesh's vertices mean.
///
/// Those of a vertex of the base mesh are its coordinates, those of another its distance from where it is foretold: along the normal of
/// the coarser mesh there, along the edge that is split, and across both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetailScheme {
    /// How new vertices are foretold.
    pub predictor: Predictor,
    /// How much of each new vertex's detail moves either end of its edge; zero: no update step.
    pub update: f32,
    /// What the coordinates of the base mesh count from, metres.
    pub origin_m: DVec3,
    /// A unit of the base mesh's coordinates, metres.
    pub base_step_m: f64,
    /// A unit along the normal on level 1, metres.
    pub step_m: f64,
    /// How much larger a unit is from a level to the next.
    pub level_ratio: f32,
    /// How much larger a unit is along the surface than along the normal.
    pub tangent_ratio: f32,
}

impl DetailScheme {
    /// Units of a level's three integers, metres.
    pub fn steps_m(&self, level: u32) -> [f64; 3] {
        if level == 0 {
            return [self.base_step_m; 3];
        }
        let normal = self.step_m * f64::from(self.level_ratio).powi(level as i32 - 1);
        let tangent = normal * f64::from(self.tangent_ratio);
        [normal, tangent, tangent]
    }
}
