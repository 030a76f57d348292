//! What a model's database says of itself.

use yamanami_core::{Aabb, Crs, Snap};

/// The facts of a model that are not in its nodes and pages.
#[derive(Debug, Clone, PartialEq)]
pub struct ClusterMeta {
    /// A name for people.
    pub title: String,
    /// Where the model comes from: files, licence.
    pub source: String,
    /// Triangles of the source.
    pub source_faces: u64,
    /// Vertices of the source.
    pub source_vertices: u64,
    /// The box of the source, metres.
    pub bounds: Aabb,
    /// Coordinates are stored as whole multiples of this, metres, counted from the least corner of the box.
    pub quantum_m: f64,
    /// No vertex is further from its place before storing, metres.
    pub max_error_m: f64,
    /// Whether vertices have colours; else all are white.
    pub has_colours: bool,
    /// Nodes of the hierarchy.
    pub nodes: u32,
    /// Triangles of all pages, the base mesh's among them.
    pub triangles: u64,
    /// Vertices of all pages, the base mesh's among them.
    pub vertices: u64,
    /// What makes it a TIN; a scan if `None`.
    pub tin: Option<TinMeta>,
}

/// The facts of a TIN. Its vertices are stored exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct TinMeta {
    /// The CRS of x and y; z is up.
    pub crs: Crs,
    /// Metres in a unit of the source's coordinates.
    pub unit_m: f64,
    /// The lattice whose steps are stored; what lies between two is stored beside them.
    pub snap: Snap,
}

/// An edge of the source is at least so many quanta long where nothing else is asked for: what is lost is far below what
/// a scanner can tell.
const QUANTA_AN_EDGE: f64 = 64.0;
/// Most quanta along the box's diagonal: coordinates are 32-bit integers with room for what lies outside the box.
const MOST_QUANTA: f64 = (1u32 << 28) as f64;

impl ClusterMeta {
    /// The quantum that suits a model whose edges are so long on average.
    pub fn usual_quantum_m(bounds: &Aabb, mean_edge_m: f64) -> f64 {
        Self::quantum_below(bounds, mean_edge_m / QUANTA_AN_EDGE)
    }

    /// The quantum that keeps every vertex within so many metres, or the least one there is: along each axis a vertex
    /// goes half a quantum, and one more where its place is taken.
    pub fn quantum_within_m(bounds: &Aabb, max_error_m: f64) -> f64 {
        Self::quantum_below(bounds, max_error_m / (1.5 * 3f64.sqrt()))
    }

    /// A power of two, so that multiples are exact, that is at most `wanted_m` where that is not too small for the box.
    fn quantum_below(bounds: &Aabb, wanted_m: f64) -> f64 {
        let least_m = Self::least_quantum_m(bounds);
        let power = |m: f64| if m > 0.0 && m.is_finite() { m.log2() } else { -60.0 };
        power(wanted_m).floor().max(power(least_m).ceil()).clamp(-200.0, 200.0).exp2()
    }

    /// Below this coordinates would not fit into 32 bits, or be lost in those of a box far from zero.
    fn least_quantum_m(bounds: &Aabb) -> f64 {
        let far_m = bounds.min.abs().max_element().max(bounds.max.abs().max_element());
        (bounds.diagonal() / MOST_QUANTA).max(far_m * 2f64.powi(-48))
    }

    /// Checks that the facts can be true; says which cannot.
    pub(crate) fn check(&self) -> Result<(), String> {
        let Aabb { min, max } = self.bounds;
        if !(min.is_finite() && max.is_finite() && min.cmple(max).all()) {
            return Err(format!("a box from {min} to {max}"));
        }
        let least_m = Self::least_quantum_m(&self.bounds);
        if let Some(TinMeta { unit_m, snap, .. }) = &self.tin {
            let is_sound = |x: f64| x.is_finite() && x > 0.0;
            if ![*unit_m, snap.unit_m, snap.per_unit].into_iter().all(is_sound) || self.max_error_m != 0.0 {
                return Err(format!("units of {unit_m} m, {} steps in {} m", snap.per_unit, snap.unit_m));
            }
            return Ok(());
        }
        if !(self.quantum_m.is_finite() && self.quantum_m > 0.0 && self.quantum_m >= least_m * 0.999) {
            return Err(format!("a quantum of {} m", self.quantum_m));
        }
        if !(self.max_error_m.is_finite() && self.max_error_m >= 0.0) {
            return Err(format!("a maximum error of {} m", self.max_error_m));
        }
        Ok(())
    }
}
